//! Samples of a density by ensembles of walkers that are invariant to affine maps (Goodman, Weare 2010), and whether they
//! suffice: R̂ of the walkers and of the halves of the ensembles (Gelman, Rubin 1992), and effective size.
//!
//! Half of the steps stretch towards another walker, half follow the difference of two others (differential evolution,
//! Nelson et al. 2014), which mixes better in more than about ten dimensions. Coordinates that scatter about others take
//! steps of their own, and the others two: one in which they stay where they are, one in which they stay as many
//! deviations from their mean (Yu, Meng 2011; docs/methods.md, section 28).

use crate::random::Stream;
use crate::statistics::{mean, variance};
use crate::{Error, ensure};

/// Independent ensembles, which R̂ compares.
const ENSEMBLES: usize = 4;

/// Deviation of the factor of a step along the difference of two walkers, about its mean 2.38/√(2 d).
const DIFFERENCE_SPREAD: f64 = 1e-5;

/// Most steps of each walker whose points are kept: of more, every second, third …
const MOST_KEPT: usize = 1000;

/// Largest R̂ with which samples count as those of the density (Vehtari et al. 2021); R̂ of walkers is so near to one after
/// fifty times their integrated time of autocorrelation.
pub const LARGEST_R_HAT: f64 = 1.01;

/// A density up to a constant. A function that gives the logarithm of one is a density.
pub trait Density: Sync {
    /// Logarithm of the factor that depends on no block; −∞ where the density is zero.
    fn log(&self, state: &[f64]) -> f64;

    /// Coordinates that scatter about others, in blocks that are independent of each other given the rest.
    fn blocks(&self) -> &[Vec<Scattered>] {
        &[]
    }

    /// Logarithm of the factor that depends on the coordinates of one block, and on those of no other.
    fn log_of_block(&self, _block: usize, _state: &[f64]) -> f64 {
        0.0
    }
}

impl<F: Fn(&[f64]) -> f64 + Sync> Density for F {
    fn log(&self, state: &[f64]) -> f64 {
        self(state)
    }
}

/// A coordinate that scatters about another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scattered {
    /// Its place.
    pub place: usize,
    /// Place of what it scatters about.
    pub mean: usize,
    /// Place of the logarithm of its deviation.
    pub deviation: usize,
}

/// How a density is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Steps of each walker, of which the first half is discarded; doubled until R̂ and effective size suffice, each time with the
    /// first half of all discarded.
    pub steps: usize,
    /// Steps that are not exceeded by doubling.
    pub most_steps: usize,
    /// Effective size of every coordinate that is asked for.
    pub effective: f64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { steps: 500, most_steps: 16_000, effective: 1000.0, seed: 0 }
    }
}

/// Samples of a density.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Points, in the order of the ensembles, then of steps, of which not all may be kept, then of walkers.
    pub points: Vec<Vec<f64>>,
    /// R̂ of every coordinate, the larger one of that over all walkers and that over the halves of the ensembles.
    pub r_hat: Vec<f64>,
    /// Effective number of independent samples of every coordinate.
    pub effective: Vec<f64>,
    /// Share of the steps that were accepted.
    pub acceptance: f64,
    /// Steps of each walker.
    pub steps: usize,
}

impl Samples {
    /// Whether R̂ of every coordinate is at most [`LARGEST_R_HAT`].
    pub fn is_converged(&self) -> bool {
        self.r_hat.iter().all(|r_hat| *r_hat <= LARGEST_R_HAT)
    }
}

/// Samples a density by four ensembles that start at successive draws of `start`. The samples follow from the options alone,
/// whatever the number of threads.
///
/// # Errors
/// See [`Error`].
pub fn sample(
    density: &impl Density,
    mut start: impl FnMut() -> Vec<f64>,
    options: &Options,
) -> Result<Samples, Error> {
    let all = start().len();
    let blocks = density.blocks();
    let in_block = |place: &usize| blocks.iter().flatten().any(|own| own.place == *place);
    let others: Vec<usize> = (0..all).filter(|place| !in_block(place)).collect();
    let dimensions = blocks.iter().map(Vec::len).chain([others.len()]).max().unwrap_or(0);
    ensure(!others.is_empty(), || "a density of no coordinates has no samples")?;
    // Steps along differences of fewer than twice the coordinates would stay in a subspace.
    let walkers = (4 * dimensions).max(32);
    let starts = starts(density, &mut start, ENSEMBLES * walkers)?;
    let mut streams = Stream::new(options.seed);
    let ensemble = |walkers: &[Walker]| Ensemble { walkers: walkers.to_vec(), stream: Stream::new(streams.bits()) };
    let mut ensembles: Vec<Ensemble> = starts.chunks(walkers).map(ensemble).collect();
    // The first half of all steps is discarded, so that what doubling adds is what is kept.
    let mut steps = (options.steps / 2).max(4);
    drop(walked(density, &others, &mut ensembles, steps));
    let mut done = steps;
    loop {
        let kept = walked(density, &others, &mut ensembles, steps);
        done += steps;
        let samples = kept.samples(walkers, done);
        let is_enough = samples.is_converged() && samples.effective.iter().all(|size| *size >= options.effective);
        if is_enough || 2 * done > options.most_steps {
            return Ok(samples);
        }
        steps = done;
    }
}

/// So many starts with a density above zero.
fn starts(density: &impl Density, start: &mut impl FnMut() -> Vec<f64>, needed: usize) -> Result<Vec<Walker>, Error> {
    /// Draws for one start that is needed.
    const DRAWS: usize = 100;
    let drawn = (0..DRAWS * needed).filter_map(|_| Walker::at(density, start()));
    let found: Vec<Walker> = drawn.take(needed).collect();
    let count = found.len();
    ensure(count == needed, || format!("{count} of {needed} starts of walkers have a density above zero"))?;
    Ok(found)
}

/// Where a walker is, and the logarithms of the factors of the density there: that of no block, and of each block.
#[derive(Clone)]
struct Walker {
    state: Vec<f64>,
    factors: Vec<f64>,
}

impl Walker {
    /// A walker at a state; none where the density is zero.
    fn at(density: &impl Density, state: Vec<f64>) -> Option<Walker> {
        let mut factors = vec![density.log(&state)];
        for block in 0..density.blocks().len() {
            if factors[block].is_nan() || factors[block] == f64::NEG_INFINITY {
                return None;
            }
            factors.push(density.log_of_block(block, &state));
        }
        factors.iter().all(|factor| *factor > f64::NEG_INFINITY).then_some(Walker { state, factors })
    }
}

/// Walkers that take their steps from each other.
struct Ensemble {
    walkers: Vec<Walker>,
    stream: Stream,
}

impl Ensemble {
    /// A step of every walker, one after the other: how many were accepted, and of how many.
    fn step(&mut self, density: &impl Density, others: &[usize]) -> [usize; 2] {
        let mut counts = [0; 2];
        let blocks = density.blocks();
        let mut count = |is_accepted: bool| {
            counts[0] += usize::from(is_accepted);
            counts[1] += 1;
        };
        for own in 0..self.walkers.len() {
            count(self.step_of_others(own, density, others, false));
            if !blocks.is_empty() {
                count(self.step_of_others(own, density, others, true));
            }
            for (block, places) in blocks.iter().enumerate() {
                count(self.step_of_block(own, density, block, places));
            }
        }
        counts
    }

    /// A step of what is in no block; blocks stay where they are, or as many deviations from their mean.
    fn step_of_others(&mut self, own: usize, density: &impl Density, others: &[usize], follows: bool) -> bool {
        let [one, two] = self.partners(own);
        let [from, one, two] = [own, one, two].map(|walker| self.walkers[walker].state.as_slice());
        let (mut state, mut factor) = proposed(from, [one, two], others, &mut self.stream);
        if follows {
            for own in density.blocks().iter().flatten() {
                let ratio = state[own.deviation] - from[own.deviation];
                state[own.place] = state[own.mean] + (from[own.place] - from[own.mean]) * libm::exp(ratio);
                // What the volume of the blocks grows by.
                factor += ratio;
            }
        }
        let Some(next) = Walker::at(density, state) else { return false };
        self.accept(own, next, factor)
    }

    /// A step of a block, as far as another walker's differs from where that one is, or in deviations from its mean.
    fn step_of_block(&mut self, own: usize, density: &impl Density, block: usize, places: &[Scattered]) -> bool {
        let partners = self.partners(own);
        let is_scaled = self.stream.uniform() < 0.5;
        let from = &self.walkers[own];
        let seen = |walker: usize| {
            let mut state = self.walkers[walker].state.clone();
            for own in places.iter().filter(|_| is_scaled) {
                let deviations = (state[own.place] - state[own.mean]) / libm::exp(state[own.deviation]);
                state[own.place] = from.state[own.mean] + deviations * libm::exp(from.state[own.deviation]);
            }
            state
        };
        let [one, two] = partners.map(seen);
        let moved: Vec<usize> = places.iter().map(|own| own.place).collect();
        let (state, factor) = proposed(&from.state, [&one, &two], &moved, &mut self.stream);
        let mut factors = from.factors.clone();
        factors[block + 1] = density.log_of_block(block, &state);
        self.accept(own, Walker { state, factors }, factor)
    }

    /// Two other walkers.
    fn partners(&mut self, own: usize) -> [usize; 2] {
        let count = self.walkers.len();
        let one = (own + 1 + self.stream.below(count - 1)) % count;
        let two = (own + 1 + self.stream.below(count - 1)) % count;
        if one == two { self.partners(own) } else { [one, two] }
    }

    /// Moves a walker there with the probability of Metropolis; `factor` is the logarithm of what proposals differ by.
    fn accept(&mut self, own: usize, next: Walker, factor: f64) -> bool {
        let [now, then] = [&self.walkers[own], &next].map(|walker| walker.factors.iter().sum::<f64>());
        // A comparison with no number is false.
        let is_accepted = then - now + factor >= libm::log(self.stream.uniform());
        if is_accepted {
            self.walkers[own] = next;
        }
        is_accepted
    }
}

/// A state with other coordinates at these places, and the logarithm of the factor that makes up for the way there.
fn proposed(own: &[f64], [one, two]: [&[f64]; 2], places: &[usize], stream: &mut Stream) -> (Vec<f64>, f64) {
    let mut state = own.to_vec();
    let count = places.len() as f64;
    if stream.uniform() < 0.5 {
        // Density of the factor ∝ 1/√z between 1/2 and 2.
        let z = 0.5 * (1.0 + stream.uniform()).powi(2);
        places.iter().for_each(|place| state[*place] = one[*place] + z * (own[*place] - one[*place]));
        (state, (count - 1.0) * libm::log(z))
    } else {
        let factor = 2.38 / (2.0 * count).sqrt() * (1.0 + DIFFERENCE_SPREAD * stream.normal());
        places.iter().for_each(|place| state[*place] += factor * (one[*place] - two[*place]));
        (state, 0.0)
    }
}

/// What is kept of some steps.
struct Kept {
    /// Points of each ensemble: of all its walkers, every so many steps.
    chains: Vec<Vec<Vec<f64>>>,
    /// Share of the steps that were accepted.
    acceptance: f64,
}

/// So many steps on, each ensemble in a thread; at most [`MOST_KEPT`] of them are kept, evenly.
fn walked(density: &impl Density, others: &[usize], ensembles: &mut [Ensemble], steps: usize) -> Kept {
    let every = steps.div_ceil(MOST_KEPT);
    let walk = |ensemble: &mut Ensemble| {
        let (mut points, mut counts) = (Vec::new(), [0; 2]);
        for step in 1..=steps {
            let [accepted, all] = ensemble.step(density, others);
            counts = [counts[0] + accepted, counts[1] + all];
            if step % every == 0 {
                points.extend(ensemble.walkers.iter().map(|walker| walker.state.clone()));
            }
        }
        (points, counts)
    };
    let found: Vec<(Vec<Vec<f64>>, [usize; 2])> = std::thread::scope(|scope| {
        let threads: Vec<_> = ensembles.iter_mut().map(|own| scope.spawn(|| walk(own))).collect();
        let joined = threads.into_iter().map(|own| own.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        joined.collect()
    });
    let [accepted, all] = [0, 1].map(|which| found.iter().map(|(_, counts)| counts[which]).sum::<usize>() as f64);
    Kept { chains: found.into_iter().map(|(points, _)| points).collect(), acceptance: accepted / all }
}

impl Kept {
    fn samples(self, walkers: usize, steps: usize) -> Samples {
        let dimensions = self.chains[0][0].len();
        let known = (0..dimensions).map(|index| {
            let of = |chain: &Vec<Vec<f64>>| chain.iter().map(|point| point[index]).collect::<Vec<f64>>();
            known(&self.chains.iter().map(of).collect::<Vec<_>>(), walkers)
        });
        let (r_hat, effective) = known.map(|[r_hat, effective]| (r_hat, effective)).unzip();
        let acceptance = self.acceptance;
        Samples { points: self.chains.into_iter().flatten().collect(), r_hat, effective, acceptance, steps }
    }
}

/// R̂ and effective size of a coordinate, by the chains of ensembles, whose points are `walkers` a step.
///
/// Each walker is a chain of its own: the variance of their means over that within is the integrated time of
/// autocorrelation of a walker over its steps (batch means), whatever the walkers have from their starts. Walkers of an
/// ensemble may move together, which the halves of ensembles show.
fn known(chains: &[Vec<f64>], walkers: usize) -> [f64; 2] {
    let of_walker = |chain: &[f64], walker: usize| chain.iter().skip(walker).step_by(walkers).copied().collect();
    let single: Vec<Vec<f64>> =
        chains.iter().flat_map(|chain| (0..walkers).map(|walker| of_walker(chain, walker))).collect();
    let halves: Vec<Vec<f64>> = chains
        .iter()
        .flat_map(|chain| {
            let (first, second) = chain.split_at(chain.len() / walkers / 2 * walkers);
            [first.to_vec(), second.to_vec()]
        })
        .collect();
    let between = between_over_within(&single);
    let effective = if between > 0.0 { (single.len() as f64 / between).min(chains.concat().len() as f64) } else { 0.0 };
    [(1.0 + between.max(between_over_within(&halves))).sqrt(), effective]
}

/// The variance of the means of chains over the mean variance within them; infinite where nothing moves.
fn between_over_within(chains: &[Vec<f64>]) -> f64 {
    let of =
        |reduce: fn(&[f64]) -> Option<f64>| -> Option<Vec<f64>> { chains.iter().map(|chain| reduce(chain)).collect() };
    let found = || {
        let within = mean(&of(variance)?)?;
        let between = variance(&of(mean)?)?;
        // Means of the same number again differ by its rounding.
        (within > f64::EPSILON * between).then(|| between / within)
    };
    found().unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::statistics::{deviation, quantiles};

    /// One coordinate of all points.
    fn coordinate(samples: &Samples, index: usize) -> Vec<f64> {
        samples.points.iter().map(|point| point[index]).collect()
    }

    fn about(centre: &[f64], spread: f64) -> impl FnMut() -> Vec<f64> {
        let (centre, mut stream) = (centre.to_vec(), Stream::new(1));
        move || centre.iter().map(|x| x + spread * stream.normal()).collect()
    }

    /// Mean and covariance of a normal density in three dimensions whose directions differ by a thousand.
    #[test]
    fn a_normal_density_has_its_mean_deviations_and_correlation() {
        let (deviations, correlation) = ([1.0, 1e3, 1e-3], 0.95_f64);
        let density = |x: &[f64]| {
            let [a, b, c] = [x[0] / deviations[0], (x[1] - 5.0) / deviations[1], x[2] / deviations[2]];
            let tied = (b - correlation * a).powi(2) / (1.0 - correlation * correlation);
            -0.5 * (a * a + tied + c * c)
        };
        let found =
            sample(&density, about(&[0.0, 5.0, 0.0], 1e-3), &Options { effective: 4000.0, ..Options::default() });
        let found = found.unwrap();
        assert!(found.is_converged() && found.effective.iter().all(|size| *size > 4000.0), "{:?}", found.r_hat);
        for (index, expected) in deviations.iter().enumerate() {
            let own = coordinate(&found, index);
            let [ratio, shift] =
                [deviation(&own).unwrap() / expected, (mean(&own).unwrap() - [0.0, 5.0, 0.0][index]) / expected];
            // Four standard errors of 4000 independent samples.
            let is_near = (ratio - 1.0).abs() < 4.0 / 8000_f64.sqrt() && shift.abs() < 4.0 / 4000_f64.sqrt();
            assert!(is_near, "{ratio} {shift}");
        }
        let both = found.points.iter().map(|x| x[0] * (x[1] - 5.0) / 1e3).sum::<f64>() / found.points.len() as f64;
        assert!((both - correlation).abs() < 0.07, "{both}");
    }

    /// Rosenbrock's density exp(−(a − x)²/2 − b (y − x²)²/2): x is normal about a, y about x² (Pagani, Wiegand, Nadarajah
    /// 2022), so that E[y] = a² + 1 and var(y) = 4 a² + 2 + 1/b.
    #[test]
    fn rosenbrock_s_banana_has_its_closed_moments() {
        let (a, b) = (1.0, 20.0);
        let density = |x: &[f64]| -0.5 * (a - x[0]).powi(2) - 0.5 * b * (x[1] - x[0] * x[0]).powi(2);
        let options = Options { effective: 3000.0, most_steps: 64_000, ..Options::default() };
        let found = sample(&density, about(&[1.0, 1.0], 0.3), &options).unwrap();
        assert!(found.is_converged(), "{:?} {:?}", found.r_hat, found.effective);
        let (x, y) = (coordinate(&found, 0), coordinate(&found, 1));
        assert!((mean(&x).unwrap() - a).abs() < 0.1 && (deviation(&x).unwrap() - 1.0).abs() < 0.07);
        let (expected, spread) = (a * a + 1.0, (4.0 * a * a + 2.0 + 1.0 / b).sqrt());
        assert!((mean(&y).unwrap() - expected).abs() < 5.0 * spread / 3000_f64.sqrt(), "{:?}", mean(&y));
        assert!((deviation(&y).unwrap() / spread - 1.0).abs() < 0.12, "{:?} for {spread}", deviation(&y));
    }

    /// Two normal densities three deviations from zero, of which the right one has three quarters.
    #[test]
    fn both_modes_of_a_density_have_their_shares() {
        let normal = |x: f64, centre: f64| (-0.5 * (x - centre).powi(2)).exp();
        let density = |x: &[f64]| (0.25 * normal(x[0], -3.0) + 0.75 * normal(x[0], 3.0)).ln() - 0.5 * x[1] * x[1];
        let options = Options { effective: 2000.0, most_steps: 32_000, ..Options::default() };
        let found = sample(&density, about(&[0.0, 0.0], 3.0), &options).unwrap();
        assert!(found.is_converged(), "{:?}", found.r_hat);
        let right = found.points.iter().filter(|x| x[0] > 0.0).count() as f64 / found.points.len() as f64;
        assert!((right - 0.75).abs() < 0.05, "{right}");
        let ends = quantiles(&coordinate(&found, 0), &[0.025, 0.975]).unwrap();
        assert!((ends[0] + 4.28).abs() < 0.3 && (ends[1] - 4.83).abs() < 0.3, "{ends:?}");
    }

    /// Walkers that start in one of two modes far apart stay there, and R̂ says so.
    #[test]
    fn modes_that_no_walker_crosses_are_not_converged() {
        let density = |x: &[f64]| (-0.5 * (x[0].abs() - 40.0).powi(2)) - 0.5 * x[1] * x[1];
        let mut number = 0;
        let start = || {
            number += 1;
            let mut stream = Stream::new(number);
            // The first ensemble, 32 walkers and the draw that counts the dimensions, on the left.
            let side = if number <= 33 { -40.0 } else { 40.0 };
            vec![side + stream.normal(), stream.normal()]
        };
        let found = sample(&density, start, &Options { most_steps: 1000, ..Options::default() }).unwrap();
        assert!(!found.is_converged() && found.r_hat[0] > 2.0, "{:?}", found.r_hat);
    }

    #[test]
    fn a_seed_gives_the_same_samples_and_another_others() {
        let density = |x: &[f64]| -0.5 * x[0] * x[0];
        let of = |seed| {
            sample(&density, about(&[0.0], 1.0), &Options { seed, steps: 50, most_steps: 50, ..Options::default() })
        };
        assert_eq!(of(1).unwrap(), of(1).unwrap());
        assert_ne!(of(1).unwrap().points, of(2).unwrap().points);
    }

    #[test]
    fn what_cannot_be_sampled_is_said() {
        let density = |x: &[f64]| if x[0] > 100.0 { 0.0 } else { f64::NEG_INFINITY };
        let nowhere = sample(&density, about(&[0.0], 1.0), &Options::default()).unwrap_err();
        assert_eq!(nowhere, Error::new("0 of 128 starts of walkers have a density above zero"));
        let flat = |_: &[f64]| 0.0;
        let empty = sample(&flat, Vec::new, &Options::default()).unwrap_err();
        assert_eq!(empty, Error::new("a density of no coordinates has no samples"));
    }

    /// 88 walkers of four ensembles that never leave a good draw of the density, and walkers that leave it every thousandth step.
    #[test]
    fn walkers_that_hardly_move_are_no_samples() {
        let (walkers, steps) = (88, 1000);
        let mut stream = Stream::new(4);
        for leaves in [0.0, 1e-3] {
            let mut chain = || {
                let mut at: Vec<f64> = (0..walkers).map(|_| stream.normal()).collect();
                let mut chain = Vec::new();
                for _ in 0..steps {
                    for x in &mut at {
                        *x = if stream.uniform() < leaves { stream.normal() } else { *x };
                    }
                    chain.extend_from_slice(&at);
                }
                chain
            };
            let chains: Vec<Vec<f64>> = (0..4).map(|_| chain()).collect();
            let [r_hat, effective] = known(&chains, walkers);
            // A walker that leaves with the probability p has an integrated time of 2/p: two thirds of a sample each at most.
            assert!(r_hat > 1.3 && effective < 4.0 * 88.0 * 1.5, "{r_hat} {effective}");
            assert!(leaves > 0.0 || (r_hat.is_infinite() && effective == 0.0), "{r_hat} {effective}");
        }
    }

    /// A long, thin banana, x of which is normal about a: walks that are too short count as not converged, and their means scatter as
    /// those of so many independent samples as are reported.
    #[test]
    fn a_banana_that_mixes_slowly_is_not_converged_before_it_is() {
        const WALKS: u64 = 16;
        let (a, b) = (1.0, 200.0);
        let density = |x: &[f64]| -0.5 * (a - x[0]).powi(2) - 0.5 * b * (x[1] - x[0] * x[0]).powi(2);
        let squares = (0..WALKS).map(|seed| {
            let options = Options { steps: 2000, most_steps: 2000, seed, ..Options::default() };
            let mut draws = Stream::new(100 + seed);
            let start = || {
                let x = a + draws.normal();
                vec![x, x * x + draws.normal() / b.sqrt()]
            };
            let found = sample(&density, start, &options).unwrap();
            assert!(!found.is_converged(), "{:?} {:?}", found.r_hat, found.effective);
            found.effective[0] * (mean(&coordinate(&found, 0)).unwrap() - a).powi(2)
        });
        let off = (squares.sum::<f64>() / WALKS as f64).sqrt();
        println!("means of {WALKS} short walks are off by {off} of what their effective sizes say");
        assert!((0.6..1.5).contains(&off), "{off}");
    }

    /// Specimens that are known to a width each, with a half-normal deviation over them.
    struct Specimens {
        measured: Vec<f64>,
        width: f64,
        expected: f64,
        blocks: Vec<Vec<Scattered>>,
    }

    impl Specimens {
        fn new(measured: Vec<f64>, width: f64, expected: f64) -> Specimens {
            let block = |specimen: usize| vec![Scattered { place: 2 + specimen, mean: 0, deviation: 1 }];
            let blocks = (0..measured.len()).map(block).collect();
            Specimens { measured, width, expected, blocks }
        }

        /// Quantiles of the deviation by quadrature: with mean and specimens integrated out,
        /// p(τ) ∝ exp(−τ²/2τ₀²) (w² + τ²)^(−(n−1)/2) exp(−Σ(y − ȳ)²/2(w² + τ²)).
        fn quantiles(&self, of: &[f64]) -> Vec<f64> {
            let count = self.measured.len() as f64;
            let centre = mean(&self.measured).unwrap();
            let squares: f64 = self.measured.iter().map(|y| (y - centre).powi(2)).sum();
            let density = |tau: f64| {
                let whole = self.width * self.width + tau * tau;
                (-0.5 * (tau / self.expected).powi(2) - 0.5 * (count - 1.0) * whole.ln() - 0.5 * squares / whole).exp()
            };
            let step = 2e-5 * self.expected;
            let values: Vec<f64> = (0..250_000).map(|at| density((f64::from(at) + 0.5) * step)).collect();
            let all: f64 = values.iter().sum();
            let at = |share: &f64| {
                let mut sum = 0.0;
                let place = values.iter().position(|value| {
                    sum += value / all;
                    sum >= *share
                });
                place.unwrap() as f64 * step
            };
            of.iter().map(at).collect()
        }
    }

    impl Density for Specimens {
        fn log(&self, state: &[f64]) -> f64 {
            state[1] - 0.5 * (state[1].exp() / self.expected).powi(2)
        }

        fn blocks(&self) -> &[Vec<Scattered>] {
            &self.blocks
        }

        fn log_of_block(&self, block: usize, state: &[f64]) -> f64 {
            let x = state[2 + block];
            let from_mean = (x - state[0]) / state[1].exp();
            -0.5 * (from_mean * from_mean + ((x - self.measured[block]) / self.width).powi(2)) - state[1]
        }
    }

    /// A hierarchy against quadrature: without scatter, where its deviation is small against the width of every test (the neck), with
    /// ten times as much scatter as that width, and with as much.
    #[test]
    fn the_deviation_of_a_hierarchy_has_the_quantiles_of_quadrature() {
        let mut stream = Stream::new(8);
        for (count, scatter) in thorough::first(2, [(10, 0.0), (10, 0.5), (10, 0.05), (40, 0.0)]) {
            let target = Specimens::new((0..count).map(|_| scatter * stream.normal()).collect(), 0.05, 0.3);
            let mut draws = Stream::new(1);
            let start = || {
                let mut state = vec![0.02 * draws.normal(), -2.5 + 0.3 * draws.normal()];
                state.extend(target.measured.iter().map(|y| y + 0.05 * draws.normal()));
                state
            };
            let found = sample(&target, start, &Options { effective: 4000.0, seed: 5, ..Options::default() }).unwrap();
            assert!(found.is_converged(), "{:?}", found.r_hat);
            let deviations: Vec<f64> = coordinate(&found, 1).iter().map(|x| x.exp()).collect();
            let at = [0.025, 0.25, 0.5, 0.975];
            let (own, exact) = (quantiles(&deviations, &at).unwrap(), target.quantiles(&at));
            println!("{count} specimens, scatter {scatter}: {own:.4?} for {exact:.4?}, {} steps", found.steps);
            let width = exact[3] - exact[0];
            for (own, exact) in own.iter().zip(&exact) {
                assert!((own - exact).abs() < 0.04 * width, "{count} {scatter}: {own} for {exact}");
            }
            assert!(scatter > 0.1 || (own[0] / exact[0] - 1.0).abs() < 0.35, "{own:?} for {exact:?}");
        }
    }
}
