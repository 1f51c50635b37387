use std::path::PathBuf;

use thiserror::Error;

use super::import::Fault;

/// Why a film or a surface could not be meshed.
#[derive(Debug, Error)]
pub enum MeshError {
    #[error("element size {size} m: it must be positive and finite")]
    Size { size: f64 },
    #[error("an outline of {x} m by {y} m: lengths must be positive and finite")]
    Outline { x: f64, y: f64 },
    #[error("{elements} elements: more than the {limit} that a mesh can number; choose a larger size")]
    TooMany { elements: usize, limit: usize },
    #[error("{}: {fault}", path.display())]
    File { path: PathBuf, fault: Fault },
}
