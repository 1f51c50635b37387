//! Coupons at several angles to MD: what the calibrated law makes of each, of those that it has not seen, and whether the
//! angles between follow a law that is fitted to 0, 45 and 90 degrees (docs/methods.md, section 28).

use std::collections::BTreeMap;

use rhai::Array;
use serde_json::{Value, json};

use super::bindings::Calibrated;
use super::left_out::{self, LeftOut};
use super::plan::Plan;
use super::pulled;
use super::recorded_test::Test;
use super::warning::Warning;
use crate::scenario_functions::Changes;
use crate::script::{HostResult, Options, Row, numbers, object, refuse};
use base::number::significant;
use lab::experiment::coupon::{Curve, Direction, WINDOW};
use lab::signal::Series;
use plot::{Look, Plot};
use scene::model::Loading;
use scene::simulate::{Across, section_between_jaws};

/// Strains of the force where none are given, over the end of the shortest recording.
const USUAL_SHARES: [f64; 3] = [0.1, 0.3, 0.9];
/// Degrees from one point of a drawn law to the next.
const STEP: usize = 5;
/// Error up to which an angle follows the law.
const USUAL_TOLERANCE: f64 = 0.05;
/// Label of the angle in diagrams.
const ANGLE: &str = "angle from MD (°)";

/// Options of `angles`.
pub(super) const OPTIONS: [&str; 3] = ["strains", "modulus", "tolerance"];

/// What a script asks for.
pub(super) struct Asked {
    strains: Vec<f64>,
    modulus: [f64; 2],
    tolerance: f64,
}

/// What angles say: rows, diagrams and a finding.
pub(super) struct Angles {
    pub(super) rows: Vec<Row>,
    pub(super) plots: Vec<Plot>,
    pub(super) warnings: Vec<Warning>,
}

/// A coupon at its angle.
struct Coupon<'a> {
    /// Index of its test.
    index: usize,
    test: &'a Test,
    direction: Direction,
    across: Across,
    /// Stress-free cross-section, m².
    section: f64,
}

impl Asked {
    /// `#{ strains, modulus, tolerance }`.
    pub(super) fn read(options: &Options<'_>, plan: &Plan) -> HostResult<Asked> {
        options.check(&OPTIONS)?;
        let list = |name: &str| -> HostResult<Option<Vec<f64>>> {
            let Some(given) = options.map.get(name) else { return Ok(None) };
            let list = given.clone().try_cast::<Array>();
            numbers(&list.ok_or_else(|| refuse!("`{name}` must be an array of strains"))?, "a strain").map(Some)
        };
        let ends = plan.tests.iter().filter(|test| test.pull.is_some()).flat_map(Test::recordings).map(end_of);
        let shortest = ends.fold(f64::INFINITY, f64::min);
        let strains = list("strains")?.unwrap_or_else(|| USUAL_SHARES.map(|share| share * shortest).into());
        if let Some(wrong) = strains.iter().find(|strain| !(0.0..=shortest).contains(*strain)) {
            return Err(refuse!("the strain {wrong} lies outside of the recordings, which end at {shortest}"));
        }
        let modulus = match list("modulus")?.as_deref() {
            None => [WINDOW[0], WINDOW[1].min(shortest)],
            Some(&[from, to]) if 0.0 <= from && from < to && to <= shortest => [from, to],
            Some(_) => return Err(refuse!("`modulus` is two strains from 0 to {shortest}")),
        };
        let tolerance = options.number("tolerance", USUAL_TOLERANCE)?;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(refuse!("`tolerance` is a relative error such as 0.05, not {tolerance}"));
        }
        Ok(Asked { strains, modulus, tolerance })
    }
}

impl Angles {
    /// Compares the coupons of a calibration.
    pub(super) fn compared(asked: &Asked, done: &Calibrated<'_>) -> HostResult<Angles> {
        let Calibrated { plan, fit, .. } = *done;
        let coupons = coupons(plan);
        if coupons.len() < 2 {
            return Err(refuse(
                "angles are compared of two coupons or more: tests with `pull: \"strip\"` of [loading.stretch]",
            ));
        }
        let is_axis = |coupon: &&Coupon<'_>| {
            matches!(coupon.direction, Direction::Md | Direction::Td | Direction::D3 | Direction::D4)
        };
        let between: Vec<usize> = coupons.iter().filter(|own| !is_axis(own)).map(|own| own.index).collect();
        let has = |any: &[Direction]| coupons.iter().any(|own| any.contains(&own.direction));
        let has_axes = has(&[Direction::Md]) && has(&[Direction::Td]) && has(&[Direction::D3, Direction::D4]);
        let mut groups: Vec<Vec<usize>> = coupons.iter().map(|own| vec![own.index]).collect();
        if has_axes && !between.is_empty() {
            groups.push(between.clone());
        }
        let mut found = left_out::searched(&groups, done)?;
        let of_axes = (found.len() > coupons.len()).then(|| found.pop()).flatten();
        let mut laws = vec![Law::new("law", asked, &coupons, &fit.values, done)?];
        if let Some(left) = &of_axes {
            laws.push(Law::new("law of 0, 45, 90°", asked, &coupons, &left.values, done)?);
        }
        let rows: Vec<Row> = coupons
            .iter()
            .zip(&found)
            .map(|(coupon, left)| row(asked, coupon, &fit.simulated[coupon.index], left, of_axes.as_ref()))
            .collect();
        let mut warnings: Vec<Warning> = found.iter().chain(&of_axes).flat_map(|left| left.doubts(plan)).collect();
        if let Some(left) = &of_axes {
            let of_axis = |index: usize| left_out::simulated(done, index, &left.values);
            let axes = coupons.iter().map(|own| own.index).filter(|index| !left.tests.contains(index));
            let axes = axes.map(|index| Ok((index, of_axis(index)?))).collect::<HostResult<BTreeMap<_, _>>>()?;
            warnings.extend(doubt(asked, &coupons, left, &axes));
        }
        let mut plots = vec![modulus_plot(asked, &coupons, &laws)];
        plots.extend((0..asked.strains.len()).map(|place| force_plot(asked, &coupons, &laws, place)));
        Ok(Angles { rows, plots, warnings })
    }
}

/// The tests that are pulled, in the order of their angles.
fn coupons(plan: &Plan) -> Vec<Coupon<'_>> {
    let coupon = |(index, test): (usize, &'_ Test)| {
        let (Some(across), Loading::Stretch(stretch)) = (test.pull, &test.study.model().loading) else { return None };
        let section = section_between_jaws(test.study.model())?;
        Some((index, Direction::at(stretch.angle), across, section))
    };
    let found = plan.tests.iter().enumerate().filter_map(coupon);
    let of_test =
        |(index, direction, across, section)| Coupon { index, test: &plan.tests[index], direction, across, section };
    let mut coupons: Vec<Coupon<'_>> = found.map(of_test).collect();
    coupons.sort_by(|a, b| a.direction.angle().total_cmp(&b.direction.angle()));
    coupons
}

fn end_of(recording: &Series) -> f64 {
    recording.time().last().copied().unwrap_or(0.0)
}

/// Slope of stress over strain within the window, Pa.
fn modulus(series: &Series, window: [f64; 2]) -> Option<f64> {
    let curve = Curve::new(series.time().to_vec(), series.values().to_vec()).ok()?;
    curve.modulus(window).ok().map(|found| found.slope)
}

/// Mean of the relative difference of a law from the recordings over the strains of a test, signed; early strains, where
/// both are small, count by their stress.
fn bias(test: &Test, simulated: &[Series]) -> f64 {
    let mut sums = [0.0; 2];
    for [strain, measured] in test.recordings().flat_map(Series::samples) {
        if let Some(own) = simulated.first().and_then(|own| own.value_at(strain)) {
            sums[0] += own - measured;
            sums[1] += measured;
        }
    }
    sums[0] / sums[1]
}

/// Error of the mean of the recordings of a test, relative to its stress.
fn error(test: &Test, simulated: &[Series]) -> Option<f64> {
    let errors = test.signals.iter().zip(simulated).map(|(signal, own)| signal.errors.relative_error(own).ok());
    let squares = errors.map(|error| error.map(|error| error * error)).collect::<Option<Vec<_>>>()?;
    Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// One row a coupon.
fn row(asked: &Asked, coupon: &Coupon<'_>, fitted: &[Series], left: &LeftOut, of_axes: Option<&LeftOut>) -> Row {
    let test = coupon.test;
    let mean = |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    let measured = |value: &dyn Fn(&Series) -> Option<f64>| mean(test.recordings().filter_map(value).collect());
    let of_law = |value: &dyn Fn(&Series) -> Option<f64>| fitted.first().and_then(value);
    let moduli = |series: &Series| modulus(series, asked.modulus).map(|slope| 1e-6 * slope);
    let from_axes = of_axes.and_then(|left| left.signals(coupon.index));
    let mut row = object(json!({
        "test": test.name, "angle_deg": coupon.direction.degrees(),
        "modulus_MPa": measured(&moduli), "modulus_law_MPa": of_law(&moduli),
        "relative_error": error(test, fitted), "relative_error_left_out": left.signals(coupon.index).and_then(|own| error(test, own)),
        "relative_error_from_0_45_90": from_axes.and_then(|own| error(test, own)),
        "bias_from_0_45_90": from_axes.map(|own| bias(test, own)),
    }));
    for strain in &asked.strains {
        let force = |series: &Series| series.value_at(*strain).map(|stress| stress * coupon.section);
        // Percent without a point, since a column is a name.
        let name = significant(100.0 * strain, 3).replace('.', "_");
        row.insert(format!("force_at_{name}_percent_N"), json!(measured(&force)));
        row.insert(format!("force_law_at_{name}_percent_N"), of_law(&force).map_or(Value::Null, Value::from));
    }
    row
}

/// Whether the angles between follow the law of 0, 45 and 90 degrees, and if not, what would; `axes` are the signals of the
/// coupons at these, by their tests.
fn doubt(
    asked: &Asked,
    coupons: &[Coupon<'_>],
    left: &LeftOut,
    axes: &BTreeMap<usize, Vec<Series>>,
) -> Option<Warning> {
    let signals =
        |coupon: &Coupon<'_>| left.signals(coupon.index).or_else(|| axes.get(&coupon.index).map(Vec::as_slice));
    let is_between = |coupon: &&Coupon<'_>| left.tests.contains(&coupon.index);
    let off: Vec<(&Coupon<'_>, f64, f64)> = coupons
        .iter()
        .filter(is_between)
        .filter_map(|coupon| {
            let simulated = signals(coupon)?;
            let error = error(coupon.test, simulated)?;
            (error > asked.tolerance).then(|| (coupon, bias(coupon.test, simulated), error))
        })
        .collect();
    if off.is_empty() {
        return None;
    }
    // What the pieces of the curves make of every modulus is no matter of the angle.
    let slope = |coupon: &Coupon<'_>| {
        let measured = coupon.test.recordings().filter_map(|own| modulus(own, asked.modulus));
        let measured: Vec<f64> = measured.collect();
        let own = modulus(signals(coupon)?.first()?, asked.modulus)?;
        Some(own * measured.len() as f64 / measured.iter().sum::<f64>() - 1.0)
    };
    let of_axes: Vec<f64> = coupons.iter().filter(|own| !is_between(own)).filter_map(slope).collect();
    let level = of_axes.iter().sum::<f64>() / of_axes.len().max(1) as f64;
    let slopes = coupons.iter().filter(is_between).filter_map(|own| Some(slope(own)? - level));
    let of_modulus = slopes.fold(0.0, |worst: f64, own| if own.abs() > worst.abs() { own } else { worst });
    let mirrored = mirrored(coupons);
    let (least, most) = off
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (_, bias, _)| (least.min(*bias), most.max(*bias)));
    let needs = if mirrored.is_some_and(|difference| difference > asked.tolerance) {
        SKEW_FIBRES
    } else if of_modulus.abs() > asked.tolerance {
        OTHER_MODULUS
    } else if most > 0.0 {
        INTERACTION
    } else {
        UNKNOWN
    };
    let error = off.iter().map(|(_, _, error)| *error).fold(0.0, f64::max);
    let angles = off.iter().map(|(coupon, ..)| significant(coupon.direction.degrees(), 4)).collect();
    Some(Warning::AnglesDoNotFollow { angles, least, most, error, of_modulus, needs: needs.into() })
}

/// What a law that follows the angles between needs, where angles θ and −θ differ.
const SKEW_FIBRES: &str = "the same angle on both sides of MD differs, so that the law needs fibres that are not at right angles, or MD \
                           lies elsewhere than was assumed";
/// Where they differ from the first strain on.
const OTHER_MODULUS: &str = "the modulus does not follow either, which that of every orthotropic film does in a free strip: the angles, \
                             the jaws or the film differ";
/// Where they follow at first, and the film yields earlier than the law.
const INTERACTION: &str = "the modulus follows and the stress afterwards does not: strain along fibres and shear need to yield together, \
                           as in film whose stresses depend on one equivalent strain";
/// Where it is none of these.
const UNKNOWN: &str = "neither fibres that are not at right angles nor yielding together explains it";

/// The largest difference of coupons at θ and −θ, relative to their stress; none where no angle was measured on both sides.
fn mirrored(coupons: &[Coupon<'_>]) -> Option<f64> {
    let pairs = coupons.iter().filter_map(|own| {
        let mirror = Direction::at(-own.direction.angle());
        let other = coupons.iter().find(|other| other.direction == mirror && mirror > own.direction)?;
        let [recorded, simulated] = [own.test.recordings().next()?, other.test.recordings().next()?];
        let end = end_of(recorded).min(end_of(simulated));
        let squares = recorded.samples().filter(|[strain, _]| *strain <= end).filter_map(|[strain, stress]| {
            simulated.value_at(strain).map(|other| [(other - stress).powi(2), stress * stress])
        });
        let [difference, level] = squares.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        (level > 0.0).then(|| (difference / level).sqrt())
    });
    pairs.fold(None, |worst: Option<f64>, own| Some(worst.map_or(own, |worst| worst.max(own))))
}

/// A law at every angle.
struct Law {
    name: &'static str,
    /// Degrees.
    angles: Vec<f64>,
    /// MPa.
    moduli: Vec<f64>,
    /// Force (N) at each of the strains.
    forces: Vec<Vec<f64>>,
}

impl Law {
    fn new(
        name: &'static str,
        asked: &Asked,
        coupons: &[Coupon<'_>],
        values: &[f64],
        Calibrated { plan, session, .. }: &Calibrated<'_>,
    ) -> HostResult<Law> {
        let Some(first) = coupons.first() else { return Err(refuse("there is no coupon")) };
        let film = first.test.study.with(plan.changes(first.index, values), session)?;
        let end = asked.strains.iter().copied().fold(asked.modulus[1], f64::max);
        let angles: Vec<f64> = (0..180).step_by(STEP).map(|angle| angle as f64).collect();
        let at = |angle: &f64| -> HostResult<Series> {
            let turned = Changes::from([("loading.stretch.direction".to_owned(), Value::from(format!("{angle} deg")))]);
            pulled::simulated(&film.with(turned, session)?, first.across, end)
        };
        let curves = angles.iter().map(at).collect::<HostResult<Vec<_>>>()?;
        let moduli = curves.iter().map(|curve| 1e-6 * modulus(curve, asked.modulus).unwrap_or(f64::NAN)).collect();
        let force = |strain: &f64| {
            curves.iter().map(|curve| first.section * curve.value_at(*strain).unwrap_or(f64::NAN)).collect()
        };
        Ok(Law { name, angles, moduli, forces: asked.strains.iter().map(force).collect() })
    }

    /// Half a turn, after which the values come again.
    fn curve(&self, values: &[f64]) -> plot::Curve {
        let again = values.first().map(|value| [180.0, *value]);
        plot::Curve::line(self.name, self.angles.iter().zip(values).map(|(angle, value)| [*angle, *value]).chain(again))
    }
}

/// The laws, all but the first dashed, and the coupons.
fn drawn<'l>(
    laws: &'l [Law],
    values: impl Fn(&'l Law) -> &'l [f64],
    coupons: &[Coupon<'_>],
    of: &dyn Fn(&Series, f64) -> Option<f64>,
) -> Vec<plot::Curve> {
    let curve = |(place, law): (usize, &'l Law)| {
        let curve = law.curve(values(law));
        if place == 0 { curve } else { curve.dashed() }
    };
    laws.iter().enumerate().map(curve).chain([measured(coupons, of)]).collect()
}

fn modulus_plot(asked: &Asked, coupons: &[Coupon<'_>], laws: &[Law]) -> Plot {
    let of = |series: &Series, _: f64| modulus(series, asked.modulus).map(|slope| 1e-6 * slope);
    let curves = drawn(laws, |law| &law.moduli, coupons, &of);
    Plot::new("Modulus over the angle", [ANGLE, "modulus (MPa)"], curves)
}

fn force_plot(asked: &Asked, coupons: &[Coupon<'_>], laws: &[Law], place: usize) -> Plot {
    let strain = asked.strains[place];
    let of = |series: &Series, section: f64| series.value_at(strain).map(|stress| stress * section);
    let curves = drawn(laws, |law| &law.forces[place], coupons, &of);
    let title = format!("Force at {} % over the angle", significant(100.0 * strain, 3));
    Plot::new(title, [ANGLE, "force (N)"], curves)
}

/// The coupons as points, each at its angle.
fn measured(coupons: &[Coupon<'_>], value: &dyn Fn(&Series, f64) -> Option<f64>) -> plot::Curve {
    let points = coupons.iter().flat_map(|coupon| {
        let angle = coupon.direction.degrees();
        let values = coupon.test.recordings().filter_map(|own| value(own, coupon.section));
        values.map(move |own| [angle, own]).collect::<Vec<_>>()
    });
    plot::Curve { name: "coupons".into(), points: points.collect(), look: Look::Points }
}
