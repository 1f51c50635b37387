//! The unknowns of a recording by maximum posterior density, draws of them (methods.md, equations 46, 50 and 51), and the
//! intervals of its figures from these (section 12).

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::model::{COUNT, Model, Unknowns, of};
use super::recording::Recorded;
use super::result::{Input, Intervals};
use crate::experiment::absorption::{Body, RISES};
use base::cancellation::stop_if_cancelled;

/// Steps of the differences by which residuals are differentiated, of each unknown.
const STEPS: Unknowns = [1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-5, 1e-3, 1e-3, 1e-6, 1e-4, 1e-4, 1e-4, 1e-6];
/// Most steps of the search, and the change of the sum of squares that ends it.
const MOST_STEPS: usize = 100;
const CONVERGED: f64 = 1e-6;
/// Exponents of the force, shares of the friction that go on after contact and that grow with the speed to start from.
const STARTS: [[f64; 3]; 2] = [[1.0, 0.95, 0.02], [1.8, 0.95, 0.4]];
/// Times over which the step at contact is smeared in turn before it is that of a sample, s: where friction ends there, each
/// sample that it passes is a valley of its own.
const SMEARS: [f64; 2] = [4e-3, 1e-3];
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
    /// The best of searches from each of [`STARTS`], near `start`.
    pub(super) fn find(model: &Model<'_>, start: &Unknowns) -> Option<Fit> {
        let from = |[exponent, goes_on, of_speed]: [f64; 3]| {
            let mut start = *start;
            (start[of::EXPONENT], start[of::GOES_ON], start[of::OF_SPEED]) = (exponent, goes_on, of_speed);
            let smeared = |start, smear| Fit::descend(&Model { smear, ..model.clone() }, start).best;
            Fit::descend(model, SMEARS.into_iter().fold(start, smeared))
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

/// Probability on either side of an interval.
const TAIL: f64 = 0.025;
/// Standard deviations of the inverse time constant below which a sensor may hold a constant.
const MAY_BE_ZERO: f64 = 1.96;
/// Shortest step over which an impact is integrated for a draw, s.
const IMPACT_STEP: f64 = 5e-5;

/// What each input stands for, by the unknowns of a draw.
type Values = fn(&Model<'_>, &Unknowns) -> Vec<f64>;
const INPUTS: [(Input, Values); 7] = [
    (Input::Offset, |_, u| vec![u[of::OFFSET], u[of::DRIFT]]),
    (Input::Coupling, |_, u| vec![u[of::INVERSE]]),
    (Input::Friction, |_, u| vec![u[of::FRICTION], u[of::OF_SPEED], u[of::GOES_ON]]),
    (Input::Height, |model, u| vec![model.height(u)]),
    (Input::Release, |_, u| vec![u[of::RELEASE], u[of::DURATION]]),
    (Input::Onset, |_, u| vec![u[of::LEVEL], u[of::EXPONENT], u[of::BEND]]),
    (Input::Laser, |_, u| vec![u[of::LASER]]),
];

/// What an impact gives with some unknowns.
#[derive(Clone, Copy, Debug)]
struct Impact {
    contact: f64,
    speed: f64,
    travel: f64,
    rebound: f64,
    /// Energies over the mass, m²/s²: largest taken from the impactor, and D.
    absorbed: f64,
    absorption: f64,
}

/// The intervals of 95 % of a recording whose model has this fit; none without draws.
pub(super) fn intervals(
    recorded: &Recorded,
    model: &Model<'_>,
    fit: &Fit,
    draws: &[Unknowns],
    body: Body,
) -> Option<Intervals> {
    let best = Impact::of(recorded, model, &fit.best, body)?;
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let deviation = recorded.noise * fit.colour.sqrt();
    let all: Vec<(&Unknowns, Impact)> = draws
        .iter()
        .filter_map(|draw| {
            let impact = Impact::of(recorded, model, draw, body)?;
            Some((draw, impact.with_noise(deviation, recorded, &mut random)))
        })
        .collect();
    if all.len() < 10 {
        return None;
    }
    let over = |value: &dyn Fn(&Impact) -> f64| ends(all.iter().map(|(_, of)| value(of)).collect(), value(&best));
    let is_given = model.known.inverse.is_some();
    let travels: Vec<f64> = all.iter().map(|(_, of)| of.travel).collect();
    let of_unknown = |place: usize| all.iter().map(|(draw, _)| draw[place]).collect::<Vec<f64>>();
    let share = |(input, values): &(Input, Values)| {
        let drawn: Vec<Vec<f64>> = all.iter().map(|(draw, _)| values(model, draw)).collect();
        let of_place = |place: usize| {
            let values: Vec<f64> = drawn.iter().map(|own| own[place]).collect();
            correlation(&values, &travels).powi(2)
        };
        (*input, (0..drawn[0].len()).map(of_place).fold(0.0, f64::max))
    };
    let widest = INPUTS.iter().map(share).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mass = body.mass;
    let [times, speeds] = [|of: &Impact| of.contact, |of: &Impact| of.speed]
        .map(|value| all.iter().map(|(_, of)| value(of)).collect::<Vec<f64>>());
    let both = covariance(&times, &speeds);
    Some(Intervals {
        contact: [[covariance(&times, &times), both], [both, covariance(&speeds, &speeds)]],
        time_constant: (!is_given).then(|| time_constant(of_unknown(of::INVERSE), fit.best[of::INVERSE])),
        contact_time: over(&|of| of.contact),
        impact_speed: over(&|of| of.speed),
        impact_energy: over(&|of| 0.5 * mass * of.speed * of.speed),
        displacement: over(&|of| of.travel),
        rebound_speed: (best.rebound > 0.0).then(|| over(&|of| of.rebound)),
        absorbed_energy: over(&|of| mass * of.absorbed),
        energy_absorption: Some(over(&|of| of.absorption)),
        widest,
    })
}

/// The interval of a time constant, s; without an upper end where the inverse may be zero.
fn time_constant(inverse: Vec<f64>, best: f64) -> [f64; 2] {
    let may_be_zero = best < MAY_BE_ZERO * covariance(&inverse, &inverse).sqrt();
    let [low, high] = ends(inverse, best);
    [1.0 / high, if may_be_zero { f64::INFINITY } else { 1.0 / low }]
}

/// Ends of the middle 95 % of `values`, at the ranks p (n + 1), that hold the `best` value.
pub(super) fn ends(mut values: Vec<f64>, best: f64) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let rank = (share * (values.len() + 1) as f64 - 1.0).clamp(0.0, (values.len() - 1) as f64);
        let (below, part) = (rank.floor() as usize, rank.fract());
        let above = (below + 1).min(values.len() - 1);
        values[below] + part * (values[above] - values[below])
    };
    [at(TAIL).min(best), at(1.0 - TAIL).max(best)]
}

fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len() as f64;
    let [ma, mb] = [a, b].map(|values| values.iter().sum::<f64>() / count);
    a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>() / (count - 1.0)
}

/// Zero where one of both does not scatter.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let product = (covariance(a, a) * covariance(b, b)).sqrt();
    if product > 0.0 { covariance(a, b) / product } else { 0.0 }
}

impl Impact {
    /// The reading restored with these unknowns and integrated from contact on (trapezoidal rule); none without samples
    /// after it. One loop over the samples, since the next impact, which ends it, shows only in what all figures came to.
    fn of(recorded: &Recorded, model: &Model<'_>, u: &Unknowns, body: Body) -> Option<Impact> {
        let [contact, speed] = model.contact(u);
        let (time, values) = (recorded.reading.time(), recorded.reading.values());
        let step = recorded.step();
        let count = ((IMPACT_STEP / step) as usize).max(1);
        let from = time.partition_point(|t| *t < recorded.release.rest_end);
        let means = time[from..].chunks_exact(count).zip(values[from..].chunks_exact(count)).map(|(t, r)| {
            let mean = |of: &[f64]| of.iter().sum::<f64>() / count as f64;
            let t = mean(t);
            [t, mean(r) - u[of::OFFSET] - u[of::DRIFT] * (t - recorded.start())]
        });
        let mass_energy = |v: f64, z: f64| body.energy(v, z) / body.mass;
        let at_contact = mass_energy(speed, 0.0);
        // Integral of the reading, of equation 41, and the sample before.
        let (mut integral, mut before): (f64, Option<[f64; 2]>) = (0.0, None);
        let mut last: Option<f64> = None;
        let (mut v, mut z) = (-speed, 0.0_f64);
        let mut found =
            Impact { contact, speed, travel: 0.0, rebound: f64::NEG_INFINITY, absorbed: 0.0, absorption: 0.0 };
        let (mut loading, mut unloading) = ([at_contact; 2], [f64::INFINITY, f64::NEG_INFINITY]);
        let mut top = (0.0, unloading, found);
        for [t, r] in means {
            integral += before.map_or(0.0, |[t0, r0]| 0.5 * (r + r0) * (t - t0));
            let a = r + u[of::INVERSE] * integral;
            if t > contact {
                let (h, a0) = match (last, before) {
                    (Some(a0), Some([t0, _])) if t0 > contact => (t - t0, a0),
                    (Some(a0), Some([t0, _])) => (t - contact, a0 + (a - a0) * (contact - t0) / (t - t0)),
                    _ => return None,
                };
                let faster = v + 0.5 * h * (a + a0);
                z += 0.5 * h * (v + faster);
                v = faster;
                // To the next impact: what was seen up to the highest point between them counts.
                let least = -RISES * found.travel;
                if least > 0.0 && top.0 - found.travel > least && top.0 - z > least {
                    (unloading, found) = (top.1, top.2);
                    break;
                }
                let energy = mass_energy(v, z);
                let widened = |span: [f64; 2]| [span[0].min(energy), span[1].max(energy)];
                if z < found.travel {
                    // What came before the lowest point is loading.
                    let before = if unloading[0].is_finite() { unloading } else { [energy; 2] };
                    loading = widened([loading[0].min(before[0]), loading[1].max(before[1])]);
                    (unloading, found.travel, found.rebound) = ([energy; 2], z, f64::NEG_INFINITY);
                } else {
                    unloading = widened(unloading);
                    found.rebound = found.rebound.max(v);
                }
                found.absorbed = found.absorbed.max(at_contact - energy);
                if z == found.travel || z > top.0 {
                    top = (z, unloading, found);
                }
            }
            (last, before) = (Some(a), Some([t, r]));
        }
        (found.travel < 0.0).then(|| {
            found.absorption = 1.0 - (unloading[1] - unloading[0]) / (loading[1] - loading[0]);
            found
        })
    }

    /// With the noise of the readings after contact, which the unknowns do not hold: a sum of n samples `step` apart has
    /// the deviation σ√n of it.
    fn with_noise(self, deviation: f64, recorded: &Recorded, random: &mut ChaCha8Rng) -> Impact {
        let down = (recorded.release.peak - self.contact).max(recorded.step());
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        let of_speed = deviation * (recorded.step() * 2.0 * down).sqrt() * normal();
        let of_place = deviation * (recorded.step() * (1.3 * down).powi(3) / 3.0).sqrt() * normal();
        let relative = (1.0 - self.absorption).max(0.0).sqrt();
        Impact {
            travel: self.travel + of_place,
            rebound: self.rebound + of_speed,
            absorption: self.absorption - 2.0 * relative * of_speed / self.speed,
            ..self
        }
    }
}

/// The least standard deviations that contact (s), speed (m/s), travel (m) and absorption can have by this model (Cramér–Rao
/// bound, with what is known beforehand as information: Van Trees 1968), the noise after contact included.
#[cfg(test)]
pub(super) fn least_deviations(recorded: &Recorded, model: &Model<'_>, fit: &Fit, body: Body) -> Option<[f64; 4]> {
    let bounds = model.bounds();
    let free: Vec<usize> = (0..COUNT).filter(|i| bounds[*i][0] < bounds[*i][1]).collect();
    let information = DMatrix::from_fn(free.len(), free.len(), |a, b| fit.normal[(free[a], free[b])]);
    let least = information.cholesky()?.inverse();
    let figures = |own: &Impact| [own.contact, own.speed, own.travel, own.absorption];
    let slope = |i: &usize| {
        let moved = |by: f64| {
            let mut u = fit.best;
            u[*i] = (u[*i] + by).clamp(bounds[*i][0], bounds[*i][1]);
            Some((u[*i], figures(&Impact::of(recorded, model, &u, body)?)))
        };
        let ((to, above), (from, below)) = (moved(STEPS[*i])?, moved(-STEPS[*i])?);
        Some([0, 1, 2, 3].map(|k| (above[k] - below[k]) / (to - from)))
    };
    let slopes: Vec<[f64; 4]> = free.iter().map(slope).collect::<Option<_>>()?;
    let best = Impact::of(recorded, model, &fit.best, body)?;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let noisy: Vec<[f64; 4]> =
        (0..DRAWS).map(|_| figures(&best.with_noise(recorded.noise, recorded, &mut random))).collect();
    Some([0, 1, 2, 3].map(|k| {
        let slope = DVector::from_iterator(free.len(), slopes.iter().map(|own| own[k]));
        let noisy: Vec<f64> = noisy.iter().map(|own| own[k]).collect();
        ((slope.transpose() * &least * &slope)[0] + covariance(&noisy, &noisy)).sqrt()
    }))
}
