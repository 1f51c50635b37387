//! The two curves of a rating.

use std::fmt;

/// One of the two curves of a rating.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// The measured curve, or the one that counts as exact.
    Reference,
    /// The curve that is rated.
    Comparison,
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Curve::Reference => "reference",
            Curve::Comparison => "comparison",
        })
    }
}
