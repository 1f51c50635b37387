use serde::Serialize;

use super::Curve;
use crate::error::{Error, refusal};
use crate::experiment::fit::least_squares;

/// Fewest samples that a broken line is fitted to.
const FEWEST_BENT: usize = 20;

/// A bend counts where it lowers the distance of broken line and curve by this factor at least.
const GAIN: f64 = 0.75;

/// Distance of straight lines from a curve, as a share of the largest stress, at which they are the curve itself.
const EXACT: f64 = 1e-7;

/// The second yield point lies beyond the first by this share of the first one's strain at least: a bend that sampling
/// or averaging has blunted is no middle piece.
const APART: f64 = 0.5;

/// A bend changes the slope by this share of the steeper piece beside it at least.
const CHANGE: f64 = 0.05;

/// Places that are tried for a bend before the best are refined.
const PLACES: usize = 40;

/// Refinements of the best places; each leaves two thirds of the step.
const REFINEMENTS: usize = 50;

/// The double yield point of a curve: where straight pieces that fit it best meet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct YieldPoints {
    /// Strain and stress (Pa) of the first yield point.
    pub first: [f64; 2],
    /// Strain and stress (Pa) of the second yield point.
    pub second: [f64; 2],
    /// Slopes of the three pieces, Pa.
    pub slopes: [f64; 3],
    /// Root mean square distance of curve and broken line, Pa.
    pub residual: f64,
}

/// The yield points of `curve`: the two bends of the continuous line of three straight pieces that fits it best.
///
/// The line begins where the elastic line ends, which is fitted in the window `elastic` (see [`Curve::modulus`]), so a
/// steep elastic part does not move the first yield point. It ends with the curve. Best is the least square
/// of the distance in stress, each sample weighted by its stretch of strain, so that dense sampling has no more weight.
///
/// # Errors
/// No elastic line, too few samples, and a curve that one bend describes as well: two must lower the root mean square
/// distance to three quarters, lie apart by half of the first one's strain, and each change the slope by a twentieth.
pub fn yield_points(curve: &Curve, elastic: [f64; 2]) -> Result<YieldPoints, Error> {
    let line = curve.modulus(elastic);
    let line = line.map_err(|error| error.about("the elastic line that the yield points are sought beyond"))?;
    let start = [elastic[1], line.stress(elastic[1])];
    let scatter = Scatter::beyond(curve, start)?;
    let (straight, one, two) = (scatter.straight(), scatter.bent_once(), scatter.bent_twice());
    let exact = EXACT * curve.stress().iter().fold(0.0, |largest: f64, stress| largest.max(stress.abs()));
    if one.residual > GAIN * straight.residual || straight.residual <= exact {
        return Err(refusal!("the curve has no yield point: beyond the elastic part it is one straight line"));
    }
    if two.residual > GAIN * one.residual || one.residual <= exact || !two.bends_everywhere() {
        let at = start[0] + one.bends[0];
        return Err(refusal!(
            "the curve has no second yield point: one bend, at the strain {at:.3}, describes it as well as two"
        ));
    }
    let [first, second] = two.bends;
    let [rise, further] = [two.slopes[0] * first, two.slopes[1] * (second - first)];
    let point = |strain: f64, stress: f64| [start[0] + strain, start[1] + stress];
    let (first, second) = (point(first, rise), point(second, rise + further));
    Ok(YieldPoints { first, second, slopes: two.slopes, residual: two.residual })
}

/// The samples of a curve beyond a point, counted from it.
struct Scatter {
    samples: Vec<[f64; 2]>,
    /// Stretch of strain that each sample stands for.
    weights: Vec<f64>,
    /// Strain of the point.
    start: f64,
    end: f64,
}

/// A line of `P` pieces with `B` bends.
#[derive(Clone, Copy)]
struct Broken<const P: usize, const B: usize> {
    bends: [f64; B],
    slopes: [f64; P],
    /// Root mean square distance.
    residual: f64,
}

impl Scatter {
    fn beyond(curve: &Curve, [strain, stress]: [f64; 2]) -> Result<Scatter, Error> {
        let samples = curve.samples().map(|[e, s]| [e - strain, s - stress]).filter(|[e, _]| *e > 0.0);
        let samples: Vec<[f64; 2]> = samples.collect();
        if samples.len() < FEWEST_BENT {
            let found = samples.len();
            return Err(refusal!("{found} samples beyond the elastic part, where yield points need {FEWEST_BENT}"));
        }
        let end = samples[samples.len() - 1][0];
        let place = |i: usize| samples[i][0];
        let weight = |i: usize| {
            let before = if i == 0 { 0.0 } else { place(i - 1) };
            0.5 * (place((i + 1).min(samples.len() - 1)) - before)
        };
        let weights = (0..samples.len()).map(weight).collect();
        Ok(Scatter { weights, samples, start: strain, end })
    }

    fn straight(&self) -> Broken<1, 0> {
        self.fit([])
    }

    fn bent_once(&self) -> Broken<2, 1> {
        let tried = self.places().map(|bend| self.fit([bend]));
        let offsets = OFFSETS.map(|offset| [offset]);
        self.refined(best(tried), &offsets)
    }

    fn bent_twice(&self) -> Broken<3, 2> {
        let pairs = self.places().flat_map(|first| self.places().map(move |second| [first, second]));
        let tried = pairs.filter(|bends| self.are_bends(bends)).map(|bends| self.fit(bends));
        let offsets: Vec<[f64; 2]> = OFFSETS.iter().flat_map(|a| OFFSETS.map(|b| [*a, b])).collect();
        self.refined(best(tried), &offsets)
    }

    /// Denser near the start, where curves bend.
    fn places(&self) -> impl Iterator<Item = f64> + '_ {
        (1..PLACES).map(|i| self.end * (i as f64 / PLACES as f64).powi(2))
    }

    /// The best line around `from`, with ever smaller steps.
    fn refined<const P: usize, const B: usize>(&self, from: Broken<P, B>, offsets: &[[f64; B]]) -> Broken<P, B> {
        let (mut found, mut step) = (from, self.end / PLACES as f64);
        for _ in 0..REFINEMENTS {
            let moved = offsets.iter().map(|offset| std::array::from_fn(|i| found.bends[i] + step * offset[i]));
            let inside = moved.filter(|bends: &[f64; B]| self.are_bends(bends));
            found = best(inside.map(|bends| self.fit(bends)).chain([found]));
            step *= 2.0 / 3.0;
        }
        found
    }

    fn are_bends(&self, bends: &[f64]) -> bool {
        bends.first().is_some_and(|first| *first > 0.0)
            && bends.windows(2).all(|pair| pair[1] - pair[0] >= APART * (self.start + pair[0]))
            && bends.last().is_some_and(|last| *last < self.end)
    }

    /// The slopes between `bends` that fit best; an infinite distance where the samples do not determine them.
    fn fit<const P: usize, const B: usize>(&self, bends: [f64; B]) -> Broken<P, B> {
        let rows = self.samples.iter().zip(&self.weights).map(|([strain, stress], weight)| {
            let root = weight.sqrt();
            (lengths::<P, B>(*strain, &bends).map(|length| root * length), root * stress)
        });
        match least_squares(rows) {
            Some((slopes, left)) => Broken { bends, slopes, residual: (left / self.end).sqrt() },
            None => Broken { bends, slopes: [0.0; P], residual: f64::INFINITY },
        }
    }
}

impl<const P: usize, const B: usize> Broken<P, B> {
    fn bends_everywhere(&self) -> bool {
        let changes = |pair: &[f64]| (pair[0] - pair[1]).abs() >= CHANGE * pair[0].abs().max(pair[1].abs());
        self.slopes.windows(2).all(changes)
    }
}

/// Steps around a place while it is refined.
const OFFSETS: [f64; 3] = [-1.0, 0.0, 1.0];

/// How much of each piece lies below `strain`.
fn lengths<const P: usize, const B: usize>(strain: f64, bends: &[f64; B]) -> [f64; P] {
    let mut lengths = [0.0; P];
    let mut from = 0.0;
    for (piece, length) in lengths.iter_mut().enumerate() {
        let to = if piece < B { bends[piece] } else { strain };
        *length = (strain.min(to) - from).max(0.0);
        from = to;
    }
    lengths
}

/// The nearest of the lines, of which there is at least one; the first of several.
fn best<const P: usize, const B: usize>(lines: impl Iterator<Item = Broken<P, B>>) -> Broken<P, B> {
    let none = Broken { bends: [0.0; B], slopes: [0.0; P], residual: f64::INFINITY };
    lines.fold(none, |best, line| if line.residual < best.residual { line } else { best })
}

/// Strains between which the modulus is fitted by default: the elastic part of a polyethylene film.
pub const WINDOW: [f64; 2] = [0.0, 0.04];

/// Fewest samples that a slope is fitted to.
pub const FEWEST_SAMPLES: usize = 3;

/// The straight line that fits the elastic part of a curve best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulus {
    /// Young's modulus E, Pa.
    pub slope: f64,
    /// Stress of the line at zero strain, Pa: not zero after an offset of the load cell or slack.
    pub intercept: f64,
    /// Samples in the window.
    pub samples: usize,
}

impl Modulus {
    /// Stress of the line at `strain`, Pa.
    pub fn stress(&self, strain: f64) -> f64 {
        self.intercept + self.slope * strain
    }
}

impl Curve {
    /// Young's modulus (equation 2): slope of the least-squares line through the samples with `from <= strain <= to`.
    ///
    /// The line need not go through the origin, so that neither an offset of the load cell nor slack changes it.
    pub fn modulus(&self, [from, to]: [f64; 2]) -> Result<Modulus, Error> {
        check_window([from, to])?;
        let inside: Vec<[f64; 2]> = self.samples().filter(|[strain, _]| (from..=to).contains(strain)).collect();
        let too_few = || {
            let found = inside.len();
            refusal!("{found} samples between the strains {from} and {to}, where a slope needs {FEWEST_SAMPLES}")
        };
        let line = if inside.len() < FEWEST_SAMPLES { None } else { line(&inside) };
        let modulus = line.ok_or_else(too_few)?;
        if modulus.slope > 0.0 {
            return Ok(modulus);
        }
        Err(refusal!("stress does not rise between the strains {from} and {to}").with_hint(
            "force and displacement count above zero in tension: change the sign of a channel that falls, give other \
             strains by --window, or leave out slack at the start by --toe",
        ))
    }
}

/// Refuses what is no window of strain.
pub(super) fn check_window([from, to]: [f64; 2]) -> Result<(), Error> {
    let is_window = from.is_finite() && to.is_finite() && from < to;
    is_window.then_some(()).ok_or_else(|| refusal!("expected a window of strain, found {from} to {to}"))
}

/// The line through `points`; none where they lie at one abscissa.
pub(super) fn line(points: &[[f64; 2]]) -> Option<Modulus> {
    let [start, end] = [points.first()?[0], points.last()?[0]];
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    // Strain from the middle in halves of the interval: columns of one magnitude.
    let rows = points.iter().map(|[strain, stress]| ([1.0, (strain - middle) / half], *stress));
    let ([stress, rise], _) = least_squares(rows)?;
    let slope = rise / half;
    Some(Modulus { slope, intercept: stress - slope * middle, samples: points.len() })
}

/// Share of the largest force below which a coupon counts as broken, by default.
pub const BREAK_SHARE: f64 = 0.5;

/// Share of the fall from the largest force within which noise may rise.
const NOISE: f64 = 0.07;

/// How and where a coupon's curve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rupture {
    /// Break elongation: engineering strain of the last sample before the force collapsed.
    pub strain: f64,
    /// Nominal stress there, Pa.
    pub stress: f64,
    /// Tensile strength: the largest nominal stress, Pa.
    pub strength: f64,
    /// Its end.
    pub ending: CurveEnd,
}

/// The end of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveEnd {
    /// The force fell below the share of its largest value.
    Broke,
    /// The recording ended under load.
    RecordEnded,
}

impl Curve {
    /// Where the coupon broke: from the first sample after the largest force that lies below `share` of it, back to
    /// where that fall began; the end of the record where there is none.
    pub fn rupture(&self, share: f64) -> Result<Rupture, Error> {
        if !(share > 0.0 && share < 1.0) {
            return Err(refusal!(
                "the share of the largest force at which a coupon is broken lies between 0 and 1, not at {share}"
            ));
        }
        let stress = self.stress();
        let peak = (0..stress.len()).max_by(|a, b| stress[*a].total_cmp(&stress[*b])).unwrap_or(0);
        if peak == 0 || stress[peak] <= 0.0 {
            return Err(refusal!("the force never rises: its largest value is the first"));
        }
        let collapsed = (peak..stress.len()).find(|i| stress[*i] < share * stress[peak]);
        let (last, ending) = match collapsed {
            Some(index) => (start_of_fall(stress, index, NOISE * (stress[peak] - stress[index])), CurveEnd::Broke),
            None => (stress.len() - 1, CurveEnd::RecordEnded),
        };
        Ok(Rupture { strain: self.strain()[last], stress: stress[last], strength: stress[peak], ending })
    }
}

/// Where the fall to the sample `from` began, which rises by no more than `noise` meanwhile.
fn start_of_fall(stress: &[f64], from: usize, noise: f64) -> usize {
    let mut highest = stress[from];
    let fall = (0..from).rev().take_while(|i| {
        let falls = stress[*i] >= highest - noise;
        highest = highest.max(stress[*i]);
        falls
    });
    // Over the root of its length a steady fall grows with it, and what went before does not.
    let steepness = |i: usize| (stress[i] - stress[from] - noise) / ((from - i) as f64).sqrt();
    let top = fall.max_by(|a, b| steepness(*a).total_cmp(&steepness(*b))).unwrap_or(from);
    (1..=top).rev().find(|i| stress[i - 1] <= stress[*i]).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupon::average::mean_curve;

    const MD: [[f64; 2]; 3] = [[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]];
    const TD: [[f64; 2]; 3] = [[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]];
    const ELASTIC: [f64; 2] = [0.0, 0.04];

    fn sampled(points: &[[f64; 2]], count: u32, noise: impl Fn(u32) -> f64) -> Curve {
        let nodes: (Vec<f64>, Vec<f64>) = [[0.0, 0.0]].iter().chain(points).map(|p| (p[0], p[1])).unzip();
        let line = Curve::new(nodes.0, nodes.1).unwrap();
        let end = line.range()[1];
        let strain: Vec<f64> = (0..=count).map(|i| (end * f64::from(i) / f64::from(count)).min(end)).collect();
        let stress = strain.iter().zip(0..).map(|(e, i)| line.stress_at(*e).unwrap() + noise(i)).collect();
        Curve::new(strain, stress).unwrap()
    }

    /// The yield points of a curve, near the first two of `points`.
    fn assert_near(curve: &Curve, points: &[[f64; 2]], tolerance: f64) -> YieldPoints {
        let found = yield_points(curve, ELASTIC).unwrap();
        let pairs = [found.first, found.second].concat().into_iter().zip(points.concat());
        let off = pairs.map(|(found, expected)| (found / expected - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < tolerance, "{found:?} is off {points:?} by {off}");
        found
    }

    #[test]
    fn the_corners_of_a_polyline_are_found() {
        for points in [MD, TD] {
            let found = assert_near(&sampled(&points, 700, |_| 0.0), &points, 1e-6);
            assert!(found.residual < 1.0, "{found:?}");
        }
    }

    /// As noise, a fixed sequence that no straight piece can follow.
    fn noise(i: u32) -> f64 {
        50e3 * (f64::from(i) * 12.9898).sin() * if i.is_multiple_of(3) { 1.0 } else { -0.7 }
    }

    #[test]
    fn noise_moves_them_little() {
        for points in [MD, TD] {
            assert_near(&sampled(&points, 700, noise), &points, 0.05);
        }
    }

    #[test]
    fn a_steep_elastic_part_does_not_move_the_first_yield_point() {
        for modulus in [30e6, 53e6, 75e6] {
            let points = [&[[0.04, 0.04 * modulus]], TD.as_slice()].concat();
            assert_near(&sampled(&points, 1402, |_| 0.0), &TD, 1e-3);
        }
    }

    #[test]
    fn dense_sampling_has_no_more_weight() {
        let even = sampled(&TD, 500, |_| 0.0);
        let strain: Vec<f64> = (0..=500).map(|i| 7.01 * (f64::from(i) / 500.0).powi(2)).collect();
        let stress = strain.iter().map(|e| even.stress_at(*e).unwrap()).collect();
        assert_near(&Curve::new(strain, stress).unwrap(), &TD, 0.02);
    }

    /// Strain of the only bend that a curve is refused for.
    fn only_bend(found: &Result<YieldPoints, Error>) -> f64 {
        let error = found.as_ref().unwrap_err().to_string();
        let (_, rest) = error.split_once("one bend, at the strain ").unwrap_or_else(|| panic!("{error}"));
        rest.split(',').next().unwrap().parse().unwrap()
    }

    /// Coupons whose only corner lies between their samples, averaged: the corner of the mean is blunt.
    #[test]
    fn a_corner_between_samples_is_one_bend() {
        for corner in [0.3011, 0.3171, 0.3205] {
            for count in [130, 231] {
                let end = [1.2, 30e6 * corner + 5e6 * (1.2 - corner)];
                let coupon = sampled(&[[corner, 30e6 * corner], end], count, |_| 0.0);
                let mean = mean_curve(&[coupon.clone(), coupon]).unwrap();
                let found = yield_points(&mean, ELASTIC);
                assert!((only_bend(&found) - corner).abs() < 0.005, "{corner}, {count}: {found:?}");
            }
        }
    }

    #[test]
    fn curves_without_two_bends_are_refused() {
        for noise in [|_| 0.0, noise] {
            let straight = yield_points(&sampled(&[[1.0, 30e6]], 400, noise), ELASTIC);
            assert!(straight.unwrap_err().message().starts_with("the curve has no yield point"));
            let bent = yield_points(&sampled(&[[0.3, 8e6], [1.4, 20e6]], 400, noise), ELASTIC);
            assert!((only_bend(&bent) - 0.3).abs() < 0.01, "{bent:?}");
        }
        let short = sampled(&MD, 15, |_| 0.0);
        let few = yield_points(&short, [0.0, 0.2]).unwrap_err();
        assert!(few.message().starts_with("13 samples beyond the elastic part"), "{few}");
    }

    fn bent(offset: f64) -> Curve {
        let strain: Vec<f64> = (0..=100).map(|i| 0.001 * f64::from(i)).collect();
        let stress = strain.iter().map(|e| offset + 50e6 * e.min(0.04) + 20e6 * (e - 0.04).max(0.0)).collect();
        Curve::new(strain, stress).unwrap()
    }

    #[test]
    fn the_modulus_is_the_slope_of_the_elastic_part_with_any_offset() {
        for offset in [0.0, 0.3e6, -1e6] {
            let modulus = bent(offset).modulus(WINDOW).unwrap();
            assert!((modulus.slope / 50e6 - 1.0).abs() < 1e-9, "{modulus:?}");
            assert!((modulus.intercept - offset).abs() < 1.0, "{modulus:?}");
        }
        let beyond = bent(0.0).modulus([0.05, 0.1]).unwrap();
        assert!((beyond.slope / 20e6 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn windows_without_a_slope_are_refused() {
        let refused = |curve: &Curve, window| curve.modulus(window).unwrap_err().to_string();
        let too_few = "2 samples between the strains 0 and 0.0015, where a slope needs 3";
        assert_eq!(refused(&bent(0.0), [0.0, 0.0015]), too_few);
        assert_eq!(refused(&bent(0.0), [0.1, 0.0]), "expected a window of strain, found 0.1 to 0");
        let slack = Curve::new(vec![0.0, 0.01, 0.02], vec![0.0; 3]).unwrap();
        assert_eq!(refused(&slack, WINDOW), "stress does not rise between the strains 0 and 0.04");
    }

    fn curve(stress: &[f64]) -> Curve {
        Curve::new((0..stress.len()).map(|i| 0.1 * i as f64).collect(), stress.to_vec()).unwrap()
    }

    #[test]
    fn the_break_is_where_the_force_begins_to_fall() {
        let rupture = curve(&[0.0, 5.0, 9.0, 10.0, 6.0, 3.0, 0.1]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.strength, rupture.ending), (10.0, 10.0, CurveEnd::Broke));
        assert!((rupture.strain - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_yield_drop_is_no_break() {
        let rupture = curve(&[0.0, 10.0, 7.0, 7.5, 9.0, 0.2]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.strength), (9.0, 10.0));
    }

    /// Noise of half a percent turns the force around many times while it falls.
    #[test]
    fn noise_does_not_end_a_fall() {
        for (before, samples) in [(2e-3, 100), (0.0, 100), (-2e-4, 10), (2e-3, 1000)] {
            let share = |i: u32| f64::from(i.saturating_sub(1000)) / f64::from(samples);
            let line = |i: u32| (10.0 - before * f64::from(1000_u32.saturating_sub(i))) * (1.0 - share(i));
            let stress = (0..=1000 + samples).map(|i| line(i) + 1e-6 * noise(i));
            let stress: Vec<f64> = [0.0, 10.5].into_iter().chain(stress).collect();
            let rupture = curve(&stress).rupture(BREAK_SHARE).unwrap();
            let late = rupture.strain / 0.1 - 1002.0;
            assert!((rupture.stress - 10.0).abs() < 0.25, "{before}, {samples}: {rupture:?}");
            assert!(late.abs() <= 5.0 + 0.02 * f64::from(samples), "{before}, {samples}: {late} samples");
        }
    }

    #[test]
    fn a_record_may_end_before() {
        let rupture = curve(&[0.0, 5.0, 9.0]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.ending), (9.0, CurveEnd::RecordEnded));
    }

    #[test]
    fn a_force_that_never_rises_is_refused() {
        for (stress, share, expected) in [
            (&[3.0, 2.0, 1.0][..], BREAK_SHARE, "the force never rises"),
            (&[-3.0, -2.0, -1.0], BREAK_SHARE, "the force never rises"),
            (&[0.0, 1.0], 1.5, "the share of the largest force at which a coupon is broken"),
        ] {
            let error = curve(stress).rupture(share).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
