//! How well estimated parameters are known: linearization, covariance, identifiability, and profiles of the objective.

pub(super) mod confidence;
mod constrained_fit;
pub(super) mod covariance;
pub(super) mod identifiability;
mod interval;
pub(super) mod linearization;
pub(super) mod noise;
pub(super) mod profile;
