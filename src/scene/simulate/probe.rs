//! The observer of a run: signals, audits, snapshots, warnings and progress.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::energy_check::{EnergyCheck, RateAudit};
use super::fault::Fault;
use super::frame::{Crest, HeldSides};
use super::loading::{self, LoadCase};
use super::monitor::{End, Monitor};
use super::mount::Mounting;
use super::outcome::{self, MotionRecord, Outcome, Snapshot};
use super::tracks::{self, BodyTracks, Rise, Sample, Sampling, Tracks};
use super::warning::bounds::KINETIC;
use crate::model::loading::Inertia;
use crate::model::{Impactor, Model};
use lab::signal::{Recording, column};
use membrane::engine::{self, ElementStrain, Engine, Observer, Relaxation, StateMismatch, Torn, Track, View};

/// Audits of energies, contact and strains in a run, unless there are fewer samples.
const AUDITS: f64 = 400.0;

/// Change of the deflection of an inflated film in the last tenth of its run, over the deflection, above which it is
/// not at rest.
const UNSETTLED: f64 = 2e-3;

/// Part of a slow test after which a lost energy balance stops it; at its end the balance is checked as a whole.
const CHECKED_FROM: f64 = 0.1;

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
    crest: Crest,
    /// Strains of all elements, as last computed.
    faces: Vec<Vec<ElementStrain>>,
    record: Record,
}

/// Record of a probe so far: its part of a checkpoint.
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
    /// Largest growth of the temperature before film first broke, K, where it warms up.
    warming: Option<f64>,
    penetration: Option<f64>,
    lowest: Vec<f64>,
    relaxation: Option<Relaxation>,
    motion: MotionRecord,
}

impl<'a> Probe<'a> {
    pub(super) fn new(model: &'a Model, mounting: &Mounting, detailed: bool) -> Probe<'a> {
        let sample = 1.0 / model.output.sample_rate;
        let duration = model.run_time();
        let loading = loading::load_case(model);
        let checked_from = if model.loading.inertia() == Inertia::Dynamic { 0.0 } else { CHECKED_FROM * duration };
        let measured = model.faces.iter().map(|f| f.material.measured_rates).collect();
        let snapshots = outcome::count(model.output.frames, &mounting.films, detailed);
        let record = Record {
            audits: 0,
            tracks: tracks(model, mounting, Sampling::new(duration, sample)),
            rise: Rise::default(),
            snapshots: vec![],
            energy: EnergyCheck::new(mounting.energy_scale, checked_from),
            rates: RateAudit::new(measured),
            monitor: Monitor::new(model),
            rupture_time: None,
            warming: None,
            penetration: None,
            lowest: vec![f64::INFINITY; model.impactors.len()],
            relaxation: None,
            motion: MotionRecord::default(),
        };
        Probe {
            model,
            loading,
            duration,
            snapshots,
            snapshot_interval: duration / snapshots.saturating_sub(1).max(1) as f64,
            detailed,
            held: mounting.held.clone(),
            crest: mounting.crest.clone(),
            audit: (duration / AUDITS).max(sample),
            faces: vec![],
            record,
        }
    }

    /// Record so far.
    pub(super) fn record(&self) -> &Record {
        &self.record
    }

    /// Resumes from the record of a checkpoint.
    ///
    /// # Errors
    /// It is of another scene.
    pub(super) fn resume(&mut self, record: Record) -> Result<(), StateMismatch> {
        let counts = |record: &Record| [record.tracks.sampling.count, record.tracks.bodies.len(), record.lowest.len()];
        let (found, expected) = (counts(&record), counts(&self.record));
        let mut pairs = ["samples", "tracks", "impactors"].into_iter().zip(found.into_iter().zip(expected));
        if let Some((what, (found, expected))) = pairs.find(|(_, (found, expected))| found != expected) {
            return Err(StateMismatch { what, found, expected });
        }
        if !record.tracks.is_like(&self.record.tracks) {
            return Err(StateMismatch { what: "tracks like those of the scene", found: 0, expected: found[1] });
        }
        let faces = self.model.faces.len();
        if !record.rates.is_like(&self.record.rates) {
            return Err(StateMismatch { what: "curves like those of the scene", found: 0, expected: faces });
        }
        if !record.monitor.is_like(&self.record.monitor, faces) {
            return Err(StateMismatch { what: "findings of bodies and faces like its", found: 0, expected: faces });
        }
        self.record = record;
        Ok(())
    }

    /// Records how the film came to equilibrium before the first step.
    pub(super) fn record_relaxation(&mut self, relaxation: Option<Relaxation>) {
        self.record.relaxation = relaxation;
    }

    /// Height by which impactors in contact with the film were lifted over settled film, m.
    pub(super) fn lift(&self) -> f64 {
        self.record.relaxation.map_or(0.0, |relaxation| relaxation.lift)
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

    /// Whether everything has been recorded by `time` (s).
    pub(super) fn is_done(&self, time: f64) -> bool {
        let goes_on = self.model.can_tear() && !self.model.loading.is_by_gas();
        let failed = self.record.rupture_time.is_some() && self.is_quasi_static() && !goes_on;
        failed || (time > self.duration && self.record.tracks.are_complete())
    }

    /// Whether inertia must not matter; then the failure of film that cannot tear, or that holds gas, ends the test.
    fn is_quasi_static(&self) -> bool {
        self.model.loading.inertia() == Inertia::Negligible
    }

    /// The fault of a run as a whole: a lost energy balance, or inertia in a test that must be quasi-static.
    pub(super) fn fault(&self) -> Option<Fault> {
        self.record.energy.fault().or_else(|| self.not_in_equilibrium())
    }

    fn not_in_equilibrium(&self) -> Option<Fault> {
        let (time, share) = self.record.energy.kinetic_share(self.model.can_tear());
        if !self.is_quasi_static() {
            return None;
        }
        if share > KINETIC {
            return Some(Fault::NotQuasiStatic { time, share });
        }
        let unsettled = self.settling().filter(|change| *change > UNSETTLED);
        unsettled.map(|change| Fault::NotAtRest { time: self.duration, change })
    }

    /// Change of an inflated film's deflection at the end (see [`tracks::settling`]); none after a rupture.
    fn settling(&self) -> Option<f64> {
        self.record.rupture_time.is_none().then(|| tracks::settling(&self.record.tracks))?
    }

    /// Records that elements failed in the step from `time` (s).
    pub(super) fn record_rupture(&mut self, time: f64) {
        self.record.rupture_time.get_or_insert(time);
    }

    fn snapshot_due(&self, time: f64) -> bool {
        self.record.snapshots.len() < self.snapshots
            && self.record.snapshots.len() as f64 * self.snapshot_interval <= time
    }

    fn motion_due(&self, time: f64) -> bool {
        self.model.output.motion.as_ref().is_some_and(|wanted| self.record.motion.is_due(wanted, time))
    }

    fn audit_due(&self, time: f64) -> bool {
        self.record.audits as f64 * self.audit <= time
    }

    fn record_due(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) -> Result<(), engine::Fault> {
        if self.snapshot_due(view.time) {
            self.record.snapshots.push(outcome::snapshot(view, faces, self.detailed));
        }
        if let Some(wanted) = self.model.output.motion.as_ref().filter(|_| self.motion_due(view.time)) {
            self.record.motion.record(wanted, view);
        }
        if self.record.tracks.is_due(view.time) {
            self.take_sample(view, faces);
        }
        if self.audit_due(view.time) { self.take_audit(view, faces) } else { Ok(()) }
    }

    fn take_sample(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) {
        let intact = |fibre: usize| faces.iter().flatten().filter(move |s| s.left[fibre] > 0.0);
        let largest = |fibre: usize| intact(fibre).map(|s| s.strain[fibre]).fold(f64::NAN, f64::max);
        self.record.tracks.strains.push(view.time, [largest(0), largest(1)]);
        let sample = Sample {
            view,
            held: &self.held,
            crest: &self.crest,
            rise: self.model.loading.is_by_gas().then(|| self.record.rise.largest(view)),
            clamp: view.clamp_slip(),
            springs: view.springs().map(|springs| springs.state(view.nodes)),
            films: view.film_contact_state(),
            torn: view.torn(),
        };
        tracks::take(&sample, &mut self.record.tracks);
        self.record.monitor.sample(&sample);
        self.record.rates.sample(view.time, faces);
        let mut sinks = view.bodies().len() == 0;
        for (lowest, body) in self.record.lowest.iter_mut().zip(view.bodies()) {
            let z = body.centre().z;
            if z <= *lowest {
                *lowest = z;
                sinks = true;
            }
        }
        if sinks {
            self.record.rates.commit();
        }
    }

    /// Notes how much film has warmed up that does not tear. Where it breaks, an element is drawn out as far as the mesh lets it.
    fn note_warming(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) {
        let films = view.films.iter().zip(faces);
        let warm = films.filter(|(film, _)| film.warms_up() && self.record.rupture_time.is_none());
        let elements = warm.flat_map(|(film, strains)| film.details(&view.nodes.position).into_iter().zip(strains));
        let whole = elements.filter(|(_, strain)| strain.damage == 0.0).map(|(element, _)| element.warming);
        self.record.warming = whole.chain(self.record.warming).reduce(f64::max);
    }

    fn take_audit(&mut self, view: &View<'_>, faces: &[Vec<ElementStrain>]) -> Result<(), engine::Fault> {
        self.record.audits += 1;
        self.note_warming(view, faces);
        let energies = view.energies();
        if !energies.total().is_finite() {
            return Err(not_finite(view, faces));
        }
        self.record.monitor.strain(view, faces);
        self.record.monitor.biaxial(view.time, faces, self.model);
        self.record.monitor.beyond_data(view, faces, self.model);
        for (body, (state, size)) in view.contact_states().enumerate() {
            self.record.monitor.contact(body, view.time, size, &state, self.record.rupture_time.is_none());
            if body < self.model.impactors.len() {
                self.record.penetration = Some(self.record.penetration.unwrap_or(0.0).max(state.penetration / size));
            }
        }
        self.record.energy.sample(view.time, energies).map_err(|_| engine::Fault::Stopped)
    }

    /// The outcome after the last step of `engine`.
    pub(super) fn finish(self, engine: &Engine, mounting: Mounting, wall: Duration) -> Outcome {
        let slow = self.model.loading.inertia() != Inertia::Dynamic;
        let kinetic_share = slow.then(|| self.record.energy.kinetic_share(self.model.can_tear()).1);
        let damping_share = slow.then(|| self.record.energy.damping_share());
        let balance = self.record.energy.balance_error();
        let settling = self.settling();
        let signals = self.signals(&mounting);
        let energies = self.energies();
        // A body that a run ended too early for has not missed the film.
        let ended = self.is_done(engine.time());
        let missed = |other: bool| {
            self.record.tracks.bodies.iter().map(|body| ended && body.touched() == [false, other]).collect()
        };
        let (missed, met_others_alone) = (missed(false), missed(true));
        let rates = self.record.rates.finish();
        let force = |prefix: String| signals.channel(&format!("{prefix}{}", column::CONTACT_FORCE.name));
        // What stands still, or moves as it is told to, ends its test by the clock.
        let bodies = self.model.impactors.iter().zip(self.model.prefixes());
        let ends_loaded = |(impactor, prefix): (&Impactor, String)| {
            impactor.mass.is_finite() && force(prefix).is_some_and(loading::ends_loaded)
        };
        let unfinished = bodies.map(ends_loaded).collect();
        let relaxation = self.record.relaxation;
        // Torn length, area and energy only grow: their last sample is that of the run.
        let last = |column| self.record.tracks.sampled(&column).last().copied();
        let motion = self.model.output.motion.as_ref();
        let motion = motion.and_then(|wanted| self.record.motion.finish(wanted, &mounting.films));
        let torn = last(column::TORN_LENGTH).zip(last(column::TORN_AREA)).zip(last(column::FRACTURE_ENERGY));
        let (spring_step, snapshots, time) = (mounting.spring_step, self.snapshots, engine.time());
        let end = End { missed, met_others_alone, unfinished, spring_step, snapshots, time };
        let outcome = Outcome {
            signals,
            energies,
            snapshots: self.record.snapshots,
            warnings: vec![],
            films: mounting.films,
            motion,
            impactors: engine.impactors().cloned().collect(),
            rates,
            rupture_time: self.record.rupture_time,
            energy_balance_error: balance,
            kinetic_share,
            damping_share,
            settling,
            relaxation,
            mass_scaling: mounting.mass_scaling,
            added_mass: mounting.added_mass,
            penetration: self.record.penetration,
            torn: torn.map(|((length, area), energy)| Torn { length, area, energy }),
            warming: self.record.warming,
            elements: engine.elements(),
            threads: engine.pool().threads(),
            instructions: engine.pool().width(),
            steps: engine.steps(),
            time_step: engine.time() / engine.steps().max(1) as f64,
            wall,
        };
        Outcome { warnings: self.record.monitor.finish(&outcome, &end, self.model), ..outcome }
    }

    /// The signals of `signals.csv` so far.
    pub(super) fn signals(&self, mounting: &Mounting) -> Recording {
        let tracks = &self.record.tracks;
        let mut signals = self.loading.signals(tracks, mounting);
        tracks::add(tracks, &mut signals);
        signals
    }
}

/// The tracks of a run of `model`.
fn tracks(model: &Model, mounting: &Mounting, sampling: Sampling) -> Tracks {
    let bodies = model.impactors.iter().zip(&mounting.bodies);
    let bodies = bodies.map(|(impactor, body)| BodyTracks::new(sampling, body.approach, impactor.is_spatial()));
    let bars = model.frame.bars.map(|_| BodyTracks::new(sampling, [0.0; 2], false));
    Tracks::new(sampling, bodies.collect(), bars)
}

fn not_finite(view: &View<'_>, faces: &[Vec<ElementStrain>]) -> engine::Fault {
    let time = view.time;
    let is_lost = |s: &ElementStrain| !s.strain.iter().all(|e| e.is_finite());
    let found =
        faces.iter().enumerate().find_map(|(face, s)| s.iter().position(is_lost).map(|element| (face, element)));
    match found {
        Some((face, _)) if view.films[face].has_limit() => engine::Fault::StretchLimit { time, face: face + 1 },
        Some((face, element)) => engine::Fault::NotFinite { time, face: face + 1, element: element + 1 },
        None => engine::Fault::ImpactorLost { time },
    }
}

impl Observer for Probe<'_> {
    fn needs_state(&self, time: f64) -> bool {
        self.record.tracks.is_due(time) || self.snapshot_due(time) || self.audit_due(time) || self.motion_due(time)
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), engine::Fault> {
        let mut faces = std::mem::take(&mut self.faces);
        view.strains(&mut faces);
        let result = self.record_due(view, &faces);
        self.faces = faces;
        result
    }

    fn track(&mut self, track: &Track<'_>) {
        for (impactor, body) in track.bodies.iter().enumerate() {
            if body.meets_frame {
                self.record.monitor.frame_hit(impactor, track.time);
            }
            let speed = body.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            self.record.monitor.travel(impactor, track.time, speed * track.dt);
        }
        self.record.tracks.follow(track);
    }
}
