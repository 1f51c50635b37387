//! Coupon tests: force over displacement of a film strip, reduced to the figures of a material.
//!
//! Equation numbers are those of Hynčík et al., Polymers 2021, 13, 1537.

pub mod average;
mod curve;
mod direction;
pub mod label;
mod machine;
mod modulus;
mod recording;
mod reduction;
mod residuals;
mod rupture;
pub mod shear;
mod skewed;
mod specimen;
mod strip;
mod yield_points;

pub(crate) use curve::too_short;
pub use curve::{Curve, JITTER};
pub use direction::Direction;
pub use label::{FASTEST, Label};
pub use machine::{LoadCell, Machine, TensileRecord};
pub use modulus::{FEWEST_SAMPLES, Modulus, WINDOW};
pub use recording::{CouponReader, CouponTest, Dimensions, SpecimenNote};
pub use reduction::{DirectionMeans, Reduction, Rules, Sample, SpeedMeans};
pub use residuals::relative_residuals;
pub use rupture::{BREAK_SHARE, CurveEnd, Rupture};
pub use skewed::{Fibres, ShearMethod};
pub use strip::Coupon;
pub use yield_points::{YieldPoints, yield_points};
