//! Why a film or a surface could not be meshed.

use std::path::PathBuf;

use thiserror::Error;

use super::import::Fault;
use super::polygon::PolygonFault;

/// Why a film or a surface could not be meshed.
#[derive(Debug, Error)]
pub enum MeshError {
    /// The element size is not positive or not finite.
    #[error("expected a positive element size, found {size} m")]
    Size {
        /// m.
        size: f64,
    },
    /// The growth of the elements of a graded mesh is not positive or not finite.
    #[error("expected a positive growth of the elements, found {growth}")]
    Growth {
        /// Edge length per distance.
        growth: f64,
    },
    /// A length of the outline is not positive or not finite.
    #[error("expected an outline of positive lengths, found {x} m by {y} m")]
    Outline {
        /// Length along x, m.
        x: f64,
        /// Length along y, m.
        y: f64,
    },
    /// The nodes could not be numbered.
    #[error("{elements} elements exceed the {limit} of a mesh; choose a larger element size")]
    TooMany {
        /// Their number.
        elements: usize,
        /// The largest number.
        limit: usize,
    },
    /// A polygon is not the outline of a film.
    #[error("{0}")]
    Polygon(#[from] PolygonFault),
    /// A file is not a mesh of a film or of an impactor.
    #[error("{}: {fault}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The fault in it.
        fault: Fault,
    },
}
