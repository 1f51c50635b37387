//! The methods of search, and the trials that they request.

pub(super) mod bounded;
pub(super) mod cma_es;
pub(super) mod levenberg_marquardt;
pub(super) mod nelder_mead;
mod simplex;
mod speculation;
pub(super) mod trials;
