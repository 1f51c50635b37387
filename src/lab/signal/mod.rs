//! Time series as values: channels and recordings, their files, and what is computed from them.

mod annotations;
mod channel_code;
mod channel_fault;
pub mod clip;
pub mod column;
pub(crate) mod column_name;
pub mod csv;
mod curve;
pub mod export;
pub mod file;
pub mod filter;
pub mod gap;
pub mod hic;
pub mod integrate;
pub mod isomme;
mod measurement;
pub mod norm;
mod options;
pub mod rating;
mod recording;
pub mod resample;
mod series;
pub mod stored;
pub mod tdms;
pub mod text;
mod warning;
pub mod workbook;

pub use annotations::Annotations;
pub use channel_fault::{ChannelFault, MOST_VALUES};
pub use measurement::{ChannelError, MeasuredChannel, Measurement, QuantityError};
pub use options::{ChannelSelection, ReadOptions};
pub use recording::{Channel, Recording};
pub use series::Series;
pub(crate) use series::interpolated;
pub use warning::{CODES, Warning};
pub use warning::{FILTERED_BEFORE, VIRTUAL_RECORDING};
