//! Samples of a density by ensembles of walkers that are invariant to affine maps (Goodman, Weare 2010), and whether they
//! suffice: R̂ of split chains (Gelman, Rubin 1992; Vehtari et al. 2021) and effective size (Sokal 1997).
//!
//! Half of the steps stretch towards another walker, half follow the difference of two others (differential evolution,
//! Nelson et al. 2014), which mixes better in more than about ten dimensions.

use hammer_and_sample::{DifferentialEvolution, MinChainLen, Mixture, Model, Serial, Stretch, sample as run};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use thiserror::Error;

use crate::statistics::{mean, variance};

/// Independent ensembles, which R̂ compares.
const ENSEMBLES: usize = 4;

/// Deviation of the factor of a step along the difference of two walkers, about its mean 2.38/√(2 d).
const DIFFERENCE_SPREAD: f64 = 1e-5;

/// Most steps of each walker whose points are kept: of more, every second, third …
const MOST_KEPT: usize = 1000;
/// Steps of each walker whose points are in memory at once.
const PIECE: usize = 250;

/// Largest R̂ with which samples count as those of the density (Vehtari et al. 2021).
pub const LARGEST_R_HAT: f64 = 1.01;

/// How a density is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Walkers of each ensemble, even, at least twice the dimensions and four; none for four times the dimensions and at least
    /// 32.
    pub walkers: Option<usize>,
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
        Self { walkers: None, steps: 500, most_steps: 16_000, effective: 1000.0, seed: 0 }
    }
}

/// Why a density is not sampled.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EnsembleError {
    /// The number of walkers is odd or too small.
    #[error("{walkers} walkers for {dimensions} dimensions: an even number of at least {} is needed", fewest(*dimensions))]
    Walkers {
        /// Their number.
        walkers: usize,
        /// Coordinates of the density.
        dimensions: usize,
    },
    /// There are too few starts with a density.
    #[error("{found} of {needed} starts of walkers have a density above zero")]
    Starts {
        /// Starts with a finite logarithm of the density.
        found: usize,
        /// Starts that are needed.
        needed: usize,
    },
    /// A density has no coordinate.
    #[error("a density of no coordinates has no samples")]
    NoCoordinate,
}

/// Samples of a density.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Points, in the order of the ensembles, then of steps, of which not all may be kept, then of walkers.
    pub points: Vec<Vec<f64>>,
    /// R̂ of every coordinate over the halves of the ensembles' chains.
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

    /// One coordinate of all points.
    pub fn coordinate(&self, index: usize) -> Vec<f64> {
        self.points.iter().map(|point| point[index]).collect()
    }
}

/// The logarithm of a density; −∞ where it is zero.
struct Density<'a, F>(&'a F);

impl<F: Fn(&[f64]) -> f64 + Sync> Model for Density<'_, F> {
    type Params = Vec<f64>;

    fn log_prob(&self, state: &Vec<f64>) -> f64 {
        let found = (self.0)(state);
        if found.is_nan() { f64::NEG_INFINITY } else { found }
    }
}

/// Samples `log_density`, the logarithm of a density up to a constant, by four ensembles that start at successive draws
/// of `start`. The samples follow from the options alone, whatever the number of threads.
///
/// # Errors
/// See [`EnsembleError`].
pub fn sample(
    log_density: &(impl Fn(&[f64]) -> f64 + Sync),
    mut start: impl FnMut() -> Vec<f64>,
    options: &Options,
) -> Result<Samples, EnsembleError> {
    let dimensions = start().len();
    if dimensions == 0 {
        return Err(EnsembleError::NoCoordinate);
    }
    let walkers = options.walkers.unwrap_or_else(|| (4 * dimensions).max(32));
    if !walkers.is_multiple_of(2) || walkers < fewest(dimensions) {
        return Err(EnsembleError::Walkers { walkers, dimensions });
    }
    let starts = starts(log_density, &mut start, ENSEMBLES * walkers)?;
    let mut walk = Walk { log_density, walkers, seed: options.seed, at: starts, done: 0 };
    // The first half of all steps is discarded, so that what doubling adds is what is kept.
    let mut steps = (options.steps / 2).max(4);
    walk.on(steps);
    loop {
        let kept = walk.on(steps);
        let samples = kept.samples(walk.walkers, walk.done);
        let is_enough = samples.is_converged() && samples.effective.iter().all(|size| *size >= options.effective);
        if is_enough || 2 * walk.done > options.most_steps {
            return Ok(samples);
        }
        steps = walk.done;
    }
}

/// Fewest walkers of an ensemble: a step along the difference of two needs two others in its half.
fn fewest(dimensions: usize) -> usize {
    (2 * dimensions).max(4)
}

/// So many starts with a density above zero.
fn starts(
    log_density: &impl Fn(&[f64]) -> f64,
    start: &mut impl FnMut() -> Vec<f64>,
    needed: usize,
) -> Result<Vec<Vec<f64>>, EnsembleError> {
    /// Draws for one start that is needed.
    const DRAWS: usize = 100;
    let drawn = (0..DRAWS * needed).map(|_| start()).filter(|point| log_density(point).is_finite());
    let found: Vec<Vec<f64>> = drawn.take(needed).collect();
    if found.len() < needed { Err(EnsembleError::Starts { found: found.len(), needed }) } else { Ok(found) }
}

/// Ensembles on their way.
struct Walk<'a, F> {
    log_density: &'a F,
    /// Walkers of each ensemble.
    walkers: usize,
    seed: u64,
    /// Where the walkers of all ensembles are.
    at: Vec<Vec<f64>>,
    /// Steps that each has taken.
    done: usize,
}

/// Steps of one ensemble.
struct Steps {
    /// Points that are kept.
    kept: Vec<Vec<f64>>,
    /// Where its walkers are in the end.
    at: Vec<Vec<f64>>,
    /// How many steps were accepted.
    accepted: usize,
}

/// What is kept of some steps.
struct Kept {
    /// Points of each ensemble: of all its walkers, every so many steps.
    chains: Vec<Vec<Vec<f64>>>,
    /// Share of the steps that were accepted.
    acceptance: f64,
}

impl<F: Fn(&[f64]) -> f64 + Sync> Walk<'_, F> {
    /// So many steps on, each ensemble in a thread; at most [`MOST_KEPT`] of them are kept, evenly.
    fn on(&mut self, steps: usize) -> Kept {
        let every = steps.div_ceil(MOST_KEPT);
        let (walk, count) = (&*self, self.walkers);
        let found: Vec<Steps> = std::thread::scope(|scope| {
            let threads: Vec<_> = self
                .at
                .chunks(count)
                .enumerate()
                .map(|(number, at)| scope.spawn(move || walk.ensemble(number, at.to_vec(), steps, every)))
                .collect();
            threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
                .collect()
        });
        let accepted: usize = found.iter().map(|steps| steps.accepted).sum();
        let acceptance = accepted as f64 / (ENSEMBLES * count * steps) as f64;
        let (mut chains, mut at) = (Vec::new(), Vec::new());
        for steps in found {
            chains.push(steps.kept);
            at.extend(steps.at);
        }
        (self.at, self.done) = (at, self.done + steps);
        Kept { chains, acceptance }
    }

    /// So many steps of an ensemble, of which each of so many is kept.
    fn ensemble(&self, number: usize, mut at: Vec<Vec<f64>>, steps: usize, every: usize) -> Steps {
        let count = self.walkers;
        let factor = 2.38 / (2.0 * at[0].len() as f64).sqrt();
        let moves =
            Mixture::from(((Stretch::default(), 1), (DifferentialEvolution::new(factor, DIFFERENCE_SPREAD), 1)));
        let (mut kept, mut accepted, mut done) = (Vec::new(), 0, 0);
        while done < steps {
            // A few steps at a time, since all points of them are in memory.
            let piece = (every * PIECE.div_ceil(every)).min(steps - done);
            let generator = |walker: usize| {
                let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
                // Steps before this one, so that each piece has random numbers of its own.
                generator.set_stream(((self.done + done) * ENSEMBLES * count + number * count + walker) as u64);
                generator
            };
            let start = at.into_iter().enumerate().map(|(walker, start)| (start, generator(walker)));
            let (mut points, own) = run(&Density(self.log_density), &moves, start, MinChainLen(count * piece), Serial);
            accepted += own;
            at = points[points.len() - count..].to_vec();
            if every == 1 {
                kept.append(&mut points);
            } else {
                let of_step = |step: usize| step % every == every - 1;
                kept.extend(
                    points
                        .chunks(count)
                        .enumerate()
                        .filter(|(step, _)| of_step(*step))
                        .flat_map(|(_, own)| own.to_vec()),
                );
            }
            done += piece;
        }
        Steps { kept, at, accepted }
    }
}

impl Kept {
    fn samples(self, walkers: usize, steps: usize) -> Samples {
        let dimensions = self.chains[0][0].len();
        let of = |index: usize| -> Vec<Vec<f64>> {
            self.chains.iter().map(|chain| chain.iter().map(|point| point[index]).collect()).collect()
        };
        let r_hat = (0..dimensions).map(|index| r_hat(&of(index), walkers)).collect();
        let effective = (0..dimensions).map(|index| effective_size(&of(index), walkers)).collect();
        let acceptance = self.acceptance;
        Samples { points: self.chains.into_iter().flatten().collect(), r_hat, effective, acceptance, steps }
    }
}

/// R̂ over the halves of chains whose points are `walkers` a step.
fn r_hat(chains: &[Vec<f64>], walkers: usize) -> f64 {
    let halves: Vec<&[f64]> = chains
        .iter()
        .flat_map(|chain| {
            let middle = chain.len() / walkers / 2 * walkers;
            [&chain[..middle], &chain[middle..]]
        })
        .collect();
    let of =
        |reduce: fn(&[f64]) -> Option<f64>| -> Option<Vec<f64>> { halves.iter().map(|half| reduce(half)).collect() };
    let found = || {
        let within = mean(&of(variance)?)?;
        let between = variance(&of(mean)?)?;
        (within > 0.0).then(|| (1.0 + between / within).sqrt())
    };
    found().unwrap_or(f64::INFINITY)
}

/// Samples over the time of their autocorrelation, whose covariances are the means of all walkers; the sum ends at five
/// times that time (Sokal 1997).
fn effective_size(chains: &[Vec<f64>], walkers: usize) -> f64 {
    /// Times of autocorrelation after which the sum of correlations ends.
    const WINDOW: f64 = 5.0;
    /// Length of a chain over the longest lag that counts.
    const SHORTEST: usize = 4;
    let all: Vec<f64> = chains.concat();
    let (Some(mean), Some(variance)) = (mean(&all), variance(&all)) else { return 0.0 };
    let steps = chains.iter().map(|chain| chain.len() / walkers).min().unwrap_or(0);
    let correlation = |lag: usize| {
        let (mut sum, mut count) = (0.0, 0_usize);
        for chain in chains {
            for place in 0..chain.len() - lag * walkers {
                sum += (chain[place] - mean) * (chain[place + lag * walkers] - mean);
            }
            count += chain.len() - lag * walkers;
        }
        sum / count as f64 / variance
    };
    let mut time = 1.0;
    // Correlations of chains that mix so slowly are noise farther out, and cost a pass over the chains each; R̂ tells of such chains.
    for lag in 1..steps / SHORTEST {
        time += 2.0 * correlation(lag);
        if lag as f64 >= WINDOW * time {
            break;
        }
    }
    all.len() as f64 / time.max(1.0)
}

#[cfg(test)]
mod tests;
