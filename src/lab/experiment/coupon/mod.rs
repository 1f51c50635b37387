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

pub use curve::{Curve, CurveError, JITTER};
pub use direction::{Direction, DirectionError};
pub use label::{FASTEST, Label, LabelError};
pub use machine::{LoadCell, Machine, MachineError, TensileRecord};
pub use modulus::{FEWEST_SAMPLES, Modulus, ModulusError, WINDOW};
pub use recording::{CouponReader, CouponTest, Dimensions, RecordingError, RecordingFault, SpecimenNote};
pub use reduction::{DirectionMeans, Reduction, ReductionError, Rules, Sample, SampleError, SpeedMeans};
pub use residuals::{ResidualError, relative_residuals};
pub use rupture::{BREAK_SHARE, CurveEnd, Rupture, RuptureError};
pub use skewed::{Fibres, ShearMethod, ShearMethodError};
pub use strip::{Coupon, CouponError};
pub use yield_points::{YieldError, YieldPoints, yield_points};
