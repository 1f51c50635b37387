//! Checkpoints of a run: when they are written, and which one a run resumes from.

mod header;
mod warning;

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use self::header::{CheckpointHeader, OTHER_LAYOUT};
pub(super) use self::warning::{CODES, Warning};
use super::faults::storing;
use super::scenarios::Checked;
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::units::Time;
use scene::simulate::{Checkpoint, Restart};
use study::store::checkpoints::{self, CheckpointStore};

/// When checkpoints are written, and whether the run resumes from one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CheckpointPolicy {
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
pub(super) struct CheckpointWriter {
    store: CheckpointStore,
    header: CheckpointHeader,
    /// The file that the run resumes from.
    start: Option<PathBuf>,
    /// Warnings about that file.
    pub warnings: Vec<Warning>,
}

/// Whether there are checkpoints, complete or damaged, of the run whose results go to `place`.
pub(super) fn are_beside(place: &Path) -> bool {
    !CheckpointStore::beside(place).checkpoints().is_empty()
}

/// The interval that `--checkpoint-every` gives, s.
pub(super) fn interval(text: &str) -> Result<f64, Diagnostic> {
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
    /// The checkpoints of the run of `checked` whose results go to `place`; `None` where it neither writes nor reads
    /// any.
    ///
    /// # Errors
    /// The interval is longer than the run, checkpoints would be overwritten, or there is no checkpoint of this run to
    /// resume from.
    pub(super) fn new(
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
    pub(super) fn every(&self) -> Option<f64> {
        self.header.every
    }

    /// Takes the interval of another run of the command, where this run has none and its `duration` (s) is longer.
    pub(super) fn default_interval(&mut self, every: f64, duration: f64) {
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
    pub(super) fn start(&self) -> Result<Option<Restart>, Diagnostic> {
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
    pub(super) fn create_folder(&self) -> Result<(), Diagnostic> {
        self.every().map_or(Ok(()), |_| self.store.create_folder().map_err(|error| storing(&error)))
    }

    /// Writes a checkpoint.
    pub(super) fn write(&self, checkpoint: &Checkpoint<'_>) -> Result<(), Diagnostic> {
        let put = self.store.put(checkpoint.steps(), |out| {
            self.header.write(out)?;
            serialise(checkpoint, out)
        });
        put.map_err(|error| storing(&error))
    }

    /// Removes the checkpoints of a run that has ended.
    pub(super) fn clear(&self) {
        self.store.clear();
    }
}

fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {error}", shown_path(path)));
    mistake.hint("resume with the droptower that wrote it, or remove the folder to start from the beginning")
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
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
}
