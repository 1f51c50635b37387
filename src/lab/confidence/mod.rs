//! How well estimated parameters are known: covariance and intervals of a linear model, and identifiability.
//!
//! Searches and fits of laws linearize their residuals; what follows from that is here.

mod covariance;
mod estimate;
mod linearization;
mod noise;
mod warning;

pub use estimate::{Confidence, Direction};
pub use linearization::{ConfidenceOptions, Linearization};
pub use noise::{Colour, Misfit, Noise};
pub use warning::{CODES, Warning};
