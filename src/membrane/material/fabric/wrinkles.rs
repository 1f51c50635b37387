//! Film of two fibre sets that wrinkles: its relaxed energy.
//!
//! Wrinkles too fine for the mesh take up length, so that the fibres of film with the metric C = FᵀF may have any
//! metric C* = C + d dᵀ; d is the direction across the wrinkles (theory.md, equations 8b, 8c):
//!
//! ```text
//! W_r(C) = min W(C + d dᵀ) over d ,   S = 2 ∂W/∂C at C* :   S d = 0 ,  S positive semidefinite
//! ```
//!
//! The least energy is that of film in tension along one direction, or slack in all. With d = (x, −y sgn C₁₂) and
//! x, y ≥ 0 wrinkles lengthen the fibres and reduce their shear. Newton's method finds (x, y), each step with a line
//! search, since curves have corners.

use super::fibres::{Fibres, Metric, SINE_BOUND};
use crate::lane::{Lane, lanes, larger, smaller, splat};

/// Nominal stresses of the fibres and of shear at trial strains, from one history.
pub(super) trait TrialStresses<const L: usize> {
    /// Stresses along MD, along TD and in shear (Pa) at the strains ε_md, ε_td and |γ|.
    fn stresses(&self, strains: &[Lane<L>; 3]) -> [Lane<L>; 3];
    /// Strains up to which the MD and TD fibres carry no stress.
    fn slack(&self) -> [Lane<L>; 2];
}

/// S·d over the sizes of its two terms at which wrinkles are in equilibrium.
const TOLERANCE: f64 = 1e-10;
/// Strain below which fibres count as unstrained: round-off of a stretch.
const RESOLUTION: f64 = 1e-11;
/// S·d over the sizes of its two terms above which a search has failed.
const FAILURE: f64 = 1e-6;
/// Trials of one search; most take four to seven, where curves have corners up to a hundred.
const TRIALS: usize = 400;
/// Difference of strain for the slopes of the curves.
const DIFFERENCE: f64 = 1e-8;
/// Slope along a line over that at its start with which the line search ends (curvature condition; Nocedal and Wright,
/// *Numerical Optimization*, 2006, equation 3.7b).
const CURVATURE: f64 = 0.3;
/// Largest square by which a first guess of wrinkles lengthens film.
const GUESS: f64 = 0.1;
/// Strain beyond the end of its slack to which a fibre is lengthened at least: its stretch stays above one in
/// round-off, where shear depends on it.
const TAUT: f64 = 1e-12;

/// √(x² + y²), with the same bits on every machine, unlike that of the platform's library.
#[inline(always)]
fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// The metric of the fibres in film of the metric `metric`, which is `metric` itself where it is taut; NaN where the
/// search has failed, so that the run ends with a fault.
#[inline(always)]
pub(super) fn relaxed<const L: usize>(metric: &Metric<L>, stresses: &impl TrialStresses<L>) -> Metric<L> {
    let mut searches = started(metric, stresses);
    for _ in 0..TRIALS {
        // Lanes wait for the slowest one; what is found does not move any more.
        if searches.iter().all(|search| search.found) {
            break;
        }
        let trial = Trial::from_metric(&lengthened(metric, &searches), stresses);
        for (l, search) in searches.iter_mut().enumerate().filter(|(_, search)| !search.found) {
            search.improve(&trial.slope(l, search.at));
        }
    }
    let mut relaxed = lengthened(metric, &searches);
    for (l, search) in searches.iter().enumerate() {
        let failed = if search.found || search.residual <= FAILURE { 1.0 } else { f64::NAN };
        // The search works with |f₁·f₂|, by symmetry of the shear curve; the sign comes back here.
        relaxed.product[l] *= failed.copysign(metric.product[l]);
    }
    relaxed
}

/// The metric of fibres that the wrinkles of each lane lengthen; f₁·f₂ without its sign.
#[inline(always)]
fn lengthened<const L: usize>(metric: &Metric<L>, searches: &[Search; L]) -> Metric<L> {
    let mut out = *metric;
    for (l, search) in searches.iter().enumerate() {
        let [x, y] = search.at;
        out.square[0][l] += x * x;
        out.square[1][l] += y * y;
        // Wrinkles always reduce the shear: the sign of d's second component is that of −C₁₂ (theory.md, below equation
        // 8b).
        out.product[l] = metric.product[l].abs() - x * y;
    }
    out
}

/// The search of each lane at its first trial: found where film is taut or slack.
#[inline(always)]
fn started<const L: usize>(metric: &Metric<L>, stresses: &impl TrialStresses<L>) -> [Search; L] {
    let slack = stresses.slack();
    let mut searches: [Search; L] = std::array::from_fn(|l| {
        let least = std::array::from_fn(|fibre| {
            let taut = 1.0 + slack[fibre][l] + TAUT;
            larger(taut * taut - metric.square[fibre][l], 0.0).sqrt()
        });
        Search::from(least, metric.product[l].abs())
    });
    let unwrinkled = Trial::from_metric(&lengthened(metric, &searches), stresses);
    let mut direction = [[0.0; 2]; L];
    for (l, search) in searches.iter_mut().enumerate() {
        // Where slack is taken up anyway, the search begins at `least`; only taut film needs a direction.
        if search.found || search.least != [0.0; 2] {
            continue;
        }
        let [t1, t2, cross] = unwrinkled.tensions(l);
        // Both principal stresses of S are tensions: film is taut, as most of it is most of the time.
        if smaller(t1, t2) >= 0.0 && t1 * t2 >= cross * cross {
            search.found = true;
            continue;
        }
        // The direction of the largest compression, and a square of wrinkles at which shear vanishes or fibres resist.
        let compression = 0.5 * (t1 + t2) - length(0.5 * (t1 - t2), cross);
        // The eigenvector by that row of S − S₂ which does not vanish.
        let (x, y) = if t1 > t2 { (cross, t1 - compression) } else { (t2 - compression, cross) };
        let size = length(x, y);
        direction[l] = [x / size, y / size];
        let [x, y] = direction[l];
        // At x y = |C₁₂| there is no shear left: beyond, wrinkles would only slacken the film.
        let most = smaller(metric.product[l].abs() / (x * y), GUESS).sqrt();
        search.at = [most * x, most * y];
    }
    if direction == [[0.0; 2]; L] {
        return searches;
    }
    let farthest = Trial::from_metric(&lengthened(metric, &searches), stresses);
    for (l, search) in searches.iter_mut().enumerate().filter(|(l, _)| direction[*l] != [0.0; 2]) {
        let [x, y] = direction[l];
        let along = |[t1, t2, cross]: [f64; 3]| t1 * x * x + t2 * y * y - 2.0 * cross * x * y;
        let (before, after) = (along(unwrinkled.tensions(l)), along(farthest.tensions(l)));
        // The compression is about linear in the square of the wrinkles: where it vanishes on this line, Newton's
        // method is close.
        let share = if after > 0.0 { (before / (before - after)).sqrt() } else { 1.0 };
        search.at = search.at.map(|part| share * part);
    }
    searches
}

/// The law at one trial, as a function of λ₁, λ₂ and c = f₁·f₂.
struct Trial<const L: usize> {
    stretch: [Lane<L>; 2],
    /// ∂W/∂λ₁, ∂W/∂λ₂, ∂W/∂c.
    gradient: [Lane<L>; 3],
    /// Sums of the sizes of the terms of ∂W/∂λ₁ and ∂W/∂λ₂.
    size: [Lane<L>; 2],
    /// ∂²W by 11, 22, 12, 1c, 2c, cc.
    hessian: [Lane<L>; 6],
}

impl<const L: usize> Trial<L> {
    #[inline(always)]
    fn from_metric(metric: &Metric<L>, curves: &impl TrialStresses<L>) -> Trial<L> {
        let fibres = Fibres::from_metric(metric);
        let strains = [fibres.strain(0), fibres.strain(1), fibres.shear()];
        let stresses = curves.stresses(&strains);
        let [md, td, shear] = &strains;
        let ahead = |strain: &Lane<L>| lanes(|l| strain[l] + DIFFERENCE);
        let beyond = curves.stresses(&[ahead(md), ahead(td), ahead(shear)]);
        let mut trial = Trial {
            stretch: fibres.stretch,
            gradient: [splat(0.0); 3],
            size: [splat(0.0); 2],
            hessian: [splat(0.0); 6],
        };
        for l in 0..L {
            // One-sided and never negative: at a corner of a curve the slope ahead is taken.
            let slope = |curve: usize| larger((beyond[curve][l] - stresses[curve][l]) / DIFFERENCE, 0.0);
            let (s, secant) = (fibres.sine[l].abs(), fibres.secant[l]);
            // dW/ds and d²W/ds² of shear; beyond the bound the angle is linear in s.
            let secant_slope = if s < SINE_BOUND { s * secant * secant * secant } else { 0.0 };
            let first = stresses[2][l] * secant;
            let second = slope(2) * secant * secant + stresses[2][l] * secant_slope;
            // m_I is constant for slack fibres (equation 5), so shear has no derivative by their stretch.
            let taut = |i: usize| if fibres.stretch[i][l] > 1.0 { fibres.inverse[i][l] } else { 0.0 };
            let taut = [taut(0), taut(1)];
            let both = fibres.inverse[0][l] * fibres.inverse[1][l];
            let sign = 1.0_f64.copysign(metric.product[l]);
            for i in 0..2 {
                trial.gradient[i][l] = stresses[i][l] - first * s * taut[i];
                // Equilibrium is a difference of these terms; their sum tells which difference is round-off.
                trial.size[i][l] = stresses[i][l] + first * s * taut[i];
                trial.hessian[i][l] = slope(i) + (second * s + 2.0 * first) * s * taut[i] * taut[i];
                trial.hessian[3 + i][l] = -sign * (second * s + first) * taut[i] * both;
            }
            trial.gradient[2][l] = sign * first * both;
            trial.hessian[2][l] = (second * s + first) * s * taut[0] * taut[1];
            trial.hessian[5][l] = second * both * both;
        }
        trial
    }

    /// 2 ∂W/∂λ₁², 2 ∂W/∂λ₂² and ∂W/∂c in one lane, Pa.
    #[inline(always)]
    fn tensions(&self, l: usize) -> [f64; 3] {
        [self.gradient[0][l] / self.stretch[0][l], self.gradient[1][l] / self.stretch[1][l], self.gradient[2][l]]
    }

    /// The energy of one lane as a function of the wrinkles (x, y), by the chain rule through λ₁² = C₁₁ + x²,
    /// λ₂² = C₂₂ + y² and c = |C₁₂| − x y.
    #[inline(always)]
    fn slope(&self, l: usize, [x, y]: [f64; 2]) -> Slope {
        let (lambda1, lambda2) = (self.stretch[0][l], self.stretch[1][l]);
        let (w1, w2, wc) = (self.gradient[0][l], self.gradient[1][l], self.gradient[2][l]);
        let of = |k: usize| self.hessian[k][l];
        let [w11, w22, w12, w1c, w2c, wcc] = [of(0), of(1), of(2), of(3), of(4), of(5)];
        let (dx, dy) = (x / lambda1, y / lambda2);
        let (ddx, ddy) = ((1.0 - dx * dx) / lambda1, (1.0 - dy * dy) / lambda2);
        Slope {
            gradient: [w1 * dx - wc * y, w2 * dy - wc * x],
            size: [
                // Where all stresses vanish, a strain of `RESOLUTION` still counts as equilibrium: stiffness takes the
                // place of stress.
                (self.size[0][l] + w11 * (RESOLUTION / TOLERANCE)) * dx + wc.abs() * y,
                (self.size[1][l] + w22 * (RESOLUTION / TOLERANCE)) * dy + wc.abs() * x,
            ],
            hessian: [
                w11 * dx * dx - 2.0 * w1c * dx * y + wcc * y * y + w1 * ddx,
                w22 * dy * dy - 2.0 * w2c * dy * x + wcc * x * x + w2 * ddy,
                w12 * dx * dy - w1c * dx * x - w2c * dy * y + wcc * x * y - wc,
            ],
        }
    }
}

/// First and second derivatives of the energy by the wrinkles (x, y).
struct Slope {
    gradient: [f64; 2],
    /// Sums of the sizes of the gradient's terms.
    size: [f64; 2],
    /// By xx, yy, xy.
    hessian: [f64; 3],
}

impl Slope {
    /// The gradient over the sizes of its terms.
    #[inline(always)]
    fn residual(&self) -> f64 {
        let of = |i: usize| self.gradient[i].abs() / larger(self.size[i], f64::MIN_POSITIVE);
        larger(of(0), of(1))
    }

    /// Newton's step, with the sizes of the second derivatives along the principal directions where one is negative.
    #[inline(always)]
    fn step(&self) -> [f64; 2] {
        let [xx, yy, xy] = self.hessian;
        let [g1, g2] = self.gradient;
        let (mean, apart) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = length(apart, xy);
        // cos 2θ and sin 2θ of the first principal direction.
        let (cosine, sine) = if radius > 0.0 { (apart / radius, xy / radius) } else { (1.0, 0.0) };
        // The energy is not convex in (x, y): with the sizes of both curvatures the step leads down in any case.
        let (first, second) = ((mean + radius).abs(), (mean - radius).abs());
        // A direction without curvature, as along slack, must not give an infinite step.
        let floor = f64::EPSILON * larger(first, second) + f64::MIN_POSITIVE;
        let (i, j) = (1.0 / (first + floor), 1.0 / (second + floor));
        let (sum, difference) = (0.5 * (i + j), 0.5 * (i - j));
        [
            -((sum + difference * cosine) * g1 + difference * sine * g2),
            -((sum - difference * cosine) * g2 + difference * sine * g1),
        ]
    }
}

/// The search for the wrinkles of one lane: the present line and what is known of it.
#[derive(Clone, Copy, Debug)]
struct Search {
    found: bool,
    /// Wrinkles that only take up slack.
    least: [f64; 2],
    /// The present trial (x, y).
    at: [f64; 2],
    /// S·d at the last trial, over the sizes of its terms.
    residual: f64,
    start: [f64; 2],
    step: [f64; 2],
    /// Share of `step` from `start` to the trial.
    step_length: f64,
    /// Derivative of the energy by the step length at the start; zero before the first line.
    initial_slope: f64,
    /// Step length and derivative below and above the minimum, the latter once it is known.
    bracket: [[f64; 2]; 2],
    /// The end of the bracket that the trial before has replaced.
    replaced: Option<usize>,
}

impl Search {
    /// The search of film whose fibres are taut beyond the wrinkles `least`, with `product` = |f₁·f₂|. Where these
    /// wrinkles take up all of its shear, film is slack; without shear there is none to be taken up.
    #[inline(always)]
    fn from(least: [f64; 2], product: f64) -> Search {
        let [x, y] = least;
        let found = x * y >= product;
        let share = if found && product > 0.0 { (product / (x * y)).sqrt() } else { 0.0 };
        Search {
            found,
            least,
            at: if found { least.map(|part| share * part) } else { least },
            residual: f64::INFINITY,
            start: [0.0; 2],
            step: [0.0; 2],
            step_length: 0.0,
            initial_slope: 0.0,
            bracket: [[0.0; 2]; 2],
            replaced: None,
        }
    }

    /// Chooses the next trial from the derivatives at the present one, or ends the search.
    #[inline(always)]
    fn improve(&mut self, slope: &Slope) {
        self.residual = slope.residual();
        if self.residual <= TOLERANCE {
            self.found = true;
            return;
        }
        let [g1, g2] = slope.gradient;
        let along = g1 * self.step[0] + g2 * self.step[1];
        let closed = self.bracket[1][1] > 0.0;
        // `initial_slope` < 0. Too short a step is no reason to stay on the line, unless a minimum is bracketed on it:
        // Newton's next step goes on from there.
        let is_steep = along > -CURVATURE * self.initial_slope || (closed && along < CURVATURE * self.initial_slope);
        if is_steep && self.narrow(along) {
            return;
        }
        self.start = self.at;
        self.move_by(slope.step());
        self.initial_slope = g1 * self.step[0] + g2 * self.step[1];
        // Held at the least wrinkles, Newton's step may lead up (Bertsekas 1982): the gradient does not.
        if self.initial_slope >= 0.0 {
            let size = slope.hessian[0].abs() + slope.hessian[1].abs() + f64::MIN_POSITIVE;
            self.move_by([-g1 / size, -g2 / size]);
            self.initial_slope = g1 * self.step[0] + g2 * self.step[1];
        }
        self.step_length = 1.0;
        (self.bracket, self.replaced) = ([[0.0, self.initial_slope], [f64::INFINITY, 0.0]], None);
    }

    /// The trial that is `step` from the start, held at the least wrinkles.
    #[inline(always)]
    fn move_by(&mut self, step: [f64; 2]) {
        for i in 0..2 {
            self.at[i] = larger(self.start[i] + step[i], self.least[i]);
            self.step[i] = self.at[i] - self.start[i];
        }
    }

    /// The next trial on the line by regula falsi (Illinois: an end that stays has its derivative halved); false where
    /// the bracket is as narrow as numbers resolve.
    #[inline(always)]
    fn narrow(&mut self, along: f64) -> bool {
        let side = usize::from(along > 0.0);
        self.bracket[side] = [self.step_length, along];
        // Without this one end of the bracket may stay for ever on a curve with a corner.
        if self.replaced == Some(side) {
            self.bracket[1 - side][1] *= 0.5;
        }
        self.replaced = Some(side);
        let [[low, falling], [high, rising]] = self.bracket;
        let step_length = low + (high - low) * falling / (falling - rising);
        if step_length <= low || step_length >= high {
            return false;
        }
        self.step_length = step_length;
        self.at = std::array::from_fn(|i| self.start[i] + step_length * self.step[i]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Fabric, History, MembraneLaw, PeakStrains};
    use proptest::prelude::*;

    fn film(absorption: f64) -> Fabric {
        crate::material::tests::film(absorption).with_wrinkling()
    }

    fn metric([first, second, sine]: [f64; 3]) -> Metric<1> {
        Metric { square: [[first * first], [second * second]], product: [sine * first * second] }
    }

    fn energy(film: &Fabric, history: &PeakStrains<1>, metric: &Metric<1>) -> f64 {
        let fibres = Fibres::from_metric(metric);
        let curves = [film.md(), film.td(), film.shear()];
        let strains = [fibres.strain(0), fibres.strain(1), fibres.shear()];
        let peaks = [history.fibres[0], history.fibres[1], history.shear];
        let parts = (0..3).map(|i| {
            let peak = [larger(peaks[i][0], strains[i][0])];
            let (stored, absorbed) = film.absorption.energy(curves[i], &strains[i], &peak);
            stored[0] + absorbed[0]
        });
        parts.sum()
    }

    /// The least energy on ever finer grids of wrinkles about the best of the grid before.
    fn least(film: &Fabric, history: &PeakStrains<1>, metric: &Metric<1>) -> f64 {
        let (mut best, mut about, mut width) = (f64::INFINITY, [0.0, 0.0], 1.2);
        for _ in 0..60 {
            let centre = about;
            for i in -12..=12 {
                for j in -12..=12 {
                    let x = (centre[0] + width * f64::from(i) / 12.0).max(0.0);
                    let y = (centre[1] + width * f64::from(j) / 12.0).max(0.0);
                    let mut trial = *metric;
                    trial.square[0][0] += x * x;
                    trial.square[1][0] += y * y;
                    trial.product[0] = metric.product[0].abs() - x * y;
                    let energy = energy(film, history, &trial);
                    if energy < best {
                        (best, about) = (energy, [x, y]);
                    }
                }
            }
            width *= 0.6;
        }
        best
    }

    fn check(film: &Fabric, peaks: [f64; 3], at: [f64; 3]) {
        let mut history = PeakStrains::<1>::virgin();
        (history.fibres, history.shear) = ([[peaks[0]], [peaks[1]]], [peaks[2]]);
        let metric = metric(at);
        let curves = super::super::Curves { fabric: film, history: &history, dt: Some(1e-6) };
        let relaxed = relaxed(&metric, &curves);
        assert!(relaxed.product[0].is_finite(), "no wrinkles at {at:?}, {peaks:?}");
        let (found, least) = (energy(film, &history, &relaxed), least(film, &history, &metric));
        assert!(
            found <= least + 1e-6 * least.max(1.0),
            "{found} J/m³ for {least} at {at:?}, largest strains {peaks:?}"
        );
        let trial = Trial::from_metric(&relaxed, &curves);
        let [t1, t2, cross] = trial.tensions(0);
        let scale = 1e6 + trial.size[0][0] + trial.size[1][0];
        assert!(t1 >= -1e-9 * scale && t2 >= -1e-9 * scale, "compression {t1} {t2} at {at:?}, {peaks:?}");
        assert!(t1 * t2 - cross * cross >= -1e-8 * scale * scale, "{t1} {t2} {cross} at {at:?}, {peaks:?}");
        // S (C* − C) = 0.
        let [x2, y2] = [0, 1].map(|i| relaxed.square[i][0] - metric.square[i][0]);
        let xy = metric.product[0].abs() - relaxed.product[0].abs();
        let work = t1 * x2 + t2 * y2 - 2.0 * cross.abs() * xy;
        assert!(
            work.abs() <= 1e-8 * scale * (x2 + y2),
            "{work} of {scale} {x2} {y2} {xy} t {t1} {t2} {cross} at {at:?}, {peaks:?}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

        /// The energy is that of a search by brute force, and the stress is a tension field.
        #[test]
        fn the_energy_is_relaxed(
            at in [0.6..1.6, 0.6..1.6, -0.99..0.99],
            peaks in [0.0..0.5, 0.0..0.5, 0.0..0.6],
            share in prop::sample::select(vec![0.0, 0.6, 0.89]),
            virgin: bool,
        ) {
            check(&film(share), if virgin { [0.0; 3] } else { peaks }, at);
        }
    }

    /// Without relaxation it jumps by τ tan γ.
    #[test]
    fn stress_is_continuous_where_a_fibre_becomes_taut() {
        let (film, plain) = (film(0.0), Fabric { coupling: super::super::Coupling::None, ..film(0.0) });
        let stress = |film: &Fabric, stretch: f64| {
            let (sine, cosine) = 0.2_f64.sin_cos();
            let f = [[stretch, 0.0, 0.0], [1.1 * sine, 1.1 * cosine, 0.0]].map(|v| v.map(|x| [x]));
            film.stress(&f.into(), &mut History::virgin(), 0.0).tension[0][0]
        };
        let jump = |film: &Fabric| (stress(film, 1.0 + 1e-9) - stress(film, 1.0 - 1e-9)).abs();
        assert!(jump(&plain) > 4e5, "{}", jump(&plain));
        assert!(jump(&film) < 10.0, "{}", jump(&film));
    }

    /// A lane does not depend on its neighbours.
    #[test]
    fn lanes_are_alike() {
        let film = film(0.6);
        let states: [[f64; 3]; 8] = std::array::from_fn(|k| {
            let k = k as f64;
            [0.85 + 0.06 * k, 1.3 - 0.05 * k, 0.1 * k - 0.3]
        });
        let eight = Metric::<8> {
            square: [0, 1].map(|i| std::array::from_fn(|l| states[l][i] * states[l][i])),
            product: std::array::from_fn(|l| states[l][2] * states[l][0] * states[l][1]),
        };
        let history = PeakStrains::<8>::virgin();
        let together = relaxed(&eight, &super::super::Curves { fabric: &film, history: &history, dt: Some(0.0) });
        for (l, state) in states.into_iter().enumerate() {
            let history = PeakStrains::<1>::virgin();
            let curves = super::super::Curves { fabric: &film, history: &history, dt: Some(0.0) };
            let alone = relaxed(&metric(state), &curves);
            assert_eq!([alone.square[0][0], alone.square[1][0]], [together.square[0][l], together.square[1][l]]);
            assert_eq!(alone.product[0], together.product[l]);
        }
    }
}
