//! The reduction of laboratory recordings: coupons and drops; fits of laws; virtual sensors.

pub mod absorption;
pub mod biaxial;
pub mod coupling;
pub mod coupon;
pub mod drop;
pub mod fall;
pub mod fit;
pub mod law_fit;
pub mod material_file;
mod nonnegative;
pub mod relaxation;
pub mod sensor;
mod warning;

pub use warning::{CODES, Warning};
