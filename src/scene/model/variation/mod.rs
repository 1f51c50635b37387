//! `[variation]`: what varies from run to run of a sweep, and the values of each run.

mod factor;

use super::{Checker, checked};
use crate::scenario::{self, Assignment, Document, Method};
use base::diagnostic::Diagnostic;
pub use factor::{Factor, Input, Level, Values, distribution};
use uncertainty::correlation::Correlation;
use uncertainty::design::{self, Levels, Method as Sampling};

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
        self.correlation.is_none() && !self.is_table()
    }

    /// Whether the runs are the rows of a table.
    pub fn is_table(&self) -> bool {
        matches!(self.method, Method::Table(_))
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
    checked(document, document.scenario(), |scenario, found| {
        // None where there is no table, or with its mistakes.
        Some(scenario.variation.as_ref().and_then(|written| check(written, found)))
    })
}

/// Checks the table as written.
pub(super) fn check(written: &scenario::Variation, checker: &mut Checker<'_>) -> Option<Variation> {
    let before = checker.found.0.len();
    let keys = checker.document.varied_keys();
    let factors = match &written.method {
        Some(Method::Table(_)) => {
            if let Some(key) = keys.first() {
                let message = format!("`{}` varies by the table", key.path);
                checker.found.report_with(&key.span, message, "leave it out, or leave `method` out");
            }
            let file = checker.file("variation.method.table")?;
            let span = checker.document.span("variation.method.table");
            factor::read(&file, &span, checker)
        }
        _ => {
            let factor = |key| Factor::read(key, &mut *checker);
            keys.iter().filter_map(factor).collect()
        }
    };
    repeated(&factors, checker);
    if factors.is_empty() && keys.is_empty() && checker.found.0.len() == before {
        checker.report_with("variation", "no key varies", "write one like \"impactor.mass\" = [\"10 kg\", \"12 kg\"]");
    }
    let method = method(written, &factors, checker);
    let correlation = written.correlation.as_ref().and_then(|written| correlation(written, &factors, checker));
    let samples = written.samples.map(|samples| samples as usize);
    if checker.found.0.len() > before {
        return None;
    }
    Some(Variation { factors, method, samples, seed: written.seed, correlation })
}

/// A key that varies twice, or of which a part varies too.
fn repeated(factors: &[Factor], checker: &mut Checker<'_>) {
    for (place, factor) in factors.iter().enumerate() {
        let is_part = |inner: &str, whole: &str| inner.strip_prefix(whole).is_some_and(|rest| rest.starts_with('.'));
        let other = factors[..place].iter().find(|other| {
            other.path == factor.path || is_part(&other.path, &factor.path) || is_part(&factor.path, &other.path)
        });
        if let Some(other) = other {
            let mistake = Diagnostic::new(format!("`{}` varies already", factor.path)).at(&factor.span);
            checker.found.0.push(mistake.label(&other.span, "here"));
        }
    }
}

/// The method, which must suit the values of the keys.
fn method(written: &scenario::Variation, factors: &[Factor], checker: &mut Checker<'_>) -> Method {
    let continuous = factors.iter().find(|factor| matches!(factor.values, Values::Distribution(_)));
    match (&written.method, continuous) {
        (None, None) => Method::Grid,
        (None, Some(_)) => Method::Sobol,
        (Some(Method::Grid), Some(factor)) => {
            let message =
                format!("a grid needs a list or a range of every key, and `{}` has a distribution", factor.path);
            checker.report_with(METHOD, message, "write { range = [low, high], count = 5 }, or another method");
            Method::Grid
        }
        (Some(method), _) => {
            if let (Method::Grid | Method::Table(_), Some(_)) = (method, written.samples) {
                checker.out_of_place("variation.samples", "a grid and a table have the runs that they list");
            }
            method.clone()
        }
    }
}

/// The correlation of all factors; those that are not named are independent.
fn correlation(written: &scenario::Correlation, factors: &[Factor], checker: &mut Checker<'_>) -> Option<Correlation> {
    let mut places = Vec::new();
    for (row, key) in written.keys.iter().enumerate() {
        let at = format!("{CORRELATION}.keys.{row}");
        match factors.iter().position(|factor| factor.path == *key) {
            None => checker.report(&at, format!("`{key}` does not vary")),
            Some(place) if matches!(factors[place].values, Values::Levels(_)) => {
                checker.report_with(&at, format!("`{key}` has no distribution"), "a list cannot be correlated");
            }
            Some(place) if places.contains(&place) => checker.report(&at, format!("`{key}` is named twice")),
            Some(place) => places.push(place),
        }
    }
    if places.len() < written.keys.len() {
        return None;
    }
    let count = places.len();
    if written.matrix.len() != count || written.matrix.iter().any(|row| row.len() != count) {
        checker.report(&format!("{CORRELATION}.matrix"), format!("expected {count} rows of {count} coefficients"));
        return None;
    }
    let mut whole = vec![vec![0.0; factors.len()]; factors.len()];
    (0..factors.len()).for_each(|place| whole[place][place] = 1.0);
    for (row, coefficients) in places.iter().zip(&written.matrix) {
        for (column, coefficient) in places.iter().zip(coefficients) {
            whole[*row][*column] = *coefficient;
        }
    }
    let refused = |error: uncertainty::Error| checker.report(&format!("{CORRELATION}.matrix"), error.to_string());
    Correlation::new(&whole).map_err(refused).ok()
}

/// Most runs of a sweep.
const MOST: usize = 1_000_000;

/// The values of one run, in the order of the factors.
#[derive(Clone, Debug)]
pub struct Point {
    /// A value of each factor.
    pub levels: Vec<Level>,
}

/// Which values all runs of a sweep have; those of a run are made when it is at hand.
#[derive(Clone, Debug)]
pub enum Points {
    /// The rows of a table, as many.
    Rows(usize),
    /// Places in the unit cube, of each factor the probability of at most its value.
    Places(Vec<Vec<f64>>),
}

impl Points {
    /// Number of runs.
    pub fn len(&self) -> usize {
        match self {
            Points::Rows(count) => *count,
            Points::Places(places) => places.len(),
        }
    }

    /// Whether there are no runs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Variation {
    /// The points, of which there are `samples` in place of the number that is written.
    ///
    /// # Errors
    /// Their number is not known, or the method does not suit the factors.
    pub fn points(&self, samples: Option<usize>) -> Result<Points, Diagnostic> {
        let listed = self.listed();
        let count = match (listed, samples) {
            (Some(listed), Some(samples)) if samples != listed => {
                let message = format!("the variation has {listed} runs, which `-n` does not change");
                return Err(
                    Diagnostic::new(message).hint("leave `-n` out, or choose another method: method = \"sobol\"")
                );
            }
            (Some(listed), _) => listed,
            (None, samples) => samples.or(self.samples).ok_or_else(|| {
                Diagnostic::new("the number of runs is not given")
                    .hint("write samples = 200 in [variation], or give -n 200")
            })?,
        };
        if count > MOST {
            return Err(Diagnostic::new(format!("the variation has more than {MOST} runs")));
        }
        if self.is_table() {
            return Ok(Points::Rows(count));
        }
        let chosen = design::points(self.sampling(), &self.levels(), count, self.seed)
            .map_err(|error| Diagnostic::new(error.to_string()))?;
        Ok(self.coupled(chosen))
    }

    /// The points at places of independent factors.
    pub fn coupled(&self, places: Vec<Vec<f64>>) -> Points {
        Points::Places(match &self.correlation {
            Some(correlation) => places.iter().map(|place| correlation.apply(place)).collect(),
            None => places,
        })
    }

    /// The values of the run at `place` among `points`.
    pub fn point(&self, points: &Points, place: usize) -> Point {
        match points {
            Points::Rows(_) => Point { levels: self.factors.iter().map(|factor| factor.level(place)).collect() },
            Points::Places(places) => self.point_at(&places[place]),
        }
    }

    /// The changes of the scenario that make it the one of a run.
    pub fn assignments(&self, point: &Point) -> Vec<Assignment> {
        self.factors.iter().zip(&point.levels).map(|(factor, level)| factor.assignment(level)).collect()
    }

    /// Number of runs, where the scenario says it.
    pub fn runs(&self) -> Option<usize> {
        self.listed().or(self.samples)
    }

    /// Number of runs of a grid or a table.
    fn listed(&self) -> Option<usize> {
        let counts = || self.factors.iter().map(|factor| factor.values.count().unwrap_or(1));
        match self.method {
            Method::Grid => Some(counts().fold(1, usize::saturating_mul)),
            Method::Table(_) => counts().next(),
            Method::LatinHypercube | Method::Sobol | Method::Random => None,
        }
    }

    fn sampling(&self) -> Sampling {
        match self.method {
            Method::Grid | Method::Table(_) => Sampling::Grid,
            Method::LatinHypercube => Sampling::LatinHypercube,
            Method::Sobol => Sampling::Sobol,
            Method::Random => Sampling::Random,
        }
    }

    fn levels(&self) -> Vec<Levels> {
        let levels = |factor: &Factor| factor.values.count().map_or(Levels::Continuous, Levels::Count);
        self.factors.iter().map(levels).collect()
    }

    fn point_at(&self, place: &[f64]) -> Point {
        let at = |(factor, place): (&Factor, &f64)| match &factor.values {
            Values::Levels(levels) => factor.level((place * levels.len() as f64) as usize),
            Values::Distribution(distribution) => factor.number(distribution.quantile(*place)),
        };
        Point { levels: self.factors.iter().zip(place).map(at).collect() }
    }
}
