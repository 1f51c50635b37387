//! Time series as values: channels and recordings, their files, and what is computed from them.

pub(crate) mod annotations;
pub mod catalogue;
pub mod clip;
pub mod column;
pub(crate) mod column_name;
pub mod csv;
pub mod export;
pub mod file;
pub mod filter;
pub mod format;
pub mod gap;
pub mod hdf5;
pub mod hic;
pub mod integrate;
pub mod isomme;
pub mod matlab;
mod measurement;
pub mod norm;
pub mod rating;
pub mod resample;
mod series;
pub mod t01;
pub mod tdms;
mod text;
mod warning;
pub mod workbook;

pub use annotations::Annotations;
pub use measurement::{ChannelSelection, MOST_VALUES, MeasuredChannel, Measurement, ReadOptions};
pub(crate) use measurement::{ambiguous, check_dimension, missing, with_unit};
pub use series::{Channel, Recording, Series};
pub(crate) use series::{flat_top, interpolated, quantum};
pub use warning::{CODES, FILTERED_BEFORE, VIRTUAL_RECORDING, Warning};
