//! The material of a layer: valid curves with their multipliers.

use super::{Checker, exclusions, law};
use crate::scenario::{self, Fibre, FibreCurve, Point, RateCurve, Scale};
use base::number::significant;
use base::units::Rate;
use membrane::material::{
    Curve, CurveError, Elastic, Fabric, FibreLaw, Law, Material, Multipliers, RateCurves, RateCurvesError,
    TensionField, Thermal,
};

/// The material written at `path`, which is empty for that of a material file; none where it is invalid.
pub fn check(written: &scenario::Material, path: &str, checker: &mut Checker<'_>) -> Option<Material> {
    let of = |table: &str| if path.is_empty() { table.to_owned() } else { format!("{path}.{table}") };
    let (law, rates, place) = match (&written.fabric, &written.elastic, &written.hyperelastic, &written.plastic) {
        (Some(fabric), ..) => {
            let place = of("fabric");
            (self::fabric(fabric, &place, checker)?, fabric.measured_rates, place)
        }
        (None, Some(written), ..) => (elastic(written), written.measured_rates, of("elastic")),
        (None, None, Some(written), _) => {
            let place = of("hyperelastic");
            (law::check_hyperelastic(written, &place, checker)?, written.measured_rates, place)
        }
        (None, None, None, Some(written)) => {
            let place = of("plastic");
            (law::check_plastic(written, &place, checker)?, written.measured_rates, place)
        }
        (None, None, None, None) => return None,
    };
    let written_rates = rates.map(|[from, to]| [from.0, to.0]);
    if written_rates.is_some_and(|[from, to]| to < from) {
        let path = format!("{place}.measured_rates");
        checker.report_with(&path, "the highest rate is below the lowest", "write the lowest first");
    }
    let measured_rates = written_rates.or_else(|| law.rates());
    let refused = checker.exclude(&of(""), &exclusions::material(), written);
    let is_possible = |key: &str| !refused.contains(&key);
    let viscosity = is_possible("prony").then(|| law::check_viscosity(written, &law, path, checker)).flatten();
    let rupture = is_possible("rupture").then(|| law::check_rupture(written, &law, path, checker)).flatten();
    let (density, thickness) = (written.density.0, written.thickness.0);
    // The ranges were checked before.
    let heated = written.thermal.filter(|thermal| density * thermal.heat.0 > 0.0 && is_possible("thermal"));
    let thermal = heated.map(|heated| Thermal { capacity: density * heated.heat.0, softening: heated.softening.0 });
    Some(Material { density, thickness, law, viscosity, rupture, thermal, measured_rates })
}

fn elastic(written: &scenario::Elastic) -> Law {
    let elastic = Elastic { young: written.young.0, poisson: written.poisson };
    if written.wrinkling { Law::TensionField(TensionField(elastic)) } else { Law::Elastic(elastic) }
}

fn fabric(written: &scenario::Fabric, path: &str, checker: &mut Checker<'_>) -> Option<Law> {
    let md = fibre(&written.md, written, &format!("{path}.md"), checker);
    let td = fibre(&written.td, written, &format!("{path}.td"), checker);
    let shear_path = format!("{path}.shear.curve");
    let place = |index: usize| format!("{shear_path}.{index}");
    let shear = curve(&written.shear.curve, &shear_path, place, checker);
    if written.biaxial_source.as_ref().is_some_and(|source| source.trim().is_empty()) {
        let path = format!("{path}.biaxial_source");
        checker.report_with(
            &path,
            "expected where the coupling comes from, found nothing",
            "name the test, or leave it out",
        );
    }
    // The range was checked before; there is no law outside it.
    let absorption = Some(written.absorption).filter(|share| (0.0..1.0).contains(share));
    Some(match (md?, td?) {
        (Curves::One(md), Curves::One(td)) => {
            Law::Fabric(with_coupling(Fabric::new(md, td, shear?, absorption?), written))
        }
        (md, td) => {
            Law::RateFabric(with_coupling(Fabric::new(md.by_rate(), td.by_rate(), shear?, absorption?), written))
        }
    })
}

/// The fabric with what couples its fibre sets besides shear.
fn with_coupling<F: FibreLaw>(fabric: Fabric<F>, written: &scenario::Fabric) -> Fabric<F> {
    if written.biaxial > 0.0 { fabric.with_biaxial(written.biaxial) } else { fabric }
}

/// The curve of a fibre set, or its curves by strain rate.
enum Curves {
    /// One for all rates.
    One(Curve),
    /// One a rate.
    ByRate(RateCurves),
}

impl Curves {
    fn by_rate(self) -> RateCurves {
        match self {
            Curves::One(curve) => RateCurves::from(curve),
            Curves::ByRate(curves) => curves,
        }
    }
}

/// A curve as written, of a fibre set or of one of its rates.
struct Written<'a> {
    points: &'a FibreCurve,
    /// Its multipliers.
    scale: Scaling,
    /// Its break strain over that which these leave.
    break_factor: f64,
}

/// Multipliers as written.
#[derive(Clone)]
struct Scaling {
    multipliers: Scale,
    /// Their key path.
    path: String,
    /// Whether they move the break strain.
    moves_break: bool,
}

/// The curves of one fibre set with their own multipliers, those of the set or else those of the fabric.
fn fibre(written: &Fibre, fabric: &scenario::Fabric, path: &str, checker: &mut Checker<'_>) -> Option<Curves> {
    let of_fabric = path.rsplit_once('.').map_or(String::new(), |(fabric, _)| format!("{fabric}.scale"));
    let (multipliers, place) = written.scale.map_or((fabric.scale, of_fabric), |own| (own, format!("{path}.scale")));
    let scale = Scaling { multipliers, path: place, moves_break: fabric.scale_break };
    let Some(rates) = &written.rates else {
        let written = Written { points: &written.points, scale, break_factor: written.break_factor };
        return self::written(&written, path, checker).map(Curves::One);
    };
    if written.points.yield_strains.is_some() {
        checker.out_of_place(&format!("{path}.yield_strains"), "each of `rates` has its own");
    }
    let memory = fabric.rate_memory.unwrap_or(RATE_MEMORY);
    by_rate(rates, memory, &scale, written.break_factor, path, checker).map(Curves::ByRate)
}

/// Growth of the largest strain over which the rate is averaged; assumed. At the 5 to 25 1/s of a drop test that is 0.4
/// to 2 ms.
const RATE_MEMORY: f64 = 0.01;

/// Curves by rate; `scale` applies to curves without their own.
fn by_rate(
    written: &[RateCurve],
    memory: f64,
    scale: &Scaling,
    break_factor: f64,
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<RateCurves> {
    let mut curves = Vec::with_capacity(written.len());
    for (index, written) in written.iter().enumerate() {
        let path = format!("{path}.rates.{index}");
        let RateCurve { rate, points, scale: own } = written;
        let own = own.map(|multipliers| Scaling { multipliers, path: format!("{path}.scale"), ..*scale });
        let scale = own.unwrap_or_else(|| scale.clone());
        let written = Written { points, scale, break_factor };
        curves.push(self::written(&written, &path, checker).map(|curve| (rate.0, curve)));
    }
    match RateCurves::new(curves.into_iter().collect::<Option<_>>()?, memory) {
        Ok(curves) => return Some(curves),
        Err(RateCurvesError::RateNotIncreasing { index, rate, previous }) => checker.report_with(
            &format!("{path}.rates.{index}.rate"),
            "the rates do not increase",
            format!("{} follows {}; list the slowest first", Rate(rate), Rate(previous)),
        ),
        Err(RateCurvesError::NoInitialSlope { index }) => checker.report_with(
            &format!("{path}.rates.{index}"),
            "this curve starts without stress",
            "curves by strain rate rise from the origin, so that the film can unload along each of them",
        ),
        // The ranges were checked before.
        Err(
            RateCurvesError::Empty
            | RateCurvesError::InvalidRate { .. }
            | RateCurvesError::InvalidAveragingStrain { .. },
        ) => {}
    }
    None
}

/// One curve with its multipliers.
fn written(written: &Written<'_>, path: &str, checker: &mut Checker<'_>) -> Option<Curve> {
    let FibreCurve { yield_points, break_point, curve, yield_strains } = written.points;
    let (curve, yields) = match (curve, *yield_points, *break_point) {
        (Some(points), _, _) => general(*yield_strains, points, path, checker)?,
        (None, Some([first, second]), Some(end)) => {
            if yield_strains.is_some() {
                let why = "the yield points are those of `yield`";
                checker.out_of_place(&format!("{path}.yield_strains"), why);
            }
            let place = |index: usize| match index {
                0 | 1 => format!("{path}.yield.{index}"),
                _ => format!("{path}.break"),
            };
            let curve = self::curve(&[first, second, end], path, place, checker)?;
            (curve, Some([first.0, second.0]))
        }
        _ => return None,
    };
    let curve = scaled(curve, yields, &written.scale, path, checker)?;
    let factor = written.break_factor;
    match factor {
        1.0 => Some(curve),
        // The range was checked before.
        _ => (factor > 0.0).then(|| curve.ending_at(factor * curve.end())),
    }
}

/// A curve of any points; its yield strains must ascend within it.
fn general(
    yield_strains: Option<[f64; 2]>,
    points: &[Point],
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<(Curve, Option<[f64; 2]>)> {
    let curve_path = format!("{path}.curve");
    let place = |index: usize| format!("{curve_path}.{index}");
    let curve = curve(points, &curve_path, place, checker)?;
    if let Some([first, second]) = yield_strains {
        let last = curve.points().last().map_or(0.0, |point| point[0]);
        let path = format!("{path}.yield_strains");
        if second <= first {
            checker.report(&path, "the second yield strain is not above the first");
        } else if second >= last {
            let message = format!("the curve ends at {last}, before its second yield point");
            checker.report(&path, message);
            checker.label(&place(points.len() - 1), "its last point");
        }
    }
    Some((curve, yield_strains))
}

/// The curve with its multipliers, which need its yield strains.
fn scaled(
    curve: Curve,
    yields: Option<[f64; 2]>,
    scale: &Scaling,
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<Curve> {
    let Scale { k1, ke, ky } = scale.multipliers;
    if scale.multipliers == Scale::default() {
        return Some(curve);
    }
    let Some(yields) = yields else {
        return checker.refuse(
            &format!("{path}.curve"),
            "`scale` needs the yield points of a curve, and this one has none",
            format!("give their strains beside it: yield_strains = [{}, {}]", 0.3, 0.8),
        );
    };
    if ![k1, ke, ky].iter().all(|k| *k > 0.0) {
        return None; // the range was checked before
    }
    let multipliers = Multipliers { k1, ke, ky };
    let moved = match multipliers.apply(&curve, yields) {
        Ok(moved) => moved,
        Err(error) => {
            let message = format!("no curve with these multipliers: {error}");
            checker.report(&scale.path, message);
            return None;
        }
    };
    if scale.moves_break {
        return Some(moved);
    }
    let second = multipliers.strain(yields[1], yields);
    if second >= curve.end() {
        let [second, end] = [second, curve.end()].map(|strain| significant(strain, 4));
        return checker.refuse(
            &scale.path,
            format!("these multipliers move the second yield point to {second}, beyond the break strain {end}"),
            "with `scale_break = true` in [fabric] the break strain moves along",
        );
    }
    Some(moved.ending_at(curve.end()))
}

/// The curve through `points`; a mistake is reported at the `place` of its point.
fn curve(points: &[Point], path: &str, place: impl Fn(usize) -> String, checker: &mut Checker<'_>) -> Option<Curve> {
    let pairs = points.iter().map(|Point(strain, stress)| [*strain, stress.0]);
    if points.is_empty() {
        return None; // the length was checked before
    }
    match Curve::new(pairs.collect()) {
        Ok(curve) => return Some(curve),
        Err(CurveError::StrainNotIncreasing { index, strain, previous }) => {
            let hint = match index {
                0 => format!(
                    "{strain} follows the point (0, 0), which is added before the first: leave out what is not above it"
                ),
                _ => format!("{strain} follows {previous}"),
            };
            checker.report_with(&place(index), "the curve is not increasing in strain", hint);
            if let Some(before) = index.checked_sub(1) {
                checker.label(&place(before), "the point before it");
            }
        }
        Err(CurveError::StressFalls { index: 0, .. }) => {
            let hint = "the point (0, 0) is added before the first: film that is stretched without stress has no curve";
            checker.report_with(&place(0), "the stress of the curve falls", hint);
        }
        Err(CurveError::StressFalls { index, .. }) => {
            checker.report(&place(index), "the stress of the curve falls");
            if let Some(before) = index.checked_sub(1) {
                checker.label(&place(before), "the point before it");
            }
        }
        Err(CurveError::NotFinite { index }) => {
            checker.report(&place(index), "this point of the curve is not finite");
        }
        Err(error @ CurveError::TooShort) => checker.report(path, error.to_string()),
    }
    None
}
