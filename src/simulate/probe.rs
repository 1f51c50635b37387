//! The observer of a run: signals, audits, frames, warnings and progress.

use std::time::Duration;

use super::build::Mounting;
use super::energy_check::EnergyCheck;
use super::grid::Grid;
use super::rates::RateAudit;
use super::warnings::{Figures, Warnings};
use super::{Frame, Outcome, Progress, frames};
use crate::engine::{ElementStrain, Engine, Fault, Observer, Track, View};
use crate::model::{Loading, Model};
use crate::signal::{Channel, Recording};

/// Looks at the energies, the contact and the strain around it in a run, unless there are fewer samples.
const AUDITS: f64 = 400.0;

/// Gathers the outcome of a run while it goes.
pub(super) struct Probe<'a> {
    model: &'a Model,
    progress: &'a mut dyn FnMut(Progress),
    duration: f64,
    sample: f64,
    samples: usize,
    frame: f64,
    audit: f64,
    audits: usize,
    strains: Grid<2>,
    frames: Vec<Frame>,
    at_steps: Grid<3>,
    at_half_steps: Grid<2>,
    energy: EnergyCheck,
    rates: RateAudit,
    warnings: Warnings,
    rupture_time: Option<f64>,
    penetration: Option<f64>,
    lowest: f64,
    first_contact: Option<f64>,
}

impl<'a> Probe<'a> {
    pub(super) fn new(model: &'a Model, mounting: &Mounting, progress: &'a mut dyn FnMut(Progress)) -> Probe<'a> {
        let sample = 1.0 / model.output.sample_rate;
        let (duration, speed, gravity) = match model.loading {
            Loading::Impact { velocity, duration, gravity } => (duration, velocity, gravity),
            Loading::Stretch { velocity, until, .. } => (until * mounting.gauge / velocity, 0.0, 0.0),
        };
        let mass = model.impactor.as_ref().map_or(0.0, |i| i.mass);
        let measured = model.faces.iter().map(|f| f.material.measured_rates).collect();
        let mut at_half_steps = Grid::new(-0.5 * sample, 0.5 * sample);
        // Free fall before first contact, so that the first sample is a mean like every other.
        at_half_steps.push(-sample, [gravity * sample - speed, 0.0]);
        at_half_steps.push(0.0, [-speed, 0.0]);
        Probe {
            model,
            progress,
            duration,
            sample,
            samples: (duration / sample * (1.0 + 1e-12)).floor() as usize + 1,
            frame: duration / model.output.frames.saturating_sub(1).max(1) as f64,
            audit: (duration / AUDITS).max(sample),
            audits: 0,
            strains: Grid::new(0.0, sample),
            frames: vec![],
            at_steps: Grid::new(0.0, sample),
            at_half_steps,
            energy: EnergyCheck::new(0.5 * mass * speed * speed),
            rates: RateAudit::new(measured),
            warnings: Warnings::default(),
            rupture_time: None,
            penetration: None,
            lowest: f64::INFINITY,
            first_contact: None,
        }
    }

    /// Whether everything that was asked for has been seen by `time` (s).
    pub(super) fn is_done(&self, time: f64) -> bool {
        time > self.duration
            && self.at_steps.rows.len() >= self.samples
            && self.at_half_steps.rows.len() > 2 * self.samples
    }

    /// Elements broke in the step from `time` (s).
    pub(super) fn broke(&mut self, time: f64) {
        self.rupture_time.get_or_insert(time);
    }

    fn sample_due(&self, time: f64) -> bool {
        self.strains.rows.len() < self.samples && self.strains.is_due(time)
    }

    fn frame_due(&self, time: f64) -> bool {
        self.frames.len() < self.model.output.frames && self.frames.len() as f64 * self.frame <= time
    }

    fn audit_due(&self, time: f64) -> bool {
        self.audits as f64 * self.audit <= time
    }

    fn take_sample(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) {
        let intact = || faces.iter().flatten().filter(|s| s.volume > 0.0);
        let largest = |fibre: usize| intact().map(|s| s.strain[fibre]).fold(f64::NAN, f64::max);
        self.strains.push(view.time, [largest(0), largest(1)]);
        self.rates.sample(view.time, faces);
        let z = view.body.map_or(f64::NEG_INFINITY, |body| body.centre().z);
        if z <= self.lowest {
            self.lowest = z;
            self.rates.commit();
        }
        (self.progress)(Progress { done: view.time / self.duration, time: view.time, steps: view.steps });
    }

    fn take_audit(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) -> Result<(), Fault> {
        self.audits += 1;
        let energies = view.energies();
        if !energies.total().is_finite() {
            return Err(not_a_number(view.time, faces));
        }
        self.warnings.strain(view, faces);
        if let (Some(seen), Some(size)) = (view.inspect(), view.impactor_size()) {
            self.warnings.touch(view.time, size, &seen);
            self.penetration = Some(self.penetration.unwrap_or(0.0).max(seen.penetration / size));
        }
        self.energy.sample(view.time, energies)
    }

    /// The outcome after the last step of `engine`.
    pub(super) fn finish(self, engine: &Engine, mounting: Mounting, wall: Duration) -> Outcome {
        let slow = matches!(self.model.loading, Loading::Stretch { .. });
        let kinetic_share = slow.then(|| self.energy.kinetic_share());
        let balance = self.energy.balance_error();
        let signals = if slow { self.stretch_signals(&mounting) } else { self.impact_signals(&mounting) };
        let energies = self.energy.recording();
        let rates = self.rates.finish();
        let unfinished = signals.channel("contact_force_N").is_some_and(ends_loaded);
        let figures = Figures { balance, outside: rates.outside, kinetic: kinetic_share, unfinished };
        Outcome {
            signals,
            energies,
            frames: self.frames,
            warnings: self.warnings.finish(&figures, &mounting.films),
            films: mounting.films,
            rates,
            rupture_time: self.rupture_time,
            energy_balance_error: balance,
            kinetic_share,
            mass_scaling: mounting.mass_scaling,
            penetration: self.penetration,
            elements: engine.elements(),
            steps: engine.steps(),
            time_step: engine.time() / engine.steps().max(1) as f64,
            wall,
        }
    }

    fn impact_signals(&self, mounting: &Mounting) -> Recording {
        let mass = self.model.impactor.as_ref().map_or(0.0, |i| i.mass);
        let gravity = match self.model.loading {
            Loading::Impact { gravity, .. } => gravity,
            Loading::Stretch { .. } => 0.0,
        };
        let start = self.first_contact.unwrap_or(mounting.start);
        let half = &self.at_half_steps.rows;
        let complete = self.samples.min(self.at_steps.rows.len()).min(half.len().saturating_sub(1) / 2);
        let count = complete.min(self.strains.rows.len());
        let row = |k: usize| {
            let [z, work, _] = self.at_steps.rows[k];
            let velocity = half[2 * k + 1][0];
            let acceleration = (half[2 * k + 2][0] - half[2 * k][0]) / self.sample;
            let displacement = z - start;
            let kinetic = 0.5 * mass * velocity * velocity;
            let potential = mass * gravity * displacement;
            let force = (half[2 * k + 2][1] - half[2 * k][1]) / self.sample;
            let [md, td] = self.strains.rows[k];
            [displacement, velocity, acceleration, force, kinetic, potential, work, kinetic + potential + work, md, td]
        };
        let rows: Vec<_> = (0..count).map(row).collect();
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
        table(self.sample, &NAMES, &rows)
    }

    fn stretch_signals(&self, mounting: &Mounting) -> Recording {
        let Loading::Stretch { velocity, .. } = self.model.loading else { return Recording::default() };
        let copies = mounting.films.first().map_or(1.0, |f| if f.mirrored[1] { 2.0 } else { 1.0 });
        let count = self.samples.min(self.at_steps.rows.len());
        let row = |k: usize| {
            let displacement = velocity * k as f64 * self.sample;
            let force = copies * self.at_steps.rows[k][2];
            [displacement, force, displacement / mounting.gauge, force / mounting.section]
        };
        let rows: Vec<_> = (0..count).map(row).collect();
        table(self.sample, &["displacement_m", "force_N", "strain", "stress_Pa"], &rows)
    }
}

/// Whether a force is still more than a hundredth of its peak over the last hundredth of its samples.
fn ends_loaded(force: &[f64]) -> bool {
    let peak = force.iter().copied().fold(0.0, f64::max);
    let last = &force[force.len() - force.len().div_ceil(100)..];
    let mean = last.iter().sum::<f64>() / last.len().max(1) as f64;
    mean > 0.01 * peak
}

fn table<const K: usize>(sample: f64, names: &[&str; K], rows: &[[f64; K]]) -> Recording {
    Recording {
        time: (0..rows.len()).map(|k| k as f64 * sample).collect(),
        channels: (0..K)
            .map(|c| Channel { name: names[c].to_string(), values: rows.iter().map(|r| r[c]).collect() })
            .collect(),
    }
}

fn not_a_number(time: f64, faces: &[Vec<ElementStrain>]) -> Fault {
    let lost = |s: &ElementStrain| !s.strain.iter().all(|e| e.is_finite());
    let found = faces.iter().enumerate().find_map(|(face, s)| s.iter().position(lost).map(|element| (face, element)));
    match found {
        Some((face, element)) => Fault::NotANumber { time, face: face + 1, element },
        None => Fault::ImpactorLost { time },
    }
}

impl Observer for Probe<'_> {
    fn wants(&self, time: f64) -> bool {
        self.sample_due(time) || self.frame_due(time) || self.audit_due(time)
    }

    fn see(&mut self, view: &View<'_>) -> Result<(), Fault> {
        let faces = view.strains();
        if self.frame_due(view.time) {
            self.frames.push(frames::frame(view, &faces));
        }
        if self.sample_due(view.time) {
            self.take_sample(view, &faces);
        }
        if self.audit_due(view.time) { self.take_audit(view, &faces) } else { Ok(()) }
    }

    fn follow(&mut self, track: &Track) {
        if track.impulse != 0.0 {
            self.first_contact.get_or_insert(track.z);
        }
        self.at_steps.push(track.time, [track.z, track.work, track.jaw_force]);
        self.at_half_steps.push(track.time + 0.5 * track.dt, [track.velocity, track.impulse]);
    }
}
