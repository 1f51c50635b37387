//! Comparison of a run with a displacement field: the nearest point of the film for each measured point, the rigid motion
//! between their axes, and the errors.

mod alignment;
mod comparison;
mod surface;
#[cfg(test)]
mod tests;

pub use alignment::{Alignment, FoundMotion};
pub use comparison::{ErrorNorms, FieldComparison, NoComparison, PointError, StateErrors};
pub use surface::{FilmSurface, Nearest};
