//! Evaluations: runs that leave figures instead of a folder, each computed once, and what a search takes from them.

use std::hint::black_box;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::post::{COST, HEADER, OF_THE_MACHINE, Plan, ReferenceComparison, Results, failure_message};
use crate::store::EvaluationStore;
use crate::store::evaluations::{Key, Kind, Share};
use base::file::{Digest, FileError};
use base::group;
use scene::model::loading::Impact;
use scene::model::{FieldReference, Identity, Loading, Model, Reference};
use scene::simulate::{self, Cancellation, Outcome, RunError, RunOptions};

/// Time between two looks for what another process computes.
const WAIT: Duration = Duration::from_millis(100);

/// Time after the window that the channel filter needs, times its class.
///
/// The backward pass of the filter (both poles at ω_d e^{±3πi/4}, ω_d = 2π · 2.08333 · class) forgets its initial state
/// as e^{−ω_d t/√2} = e^{−9.26 class t}: after 2/class to a hundred-millionth. For CFC 1000 that is 2 ms.
const SETTLING: f64 = 2.0;

/// Samples after the window: the reference is interpolated between two samples of the run, and the last samples need
/// their half steps.
const SAMPLES: f64 = 3.0;

/// Most bytes of an unpacked record.
const MOST_BYTES: u64 = 1 << 30;

/// All evaluations, those computed before and those computed now, in the folder that holds their records. Evaluations
/// may be asked for by several threads at once.
pub struct Evaluations {
    store: EvaluationStore,
    share: Share,
    observer: Observer,
    cache_hits: AtomicUsize,
    computed: AtomicUsize,
}

/// What becomes of the runs that are asked for.
#[derive(Clone, Copy, Debug)]
pub enum RunEvent<'a> {
    /// So many more are asked for.
    Wanted(usize),
    /// One was computed before.
    Taken,
    /// One is computed from now on.
    Begun {
        /// Its key.
        run: Key,
        /// Name of its scenario.
        name: &'a str,
    },
    /// It has ended.
    Ended {
        /// Its key.
        run: Key,
    },
    /// It failed.
    Failed {
        /// Its key.
        run: Key,
        /// Why.
        cause: &'a str,
    },
    /// It was given up, and nothing is known of it.
    GivenUp {
        /// Its key.
        run: Key,
    },
    /// The values of one make no valid scenario, for this cause.
    Refused(&'a str),
}

/// Who is told of runs.
type Observer = Box<dyn Fn(RunEvent<'_>) + Send + Sync>;

/// The identity of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EvaluationKeys {
    /// All that decides the run.
    pub run: Key,
    /// All that decides its figures: the run, its reference and its post script.
    pub figures: Key,
}

/// The record that is kept of every evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The figures of `summary.json` that are numbers, Booleans or strings, in its order, without those of the machine.
    pub figures: Vec<(String, Figure)>,
    /// Codes of the findings, each once.
    pub findings: Vec<String>,
    /// Why the run failed, where it did; it has no figures then: those until then would count as results of a test.
    pub failure: Option<String>,
    /// Time that the engine took, s.
    pub engine_s: f64,
    /// Time that the whole evaluation took, s.
    pub wall_s: f64,
}

/// An evaluation, and whether its run was computed now.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// The evaluation.
    pub evaluation: Evaluation,
    /// Whether nothing of it was there before.
    pub is_new: bool,
}

/// A figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Figure {
    /// A number, SI.
    Number(f64),
    /// Whether something is so.
    Flag(bool),
    /// A word.
    Text(String),
}

/// Why there is no evaluation.
#[derive(Debug, Error)]
pub enum EvaluationError {
    /// The records cannot be read or written.
    #[error("{}: {source}", folder.display())]
    Store {
        /// Their folder.
        folder: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file that decides the run cannot be read.
    #[error("{0}")]
    Input(io::Error),
    /// The run was cancelled.
    #[error("the run was cancelled")]
    Cancelled,
    /// The run has no outcome, for a cause that may pass: a mesh could not be read, the post script took too long. There
    /// is no record of it.
    #[error("{0}")]
    Passing(String),
}

impl EvaluationError {
    /// A remedy, where one follows from the error.
    pub fn hint(&self) -> Option<&'static str> {
        let EvaluationError::Store { source, .. } = self else { return None };
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                Some("free some space, or give another folder by --store; what is done stays")
            }
            io::ErrorKind::ReadOnlyFilesystem | io::ErrorKind::PermissionDenied => {
                Some("give a folder that you may write by --store")
            }
            _ => None,
        }
    }
}

/// Why a run has no outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Error)]
#[error("{cause}")]
pub struct NoOutcome {
    /// The cause, with what to do.
    pub cause: String,
    /// Whether the run failed numerically; else it could not start.
    pub is_numerical: bool,
}

impl NoOutcome {
    /// The cause in the error of a run of `model`.
    pub fn from_error(error: &RunError, model: &Model) -> NoOutcome {
        let cause = match (error, error.hint()) {
            (RunError::Failure(failure), _) => failure_message(failure, model),
            (error, Some(hint)) => format!("{error}: {hint}"),
            (error, None) => error.to_string(),
        };
        NoOutcome { cause, is_numerical: matches!(error, RunError::Failure(_)) }
    }
}

impl Figure {
    /// Of a value of a summary; none of a list, a table or nothing.
    fn from_value(value: &Value) -> Option<Figure> {
        match value {
            Value::Number(number) => number.as_f64().map(Figure::Number),
            Value::Bool(flag) => Some(Figure::Flag(*flag)),
            Value::String(text) => Some(Figure::Text(text.clone())),
            Value::Null | Value::Array(_) | Value::Object(_) => None,
        }
    }

    /// As a number: a flag is one or zero.
    pub fn number(&self) -> Option<f64> {
        match self {
            Figure::Number(number) => Some(*number),
            Figure::Flag(flag) => Some(f64::from(u8::from(*flag))),
            Figure::Text(_) => None,
        }
    }
}

impl Evaluation {
    /// The figure of this name.
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|(own, _)| own == name).map(|(_, figure)| figure)
    }

    /// The record of a run with these results.
    fn from_outcome(model: &Model, outcome: &Outcome, results: &Results, wall_s: f64) -> Evaluation {
        let is_figure = |name: &str| !HEADER.contains(&name) && !OF_THE_MACHINE.contains(&name);
        let summary = results.summary(model);
        let figures = summary.iter().filter(|(name, _)| is_figure(name));
        let figures = figures.filter_map(|(name, value)| Some((name.clone(), Figure::from_value(value)?))).collect();
        let findings = group::unique(results.findings.iter().map(|finding| finding.code.clone()));
        Evaluation { figures, findings, failure: None, engine_s: outcome.wall.as_secs_f64(), wall_s }
    }

    /// The record of a scene that cannot be run.
    pub fn failed(cause: String) -> Evaluation {
        Evaluation { figures: vec![], findings: vec![], failure: Some(cause), engine_s: 0.0, wall_s: 0.0 }
    }
}

impl Evaluations {
    /// The evaluations whose records are in `folder`, which need not exist.
    pub fn new(folder: &Path) -> Evaluations {
        let store = EvaluationStore::new(folder, build_name());
        let observer: Observer = Box::new(|_| {});
        let (cache_hits, computed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Evaluations { store, share: Share::WHOLE, observer, cache_hits, computed }
    }

    /// The evaluations for a process that takes this part of the runs first.
    pub fn with_share(self, share: Share) -> Evaluations {
        Evaluations { share, ..self }
    }

    /// The evaluations that tell `observer` of every run, by several threads and without a lock.
    pub fn with_observer(self, observer: impl Fn(RunEvent<'_>) + Send + Sync + 'static) -> Evaluations {
        Evaluations { observer: Box::new(observer), ..self }
    }

    /// Tells the observer of a run.
    pub(crate) fn tell(&self, event: RunEvent<'_>) {
        (self.observer)(event);
    }

    /// Counts a run that is taken from what is known.
    fn count_hit(&self) {
        self.cache_hits.fetch_add(1, Ordering::Relaxed);
        self.tell(RunEvent::Taken);
    }

    /// Runs `model`, of which the observer is told.
    fn run(&self, model: &Model, run: Key, cancellation: &Cancellation) -> Result<Outcome, RunError> {
        self.tell(RunEvent::Begun { run, name: &model.name });
        let options = RunOptions { cancellation: cancellation.clone(), ..RunOptions::default() };
        let ran = simulate::run_with(model, options, &mut |_| {});
        match &ran {
            Ok(_) => self.tell(RunEvent::Ended { run }),
            Err(RunError::Cancelled) => self.tell(RunEvent::GivenUp { run }),
            Err(error) => self.tell(RunEvent::Failed { run, cause: &NoOutcome::from_error(error, model).cause }),
        }
        ran
    }

    /// The part of the runs that this process takes first.
    pub fn share(&self) -> Share {
        self.share
    }

    /// The records.
    pub fn store(&self) -> &EvaluationStore {
        &self.store
    }

    /// How many evaluations were taken from records, and how many were computed.
    pub fn counts(&self) -> [usize; 2] {
        [&self.cache_hits, &self.computed].map(|count| count.load(Ordering::Relaxed))
    }

    /// The identity of the evaluation of `model` by `plan`.
    ///
    /// # Errors
    /// A mesh or the reference cannot be read.
    pub fn keys(model: &Model, plan: &Plan) -> Result<EvaluationKeys, EvaluationError> {
        let run = run_key(&without_snapshots(model))?;
        let reference = model.reference.as_ref().map(content).transpose().map_err(EvaluationError::Input)?;
        let script = plan.whole_script().unwrap_or_default();
        // Findings of the scenario as written, which the model does not tell: what is written though it is the default.
        let findings = plan.findings().iter().map(|own| own.code.as_str()).collect::<Vec<_>>().join(" ");
        let parts = [&run.0, &reference.unwrap_or_default()[..], script.as_bytes(), findings.as_bytes()];
        Ok(EvaluationKeys { run, figures: Key::from_parts(&parts) })
    }

    /// The evaluation under these keys; none where it was not computed before.
    ///
    /// # Errors
    /// Its record cannot be read.
    pub fn record(&self, keys: EvaluationKeys) -> Result<Option<Evaluation>, EvaluationError> {
        self.read(Kind::Record, keys.figures)
    }

    /// The evaluation under these keys, which was computed before.
    ///
    /// # Errors
    /// Its record cannot be read, or was damaged meanwhile.
    pub fn known_record(&self, keys: EvaluationKeys) -> Result<Evaluation, EvaluationError> {
        let damaged = || self.failed(io::Error::new(io::ErrorKind::InvalidData, "a record was damaged"));
        self.record(keys)?.ok_or_else(damaged)
    }

    /// The evaluation of `model` by `plan`: from its record, from a whole run that is kept, or computed now. A run with a
    /// reference or a script, which another one may want for others, is kept whole; one without, which only other
    /// findings may want, is computed again.
    ///
    /// # Errors
    /// [`EvaluationError`]; a run that fails numerically is an evaluation, one that fails for a cause that may pass is not.
    pub fn evaluate(
        &self,
        model: &Model,
        plan: &Plan,
        keys: EvaluationKeys,
        cancellation: &Cancellation,
    ) -> Result<Evaluated, EvaluationError> {
        if let Some(evaluation) = self.record(keys)? {
            self.count_hit();
            return Ok(Evaluated { evaluation, is_new: false });
        }
        let begin = std::time::Instant::now();
        // No figure needs snapshots, and they would be most of what is kept.
        let model = &without_snapshots(model);
        let kept = self.outcome(keys.run)?;
        let is_kept = kept.is_some();
        let ran = match kept {
            Some(outcome) => Ok(outcome),
            None => self.run(model, keys.run, cancellation),
        };
        let evaluation = match ran {
            Ok(outcome) => {
                let is_wanted_again = model.reference.is_some() || plan.whole_script().is_some();
                if is_wanted_again && !is_kept {
                    self.write(Kind::Run, keys.run, &outcome)?;
                }
                match plan.evaluate(model, &outcome) {
                    Ok(results) => Evaluation::from_outcome(model, &outcome, &results, begin.elapsed().as_secs_f64()),
                    Err(error) if error.may_pass() => return Err(EvaluationError::Passing(error.to_string())),
                    Err(error) => Evaluation::failed(error.to_string()),
                }
            }
            Err(RunError::Cancelled) => return Err(EvaluationError::Cancelled),
            Err(RunError::Failure(failure)) => {
                let (engine_s, wall_s) = (failure.so_far.wall.as_secs_f64(), begin.elapsed().as_secs_f64());
                Evaluation { engine_s, wall_s, ..Evaluation::failed(failure_message(&failure, model)) }
            }
            // What may be different at the next try must not be stored as the value of this point.
            Err(error) if may_pass(&error, model, keys.run) => {
                return Err(EvaluationError::Passing(error.to_string()));
            }
            Err(error) => Evaluation::failed(NoOutcome::from_error(&error, model).cause),
        };
        self.write(Kind::Record, keys.figures, &evaluation)?;
        if is_kept {
            self.count_hit();
        } else {
            self.computed.fetch_add(1, Ordering::Relaxed);
        }
        Ok(Evaluated { evaluation, is_new: !is_kept })
    }

    /// The outcome of `model` without its pictures: of a run that is kept whole, or of one that is computed and kept now;
    /// none where another thread or process computes it. There is no record of a failure whose cause may pass.
    ///
    /// # Errors
    /// [`EvaluationError`]; why the run has no outcome is within.
    pub fn outcome_unless_claimed(
        &self,
        model: &Model,
        cancellation: &Cancellation,
    ) -> Result<Option<Result<Outcome, NoOutcome>>, EvaluationError> {
        let model = without_snapshots(model);
        let run = run_key(&model)?;
        if let Some(known) = self.known(run)? {
            return Ok(Some(known));
        }
        let Some(_claim) = self.store.claim(run).map_err(|source| self.failed(source))? else { return Ok(None) };
        // Whoever held the claim before may have ended since the look.
        if let Some(known) = self.known(run)? {
            return Ok(Some(known));
        }
        let found = self.run(&model, run, cancellation);
        match &found {
            Ok(outcome) => self.write(Kind::Run, run, outcome)?,
            Err(error) if may_pass(error, &model, run) => {}
            Err(error) => self.write(Kind::Record, failure_key(run), &NoOutcome::from_error(error, &model))?,
        }
        if matches!(found, Err(RunError::Cancelled)) {
            return Err(EvaluationError::Cancelled);
        }
        self.computed.fetch_add(1, Ordering::Relaxed);
        Ok(Some(found.map_err(|error| NoOutcome::from_error(&error, &model))))
    }

    /// The outcome of a run, waiting for another thread or process that computes it.
    ///
    /// # Errors
    /// As [`Evaluations::outcome_unless_claimed`].
    pub fn outcome_of(
        &self,
        model: &Model,
        cancellation: &Cancellation,
    ) -> Result<Result<Outcome, NoOutcome>, EvaluationError> {
        loop {
            if let Some(found) = self.outcome_unless_claimed(model, cancellation)? {
                return Ok(found);
            }
            if cancellation.is_cancelled() {
                return Err(EvaluationError::Cancelled);
            }
            thread::sleep(WAIT);
        }
    }

    /// A known result of a run: its outcome, or why it has none.
    fn known(&self, run: Key) -> Result<Option<Result<Outcome, NoOutcome>>, EvaluationError> {
        let known = match self.outcome(run)? {
            Some(outcome) => Some(Ok(outcome)),
            None => self.read(Kind::Record, failure_key(run))?.map(Err),
        };
        Ok(known.inspect(|_| self.count_hit()))
    }

    /// The outcome of a run that is kept whole, without its pictures.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn outcome(&self, run: Key) -> Result<Option<Outcome>, EvaluationError> {
        self.read(Kind::Run, run)
    }

    /// The value that is kept under `key`; none where there is none, or a damaged one.
    fn read<T: DeserializeOwned>(&self, kind: Kind, key: Key) -> Result<Option<T>, EvaluationError> {
        let content = self.store.read(kind, key).map_err(|source| self.failed(source))?;
        Ok(content.and_then(|content| unpacked(&content)))
    }

    fn write(&self, kind: Kind, key: Key, value: &impl Serialize) -> Result<(), EvaluationError> {
        let written = packed(value).and_then(|content| self.store.write(kind, key, &content));
        written.map_err(|source| self.failed(source))
    }

    /// An error of the store.
    pub fn failed(&self, source: io::Error) -> EvaluationError {
        EvaluationError::Store { folder: self.store.folder().into(), source }
    }
}

/// Key of why a run has no outcome.
fn failure_key(run: Key) -> Key {
    Key::from_parts(&[&run.0, b"failure"])
}

/// Whether a figure of that name says what a run cost, not what came of it.
pub fn is_cost(name: &str) -> bool {
    COST.contains(&name)
}

/// A model that stores no snapshots, which decide nothing.
fn without_snapshots(model: &Model) -> Model {
    let mut model = model.clone();
    model.output.frames = 0;
    model
}

/// The identity of a run of a model without snapshots, by this build.
fn run_key(model: &Model) -> Result<Key, EvaluationError> {
    let identity = Identity::from_model(model).map_err(EvaluationError::Input)?;
    Ok(Key::from_parts(&[build_name().as_bytes(), &encoded(&identity).map_err(EvaluationError::Input)?]))
}

/// The bytes that decide a reference: how it is read, and its files.
fn content(reference: &Reference) -> io::Result<Vec<u8>> {
    let digest = |path: &PathBuf| {
        Digest::of_file(path).map_err(|error| match error {
            FileError::Io(error) => error,
            error => io::Error::other(error.to_string()),
        })
    };
    let files: Vec<Digest> = reference.files().map(digest).collect::<io::Result<_>>()?;
    // Without their paths: a project that is moved or copied still has its records.
    let field = reference.field.clone().map(|field| FieldReference { files: vec![], ..field });
    let signals = reference.signals.as_ref().map(|_| PathBuf::new());
    encoded(&(Reference { signals, field, ..reference.clone() }, files))
}

fn encoded(value: &impl Serialize) -> io::Result<Vec<u8>> {
    postcard::to_allocvec(value).map_err(io::Error::other)
}

fn packed(value: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&encoded(value)?)?;
    encoder.finish()
}

/// The value that was packed; none where it is damaged.
fn unpacked<T: DeserializeOwned>(content: &[u8]) -> Option<T> {
    let mut bytes = Vec::new();
    // A damaged record must not fill the memory.
    ZlibDecoder::new(content).take(MOST_BYTES).read_to_end(&mut bytes).ok()?;
    postcard::from_bytes(&bytes).ok()
}

/// Whether the same run may succeed another time: also where a file is not what it was when its `key` was made.
fn may_pass(error: &RunError, model: &Model, key: Key) -> bool {
    error.may_pass() || !matches!(run_key(model), Ok(now) if now == key)
}

/// `model` cut to what a comparison needs: an impact that is compared with a reference ends with the window of the
/// comparison and what the filter needs behind it; any other run is complete. No snapshots are stored.
///
/// Up to there, its signals are those of the whole run bit for bit, but for the filtered channel close to the end.
pub(crate) fn cut(model: &Model, comparison: Option<&ReferenceComparison>) -> Model {
    let mut model = model.clone();
    model.output.frames = 0;
    let Some(ReferenceComparison { window: [_, end], .. }) = comparison else {
        return model;
    };
    if let Loading::Impact(Impact { duration, .. }) = &mut model.loading {
        let filter = model.output.filter.map_or(0.0, |class| SETTLING / class);
        *duration = duration.min(end + filter + SAMPLES / model.output.sample_rate);
    }
    model
}

/// The name of this build where it runs: its version, a digest of the sources, the compiler and the machine that it was
/// made for, and one of what the mathematical library of this machine answers. Equal names promise equal bits.
pub fn build_name() -> &'static str {
    static NAME: LazyLock<String> = LazyLock::new(|| name_of(&answers()));
    &NAME
}

fn name_of(answers: &[f64]) -> String {
    let bits: Vec<u8> = answers.iter().flat_map(|answer| answer.to_bits().to_le_bytes()).collect();
    let library = &Key::from_parts(&[&bits]).to_string()[..16];
    concat!(env!("CARGO_PKG_VERSION"), " ", env!("DROPTOWER_BUILD"), " ").to_owned() + library
}

/// Functions of one argument that the mathematical library of the machine computes.
const OF_ONE: [fn(f64) -> f64; 17] = [
    f64::exp,
    f64::exp2,
    f64::exp_m1,
    f64::ln,
    f64::ln_1p,
    f64::log2,
    f64::log10,
    f64::sin,
    f64::cos,
    f64::tan,
    f64::asin,
    f64::acos,
    f64::atan,
    f64::sinh,
    f64::cosh,
    f64::tanh,
    f64::cbrt,
];

/// Functions of two arguments.
const OF_TWO: [fn(f64, f64) -> f64; 3] = [f64::powf, f64::atan2, f64::hypot];

/// Number of arguments at which each function is asked.
const ARGUMENTS: u32 = 64;

/// Values of the functions at arguments that cover the unit interval, and some beyond it.
fn answers() -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    // Hidden from the compiler, which would else answer with the library of the machine that it runs on.
    let arguments = || (1..=ARGUMENTS).map(|number| black_box((f64::from(number) * GOLDEN).fract()));
    let of_one = |function: &fn(f64) -> f64| {
        let function = *black_box(function);
        arguments().flat_map(move |x| [x, 40.0 * x].map(function)).collect::<Vec<f64>>()
    };
    let of_two = |function: &fn(f64, f64) -> f64| {
        let function = *black_box(function);
        arguments().zip(arguments().skip(1)).map(move |(x, y)| function(x, 9.0 * y)).collect::<Vec<f64>>()
    };
    OF_ONE.iter().flat_map(of_one).chain(OF_TWO.iter().flat_map(of_two)).collect()
}

// Its `main` runs before the build.
#[cfg(test)]
#[allow(dead_code)]
#[path = "build.rs"]
mod build;

#[cfg(test)]
mod tests {
    use std::fs;

    use scene::model;
    use scene::scenario::{Assignment, Document};

    use super::*;

    /// A square of four elements, OBJ.
    const FILM: &str = "v -0.2 -0.2 0\nv 0 -0.2 0\nv 0.2 -0.2 0\nv -0.2 0 0\nv 0 0 0\nv 0.2 0 0\nv -0.2 0.2 0\n\
                    v 0 0.2 0\nv 0.2 0.2 0\nf 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\n";

    /// A model whose film is in the file `mesh`, with a scenario in `folder`.
    fn imported(folder: &Path, mesh: &Path) -> Model {
        let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        let path = folder.join("film.toml");
        fs::write(&path, format!("extends = {base:?}\n")).unwrap();
        let unset = ["reference", "post", "specimen.shape", "specimen.mesh"].map(|key| Assignment::unset(key, "test"));
        let shape = format!("specimen.shape.mesh={mesh:?}");
        let set = [shape.as_str(), "specimen.symmetry=none", "loading.impact.duration=1 ms"];
        let set = set.map(|text| Assignment::from_argument(text).unwrap());
        model::check(&Document::read(&path).unwrap().with(&unset).with(&set)).unwrap()
    }

    #[test]
    fn a_mesh_that_could_not_be_read_is_no_record() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("film.obj");
        fs::write(&mesh, FILM).unwrap();
        let model = imported(folder.path(), &mesh);
        let plan = Plan::prepare(&model).unwrap();
        let keys = Evaluations::keys(&model, &plan).unwrap();
        let evaluations = Evaluations::new(&folder.path().join("store"));
        let evaluate = || evaluations.evaluate(&model, &plan, keys, &Cancellation::default());
        fs::remove_file(&mesh).unwrap();
        let found = evaluate();
        assert!(matches!(&found, Err(EvaluationError::Passing(cause)) if cause.contains("no such file")), "{found:?}");
        assert_eq!(evaluations.record(keys).unwrap(), None);
        fs::write(&mesh, FILM).unwrap();
        assert_eq!(evaluate().unwrap().evaluation.failure, None);
    }

    #[test]
    fn what_decides_the_bits_is_digested_and_nothing_else() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let files: Vec<String> = build::sources(&root).unwrap().into_iter().map(|(name, _)| name).collect();
        for name in [
            "src/membrane/engine/cushion.rs",
            "src/membrane/material/viscous/point.rs",
            "src/scene/simulate/mod.rs",
            "src/lab/signal/filter.rs",
            "src/study/post/impact.rs",
            "src/study/evaluate.rs",
            "src/study/field_comparison/mod.rs",
            "scripts/droptower/film.rhai",
            "Cargo.lock",
        ] {
            assert!(files.iter().any(|file| file == name), "{name} is not in");
        }
        let is_other = |file: &&String| {
            let starts =
                ["src/cli", "src/report", "src/picture", "src/plot", "src/study/sweep", "src/study/store", "viz"];
            starts.iter().any(|start| file.starts_with(start)) || file.contains("tests")
        };
        assert_eq!(files.iter().find(is_other), None);
    }

    #[test]
    fn another_mathematical_library_is_another_build() {
        let mut answers = answers();
        assert_eq!(name_of(&answers), build_name());
        assert!(answers.iter().filter(|answer| answer.is_finite()).count() > answers.len() / 2);
        let last = answers.last_mut().unwrap();
        *last = f64::from_bits(last.to_bits() + 1);
        assert_ne!(name_of(&answers), build_name());
    }
}
