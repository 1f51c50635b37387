//! The observer of a run: signals, audits, snapshots, warnings and progress.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::energy_check::EnergyCheck;
use super::fault::Fault;
use super::frame_force::HeldSides;
use super::loading::{self, Inertia, LoadCase};
use super::monitor::{Figures, Monitor};
use super::mount::Mounting;
use super::outcome::Outcome;
use super::rates::RateAudit;
use super::rise::{self, Rise};
use super::snapshot::{self, Snapshot};
use super::tracks::Tracks;
use super::warning::bounds::KINETIC;
use crate::engine::{self, ElementStrain, Engine, Observer, Track, View};
use crate::model::Model;
use crate::signal::{Recording, column};

/// Looks at the energies, the contact and the strain around it in a run, unless there are fewer samples.
const AUDITS: f64 = 400.0;

/// Change of an inflated film in the last tenth of its run, over its deflection, above which it is not at rest.
const RESTLESS: f64 = 2e-3;

/// Part of a slow test after which its energies are judged while it runs; at its end they are judged as a whole.
const JUDGED_FROM: f64 = 0.1;

/// Records the outcome of a run while it steps.
pub(super) struct Probe<'a> {
    model: &'a Model,
    loading: Box<dyn LoadCase + 'a>,
    duration: f64,
    /// Number of snapshots.
    snapshots: usize,
    /// Time between two of them, s.
    snapshot_interval: f64,
    /// Whether they have their detail.
    detailed: bool,
    audit: f64,
    held: HeldSides,
    /// Strains of all elements, as last looked at.
    faces: Vec<Vec<ElementStrain>>,
    record: Record,
}

/// What a probe has recorded so far, and needs again when the run resumes from a checkpoint.
#[derive(Serialize, Deserialize)]
pub(super) struct Record {
    audits: usize,
    tracks: Tracks,
    rise: Rise,
    snapshots: Vec<Snapshot>,
    energy: EnergyCheck,
    rates: RateAudit,
    monitor: Monitor,
    rupture_time: Option<f64>,
    penetration: Option<f64>,
    lowest: f64,
}

impl<'a> Probe<'a> {
    pub(super) fn new(model: &'a Model, mounting: &Mounting, detailed: bool) -> Probe<'a> {
        let sample = 1.0 / model.output.sample_rate;
        let duration = model.run_time();
        let loading = loading::of(model);
        let [speed, gravity] = loading.approach();
        let judged_from = if loading.inertia() == Inertia::Dynamic { 0.0 } else { JUDGED_FROM * duration };
        let measured = model.faces.iter().map(|f| f.material.measured_rates).collect();
        let snapshots = snapshot::count(model.output.frames, &mounting.films, detailed);
        let record = Record {
            audits: 0,
            tracks: Tracks::new(duration, sample, speed, gravity),
            rise: Rise::default(),
            snapshots: vec![],
            energy: EnergyCheck::new(loading.energy_scale(), judged_from),
            rates: RateAudit::new(measured),
            monitor: Monitor::default(),
            rupture_time: None,
            penetration: None,
            lowest: f64::INFINITY,
        };
        Probe {
            model,
            loading,
            duration,
            snapshots,
            snapshot_interval: duration / snapshots.saturating_sub(1).max(1) as f64,
            detailed,
            held: mounting.held.clone(),
            audit: (duration / AUDITS).max(sample),
            faces: vec![],
            record,
        }
    }

    /// What was recorded so far.
    pub(super) fn record(&self) -> &Record {
        &self.record
    }

    /// Resumes from the record of a checkpoint.
    pub(super) fn resume(&mut self, record: Record) {
        self.record = record;
    }

    /// Snapshots so far.
    pub(super) fn snapshots(&self) -> &[Snapshot] {
        &self.record.snapshots
    }

    /// The energy audit so far.
    pub(super) fn energies(&self) -> Recording {
        self.record.energy.recording()
    }

    /// Simulated time, s.
    pub(super) fn duration(&self) -> f64 {
        self.duration
    }

    /// Whether everything that was asked for has been seen by `time` (s).
    pub(super) fn is_done(&self, time: f64) -> bool {
        let broke = self.record.rupture_time.is_some() && self.is_quasi_static();
        broke || (time > self.duration && self.record.tracks.are_complete())
    }

    /// Whether inertia must not matter; then the failure of the film ends the test.
    fn is_quasi_static(&self) -> bool {
        self.loading.inertia() == Inertia::Negligible
    }

    /// The fault of a run as a whole: energies that do not add up, or a test that was not quasi-static as it should be.
    pub(super) fn fault(&self) -> Option<Fault> {
        self.record.energy.fault().or_else(|| self.unsteady())
    }

    fn unsteady(&self) -> Option<Fault> {
        let (time, share) = self.record.energy.kinetic_share();
        if self.is_quasi_static() && share > KINETIC {
            return Some(Fault::NotQuasiStatic { time, share });
        }
        let restless = self.settling().filter(|change| *change > RESTLESS);
        restless.map(|change| Fault::NotAtRest { time: self.duration, change })
    }

    /// How far an inflated film that held is at rest.
    fn settling(&self) -> Option<f64> {
        self.record.rupture_time.is_none().then(|| rise::settling(&self.record.tracks))?
    }

    /// Elements failed in the step from `time` (s).
    pub(super) fn broke(&mut self, time: f64) {
        self.record.rupture_time.get_or_insert(time);
    }

    fn snapshot_due(&self, time: f64) -> bool {
        self.record.snapshots.len() < self.snapshots
            && self.record.snapshots.len() as f64 * self.snapshot_interval <= time
    }

    fn audit_due(&self, time: f64) -> bool {
        self.record.audits as f64 * self.audit <= time
    }

    fn look(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) -> Result<(), engine::Fault> {
        if self.snapshot_due(view.time) {
            self.record.snapshots.push(snapshot::snapshot(view, faces, self.detailed));
        }
        if self.record.tracks.is_due(view.time) {
            self.take_sample(view, faces);
        }
        if self.audit_due(view.time) { self.take_audit(view, faces) } else { Ok(()) }
    }

    fn take_sample(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) {
        let intact = || faces.iter().flatten().filter(|s| s.volume > 0.0);
        let largest = |fibre: usize| intact().map(|s| s.strain[fibre]).fold(f64::NAN, f64::max);
        self.record.tracks.strains.push(view.time, [largest(0), largest(1)]);
        if self.held.are_there() {
            self.record.tracks.frame.push(view.time, self.held.pull(view.nodes));
        }
        if self.loading.has_rise() {
            self.record.tracks.rise.push(view.time, [self.record.rise.largest(view)]);
        }
        self.record.rates.sample(view.time, faces);
        let z = view.body.map_or(f64::NEG_INFINITY, |body| body.centre().z);
        if z <= self.record.lowest {
            self.record.lowest = z;
            self.record.rates.commit();
        }
    }

    fn take_audit(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) -> Result<(), engine::Fault> {
        self.record.audits += 1;
        let energies = view.energies();
        if !energies.total().is_finite() {
            return Err(not_a_number(view.time, faces));
        }
        self.record.monitor.strain(view, faces);
        if let (Some(seen), Some(size)) = (view.contact_state(), view.impactor_size()) {
            self.record.monitor.contact(view.time, size, &seen);
            self.record.penetration = Some(self.record.penetration.unwrap_or(0.0).max(seen.penetration / size));
        }
        self.record.energy.sample(view.time, energies).map_err(|_| engine::Fault::Stopped)
    }

    /// The outcome after the last step of `engine`.
    pub(super) fn finish(self, engine: &Engine, mounting: Mounting, wall: Duration) -> Outcome {
        let slow = self.loading.inertia() != Inertia::Dynamic;
        let kinetic_share = slow.then(|| self.record.energy.kinetic_share().1);
        let damping_share = slow.then(|| self.record.energy.damping_share());
        let balance = self.record.energy.balance_error();
        let settling = self.settling();
        let signals = self.signals(&mounting);
        let energies = self.energies();
        let rates = self.record.rates.finish();
        let unfinished = signals.channel(column::CONTACT_FORCE.name).is_some_and(loading::ends_loaded);
        let snapshots = [self.model.output.frames, self.snapshots];
        let figures = Figures { balance, outside: rates.outside, kinetic: kinetic_share, snapshots, unfinished };
        Outcome {
            signals,
            energies,
            snapshots: self.record.snapshots,
            warnings: self.record.monitor.finish(&figures, &mounting.films),
            films: mounting.films,
            impactor: engine.impactor().cloned(),
            rates,
            rupture_time: self.record.rupture_time,
            energy_balance_error: balance,
            kinetic_share,
            damping_share,
            settling,
            mass_scaling: mounting.mass_scaling,
            penetration: self.record.penetration,
            elements: engine.elements(),
            bytes: engine.bytes(),
            threads: engine.pool().threads(),
            instructions: engine.pool().width(),
            steps: engine.steps(),
            time_step: engine.time() / engine.steps().max(1) as f64,
            wall,
        }
    }

    /// The signals of `signals.csv` so far.
    pub(super) fn signals(&self, mounting: &Mounting) -> Recording {
        let tracks = &self.record.tracks;
        let mut signals = self.loading.signals(tracks, mounting);
        self.held.add_columns(&tracks.frame.rows, &mut signals);
        signals
    }
}

fn not_a_number(time: f64, faces: &[Vec<ElementStrain>]) -> engine::Fault {
    let lost = |s: &ElementStrain| !s.strain.iter().all(|e| e.is_finite());
    let found = faces.iter().enumerate().find_map(|(face, s)| s.iter().position(lost).map(|element| (face, element)));
    match found {
        Some((face, element)) => engine::Fault::NotANumber { time, face: face + 1, element },
        None => engine::Fault::ImpactorLost { time },
    }
}

impl Observer for Probe<'_> {
    fn wants(&self, time: f64) -> bool {
        self.record.tracks.is_due(time) || self.snapshot_due(time) || self.audit_due(time)
    }

    fn see(&mut self, view: &View<'_>) -> Result<(), engine::Fault> {
        let mut faces = std::mem::take(&mut self.faces);
        view.strains(&mut faces);
        let seen = self.look(view, &faces);
        self.faces = faces;
        seen
    }

    fn follow(&mut self, track: &Track) {
        self.record.tracks.follow(track);
    }
}
