//! The displacement field that a run is compared with: its files and times.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Align, Face, FieldReference, ModelDiagnostics, Motion};
use crate::scenario::{self, FieldFiles, FieldTimes, Marker};
use base::diagnostic::{shown_path, tidy_path};
use base::number::duration;
use lab::dic::{RigidMotion, in_order, read_times};

const FILES: &str = "reference.field.files";
const TIMES: &str = "reference.field.times";

/// The field, of a run that takes so long, s; none without one.
pub fn check(
    written: &scenario::FieldReference,
    faces: Option<&[Face]>,
    run_time: Option<f64>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<FieldReference> {
    let count = faces.map_or(usize::MAX, <[Face]>::len);
    let face = usize::try_from(written.face).unwrap_or(usize::MAX);
    if face > count {
        let faces = if count == 1 { "one face".to_owned() } else { format!("{count} faces") };
        mistakes.report("reference.field.face", format!("there is no face {face}: the film has {faces}"));
    }
    let align = align(&written.align, mistakes);
    let files = files(&written.files, mistakes)?;
    let times = times(&written.times, files.len(), mistakes)?;
    if let Some(run_time) = run_time
        && times.iter().all(|time| *time > run_time || *time < 0.0)
    {
        let message = format!("no file was recorded during the run, which takes {}", duration(run_time));
        mistakes.report_with(
            TIMES,
            message,
            "times are those of the run: zero is its start, first contact of an impact",
        );
    }
    let unit = written.unit.map(scenario::MeshUnit::metres);
    Some(FieldReference { files, times, unit, face: face.saturating_sub(1), align: align? })
}

/// The motion of its face that a run of so long (s) records for the comparison with a field.
pub fn motion(field: &FieldReference, run_time: f64) -> Motion {
    let times = field.times.iter().copied().filter(|time| (0.0..=run_time).contains(time)).collect();
    Motion { face: field.face, times }
}

fn align(written: &scenario::Align, mistakes: &mut ModelDiagnostics<'_>) -> Option<Align> {
    let markers = match written {
        scenario::Align::Rigid => return Some(Align::Rigid),
        scenario::Align::None => return Some(Align::None),
        scenario::Align::Markers(markers) => markers,
    };
    let pair = |marker: &Marker| [marker.field, marker.film].map(|place| place.map(|length| length.0));
    let pairs: Vec<_> = markers.iter().map(pair).collect();
    if RigidMotion::of_pairs(&pairs).is_none() {
        let hint = "take three markers that form a triangle";
        mistakes.report_with(
            "reference.field.align",
            "the markers lie on a line, so a rotation about it is open",
            hint,
        );
        return None;
    }
    Some(Align::Markers(pairs))
}

/// The existing files in their order.
fn files(written: &FieldFiles, mistakes: &mut ModelDiagnostics<'_>) -> Option<Vec<PathBuf>> {
    match written {
        FieldFiles::Pattern(_) => {
            let path = mistakes.document.file(FILES)?;
            match matching(&path) {
                Ok(files) => Some(in_order(files)),
                Err(message) => {
                    mistakes.report(FILES, message);
                    None
                }
            }
        }
        // A list has its own order.
        FieldFiles::List(list) => (0..list.len()).map(|place| mistakes.file(&format!("{FILES}.{place}"))).collect(),
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
fn times(written: &FieldTimes, files: usize, mistakes: &mut ModelDiagnostics<'_>) -> Option<Vec<f64>> {
    let times = match written {
        FieldTimes::Rate(rate) => {
            return Some((0..files).map(|number| rate.start.0 + number as f64 / rate.rate.0).collect());
        }
        FieldTimes::List(times) => times.iter().map(|time| time.0).collect(),
        FieldTimes::Table(_) => {
            let path = mistakes.file(TIMES)?;
            match read_times(&path) {
                Ok(times) => times,
                Err(error) => {
                    match error.hint() {
                        Some(hint) => mistakes.report_with(TIMES, error.to_string(), hint),
                        None => mistakes.report(TIMES, error.to_string()),
                    }
                    return None;
                }
            }
        }
    };
    if times.len() != files {
        let word = if files == 1 { "file" } else { "files" };
        mistakes.report(TIMES, format!("{} times for {files} {word}", times.len()));
        return None;
    }
    if let Some(place) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        mistakes.report(&format!("{TIMES}.{}", place + 1), "the times do not increase");
        return None;
    }
    Some(times)
}
