//! The signals of an impact.

use super::build::Mounting;
use super::tracks::Tracks;
use crate::signal::Recording;

const NAMES: [&str; 10] = [
    "displacement_m",
    "velocity_m_s",
    "acceleration_m_s2",
    "contact_force_N",
    "kinetic_energy_J",
    "potential_energy_J",
    "absorbed_energy_J",
    "total_energy_J",
    "max_strain_md",
    "max_strain_td",
];

/// Motion and energies of an impactor of `mass` (kg) under `gravity` (m/s²) and the largest strains (theory.md, section 8).
pub(super) fn signals(tracks: &Tracks, mounting: &Mounting, mass: f64, gravity: f64) -> Recording {
    let start = tracks.first_contact.unwrap_or(mounting.start);
    let half = &tracks.at_half_steps.rows;
    let row = |k: usize| {
        let [z, work, _] = tracks.at_steps.rows[k];
        let velocity = half[2 * k + 1][0];
        let acceleration = (half[2 * k + 2][0] - half[2 * k][0]) / tracks.sample;
        let displacement = z - start;
        let kinetic = 0.5 * mass * velocity * velocity;
        let potential = mass * gravity * displacement;
        let force = tracks.contact_force(k);
        let [md, td] = tracks.strains.rows[k];
        [displacement, velocity, acceleration, force, kinetic, potential, work, kinetic + potential + work, md, td]
    };
    let rows: Vec<_> = (0..tracks.whole().min(tracks.strains.rows.len())).map(row).collect();
    tracks.table(&NAMES, &rows)
}

/// Whether a force is still more than a hundredth of its peak over the last hundredth of its samples.
pub(super) fn ends_loaded(force: &[f64]) -> bool {
    let peak = force.iter().copied().fold(0.0, f64::max);
    let last = &force[force.len() - force.len().div_ceil(100)..];
    let mean = last.iter().sum::<f64>() / last.len().max(1) as f64;
    mean > 0.01 * peak
}
