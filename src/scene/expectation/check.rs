//! Expectations in SI units.

use std::path::PathBuf;

use crate::scenario::{self, Amount, Document};
use base::diagnostic::{Diagnostic, Diagnostics};
use lab::signal::{Series, column, csv};

/// Stands for every signal without an entry of its own, and for every warning.
pub(super) const ALL: &str = "*";

/// The demands on the results of a run, SI.
#[derive(Clone, Debug, Default)]
pub struct Expectations {
    /// Bounds of signals by name; those under `*` are last.
    pub signals: Vec<(String, SignalBounds)>,
    /// Bounds of figures by name.
    pub figures: Vec<(String, FigureBounds)>,
    /// Codes of findings that must come.
    pub must: Vec<String>,
    /// Codes of findings that must not come; `*` stands for every other warning.
    pub must_not: Vec<String>,
}

/// How far a signal may be from the recorded one.
#[derive(Clone, Debug, Default)]
pub struct SignalBounds {
    /// Largest distance.
    pub absolute: Option<f64>,
    /// Largest distance over the largest recorded magnitude.
    pub relative: Option<f64>,
    /// Distance in time that is allowed, s.
    pub time: f64,
    /// Least rating by ISO/TS 18571.
    pub rating: Option<f64>,
    /// Lower and upper bound over time.
    pub corridor: Option<[Series; 2]>,
    /// From when to when they hold, s.
    pub window: Option<[f64; 2]>,
}

/// The demand on a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureBounds {
    /// True or false.
    Flag(bool),
    /// Exactly this number.
    Number(f64),
    /// Exactly this text.
    Text(String),
    /// Bounds.
    Bounds {
        /// Least and largest value.
        between: Option<[f64; 2]>,
        /// Largest distance from the recorded figure.
        absolute: Option<f64>,
        /// Largest distance from the recorded figure over its magnitude.
        relative: Option<f64>,
    },
}

impl SignalBounds {
    /// Whether they bound the distance from a recorded signal.
    pub fn needs_recording(&self) -> bool {
        self.absolute.is_some() || self.relative.is_some() || self.rating.is_some()
    }
}

impl FigureBounds {
    /// Whether they bound the distance from a recorded figure.
    pub fn needs_recording(&self) -> bool {
        matches!(self, FigureBounds::Bounds { absolute, relative, .. } if absolute.is_some() || relative.is_some())
    }
}

impl Expectations {
    /// The expectations of the file.
    ///
    /// # Errors
    /// All mistakes of the file, at once.
    pub fn check(document: &Document) -> Result<Expectations, Vec<Diagnostic>> {
        let (written, mistakes) = document.expectations();
        let is_read = mistakes.is_empty();
        let mut check = Check { document, is_read, mistakes: Diagnostics(mistakes) };
        let found = written.map(|written| check.all(&written));
        match found {
            Some(found) if check.mistakes.0.is_empty() => Ok(found),
            _ => Err(check.mistakes.0),
        }
    }

    /// The bounds of a signal.
    pub fn signal(&self, name: &str) -> Option<&SignalBounds> {
        let of = |wanted: &str| self.signals.iter().find(|(own, _)| own == wanted);
        of(name).or_else(|| of(ALL)).map(|(_, bounds)| bounds)
    }
}

struct Check<'a> {
    document: &'a Document,
    /// Whether every key was read: where one was not, another that is missing may be what it stands for.
    is_read: bool,
    mistakes: Diagnostics,
}

impl Check<'_> {
    fn all(&mut self, written: &scenario::Expectations) -> Expectations {
        let signals = written.signals.iter().map(|(name, bounds)| (name.clone(), self.signal(name, bounds)));
        let signals = signals.collect();
        let figures =
            written.figures.iter().filter_map(|(name, bounds)| Some((name.clone(), self.figure(name, bounds)?)));
        let figures = figures.collect();
        let found = Expectations {
            signals,
            figures,
            must: written.warnings.must.clone(),
            must_not: written.warnings.must_not.clone(),
        };
        let both = found.must.iter().find(|code| found.must_not.contains(code));
        if let Some(code) = both {
            let span = self.document.span_of(&["warnings", "must_not"]);
            self.mistakes.report_with(&span, format!("`{code}` must and must not come"), "keep one of both");
        }
        let is_empty = written.signals.is_empty() && written.figures.is_empty();
        if self.is_read && is_empty && found.must.is_empty() && found.must_not.is_empty() {
            let hint = "write [signals], [figures] or [warnings]: `droptower explain expect`";
            self.mistakes.report_with(&self.document.span_of(&["signals"]), "nothing is expected", hint);
        }
        found
    }

    fn signal(&mut self, name: &str, written: &scenario::SignalBounds) -> SignalBounds {
        let found = SignalBounds {
            absolute: written
                .absolute
                .as_ref()
                .and_then(|amount| self.distance(&["signals", name, "absolute"], name, amount)),
            relative: written.relative,
            time: written.time.map_or(0.0, |time| time.0),
            rating: written.rating,
            corridor: written.corridor.as_ref().and_then(|_| self.corridor(name)),
            window: written.window.map(|window| window.map(|time| time.0)),
        };
        if name == ALL && (written.absolute.is_some() || written.corridor.is_some()) {
            let message = "signals have different units: `*` cannot bound them by a value";
            let span = self.document.span_of(&["signals", name]);
            self.mistakes.report_with(&span, message, "give `relative` or `rating`");
        }
        let has_bound = found.needs_recording() || written.absolute.is_some() || written.corridor.is_some();
        if self.is_read && !has_bound {
            let span = self.document.span_of(&["signals", name]);
            let hint = "give absolute, relative, rating or corridor";
            self.mistakes.report_with(&span, format!("nothing bounds `{name}`"), hint);
        }
        if found.window.is_some_and(|[from, to]| from >= to) {
            let span = self.document.span_of(&["signals", name, "window"]);
            self.mistakes.report(&span, "expected a window that ends after it starts");
        }
        found
    }

    fn figure(&mut self, name: &str, written: &scenario::FigureBounds) -> Option<FigureBounds> {
        let bounds = match written {
            scenario::FigureBounds::Flag(flag) => return Some(FigureBounds::Flag(*flag)),
            scenario::FigureBounds::Number(number) => return Some(FigureBounds::Number(*number)),
            scenario::FigureBounds::Text(text) => return Some(FigureBounds::Text(text.clone())),
            scenario::FigureBounds::Bounds(bounds) => bounds,
        };
        if bounds.between.is_none() && bounds.absolute.is_none() && bounds.relative.is_none() {
            if self.is_read {
                let span = self.document.span_of(&["figures", name]);
                let hint = "give between, absolute or relative";
                self.mistakes.report_with(&span, format!("nothing bounds `{name}`"), hint);
            }
            return None;
        }
        let between = bounds.between.as_ref().and_then(|[low, high]| {
            let path = ["figures", name, "between"];
            Some([self.amount(&path, name, low)?, self.amount(&path, name, high)?])
        });
        if between.is_some_and(|[low, high]| low > high) {
            let span = self.document.span_of(&["figures", name, "between"]);
            self.mistakes.report(&span, "expected the least value first");
        }
        let absolute = bounds.absolute.as_ref();
        let absolute = absolute.and_then(|amount| self.distance(&["figures", name, "absolute"], name, amount));
        Some(FigureBounds::Bounds { between, absolute, relative: bounds.relative })
    }

    /// A distance in the unit of what is called `name`.
    fn distance(&mut self, path: &[&str], name: &str, amount: &Amount) -> Option<f64> {
        let found = self.amount(path, name, amount)?;
        if found >= 0.0 {
            return Some(found);
        }
        self.mistakes.report(&self.document.span_of(path), "expected a distance of at least 0");
        None
    }

    /// The value of an amount in the unit of what is called `name`.
    fn amount(&mut self, path: &[&str], name: &str, amount: &Amount) -> Option<f64> {
        let text = match amount {
            Amount::Number(number) => return Some(*number),
            Amount::Text(text) => text,
        };
        let parsed = match column::dimension(name) {
            Some(dimension) => dimension.parse(text).map_err(|error| (error.to_string(), error.hint())),
            None => text
                .trim()
                .parse()
                .map_err(|_| (format!("expected a number, found \"{text}\""), format!("`{name}` has no unit"))),
        };
        let span = self.document.span_of(path);
        parsed.map_err(|(message, hint)| self.mistakes.report_with(&span, message, hint)).ok()
    }

    /// The two bounds of a corridor.
    fn corridor(&mut self, name: &str) -> Option<[Series; 2]> {
        let path = ["signals", name, "corridor"];
        let file: PathBuf = self.document.file_of(&path)?;
        let report = |check: &mut Self, message: String| {
            let hint = "expected the columns time_s, lower and upper";
            check.mistakes.report_with(&check.document.span_of(&path), message, hint);
        };
        let found = match csv::read(&file) {
            Ok(found) => found,
            Err(error) => {
                report(self, error.to_string());
                return None;
            }
        };
        match (found.series("lower"), found.series("upper")) {
            (Some(lower), Some(upper)) => Some([lower, upper]),
            _ => {
                report(self, format!("{} has no columns lower and upper", file.display()));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn checked(text: &str) -> Result<Expectations, Vec<String>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("expect.toml");
        fs::write(folder.path().join("corridor.csv"), "time_s,lower,upper\n0,-1,1\n1,-2,2\n").unwrap();
        fs::write(&path, text).unwrap();
        let messages = |mistakes: Vec<Diagnostic>| mistakes.into_iter().map(|mistake| mistake.message).collect();
        let document = Document::read_expectations(&path).map_err(messages)?;
        Expectations::check(&document).map_err(messages)
    }

    #[test]
    fn expectations_are_read_in_their_units() {
        let found = checked(
            r#"
            [signals."acceleration_filtered_m_s2"]
            absolute = "50 cm/s2"
            relative = 0.01
            window   = ["0 ms", "60 ms"]
            [signals."*"]
            rating = 0.9
            [figures]
            peak_acceleration_m_s2 = { between = ["138 m/s2", 142] }
            ruptured = false
            layers = 8
            energy_absorption = { relative = 0.01 }
            [warnings]
            must = ["strain-rate-outside"]
            "#,
        )
        .unwrap();
        let bounds = found.signal("acceleration_filtered_m_s2").unwrap();
        assert_eq!((bounds.absolute, bounds.window), (Some(0.5), Some([0.0, 0.06])));
        assert_eq!(found.signal("displacement_m").unwrap().rating, Some(0.9));
        let figure = |name: &str| found.figures.iter().find(|(own, _)| own == name).map(|(_, bounds)| bounds.clone());
        let between = Some([138.0, 142.0]);
        let expected = FigureBounds::Bounds { between, absolute: None, relative: None };
        assert_eq!(figure("peak_acceleration_m_s2"), Some(expected));
        assert_eq!(
            (figure("ruptured"), figure("layers")),
            (Some(FigureBounds::Flag(false)), Some(FigureBounds::Number(8.0)))
        );
        let with_corridor = checked("[signals.force_N]\ncorridor = \"corridor.csv\"").unwrap();
        assert_eq!(with_corridor.signal("force_N").unwrap().corridor.as_ref().unwrap()[1].value_at(0.5), Some(1.5));
        assert!(with_corridor.signal("displacement_m").is_none());
    }
}
