//! Points by the names of their unknowns, as findings show them.

use std::fmt;

use serde::{Serialize, Serializer};

use base::number;

/// Significant digits of a value.
const DIGITS: usize = 5;

/// A point with the names of its unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Point(Vec<(String, f64)>);

impl Point {
    /// The point `x` of unknowns with these `names`.
    pub(super) fn new(names: &[String], x: &[f64]) -> Point {
        Point(names.iter().cloned().zip(x.iter().copied()).collect())
    }
}

/// `k1 = 2.75, ke = 3.41`
impl fmt::Display for Point {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(out, "{comma}{name} = {}", number::significant(*value, DIGITS))?;
        }
        Ok(())
    }
}

/// As a map from names to values.
impl Serialize for Point {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// The names of `count` unknowns where none are given: `x0`, `x1`, …
pub(super) fn unnamed(count: usize) -> Vec<String> {
    (0..count).map(|index| format!("x{index}")).collect()
}
