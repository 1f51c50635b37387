//! Material files of what was measured, with comments on the tests, on what is assumed and on what is missing.

pub mod coupon;
pub mod fitted;
