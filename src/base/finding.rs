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
    /// The meaning of the code, one sentence for all of its findings.
    pub meaning: &'static str,
    /// The remedy that helps wherever the code is reported.
    pub remedy: &'static str,
}

/// Declares the findings of a module, each at one place, and makes of them the enum, its `Display` and [`Report`], the
/// constants of codes that others name, and `CODES`, the list of all codes.
///
/// ```
/// # use droptower_base as base;
/// base::findings! {
///     /// A doubt about a drop.
///     #[derive(Clone, Debug, PartialEq)]
///     pub enum Warning {
///         NoLaser = "no-laser", Note;
///             meaning "contact comes from the fall and the onset of the force";
///             remedy "nothing, if the height of fall is well known";
///             message "no laser";
///         /// A laser that contradicts the accelerometer.
///         LaserMismatch {
///             residual: f64, "root mean square distance, m" => "residual_m";
///             sensor: String, "name of the laser";
///         } = "laser-mismatch" as LASER_MISMATCH, Warning;
///             meaning "the motion integrated from the acceleration does not follow the laser";
///             remedy "check the unit of the laser";
///             message "{sensor} and acceleration are {:.2} mm apart", 1e3 * residual;
///         /// A laser that is not plugged in.
///         Silent { sensors: Vec<String>, "their names" => "first" = sensors[0], "lasers" = sensors.len() }
///             = code &LASER_MISMATCH;
///             message "{} write nothing", sensors.join(", ");
///     }
/// }
/// ```
///
/// - A variant has its fields in braces: name, type, sentence and, after `=>`, the figures that it gives: the field itself
///   under a name, or values; `=> ..pairs` gives those of an iterator of names and values. Or it has one field in
///   parentheses: name, type and, after `=>`, values or pairs. Figures stand in the order of the fields.
/// - After `=` follow the name of its code and its severity, `as` a constant where others name the code, or `code` and an
///   expression for the code of another variant or module, or of the finding that a field holds.
/// - The message is a format with its arguments, in which fields are references. The meaning documents the variant where
///   it has no sentence of its own.
#[macro_export]
macro_rules! findings {
    (
        $(#[$attribute:meta])* $visibility:vis enum $name:ident {
            $(
                $(#[$of_variant:meta])*
                $variant:ident
                $({ $($field:ident : $type:ty, $doc:literal
                    $(=> $($figure:literal $(= $value:expr)?),+)? $(=> ..$pairs:expr)?);+ $(;)? })?
                $(( $inner:ident : $inner_type:ty
                    $(=> $($inner_figure:literal = $inner_value:expr),+)? $(=> ..$inner_pairs:expr)? ))?
                $(= $code:literal $(as $constant:ident)?, $severity:ident;
                    meaning $meaning:literal; remedy $remedy:literal;)?
                $(= code $shared:expr;)?
                message $message:literal $(, $argument:expr)*;
            )+
        }
    ) => {
        $(#[$attribute])*
        $visibility enum $name {
            $($(#[$of_variant])* $(#[doc = $meaning])?
            $variant $({ $(#[doc = $doc] $field: $type),+ })? $(($inner_type))?,)+
        }

        $($($(
            #[doc = $meaning]
            pub const $constant: $crate::finding::Code = $crate::findings!(@code $code, $severity, $meaning, $remedy);
        )?)?)+

        /// The codes of this module.
        pub const CODES: &[&$crate::finding::Code] =
            &[$($(&$crate::findings!(@code $code, $severity, $meaning, $remedy),)?)+];

        impl ::std::fmt::Display for $name {
            #[allow(unused_variables)]
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                match self {
                    $($name::$variant $({ $($field),+ })? $(($inner))? => write!(f, $message $(, $argument)*),)+
                }
            }
        }

        impl $crate::finding::Report for $name {
            #[allow(unused_variables)]
            fn code(&self) -> &'static $crate::finding::Code {
                match self {
                    $($name::$variant $({ $($field),+ })? $(($inner))? => {
                        $(&$crate::findings!(@code $code, $severity, $meaning, $remedy))? $($shared)?
                    })+
                }
            }

            #[allow(unused_variables, unused_mut)]
            fn figures(&self) -> $crate::finding::Figures {
                let mut figures = $crate::finding::Figures::new();
                match self {
                    $($name::$variant $({ $($field),+ })? $(($inner))? => {
                        $($(
                            $($($crate::finding::insert(
                                &mut figures, [($figure, $crate::findings!(@value $field $(, $value)?))],
                            );)+)?
                            $($crate::finding::insert(&mut figures, $pairs);)?
                        )+)?
                        $(
                            $($($crate::finding::insert(&mut figures, [($inner_figure, &$inner_value)]);)+)?
                            $($crate::finding::insert(&mut figures, $inner_pairs);)?
                        )?
                    })+
                }
                figures
            }
        }
    };
    (@code $name:literal, $severity:ident, $meaning:literal, $remedy:literal) => {
        $crate::finding::Code {
            name: $name,
            severity: $crate::finding::Severity::$severity,
            meaning: $meaning,
            remedy: $remedy,
        }
    };
    (@value $field:ident) => { $field };
    (@value $field:ident, $value:expr) => { &$value };
}

/// Figures by name, SI, the unit at the end of the name (`time_s`).
pub type Figures = Map<String, Value>;

/// Adds figures to those of a finding.
#[doc(hidden)]
pub fn insert<N: Into<String>, V: Serialize>(figures: &mut Figures, added: impl IntoIterator<Item = (N, V)>) {
    let value = |value| serde_json::to_value(value).unwrap_or_default();
    figures.extend(added.into_iter().map(|(name, figure)| (name.into(), value(figure))));
}

/// A warning of one module; its message is its `Display` form: lower case, no full stop, the fact first.
pub trait Report: fmt::Display {
    /// Its kind.
    fn code(&self) -> &'static Code;

    /// Its figures.
    fn figures(&self) -> Figures;
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

    findings! {
        /// Doubts about a contact.
        enum Doubt {
            Deep { depth: f64, "how deep, m" => "depth_m"; of: Vec<u8>, "faces" => "first" = of[0], "faces" = of.len() }
                = "deep-contact" as DEEP, Warning;
                meaning "faces reach into the impactor";
                remedy "use a smaller mesh";
                message "penetration of {} m", depth;
            /// Deep somewhere.
            Somewhere { depth: Option<f64>, "how deep, m" => ..depth.map(|depth| ("depth_m", depth)) }
                = code &DEEP;
                message "penetration somewhere";
            Usual = "usual", Note;
                meaning "nothing to worry about";
                remedy "nothing";
                message "as usual";
            /// A doubt of another module.
            Other(other: Box<Doubt> => ..other.figures()) = code other.code();
                message "elsewhere: {other}";
        }
    }

    #[test]
    fn a_report_becomes_a_finding_with_its_figures_beside_the_message() {
        let deep = Doubt::Deep { depth: 0.5, of: vec![7, 8] };
        let figures = r#""depth_m":0.5,"first":7,"faces":2}"#;
        let json = |m| format!(r#"{{"code":"deep-contact","severity":"warning","message":"{m}",{figures}"#);
        let finding = Finding::new(&deep);
        assert_eq!(serde_json::to_string(&finding).unwrap(), json("penetration of 0.5 m"));
        assert_eq!(serde_json::from_str::<Finding>(&json("penetration of 0.5 m")).unwrap(), finding);
        assert_eq!(finding.to_string(), "warning[deep-contact]: penetration of 0.5 m");
        let other = Finding::new(&Doubt::Other(Box::new(deep)));
        assert_eq!(serde_json::to_string(&other).unwrap(), json("elsewhere: penetration of 0.5 m"));
    }

    #[test]
    fn each_code_is_listed_once_and_shared_by_name() {
        assert_eq!(CODES.iter().map(|code| code.name).collect::<Vec<_>>(), ["deep-contact", "usual"]);
        let somewhere = |depth| Finding::new(&Doubt::Somewhere { depth });
        assert_eq!((somewhere(None).code.as_str(), somewhere(None).figures.len()), ("deep-contact", 0));
        assert_eq!(somewhere(Some(0.5)).figures["depth_m"], 0.5);
        assert_eq!(Doubt::Usual.code(), CODES[1]);
    }

    #[test]
    fn codes_are_words_joined_by_hyphens() {
        for (name, fits) in [("coarse-contact", true), ("d1", true), ("", false), ("a--b", false), ("Coarse", false)] {
            assert_eq!(is_code(name), fits, "{name}");
        }
    }
}
