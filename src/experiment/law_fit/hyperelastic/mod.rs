//! Energies of rubber-like film, fitted through the kernels of [`crate::material::HyperelasticLaw`].

mod energy;

pub use energy::Energy;
