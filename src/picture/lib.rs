//! Pictures of stored runs: the scene at one time, and plots, as PNG or SVG for slides and papers.
//!
//! A scene is drawn by a depth buffer, which is right for patches that touch or intersect; the heading, the colour bar and
//! the axes are text and lines. An SVG holds both, so that its text stays text. A PNG is drawn with the letters of this
//! program, so that it is the same on every machine.
#![warn(missing_docs)]

mod camera;
mod drawing;
pub mod gltf;
mod raster;
mod round;
mod scene_picture;
mod setting;

pub use crate::camera::View;
pub use crate::drawing::{Drawing, FAMILIES, PictureError};
pub use crate::scene_picture::{Part, ScenePicture};
