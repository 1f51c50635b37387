//! Relaxation of film: Prony series of a modulus over time, in terms that have a share and a time each (theory.md, equation
//! 280), and files of measured moduli.

use std::path::Path;

use nalgebra::{DMatrix, DVector};

use super::nonnegative::nonnegative_least_squares;
use crate::error::{Error, refusal};
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{MeasuredChannel, Measurement, with_unit};
use base::findings;
use base::units::{Dimension, Pressure, Time};
use membrane::material::PronyTerm;

/// A relaxation modulus E(t) = E₀ (1 − Σ g_k (1 − exp(−t/τ_k))).
#[derive(Clone, Debug, PartialEq)]
pub struct Prony {
    /// E₀, the instantaneous modulus, Pa.
    pub instantaneous: f64,
    /// g_k and τ_k by increasing time; the shares add up to less than one.
    pub terms: Vec<PronyTerm>,
}

/// A series fitted to a measured modulus.
#[derive(Clone, Debug, PartialEq)]
pub struct PronyFit {
    /// The series.
    pub prony: Prony,
    /// Time (s) and measured modulus (Pa), by increasing time.
    pub measured: Vec<[f64; 2]>,
    /// R² = 1 − Σ (E − Ê)²/Σ (E − mean E)².
    pub r_squared: f64,
    /// Root mean square of (Ê − E)/E.
    pub relative_rms: f64,
    /// Largest |Ê − E|/E.
    pub largest_error: f64,
    /// Time at which it is, s.
    pub at_time: f64,
    /// Reports of the fit.
    pub warnings: Vec<Warning>,
}

/// Most terms of a series.
const MOST_TERMS: usize = 64;

impl Prony {
    /// E(t), Pa.
    pub fn modulus(&self, time: f64) -> f64 {
        let relaxed: f64 = self.terms.iter().map(|term| term.share * -(-time / term.time).exp_m1()).sum();
        self.instantaneous * (1.0 - relaxed)
    }

    /// Σ g_k.
    pub fn relaxing(&self) -> f64 {
        self.terms.iter().map(|term| term.share).sum()
    }

    /// E∞, the modulus that is left, Pa.
    pub fn equilibrium(&self) -> f64 {
        self.instantaneous * (1.0 - self.relaxing())
    }
}

/// The series of at most `terms` terms, at times evenly spaced in their logarithm from the first to the last measured
/// one, with the least Σ ((Ê − E)/E)² of shares that are not negative.
///
/// Where nothing would be left in the end the slowest times are left out, since the data do not show how the last of
/// the modulus relaxes.
pub fn fit_prony(points: &[[f64; 2]], terms: usize) -> Result<PronyFit, Error> {
    let measured = checked(points, terms)?;
    let [first, last] = [measured[0][0], measured[measured.len() - 1][0]];
    if first == last {
        return Err(refusal!("all moduli are at one time"));
    }
    // The times are fixed, since fitted ones make exponentials nearly dependent: the fit is linear, with one minimum.
    let step = (last / first).ln() / (terms.max(2) - 1) as f64;
    let times: Vec<f64> = match terms {
        1 => vec![(first * last).sqrt()],
        _ => (0..terms).map(|k| first * (step * k as f64).exp()).collect(),
    };
    let mut warnings = Vec::new();
    let (times, moduli) = (0..=times.len())
        .rev()
        .find_map(|count| Some((&times[..count], solved(&measured, &times[..count])?)))
        .ok_or_else(no_relaxation)?;
    let instantaneous: f64 = moduli.iter().sum();
    let pairs = times.iter().zip(&moduli[1..]).filter(|(_, modulus)| **modulus > 0.0);
    let kept: Vec<PronyTerm> =
        pairs.map(|(time, modulus)| PronyTerm { share: modulus / instantaneous, time: *time }).collect();
    if kept.is_empty() {
        return Err(no_relaxation());
    }
    if kept.len() < terms {
        warnings.push(Warning::TermsLeftOut { asked: terms, left: kept.len() });
    }
    let prony = Prony { instantaneous, terms: kept };
    Ok(PronyFit { warnings, ..compared(prony, measured) })
}

fn no_relaxation() -> Error {
    refusal!("the modulus does not relax: no term has a share")
}

/// A series beside a measured modulus.
fn compared(prony: Prony, measured: Vec<[f64; 2]>) -> PronyFit {
    let errors: Vec<f64> = measured.iter().map(|[time, modulus]| prony.modulus(*time) / modulus - 1.0).collect();
    let count = measured.len() as f64;
    let mean = measured.iter().map(|point| point[1]).sum::<f64>() / count;
    let left: f64 = measured.iter().zip(&errors).map(|(point, error)| (error * point[1]).powi(2)).sum();
    let scatter: f64 = measured.iter().map(|point| (point[1] - mean).powi(2)).sum();
    let worst = (0..errors.len()).max_by(|a, b| errors[*a].abs().total_cmp(&errors[*b].abs())).unwrap_or(0);
    PronyFit {
        r_squared: 1.0 - left / scatter,
        relative_rms: (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt(),
        largest_error: errors[worst].abs(),
        at_time: measured[worst][0],
        prony,
        measured,
        warnings: vec![],
    }
}

/// The points by increasing time.
fn checked(points: &[[f64; 2]], terms: usize) -> Result<Vec<[f64; 2]>, Error> {
    if !(1..=MOST_TERMS).contains(&terms) {
        return Err(refusal!("expected 1 to {MOST_TERMS} terms, found {terms}"));
    }
    if points.len() <= terms {
        let samples = points.len();
        return Err(refusal!("{samples} measured moduli for {terms} terms: there must be more moduli than terms"));
    }
    let is_positive = |value: f64| value.is_finite() && value > 0.0;
    if let Some(row) = points.iter().position(|point| !point.iter().all(|value| is_positive(*value))) {
        let [time, modulus] = points[row];
        let row = row + 1;
        return Err(refusal!("time and modulus are above zero, and row {row} has {time} s and {modulus} Pa"));
    }
    let mut measured = points.to_vec();
    // R² would be no number.
    if measured.iter().all(|point| point[1] == measured[0][1]) {
        return Err(no_relaxation());
    }
    measured.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(measured)
}

/// E∞ and the moduli of the terms at these times; none where nothing would be left in the end.
fn solved(measured: &[[f64; 2]], times: &[f64]) -> Option<Vec<f64>> {
    // Rows over the measured modulus, so that the sum of squares is that of relative errors: moduli span decades.
    let entry = |row: usize, column: usize| {
        let [time, modulus] = measured[row];
        let left = if column == 0 { 1.0 } else { (-time / times[column - 1]).exp() };
        left / modulus
    };
    let matrix = DMatrix::from_fn(measured.len(), times.len() + 1, entry);
    let moduli = nonnegative_least_squares(&matrix, &DVector::from_element(measured.len(), 1.0))?;
    // E∞ = 0 would say that film flows without end, which no measurement of finite duration shows.
    (moduli[0] > 0.0).then(|| moduli.as_slice().to_vec())
}

findings! {
    /// A doubt about a fit that continues.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        TermsLeftOut {
            asked: usize, "number of terms that were asked for" => "asked";
            left: usize, "number of terms that are left" => "left";
        } = "prony-terms-left-out", Note;
            meaning "terms of a Prony series have no share in the best fit and are left out";
            remedy "none is needed; runs cost less with fewer terms";
            message "{left} of {asked} terms are left: the others have no share in the best fit";
    }
}

/// Difference of temperatures of two rows, K, from which on they are of two relaxations.
const NEXT_TEMPERATURE: f64 = 2.0;

/// Reads the relaxation at `path`, with the columns `time` and `modulus`: time (s) and modulus (Pa) of each row.
pub fn read_relaxation(path: &Path, options: &ReadOptions) -> Result<Vec<[f64; 2]>, Error> {
    let all = ReadOptions { channels: ChannelSelection::All, ..options.clone() };
    let table = file::columns(path, &all)?;
    points(&table, options.time.as_deref()).map_err(|error| error.in_file(path))
}

fn points(table: &Measurement, time: Option<&str>) -> Result<Vec<[f64; 2]>, Error> {
    let times = values(table, time.unwrap_or("time"), Time::DIMENSION)?;
    let moduli = values(table, "modulus", Pressure::DIMENSION)?;
    let is_temperature = |channel: &&MeasuredChannel| channel.name.starts_with("temperature") || channel.name == "T";
    if let Some(channel) = table.channels.iter().find(is_temperature)
        && let (Some(least), Some(most)) = (channel.series.smallest(), channel.series.largest())
        && most[1] - least[1] > NEXT_TEMPERATURE
    {
        let error = refusal!("`{}` changes: the file holds relaxations at several temperatures", channel.label);
        return Err(error.with_hint("give one of them, or the master curve that the program of the DMA makes of them"));
    }
    let rows: Vec<[f64; 2]> = times.iter().zip(moduli).map(|(time, modulus)| [*time, *modulus]).collect();
    match rows.iter().position(|row| row.iter().any(|value| !value.is_finite())) {
        Some(row) => Err(refusal!("row {} lacks a number", row + 1)),
        None => Ok(rows),
    }
}

/// The values of the column `name`, in the SI unit of a dimension.
fn values<'t>(table: &'t Measurement, name: &str, dimension: Dimension) -> Result<&'t [f64], Error> {
    let channel = table
        .channel(name)
        .map_err(|error| error.with_hint("a relaxation has the columns `time` and `modulus`; --columns names them"))?;
    let series = channel.quantity(dimension);
    Ok(series.map_err(|error| with_unit(error, |_, _| "--unit".to_owned()))?.values())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn virtual_points(prony: &Prony, [from, to]: [f64; 2], count: usize) -> Vec<[f64; 2]> {
        let time = |k: usize| from * (to / from).powf(k as f64 / (count - 1) as f64);
        (0..count).map(|k| [time(k), prony.modulus(time(k))]).collect()
    }

    fn term(share: f64, time: f64) -> PronyTerm {
        PronyTerm { share, time }
    }

    #[test]
    fn known_terms_are_found_again() {
        let terms = vec![term(0.2, 1e-3), term(0.1, 1e-1), term(0.3, 10.0), term(0.05, 1e3)];
        let known = Prony { instantaneous: 2e8, terms };
        let found = fit_prony(&virtual_points(&known, [1e-3, 1e3], 61), 7).expect("a fit");
        assert!((found.prony.instantaneous / 2e8 - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!(found.prony.terms.len(), 4, "{found:?}");
        for (found, known) in found.prony.terms.iter().zip(&known.terms) {
            assert!((found.time / known.time - 1.0).abs() < 1e-9 && (found.share - known.share).abs() < 1e-6);
        }
        assert!(found.largest_error < 1e-6 && found.prony.relaxing() < 1.0);
        assert_eq!(found.warnings, [Warning::TermsLeftOut { asked: 7, left: 4 }]);
        assert!((found.prony.equilibrium() / (0.35 * 2e8) - 1.0).abs() < 1e-6);
    }

    /// The closer the times, the smaller the error of terms between them.
    #[test]
    fn times_between_the_terms_are_followed() {
        let known = Prony { instantaneous: 1e9, terms: vec![term(0.4, 0.02), term(0.3, 3.0)] };
        let points = virtual_points(&known, [1e-4, 1e3], 100);
        let [coarse, fine] = [15, 43].map(|terms| fit_prony(&points, terms).expect("a fit"));
        assert!(coarse.largest_error < 0.03 && coarse.r_squared > 0.999, "{coarse:?}");
        assert!(fine.largest_error < 5e-3 && fine.r_squared > 0.9999, "{fine:?}");
    }

    #[test]
    fn a_modulus_that_relaxes_to_nothing_leaves_a_rest() {
        let points: Vec<[f64; 2]> =
            (0..60).map(|k| 10.0_f64.powf(f64::from(k) / 10.0 - 3.0)).map(|t| [t, 1e6 / (1.0 + t)]).collect();
        let found = fit_prony(&points, 10).expect("a fit");
        assert!(found.prony.relaxing() < 1.0 && found.prony.equilibrium() > 0.0, "{found:?}");
    }
}
