//! The one integration binary.

mod mesh;
