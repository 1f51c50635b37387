//! Coupon tests: force over displacement of a film strip, reduced to the figures of a material.
//!
//! Equation numbers are those of Hynčík et al., Polymers 2021, 13, 1537.

pub mod average;
mod curve;
mod doubts;
pub mod label;
mod recording;
mod reduction;
pub mod shear;
mod specimen;
mod yield_points;

pub(crate) use curve::too_short;
pub use curve::{Curve, JITTER, relative_residuals};
pub use doubts::{LIKELY_THICKNESS, Slack, doubts};
pub use label::{Direction, FASTEST, Label};
pub use recording::{
    CouponReader, CouponTest, Dimensions, LoadCell, Machine, SpecimenNote, TensileRecord, join_speeds,
};
pub use reduction::{DirectionMeans, Reduction, Rules, Sample, SpeedMeans};
pub use shear::{Fibres, ShearMethod};
pub use specimen::Coupon;
pub use yield_points::{BREAK_SHARE, CurveEnd, FEWEST_SAMPLES, Modulus, Rupture, WINDOW, YieldPoints, yield_points};
