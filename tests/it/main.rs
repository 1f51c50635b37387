//! The one integration binary.

mod architecture;
mod commands;
mod diagnostics;
mod mesh;
mod runs;
