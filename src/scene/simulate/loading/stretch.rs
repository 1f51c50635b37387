//! Stretch: two jaws pull the film.

use super::LoadCase;
use crate::mesh::{Mesh, Outline, Side};
use crate::model::{Face, Hold, Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::Mounting;
use crate::simulate::tracks::Tracks;
use lab::signal::{Recording, column};
use membrane::engine::{self, Film, Jaw, Loads, Nodes};

/// Steps above which the film's mass is scaled.
const STEPS: f64 = 200_000.0;

/// Film between two jaws that part along x.
pub(in crate::simulate) struct Stretch {
    /// Speed at which the jaws part, m/s, both together.
    pub(in crate::simulate) velocity: f64,
    /// Stress-free cross-section of the film, m².
    pub(in crate::simulate) section: f64,
    /// Distance of the jaws, m.
    gauge: f64,
    damping: f64,
}

impl Stretch {
    /// The film between the jaws of `model`, whose outline is a rectangle.
    pub(super) fn new(model: &Model, loading: &loading::Stretch) -> Stretch {
        let section = |width: f64, face: &Face| {
            width * face.material.thickness * f64::from(face.layers) / (1.0 + face.prestrain[1])
        };
        let (gauge, section) = match model.specimen.shape {
            Outline::Rectangle { x, y } => (x, model.faces.iter().map(|face| section(y, face)).sum()),
            Outline::Circle { .. } | Outline::Polygon(_) | Outline::Mesh { .. } => (0.0, 0.0),
        };
        Stretch { velocity: loading.velocity, section, gauge, damping: model.specimen.damping }
    }
}

impl LoadCase for Stretch {
    fn excess(&self, steps: f64) -> f64 {
        steps / STEPS
    }

    fn damping(&self) -> f64 {
        self.damping
    }

    /// Clamps the nodes on x- and x+ and gives the film between them the velocity of a uniform stretch, so that no wave
    /// is excited. There is no jaw on a mirror plane.
    fn hold(&self, nodes: &mut Nodes, mesh: &Mesh, first: usize, _: &Hold) -> Vec<Jaw> {
        for n in first..nodes.position.len() {
            nodes.velocity.set(n, [self.velocity * nodes.position.value_at(n)[0] / self.gauge, 0.0, 0.0]);
        }
        let jaw = |(side, speed): (Side, f64)| {
            let held: Vec<u32> = mesh.sides[side as usize].iter().map(|n| first as u32 + n).collect();
            nodes.hold(held.iter().map(|n| *n as usize), [true; 3]);
            held.iter().for_each(|n| nodes.velocity.set(*n as usize, [speed, 0.0, 0.0]));
            Jaw { nodes: held, velocity: speed }
        };
        let jaws = [(Side::XMinus, -0.5 * self.velocity), (Side::XPlus, 0.5 * self.velocity)].map(jaw);
        jaws.into_iter().filter(|jaw| !jaw.nodes.is_empty()).collect()
    }

    fn apply(&self, _: &[Film], _: &Nodes, _: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        Ok(vec![])
    }

    /// The force of the jaws is a signal of its own.
    fn has_frame_force(&self) -> bool {
        false
    }

    /// Travel of the jaws, their force, engineering strain and stress.
    fn signals(&self, tracks: &Tracks, mounting: &Mounting) -> Recording {
        let Stretch { velocity, section, gauge, .. } = *self;
        let copies = mounting.films.first().map_or(1.0, |f| if f.mirrored[1] { 2.0 } else { 1.0 });
        let row = |k: usize| {
            let displacement = velocity * k as f64 * tracks.sampling.interval;
            let force = copies * tracks.jaws.rows[k][0];
            [displacement, force, displacement / gauge, force / section]
        };
        let rows: Vec<_> = (0..tracks.sampling.count.min(tracks.jaws.rows.len())).map(row).collect();
        tracks.table(&[column::DISPLACEMENT.name, column::FORCE.name, column::STRAIN.name, column::STRESS.name], &rows)
    }
}
