//! The recording that a run is compared with, brought to the run's own filter, and the displacement field.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{PrepareError, Warning};
use crate::Error;
use lab::Error as LabError;
use lab::dic::{Field, FieldOptions};
use lab::experiment;
use lab::experiment::absorption::{Body, first_impact};
use lab::experiment::drop::{ChannelNames, Class, Correction, DropChannels, Figures, Reduction, Tower};
use lab::signal::column::{self, Column};
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use lab::signal::filter::{self, Standard};
use lab::signal::norm::relative_error;
use lab::signal::resample;
use lab::signal::{Annotations, Measurement, Series, integrate, t01};
use scene::model::loading::Impact;
use scene::model::{FieldReference, Impactor, Model, Reference, Window};
use scene::scenario::{self, Phase};

/// A recording ready for comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceComparison {
    /// Through the run's channel filter, m/s².
    pub acceleration: Option<Series>,
    /// m; `NaN` where the recording has none.
    pub displacement: Option<Series>,
    /// Energy that the film took up from the impactor, J; none where the recording has none.
    pub absorbed_energy: Option<Series>,
    /// Kinetic and potential energy of the impactor and the energy that the film took up, J; none where the recording
    /// has none.
    pub total_energy: Option<Series>,
    /// Window of the errors, s.
    pub window: [f64; 2],
    /// Share of the energy that the film absorbed (paper, equation 11); of raw recordings in which the impactor
    /// rebounds.
    pub energy_absorption: Option<f64>,
    /// Figures of its reduction, of a raw recording; without its notes.
    pub drop: Option<Figures>,
    /// Covariance of the time of first contact (s) and the impact speed (m/s); zero where neither has an error.
    pub contact: [[f64; 2]; 2],
    /// Comments of the recording of signals, and the warnings of its reading.
    pub annotations: Annotations,
    /// The warnings of its reduction, of a raw recording.
    pub reduction_warnings: Vec<experiment::Warning>,
    /// Impact speed of the run, m/s.
    pub run_speed: f64,
    /// The displacement field, as measured.
    pub field: Option<Arc<Field>>,
}

/// Why a file of other columns is reduced.
const RAW: &str = "the file has no column `acceleration_m_s2`, `acceleration_filtered_m_s2` or `displacement_m` and is \
                   read as a raw recording, from the rest before the release on; of one that begins with contact, `droptower signal \
                   convert` writes such columns where its own are called `acceleration [g]` or `displacement [mm]`";

/// Why a window that ends at the lowest point does not end.
const NO_LOWEST_POINT: &str = "the recording has no lowest point: displacement has gaps, and acceleration does not bring the \
                               impactor to rest";

/// What is wrong with a recording.
fn refused(path: &Path, why: impl Display) -> Error {
    Error::new(format!("{}: {why}", path.display()))
}

impl ReferenceComparison {
    /// Reads the recording and the field of `model`, if it names any, and reduces a raw recording.
    pub fn read(model: &Model) -> Result<Option<ReferenceComparison>, PrepareError> {
        let Some(reference) = &model.reference else {
            return Ok(None);
        };
        let signals = reference.signals.as_deref().map(|path| Unwindowed::read(path, model, reference)).transpose()?;
        let field = reference.field.as_ref().map(read_field).transpose()?.flatten().map(Arc::new);
        let Unwindowed { comparison, raw } = signals.unwrap_or_default();
        let window = match (reference.written.window, &reference.signals) {
            (Window::Range(range), _) => range.map(|time| time.0),
            (Window::Phase(Phase::All), _) => [0.0, model.run_time()],
            (Window::Phase(Phase::Loading), None) => [0.0, last_of_field(model)],
            (Window::Phase(Phase::Loading), Some(path)) => {
                let motion = raw.as_ref().or(comparison.acceleration.as_ref());
                let lowest = time_of_lowest_point(motion, comparison.displacement.as_ref(), model);
                [0.0, lowest.ok_or_else(|| refused(path, NO_LOWEST_POINT))?]
            }
        };
        let run_speed = model.impactors.get(reference.impactor).map_or(f64::NAN, |impactor| -impactor.velocity[2]);
        Ok(Some(ReferenceComparison { window, run_speed, field, ..comparison }))
    }

    /// Doubts about the errors: a virtual recording, and all that was assumed or is implausible in its reduction.
    pub fn warnings(&self) -> impl Iterator<Item = Warning> {
        let marks = [Some(&self.annotations), self.field.as_deref().map(|field| &field.annotations)];
        let mark = |annotations: &Annotations| {
            annotations.virtual_mark().map(|note| Warning::VirtualReference { note: note.to_owned() })
        };
        let marks = marks.into_iter().flatten().filter_map(mark);
        let speed = self.drop.as_ref().and_then(|drop| self.other_speed(drop));
        marks.chain(speed).chain(self.reduction_warnings.iter().cloned().map(Warning::ReferenceReduction))
    }

    /// The finding of a run whose impact speed is not that of the recording.
    fn other_speed(&self, drop: &Figures) -> Option<Warning> {
        /// Share of the speed that is no matter.
        const SMALL: f64 = 0.01;
        let (run, [low, high]) = (self.run_speed, drop.impact_velocity_interval_m_s?);
        let off = (run - drop.impact_velocity_m_s).abs() / drop.impact_velocity_m_s;
        (off > SMALL && !(low..=high).contains(&run)).then_some(Warning::ReferenceSpeed { run, low, high })
    }

    /// Comments of the recording, and the warnings of its reading and of its reduction, as texts.
    pub fn notes(&self) -> Vec<String> {
        let reduction = self.reduction_warnings.iter().map(experiment::Warning::to_string);
        let field = self.field.iter().flat_map(|field| &field.annotations.warnings).map(ToString::to_string);
        self.annotations.notes().into_iter().chain(reduction).chain(field).collect()
    }

    /// Whether its files mark the recording or the field as virtual: computed, not measured.
    pub fn is_virtual(&self) -> bool {
        self.annotations.is_virtual() || self.field.as_ref().is_some_and(|field| field.annotations.is_virtual())
    }

    /// Name of its curves in plots.
    pub fn label(&self) -> &'static str {
        match self.annotations.virtual_mark() {
            Some(mark) if mark.starts_with(t01::COMPUTED) => "OpenRadioss",
            _ if self.is_virtual() => "measured (virtual)",
            _ => "measured",
        }
    }

    /// Error of a filtered acceleration (paper, equation 14).
    pub fn acceleration_error(&self, filtered: &Series) -> Option<Result<f64, LabError>> {
        let reference = self.acceleration.as_ref()?;
        Some(relative_error(filtered, reference, self.window))
    }

    /// Error of a displacement (paper, equation 15).
    pub fn displacement_error(&self, displacement: &Series) -> Option<Result<f64, LabError>> {
        let reference = self.displacement.as_ref()?;
        Some(relative_error(displacement, reference, self.window))
    }
}

/// The files of a field, with their times.
fn read_field(reference: &FieldReference) -> Result<Option<Field>, LabError> {
    let files: Vec<(PathBuf, f64)> = reference.files.iter().cloned().zip(reference.times.iter().copied()).collect();
    Field::read(&files, &FieldOptions { unit: reference.unit })
}

/// Time of the last file of the field that lies within the run, s.
fn last_of_field(model: &Model) -> f64 {
    let wanted = model.output.motion.as_ref().and_then(|motion| motion.times.last());
    wanted.copied().unwrap_or_else(|| model.run_time())
}

/// A recording from first contact on, before its window is known.
#[derive(Default)]
struct Unwindowed {
    /// With its signals, and without what the run says of it.
    comparison: ReferenceComparison,
    /// Its acceleration as recorded or corrected.
    raw: Option<Series>,
}

impl Unwindowed {
    /// Of the file at `path`, with what it says beside its numbers.
    fn read(path: &Path, model: &Model, reference: &Reference) -> Result<Unwindowed, PrepareError> {
        let options = ReadOptions { channels: channels(reference), ..ReadOptions::default() };
        let measurement = file::read(path, &options)?;
        let mut found = match Unwindowed::from_contact(&measurement, path, model, reference)? {
            Some(found) => found,
            None => Unwindowed::from_raw(&measurement, path, model, reference)?,
        };
        found.comparison.annotations = measurement.annotations;
        Ok(found)
    }

    /// Of a file that counts from first contact; none where it is a raw recording.
    fn from_contact(
        measurement: &Measurement,
        path: &Path,
        model: &Model,
        reference: &Reference,
    ) -> Result<Option<Unwindowed>, PrepareError> {
        // Of several impactors a time history of OpenRadioss has the signals of each under its name.
        let name = model.impactors.get(reference.impactor).and_then(|impactor| impactor.name.as_deref());
        let own = |column: &str| name.and_then(|name| measurement.channel(&format!("{name}/{column}")).ok());
        let channel = |column: &str| {
            let found = own(column).or_else(|| measurement.channel(column).ok());
            found.map(|channel| channel.series.clone())
        };
        let acceleration = |column: &str| channel(column).map(|reading| names(reference).upright(&reading));
        let (raw, displacement) = (acceleration(column::ACCELERATION.name), channel(column::DISPLACEMENT.name));
        let written = &reference.written;
        let named = written.acceleration.is_some() || written.displacement.is_some();
        let filtered = match acceleration(column::ACCELERATION_FILTERED.name) {
            _ if named => return Ok(None),
            Some(filtered) => Some(filtered),
            None => raw.as_ref().map(|raw| filtered(raw, model, path)).transpose()?,
        };
        let any = filtered.is_some() || displacement.is_some();
        let contact_error = written.contact_error.map(|error| error.0);
        let speed_error = written.speed_error.map(|error| error.0);
        let comparison = ReferenceComparison {
            acceleration: filtered,
            displacement,
            absorbed_energy: channel(column::ABSORBED_ENERGY.name),
            total_energy: channel(column::TOTAL_ENERGY.name),
            contact: [[variance(contact_error), 0.0], [0.0, variance(speed_error)]],
            ..ReferenceComparison::default()
        };
        Ok(any.then_some(Unwindowed { comparison, raw }))
    }

    /// Of a raw recording, reduced with the mass and gravity of the run.
    fn from_raw(
        measurement: &Measurement,
        path: &Path,
        model: &Model,
        reference: &Reference,
    ) -> Result<Unwindowed, PrepareError> {
        let (Some(Impact { gravity, .. }), Some(impactor)) =
            (model.loading.impact(), model.impactors.get(reference.impactor))
        else {
            let what = "is the raw recording of a drop: only an impact with an impactor can be compared with it";
            return Err(Error::new(format!("{} {what}", path.display())).into());
        };
        let Impactor { mass, velocity: [_, _, velocity], .. } = impactor;
        let raw = |why: &dyn Display| refused(path, format!("{why}; {RAW}"));
        let sensed = DropChannels::find(measurement, &names(reference)).map_err(|source| raw(&source))?;
        let written = &reference.written;
        let [drop_height, height_error] = [written.drop_height, written.height_error].map(|own| own.map(|own| own.0));
        let [speed, speed_error] = [written.speed, written.speed_error].map(|own| own.map(|own| own.0));
        let [contact_time, contact_error, time_constant] =
            [written.contact_time, written.contact_error, written.time_constant].map(|own| own.map(|own| own.0));
        let tower = Tower { body: Body { mass: *mass, gravity: *gravity }, height: drop_height };
        // Where nothing is written, the impactor reached the velocity of the run.
        let is_known = drop_height.is_some() || speed.is_some() || contact_time.is_some();
        let needed = [
            ("contact_error", contact_error, "contact_time", contact_time),
            ("speed_error", speed_error, "speed", speed),
        ];
        let is_alone = |(_, error, _, given): &(_, Option<f64>, _, Option<f64>)| error.is_some() && given.is_none();
        if let Some((error, _, given, _)) = needed.into_iter().find(is_alone) {
            let why = format!("`{error}` is the error of `{given}`, which is not given: write both, or neither");
            return Err(raw(&why).into());
        }
        // The class of the run, unless the recorder has filtered already: two filters in a row would lower the peak twice.
        let reduction = Reduction {
            correction: Correction::Coupling { time_constant },
            class: sensed.class_to_apply(model.output.filter.map_or(Class::None, Class::Given)),
            speed: speed.or((!is_known).then_some(-velocity)),
            contact_time,
            height_error,
            speed_error,
            contact_error,
            guide_friction: written.guide_friction.map(|friction| friction.map(|force| force.0)),
        };
        let drop = sensed.reduce(&tower, &reduction).map_err(|source| raw(&source))?;
        let channel = |column: Column| drop.signals.series(column.name);
        let comparison = ReferenceComparison {
            acceleration: channel(column::ACCELERATION_FILTERED),
            displacement: channel(column::DISPLACEMENT),
            absorbed_energy: channel(column::ABSORBED_ENERGY),
            total_energy: channel(column::TOTAL_ENERGY),
            energy_absorption: drop.energy_absorption,
            drop: Some(Figures { notes: Vec::new(), ..drop.figures() }),
            contact: drop.intervals.as_ref().map_or([[0.0; 2]; 2], |intervals| intervals.contact),
            ..ReferenceComparison::default()
        };
        let raw = channel(column::ACCELERATION);
        Ok(Unwindowed { comparison: ReferenceComparison { reduction_warnings: drop.warnings, ..comparison }, raw })
    }
}

/// The sensors of the reference.
fn names(reference: &Reference) -> ChannelNames {
    let scenario::Reference { acceleration, displacement, invert, .. } = reference.written.clone();
    ChannelNames { acceleration, laser: displacement, is_inverted: invert }
}

/// The square of a deviation; zero where none is given.
fn variance(deviation: Option<f64>) -> f64 {
    deviation.map_or(0.0, |own| own * own)
}

/// Where both channels are named, only they are read, so that a fault of another one does not matter.
fn channels(reference: &Reference) -> ChannelSelection {
    match (&reference.written.acceleration, &reference.written.displacement) {
        (Some(acceleration), Some(displacement)) => {
            ChannelSelection::Named(vec![acceleration.clone(), displacement.clone()])
        }
        _ => ChannelSelection::All,
    }
}

/// The recording through the filter of the run, on equal steps.
fn filtered(raw: &Series, model: &Model, path: &Path) -> Result<Series, Error> {
    let wrong = |source: LabError| refused(path, format!("acceleration: {source}"));
    let Some(class) = model.output.filter else {
        return Ok(raw.clone());
    };
    let even = match resample::common_step(raw.time()) {
        Some(_) => raw.clone(),
        None => resample::uniform(raw, 1.0 / model.output.sample_rate).map_err(wrong)?,
    };
    filter::channel(&even, class, Standard::Iso6487).map_err(wrong)
}

/// Time of the lowest point of the recording: of the largest travel of the first impact where it was measured
/// throughout, else of the first sample at which the integral of the acceleration has cancelled the impact velocity.
fn time_of_lowest_point(acceleration: Option<&Series>, displacement: Option<&Series>, model: &Model) -> Option<f64> {
    if let Some(complete) = displacement.filter(|d| d.is_complete()) {
        let of_first = complete.samples().take(first_impact(complete.values()));
        return of_first.min_by(|a, b| a[1].total_cmp(&b[1])).map(|[time, _]| time);
    }
    let recorded = model.reference.as_ref().map_or(0, |reference| reference.impactor);
    let [_, _, velocity] = model.impactors.get(recorded)?.velocity;
    let fall = acceleration?.window([0.0, f64::INFINITY]);
    let speed = integrate::once(&fall, velocity);
    speed.samples().find(|[_, v]| *v >= 0.0).map(|[time, _]| time)
}
