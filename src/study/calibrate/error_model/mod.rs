//! What the recordings of a test may differ by from the simulated signal of a true parameter: noise of the sensor, roughness of
//! the simulation, and an error of the model, a process along the signal that all recordings have in common (docs/methods.md,
//! section 28).
//!
//! Signals are compared by their means over bins, so that noise that is faster than a bin counts once. In the
//! eigenvectors of the covariance of the model's error over the noise, both are independent whatever the size of the error.

#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

use base::number::significant;
use lab::signal::Series;
use nalgebra::{DMatrix, DVector, Matrix2, SymmetricEigen, Vector2};
use rayon::prelude::*;

use super::mesh::MeshError;

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

/// Shares of the variance of the model's error that are in proportion to the signal and smooth over [`LONG`] of the window (assumed).
/// How far a law is off all along cannot be told from how far it is off from place to place, and parameters take most of it up.
const LONG_PARTS: [f64; 3] = [0.0, 0.3, 0.9];
const LONG: f64 = 0.37;

/// The size of the model's error, of which a share of the variance is in proportion to the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorSize {
    /// Its deviation, as a share of the root mean square of the signal.
    pub(super) share: f64,
    /// That share of its variance; the rest is even along the signal.
    pub(super) in_proportion: f64,
}

impl ErrorSize {
    /// Its deviation where a simulated signal has a `value` and the root mean square `level`.
    pub(super) fn deviation(self, value: f64, level: f64) -> f64 {
        self.share * ((1.0 - self.in_proportion) * level * level + self.in_proportion * value * value).sqrt()
    }
}

/// The shape of the model's error along a signal: a process with Matérn's correlation, even or in proportion to the signal, and a
/// long part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Twice Matérn's ν: 1 (exponential), 3 (once differentiable), or 0 for any number of times (squared exponential).
    order: u8,
    length: Correlation,
    /// Whether the process is a share of the simulated signal, with its sign, since a law that is too stiff is so on both sides of
    /// zero, or of the root mean square everywhere.
    in_proportion: bool,
    /// Share of the variance of the long part.
    long: f64,
}

impl Shape {
    /// The shapes that count beside each other with this length, which is of the whole error, or with any.
    pub(super) fn all(length: Option<Correlation>) -> Vec<Shape> {
        let lengths = length.map_or_else(|| LENGTHS.map(Correlation::Share).to_vec(), |own| vec![own]);
        let parts = if length.is_none() { &LONG_PARTS[..] } else { &[0.0] };
        let of_length = |length: &Correlation| {
            let (length, of_order) = (*length, [1, 3, 0].into_iter());
            of_order.flat_map(move |order| {
                let of_part = move |long: &f64| {
                    [false, true].map(|in_proportion| Shape { order, length, in_proportion, long: *long })
                };
                parts.iter().flat_map(of_part)
            })
        };
        lengths.iter().flat_map(of_length).collect()
    }

    /// Whether it has a long part.
    pub(super) fn is_long(self) -> bool {
        self.long > 0.0
    }

    /// Share of its variance that is in proportion to the signal.
    pub(super) fn in_proportion(self) -> f64 {
        if self.in_proportion { 1.0 } else { self.long }
    }
}

/// Matérn's correlation of an [order](Shape::order) at two places, so many lengths apart.
fn correlation(order: u8, apart: f64) -> f64 {
    let s = f64::from(order).sqrt() * apart.abs();
    match order {
        0 => (-0.5 * apart * apart).exp(),
        1 => (-s).exp(),
        _ => (1.0 + s) * (-s).exp(),
    }
}

/// Covariance of the means of an error of unit variance over two bins, so many bins apart; a bin is `bin` lengths (equation 330).
fn of_means(order: u8, apart: usize, bin: f64) -> f64 {
    /// Parts of a bin, of three places each (Gauss).
    const PARTS: usize = 8;
    const PLACES: [[f64; 2]; 3] =
        [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
    let apart = apart as f64;
    let of_part = |part: usize| {
        let of_place = |[place, weight]: [f64; 2]| {
            let u = (part as f64 + place) / PARTS as f64;
            let both = correlation(order, (apart + u) * bin) + correlation(order, (apart - u) * bin);
            weight / PARTS as f64 * (1.0 - u) * both
        };
        PLACES.map(of_place).iter().sum::<f64>()
    };
    (0..PARTS).map(of_part).sum()
}

/// Mean square of the third differences of such means, over that of independent ones.
fn third_difference_of(order: u8, bin: f64) -> f64 {
    let terms = [20.0, -30.0, 12.0, -2.0].into_iter().enumerate();
    terms.map(|(apart, factor)| factor * of_means(order, apart, bin)).sum::<f64>() / OF_THIRD_DIFFERENCE
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let smooth = match self.order {
            0 => "smooth",
            1 => "as rough as an exponential correlation",
            _ => "once differentiable",
        };
        match self.length {
            Correlation::Length(length) => write!(f, "{} ms", significant(1e3 * length, 3))?,
            Correlation::Share(share) => write!(f, "{} % of the window", significant(100.0 * share, 2))?,
        }
        write!(f, ", {smooth}")?;
        if self.in_proportion {
            f.write_str(", in proportion to the signal")?;
        }
        if self.long > 0.0 {
            write!(f, ", {} % of its variance all along", significant(100.0 * self.long, 2))?;
        }
        Ok(())
    }
}

/// Why a signal cannot be compared: the recording has too few samples in the window.
fn too_few(found: usize, from: f64, to: f64) -> String {
    format!("the recording has {found} samples from {from} to {to}; at least {FEWEST_BINS} are needed")
}

/// A signal has a gap.
fn gap(of: &str, from: f64, to: f64) -> String {
    format!("the {of} has no value between {from} and {to}")
}

/// A recording in its window.
#[derive(Clone, Debug)]
pub(super) struct Recorded {
    pub(super) series: Series,
    /// Class of the channel filter behind it.
    pub(super) class: Option<f64>,
    /// Covariance of the errors of its time of contact (s) and impact speed (m/s).
    pub(super) contact: Matrix2<f64>,
}

impl Recorded {
    /// One whose contact has no error.
    pub(super) fn new(series: &Series, window: [f64; 2], class: Option<f64>) -> Result<Recorded, String> {
        let series = series.window(window);
        if series.is_empty() {
            return Err(too_few(0, window[0], window[1]));
        }
        Ok(Recorded { series, class, contact: Matrix2::zeros() })
    }

    /// One of so many signals of a recording, which have the error of one contact. As errors that are independent of each other
    /// they cover it where each is √n times as large, since (Σ xᵢ)² ≤ n Σ xᵢ².
    pub(super) fn with_contact(self, covariance: Matrix2<f64>, signals: usize) -> Recorded {
        Recorded { contact: covariance * signals as f64, ..self }
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
    /// of so many: their number, and what the mean square of third differences over them is multiplied by. A short recording has
    /// shorter ones: fewer have no third differences.
    fn fine(&self, bins: f64) -> (usize, f64) {
        let fine = ((self.series.len() - 1) / SAMPLES).min(self.independent()).max(bins as usize).max(FEWEST_BINS);
        let intervals = (self.series.len() - 1) as f64 / fine as f64;
        (fine, of_intervals(intervals) * bins / fine as f64)
    }

    /// Standard deviation of the noise of a mean over one of so many bins.
    fn noise(&self, bins: f64) -> Result<f64, String> {
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
    /// Simulated means near the best parameters, of whose size an error may be; the measured ones contain the error itself.
    simulated_means: Vec<f64>,
    /// Covariance of the mean error of the recordings' times of contact (s) and impact speeds (m/s).
    contact: Matrix2<f64>,
    /// The independent parts of that error, each one standard deviation long, and what they add to the differences.
    of_contact: Vec<(Vector2<f64>, DVector<f64>)>,
    /// The error of the elements of the simulation.
    mesh: Option<MeshError>,
    /// The shape of the model's error with which residuals are independent.
    shape: Shape,
    spectrum: Spectrum,
}

/// The model's error in coordinates in which it and noise are independent: differences over the noise by these rows, and
/// variances of an error with a share of one.
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

    /// Variances of its coordinates with a model's error of this share.
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
    pub(super) fn new(recordings: &[Recorded], noise: Noise, shape: Shape) -> Result<ErrorModel, String> {
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
            return Err(too_few(shortest, from, to));
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
            return Err(gap("recording", edges[bin], edges[bin + 1]));
        }
        let measured: Vec<f64> = sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect();
        let level = root_mean_square(&measured);
        if level <= 0.0 {
            return Err(format!("the recording is zero from {from} to {to}"));
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
            simulated_means: vec![level; bins],
            contact: recordings.iter().map(|own| own.contact).sum::<Matrix2<f64>>() / (recordings.len() as f64).powi(2),
            of_contact: Vec::new(),
            mesh: None,
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
        // The recordings show the roughness of the model's error as noise, too: each place is relieved of its own. Where an error in
        // proportion is small, the noise stays as large as the recording shows it.
        let rough = self.fine.map_or(0.0, |(fine, factor)| factor * third_difference_of(shape.order, fine / length));
        let bin = window / bins as f64;
        let pairs = |apart| {
            let [own, long] =
                [(shape.order, length), (0, LONG * window)].map(|(order, of)| of_means(order, apart, bin / of));
            [(1.0 - shape.long) * own, shape.long * long]
        };
        let covariances: Vec<[f64; 2]> = (0..bins).map(pairs).collect();
        let noises: Vec<f64> = self.noises().collect();
        // Sizes of both parts, over the noise.
        let sizes = |(simulated, noise): (&f64, &f64)| {
            [if shape.in_proportion { *simulated } else { self.level }, *simulated].map(|own| own / noise)
        };
        let sizes: Vec<[f64; 2]> = self.simulated_means.iter().zip(&noises).map(sizes).collect();
        let scaled = DMatrix::from_fn(bins, bins, |row, column| {
            let [mut own, long] = covariances[row.abs_diff(column)];
            if row == column {
                own -= (1.0 - shape.long) * rough / self.counts[row];
            }
            sizes[row][0] * own * sizes[column][0] + sizes[row][1] * long * sizes[column][1]
        });
        let mut white = DMatrix::identity(bins, bins);
        self.take_common_off(&mut white, &noises);
        let eigen = SymmetricEigen::new(&white * scaled * &white);
        let basis = eigen.eigenvectors.transpose() * white;
        Spectrum { basis: Arc::new(basis), eigenvalues: eigen.eigenvalues.as_slice().to_vec() }
    }

    /// What all differences have in common, each part one standard deviation long: of contact, and of the elements.
    fn directions(&self) -> impl Iterator<Item = &DVector<f64>> {
        self.of_contact.iter().map(|(_, own)| own).chain(self.mesh.iter().flat_map(MeshError::doubts))
    }

    /// Multiplies columns of differences over these deviations by (I + U Uᵀ)^(−1/2), with the common parts over the deviations as
    /// U (equation 331c).
    fn take_common_off(&self, columns: &mut DMatrix<f64>, deviations: &[f64]) {
        let all: Vec<&DVector<f64>> = self.directions().collect();
        if all.is_empty() {
            return;
        }
        let over = |row: usize, part: usize| all[part][row] / deviations[row];
        let parts = DMatrix::from_fn(self.bins(), all.len(), over).svd(true, false);
        for (own, size) in parts.u.iter().flat_map(DMatrix::column_iter).zip(parts.singular_values.iter()) {
            let along = own.transpose() * &*columns;
            *columns += own * along * ((1.0 + size * size).sqrt().recip() - 1.0);
        }
    }

    /// Takes up the error of the elements, or none; one that is far below the noise counts as none. By how much the correction
    /// changes, root mean square over the bins, over the noise.
    pub(super) fn set_mesh(&mut self, error: Option<MeshError>) -> f64 {
        let none = || DVector::zeros(self.bins());
        let before = self.mesh.as_ref().map_or_else(none, |own| own.correction.clone());
        let error = error.filter(|error| error.correction.norm() > LEAST_NOISE * self.measured.norm());
        let change = error.as_ref().map_or_else(none, |own| own.correction.clone()) - before;
        let over = self.over_noise(&change);
        self.mesh = error;
        self.spectrum = self.spectrum_of(self.shape);
        root_mean_square(over.as_slice())
    }

    /// The error of the elements, where there is one that counts.
    pub(super) fn mesh(&self) -> Option<&MeshError> {
        self.mesh.as_ref()
    }

    /// The order at which the signal converges with its elements.
    pub(super) fn mesh_order(&self) -> Option<f64> {
        self.mesh.as_ref().map(|own| own.order)
    }

    /// The correction for the elements, and a column for each part that it is uncertain by, as residuals.
    pub(super) fn whitened_mesh(&self, share: f64) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let residuals = |own: &DVector<f64>| DVector::from_vec(self.whitened(&self.over_noise(own), share));
        let own = self.mesh.as_ref()?;
        Some((residuals(&own.correction), DMatrix::from_columns(&own.doubts().map(residuals).collect::<Vec<_>>())))
    }

    /// Differences of the means of a simulated signal, corrected for its elements, from the measured ones.
    fn difference(&self, simulated: &Series) -> Result<DVector<f64>, String> {
        let difference = DVector::from_vec(self.means(simulated)?) - &self.measured;
        Ok(match &self.mesh {
            Some(own) => difference + &own.correction,
            None => difference,
        })
    }

    /// Whether recordings are uncertain in their times of contact, and in their impact speeds.
    pub(super) fn contact_errors(&self) -> [bool; 2] {
        [0, 1].map(|place| self.contact[(place, place)] > 0.0)
    }

    /// Takes what the recordings are uncertain in at contact as an error of the differences: how these change with the time of
    /// contact, by the signal that is seen `later` by a time, and with the speed (per m/s).
    pub(super) fn add_contact(
        &mut self,
        later: impl Fn(f64) -> Series,
        of_speed: Option<DVector<f64>>,
    ) -> Result<(), String> {
        let deviation = self.contact.map_diagonal(f64::sqrt);
        let mut factor = Matrix2::zeros();
        let of_speed = of_speed.filter(|_| deviation[1] > 0.0).unwrap_or_else(|| DVector::zeros(self.bins()));
        let mut of_time = DVector::zeros(self.bins());
        if deviation[0] > 0.0 {
            let [after, before] = [deviation[0], -deviation[0]].map(|by| self.means(&later(by)).map(DVector::from_vec));
            of_time = (before? - after?) / (2.0 * deviation[0]);
            factor[(0, 0)] = deviation[0];
            factor[(1, 0)] = self.contact[(0, 1)] / deviation[0];
        }
        factor[(1, 1)] = (self.contact[(1, 1)] - factor[(1, 0)] * factor[(1, 0)]).max(0.0).sqrt();
        let part = |column: usize| {
            let error: Vector2<f64> = factor.column(column).into();
            (error, &of_time * error[0] + &of_speed * error[1])
        };
        self.of_contact = [0, 1].map(part).into_iter().filter(|(_, own)| own.norm() > 0.0).collect();
        self.spectrum = self.spectrum_of(self.shape);
        Ok(())
    }

    /// The error of the time of contact (s) and of the impact speed (m/s) that differences over the noise show, for a model's
    /// error of `share`.
    pub(super) fn contact_found(&self, scaled: &DVector<f64>, share: f64) -> Vector2<f64> {
        let whitened = DVector::from_vec(self.whitened(scaled, share));
        let of_part = |(error, own): &(Vector2<f64>, DVector<f64>)| {
            error * DVector::from_vec(self.whitened(&self.over_noise(own), share)).dot(&whitened)
        };
        self.of_contact.iter().map(of_part).sum()
    }

    /// Takes the roughness of a simulated signal near the best parameters, which contact makes, as noise beside that of the
    /// recordings, and its size as that of errors as large as the signal.
    pub(super) fn set_simulated(&mut self, simulated: &Series) -> Result<(), String> {
        let means = self.means(simulated)?;
        self.simulated = third_difference(&means);
        self.simulated_means = means;
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
        self.counts.iter_mut().for_each(|own| *own /= factor * factor);
        for (error, own) in &mut self.of_contact {
            *error *= factor;
            *own *= factor;
        }
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

    /// Differences over these.
    fn over_noise(&self, differences: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(self.bins(), differences.iter().zip(self.noises()).map(|(own, noise)| own / noise))
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
    pub(super) fn means(&self, simulated: &Series) -> Result<Vec<f64>, String> {
        means(simulated, &self.edges, "simulated signal")
    }

    /// Differences of the means of a simulated signal from the measured ones, each over the noise.
    pub(super) fn scaled(&self, simulated: &Series) -> Result<DVector<f64>, String> {
        Ok(self.over_noise(&self.difference(simulated)?))
    }

    /// ‖simulated − measured‖/‖measured‖ over the bins.
    pub(super) fn relative_error(&self, simulated: &Series) -> Result<f64, String> {
        Ok(self.difference(simulated)?.norm() / self.measured.norm())
    }

    /// The same of the signal as simulated, without the correction for its elements.
    pub(super) fn relative_error_as_simulated(&self, simulated: &Series) -> Result<f64, String> {
        Ok((DVector::from_vec(self.means(simulated)?) - &self.measured).norm() / self.measured.norm())
    }

    /// Independent residuals of unit variance of differences over the noise, for a model's error of `share`.
    pub(super) fn whitened(&self, scaled: &DVector<f64>, share: f64) -> Vec<f64> {
        let rotated = &*self.spectrum.basis * scaled;
        rotated.iter().zip(self.spectrum.variances(share)).map(|(value, variance)| value / variance.sqrt()).collect()
    }

    /// The same for an error that is independent from bin to bin.
    pub(super) fn plain(&self, scaled: &DVector<f64>, share: f64) -> Vec<f64> {
        let deviations: Vec<f64> = self.noises().map(|noise| noise.hypot(share * self.level)).collect();
        let residual = |((value, noise), deviation): ((&f64, f64), &f64)| value * noise / deviation;
        let residuals: Vec<f64> = scaled.iter().zip(self.noises()).zip(&deviations).map(residual).collect();
        let mut residuals = DMatrix::from_column_slice(self.bins(), 1, &residuals);
        self.take_common_off(&mut residuals, &deviations);
        residuals.as_slice().to_vec()
    }
}

/// What signals of a test leave: each with its errors, and its differences over the noise.
pub(super) struct Left<'a> {
    pub(super) signals: Vec<(&'a ErrorModel, DVector<f64>)>,
    pub(super) weight: f64,
    /// The shapes that its error may have.
    pub(super) shapes: &'a [Shape],
}

/// The shape of a test's error that is most likely, and logarithms of likelihoods.
pub(super) struct Likeliest {
    pub(super) shape: Shape,
    /// Of that shape.
    pub(super) log: f64,
    /// Of the shape which its signals have; −∞ if it is not among those that it may have.
    pub(super) of_present: f64,
    /// The mean over those that it may have.
    pub(super) mean: f64,
}

/// The share of the model's error, where none is given, for which what tests leave is most likely, zero where noise explains it; and
/// of each test the shape that is most likely then.
pub(super) fn most_likely(tests: &[Left<'_>], given: Option<f64>) -> (f64, Vec<Likeliest>) {
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
        let present = left.shapes.iter().position(|own| Some(*own) == has);
        Likeliest {
            shape: left.shapes[most],
            log: shapes[most][best],
            of_present: present.map_or(f64::NEG_INFINITY, |own| shapes[own][best]),
            mean: log_mean_exp(shapes.iter().map(|own| own[best])),
        }
    };
    (shares[best], tests.iter().zip(&all).map(shape).collect())
}

/// Of each test, the shape that is likeliest of all that there are, and by how much the logarithm of the mean likelihood of all is
/// larger than that of the shapes which the test may have: the best of so many is always likelier than a right one.
pub(super) fn likelier(tests: &[Left<'_>]) -> Vec<(Shape, f64)> {
    let all = Shape::all(None);
    let any = tests.iter().map(|own| Left { signals: own.signals.clone(), weight: own.weight, shapes: &all });
    let any: Vec<Left<'_>> = any.collect();
    let [any, own] = [&any[..], tests].map(|tests| most_likely(tests, None).1);
    any.into_iter().zip(own).map(|(any, own)| (any.shape, any.mean - own.mean)).collect()
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
fn means(series: &Series, edges: &[f64], of: &str) -> Result<Vec<f64>, String> {
    let (time, values) = (series.time(), series.values());
    let mean = |bin: &[f64]| {
        let [from, to] = [bin[0], bin[1]];
        // Where rounding puts the last edge behind the last sample, that sample counts.
        let at = |place: f64| {
            let inside = place.clamp(*time.first()?, *time.last()?);
            ((inside - place).abs() <= 1e-9 * (to - from)).then(|| series.value_at(inside))?
        };
        let ends = at(from).zip(at(to)).ok_or_else(|| gap(of, from, to))?;
        let start = time.partition_point(|t| *t <= from);
        let end = time.partition_point(|t| *t < to).max(start);
        let (mut sum, mut before) = (0.0, (from, ends.0));
        for next in time[start..end].iter().copied().zip(values[start..end].iter().copied()).chain([(to, ends.1)]) {
            sum += 0.5 * (before.1 + next.1) * (next.0 - before.0);
            before = next;
        }
        let mean = sum / (to - from);
        if mean.is_finite() { Ok(mean) } else { Err(gap(of, from, to)) }
    };
    edges.windows(2).map(mean).collect()
}

/// The mean square noise of means over bins of so many intervals between samples, over that of their third differences
/// (docs/methods.md, equation 331b).
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
