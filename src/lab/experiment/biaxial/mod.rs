//! Film that is stretched in both directions: bulges, and coupons that are wide for their length; what they say of the
//! coupling of MD and TD (docs/methods.md, section 11).

mod bulge;
mod coupling;

pub use bulge::{Bulge, BulgeError};
pub use coupling::{Coupling, CouplingError, Uncoupled, edge_share};
