//! The reduction of a drop test: from the readings of the sensors to contact, speed, travel and energies.

mod bridge;
mod channels;
mod clipping;
mod error;
mod fit;
mod intervals;
mod model;
mod motion;
mod plausibility;
mod ramp;
mod recording;
mod reduce;
mod release;
mod result;
mod stated;
#[cfg(test)]
mod tests;
mod tower;

pub use bridge::{Bridged, bridged, longest_gap};
pub use channels::{ChannelNames, DropChannels, DropChannelsError};
pub use error::DropError;
pub use ramp::GravityRamp;
pub use reduce::reduce;
pub use release::{Release, ReleaseError};
pub use result::{Contact, Drop, Figures, Input, Intervals, Landmarks, SpeedSource};
pub use stated::{Stated, StatedError};
pub use tower::{Class, Correction, Reduction, Tower};
