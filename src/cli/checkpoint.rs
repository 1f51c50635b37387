//! Checkpoints of a run: what they are written for, and whether one may be taken up.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::faults::storing;
use super::scenarios::Checked;
use crate::diagnostic::{Diagnostic, Source, Span, shown_path};
use crate::file::Digest;
use crate::model::{ImpactorShape, Model, Shape};
use crate::scenario;
use crate::simulate::{Checkpoint, Restart};
use crate::store::checkpoints::{self, CheckpointStore};
use crate::units::Time;

/// Name and number of the layout, at the start of every checkpoint. The number is raised by hand whenever `CheckpointHeader`,
/// `simulate::Checkpoint` or anything in them (the engine's `State`, the probe's `Record`) gains, loses or moves a field or
/// gives it another type or meaning: the file holds bare numbers, which another layout would misread, and builds of one
/// version may differ.
const MAGIC: &[u8; 24] = b"droptower checkpoint 04\n";

/// What is wrong with a checkpoint of another layout.
const LAID_OUT: &str = "no checkpoint of this build of droptower";

/// Version of the engine: another one may give other bits.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Tables of a scenario that are read after the run.
const AFTER_THE_RUN: [&str; 3] = ["title", "reference", "post"];

/// Keys that a refused checkpoint names at most.
const SHOWN: usize = 3;

/// Values of more characters are not shown.
const LONG: usize = 60;

/// What the user wants of checkpoints.
#[derive(Clone, Copy, Debug, Default)]
pub struct CheckpointPolicy {
    /// Simulated time between two, s.
    pub every: Option<f64>,
    /// Whether to go on from the newest.
    pub resume: bool,
    /// Whether a run that has none to go on from starts from its beginning.
    pub or_start: bool,
    /// Whether kept states have their detail.
    pub detailed: bool,
}

/// The checkpoints of one run.
#[derive(Clone, Debug)]
pub struct CheckpointWriter {
    store: CheckpointStore,
    header: CheckpointHeader,
    /// The one to go on from.
    start: Option<PathBuf>,
    /// What the user should know about it.
    pub notes: Vec<String>,
}

/// What a checkpoint is of; stands before the state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct CheckpointHeader {
    version: String,
    /// Simulated time between two checkpoints, s; none where no more were asked for.
    every: Option<f64>,
    /// Whether kept states have their detail.
    detailed: bool,
    /// The scenario as resolved, for messages.
    scenario: String,
    /// Everything that decides the run's bits.
    run: String,
}

/// Whether the run whose results go to `place` left checkpoints, whole or not.
pub fn are_beside(place: &Path) -> bool {
    !CheckpointStore::beside(place).checkpoints().is_empty()
}

/// The interval that `--checkpoint-every` gives, s.
pub fn interval(text: &str) -> Result<f64, Diagnostic> {
    let source = Source::unfiled("--checkpoint-every", text.to_owned());
    let whole = Span::new(&source, 0..text.len());
    let value = match text.trim().parse::<f64>() {
        Ok(seconds) => seconds,
        Err(_) => Time::DIMENSION.parse(text).map_err(|error| {
            let mistake = Diagnostic::new(error.to_string()).at(&whole);
            mistake.hint(format!("simulated time between two checkpoints; {}", error.hint()))
        })?,
    };
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Diagnostic::new(format!("no time passes between checkpoints every {}", Time(value))).at(&whole))
    }
}

impl CheckpointWriter {
    /// What `policy` means for the run of `checked` whose results go to `place`; none where nothing is to be kept.
    ///
    /// # Errors
    /// An interval in which the run is over, checkpoints that would be lost, no checkpoint to go on from, or one of another
    /// run.
    pub fn new(
        policy: CheckpointPolicy,
        checked: &Checked,
        place: &Path,
    ) -> Result<Option<CheckpointWriter>, Diagnostic> {
        let CheckpointPolicy { every, resume, or_start, detailed } = policy;
        if every.is_none() && !resume {
            return Ok(None);
        }
        let model = &checked.model;
        let duration = model.run_time();
        if let Some(every) = every.filter(|every| *every >= duration) {
            let message = format!("{}: no checkpoint within {}, which is all it simulates", model.name, Time(duration));
            let hint = format!("--checkpoint-every is simulated time, and {} is longer", Time(every));
            return Err(Diagnostic::new(message).hint(hint));
        }
        let store = CheckpointStore::beside(place);
        let run = identity(model).map_err(|error| Diagnostic::new(format!("{}: {error}", model.name)))?;
        let header =
            CheckpointHeader { version: VERSION.into(), every, detailed, scenario: checked.document.resolved(), run };
        let mut writer = CheckpointWriter { store, header, start: None, notes: vec![] };
        if or_start && writer.store.checkpoints().is_empty() {
            writer.start_anew(&model.name, place);
        } else if resume {
            writer.find_start(&model.name)?
        } else {
            writer.refuse_to_overwrite(&model.name)?
        }
        Ok(Some(writer))
    }

    /// Simulated time between two checkpoints, s.
    pub fn every(&self) -> Option<f64> {
        self.header.every
    }

    /// The same interval as another run of the command has, where none was asked for and checkpoints fall into the
    /// `duration` (s) of this one.
    pub fn keep_as_others(&mut self, every: f64, duration: f64) {
        self.header.every = self.header.every.or(Some(every).filter(|every| *every < duration));
    }

    fn start_anew(&mut self, name: &str, place: &Path) {
        let folder = shown_path(self.store.path());
        let replaced = if place.exists() {
            format!("; its results in {} will be replaced: leave it out to keep them", shown_path(place))
        } else {
            String::new()
        };
        self.notes.push(format!("{name} starts from its beginning: there is no checkpoint in {folder}{replaced}"));
    }

    fn refuse_to_overwrite(&self, name: &str) -> Result<(), Diagnostic> {
        if self.store.checkpoints().is_empty() {
            return Ok(());
        }
        let folder = shown_path(self.store.path());
        let mistake = Diagnostic::new(format!("{name}: an unfinished run left checkpoints in {folder}"));
        Err(mistake.hint("--resume goes on from there; remove the folder to start anew"))
    }

    /// Finds the newest whole checkpoint and proves that it is of this run.
    fn find_start(&mut self, name: &str) -> Result<(), Diagnostic> {
        let folder = shown_path(self.store.path());
        let Some(found) = self.store.newest() else {
            let all = self.store.checkpoints();
            if all.is_empty() {
                let mistake = Diagnostic::new(format!("{name}: there is no checkpoint in {folder}"));
                return Err(mistake.hint("only a run with --checkpoint-every leaves some, and only until it ends"));
            }
            let files: Vec<String> = all.iter().map(|path| file_name(path)).collect();
            let message = format!("{name}: no checkpoint in {folder} is whole: {} damaged", files.join(", "));
            return Err(Diagnostic::new(message).hint("remove the folder and start anew"));
        };
        let header = checkpoints::open(&found.path).and_then(|mut file| read_header(&mut file));
        let header = header.map_err(|error| unreadable(&found.path, &error))?;
        self.header.differs_from(&header).map_or(Ok(()), |why| {
            let mistake = Diagnostic::new(format!("{name}: the checkpoint in {folder} is of another run"));
            Err(mistake.hint(why))
        })?;
        self.header.every = self.header.every.or(header.every);
        for damaged in &found.damaged {
            let used = file_name(&found.path);
            self.notes.push(format!("{name}: {} is damaged; {used}, the one before it, is not", shown_path(damaged)));
        }
        self.start = Some(found.path);
        Ok(())
    }

    /// The state to go on from, if the run does.
    pub fn start(&self) -> Result<Option<Restart>, Diagnostic> {
        let Some(path) = &self.start else { return Ok(None) };
        let read = || {
            let mut file = checkpoints::open(path)?;
            read_header(&mut file)?;
            // The state holds no text, for which alone the buffer would be.
            let (restart, (mut file, _)) =
                postcard::from_io((file, &mut [0_u8; 64][..])).map_err(|_| io::Error::other(LAID_OUT))?;
            // Bare numbers of another layout may well be read, but hardly to the last.
            if file.read(&mut [0])? == 0 { Ok(restart) } else { Err(io::Error::other(LAID_OUT)) }
        };
        read().map(Some).map_err(|error: io::Error| unreadable(path, &error))
    }

    /// Makes the place for checkpoints, where more are wanted.
    pub fn open(&self) -> Result<(), Diagnostic> {
        self.every().map_or(Ok(()), |_| self.store.open().map_err(|error| storing(&error)))
    }

    /// Writes a checkpoint.
    pub fn keep(&self, checkpoint: &Checkpoint<'_>) -> Result<(), Diagnostic> {
        let put = self.store.put(checkpoint.steps(), |out| {
            out.write_all(MAGIC)?;
            let header = postcard::to_allocvec(&self.header).map_err(io::Error::other)?;
            out.write_all(&(header.len() as u64).to_le_bytes())?;
            out.write_all(&header)?;
            serialise(checkpoint, out)
        });
        put.map_err(|error| storing(&error))
    }

    /// Removes the checkpoints of a run that has ended.
    pub fn clear(&self) {
        self.store.clear();
    }
}

impl CheckpointHeader {
    /// Why a run of this header cannot go on from a checkpoint of another; none where it can.
    fn differs_from(&self, other: &CheckpointHeader) -> Option<String> {
        if self.version != other.version {
            let (now, then) = (&self.version, &other.version);
            return Some(format!("droptower {then} wrote it, and this is {now}: it could not give the same bits"));
        }
        if self.detailed != other.detailed {
            return Some(format!("it was started with{} --vtu", if other.detailed { "" } else { "out" }));
        }
        if self.run == other.run {
            return None;
        }
        let differences = differences(&other.scenario, &self.scenario);
        Some(match differences.as_slice() {
            [] => "the scenario is the same, but a file that it names has changed".into(),
            all if all.len() > SHOWN => format!("{}; and {} more", all[..SHOWN].join("; "), all.len() - SHOWN),
            all => all.join("; "),
        })
    }
}

/// The keys in which the resolved scenario of a checkpoint, `then`, and that of a run, `now`, differ, as told to the user.
fn differences(then: &str, now: &str) -> Vec<String> {
    let (then, now) = (leaves(then), leaves(now));
    let paths: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let told = |path: &String| match (then.get(path), now.get(path)) {
        (Some(then), Some(now)) if then == now => None,
        (Some(then), Some(now)) if then.len().max(now.len()) > LONG => Some(format!("there `{path}` is another one")),
        (Some(then), Some(now)) => Some(format!("there `{path}` is {then}, here it is {now}")),
        (None, Some(_)) => Some(format!("there it has no `{path}`")),
        (Some(_), None) => Some(format!("there it has `{path}`, here it has none")),
        (None, None) => None,
    };
    paths.into_iter().filter_map(told).collect()
}

/// The values of a resolved scenario that decide the run, as TOML, by the paths of their keys.
fn leaves(scenario: &str) -> BTreeMap<String, String> {
    let mut leaves = scenario::leaves(scenario);
    leaves.retain(|path, _| !AFTER_THE_RUN.contains(&path.split('.').next().unwrap_or_default()));
    leaves
}

fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {error}", shown_path(path)));
    mistake.hint("go on with the droptower that wrote it, or remove the folder to start anew")
}

fn read_header(file: &mut impl Read) -> io::Result<CheckpointHeader> {
    let mut magic = [0; MAGIC.len()];
    file.read_exact(&mut magic)?;
    if magic != *MAGIC {
        return Err(io::Error::other(LAID_OUT));
    }
    let mut length = [0; 8];
    file.read_exact(&mut length)?;
    let mut header = Vec::new();
    file.take(u64::from_le_bytes(length)).read_to_end(&mut header)?;
    postcard::from_bytes(&header).map_err(io::Error::other)
}

/// Everything that decides a run's bits, as text: the checked model, with meshes by what their files hold. Title, reference
/// and post script are left out: they are read after the run.
fn identity(model: &Model) -> io::Result<String> {
    let Model { name: _, title: _, specimen, faces, frame, impactor, loading, solver, output, reference: _, post: _ } =
        model;
    let (mut specimen, mut impactor) = (specimen.clone(), impactor.clone());
    if let Shape::Mesh(path) = &mut specimen.shape {
        *path = content(path)?;
    }
    if let Some(ImpactorShape::Mesh(path)) = impactor.as_mut().map(|impactor| &mut impactor.shape) {
        *path = content(path)?;
    }
    Ok(format!("{specimen:?}\n{faces:?}\n{frame:?}\n{impactor:?}\n{loading:?}\n{solver:?}\n{output:?}"))
}

/// A name that tells what the file at `path` holds.
fn content(path: &Path) -> io::Result<PathBuf> {
    let digest = Digest::of_file(path);
    let digest = digest.map_err(|error| io::Error::other(format!("{}: {error}", shown_path(path))))?;
    Ok(PathBuf::from(digest.to_string()))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn serialise(value: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    let mut out = Remembering { out, error: None };
    let written = postcard::to_io(value, &mut out).map(drop);
    written.map_err(|error| out.error.unwrap_or_else(|| io::Error::other(error)))
}

/// Keeps the error that the serialiser hides.
struct Remembering<'a> {
    out: &'a mut dyn Write,
    error: Option<io::Error>,
}

impl Write for Remembering<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes).map_err(|error| keep(&mut self.error, error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush().map_err(|error| keep(&mut self.error, error))
    }
}

fn keep(place: &mut Option<io::Error>, error: io::Error) -> io::Error {
    let kind = error.kind();
    *place = Some(error);
    kind.into()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A disk that is full when a write, or only the flush, reaches it.
    struct Full {
        at_once: bool,
    }

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.at_once { Err(io::Error::other("no space left")) } else { Ok(bytes.len()) }
        }

        fn flush(&mut self) -> io::Result<()> {
            Err(io::Error::other("no space left"))
        }
    }

    #[test]
    fn the_disk_s_own_error_is_told() {
        for at_once in [true, false] {
            let error = serialise(&[1.0, 2.0], &mut Full { at_once }).unwrap_err();
            assert_eq!(error.to_string(), "no space left");
        }
    }

    #[test]
    fn an_interval_is_a_simulated_time() {
        for (text, expected) in [("5 ms", 0.005), ("0.25", 0.25), ("1e-3 s", 0.001)] {
            assert_eq!(interval(text).unwrap(), expected);
        }
        for (text, expected) in [
            ("5 mm", "expected a time, found \"5 mm\""),
            ("soon", "which does not start with a number"),
            ("0 s", "no time passes"),
            ("-1 ms", "no time passes"),
            ("nan", "no time passes"),
        ] {
            let mistake = interval(text).unwrap_err();
            assert!(mistake.message.contains(expected), "{}", mistake.message);
        }
    }

    #[test]
    fn a_mesh_counts_with_what_its_file_holds() {
        let folder = tempfile::tempdir().unwrap();
        let (path, moved) = (folder.path().join("a.stl"), folder.path().join("b.stl"));
        fs::write(&path, "solid film").unwrap();
        let before = content(&path).unwrap();
        fs::rename(&path, &moved).unwrap();
        assert_eq!(content(&moved).unwrap(), before);
        fs::write(&moved, "solid Film").unwrap();
        assert_ne!(content(&moved).unwrap(), before);
        assert!(content(&path).is_err());
    }

    #[test]
    fn long_values_and_long_lists_are_cut_short() {
        let lists = |last: u8| format!("a = [{}{last}]\n[[layer]]\nheight = {last}\n", "0.25, ".repeat(20));
        let told = differences(&lists(1), &lists(2));
        assert_eq!(told, ["there `a` is another one", "there `layer.0.height` is 1, here it is 2"]);
        let own = |run: &str, scenario: &str| CheckpointHeader {
            version: VERSION.into(),
            every: None,
            detailed: false,
            scenario: scenario.into(),
            run: run.into(),
        };
        let hint = own("1", "").differs_from(&own("2", "a = 1\nb = 1\nc = 1\nd = 1\ne = 1\n")).unwrap();
        assert!(hint.ends_with("there it has `c`, here it has none; and 2 more"), "{hint}");
    }

    #[test]
    fn a_stamp_tells_what_is_different() {
        let header = |version: &str, scenario: &str, run: &str| CheckpointHeader {
            version: version.into(),
            every: None,
            detailed: false,
            scenario: scenario.into(),
            run: run.into(),
        };
        let own = header("0.1.0", "[layers]\ncount = 8\n", "8");
        for (other, expected) in [
            (header("0.1.0", "[layers]\ncount = 8\n", "8"), None),
            (header("0.1.0", "title = \"other\"\n", "8"), None),
            (
                header("0.0.9", "[layers]\ncount = 8\n", "8"),
                Some("droptower 0.0.9 wrote it, and this is 0.1.0: it could not give the same bits"),
            ),
            (header("0.1.0", "[layers]\ncount = 9\n", "9"), Some("there `layers.count` is 9, here it is 8")),
            (
                header("0.1.0", "[layers]\ncount = 8\nmore = 1\n", "9"),
                Some("there it has `layers.more`, here it has none"),
            ),
            (header("0.1.0", "[layers]\n", "9"), Some("there it has no `layers.count`")),
            (
                header("0.1.0", "title = \"a\"\n[layers]\ncount = 9\n", "9"),
                Some("there `layers.count` is 9, here it is 8"),
            ),
            (
                header("0.1.0", "[layers]\ncount = 8\n", "9"),
                Some("the scenario is the same, but a file that it names has changed"),
            ),
        ] {
            assert_eq!(own.differs_from(&other).as_deref(), expected);
        }
    }
}
