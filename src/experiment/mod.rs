//! What a laboratory does to its recordings.

pub mod absorption;
pub mod coupon;
