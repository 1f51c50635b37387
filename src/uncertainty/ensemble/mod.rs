//! Samples of a density by ensembles of walkers that are invariant to affine maps (Goodman, Weare 2010), and whether they
//! suffice: R̂ of the walkers and of the halves of the ensembles (Gelman, Rubin 1992), and effective size.
//!
//! Half of the steps stretch towards another walker, half follow the difference of two others (differential evolution,
//! Nelson et al. 2014), which mixes better in more than about ten dimensions. Coordinates that scatter about others take
//! steps of their own, and the others two: one in which they stay where they are, one in which they stay as many
//! deviations from their mean (Yu, Meng 2011; docs/methods.md, section 28).

use thiserror::Error;

use crate::random::Stream;
use crate::statistics::{mean, variance};

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
    /// Walkers of each ensemble, at least twice the coordinates of a step and four; none for four times these and at least 32.
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
    /// The number of walkers is too small.
    #[error("{walkers} walkers for {dimensions} dimensions: at least {} are needed", fewest(*dimensions))]
    Walkers {
        /// Their number.
        walkers: usize,
        /// Coordinates of a step.
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

    /// One coordinate of all points.
    pub fn coordinate(&self, index: usize) -> Vec<f64> {
        self.points.iter().map(|point| point[index]).collect()
    }
}

/// Samples a density by four ensembles that start at successive draws of `start`. The samples follow from the options alone,
/// whatever the number of threads.
///
/// # Errors
/// See [`EnsembleError`].
pub fn sample(
    density: &impl Density,
    mut start: impl FnMut() -> Vec<f64>,
    options: &Options,
) -> Result<Samples, EnsembleError> {
    let all = start().len();
    let blocks = density.blocks();
    let in_block = |place: &usize| blocks.iter().flatten().any(|own| own.place == *place);
    let others: Vec<usize> = (0..all).filter(|place| !in_block(place)).collect();
    let dimensions = blocks.iter().map(Vec::len).chain([others.len()]).max().unwrap_or(0);
    if others.is_empty() {
        return Err(EnsembleError::NoCoordinate);
    }
    let walkers = options.walkers.unwrap_or_else(|| (4 * dimensions).max(32));
    if walkers < fewest(dimensions) {
        return Err(EnsembleError::Walkers { walkers, dimensions });
    }
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

/// Fewest walkers of an ensemble: steps along differences of fewer would stay in a subspace.
fn fewest(dimensions: usize) -> usize {
    (2 * dimensions).max(4)
}

/// So many starts with a density above zero.
fn starts(
    density: &impl Density,
    start: &mut impl FnMut() -> Vec<f64>,
    needed: usize,
) -> Result<Vec<Walker>, EnsembleError> {
    /// Draws for one start that is needed.
    const DRAWS: usize = 100;
    let drawn = (0..DRAWS * needed).filter_map(|_| Walker::at(density, start()));
    let found: Vec<Walker> = drawn.take(needed).collect();
    if found.len() < needed { Err(EnsembleError::Starts { found: found.len(), needed }) } else { Ok(found) }
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
mod tests;
