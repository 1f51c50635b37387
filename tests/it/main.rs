//! The one integration binary.

mod golden;
mod mesh;
