//! Checkpoints of a run: when they are written, their header, and which one a run resumes from.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::args::in_option;
use crate::scenarios::Checked;
use base::diagnostic::{Diagnostic, file_name, shown_path};
use base::findings;
use base::units::Time;
use scene::model::{Identity, Model};
use scene::scenario::{self, Document};
use scene::simulate::{Checkpoint, Restart};
use study::evaluate::build_name;
use study::store::checkpoints::{self, CheckpointStore};

/// When checkpoints are written, and whether the run resumes from one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CheckpointPolicy {
    /// Simulated time between two, s.
    pub every: Option<f64>,
    /// Whether the run resumes from the newest.
    pub resume: bool,
    /// Whether a run without a checkpoint to resume from starts from its beginning.
    pub or_start: bool,
    /// Whether snapshots have their detail.
    pub detailed: bool,
}

/// The checkpoints of one run.
#[derive(Clone, Debug)]
pub(crate) struct CheckpointWriter {
    store: CheckpointStore,
    header: CheckpointHeader,
    /// The file that the run resumes from.
    start: Option<PathBuf>,
    /// Warnings about that file.
    pub warnings: Vec<Warning>,
}

/// Whether there are checkpoints, complete or damaged, of the run whose results go to `place`.
pub(crate) fn are_beside(place: &Path) -> bool {
    !CheckpointStore::beside(place).checkpoints().is_empty()
}

/// The interval that `--checkpoint-every` gives, s.
pub(crate) fn interval(text: &str) -> Result<f64, Diagnostic> {
    let mistake = |message: String| in_option("--checkpoint-every", text, message);
    let value = match text.trim().parse::<f64>() {
        Ok(seconds) => seconds,
        Err(_) => Time::DIMENSION.parse(text).map_err(|error| {
            mistake(error.to_string()).hint(format!("simulated time between two checkpoints; {}", error.hint()))
        })?,
    };
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(mistake(format!("no time passes between checkpoints every {}", Time(value))))
    }
}

impl CheckpointWriter {
    /// The checkpoints of the run of `checked` whose results go to `place`; `None` where it neither writes nor reads
    /// any.
    ///
    /// # Errors
    /// The interval is longer than the run, checkpoints would be overwritten, or there is no checkpoint of this run to
    /// resume from.
    pub(crate) fn new(
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
            let message = format!("{}: no checkpoint within the simulated time of {}", model.name, Time(duration));
            let hint = format!("--checkpoint-every is simulated time, and {} is longer", Time(every));
            return Err(Diagnostic::new(message).hint(hint));
        }
        let store = CheckpointStore::beside(place);
        let header = CheckpointHeader::new(&checked.document, model, every, detailed);
        let header = header.map_err(|error| Diagnostic::new(format!("{}: {error}", model.name)))?;
        let mut writer = CheckpointWriter { store, header, start: None, warnings: vec![] };
        if or_start && writer.store.checkpoints().is_empty() {
            writer.start_from_beginning(&model.name, place);
        } else if resume {
            writer.find_start(&model.name)?
        } else {
            writer.refuse_to_overwrite(&model.name)?
        }
        Ok(Some(writer))
    }

    /// Simulated time between two checkpoints, s.
    pub(crate) fn every(&self) -> Option<f64> {
        self.header.every
    }

    /// Takes the interval of another run of the command, where this run has none and its `duration` (s) is longer.
    pub(crate) fn default_interval(&mut self, every: f64, duration: f64) {
        self.header.every = self.header.every.or(Some(every).filter(|every| *every < duration));
    }

    fn start_from_beginning(&mut self, name: &str, place: &Path) {
        self.warnings.push(Warning::NoCheckpoint {
            run: name.into(),
            folder: self.store.path().into(),
            replaced: place.exists().then(|| place.into()),
        });
    }

    fn refuse_to_overwrite(&self, name: &str) -> Result<(), Diagnostic> {
        if self.store.checkpoints().is_empty() {
            return Ok(());
        }
        let folder = shown_path(self.store.path());
        let mistake = Diagnostic::new(format!("{name}: an unfinished run left checkpoints in {folder}"));
        Err(mistake.hint("--resume continues from there; remove the folder to start from the beginning"))
    }

    /// Finds the newest complete checkpoint and checks that it belongs to this run.
    fn find_start(&mut self, name: &str) -> Result<(), Diagnostic> {
        let folder = shown_path(self.store.path());
        let Some(found) = self.store.newest() else {
            let all = self.store.checkpoints();
            if all.is_empty() {
                let mistake = Diagnostic::new(format!("{name}: there is no checkpoint in {folder}"));
                return Err(
                    mistake.hint("a run with --checkpoint-every writes checkpoints and removes them when it ends")
                );
            }
            let files: Vec<String> = all.iter().map(|path| file_name(path)).collect();
            let message = format!("{name}: no checkpoint in {folder} is whole: {} damaged", files.join(", "));
            return Err(Diagnostic::new(message).hint("remove the folder and start from the beginning"));
        };
        let header = checkpoints::open(&found.path).and_then(|mut file| CheckpointHeader::read(&mut file));
        let header = header.map_err(|error| unreadable(&found.path, &error))?;
        self.header.differs_from(&header).map_or(Ok(()), |why| {
            let mistake = Diagnostic::new(format!("{name}: the checkpoint in {folder} is of another run"));
            Err(mistake.hint(why))
        })?;
        self.header.every = self.header.every.or(header.every);
        let damaged = |damaged: PathBuf| Warning::Damaged { run: name.into(), damaged, used: found.path.clone() };
        self.warnings.extend(found.damaged.into_iter().map(damaged));
        self.start = Some(found.path);
        Ok(())
    }

    /// The state that the run resumes from, if it does.
    pub(crate) fn start(&self) -> Result<Option<Restart>, Diagnostic> {
        let Some(path) = &self.start else { return Ok(None) };
        let read = || {
            let mut file = checkpoints::open(path)?;
            CheckpointHeader::read(&mut file)?;
            // The state holds no text, which alone needs the buffer.
            let (restart, (mut file, _)) =
                postcard::from_io((file, &mut [0_u8; 64][..])).map_err(|_| io::Error::other(OTHER_LAYOUT))?;
            // Bare numbers of another layout may be read, but rarely to the last byte.
            if file.read(&mut [0])? == 0 { Ok(restart) } else { Err(io::Error::other(OTHER_LAYOUT)) }
        };
        read().map(Some).map_err(|error: io::Error| unreadable(path, &error))
    }

    /// Creates the folder of the checkpoints, where further ones are written.
    pub(crate) fn create_folder(&self) -> Result<(), Diagnostic> {
        self.every().map_or(Ok(()), |_| self.store.create_folder().map_err(|error| Diagnostic::new(error.to_string())))
    }

    /// Writes a checkpoint.
    pub(crate) fn write(&self, checkpoint: &Checkpoint<'_>) -> Result<(), Diagnostic> {
        let put = self.store.put(checkpoint.steps(), |out| {
            self.header.write(out)?;
            serialise(checkpoint, out)
        });
        put.map_err(|error| Diagnostic::new(error.to_string()))
    }

    /// Removes the checkpoints of a run that has ended.
    pub(crate) fn clear(&self) {
        self.store.clear();
    }
}

fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {error}", shown_path(path)));
    mistake.hint("resume with the droptower that wrote it, or remove the folder to start from the beginning")
}

fn serialise(value: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    let mut out = ErrorTrap { out, error: None };
    let written = postcard::to_io(value, &mut out).map(drop);
    written.map_err(|error| out.error.unwrap_or_else(|| io::Error::other(error)))
}

/// A writer that stores the error that the serialiser discards.
struct ErrorTrap<'a> {
    out: &'a mut dyn Write,
    error: Option<io::Error>,
}

impl Write for ErrorTrap<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes).map_err(|error| store(&mut self.error, error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush().map_err(|error| store(&mut self.error, error))
    }
}

fn store(place: &mut Option<io::Error>, error: io::Error) -> io::Error {
    let kind = error.kind();
    *place = Some(error);
    kind.into()
}

/// Name and number of the layout, at the start of every checkpoint. The number is raised by hand whenever
/// [`CheckpointHeader`], `simulate::Checkpoint` or anything in them (the model, the engine's `State`, the probe's
/// `Record`) gains, loses or moves a field or gives it another type or meaning: the file holds bare numbers, which
/// another layout would misread, and builds of one version may differ.
const MAGIC: &[u8; 24] = b"droptower checkpoint 09\n";

/// The message for a checkpoint of another layout.
const OTHER_LAYOUT: &str = "not a checkpoint of this build of droptower";

/// Tables of a scenario that are read after the run.
const AFTER_THE_RUN: [&str; 3] = ["title", "reference", "post"];

/// Characters beyond which a refusal does not print a value.
const LONGEST_VALUE: usize = 60;

/// Most differing keys that a refusal names.
const MOST_KEYS: usize = 3;

/// The run that a checkpoint belongs to; it precedes the state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct CheckpointHeader {
    /// The build of droptower: another one may give other bits.
    build: String,
    /// Simulated time between two checkpoints, s; `None` where no further ones are written.
    pub every: Option<f64>,
    /// Whether snapshots have their detail.
    detailed: bool,
    /// The resolved scenario, for messages.
    scenario: String,
    /// All that decides the bits of the run.
    identity: Identity,
}

impl CheckpointHeader {
    /// The header of a run of `model`, checked from `document`.
    ///
    /// # Errors
    /// A mesh cannot be read.
    pub(crate) fn new(
        document: &Document,
        model: &Model,
        every: Option<f64>,
        detailed: bool,
    ) -> io::Result<CheckpointHeader> {
        let (scenario, identity) = (document.resolved(), Identity::from_model(model)?);
        Ok(CheckpointHeader { build: build_name().into(), every, detailed, scenario, identity })
    }

    /// Reads the header at the start of a checkpoint.
    pub(crate) fn read(file: &mut impl Read) -> io::Result<CheckpointHeader> {
        let mut magic = [0; MAGIC.len()];
        file.read_exact(&mut magic)?;
        if magic != *MAGIC {
            return Err(io::Error::other(OTHER_LAYOUT));
        }
        let mut length = [0; 8];
        file.read_exact(&mut length)?;
        let mut header = Vec::new();
        // As far as the file goes: the length in a damaged file may be any, and is not allocated beforehand.
        file.take(u64::from_le_bytes(length)).read_to_end(&mut header)?;
        postcard::from_bytes(&header).map_err(|_| io::Error::other(OTHER_LAYOUT))
    }

    /// Writes the header at the start of a checkpoint.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let header = postcard::to_allocvec(self).map_err(io::Error::other)?;
        out.write_all(MAGIC)?;
        out.write_all(&(header.len() as u64).to_le_bytes())?;
        out.write_all(&header)
    }

    /// Why a run of this header cannot resume from a checkpoint of another; `None` where it can.
    fn differs_from(&self, other: &CheckpointHeader) -> Option<String> {
        if self.build != other.build {
            let (now, then) = (&self.build, &other.build);
            return Some(format!("droptower {then} wrote it, this is {now}: the results may differ in their bits"));
        }
        if self.detailed != other.detailed {
            return Some(format!("it was started with{} --vtu", if other.detailed { "" } else { "out" }));
        }
        if self.identity == other.identity {
            return None;
        }
        let differences = differences(&other.scenario, &self.scenario);
        Some(match differences.as_slice() {
            [] => "the scenario is the same, but a file that it names has changed".into(),
            all if all.len() > MOST_KEYS => {
                format!("{}; and {} more", all[..MOST_KEYS].join("; "), all.len() - MOST_KEYS)
            }
            all => all.join("; "),
        })
    }
}

/// The keys in which the resolved scenario of a checkpoint, `then`, and that of a run, `now`, differ, worded for a
/// message.
fn differences(then: &str, now: &str) -> Vec<String> {
    let [then, now] = [leaves(then), leaves(now)];
    let keys: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let difference = |key: &String| match (then.get(key), now.get(key)) {
        (there, here) if scenario::is_same_value(there, here) => None,
        (Some(there), Some(here)) if there.len().max(here.len()) > LONGEST_VALUE => {
            Some(format!("there `{key}` is another one"))
        }
        (Some(there), Some(here)) => Some(format!("there `{key}` is {there}, here it is {here}")),
        (None, _) => Some(format!("there it has no `{key}`")),
        (_, None) => Some(format!("there it has `{key}`, here it has none")),
    };
    keys.into_iter().filter_map(difference).collect()
}

/// The values of a resolved scenario that determine the run, as TOML, by the paths of their keys.
fn leaves(scenario: &str) -> BTreeMap<String, String> {
    let mut leaves = scenario::leaves(scenario);
    leaves.retain(|path, _| !AFTER_THE_RUN.contains(&path.split('.').next().unwrap_or_default()));
    leaves
}

findings! {
    /// A warning that comes before a run resumes.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub(crate) enum Warning {
        NoCheckpoint {
            run: String, "its name" => "run";
            folder: PathBuf, "the folder without checkpoints" => "folder" = shown_path(folder);
            replaced: Option<PathBuf>, "the folder of results that will be replaced, where it exists"
                => "replaced" = replaced.as_deref().map(shown_path);
        } = "no-checkpoint", Note;
            meaning "a batch resumes, and this run has no checkpoint: it had not started, or its results are of \
                another state of its scenario, so it starts from its beginning";
            remedy "leave its scenario out where its results are to stay";
            message "{run} starts from its beginning: there is no checkpoint in {}{}", shown_path(folder),
                replaced.as_deref().map_or_else(String::new, |results| {
                    let results = shown_path(results);
                    format!("; its results in {results} will be replaced: leave the scenario out to keep them")
                });
        Complete {
            run: String, "its name" => "run";
            folder: PathBuf, "the folder of its results" => "folder" = shown_path(folder);
        } = "already-complete", Note;
            meaning "a run is to resume, and its results are those of its scenario as it is now: they are left as they are";
            remedy "none is needed; without --resume the run is repeated";
            message "{run} is complete: {}", shown_path(folder);
        Damaged {
            run: String, "name of the run" => "run";
            damaged: PathBuf, "the checkpoint" => "damaged" = shown_path(damaged);
            used: PathBuf, "the one before it" => "used" = shown_path(used);
        } = "damaged-checkpoint", Warning;
            meaning "the newest checkpoint of a run is damaged, so the run resumes from the one before it";
            remedy "none is needed; what was computed between the two is computed again, with the same result";
            message "{run}: {} is damaged; the run resumes from {}, the one before it",
                shown_path(damaged), file_name(used);
    }
}

#[cfg(test)]
mod tests {
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
    fn an_error_of_the_disk_is_reported() {
        for at_once in [true, false] {
            let error = serialise(&[1.0, 2.0], &mut Full { at_once }).unwrap_err();
            assert_eq!(error.to_string(), "no space left");
        }
    }

    /// The header of a run of so many layers, whose resolved scenario is `scenario`.
    fn header(build: &str, scenario: &str, layers: u32) -> CheckpointHeader {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        let document = Document::read(&path).expect("a document");
        let mut model = scene::model::check(&document).expect("a model");
        model.faces[0].layers = layers;
        let header = CheckpointHeader::new(&document, &model, None, false).expect("a header");
        CheckpointHeader { build: build.into(), scenario: scenario.into(), ..header }
    }

    #[test]
    fn long_values_and_long_lists_are_cut_short() {
        let lists = |last: u8| format!("a = [{}{last}]\n[[layer]]\nheight = {last}\n", "0.25, ".repeat(20));
        let found = differences(&lists(1), &lists(2));
        assert_eq!(found, ["there `a` is another one", "there `layer.0.height` is 1, here it is 2"]);
        let other = header(build_name(), "a = 1\nb = 1\nc = 1\nd = 1\ne = 1\n", 9);
        let hint = header(build_name(), "", 8).differs_from(&other).unwrap();
        assert!(hint.ends_with("there it has `c`, here it has none; and 2 more"), "{hint}");
    }

    #[test]
    fn a_refusal_names_the_keys_that_differ() {
        let own = header("0.1.0", "[layers]\ncount = 8\n", 8);
        for (build, scenario, layers, expected) in [
            ("0.1.0", "[layers]\ncount = 8\n", 8, None),
            ("0.1.0", "title = \"other\"\n", 8, None),
            (
                "0.0.9",
                "[layers]\ncount = 8\n",
                8,
                Some("droptower 0.0.9 wrote it, this is 0.1.0: the results may differ in their bits"),
            ),
            ("0.1.0", "[layers]\ncount = 9\n", 9, Some("there `layers.count` is 9, here it is 8")),
            ("0.1.0", "[layers]\ncount = 8\nmore = 1\n", 9, Some("there it has `layers.more`, here it has none")),
            ("0.1.0", "[layers]\n", 9, Some("there it has no `layers.count`")),
            ("0.1.0", "title = \"a\"\n[layers]\ncount = 9\n", 9, Some("there `layers.count` is 9, here it is 8")),
            (
                "0.1.0",
                "[layers]\ncount = 8\n",
                9,
                Some("the scenario is the same, but a file that it names has changed"),
            ),
        ] {
            assert_eq!(own.differs_from(&header(build, scenario, layers)).as_deref(), expected);
        }
    }

    #[test]
    fn a_header_is_read_as_it_was_written() {
        let header = header(build_name(), "[layers]\ncount = 8\n", 8);
        let mut file = Vec::new();
        header.write(&mut file).unwrap();
        assert_eq!(CheckpointHeader::read(&mut file.as_slice()).unwrap(), header);
        file[22] += 1;
        assert_eq!(CheckpointHeader::read(&mut file.as_slice()).unwrap_err().to_string(), OTHER_LAYOUT);
    }
}
