//! A stretch: its jaws and its signals.

use super::build::Mounting;
use super::tracks::Tracks;
use crate::engine::{Jaw, Nodes};
use crate::mesh::Mesh;
use crate::mesh::{Outline, Side};
use crate::model::{Face, Model};
use crate::signal::Recording;

/// Distance of the jaws, m, and stress-free cross-section of the film between them, m².
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coupon {
    pub(super) gauge: f64,
    pub(super) section: f64,
}

impl Coupon {
    /// The film between the jaws of `model`; none but a rectangle can be held.
    pub(super) fn of(model: &Model) -> Coupon {
        let Outline::Rectangle { x: gauge, y: width } = model.specimen.shape else { return Coupon::default() };
        let section =
            |face: &Face| width * face.material.thickness * f64::from(face.layers) / (1.0 + face.prestrain[1]);
        Coupon { gauge, section: model.faces.iter().map(section).sum() }
    }
}

/// Clamps the nodes on x- and x+ and gives the film between them the velocity of a uniform stretch, so that no wave runs.
/// There is no jaw on a mirror plane. `first` is the first of all nodes that belongs to `mesh`.
pub(super) fn grip(nodes: &mut Nodes, mesh: &Mesh, first: usize, velocity: f64, gauge: f64) -> Vec<Jaw> {
    for n in first..nodes.position.len() {
        nodes.velocity.set(n, [velocity * nodes.position.at(n)[0] / gauge, 0.0, 0.0]);
    }
    let jaw = |(side, speed): (Side, f64)| {
        let held: Vec<u32> = mesh.sides[side as usize].iter().map(|n| first as u32 + n).collect();
        nodes.hold(held.iter().map(|n| *n as usize), [true; 3]);
        held.iter().for_each(|n| nodes.velocity.set(*n as usize, [speed, 0.0, 0.0]));
        Jaw { nodes: held, velocity: speed }
    };
    let jaws = [(Side::XMinus, -0.5 * velocity), (Side::XPlus, 0.5 * velocity)].map(jaw);
    jaws.into_iter().filter(|jaw| !jaw.nodes.is_empty()).collect()
}

/// Travel of jaws that part at `velocity` (m/s), their force, engineering strain and stress.
pub(super) fn signals(tracks: &Tracks, mounting: &Mounting, velocity: f64) -> Recording {
    let Coupon { gauge, section } = mounting.coupon;
    let copies = mounting.films.first().map_or(1.0, |f| if f.mirrored[1] { 2.0 } else { 1.0 });
    let row = |k: usize| {
        let displacement = velocity * k as f64 * tracks.sample;
        let force = copies * tracks.at_steps.rows[k][2];
        [displacement, force, displacement / gauge, force / section]
    };
    let rows: Vec<_> = (0..tracks.samples.min(tracks.at_steps.rows.len())).map(row).collect();
    tracks.table(&["displacement_m", "force_N", "strain", "stress_Pa"], &rows)
}
