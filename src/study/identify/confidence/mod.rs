//! How well estimated parameters are known: the linearization of an objective, and its profiles.

mod constrained_fit;
pub(super) mod linearization;
pub(super) mod profile;
pub(super) mod refinement;
