//! The one integration binary.

mod architecture;
mod calibration;
mod cards;
mod cmd;
mod commands;
mod conversions;
mod coupling;
mod coupon_materials;
mod coupons;
mod coverage;
mod diagnostics;
mod language;
mod law_fits;
mod decks;
mod documents;
mod drop_pages;
mod examples;
mod field;
mod files;
mod gltf;
mod golden;
mod graded_mesh;
mod guide;
#[cfg(unix)]
mod hints;
mod identification;
#[cfg(unix)]
mod links;
mod mesh;
mod openradioss;
mod paper_study;
mod paraview;
mod picture;
#[cfg(feature = "rerun")]
mod playback;
mod polygon_mesh;
mod progress;
mod recordings;
mod restraint;
mod resume;
mod runs;
mod script_help;
mod shell;
mod shipped;
mod sick;
mod signals;
mod slow;
mod sweeps;
mod templates;
#[cfg(unix)]
mod terminal;
mod tested;
mod verification;
mod view;
mod virtual_drops;
mod watch;
mod workbench;
mod zipped;
