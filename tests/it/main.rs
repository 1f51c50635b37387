//! The one integration binary.

mod architecture;
mod commands;
mod compare;
mod conversions;
mod coupons;
mod diagnostics;
mod language;
mod law_fits;
mod documents;
mod examples;
mod golden;
mod graded_mesh;
mod guide;
mod identification;
mod mesh;
mod paper_study;
mod paraview;
mod polygon_mesh;
#[cfg(feature = "rerun")]
mod playback;
mod recordings;
mod restraint;
mod resume;
mod runs;
mod shipped;
mod signals;
mod slow;
mod sweeps;
mod templates;
mod verification;
mod view;
mod virtual_drops;
mod workbench;
