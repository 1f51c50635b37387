//! Findings: what a run, a search or a reduction reports although it went on.
//!
//! Each module has its own `Warning` enum, whose variants carry figures and name a [`Code`]. [`Finding`] is what
//! becomes of it in `summary.json`, on the page and on the terminal; nothing reads its message back.

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// How much a finding weighs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Says how a figure came about.
    Note,
    /// Puts a figure in doubt.
    Warning,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
        })
    }
}

/// A kind of finding and its entry in `droptower explain`.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Code {
    /// Lower-case words joined by hyphens. Part of the file format: it never changes its meaning.
    pub name: &'static str,
    /// How much a finding of this kind weighs.
    pub severity: Severity,
    /// What it means.
    pub meaning: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

/// Defines the codes of a module, one constant each, and `CODES`, the list of them.
#[macro_export]
macro_rules! codes {
    ($($constant:ident = $name:literal, $severity:ident, $meaning:literal, $remedy:literal;)+) => {
        $(#[doc = $meaning] pub const $constant: $crate::finding::Code = $crate::finding::Code {
            name: $name,
            severity: $crate::finding::Severity::$severity,
            meaning: $meaning,
            remedy: $remedy,
        };)+
        /// The codes of this module.
        pub const CODES: &[&$crate::finding::Code] = &[$(&$constant),+];
    };
}

/// A warning of one module; its message is its `Display` form: lower case, no full stop, the fact first.
pub trait Report: fmt::Display {
    /// Its kind.
    fn code(&self) -> &'static Code;

    /// Its figures by name, SI, the unit at the end of the name (`time_s`); none by default.
    fn figures(&self) -> Map<String, Value> {
        Map::new()
    }
}

/// A finding as `summary.json` holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// [`Code::name`], or the code that a script gave.
    pub code: String,
    /// How much it weighs.
    pub severity: Severity,
    /// Lower case, no full stop, the fact first.
    pub message: String,
    /// Figures by name, SI.
    #[serde(flatten)]
    pub figures: Map<String, Value>,
}

impl Finding {
    /// The finding that a module reports.
    pub fn new(report: &impl Report) -> Finding {
        let code = report.code();
        Finding {
            code: code.name.into(),
            severity: code.severity,
            message: report.to_string(),
            figures: report.figures(),
        }
    }

    /// The finding of a script, which words it itself.
    pub fn of_script(code: &str, message: &str) -> Finding {
        Finding { code: code.into(), severity: Severity::Warning, message: message.into(), figures: Map::new() }
    }

    /// Whether it puts a figure in doubt.
    pub fn is_warning(&self) -> bool {
        self.severity == Severity::Warning
    }
}

/// As a terminal shows it: `warning[coarse-contact]: message`.
impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]: {}", self.severity, self.code, self.message)
    }
}

/// Whether `name` can be a code: lower-case letters and digits in words joined by hyphens, at most 60 characters.
pub fn is_code(name: &str) -> bool {
    let word = |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit());
    name.len() <= 60 && name.split('-').all(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    codes! {
        DEEP = "deep-contact", Warning, "faces reach into the impactor", "use a smaller mesh";
        USUAL = "usual", Note, "nothing to worry about", "nothing";
    }

    struct Deep(f64);

    impl fmt::Display for Deep {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "penetration of {} m", self.0)
        }
    }

    impl Report for Deep {
        fn code(&self) -> &'static Code {
            &DEEP
        }

        fn figures(&self) -> Map<String, Value> {
            Map::from_iter([("depth_m".into(), self.0.into())])
        }
    }

    #[test]
    fn a_report_becomes_a_finding_with_its_figures_beside_the_message() {
        let finding = Finding::new(&Deep(0.5));
        let json = r#"{"code":"deep-contact","severity":"warning","message":"penetration of 0.5 m","depth_m":0.5}"#;
        assert_eq!(serde_json::to_string(&finding).unwrap(), json);
        assert_eq!(serde_json::from_str::<Finding>(json).unwrap(), finding);
        assert_eq!(finding.to_string(), "warning[deep-contact]: penetration of 0.5 m");
        assert_eq!(CODES, [&DEEP, &USUAL]);
    }

    #[test]
    fn codes_are_words_joined_by_hyphens() {
        for (name, fits) in [("coarse-contact", true), ("d1", true), ("", false), ("a--b", false), ("Coarse", false)] {
            assert_eq!(is_code(name), fits, "{name}");
        }
    }
}
