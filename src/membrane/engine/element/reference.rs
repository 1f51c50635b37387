//! The stress-free film under an element.

use nalgebra::{Point3, Vector3};
use thiserror::Error;

/// MD and pre-strain, which relate the mounted film to the stress-free one.
#[derive(Clone, Copy, Debug)]
pub struct StressFree {
    md: Vector3<f64>,
    prestrain: [f64; 2],
}

/// MD is perpendicular to the plane of an element, so the fibre directions in it are undefined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the fibre directions are undefined in the element at nodes {nodes:?}: MD is perpendicular to its plane")]
pub struct UndefinedFibreDirection {
    /// The first three nodes of the element.
    pub nodes: [u32; 3],
}

impl StressFree {
    /// MD at `md_angle` (rad) from the x axis; engineering pre-strain along MD and TD.
    pub fn new(md_angle: f64, prestrain: [f64; 2]) -> StressFree {
        StressFree { md: Vector3::new(md_angle.cos(), md_angle.sin(), 0.0), prestrain }
    }

    /// Stress-free coordinates (m, along MD and TD) of an element's nodes: the mounted ones, projected onto the
    /// element's plane and divided by 1 + pre-strain (theory.md, equation 3).
    pub(super) fn reference<const NODES: usize>(
        &self,
        nodes: [u32; NODES],
        positions: &[Point3<f64>],
    ) -> Result<[[f64; 2]; NODES], UndefinedFibreDirection> {
        let x: [Point3<f64>; NODES] = nodes.map(|n| positions[n as usize]);
        let undefined = UndefinedFibreDirection { nodes: [nodes[0], nodes[1], nodes[2]] };
        let last = x[NODES - 1];
        let normal = (x[2] - x[0]).cross(&(last - x[1])).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let normal = if NODES == 3 { (x[1] - x[0]).cross(&(x[2] - x[0])).normalize() } else { normal };
        let md = self.md - normal * self.md.dot(&normal);
        let md = md.try_normalize(1e-3).ok_or(undefined)?;
        let td = normal.cross(&md);
        Ok(x.map(|p| {
            let arm = p - x[0];
            [arm.dot(&md) / (1.0 + self.prestrain[0]), arm.dot(&td) / (1.0 + self.prestrain[1])]
        }))
    }
}
