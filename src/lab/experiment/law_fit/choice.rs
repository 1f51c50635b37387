//! The laws that can be fitted, by the words that users type.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::hyperelastic::Energy;

/// A law that can be fitted: `ogden:3`, `yeoh`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawChoice {
    /// An energy of rubber-like film.
    Hyperelastic(Energy),
}

/// Why a word is not a law that can be fitted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{word}` is not a law that can be fitted: expected {}", LawChoice::WORDS)]
pub struct LawChoiceError {
    /// As it was written.
    pub word: String,
}

impl LawChoice {
    /// The words of all laws.
    pub const WORDS: &'static str = Energy::WORDS;
}

impl FromStr for LawChoice {
    type Err = LawChoiceError;

    fn from_str(word: &str) -> Result<LawChoice, LawChoiceError> {
        let found = Energy::named(word).map(LawChoice::Hyperelastic);
        found.ok_or_else(|| LawChoiceError { word: word.into() })
    }
}

impl fmt::Display for LawChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LawChoice::Hyperelastic(energy) => energy.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_laws() {
        for word in ["neo-hookean", "compressible-neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden:1", "ogden:6"] {
            assert_eq!(word.parse::<LawChoice>().map(|law| law.to_string()).as_deref(), Ok(word));
        }
        assert_eq!("ogden".parse::<LawChoice>().map(|law| law.to_string()).as_deref(), Ok("ogden:3"));
        for word in ["", "ogden:0", "ogden:7", "ogden:", "yeoh:3", "Ogden:3 "] {
            let error = word.parse::<LawChoice>().expect_err(word).to_string();
            assert!(error.contains("is not a law that can be fitted: expected neo-hookean, "), "{error}");
        }
    }
}
