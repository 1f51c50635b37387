//! How well estimated parameters are known: linearization, covariance, identifiability, and profiles of the objective.

mod constrained_fit;
pub(super) mod covariance;
pub(super) mod estimate;
pub(super) mod identifiability;
mod interval;
pub(super) mod linearization;
pub(super) mod noise;
pub(super) mod options;
pub(super) mod profile;
pub(super) mod refinement;
