//! The unknowns of a recording by maximum posterior density, and draws of them (methods.md, equations 46, 50 and 51).

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::model::{COUNT, Model, Unknowns, of};
use base::cancellation::stop_if_cancelled;

/// Steps of the differences by which residuals are differentiated, of each unknown.
const STEPS: Unknowns = [1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-5, 1e-3, 1e-3, 1e-5, 1e-4, 1e-4, 1e-4, 1e-6];
/// Most steps of the search, and the change of the sum of squares that ends it.
const MOST_STEPS: usize = 100;
const CONVERGED: f64 = 1e-6;
/// Exponents of the force, shares of the friction that go on after contact and that grow with the speed to start from.
const STARTS: [[f64; 3]; 5] =
    [[1.0, 0.95, 0.02], [1.8, 0.95, 0.02], [3.0, 0.95, 0.02], [1.8, 0.05, 0.02], [1.8, 0.95, 0.4]];
/// Draws, and the most that are tried for them.
const DRAWS: usize = 400;
const MOST_TRIED: usize = 200_000;
/// Least variance of the draws over that of the density: the model of release and onset is not exact. Assumed; with it
/// the intervals of docs/verification.md hold what they say.
const LEAST_COLOUR: f64 = 1.15;
/// Standard deviations beyond a bound from which on an unknown is taken to lie at it.
const AT_BOUND: f64 = 2.0;
/// Length of the bins whose means show noise that is not white, s.
const BIN: f64 = 0.01;

/// The unknowns that explain a recording best.
pub(super) struct Fit {
    pub best: Unknowns,
    /// Sum of squares at the best.
    pub cost: f64,
    /// Variance of means of [`BIN`] over that of white noise, at least [`LEAST_COLOUR`]; the draws are so much wider.
    pub colour: f64,
    /// Normal matrix JᵀJ and gradient Jᵀr there.
    normal: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Fit {
    /// The best of searches from several exponents of the force, near `start`.
    pub(super) fn find(model: &Model<'_>, start: &Unknowns) -> Option<Fit> {
        let from = |[exponent, goes_on, of_speed]: [f64; 3]| {
            let mut start = *start;
            (start[of::EXPONENT], start[of::GOES_ON], start[of::OF_SPEED]) = (exponent, goes_on, of_speed);
            Fit::descend(model, start)
        };
        STARTS.into_iter().map(from).filter(|fit| fit.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// Levenberg and Marquardt's method within the bounds: an unknown at its bound stays there while the gradient holds
    /// it. Not that of `descent`, which knows no bounds: what lies at one decides the intervals.
    fn descend(model: &Model<'_>, start: Unknowns) -> Fit {
        let bounds = model.bounds();
        let within = |i: usize, value: f64| value.clamp(bounds[i][0], bounds[i][1]);
        let mut best: Unknowns = std::array::from_fn(|i| within(i, start[i]));
        let cost = |u: &Unknowns| model.residuals(u).iter().map(|r| r * r).sum::<f64>();
        let (mut least, mut damping) = (cost(&best), 1e-3);
        let mut steps = 0;
        loop {
            stop_if_cancelled();
            let jacobian = jacobian(model, &best);
            let normal = jacobian.transpose() * &jacobian;
            let gradient = jacobian.transpose() * DVector::from_vec(model.residuals(&best));
            let is_free = |i: &usize| {
                let ([low, high], slope) = (bounds[*i], gradient[*i]);
                low < high && !(best[*i] <= low && slope > 0.0 || best[*i] >= high && slope < 0.0)
            };
            let free: Vec<usize> = (0..COUNT).filter(is_free).collect();
            let mut gain = 0.0;
            for _ in 0..12 {
                let damped = |a: usize, b: usize| normal[(free[a], free[b])] * if a == b { 1.0 + damping } else { 1.0 };
                let damped = DMatrix::from_fn(free.len(), free.len(), damped).cholesky();
                let step = damped.map(|c| c.solve(&DVector::from_fn(free.len(), |a, _| -gradient[free[a]])));
                let mut tried = best;
                for (a, i) in free.iter().enumerate() {
                    tried[*i] = within(*i, best[*i] + step.as_ref().map_or(0.0, |step| step[a]));
                }
                let found = cost(&tried);
                if found < least {
                    gain = least - found;
                    (best, least, damping) = (tried, found, (0.2 * damping).max(1e-9));
                    break;
                }
                damping *= 6.0;
            }
            steps += 1;
            if gain < CONVERGED || steps == MOST_STEPS {
                let colour = colour(model, &model.residuals(&best));
                return Fit { best, cost: least, colour, normal, gradient };
            }
        }
    }

    /// Draws of the unknowns from the density about the best: normal in those that are free, cut at the bounds. Always
    /// the same ones; none where the recording determines nothing.
    pub(super) fn draws(&self, model: &Model<'_>) -> Vec<Unknowns> {
        let bounds = model.bounds();
        let mut free: Vec<usize> = (0..COUNT).filter(|i| bounds[*i][0] < bounds[*i][1]).collect();
        let (shift, lower) = loop {
            let normal = DMatrix::from_fn(free.len(), free.len(), |a, b| self.normal[(free[a], free[b])]);
            let Some(inverse) = normal.cholesky().map(|c| c.inverse()) else {
                return vec![];
            };
            let shift = -&inverse * DVector::from_fn(free.len(), |a, _| self.gradient[free[a]]);
            // Far beyond its bound an unknown lies at it.
            let beyond = |a: usize| {
                let [low, high] = bounds[free[a]];
                let (centre, deviation) = (self.best[free[a]] + shift[a], inverse[(a, a)].sqrt());
                ((low - centre) / deviation).max((centre - high) / deviation)
            };
            match (0..free.len()).max_by(|a, b| beyond(*a).total_cmp(&beyond(*b))) {
                Some(worst) if beyond(worst) > AT_BOUND => free.remove(worst),
                _ => match (inverse * self.colour).cholesky() {
                    Some(cholesky) => break (shift, cholesky.l()),
                    None => return vec![],
                },
            };
        };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut draw = || {
            let normal = DVector::from_fn(free.len(), |_, _| StandardNormal.sample(&mut random));
            let moved: DVector<f64> = &shift + &lower * normal;
            let mut drawn = self.best;
            free.iter().enumerate().for_each(|(a, i)| drawn[*i] += moved[a]);
            drawn
        };
        let is_inside = |u: &Unknowns| u.iter().zip(bounds).all(|(value, [low, high])| (low..=high).contains(value));
        (0..MOST_TRIED).map(|_| draw()).filter(is_inside).take(DRAWS).collect()
    }
}

fn jacobian(model: &Model<'_>, u: &Unknowns) -> DMatrix<f64> {
    let column = |i: usize| {
        let moved = |step: f64| {
            let mut u = *u;
            u[i] += step;
            DVector::from_vec(model.residuals(&u))
        };
        // No coupling is weaker than none.
        let back = if i == of::INVERSE { STEPS[i].min(u[i]) } else { STEPS[i] };
        (moved(STEPS[i]) - moved(-back)) / (STEPS[i] + back)
    };
    DMatrix::from_columns(&(0..COUNT).map(column).collect::<Vec<_>>())
}

/// How much more the residuals of successive samples agree than white noise does: the mean square of their means over
/// [`BIN`], each in its standard deviations.
fn colour(model: &Model<'_>, residuals: &[f64]) -> f64 {
    let mut bins: Vec<[f64; 3]> = Vec::new();
    for (sample, residual) in model.samples.iter().zip(residuals) {
        if bins.last().is_none_or(|[from, ..]| sample.time > from + BIN) {
            bins.push([sample.time, 0.0, 0.0]);
        }
        if let Some([_, sum, weight]) = bins.last_mut() {
            *sum += residual / sample.deviation;
            *weight += sample.deviation.powi(-2);
        }
    }
    let squares = bins.iter().map(|[_, sum, weight]| sum * sum / weight).sum::<f64>();
    (squares / bins.len() as f64).max(LEAST_COLOUR)
}
