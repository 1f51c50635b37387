//! Comparison of a run with a displacement field: the nearest point of the film for each measured point, the rigid motion
//! between their axes, and the errors.

mod alignment;
mod comparison;
#[cfg(test)]
mod tests;

pub use crate::field_comparison::alignment::{Alignment, FoundMotion};
pub use crate::field_comparison::comparison::{
    ErrorNorms, FieldComparison, FilmSurface, Nearest, NoComparison, PointError, StateErrors,
};
