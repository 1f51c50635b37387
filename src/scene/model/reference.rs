//! The recording and the displacement field that a run is compared with; the signals and snapshots that it records.

use std::fs;
use std::path::{Path, PathBuf};

use super::exclusions::Scene;
use super::impactor::{self, Written};
use super::loading::{Impact, Test};
use super::{Align, Checker, Face, FieldReference, Loading, Motion, Output, Reference, Specimen, Window};
use crate::scenario::{self, FieldFiles, FieldTimes, Filter, Guide, Marker, Scenario};
use base::diagnostic::{closest, shown_path, tidy_path};
use base::number::duration;
use base::units::Time;
use lab::dic::{RigidMotion, in_order, read_times};

const WINDOW: &str = "reference.window";

/// The recording, the field and the window of the errors.
pub(super) fn check(
    scene: &Scene<'_>,
    specimen: Option<&Specimen>,
    faces: Option<&[Face]>,
    checker: &mut Checker<'_>,
) -> Option<Reference> {
    let Scene { scenario, loading, .. } = *scene;
    let written = scenario.reference.as_ref()?;
    if written.signals.is_none() && written.field.is_none() {
        return checker.refuse(
            "reference",
            "there is nothing to compare with",
            "name `reference.signals`, `reference.field`, or both",
        );
    }
    let run_time = specimen.map(|specimen| loading.run_time(&specimen.shape));
    let field = written.field.as_ref().map(|field| check_field(field, faces, run_time, checker));
    let impactors = impactor::impactors(scenario, checker);
    let place = recorded(written.impactor.as_deref(), &impactors, checker);
    let recorded = impactors.get(place);
    let why = match recorded.map(|impactor| &impactor.guide) {
        Some(Guide::Fixed | Guide::Line(_) | Guide::Hinge(_)) => {
            Some("only a falling impactor is compared with a drop".to_owned())
        }
        _ => recorded.filter(|impactor| impactor.position.len() > 2).map(|impactor| {
            let position = impactor.key("position");
            format!("a recording counts from first contact: leave out the height of `{position}`")
        }),
    };
    if let Some(why) = why.filter(|_| written.signals.is_some()) {
        checker.out_of_place("reference", why);
    }
    if let Window::Range(range) = written.window {
        check_window(range, loading, checker);
    }
    let signals = match written.signals {
        Some(_) => Some(checker.file("reference.signals")?),
        None => None,
    };
    let field = match field {
        Some(field) => Some(field?),
        None => None,
    };
    let written = scenario::Reference { impactor: None, signals: None, field: None, ..written.clone() };
    Some(Reference { written, impactor: place, signals, field })
}

/// Index of the impactor called `name`, the first where none is named.
fn recorded(name: Option<&str>, impactors: &[Written<'_>], checker: &mut Checker<'_>) -> usize {
    const KEY: &str = "reference.impactor";
    let Some(name) = name else { return 0 };
    let names = || impactors.iter().filter_map(|impactor| impactor.name.as_deref());
    let place = impactors.iter().position(|impactor| impactor.name.as_deref() == Some(name));
    if place.is_none() {
        let meant = closest(name, names()).map(|meant| format!("did you mean \"{meant}\"?"));
        checker.report_with_hint_if(KEY, format!("there is no impactor \"{name}\""), meant);
    }
    place.unwrap_or(0)
}

/// The window lies within the run.
fn check_window([from, to]: [Time; 2], loading: &Loading, checker: &mut Checker<'_>) {
    if from.0 < 0.0 {
        checker.report(&format!("{WINDOW}.0"), "the window starts before first contact");
    }
    if to.0 <= from.0 {
        checker.report(&format!("{WINDOW}.1"), "the window ends before it starts");
    }
    if let Some(Impact { duration, .. }) = loading.impact()
        && to.0 > *duration
    {
        let message = format!("the window ends after the run, which takes {}", Time(*duration));
        checker.report(&format!("{WINDOW}.1"), message);
        checker.label("loading.impact.duration", "the run ends here");
    }
}

const FILES: &str = "reference.field.files";
const TIMES: &str = "reference.field.times";

/// The field, of a run that takes so long, s; none without one.
fn check_field(
    written: &scenario::FieldReference,
    faces: Option<&[Face]>,
    run_time: Option<f64>,
    checker: &mut Checker<'_>,
) -> Option<FieldReference> {
    let count = faces.map_or(usize::MAX, <[Face]>::len);
    let face = usize::try_from(written.face).unwrap_or(usize::MAX);
    if face > count {
        let faces = if count == 1 { "one face".to_owned() } else { format!("{count} faces") };
        checker.report("reference.field.face", format!("there is no face {face}: the film has {faces}"));
    }
    let is_aligned = check_align(&written.align, checker);
    let files = files(&written.files, checker)?;
    let times = times(&written.times, files.len(), checker)?;
    if let Some(run_time) = run_time
        && times.iter().all(|time| *time > run_time || *time < 0.0)
    {
        let message = format!("no file was recorded during the run, which takes {}", duration(run_time));
        checker.report_with(
            TIMES,
            message,
            "times are those of the run: zero is its start, first contact of an impact",
        );
    }
    let (unit, align) = (written.unit.map(scenario::MeshUnit::metres), written.align.clone());
    is_aligned.then_some(FieldReference { files, times, unit, face: face.saturating_sub(1), align })
}

/// The motion of its face that a run of so long (s) records for the comparison with a field.
pub fn motion(field: &FieldReference, run_time: f64) -> Motion {
    let times = field.times.iter().copied().filter(|time| (0.0..=run_time).contains(time)).collect();
    Motion { face: field.face, times }
}

/// Whether the field can be aligned so.
fn check_align(written: &Align, checker: &mut Checker<'_>) -> bool {
    let Align::Markers(markers) = written else { return true };
    let pairs: Vec<_> = markers.iter().map(Marker::pair).collect();
    let is_determined = RigidMotion::of_pairs(&pairs).is_some();
    if !is_determined {
        let message = "the markers lie on a line, so a rotation about it is open";
        checker.report_with("reference.field.align", message, "take three markers that form a triangle");
    }
    is_determined
}

/// The existing files in their order.
fn files(written: &FieldFiles, checker: &mut Checker<'_>) -> Option<Vec<PathBuf>> {
    match written {
        FieldFiles::Pattern(_) => {
            let path = checker.document.file(FILES)?;
            match matching(&path) {
                Ok(files) => Some(in_order(files)),
                Err(message) => {
                    checker.report(FILES, message);
                    None
                }
            }
        }
        // A list has its own order.
        FieldFiles::List(list) => (0..list.len()).map(|place| checker.file(&format!("{FILES}.{place}"))).collect(),
    }
}

/// The files in a folder but for hidden ones, those that match a pattern, or the one of that name.
fn matching(path: &Path) -> Result<Vec<PathBuf>, String> {
    let shown = shown_path(path);
    let is_seen = |path: &PathBuf| {
        path.is_file() && !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
    };
    if path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let (files, none): (Vec<PathBuf>, String) = if path.is_dir() {
        let entries = fs::read_dir(path).map_err(|error| format!("cannot read {shown}: {error}"))?;
        (entries.filter_map(Result::ok).map(|entry| entry.path()).collect(), format!("{shown} has no files"))
    } else {
        let pattern = tidy_path(path).display().to_string();
        let found = glob::glob(&pattern).map_err(|error| format!("`{shown}` is no pattern of names: {error}"))?;
        (found.filter_map(Result::ok).collect(), format!("no file matches {shown}"))
    };
    let files: Vec<PathBuf> = files.into_iter().filter(is_seen).collect();
    if files.is_empty() { Err(none) } else { Ok(files) }
}

/// A time for every file, s.
fn times(written: &FieldTimes, files: usize, checker: &mut Checker<'_>) -> Option<Vec<f64>> {
    let times = match written {
        FieldTimes::Rate(rate) => {
            return Some((0..files).map(|number| rate.start.0 + number as f64 / rate.rate.0).collect());
        }
        FieldTimes::List(times) => times.iter().map(|time| time.0).collect(),
        FieldTimes::Table(_) => {
            let path = checker.file(TIMES)?;
            match read_times(&path) {
                Ok(times) => times,
                Err(error) => {
                    checker.report_with_hint_if(TIMES, error.to_string(), error.hint().map(str::to_owned));
                    return None;
                }
            }
        }
    };
    if times.len() != files {
        let word = if files == 1 { "file" } else { "files" };
        checker.report(TIMES, format!("{} times for {files} {word}", times.len()));
        return None;
    }
    if let Some(place) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        checker.report(&format!("{TIMES}.{}", place + 1), "the times do not increase");
        return None;
    }
    Some(times)
}

/// Least samples per second and hertz of the class. ISO 6487 requires 8, SAE J211-1 requires 10; what is refused
/// satisfies neither.
const SAMPLES_PER_CLASS_HERTZ: f64 = 8.0;

/// Most samples of one channel: 80 MB.
const MOST_SAMPLES: f64 = 1e7;

/// Fewest samples of one channel.
const FEWEST_SAMPLES: f64 = 10.0;

const PATH: &str = "output.sample_rate";

/// Sampling, snapshots, and the class as a number.
pub(super) fn check_output(scene: &Scene<'_>, specimen: Option<&Specimen>, checker: &mut Checker<'_>) -> Output {
    let (written, loading) = (&scene.scenario.output, scene.loading);
    let is_filtered = loading.test() == Test::Impact;
    let filter = is_filtered.then(|| written.filter.unwrap_or(Filter::Cfc1000)).and_then(class);
    let sample_rate = written.sample_rate.0;
    if let Some(class) = filter
        && sample_rate < SAMPLES_PER_CLASS_HERTZ * class
    {
        let least = SAMPLES_PER_CLASS_HERTZ * class / 1e3;
        let message = format!("too few samples for the class CFC{class}");
        let hint = format!("at least {least} kHz (ISO 6487), better {} kHz (SAE J211-1)", class / 100.0);
        checker.report_with(PATH, message, hint);
    }
    if let Some(specimen) = specimen {
        samples(loading, loading.run_time(&specimen.shape), sample_rate, checker);
    }
    Output { sample_rate, frames: usize::try_from(written.frames).unwrap_or(usize::MAX), filter, motion: None }
}

/// Refuses too few and too many samples.
fn samples(loading: &Loading, time: f64, sample_rate: f64, checker: &mut Checker<'_>) {
    let samples = time * sample_rate;
    let path = if checker.is_written(PATH) { PATH.to_owned() } else { loading.key(loading.pace()) };
    let hint = format!("the run takes {}", Time(time));
    if samples > MOST_SAMPLES {
        let message = format!("{samples:.1e} samples exceed the limit of {MOST_SAMPLES:e}");
        checker.report_with(&path, message, hint);
    } else if (0.0..FEWEST_SAMPLES).contains(&samples) {
        let message = format!("the run ends before {FEWEST_SAMPLES} samples are taken");
        checker.report_with(&path, message, hint);
    }
}

fn class(filter: Filter) -> Option<f64> {
    match filter {
        Filter::Cfc1000 => Some(1000.0),
        Filter::Cfc600 => Some(600.0),
        Filter::Cfc180 => Some(180.0),
        Filter::Cfc60 => Some(60.0),
        Filter::None => None,
    }
}

/// The script that adds to the summary.
pub fn check_post(scenario: &Scenario, checker: &mut Checker<'_>) -> Option<PathBuf> {
    scenario.post.as_ref()?;
    checker.file("post.script")
}
