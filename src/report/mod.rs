//! report

#[cfg(feature = "rerun")]
pub mod recording;
