//! Impact: a body falls onto the film.

use super::{Inertia, LoadCase, MassScaling};
use crate::engine::{self, Film, Loads, Nodes, RigidBody};
use crate::model::{Guide, Model};
use crate::signal::{Recording, column};
use crate::simulate::fault::RunError;
use crate::simulate::mount::{self, Mounting};
use crate::simulate::tracks::Tracks;

const NAMES: [&str; 10] = [
    column::DISPLACEMENT.name,
    column::VELOCITY.name,
    column::ACCELERATION.name,
    column::CONTACT_FORCE.name,
    column::KINETIC_ENERGY.name,
    column::POTENTIAL_ENERGY.name,
    column::ABSORBED_ENERGY.name,
    column::TOTAL_ENERGY.name,
    column::MAX_STRAIN_MD.name,
    column::MAX_STRAIN_TD.name,
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

/// A body that meets the film under `gravity` (m/s²).
pub(super) struct Impact<'a> {
    pub(super) model: &'a Model,
    pub(super) gravity: f64,
}

impl LoadCase for Impact<'_> {
    fn inertia(&self) -> Inertia {
        Inertia::Dynamic
    }

    fn mass_scaling(&self) -> MassScaling {
        MassScaling::Unscaled
    }

    fn damping(&self) -> f64 {
        self.model.specimen.damping
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, loads: &mut Loads) -> Result<Option<engine::Impact>, RunError> {
        loads.gravity = self.gravity;
        mount::surround(self.model, films, nodes, loads);
        let Some(impactor) = &self.model.impactor else { return Ok(None) };
        let (contact, pose) = mount::over_film(impactor, self.model, films, nodes)?;
        let body = mount::falling(impactor, contact.surface(), pose);
        let in_contact = impactor.height.is_none() && !matches!(impactor.guide, Guide::Hinge { .. });
        Ok(Some(engine::Impact { body, contact, in_contact }))
    }

    fn approach(&self, body: &RigidBody) -> [f64; 2] {
        [-body.velocity.z, body.free_acceleration(self.gravity)]
    }

    fn energy_scale(&self, body: &RigidBody) -> f64 {
        body.kinetic_energy(body)
    }

    /// Motion and energies of the impactor and the largest strains (theory.md, section 8).
    fn signals(&self, tracks: &Tracks, mounting: &Mounting) -> Recording {
        let mass = self.model.impactor.as_ref().map_or(0.0, |impactor| impactor.mass);
        let mass = if mass.is_finite() { mass } else { 0.0 };
        let start = tracks.first_contact.unwrap_or(mounting.start);
        let (half, lateral) = (&tracks.at_half_steps.rows, &tracks.lateral_half.rows);
        let row = |k: usize| {
            let [z, work, _] = tracks.at_steps.rows[k];
            let velocity = half[2 * k + 1][0];
            let acceleration = (half[2 * k + 2][0] - half[2 * k][0]) / tracks.sample;
            let displacement = z - start;
            let besides = lateral.get(2 * k + 1).map_or(0.0, |[_, _, energy]| *energy);
            let kinetic = 0.5 * mass * velocity * velocity + besides;
            let potential = mass * self.gravity * displacement;
            let force = tracks.contact_force(k);
            let [md, td] = tracks.strains.rows[k];
            [displacement, velocity, acceleration, force, kinetic, potential, work, kinetic + potential + work, md, td]
        };
        let rows: Vec<_> = (0..tracks.whole().min(tracks.strains.rows.len())).map(row).collect();
        let mut signals = tracks.table(&NAMES, &rows);
        if tracks.are_spatial {
            let from = tracks.lateral.rows.first().copied().unwrap_or_default();
            let spatial = |k: usize| {
                let [x, y] = tracks.lateral.rows[k];
                let [along_x, along_y, _] = lateral[2 * k + 1];
                let of = |axis: usize| (lateral[2 * k + 2][axis] - lateral[2 * k][axis]) / tracks.sample;
                let (across, up) = ([of(0), of(1)], rows[k][2]);
                let resultant = (across[0] * across[0] + across[1] * across[1] + up * up).sqrt();
                [x - from[0], y - from[1], along_x, along_y, across[0], across[1], resultant]
            };
            let spatial: Vec<_> = (0..rows.len()).map(spatial).collect();
            signals.channels.extend(tracks.table(&SPATIAL, &spatial).channels);
        }
        signals
    }
}

/// Whether the mean of the last hundredth of the samples of a force exceeds a hundredth of its peak.
pub(in crate::simulate) fn ends_loaded(force: &[f64]) -> bool {
    let peak = force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let last = &force[force.len() - force.len().div_ceil(100)..];
    let mean = last.iter().map(|force| force.abs()).sum::<f64>() / last.len().max(1) as f64;
    mean > 0.01 * peak
}
