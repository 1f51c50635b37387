//! How well estimated parameters are known: covariance and intervals of a linear model, and identifiability.
//!
//! Searches and fits of laws linearize their residuals; what follows from that is here.

mod covariance;
mod estimate;
mod identifiability;
mod linearization;
mod noise;
mod options;
mod warning;

pub use estimate::Confidence;
pub use identifiability::Direction;
pub use linearization::Linearization;
pub use noise::{Colour, Misfit, Noise};
pub use options::ConfidenceOptions;
pub use warning::{CODES, Warning};
