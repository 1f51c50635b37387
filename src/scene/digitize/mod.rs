//! Curves read out of pictures of published figures: two points of each axis and the colour of the curve are given, and
//! the same picture gives the same curve to the bit.
//!
//! [`Axes`] lead from pixels to values, [`Trace`] is the curve in pixels, [`Digitized`] the table with the error of each of
//! its points.

mod axes;
mod colour;
mod extremes;
mod grid;
mod spec;
mod table;
mod trace;
mod warning;

pub use axes::Axes;
pub use colour::{Fidelity, Ink};
pub use spec::{Figure, PictureError};
pub use table::{Digitized, digitize};
pub use trace::{Trace, TraceError};
pub use warning::{CODES, Warning};
