//! Sobol' indices: which share of the variance of an output is due to which input, for independent inputs.

mod given;
mod saltelli;

pub use given::{MainEffectsError, main_effects};
pub use saltelli::{FactorIndices, IndicesError, indices, rows};

#[cfg(test)]
pub(crate) mod functions;
