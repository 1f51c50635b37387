//! Indentation, impact and stretch: rigid bodies and jaws, and the channels of their signals.

use nalgebra::Isometry3;

use super::{LoadCase, PERIODS, periods};
use crate::mesh::{Mesh, Outline, Side};
use crate::model::{Face, Guide, Hold, Impactor, Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::{self, Mounting};
use crate::simulate::tracks::{BodyTracks, Tracks};
use lab::signal::{Channel, Recording, column};
use membrane::engine::{self, Contact, Film, Jaw, Loads, Nodes, RigidBody};

/// Decay times of a free oscillation in the duration of the indentation. The force is recorded throughout, so damping
/// must not add to it.
const DECAYS_OF_INDENTATION: f64 = 10.0;

/// Gap over the impactor's size that counts as closed.
const CLOSED: f64 = 1e-9;

/// Least step down over the impactor's size: beside nodes that it passes closely, steps of the gap alone would be too
/// many.
const LEAST_STEP: f64 = 1e-3;

/// An impactor that moves down.
pub(super) struct Indent<'a> {
    pub(super) model: &'a Model,
    pub(super) loading: &'a loading::Indent,
}

impl LoadCase for Indent<'_> {
    fn excess(&self, _: f64) -> f64 {
        let stretch = |_: &_, radius: f64| (self.loading.depth / radius).hypot(1.0);
        periods(self.model, self.model.run_time(), stretch) / PERIODS
    }

    fn damping(&self) -> f64 {
        2.0 * DECAYS_OF_INDENTATION / self.model.run_time()
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, _: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        if self.model.impactors.is_empty() {
            return Ok(vec![]);
        }
        let (contact, mut pose) = mount::above_film(0, self.model, films, nodes)?;
        pose.translation.vector.z -= travel_to_contact(&contact, &pose, nodes).ok_or_else(|| {
            RunError::at_position(0, "there is no film below the impactor", "change `impactor.position`")
        })?;
        let body = RigidBody::prescribed(pose, -self.loading.velocity);
        Ok(vec![engine::Impact::new(body, contact).starting_in_contact(true)])
    }

    fn approach(&self, _body: &RigidBody) -> [f64; 2] {
        [self.loading.velocity, 0.0]
    }

    /// Depth below first contact and the force on the impactor: the impulse of the film between two samples over that
    /// time.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let force = |k: usize| tracks.bodies.iter().map(|body| body.contact_force(k)).sum();
        let row = |k: usize| [self.loading.velocity * k as f64 * tracks.sampling.interval, force(k)];
        let rows: Vec<_> = (0..tracks.whole()).map(row).collect();
        tracks.table(&[column::DEPTH.name, column::FORCE.name], &rows)
    }
}

/// Travel (m) of the impactor at `pose` down to first contact; none where it passes all nodes. No gap closes faster
/// than the impactor goes down, so each step is the smallest gap, but at least the least step; if a node is then
/// inside, contact is found by bisection.
fn travel_to_contact(contact: &Contact, pose: &Isometry3<f64>, nodes: &Nodes) -> Option<f64> {
    let surface = contact.surface();
    let mut travel = 0.0;
    let lowest = nodes.position.iter().fold(f64::INFINITY, |low, x| low.min(x[2]));
    let gap_at = |travel: f64| {
        let mut at = *pose;
        at.translation.vector.z -= travel;
        contact.smallest_gap(nodes, &at)
    };
    let (closed, least_step) = (CLOSED * surface.size(), LEAST_STEP * surface.size());
    let mut gap = gap_at(travel);
    while gap >= closed {
        let before = travel;
        travel += gap.max(least_step);
        if pose.translation.vector.z - travel + surface.bounding_radius() <= lowest {
            return None;
        }
        gap = gap_at(travel);
        if gap < 0.0 {
            return Some(bisected(before, travel, closed, gap_at));
        }
    }
    Some(travel)
}

/// Travel (m) between one without contact and one with a node inside at which the gap is below `closed`.
fn bisected(mut clear: f64, mut inside: f64, closed: f64, gap_at: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (clear + inside);
        let gap = gap_at(middle);
        if gap < 0.0 {
            inside = middle;
        } else {
            clear = middle;
        }
        if (0.0..closed).contains(&gap) {
            break;
        }
    }
    clear
}

/// Channels of an impactor.
const NAMES: [&str; 8] = [
    column::DISPLACEMENT.name,
    column::VELOCITY.name,
    column::ACCELERATION.name,
    column::CONTACT_FORCE.name,
    column::KINETIC_ENERGY.name,
    column::POTENTIAL_ENERGY.name,
    column::ABSORBED_ENERGY.name,
    column::TOTAL_ENERGY.name,
];

/// Further channels of an impactor that does not move along z alone.
const SPATIAL: [&str; 7] = [
    column::DISPLACEMENT_X.name,
    column::DISPLACEMENT_Y.name,
    column::VELOCITY_X.name,
    column::VELOCITY_Y.name,
    column::ACCELERATION_X.name,
    column::ACCELERATION_Y.name,
    column::ACCELERATION_RESULTANT.name,
];

/// Bodies that meet the film.
pub(super) struct Impact<'a> {
    pub(super) model: &'a Model,
    pub(super) loading: &'a loading::Impact,
}

impl LoadCase for Impact<'_> {
    fn damping(&self) -> f64 {
        self.model.specimen.damping
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        loads.gravity = self.loading.gravity;
        let mounted = |(place, impactor): (usize, &Impactor)| {
            let (contact, pose) = mount::above_film(place, self.model, films, nodes)?;
            let body = mount::rigid_body(impactor, contact.surface(), pose);
            let in_contact = impactor.height.is_none() && !matches!(impactor.guide, Guide::Hinge(_));
            let impact = engine::Impact::new(body, contact).starting_in_contact(in_contact);
            Ok(impact.with_restitution(impactor.restitution).released_at(impactor.release))
        };
        self.model.impactors.iter().enumerate().map(mounted).collect()
    }

    fn approach(&self, body: &RigidBody) -> [f64; 2] {
        [-body.velocity.z, body.free_acceleration(self.loading.gravity)]
    }

    fn energy_scale(&self, body: &RigidBody) -> f64 {
        body.kinetic_energy(body)
    }

    /// Motion and energies of the impactors and the largest strains (methods.md, section 8). Of several impactors, names
    /// of channels begin with theirs.
    fn signals(&self, tracks: &Tracks, mounting: &Mounting) -> Recording {
        let strains = tracks
            .table(&[column::MAX_STRAIN_MD.name, column::MAX_STRAIN_TD.name], &tracks.strains.rows[..tracks.whole()]);
        let Recording { time, channels: strains } = strains;
        let bodies = self.model.impactors.iter().zip(&tracks.bodies).zip(&mounting.bodies);
        let mut tables: Vec<[Vec<Channel>; 2]> =
            bodies.map(|((impactor, body), mounting)| self.of_body(impactor, tracks, body, mounting.start)).collect();
        let channels = match tables.as_mut_slice() {
            [[along_z, spatial]] => [std::mem::take(along_z), strains, std::mem::take(spatial)].concat(),
            _ => {
                let named = |(prefix, channels): (String, [Vec<Channel>; 2])| {
                    let name = move |channel: Channel| Channel { name: format!("{prefix}{}", channel.name), ..channel };
                    channels.concat().into_iter().map(name).collect::<Vec<Channel>>()
                };
                self.model.prefixes().into_iter().zip(tables).flat_map(named).chain(strains).collect()
            }
        };
        Recording { time, channels }
    }
}

impl Impact<'_> {
    /// Channels of an impactor that starts at the height `start` (m): those of every one, and those of one that does
    /// not move along z alone.
    fn of_body(&self, impactor: &Impactor, tracks: &Tracks, body: &BodyTracks, start: f64) -> [Vec<Channel>; 2] {
        let mass = if impactor.mass.is_finite() { impactor.mass } else { 0.0 };
        let start = body.first_contact.unwrap_or(start);
        let (half, lateral) = (&body.at_half_steps.rows, &body.lateral_half.rows);
        let is_held = |k: usize| k as f64 * tracks.sampling.interval < impactor.release;
        let row = |k: usize| {
            let [z, work] = body.at_steps.rows[k];
            let velocity = if is_held(k) { 0.0 } else { half[2 * k + 1][0] };
            let acceleration = (half[2 * k + 2][0] - half[2 * k][0]) / tracks.sampling.interval;
            let displacement = z - start;
            let besides = lateral.get(2 * k + 1).filter(|_| !is_held(k)).map_or(0.0, |[_, _, energy]| *energy);
            let kinetic = 0.5 * mass * velocity * velocity + besides;
            let potential = mass * self.loading.gravity * displacement;
            let force = body.contact_force(k);
            [displacement, velocity, acceleration, force, kinetic, potential, work, kinetic + potential + work]
        };
        let rows: Vec<_> = (0..tracks.whole()).map(row).collect();
        let from = body.lateral.rows.first().copied().unwrap_or_default();
        let spatial = |k: usize| {
            let [x, y] = body.lateral.rows[k];
            let [along_x, along_y] = if is_held(k) { [0.0; 2] } else { [0, 1].map(|axis| lateral[2 * k + 1][axis]) };
            let of = |axis: usize| (lateral[2 * k + 2][axis] - lateral[2 * k][axis]) / tracks.sampling.interval;
            let (across, up) = ([of(0), of(1)], rows[k][2]);
            let resultant = (across[0] * across[0] + across[1] * across[1] + up * up).sqrt();
            [x - from[0], y - from[1], along_x, along_y, across[0], across[1], resultant]
        };
        let spatial = body.is_spatial.then(|| {
            let spatial: Vec<_> = (0..rows.len()).map(spatial).collect();
            tracks.table(&SPATIAL, &spatial).channels
        });
        let mut along_z = tracks.table(&NAMES, &rows).channels;
        if self.model.impactors.len() > 1 || self.model.frame.bars.is_some() {
            let values = (0..rows.len()).map(|k| body.collision_force(k)).collect();
            along_z.push(Channel { name: column::COLLISION_FORCE.name.into(), values });
        }
        [along_z, spatial.unwrap_or_default()]
    }
}

/// Whether the mean of the last hundredth of the samples of a force exceeds a hundredth of its peak.
pub fn ends_loaded(force: &[f64]) -> bool {
    let peak = force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let last = &force[force.len() - force.len().div_ceil(100)..];
    let mean = last.iter().map(|force| force.abs()).sum::<f64>() / last.len().max(1) as f64;
    mean > 0.01 * peak
}

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
