//! The reduction of a drop test: from the readings of the sensors to contact, speed, travel and energies.

mod bridge;
mod channels;
mod clipping;
mod corrected;
mod error;
mod evaluated;
mod figures;
mod friction;
mod integrated;
mod landmarks;
mod laser;
mod levelled;
mod motion;
mod plausibility;
mod reduce;
mod result;
mod screened;
mod stated;
#[cfg(test)]
mod tests;
mod time_constant;
mod tower;

pub use bridge::{Bridged, bridged, longest_gap};
pub use channels::{ChannelNames, DropChannels, DropChannelsError};
pub use error::DropError;
pub use figures::Figures;
pub use landmarks::Landmarks;
pub use reduce::reduce;
pub use result::{Drop, Intervals};
pub use stated::{Stated, StatedError};
pub use tower::{Correction, Height, KnownContact, Reduction, Tower};
