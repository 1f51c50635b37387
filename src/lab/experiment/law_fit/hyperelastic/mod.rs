//! Energies of rubber-like film, fitted through the kernels of [`HyperelasticLaw`](membrane::material::HyperelasticLaw).
//!
//! The stresses of each energy are linear in its moduli and nonlinear in the rest: exponents, a limit, Poisson's
//! ratio. The search is over these alone, and each of its points has the best moduli (variable projection, Golub and
//! Pereyra, SIAM J. Numer. Anal. 10, 1973). Every start is searched with moduli of any sign and with none that is
//! negative; of all minima the fit is the best one that is stable (methods.md, section 22).

mod energy;
mod fit;
mod separable;
#[cfg(test)]
mod tests;

pub use energy::Energy;
pub use fit::fit_law;
