//! The material file of coupon tests, with comments on what was measured, what is assumed and what is missing.

use std::fmt::Write;

use crate::error::{Error, refusal};
use crate::experiment::Warning;
use crate::experiment::coupon::average::SampleStatistics;
use crate::experiment::coupon::shear::Shear;
use crate::experiment::coupon::{Coupon, Curve, Direction, DirectionMeans, Fibres, Reduction, ShearMethod, too_short};
use crate::signal::Annotations;
use base::number::{rounded, significant};
use membrane::material;

/// Density of LLDPE film, kg/m³, where the user gives none.
const LLDPE_DENSITY: f64 = 915.0;

/// Points of a mean curve that is written because it has no double yield point.
const CURVE_POINTS: usize = 24;

/// Distance from the measured shear stress to the straight pieces that are written, over the largest stress.
const SHEAR_TOLERANCE: f64 = 2e-3;

/// Shortest straight piece of the shear curve, rad: below, its slope would be one of noise.
const SHEAR_PIECE: f64 = 5e-3;

/// Significant digits of the numbers that are written.
const DIGITS: usize = 4;

/// The first words of the material, and of a shear curve from D3.
const MARK: &str = "# Written by droptower from coupon tests";

/// The content of a material file.
#[derive(Clone, Debug)]
pub struct CouponMaterial<'a> {
    /// Means of the coupons.
    pub reduction: &'a Reduction,
    /// Dimensions of the coupons.
    pub coupon: Coupon,
    /// kg/m³; that of LLDPE where it is not known.
    pub density: Option<f64>,
    /// Name of the shear curve's file, in the folder of the material's.
    pub shear_file: &'a str,
    /// Engineering strain of a corner at which the curves of MD and TD leave their mean Young's modulus; none leaves it out,
    /// and a curve begins with the slope to its first yield point.
    pub elastic_corner: Option<f64>,
    /// How the shear curve follows from the coupons of D3.
    pub shear_by: ShearMethod,
    /// A shear curve from elsewhere, in place of one from D3.
    pub shear: Option<GivenShear<'a>>,
}

/// A shear curve that was not measured with the coupons.
#[derive(Clone, Copy, Debug)]
pub struct GivenShear<'a> {
    /// Where it comes from, as the files name it.
    pub source: &'a str,
    /// CSV with the columns `strain` (shear angle, rad) and `stress`, as materials read it.
    pub text: &'a str,
}

/// A material file and the shear curve's file beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texts {
    /// The material file.
    pub material: String,
    /// The file of the shear curve.
    pub shear: String,
    /// The doubt whether film of this material follows the coupons that the shear curve is from.
    pub doubt: Option<Warning>,
}

/// The refusal of a curve whose stress (Pa) falls between two points.
fn falls(direction: Direction, points: [[f64; 2]; 2]) -> Error {
    let [from, to] = points.map(|[strain, stress]| {
        format!("({}, {} MPa)", significant(strain, DIGITS), significant(stress * 1e-6, DIGITS))
    });
    refusal!("{direction}: stress falls between the points {from} and {to}: the curve of a material must not fall")
}

impl CouponMaterial<'_> {
    /// The files' texts.
    ///
    /// The curves of MD and TD are the yield points of the mean curve, or else that curve itself, and the mean break
    /// elongation with the mean stress at the break. The shear curve comes from the mean curve of D3, or is a copy of
    /// what is given.
    pub fn texts(&self) -> Result<Texts, Error> {
        let (md, td) = (self.along(Direction::Md)?, self.along(Direction::Td)?);
        let ((md_fibre, md_curve), (td_fibre, td_curve)) = (self.fibre(md)?, self.fibre(td)?);
        let (shear, remark, doubt) = match &self.shear {
            Some(given) => {
                let (shear, remark) = given.copy();
                (shear, remark, None)
            }
            None => self.sheared(self.along(Direction::D3)?, Fibres { md: &md_curve, td: &td_curve })?,
        };
        let mut material = self.head();
        let rates = self.reduction.velocities().map(|velocity| significant(velocity / self.coupon.gauge(), DIGITS));
        let _ = write!(
            material,
            "\n{density}\nthickness = \"{thickness} um\"   # as given; one layer\n\n[fabric]\n\
             # {corner}Yield points of the mean curves, mean break elongation and stress at the break; straight lines between them.\n\
             {md_fibre}{td_fibre}{remark}shear = {{ curve = {file} }}\n\
             # Coupons pulled to their break do not show the energy absorbed on unloading: none, until it is known from a\n\
             # drop test (droptower reduce drop).\n# absorption = 0.9\n\
             # Slowest and fastest jaws over the gauge length.\nmeasured_rates = [\"{} 1/s\", \"{} 1/s\"]\n",
            rates[0],
            rates[1],
            corner = if self.elastic_corner.is_some() { "Mean Young's modulus up to the first point. " } else { "" },
            density = self.density_line()?,
            thickness = significant(self.coupon.thickness() * 1e6, DIGITS),
            file = toml::Value::from(self.shear_file),
        );
        Ok(Texts { material, shear, doubt })
    }

    fn along(&self, direction: Direction) -> Result<&DirectionMeans, Error> {
        self.reduction.along(direction).ok_or_else(|| {
            let error =
                refusal!("a material needs coupons of MD, TD and D3 (for shear), and there is none of {direction}");
            match direction {
                Direction::D3 => error.with_hint("give a shear curve from elsewhere: --shear FILE"),
                _ => error,
            }
        })
    }

    fn fibre(&self, along: &DirectionMeans) -> Result<(String, material::Curve), Error> {
        fibre(along, self.elastic_corner)
    }

    fn head(&self) -> String {
        let reduction = self.reduction;
        let mut head = format!("{MARK}: {}.\n", counted(reduction.recordings(), reduction.virtual_recordings()));
        head.extend(self.reduction.directions.iter().map(summary));
        head
    }

    fn density_line(&self) -> Result<String, Error> {
        match self.density {
            Some(density) if density.is_finite() && density > 0.0 => {
                Ok(format!("density   = \"{} kg/m3\"", significant(density, DIGITS)))
            }
            Some(density) => Err(refusal!("expected a density above zero, found {density} kg/m3")),
            None => Ok(format!("density   = \"{LLDPE_DENSITY} kg/m3\" # assumed: that of LLDPE, since none was given")),
        }
    }

    /// The shear curve's file from D3, the remark that belongs to it, and the doubt about it.
    fn sheared(&self, skewed: &DirectionMeans, fibres: Fibres<'_>) -> Result<(String, String, Option<Warning>), Error> {
        let sheared =
            self.coupon.shear_by(self.shear_by, &skewed.curve, fibres).map_err(|error| error.about("shear"))?;
        let (end, why) = shear_end(&sheared, self.shear_by);
        let count = counted(skewed.recordings(), skewed.virtual_recordings);
        let mut file =
            format!("{MARK} of D3: {count}.\n# Shear angle (rad) and stress of the film.\nstrain,stress_MPa\n");
        let points = straight_pieces(&rising_shear(&sheared, end)?);
        for [angle, stress] in &points[1..] {
            let _ = writeln!(file, "{},{}", significant(*angle, DIGITS), significant(stress * 1e-6, DIGITS));
        }
        let remark = format!(
            "# From D3 {}, up to the angle {}{why}.\n\
             # Assumed: the same stress and strain all over the coupon, so that any square in it shears alike.\n",
            described(self.shear_by),
            significant(end, DIGITS)
        );
        let doubt = material::Curve::new(points).ok().and_then(|law| self.leaves_coupons(&skewed.curve, fibres, &law));
        Ok((file, remark, doubt))
    }
}

/// Share of the strain that the coupons of D3 reached up to which their shear curve ends early, where the law is then off their
/// stress by more than the other share.
const ENDS_EARLY: f64 = 0.5;
const OFF: f64 = 0.1;

impl CouponMaterial<'_> {
    /// The report of a shear curve that ends far below the strain of the `measured` mean curve of D3, which film with these
    /// fibres and the `shear` curve, continued, does not follow.
    fn leaves_coupons(&self, measured: &Curve, fibres: Fibres<'_>, shear: &material::Curve) -> Option<Warning> {
        let angle = shear.end();
        let [_, reached] = measured.range();
        let strain = self.shear_by.strain_at(measured, &fibres, angle).filter(|at| *at < ENDS_EARLY * reached)?;
        let is_held = self.shear_by == ShearMethod::Held;
        let off =
            |[strain, stress]: [f64; 2]| Some([strain, fibres.coupon_stress(shear, strain, is_held)? / stress - 1.0]);
        let beyond = measured.samples().filter(|sample| sample[0] > strain && sample[1] > 0.0);
        let off = beyond.filter_map(off).max_by(|one, other| one[1].abs().total_cmp(&other[1].abs()))?;
        (off[1].abs() > OFF).then_some(Warning::ShearCurveEnds { angle, strain, reached, off })
    }
}

impl GivenShear<'_> {
    /// The shear curve's file, and the remark that belongs to it.
    fn copy(&self) -> (String, String) {
        // A table of a curve states that it is virtual as recordings do, in a comment.
        let comments = self.text.lines().filter_map(|line| line.trim().strip_prefix('#').map(str::to_owned));
        let is_virtual = Annotations::new(comments.collect()).is_virtual();
        let mark = if is_virtual { ", which is marked as VIRTUAL" } else { "" };
        let source = self.source.replace(char::is_control, " ");
        let text = self.text.trim_start_matches('\u{feff}').trim_end();
        (
            format!("# Written by droptower: a copy of {source}{mark}.\n{text}\n"),
            format!("# Given, not measured with these coupons: a copy of {source}{mark}.\n"),
        )
    }
}

/// Number of recordings, and how many of them are virtual.
fn counted(recordings: usize, virtual_ones: usize) -> String {
    match virtual_ones {
        0 => format!("{recordings} recordings"),
        _ => format!("{recordings} recordings, {virtual_ones} of them VIRTUAL: nothing was pulled"),
    }
}

/// Assumption of a method, for the remark.
fn described(method: ShearMethod) -> &'static str {
    match method {
        ShearMethod::Free => "as a strip with free sides whose fibres have the curves above",
        ShearMethod::Held => "as a strip of held width whose fibres have the curves above",
        ShearMethod::Rhombus => "by equations 4 to 8 of Polymers 2021, 13, 1537, whose fibres do not stretch",
    }
}

/// Angle up to which a shear curve is written, and why it ends there: the curve of a material does not fall.
fn shear_end(sheared: &Shear, method: ShearMethod) -> (f64, &'static str) {
    let [_, last] = sheared.curve.range();
    let largest = sheared
        .curve
        .samples()
        .fold([0.0, f64::NEG_INFINITY], |best, sample| if sample[1] > best[1] { sample } else { best });
    match sheared.cut {
        _ if largest[0] < last => (largest[0], ", beyond which the stress falls"),
        0 => (last, ""),
        _ if method == ShearMethod::Rhombus => (last, ", where the square is closed; D3 was measured beyond"),
        _ => (last, ", where the fibres end or the angle falls; D3 was measured beyond"),
    }
}

/// The origin and the samples up to the angle `end`, whose stress does not fall: noise is levelled, a real fall is refused.
fn rising_shear(sheared: &Shear, end: f64) -> Result<Vec<[f64; 2]>, Error> {
    let samples = || sheared.curve.samples().take_while(|[angle, _]| *angle <= end);
    let largest = samples().fold(0.0_f64, |most, [_, stress]| most.max(stress));
    let mut points = vec![[0.0, 0.0]];
    for [angle, stress] in samples() {
        let [last, before] = points[points.len() - 1];
        if stress < before - SHEAR_TOLERANCE * largest {
            let angle = significant(angle, 3);
            return Err(refusal!(
                "the mean curve of the coupons of D3 gives a shear stress that falls at the angle {angle} rad: the curve of a \
                 material must not fall"
            )
            .with_hint(
                "slack at the start of coupons of any direction may do that: --toe; else try --shear-by, other strains by --window, \
                 or give a shear curve from elsewhere: --shear FILE",
            ));
        }
        if angle > last {
            points.push([angle, stress.max(before)]);
        }
    }
    if points.len() > 1 { Ok(points) } else { Err(too_short().about("shear")) }
}

/// The points that a polyline needs to stay within [`SHEAR_TOLERANCE`] of all of them, first and last included, as
/// far as its pieces are not shorter than [`SHEAR_PIECE`] (Ramer, 1972; Douglas and Peucker, 1973).
fn straight_pieces(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let last = points.len() - 1;
    let tolerance = SHEAR_TOLERANCE * points[last][1];
    let (mut kept, mut open) = (vec![0, last], vec![(0, last)]);
    while let Some((from, to)) = open.pop() {
        let [[start, low], [end, high]] = [points[from], points[to]];
        let apart = |index: usize| {
            let [angle, stress] = points[index];
            (stress - low - (high - low) * (angle - start) / (end - start)).abs()
        };
        let is_inside = |index: &usize| (start + SHEAR_PIECE..=end - SHEAR_PIECE).contains(&points[*index][0]);
        let furthest = (from + 1..to).filter(is_inside).max_by(|one, other| apart(*one).total_cmp(&apart(*other)));
        if let Some(index) = furthest.filter(|index| apart(*index) > tolerance) {
            kept.push(index);
            open.extend([(from, index), (index, to)]);
        }
    }
    kept.sort_unstable();
    kept.into_iter().map(|index| points[index]).collect()
}

/// The measurements along one direction, as a comment.
fn summary(along: &DirectionMeans) -> String {
    let DirectionMeans { direction, elongation, .. } = along;
    let speeds: Vec<String> = along.speeds.iter().map(|speed| significant(speed.velocity, DIGITS)).collect();
    let (modulus, strength) = (shown_spread(&along.modulus, 1e-6), shown_spread(&along.strength, 1e-6));
    let unused = if direction.has_curve() { "" } else { " In no curve below." };
    format!(
        "# {direction}: {} coupons at {} m/s; E {modulus} MPa, strength {strength} MPa, break elongation {} %.{unused}\n",
        elongation.count,
        speeds.join(", "),
        shown_spread(elongation, 100.0),
    )
}

fn shown_spread(spread: &SampleStatistics, factor: f64) -> String {
    let SampleStatistics { mean, deviation, count } = spread;
    if *count > 1 {
        format!("{:.1} +- {:.1}", mean * factor, deviation * factor)
    } else {
        format!("{:.1}", mean * factor)
    }
}

/// The curve of one direction, also as the language writes it: yield points and break, with a corner before them where
/// there is one, or else the mean curve and the break.
fn fibre(along: &DirectionMeans, corner: Option<f64>) -> Result<(String, material::Curve), Error> {
    let mut points = points(along);
    let corner = corner.filter(|_| along.yields.is_ok()).map(|strain| [strain, strain * along.modulus.mean]);
    points.splice(..0, corner);
    let curve = rising(along.direction, &points)?;
    let point = |[strain, stress]: &[f64; 2]| {
        format!("[{}, \"{} MPa\"]", significant(*strain, DIGITS), significant(stress * 1e-6, DIGITS))
    };
    let shown: Vec<String> = points.iter().map(point).collect();
    let key = along.direction.to_string().to_lowercase();
    let text = match &along.yields {
        Ok(yields) if corner.is_some() => {
            let strains = [yields.first, yields.second].map(|[strain, _]| significant(strain, DIGITS)).join(", ");
            format!("{key} = {{ curve = [{}], yield_strains = [{strains}] }}\n", shown.join(", "))
        }
        Ok(_) => format!("{key} = {{ yield = [{}, {}], break = {} }}\n", shown[0], shown[1], shown[2]),
        Err(error) => {
            let why = format!("# {}: {error}; so the mean curve itself, then the break.\n", along.direction);
            format!("{why}{key} = {{ curve = [{}] }}\n", shown.join(", "))
        }
    };
    Ok((text, curve))
}

/// The corners of a direction's curve; the last one is the break.
fn points(along: &DirectionMeans) -> Vec<[f64; 2]> {
    let end = [along.elongation.mean, along.break_stress.mean];
    match &along.yields {
        Ok(yields) => vec![yields.first, yields.second, end],
        Err(_) => {
            let mut points = thinned(along);
            if end[0] > along.curve.range()[1] {
                points.push(end);
            }
            points
        }
    }
}

/// The curve through the rounded points that are written.
fn rising(direction: Direction, points: &[[f64; 2]]) -> Result<material::Curve, Error> {
    let points: Vec<[f64; 2]> = points.iter().map(|point| point.map(|value| rounded(value, DIGITS))).collect();
    let mut before = [0.0, 0.0];
    for point in &points {
        if point[0] <= before[0] || point[1] < before[1] {
            return Err(falls(direction, [before, *point]));
        }
        before = *point;
    }
    material::Curve::new(points).map_err(|_| falls(direction, [[0.0; 2], before]))
}

/// The mean curve at some strains, denser at the beginning.
fn thinned(along: &DirectionMeans) -> Vec<[f64; 2]> {
    let [start, end] = along.curve.range();
    let place = |i: usize| {
        if i == CURVE_POINTS { end } else { start + (end - start) * (i as f64 / CURVE_POINTS as f64).powi(2) }
    };
    (1..=CURVE_POINTS).filter_map(|i| Some([place(i), along.curve.stress_at(place(i))?])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupon::{Rules, Sample};

    /// Direction, stress over strain, and largest strain of a coupon.
    type Given<'a> = (Direction, &'a dyn Fn(f64) -> f64, f64);

    /// The material of such coupons, sampled evenly up to their ends, then broken.
    fn texts(of: &[Given<'_>]) -> Result<Texts, Error> {
        let sample = |(direction, stress, end): &Given<'_>| {
            let mut strain: Vec<f64> = (0..=2000).map(|i| end * f64::from(i) / 2000.0).collect();
            let mut stresses: Vec<f64> = strain.iter().map(|strain| stress(*strain)).collect();
            strain.push(end + 0.01);
            stresses.push(0.0);
            let rules = Rules { window: [0.0, 0.02], ..Rules::default() };
            Sample::new(*direction, 0.01, &Curve::new(strain, stresses).unwrap(), &rules).unwrap()
        };
        let samples: Vec<Sample> = of.iter().map(sample).collect();
        let reduction = Reduction::from_samples(&samples, &Rules { window: [0.0, 0.02], ..Rules::default() })?;
        let material = CouponMaterial {
            reduction: &reduction,
            coupon: Coupon::new(0.05, 0.015, 25e-6)?,
            density: None,
            shear_file: "shear.csv",
            elastic_corner: None,
            shear_by: ShearMethod::Free,
            shear: None,
        };
        material.texts()
    }

    fn line(points: &[[f64; 2]], strain: f64) -> f64 {
        let pair = points.windows(2).find(|pair| strain <= pair[1][0]).expect("a strain within the curve");
        pair[0][1] + (pair[1][1] - pair[0][1]) * (strain - pair[0][0]) / (pair[1][0] - pair[0][0])
    }

    /// Polyethylene that is nearly alike in all directions yields at 45° as it does along MD, which two fibre sets cannot follow.
    #[test]
    fn a_shear_curve_that_ends_long_before_its_coupons_is_reported() {
        let md = |strain: f64| line(&[[0.0, 0.0], [0.06, 9e6], [0.5, 14e6], [4.0, 35e6]], strain);
        let td = |strain: f64| line(&[[0.0, 0.0], [0.06, 9.6e6], [0.5, 9.9e6], [6.0, 24e6]], strain);
        let skewed = |strain: f64| line(&[[0.0, 0.0], [0.06, 8.7e6], [0.5, 10.5e6], [5.0, 27e6]], strain);
        let written = texts(&[(Direction::Md, &md, 4.0), (Direction::Td, &td, 6.0), (Direction::D3, &skewed, 5.0)]);
        let Some(Warning::ShearCurveEnds { strain, reached, off, .. }) = written.unwrap().doubt else {
            panic!("no finding")
        };
        assert!((0.05..0.1).contains(&strain) && reached == 5.0 && off[1].abs() > 0.5, "{strain} {reached} {off:?}");
    }

    /// Fibres that hardly stretch with τ = G γ: sin γ = (1 + ε)² − 1 and σ = 2 τ/√(2 − (1 + ε)²).
    #[test]
    fn a_fabric_that_follows_its_coupons_is_not() {
        let stiff = |strain: f64| 1e12 * strain;
        let skewed = |strain: f64| {
            let squared = (1.0 + strain) * (1.0 + strain);
            2.0 * 1e6 * (squared - 1.0).asin() / (2.0 - squared).sqrt()
        };
        let written =
            texts(&[(Direction::Md, &stiff, 0.5), (Direction::Td, &stiff, 0.5), (Direction::D3, &skewed, 0.3)]);
        assert_eq!(written.unwrap().doubt, None);
    }

    #[test]
    fn a_stress_that_falls_names_the_coupons_and_a_way_out() {
        let md = |strain: f64| 100e6 * strain;
        // It falls, then rises above.
        let skewed = |strain: f64| line(&[[0.0, 0.0], [0.05, 3e6], [0.08, 1e6], [0.3, 9e6]], strain);
        let refused = texts(&[(Direction::Md, &md, 1.0), (Direction::Td, &md, 1.0), (Direction::D3, &skewed, 0.3)]);
        let refused = refused.unwrap_err();
        let message = refused.message();
        let angle = message.split_once("at the angle ").expect(message).1.split(' ').next().unwrap();
        assert!(message.contains("coupons of D3") && angle.len() <= 8, "{message}");
        let hint = refused.hint().unwrap_or_default();
        assert!(hint.contains("--toe") && hint.contains("--shear FILE"), "{refused}");
    }
}
