//! `[variation]`: what varies from run to run of a sweep, and the values of each run.

mod factor;
mod points;
mod table;

use uncertainty::correlation::{Correlation, CorrelationError};

use super::ModelDiagnostics;
use crate::scenario::{self, Document, Method};
use base::diagnostic::Diagnostic;
pub use factor::{Factor, Input, Level, Values};
pub use points::{Point, Points, PointsError};

const METHOD: &str = "variation.method";
const CORRELATION: &str = "variation.correlation";

/// The keys that vary from run to run of a sweep, and how.
#[derive(Clone, Debug)]
pub struct Variation {
    /// The keys that vary, in the order in which they are written.
    pub factors: Vec<Factor>,
    /// How the values of the runs are chosen.
    pub method: Method,
    /// Number of runs, where it is written.
    pub samples: Option<usize>,
    /// The start of the random numbers: equal seeds give equal values.
    pub seed: u64,
    /// Correlation of all factors.
    correlation: Option<Correlation>,
}

impl Variation {
    /// Whether the values of different keys do not depend on each other, as the rows of a table may.
    pub fn is_independent(&self) -> bool {
        self.correlation.is_none() && !matches!(self.method, Method::Table(_))
    }

    /// How the values of the runs are chosen, in words.
    pub fn description(&self) -> String {
        let seed = self.seed;
        let correlated = if self.correlation.is_some() { ", with correlation" } else { "" };
        match &self.method {
            Method::Grid => "every combination of the values (grid)".into(),
            Method::Table(path) => format!("the rows of {}", path.display()),
            Method::LatinHypercube => format!("Latin hypercube, seed {seed}{correlated}"),
            Method::Sobol => format!("scrambled Sobol' sequence, seed {seed}{correlated}"),
            Method::Random => format!("independent random values, seed {seed}{correlated}"),
        }
    }
}

/// The table `[variation]` of a scenario, checked; `None` where it has none.
///
/// # Errors
/// All mistakes of the table, at once.
pub fn variation(document: &Document) -> Result<Option<Variation>, Vec<Diagnostic>> {
    let (written, mistakes) = document.scenario();
    let mut mistakes = ModelDiagnostics::new(document, mistakes);
    let found = written.and_then(|scenario| scenario.variation).and_then(|written| check(&written, &mut mistakes));
    if mistakes.found.0.is_empty() { Ok(found) } else { Err(mistakes.into_mistakes()) }
}

/// Checks the table as written.
pub(super) fn check(written: &scenario::Variation, mistakes: &mut ModelDiagnostics<'_>) -> Option<Variation> {
    let before = mistakes.found.0.len();
    let keys = mistakes.document.varied_keys();
    let factors = match &written.method {
        Some(Method::Table(_)) => {
            if let Some(key) = keys.first() {
                let mistake = Diagnostic::new(format!("`{}` varies by the table", key.path)).at(&key.span);
                mistakes.found.0.push(mistake.hint("leave it out, or leave `method` out"));
            }
            let file = mistakes.file("variation.method.table")?;
            let span = mistakes.document.span("variation.method.table");
            table::read(&file, &span, mistakes)
        }
        _ => {
            let factor = |key| Factor::read(key, &mut *mistakes);
            keys.iter().filter_map(factor).collect()
        }
    };
    repeated(&factors, mistakes);
    if factors.is_empty() && keys.is_empty() && mistakes.found.0.len() == before {
        mistakes.report_with("variation", "no key varies", "write one like \"impactor.mass\" = [\"10 kg\", \"12 kg\"]");
    }
    let method = method(written, &factors, mistakes);
    let correlation = written.correlation.as_ref().and_then(|written| correlation(written, &factors, mistakes));
    let samples = written.samples.map(|samples| samples as usize);
    if mistakes.found.0.len() > before {
        return None;
    }
    Some(Variation { factors, method, samples, seed: written.seed, correlation })
}

/// A key that varies twice, or of which a part varies too.
fn repeated(factors: &[Factor], mistakes: &mut ModelDiagnostics<'_>) {
    for (place, factor) in factors.iter().enumerate() {
        let is_part = |inner: &str, whole: &str| inner.strip_prefix(whole).is_some_and(|rest| rest.starts_with('.'));
        let other = factors[..place].iter().find(|other| {
            other.path == factor.path || is_part(&other.path, &factor.path) || is_part(&factor.path, &other.path)
        });
        if let Some(other) = other {
            let mistake = Diagnostic::new(format!("`{}` varies already", factor.path)).at(&factor.span);
            mistakes.found.0.push(mistake.label(&other.span, "here"));
        }
    }
}

/// The method, which must suit the values of the keys.
fn method(written: &scenario::Variation, factors: &[Factor], mistakes: &mut ModelDiagnostics<'_>) -> Method {
    let continuous = factors.iter().find(|factor| matches!(factor.values, Values::Distribution(_)));
    match (&written.method, continuous) {
        (None, None) => Method::Grid,
        (None, Some(_)) => Method::Sobol,
        (Some(Method::Grid), Some(factor)) => {
            let message =
                format!("a grid needs a list or a range of every key, and `{}` has a distribution", factor.path);
            mistakes.report_with(METHOD, message, "write { range = [low, high], count = 5 }, or another method");
            Method::Grid
        }
        (Some(method), _) => {
            if let (Method::Grid | Method::Table(_), Some(_)) = (method, written.samples) {
                mistakes.out_of_place("variation.samples", "a grid and a table have the runs that they list");
            }
            method.clone()
        }
    }
}

/// The correlation of all factors; those that are not named are independent.
fn correlation(
    written: &scenario::Correlation,
    factors: &[Factor],
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Correlation> {
    let mut places = Vec::new();
    for (row, key) in written.keys.iter().enumerate() {
        let at = format!("{CORRELATION}.keys.{row}");
        match factors.iter().position(|factor| factor.path == *key) {
            None => mistakes.report(&at, format!("`{key}` does not vary")),
            Some(place) if matches!(factors[place].values, Values::Levels(_)) => {
                mistakes.report_with(&at, format!("`{key}` has no distribution"), "a list cannot be correlated");
            }
            Some(place) if places.contains(&place) => mistakes.report(&at, format!("`{key}` is named twice")),
            Some(place) => places.push(place),
        }
    }
    if places.len() < written.keys.len() {
        return None;
    }
    let count = places.len();
    if written.matrix.len() != count || written.matrix.iter().any(|row| row.len() != count) {
        mistakes.report(&format!("{CORRELATION}.matrix"), format!("expected {count} rows of {count} coefficients"));
        return None;
    }
    let mut whole = vec![vec![0.0; factors.len()]; factors.len()];
    (0..factors.len()).for_each(|place| whole[place][place] = 1.0);
    for (row, coefficients) in places.iter().zip(&written.matrix) {
        for (column, coefficient) in places.iter().zip(coefficients) {
            whole[*row][*column] = *coefficient;
        }
    }
    let refused = |error: CorrelationError| mistakes.report(&format!("{CORRELATION}.matrix"), error.to_string());
    Correlation::new(&whole).map_err(refused).ok()
}
