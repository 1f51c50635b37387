//! Impact: a body falls onto the film.

use super::LoadCase;
use crate::model::{Guide, Impactor, Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::{self, Mounting};
use crate::simulate::tracks::{BodyTracks, Tracks};
use lab::signal::{Channel, Recording, column};
use membrane::engine::{self, Film, Loads, Nodes, RigidBody};

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

/// Bodies that meet the film under `gravity` (m/s²).
pub(super) struct Impact<'a> {
    model: &'a Model,
    gravity: f64,
}

impl<'a> Impact<'a> {
    /// The loading of `model`.
    pub(super) fn new(model: &'a Model, loading: &loading::Impact) -> Impact<'a> {
        Impact { model, gravity: loading.gravity }
    }
}

impl LoadCase for Impact<'_> {
    fn damping(&self) -> f64 {
        self.model.specimen.damping
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        loads.gravity = self.gravity;
        let mounted = |(place, impactor): (usize, &Impactor)| {
            let (contact, pose) = mount::above_film(place, self.model, films, nodes)?;
            let body = mount::rigid_body(impactor, contact.surface(), pose);
            let in_contact = impactor.height.is_none() && !matches!(impactor.guide, Guide::Hinge { .. });
            let impact = engine::Impact::new(body, contact).starting_in_contact(in_contact);
            Ok(impact.with_restitution(impactor.restitution).released_at(impactor.release))
        };
        self.model.impactors.iter().enumerate().map(mounted).collect()
    }

    fn approach(&self, body: &RigidBody) -> [f64; 2] {
        [-body.velocity.z, body.free_acceleration(self.gravity)]
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
            let potential = mass * self.gravity * displacement;
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
