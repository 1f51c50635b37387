//! What the recordings of a test may differ by from the simulated signal of a true parameter: noise of the sensor, roughness of
//! the simulation, and an error of the model, a process along the signal that all recordings have in common (docs/theory.md,
//! section 28).
//!
//! Signals are compared by their means over bins, so that noise that is faster than a bin counts once. In the
//! eigenvectors of the covariance of the model's error over the noise, both are independent whatever the size of the error.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use base::number::significant;
use lab::signal::Series;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use thiserror::Error;

/// Most bins of a signal.
const MOST_BINS: usize = 120;
/// Fewest bins of a signal.
const FEWEST_BINS: usize = 8;
/// Memory of the channel filter, times its class: the backward pass forgets as exp(−9.26 class t), so that the noise of
/// bins of twice that time is independent.
const FILTER_MEMORY: f64 = 2.0 / 9.26;
/// Samples of the shortest bins, of which neighbours share one.
const SAMPLES: usize = 4;
/// Least noise, as a share of the root mean square of the signal: what steps of the engine and of a table leave.
const LEAST_NOISE: f64 = 1e-4;
/// Least part of the noise that a recording shows which is not the roughness of the model's error.
const LEAST_VARIANCE: f64 = 0.02;
/// Variance of the third difference of independent values of unit variance: 1 + 9 + 9 + 1.
const OF_THIRD_DIFFERENCE: f64 = 20.0;

/// The noise of a measured signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Noise {
    /// As the third differences of means over the shortest bins show it whose noise is independent: an error of the model that
    /// is correlated over many of them, and the signal itself, hardly add to that.
    FromRecording,
    /// This standard deviation of the mean of a bin, as a share of the root mean square of the signal.
    Share(f64),
}

/// The distance over which the model's error is correlated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Correlation {
    /// Along the abscissa.
    Length(f64),
    /// As a share of the window.
    Share(f64),
}

/// Shares of the window over which an error may be correlated where no length is given (assumed): from a bin or two to what a
/// scale and a slope of the signal can hardly be told from.
const LENGTHS: [f64; 8] = [0.02, 0.0325, 0.053, 0.086, 0.14, 0.228, 0.37, 0.6];

/// The shape of the model's error along a signal: a process with Matérn's correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Twice Matérn's ν: 1 (exponential), 3 (once differentiable), 5 (twice), or 0 for any number of times (squared exponential).
    order: u8,
    length: Correlation,
}

impl Shape {
    /// The shapes that count beside each other with this length, or with any.
    pub(super) fn all(length: Option<Correlation>) -> Vec<Shape> {
        let lengths = length.map_or_else(|| LENGTHS.map(Correlation::Share).to_vec(), |own| vec![own]);
        [1, 3, 5, 0]
            .into_iter()
            .flat_map(|order| lengths.iter().map(move |length| Shape { order, length: *length }))
            .collect()
    }

    /// Correlation of the error at two places, so many lengths apart.
    fn correlation(self, apart: f64) -> f64 {
        let s = f64::from(self.order).sqrt() * apart.abs();
        let factor = match self.order {
            0 => (-0.5 * apart * apart).exp(),
            1 => 1.0,
            3 => 1.0 + s,
            _ => 1.0 + s + s * s / 3.0,
        };
        factor * (-s).exp()
    }

    /// Covariance of the means of an error of unit variance over two bins, so many bins apart; a bin is `bin` lengths (equation
    /// 330).
    fn of_means(self, apart: usize, bin: f64) -> f64 {
        /// Parts of a bin, of three places each (Gauss).
        const PARTS: usize = 8;
        const PLACES: [[f64; 2]; 3] =
            [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
        let apart = apart as f64;
        let of_part = |part: usize| {
            let of_place = |[place, weight]: [f64; 2]| {
                let u = (part as f64 + place) / PARTS as f64;
                let both = self.correlation((apart + u) * bin) + self.correlation((apart - u) * bin);
                weight / PARTS as f64 * (1.0 - u) * both
            };
            PLACES.map(of_place).iter().sum::<f64>()
        };
        (0..PARTS).map(of_part).sum()
    }

    /// Mean square of the third differences of such means, over that of independent ones.
    fn third_difference(self, bin: f64) -> f64 {
        let terms = [20.0, -30.0, 12.0, -2.0].into_iter().enumerate();
        terms.map(|(apart, factor)| factor * self.of_means(apart, bin)).sum::<f64>() / OF_THIRD_DIFFERENCE
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let smooth = match self.order {
            0 => "smooth",
            1 => "as rough as an exponential correlation",
            3 => "once differentiable",
            _ => "twice differentiable",
        };
        match self.length {
            Correlation::Length(length) => write!(f, "{} ms", significant(1e3 * length, 3))?,
            Correlation::Share(share) => write!(f, "{} % of the window", significant(100.0 * share, 2))?,
        }
        write!(f, ", {smooth}")
    }
}

/// Why a signal cannot be compared.
#[derive(Clone, Debug, PartialEq, Error)]
pub(super) enum SignalError {
    /// The recording has too few samples in the window.
    #[error("the recording has {found} samples from {from} to {to}; at least {FEWEST_BINS} are needed")]
    TooFew { found: usize, from: f64, to: f64 },
    /// A signal has a gap.
    #[error("the {of} has no value between {from} and {to}")]
    Gap { of: &'static str, from: f64, to: f64 },
    /// The recording is zero throughout.
    #[error("the recording is zero from {from} to {to}")]
    Zero { from: f64, to: f64 },
}

/// A recording in its window.
#[derive(Clone, Debug)]
pub(super) struct Recorded {
    pub(super) series: Series,
    /// Class of the channel filter behind it.
    pub(super) class: Option<f64>,
}

impl Recorded {
    pub(super) fn new(series: &Series, window: [f64; 2], class: Option<f64>) -> Result<Recorded, SignalError> {
        let series = series.window(window);
        if series.is_empty() {
            return Err(SignalError::TooFew { found: 0, from: window[0], to: window[1] });
        }
        Ok(Recorded { series, class })
    }

    /// Where it begins and ends.
    fn ends(&self) -> [f64; 2] {
        [self.series.time()[0], self.series.time()[self.series.len() - 1]]
    }

    /// Most bins whose noise is independent.
    fn independent(&self) -> usize {
        let [from, to] = self.ends();
        let by_filter = self.class.map_or(usize::MAX, |class| ((to - from) * class / FILTER_MEMORY) as usize);
        (self.series.len() - 1).min(by_filter.max(FEWEST_BINS))
    }

    /// The shortest bins whose noise is independent, of which neighbours share the sample between them, where a mean is over one
    /// of so many: their number, and what the mean square of third differences over them is multiplied by.
    fn fine(&self, bins: f64) -> (usize, f64) {
        let fine = ((self.series.len() - 1) / SAMPLES).min(self.independent()).max(bins as usize);
        let intervals = (self.series.len() - 1) as f64 / fine as f64;
        (fine, of_intervals(intervals) * bins / fine as f64)
    }

    /// Standard deviation of the noise of a mean over one of so many bins.
    fn noise(&self, bins: f64) -> Result<f64, SignalError> {
        let [from, to] = self.ends();
        let (fine, factor) = self.fine(bins);
        Ok(third_difference(&means(&self.series, &edges(from, to, fine), "recording")?) * factor.sqrt())
    }
}

/// Edges of bins of equal length.
fn edges(from: f64, to: f64, bins: usize) -> Vec<f64> {
    (0..=bins).map(|edge| from + (to - from) * edge as f64 / bins as f64).collect()
}

/// The measured signal of a test in bins, the mean of its recordings, and its errors.
#[derive(Clone, Debug)]
pub(super) struct ErrorModel {
    edges: Vec<f64>,
    /// Means over the bins.
    measured: DVector<f64>,
    /// Root mean square of the measured means.
    level: f64,
    /// Standard deviation of the noise of each measured mean.
    recorded: Vec<f64>,
    /// Recordings of each mean.
    counts: Vec<f64>,
    /// Length of the bins whose third differences the noise is from, and the factor of their mean square; none of a noise that
    /// is given.
    fine: Option<(f64, f64)>,
    /// Standard deviation of the roughness of a simulated mean.
    simulated: f64,
    /// The shape of the model's error with which residuals are independent.
    shape: Shape,
    spectrum: Spectrum,
}

/// The model's error in coordinates in which it and noise are independent: differences over the noise by these rows, and
/// variances of an error of the size of the signal.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    pub(super) basis: Arc<DMatrix<f64>>,
    pub(super) eigenvalues: Vec<f64>,
}

impl Spectrum {
    /// Numbers that are independent of each other and of the model's error.
    pub(super) fn trivial(count: usize) -> Spectrum {
        Spectrum { basis: Arc::new(DMatrix::identity(count, count)), eigenvalues: vec![0.0; count] }
    }

    /// Of signals one after the other.
    pub(super) fn joined(parts: &[Spectrum]) -> Spectrum {
        if let [only] = parts {
            return only.clone();
        }
        let count = parts.iter().map(|own| own.eigenvalues.len()).sum();
        let mut basis = DMatrix::zeros(count, count);
        let mut from = 0;
        for own in parts {
            let size = own.eigenvalues.len();
            basis.view_mut((from, from), (size, size)).copy_from(&*own.basis);
            from += size;
        }
        Spectrum { basis: Arc::new(basis), eigenvalues: parts.iter().flat_map(|own| own.eigenvalues.clone()).collect() }
    }

    /// Variances of its coordinates with a model's error of `share` of the root mean square of the signal.
    pub(super) fn variances(&self, share: f64) -> impl Iterator<Item = f64> + '_ {
        self.eigenvalues.iter().map(move |eigenvalue| (1.0 + share * share * eigenvalue).max(LEAST_VARIANCE))
    }

    /// Logarithm of the likelihood of differences over the noise, up to what does not depend on `share`, for every share.
    fn log_likelihood(&self, scaled: &DVector<f64>) -> impl Fn(f64) -> f64 + '_ {
        let rotated = &*self.basis * scaled;
        move |share| {
            let of_one = |(value, variance): (&f64, f64)| -0.5 * (value * value / variance + variance.ln());
            rotated.iter().zip(self.variances(share)).map(of_one).sum()
        }
    }
}

impl ErrorModel {
    /// Of the recordings of one signal of a test; of several, each mean over a bin is that of the recordings that have the bin.
    pub(super) fn new(recordings: &[Recorded], noise: Noise, shape: Shape) -> Result<ErrorModel, SignalError> {
        let ends = recordings.iter().map(Recorded::ends);
        let [from, to] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [from, to]| [a.min(from), b.max(to)]);
        // As many bins as the coarsest recording has in its part of the window.
        let bins_of = |own: &Recorded| {
            let [first, last] = own.ends();
            own.independent() as f64 * ((to - from) / (last - first)).max(1.0)
        };
        let bins = recordings.iter().map(bins_of).fold(MOST_BINS as f64, f64::min) as usize;
        let shortest = recordings.iter().map(|own| own.series.len()).min().unwrap_or(0);
        if bins < FEWEST_BINS || shortest <= FEWEST_BINS {
            return Err(SignalError::TooFew { found: shortest, from, to });
        }
        let edges = edges(from, to, bins);
        let step = (to - from) / bins as f64;
        let (mut sums, mut squares, mut counts) = (vec![0.0; bins], vec![0.0; bins], vec![0.0; bins]);
        for own in recordings {
            let [first, last] = own.ends();
            let is_in = |bin: &usize| edges[*bin] >= first - 1e-9 * step && edges[bin + 1] <= last + 1e-9 * step;
            let (Some(start), Some(end)) = ((0..bins).find(is_in), (0..bins).rfind(is_in)) else { continue };
            let means = means(&own.series, &edges[start..=end + 1], "recording")?;
            let deviation = match noise {
                Noise::FromRecording => own.noise((last - first) / step)?,
                Noise::Share(share) => share * root_mean_square(&means),
            };
            for (bin, mean) in (start..).zip(means) {
                sums[bin] += mean;
                squares[bin] += deviation * deviation;
                counts[bin] += 1.0;
            }
        }
        if let Some(bin) = (0..bins).find(|bin| counts[*bin] == 0.0) {
            return Err(SignalError::Gap { of: "recording", from: edges[bin], to: edges[bin + 1] });
        }
        let measured: Vec<f64> = sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect();
        let level = root_mean_square(&measured);
        if level <= 0.0 {
            return Err(SignalError::Zero { from, to });
        }
        let least = LEAST_NOISE * level;
        let fine = (noise == Noise::FromRecording).then(|| {
            let [first, last] = recordings[0].ends();
            let (fine, factor) = recordings[0].fine((last - first) / step);
            ((last - first) / fine as f64, factor)
        });
        let recorded = squares.iter().zip(&counts).map(|(squares, count)| (squares.sqrt() / count).max(least));
        let mut own = ErrorModel {
            edges,
            measured: DVector::from_vec(measured),
            level,
            recorded: recorded.collect(),
            counts,
            fine,
            simulated: 0.0,
            shape,
            spectrum: Spectrum::trivial(0),
        };
        own.spectrum = own.spectrum_of(shape);
        Ok(own)
    }

    /// The coordinates in which noise and an error of this shape are independent.
    pub(super) fn spectrum_of(&self, shape: Shape) -> Spectrum {
        let bins = self.bins();
        let window = self.edges[bins] - self.edges[0];
        let length = match shape.length {
            Correlation::Length(length) => length,
            Correlation::Share(share) => share * window,
        };
        // The recordings show the roughness of the model's error as noise, too.
        let rough = self.fine.map_or(0.0, |(fine, factor)| factor * shape.third_difference(fine / length));
        let bin = window / bins as f64 / length;
        let scale: Vec<f64> = self.noises().map(|noise| self.level / noise).collect();
        let is_even = scale.iter().zip(&self.counts).all(|(own, count)| *own == scale[0] && *count == self.counts[0]);
        if is_even {
            let decomposed = decomposed(shape, bins, bin);
            let eigenvalue = |own: &f64| scale[0] * scale[0] * (own - rough / self.counts[0]);
            let eigenvalues = decomposed.1.iter().map(eigenvalue).collect();
            return Spectrum { basis: Arc::clone(&decomposed.0), eigenvalues };
        }
        let mut matrix = covariance(shape, bins, bin);
        (0..bins).for_each(|row| matrix[(row, row)] -= rough / self.counts[row]);
        let scaled = DMatrix::from_fn(bins, bins, |row, column| scale[row] * matrix[(row, column)] * scale[column]);
        let eigen = SymmetricEigen::new(scaled);
        Spectrum { basis: Arc::new(eigen.eigenvectors.transpose()), eigenvalues: eigen.eigenvalues.as_slice().to_vec() }
    }

    /// Takes the roughness of a simulated signal, which contact makes, as noise beside that of the recordings.
    pub(super) fn add_roughness(&mut self, simulated: &Series) -> Result<(), SignalError> {
        self.simulated = third_difference(&self.means(simulated)?);
        self.spectrum = self.spectrum_of(self.shape);
        Ok(())
    }

    /// Takes the model's error as one of this shape.
    pub(super) fn set_shape(&mut self, shape: Shape) {
        self.shape = shape;
        self.spectrum = self.spectrum_of(shape);
    }

    /// The shape of the model's error.
    pub(super) fn shape(&self) -> Shape {
        self.shape
    }

    /// The coordinates in which noise and that error are independent.
    pub(super) fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// Takes the recordings, so many, as one more.
    pub(super) fn repeat(&mut self, recordings: usize) {
        let factor = (recordings as f64 / (recordings as f64 + 1.0)).sqrt();
        self.recorded.iter_mut().for_each(|own| *own *= factor);
        self.spectrum = self.spectrum_of(self.shape);
    }

    /// Number of bins.
    pub(super) fn bins(&self) -> usize {
        self.recorded.len()
    }

    /// Standard deviations of the noise of the differences of two means, in the unit of the signal.
    fn noises(&self) -> impl Iterator<Item = f64> + '_ {
        self.recorded.iter().map(|own| own.hypot(self.simulated))
    }

    /// Root mean square of these.
    pub(super) fn noise(&self) -> f64 {
        root_mean_square(&self.noises().collect::<Vec<_>>())
    }

    /// The middles of the bins, and the measured means there.
    pub(super) fn middles(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.edges.windows(2).zip(self.measured.iter()).map(|(edges, mean)| [0.5 * (edges[0] + edges[1]), *mean])
    }

    /// Means of a simulated signal over the bins.
    pub(super) fn means(&self, simulated: &Series) -> Result<Vec<f64>, SignalError> {
        means(simulated, &self.edges, "simulated signal")
    }

    /// Differences of the means of a simulated signal from the measured ones, each over the noise.
    pub(super) fn scaled(&self, simulated: &Series) -> Result<DVector<f64>, SignalError> {
        let difference = DVector::from_vec(self.means(simulated)?) - &self.measured;
        Ok(DVector::from_iterator(self.bins(), difference.iter().zip(self.noises()).map(|(own, noise)| own / noise)))
    }

    /// ‖simulated − measured‖/‖measured‖ over the bins.
    pub(super) fn relative_error(&self, simulated: &Series) -> Result<f64, SignalError> {
        let difference = DVector::from_vec(self.means(simulated)?) - &self.measured;
        Ok(difference.norm() / self.measured.norm())
    }

    /// Independent residuals of unit variance of differences over the noise, for a model's error of `share`.
    pub(super) fn whitened(&self, scaled: &DVector<f64>, share: f64) -> Vec<f64> {
        let rotated = &*self.spectrum.basis * scaled;
        rotated.iter().zip(self.spectrum.variances(share)).map(|(value, variance)| value / variance.sqrt()).collect()
    }

    /// The same for an error that is independent from bin to bin.
    pub(super) fn plain(&self, scaled: &DVector<f64>, share: f64) -> Vec<f64> {
        let residual = |(value, noise): (&f64, f64)| value / (1.0_f64).hypot(share * self.level / noise);
        scaled.iter().zip(self.noises()).map(residual).collect()
    }
}

/// The covariance of the means of an error of unit variance over so many bins, of `bin` lengths each.
fn covariance(shape: Shape, bins: usize, bin: f64) -> DMatrix<f64> {
    let covariances: Vec<f64> = (0..bins).map(|apart| shape.of_means(apart, bin)).collect();
    DMatrix::from_fn(bins, bins, |row, column| covariances[row.abs_diff(column)])
}

/// Eigenvectors, as rows, and eigenvalues of a covariance.
type Decomposed = (Arc<DMatrix<f64>>, Vec<f64>);

/// Those of an error of unit variance over so many bins, which signals of all tests have in common: each is computed once.
fn decomposed(shape: Shape, bins: usize, bin: f64) -> Arc<Decomposed> {
    /// Most that are kept.
    const MOST: usize = 256;
    static KNOWN: Mutex<BTreeMap<(u8, usize, u64), Arc<Decomposed>>> = Mutex::new(BTreeMap::new());
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    // Lengths that are shares of windows differ by rounding.
    let key = (shape.order, bins, (1e9 * bin).round() as u64);
    if let Some(found) = known().get(&key) {
        return Arc::clone(found);
    }
    let eigen = SymmetricEigen::new(covariance(shape, bins, bin));
    let eigenvalues = eigen.eigenvalues.iter().map(|value| value.max(0.0)).collect();
    let found = Arc::new((Arc::new(eigen.eigenvectors.transpose()), eigenvalues));
    let mut known = known();
    if known.len() >= MOST {
        known.clear();
    }
    known.insert(key, Arc::clone(&found));
    found
}

/// What signals of a test leave: each with its errors, and its differences over the noise.
pub(super) struct Left<'a> {
    pub(super) signals: Vec<(&'a ErrorModel, DVector<f64>)>,
    pub(super) weight: f64,
    /// The shapes that its error may have.
    pub(super) shapes: &'a [Shape],
}

/// The share of the model's error, where none is given, for which what tests leave is most likely, zero where noise explains it; and of each test the
/// shape that is most likely then, with the logarithm of its likelihood over that of the shape which its signals have.
pub(super) fn most_likely(tests: &[Left<'_>], given: Option<f64>) -> (f64, Vec<(Shape, f64)>) {
    /// Shares that are considered.
    const RANGE: [f64; 2] = [1e-4, 1.0];
    /// Shares that are tried, evenly in the logarithm: 4 % apart.
    const TRIED: usize = 240;
    let tried = (0..=TRIED).map(|place| RANGE[0] * (RANGE[1] / RANGE[0]).powf(place as f64 / TRIED as f64));
    let shares: Vec<f64> = given.map_or_else(|| std::iter::once(0.0).chain(tried).collect(), |share| vec![share]);
    // Of a test: a row a shape, a column a share.
    let of_shape = |left: &Left<'_>, shape: Shape| -> Vec<f64> {
        let mut sums = vec![0.0; shares.len()];
        for (model, scaled) in &left.signals {
            let spectrum = model.spectrum_of(shape);
            let at = spectrum.log_likelihood(scaled);
            sums.iter_mut().zip(&shares).for_each(|(sum, share)| *sum += left.weight * at(*share));
        }
        sums
    };
    let of_test =
        |left: &Left<'_>| -> Vec<Vec<f64>> { left.shapes.par_iter().map(|shape| of_shape(left, *shape)).collect() };
    let all: Vec<Vec<Vec<f64>>> = tests.iter().map(of_test).collect();
    let at = |place: usize| {
        let of_test = |shapes: &Vec<Vec<f64>>| log_mean_exp(shapes.iter().map(|own| own[place]));
        all.iter().map(of_test).sum::<f64>()
    };
    let best = (0..shares.len()).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap_or(0);
    let shape = |(left, shapes): (&Left<'_>, &Vec<Vec<f64>>)| {
        let most = (0..shapes.len()).max_by(|a, b| shapes[*a][best].total_cmp(&shapes[*b][best])).unwrap_or(0);
        let has = left.signals.first().map(|(model, _)| model.shape());
        let now =
            left.shapes.iter().position(|own| Some(*own) == has).map_or(f64::NEG_INFINITY, |own| shapes[own][best]);
        (left.shapes[most], shapes[most][best] - now)
    };
    (shares[best], tests.iter().zip(&all).map(shape).collect())
}

/// Logarithm of the mean of exponentials.
pub(super) fn log_mean_exp(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), own| (sum + (own - largest).exp(), count + 1.0));
    largest + f64::ln(sum / count)
}

/// Root mean square.
pub(super) fn root_mean_square(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { (values.iter().map(|own| own * own).sum::<f64>() / values.len() as f64).sqrt() }
}

/// Means of a series between neighbouring edges, linear between samples.
fn means(series: &Series, edges: &[f64], of: &'static str) -> Result<Vec<f64>, SignalError> {
    let (time, values) = (series.time(), series.values());
    let gap = |from: f64, to: f64| SignalError::Gap { of, from, to };
    let mean = |bin: &[f64]| {
        let [from, to] = [bin[0], bin[1]];
        // Where rounding puts the last edge behind the last sample, that sample counts.
        let at = |place: f64| {
            let inside = place.clamp(*time.first()?, *time.last()?);
            ((inside - place).abs() <= 1e-9 * (to - from)).then(|| series.value_at(inside))?
        };
        let ends = at(from).zip(at(to)).ok_or_else(|| gap(from, to))?;
        let start = time.partition_point(|t| *t <= from);
        let end = time.partition_point(|t| *t < to).max(start);
        let (mut sum, mut before) = (0.0, (from, ends.0));
        for next in time[start..end].iter().copied().zip(values[start..end].iter().copied()).chain([(to, ends.1)]) {
            sum += 0.5 * (before.1 + next.1) * (next.0 - before.0);
            before = next;
        }
        let mean = sum / (to - from);
        if mean.is_finite() { Ok(mean) } else { Err(gap(from, to)) }
    };
    edges.windows(2).map(mean).collect()
}

/// The mean square noise of means over bins of so many intervals between samples, over that of their third differences
/// (docs/theory.md, equation 331b).
///
/// Neighbouring bins share a sample, so that their means are correlated: third differences show less than their noise, and its
/// sum over many bins is larger than that of independent ones. This is the noise that bins which count as independent have.
fn of_intervals(intervals: f64) -> f64 {
    intervals / (intervals - 0.875)
}

/// Root mean square of the third differences, over that of independent values of unit variance.
fn third_difference(means: &[f64]) -> f64 {
    let differences = means.windows(4).map(|m| m[3] - 3.0 * m[2] + 3.0 * m[1] - m[0]);
    let (sum, count) = differences.fold((0.0, 0_usize), |(sum, count), d| (sum + d * d, count + 1));
    (sum / count as f64 / OF_THIRD_DIFFERENCE).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use uncertainty::random::Stream;

    const ROUGH: Shape = Shape { order: 1, length: Correlation::Share(0.03) };

    /// A half wave of 140 m/s² over 0.1 s at 10 kHz, with noise.
    fn half_wave(noise: f64, seed: u64) -> Series {
        let mut stream = Stream::new(seed);
        let time: Vec<f64> = (0..=1000).map(|sample| 1e-4 * f64::from(sample)).collect();
        let value = |t: &f64| 140.0 * (std::f64::consts::PI * t / 0.1).sin() + noise * stream.normal();
        let values: Vec<f64> = time.iter().map(value).collect();
        Series::new(time, values)
    }

    fn of(series: &[&Series], noise: Noise, shape: Shape) -> Result<ErrorModel, SignalError> {
        let recorded = series.iter().map(|own| Recorded::new(own, [0.0, 0.1], None)).collect::<Result<Vec<_>, _>>()?;
        ErrorModel::new(&recorded, noise, shape)
    }

    fn model(series: &Series, shape: Shape) -> ErrorModel {
        of(&[series], Noise::FromRecording, shape).unwrap()
    }

    /// White noise on any number of samples: the mean of all bins has the deviation that independent bins would have.
    #[test]
    fn the_noise_of_few_samples_is_that_of_their_mean() {
        const RECORDINGS: u64 = 300;
        for samples in thorough::first(3, [33, 146, 1001, 41, 121, 241, 481]) {
            let time: Vec<f64> = (0..samples).map(f64::from).collect();
            let (mut expected, mut found) = (0.0, 0.0);
            for seed in 0..RECORDINGS {
                let mut stream = Stream::new(seed);
                let values: Vec<f64> = time.iter().map(|_| 50.0 + stream.normal()).collect();
                let window = [0.0, f64::from(samples - 1)];
                let recorded = [Recorded::new(&Series::new(time.clone(), values), window, None).unwrap()];
                let model = ErrorModel::new(&recorded, Noise::FromRecording, ROUGH).unwrap();
                let bins = model.bins() as f64;
                expected += model.noise().powi(2) / bins;
                found += (model.measured.sum() / bins - 50.0).powi(2);
            }
            let ratio = (found / expected).sqrt();
            assert!((ratio - 1.0).abs() < 0.15, "{samples} samples: {ratio}");
        }
    }

    #[test]
    fn the_noise_of_a_smooth_signal_is_found_and_that_of_an_exact_one_is_the_least() {
        let found = model(&half_wave(1.5, 3), ROUGH).noise();
        // 120 bins of 8.3 samples; white noise of 1.5 at samples: about 1.5/√8.3.
        assert!((found / (1.5 / 8.33_f64.sqrt()) - 1.0).abs() < 0.2, "{found}");
        let exact = model(&half_wave(0.0, 3), ROUGH).noise();
        assert!((0.0098..0.011).contains(&exact), "{exact}");
        // The mean of four recordings has half of it.
        let all: Vec<Series> = (3..7).map(|seed| half_wave(1.5, seed)).collect();
        let four = of(&all.iter().collect::<Vec<_>>(), Noise::FromRecording, ROUGH).unwrap().noise();
        assert!((four / found / 0.5 - 1.0).abs() < 0.15, "{four} for {found}");
    }

    /// Covariances of means over bins of an exponential correlation have a closed form.
    #[test]
    fn means_of_an_exponential_error_have_their_closed_covariance() {
        for bin in [0.01_f64, 0.3, 2.0, 6.0] {
            let variance = 2.0 * (bin - 1.0 + (-bin).exp()) / (bin * bin);
            let between = |apart: f64| (-apart * bin).exp() * 2.0 * (bin.cosh() - 1.0) / (bin * bin);
            for (apart, exact) in [(0, variance), (1, between(1.0)), (4, between(4.0))] {
                let own = ROUGH.of_means(apart, bin);
                assert!((own - exact).abs() < 1e-5 * exact, "{bin} {apart}: {own} for {exact}");
            }
        }
    }

    /// The residuals are C^(−1/2) times the difference: their squares sum to dᵀ C⁻¹ d with C written out.
    #[test]
    fn whitened_residuals_have_the_norm_of_the_covariance() {
        let (measured, simulated) = (half_wave(1.0, 1), half_wave(0.0, 1));
        let shape = Shape { order: 3, length: Correlation::Length(2e-3) };
        let model = of(&[&measured], Noise::Share(0.01), shape).unwrap();
        let share = 0.05;
        let means = DVector::from_vec(model.means(&simulated).unwrap()) - &model.measured;
        let level = model.measured.norm() / (model.bins() as f64).sqrt();
        let bin = 0.1 / model.bins() as f64 / 2e-3;
        let covariance = DMatrix::from_fn(model.bins(), model.bins(), |row, column| {
            let own = (share * level).powi(2) * shape.of_means(row.abs_diff(column), bin);
            own + if row == column { model.noise().powi(2) } else { 0.0 }
        });
        let expected = means.dot(&(covariance.clone().try_inverse().unwrap() * &means));
        let scaled = model.scaled(&simulated).unwrap();
        let found: f64 = model.whitened(&scaled, share).iter().map(|r| r * r).sum();
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        let log_determinant = 2.0 * covariance.cholesky().unwrap().l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let constant = 2.0 * model.bins() as f64 * model.noise().ln();
        let likelihood = -0.5 * (expected + log_determinant - constant);
        let own = model.spectrum.log_likelihood(&scaled)(share);
        assert!((own - likelihood).abs() < 1e-6 * likelihood.abs());
    }

    /// An error of the law, drawn at the samples of a recording and not from the covariance of any bins.
    #[derive(Clone, Copy)]
    enum Process {
        /// Exponential correlation over this share of the window.
        Rough(f64),
        /// Squared exponential correlation, by waves of random length.
        Smooth(f64),
    }

    impl Process {
        fn draw(self, samples: usize, stream: &mut Stream) -> Vec<f64> {
            match self {
                Process::Rough(length) => {
                    let keep = (-1.0 / (length * (samples - 1) as f64)).exp();
                    let mut own = stream.normal();
                    let mut next = || {
                        let now = own;
                        own = keep * own + (1.0 - keep * keep).sqrt() * stream.normal();
                        now
                    };
                    (0..samples).map(|_| next()).collect()
                }
                Process::Smooth(length) => {
                    let wave = |_| [stream.normal() / length, stream.normal(), stream.normal()];
                    let waves: Vec<[f64; 3]> = (0..300).map(wave).collect();
                    let at = |sample: usize| {
                        let x = sample as f64 / (samples - 1) as f64;
                        let of = |[k, a, b]: &[f64; 3]| a * (k * x).cos() + b * (k * x).sin();
                        waves.iter().map(of).sum::<f64>() / (waves.len() as f64).sqrt()
                    };
                    (0..samples).map(at).collect()
                }
            }
        }
    }

    /// A study of a law that is linear in two parameters, the scale and the stiffening of a wave, on quadrature.
    struct Study {
        /// Of the parameters: how far the truth is along the distribution of each.
        along: [f64; 2],
        /// Of the error's size.
        of_share: f64,
        share: f64,
        width: f64,
    }

    const SAMPLES_OF_STUDY: usize = 961;
    const TRUE_SHARE: f64 = 0.02;

    /// Parts of the law: the wave and its stiffening.
    fn parts() -> [Series; 2] {
        let time: Vec<f64> =
            (0..SAMPLES_OF_STUDY).map(|sample| 0.1 * sample as f64 / (SAMPLES_OF_STUDY - 1) as f64).collect();
        let x = |t: &f64| (std::f64::consts::PI * t / 0.1).sin();
        let of =
            |f: fn(f64) -> f64| Series::new(time.clone(), time.iter().map(|t| 140.0 * f(x(t))).collect::<Vec<_>>());
        [of(|x| x), of(|x| x * x * x)]
    }

    /// How several recordings with one error of the law count.
    #[derive(Clone, Copy, PartialEq)]
    enum Counted {
        /// As recordings of one test.
        Pooled,
        /// As tests of their own.
        Apart,
        /// As tests with one `shared_error`.
        Shared,
    }

    fn study(process: Process, recordings: usize, shapes: &[Shape], counted: Counted, stream: &mut Stream) -> Study {
        let parts = parts();
        let level = root_mean_square(parts[0].values());
        let error = process.draw(SAMPLES_OF_STUDY, stream);
        let mut recorded = || {
            let own = parts[0].values().iter().zip(&error);
            let values: Vec<f64> = own.map(|(v, e)| v + TRUE_SHARE * level * e + 0.3 * stream.normal()).collect();
            Recorded { series: Series::new(parts[0].time().to_vec(), values), class: None }
        };
        let all: Vec<Recorded> = (0..recordings).map(|_| recorded()).collect();
        let groups: Vec<&[Recorded]> =
            if counted == Counted::Pooled { vec![&all[..]] } else { all.chunks(1).collect() };
        let weight = if counted == Counted::Shared { 1.0 / recordings as f64 } else { 1.0 };
        let models: Vec<ErrorModel> =
            groups.iter().map(|own| ErrorModel::new(own, Noise::FromRecording, shapes[0]).unwrap()).collect();
        // With a flat distribution of both parameters the posterior is normal given size and shape of the error.
        let mut grid: Vec<(f64, f64, [f64; 2], [f64; 2])> = Vec::new();
        let shares: Vec<f64> = (0..48).map(|at| 0.003 * 1.08_f64.powi(at)).collect();
        for shape in shapes {
            let spectra: Vec<Spectrum> = models.iter().map(|model| model.spectrum_of(*shape)).collect();
            let columns: Vec<[DVector<f64>; 3]> = models
                .iter()
                .zip(&spectra)
                .map(|(model, spectrum)| {
                    let zero = Series::new(parts[0].time().to_vec(), vec![0.0; SAMPLES_OF_STUDY]);
                    let none = model.scaled(&zero).unwrap();
                    let [one, two] = [&parts[0], &parts[1]].map(|own| model.scaled(own).unwrap() - &none);
                    [&*spectrum.basis * one, &*spectrum.basis * two, -(&*spectrum.basis * none)]
                })
                .collect();
            for share in &shares {
                let mut normal = [[0.0; 3]; 3];
                let mut log = -0.5 * ((share / 0.02).ln()).powi(2);
                for (spectrum, columns) in spectra.iter().zip(&columns) {
                    let variances: Vec<f64> = spectrum.variances(*share).collect();
                    log -= 0.5 * weight * variances.iter().map(|own| own.ln()).sum::<f64>();
                    for a in 0..3 {
                        for b in 0..3 {
                            let products = variances.iter().enumerate().map(|(i, v)| columns[a][i] * columns[b][i] / v);
                            normal[a][b] += weight * products.sum::<f64>();
                        }
                    }
                }
                let [[a, b, c], [_, d, e], [_, _, f]] = normal;
                let determinant = a * d - b * b;
                let best = [(d * c - b * e) / determinant, (a * e - b * c) / determinant];
                log -= 0.5 * (f - best[0] * c - best[1] * e) + 0.5 * determinant.ln();
                grid.push((log, *share, best, [(d / determinant).sqrt(), (a / determinant).sqrt()]));
            }
        }
        let largest = grid.iter().map(|own| own.0).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = grid.iter().map(|own| (own.0 - largest).exp()).collect();
        let whole: f64 = weights.iter().sum();
        /// Logarithm of the weight, share, best values, deviations.
        type Point = (f64, f64, [f64; 2], [f64; 2]);
        let mean = |of: &dyn Fn(&Point) -> f64| {
            grid.iter().zip(&weights).map(|(own, weight)| weight * of(own)).sum::<f64>() / whole
        };
        let along = [0, 1].map(|which| {
            let truth = [1.0, 0.0][which];
            mean(&|own| uncertainty::normal::cumulative((truth - own.2[which]) / own.3[which]))
        });
        let of_share = mean(&|own| f64::from(u8::from(own.1 < TRUE_SHARE)));
        Study { along, of_share, share: mean(&|own| own.1.ln()).exp(), width: mean(&|own| own.3[0]) }
    }

    /// Shares of the intervals of 95, 80 and 50 % of both parameters and the size that hold the truth; the median size found over
    /// the true one.
    fn coverage(
        studies: u64,
        process: Process,
        recordings: usize,
        shapes: &[Shape],
        counted: Counted,
    ) -> ([f64; 3], f64, f64) {
        let all: Vec<Study> = (0..studies)
            .into_par_iter()
            .map(|seed| study(process, recordings, shapes, counted, &mut Stream::new(1 + seed)))
            .collect();
        let within = |p: f64, level: f64| (p - 0.5).abs() < 0.5 * level;
        let held = [0.95, 0.8, 0.5].map(|level| {
            let of = |own: &Study| own.along.iter().filter(|p| within(**p, level)).count();
            all.iter().map(of).sum::<usize>() as f64 / (2 * all.len()) as f64
        });
        let of_share = all.iter().filter(|own| within(own.of_share, 0.95)).count() as f64 / all.len() as f64;
        let mut shares: Vec<f64> = all.iter().map(|own| own.share / TRUE_SHARE).collect();
        shares.sort_by(f64::total_cmp);
        let width = all.iter().map(|own| own.width).sum::<f64>() / all.len() as f64;
        println!(
            "{studies} studies of {recordings}: 95, 80, 50 % hold {held:.3?}; size {:.2} of the true one, its 95 % {of_share:.2}; width {width:.4}",
            shares[shares.len() / 2]
        );
        (held, shares[shares.len() / 2], of_share)
    }

    /// Studies of a fast run, and of a thorough one.
    fn studies() -> u64 {
        if std::env::var_os("DROPTOWER_THOROUGH").is_some() { 400 } else { 60 }
    }

    /// 95 % hold 95 % but for what so few studies scatter by: three deviations, parameters of one study count as one.
    fn holds(found: f64, level: f64) -> bool {
        let spread = (level * (1.0 - level) / studies() as f64).sqrt();
        found > level - 3.0 * spread && found < level + 3.0 * spread
    }

    /// A process of the assumed shape, which bins of any size have the means of.
    #[test]
    fn an_error_that_is_a_process_is_found_at_its_size() {
        let ([of_95, of_80, of_50], size, of_size) =
            coverage(studies(), Process::Rough(0.03), 1, &[ROUGH], Counted::Pooled);
        assert!((size - 1.0).abs() < 0.05 && of_size > 0.88, "{size} {of_size}");
        assert!(holds(of_95, 0.95) && holds(of_80, 0.8) && holds(of_50, 0.5), "{of_95} {of_80} {of_50}");
    }

    /// Six recordings of one test have one error of the law: as tests of their own they would seem to tell √6 times as much.
    #[test]
    fn recordings_of_one_test_do_not_narrow_what_the_law_is_off_by() {
        let ([of_95, of_80, _], ..) = coverage(studies(), Process::Rough(0.03), 6, &[ROUGH], Counted::Pooled);
        assert!(holds(of_95, 0.95) && holds(of_80, 0.8), "{of_95} {of_80}");
        let ([apart, ..], ..) = coverage(studies(), Process::Rough(0.03), 6, &[ROUGH], Counted::Apart);
        assert!(apart < 0.75, "{apart}");
        let ([shared, ..], ..) = coverage(studies(), Process::Rough(0.03), 6, &[ROUGH], Counted::Shared);
        assert!(shared > 0.85, "{shared}");
    }

    /// Errors of other lengths and other smoothness than any that counts.
    #[test]
    fn errors_of_any_length_and_smoothness_are_covered() {
        for process in
            [Process::Rough(0.03), Process::Rough(0.1), Process::Rough(0.3), Process::Smooth(0.1), Process::Smooth(0.3)]
        {
            let ([of_95, ..], ..) = coverage(studies(), process, 1, &Shape::all(None), Counted::Pooled);
            assert!(of_95 > 0.85, "{of_95}");
        }
        let ([fixed, ..], ..) = coverage(studies(), Process::Smooth(0.1), 1, &[ROUGH], Counted::Pooled);
        assert!(fixed < 0.85, "{fixed}");
    }

    /// An error that is smooth is told from a rough one, and its size is found.
    #[test]
    fn the_likelier_shape_is_found() {
        let series = parts();
        let level = root_mean_square(series[0].values());
        for (process, is_smooth) in [(Process::Rough(0.1), false), (Process::Smooth(0.1), true)] {
            let mut stream = Stream::new(3);
            let error = process.draw(SAMPLES_OF_STUDY, &mut stream);
            let values = series[0]
                .values()
                .iter()
                .zip(error)
                .map(|(own, error)| own + 0.04 * level * error + 0.1 * stream.normal());
            let measured = Series::new(series[0].time().to_vec(), values.collect::<Vec<_>>());
            let model = model(&measured, ROUGH);
            let shapes = Shape::all(None);
            let left =
                Left { signals: vec![(&model, model.scaled(&series[0]).unwrap())], weight: 1.0, shapes: &shapes };
            let (share, found) = most_likely(&[left], None);
            assert!((0.015..0.09).contains(&share), "{share}");
            assert_eq!(found[0].0.order != 1, is_smooth, "{}", found[0].0);
        }
    }

    #[test]
    fn roughness_of_the_simulation_is_noise_too() {
        let mut model = model(&half_wave(1.0, 1), ROUGH);
        let before = model.noise();
        model.add_roughness(&half_wave(1.0, 2)).unwrap();
        assert!((model.noise() / before / 2_f64.sqrt() - 1.0).abs() < 0.15, "{} {before}", model.noise());
    }

    #[test]
    fn gaps_and_short_recordings_are_refused() {
        let wave = half_wave(0.1, 1);
        let short = Series::new(&wave.time()[..900], &wave.values()[..900]);
        let error = model(&wave, ROUGH).scaled(&short).unwrap_err();
        assert!(matches!(error, SignalError::Gap { of: "simulated signal", .. }), "{error}");
        let few = Recorded::new(&wave, [0.0, 5e-4], None).unwrap();
        let few = ErrorModel::new(&[few], Noise::Share(0.01), ROUGH).unwrap_err();
        assert!(few.to_string().starts_with("the recording has 6 samples from 0 to 0.0005"), "{few}");
        let late = Series::new(&wave.time()[950..], &wave.values()[950..]);
        let apart = of(&[&Series::new(&wave.time()[..90], &wave.values()[..90]), &late], Noise::Share(0.01), ROUGH);
        assert!(matches!(apart.unwrap_err(), SignalError::Gap { of: "recording", .. }));
        // The longer of two recordings goes on alone.
        assert_eq!(of(&[&wave, &short], Noise::Share(0.01), ROUGH).unwrap().bins(), MOST_BINS);
        let zero = wave.with_values(vec![0.0; wave.len()]);
        assert_eq!(of(&[&zero], Noise::Share(0.01), ROUGH).unwrap_err(), SignalError::Zero { from: 0.0, to: 0.1 });
    }
}
