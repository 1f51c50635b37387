//! Which energy is fitted.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, refusal};
use membrane::material::Ogden;

/// An energy of rubber-like film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Energy {
    /// `mu`.
    NeoHookean,
    /// `young`, `poisson`.
    CompressibleNeoHookean,
    /// `c10`, `c01`.
    MooneyRivlin,
    /// `c10`, `c20`, `c30`.
    Yeoh,
    /// `mu`, `jm`.
    Gent,
    /// `mu` and `alpha` of as many terms.
    Ogden {
        /// Number of terms, 1 to [`Ogden::TERMS`].
        terms: usize,
    },
}

impl Energy {
    /// The words of all energies.
    pub const WORDS: &'static str =
        "neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent or ogden:N with 1 to 6 terms";

    /// Its name in a material file.
    pub fn law(self) -> &'static str {
        match self {
            Energy::NeoHookean => "neo-hookean",
            Energy::CompressibleNeoHookean => "compressible-neo-hookean",
            Energy::MooneyRivlin => "mooney-rivlin",
            Energy::Yeoh => "yeoh",
            Energy::Gent => "gent",
            Energy::Ogden { .. } => "ogden",
        }
    }
}

impl Energy {
    /// Names of the coefficients; those of Ogden's law up to `most`, a modulus and an exponent a term.
    pub fn names(self, most: usize) -> Vec<String> {
        let fixed: &[&str] = match self {
            Energy::NeoHookean => &["mu"],
            Energy::CompressibleNeoHookean => &["young", "poisson"],
            Energy::MooneyRivlin => &["c10", "c01"],
            Energy::Yeoh => &["c10", "c20", "c30"],
            Energy::Gent => &["mu", "jm"],
            Energy::Ogden { terms } => {
                let names = (1..=terms).flat_map(|term| [format!("mu_{term}"), format!("alpha_{term}")]);
                return names.take(most).collect();
            }
        };
        fixed.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Whether the coefficient of this name is in Pa.
    pub(in crate::experiment::law_fit) fn is_modulus(name: &str) -> bool {
        !(name == "jm" || name == "poisson" || name.starts_with("alpha"))
    }
}

/// `ogden` alone has three terms.
impl FromStr for Energy {
    type Err = Error;

    fn from_str(word: &str) -> Result<Energy, Error> {
        let unknown = || refusal!("`{word}` is not a law that can be fitted: expected {}", Energy::WORDS);
        Ok(match word {
            "neo-hookean" => Energy::NeoHookean,
            "compressible-neo-hookean" => Energy::CompressibleNeoHookean,
            "mooney-rivlin" => Energy::MooneyRivlin,
            "yeoh" => Energy::Yeoh,
            "gent" => Energy::Gent,
            "ogden" => Energy::Ogden { terms: 3 },
            other => {
                let terms = other.strip_prefix("ogden:").and_then(|terms| terms.parse().ok()).ok_or_else(unknown)?;
                (1..=Ogden::TERMS).contains(&terms).then_some(Energy::Ogden { terms }).ok_or_else(unknown)?
            }
        })
    }
}

impl fmt::Display for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Energy::Ogden { terms } => write!(f, "ogden:{terms}"),
            other => f.write_str(other.law()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_laws() {
        for word in ["neo-hookean", "compressible-neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden:1", "ogden:6"] {
            assert_eq!(word.parse::<Energy>().map(|law| law.to_string()), Ok(word.to_owned()));
        }
        assert_eq!("ogden".parse::<Energy>().map(|law| law.to_string()), Ok("ogden:3".to_owned()));
        for word in ["", "ogden:0", "ogden:7", "ogden:", "yeoh:3", "Ogden:3 "] {
            let error = word.parse::<Energy>().expect_err(word).to_string();
            assert!(error.contains("is not a law that can be fitted: expected neo-hookean, "), "{error}");
        }
    }
}
