//! Full-field measurements: displacement fields of stereo digital image correlation, a file an image, over time.
//!
//! Written after descriptions and printed examples of the exports of VIC-3D, MatchID, ARAMIS (GOM) and DICe.

mod columns;
mod fault;
mod file;
mod motion;
mod series;
#[cfg(test)]
mod tests;

pub use fault::{FieldError, FileFault};
pub use file::{FieldFile, FieldOptions, read};
pub use motion::RigidMotion;
pub use series::{Field, FieldState, in_order, read_times};
