//! Records of evaluations by their content, in a folder that any number of processes share, also over a network.
//!
//! Every process appends to a segment of its own, and reads those of the others: nothing is overwritten, and no process waits for
//! the lock of another. Each locks its own segment, by which others of its machine see that it lives. What a killed process leaves is complete up to its last record. A process that is about to compute an evaluation
//! claims it, looks whether another has claimed the same meanwhile, and says that it begins. A claim holds while the
//! segment of its process grows, by the clock of whoever asks: a killed process claims nothing for long. Where two
//! processes nevertheless compute the same (a network file system shows their entries late), both records hold the same.

mod segment;
mod share;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use serde::Serialize;
use sha2::{Digest as _, Sha256};

use base::file;
use segment::{Entry, Kind, OwnSegment, Segment};
pub use share::Share;

/// Time without growth after which the claims of a segment hold no longer.
const STALE: Duration = Duration::from_secs(15);

/// Time between two signs of life of a process that is at work.
pub const HEARTBEAT: Duration = Duration::from_secs(2);

/// Time between two looks at a claim that was made at the same time.
const LOOK_AGAIN: Duration = Duration::from_millis(1);

/// Extension of segments.
const SEGMENT: &str = "evaluations";

/// Folder of the runs that are kept whole.
const RUNS: &str = "runs";

/// Extension of a run that is kept whole.
const RUN: &str = "run";

/// Creates the folder of a store; in the path of the one that nobody named, no link is followed.
fn create_folder(folder: &Path) -> io::Result<()> {
    if folder == Path::new(super::EVALUATIONS) {
        let mut parts = folder.ancestors().filter(|part| !part.as_os_str().is_empty());
        parts.try_for_each(file::refuse_link)?;
    }
    fs::create_dir_all(folder)
}

/// The identity of an evaluation: a digest of all that decides its result.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(pub [u8; 16]);

impl Key {
    /// The digest of parts, each with its length.
    pub fn from_parts(parts: &[&[u8]]) -> Key {
        let mut digest = Sha256::new();
        for part in parts {
            digest.update((part.len() as u64).to_le_bytes());
            digest.update(part);
        }
        let mut key = [0; 16];
        key.copy_from_slice(&digest.finalize()[..16]);
        Key(key)
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Where a record is.
#[derive(Clone, Copy, Debug)]
struct Place {
    segment: u32,
    length: u32,
    offset: u64,
}

/// A store of evaluations.
#[derive(Debug)]
pub struct EvaluationStore {
    folder: PathBuf,
    build: String,
    state: Mutex<State>,
}

/// A claim of this process on an evaluation. It is given up when it is dropped, however its thread ends, unless the
/// evaluation was added: nobody would compute what others wait for.
#[derive(Debug)]
#[must_use]
pub struct OwnClaim<'a> {
    store: &'a EvaluationStore,
    key: Key,
}

impl OwnClaim<'_> {
    /// Gives up the claim: the evaluation is kept otherwise, or was not finished.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn release(self) -> io::Result<()> {
        self.store.end(self.key, Kind::Released, &[])
    }

    /// Gives up the claim of an evaluation that failed for a `cause` that may pass: others need not wait for it, and may
    /// try again.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn refuse(self, cause: &str) -> io::Result<()> {
        self.store.end(self.key, Kind::Refused, cause.as_bytes())
    }
}

impl Drop for OwnClaim<'_> {
    fn drop(&mut self) {
        let is_held = self.store.state().under_way.contains(&self.key);
        if is_held {
            // What cannot be written leaves a claim that ends with the process.
            let _ = self.store.end(self.key, Kind::Released, &[]);
        }
    }
}

/// A claim of another process.
#[derive(Clone, Copy, Debug)]
struct Claim {
    segment: u32,
    /// Whether its process has seen no other claim that it yields to.
    has_begun: bool,
}

/// The fate of a claim; of several rivals, the last of these counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// This process computes the evaluation.
    Stands,
    /// Another one has claimed it at the same time and is about to see that it yields, or to begin.
    Open,
    /// Another one computes it.
    Yields,
}

#[derive(Debug, Default)]
struct State {
    segments: Vec<Segment>,
    index: HashMap<Key, Place>,
    /// Claims of other processes.
    claims: HashMap<Key, Vec<Claim>>,
    /// Evaluations that failed for causes that may pass, and have no record yet.
    refusals: HashMap<Key, Place>,
    /// Claims of this process.
    under_way: HashSet<Key>,
    own: Option<OwnSegment>,
    /// Records that other processes wrote.
    others: usize,
    /// Names of segments that are known, or that are none.
    known: HashSet<PathBuf>,
}

/// The figures of a segment for `droptower store list`.
#[derive(Clone, Debug, Serialize)]
pub struct SegmentFigures {
    /// The file.
    pub path: PathBuf,
    /// Build of droptower that wrote it; none of a damaged segment.
    pub build: Option<String>,
    /// Records.
    pub evaluations: usize,
    /// Size, bytes.
    pub bytes: u64,
    /// Runs that are kept whole beside it.
    pub runs: usize,
    /// Their size, bytes.
    pub run_bytes: u64,
    /// Time since it last grew, s.
    pub age_s: f64,
}

impl EvaluationStore {
    /// The store in `folder`, which need not exist, of what this `build` of droptower computes.
    ///
    /// # Errors
    /// The folder or a segment in it cannot be read.
    pub fn open(folder: &Path, build: &str) -> io::Result<EvaluationStore> {
        let store = EvaluationStore::without_loading(folder, build);
        store.refresh()?;
        Ok(store)
    }

    /// The store in `folder`, of which nothing is read before it is refreshed.
    pub fn without_loading(folder: &Path, build: &str) -> EvaluationStore {
        EvaluationStore { folder: folder.into(), build: build.into(), state: Mutex::default() }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Reads what other processes have added.
    ///
    /// # Errors
    /// The folder or a segment in it cannot be read.
    pub fn refresh(&self) -> io::Result<()> {
        let mut state = self.state();
        for path in segments(&self.folder)? {
            if state.known.insert(path.clone())
                && let Some(segment) = Segment::open(&path, &self.build)?
            {
                state.segments.push(segment);
            }
        }
        (0..state.segments.len()).try_for_each(|place| state.follow(place))
    }

    /// The record under `key`.
    ///
    /// # Errors
    /// Its segment cannot be read.
    pub fn get(&self, key: Key) -> io::Result<Option<Vec<u8>>> {
        let mut state = self.state();
        let Some(place) = state.index.get(&key).copied() else { return Ok(None) };
        let Some(segment) = state.segments.get_mut(place.segment as usize) else { return Ok(None) };
        segment.read(place.offset, place.length).map(Some)
    }

    /// Whether there is a record under `key`.
    pub fn contains(&self, key: Key) -> bool {
        self.state().index.contains_key(&key)
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.state().index.len()
    }

    /// Number of records that other processes have written, now or before.
    pub fn others(&self) -> usize {
        self.state().others
    }

    /// Whether there are no records.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a record.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn put(&self, key: Key, record: &[u8]) -> io::Result<()> {
        self.append(Kind::Record, key, record)?;
        self.state().under_way.remove(&key);
        Ok(())
    }

    /// Why the evaluation under `key`, of which there is no record, failed last for a cause that may pass.
    ///
    /// # Errors
    /// Its segment cannot be read.
    pub fn refusal(&self, key: Key) -> io::Result<Option<String>> {
        let mut state = self.state();
        let Some(Place { segment, offset, length }) = state.refusals.get(&key).copied() else {
            return Ok(None);
        };
        let Some(segment) = state.segments.get_mut(segment as usize) else { return Ok(None) };
        segment.read(offset, length).map(|cause| Some(String::from_utf8_lossy(&cause).into_owned()))
    }

    /// Claims an evaluation for a thread of this process; none where another thread or another process computes it.
    ///
    /// # Errors
    /// The claim cannot be written.
    pub fn claim(&self, key: Key) -> io::Result<Option<OwnClaim<'_>>> {
        // The lock is not held while the claim is written, so that threads with other keys go on.
        {
            let mut state = self.state();
            if state.rivals(key).next().is_some() || !state.under_way.insert(key) {
                return Ok(None);
            }
        }
        let claim = OwnClaim { store: self, key };
        self.append(Kind::Claim, key, &[])?;
        // Another process may have done the same at the same time. Of the claims that have not begun, the one in the first
        // segment stands once the others have yielded; they do not wait for it, so that none waits for long.
        loop {
            self.refresh()?;
            let verdict = self.state().verdict(key);
            match verdict {
                Verdict::Stands => break,
                Verdict::Yields => return claim.release().map(|()| None),
                Verdict::Open => thread::sleep(LOOK_AGAIN),
            }
        }
        self.append(Kind::Begun, key, &[])?;
        Ok(Some(claim))
    }

    /// Ends a claim of this process by an entry of this `kind`.
    fn end(&self, key: Key, kind: Kind, content: &[u8]) -> io::Result<()> {
        // First: should it not be written, no thread of this process waits for it.
        self.state().under_way.remove(&key);
        self.append(kind, key, content)
    }

    /// Shows other processes that this one is at work, where it has claims and has not shown it lately.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep_alive(&self) -> io::Result<()> {
        let is_due = self.state().own.as_ref().is_some_and(|own| own.written.elapsed() >= HEARTBEAT);
        if is_due { self.append(Kind::Alive, Key([0; 16]), &[]) } else { Ok(()) }
    }

    /// Gives up the claims of this process: nothing that it has not added will be.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn close(&self) -> io::Result<()> {
        let has_claims = self.state().own.is_some();
        if has_claims { self.append(Kind::Closed, Key([0; 16]), &[]) } else { Ok(()) }
    }

    /// Makes sure that what was added survives a failure of the machine.
    ///
    /// # Errors
    /// The segment cannot be written.
    pub fn sync(&self) -> io::Result<()> {
        self.state().own.as_ref().map_or(Ok(()), OwnSegment::sync)
    }

    /// Keeps a whole run under `key`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn put_run(&self, key: Key, content: &[u8]) -> io::Result<()> {
        // First, so that whoever removes the segment finds the run, however this process ends.
        self.append(Kind::Kept, key, &[])?;
        let path = self.run_path(key);
        let folder = path.parent().unwrap_or(&self.folder);
        file::own_folder(folder)?;
        file::replace(&path, &[&file::checksum(content).to_le_bytes(), content].concat())
    }

    /// The whole run kept under `key`; none where there is none, or a damaged one.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn run(&self, key: Key) -> io::Result<Option<Vec<u8>>> {
        let content = match fs::read(self.run_path(key)) {
            Ok(content) => content,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        let Some((checksum, rest)) = content.split_first_chunk::<4>() else { return Ok(None) };
        Ok((file::checksum(rest) == u32::from_le_bytes(*checksum)).then(|| rest.to_vec()))
    }

    /// The segments of a folder, of all builds.
    ///
    /// # Errors
    /// The folder or a segment cannot be read.
    pub fn list(folder: &Path) -> io::Result<Vec<SegmentFigures>> {
        segments(folder)?.into_iter().map(|path| Segment::figures(&path, |key| run_path(folder, key))).collect()
    }

    /// Removes the segment at `path` and the runs that its process keeps whole.
    ///
    /// # Errors
    /// Something cannot be removed.
    pub fn remove(folder: &Path, path: &Path) -> io::Result<()> {
        let mut keys = BTreeSet::new();
        if let Some(mut segment) = Segment::open_any(path)? {
            segment.follow(|entry| keys.extend((entry.kind == Kind::Kept).then_some(entry.key)))?;
        }
        for key in keys {
            match fs::remove_file(run_path(folder, key)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        fs::remove_file(path)
    }

    fn run_path(&self, key: Key) -> PathBuf {
        run_path(&self.folder, key)
    }

    fn append(&self, kind: Kind, key: Key, content: &[u8]) -> io::Result<()> {
        let mut state = self.state();
        if state.own.is_none() {
            create_folder(&self.folder)?;
            let own = OwnSegment::create(&self.folder, SEGMENT, &self.build)?;
            state.known.insert(own.path.clone());
            let segment = Segment::of_own(&own)?;
            state.segments.push(segment);
            state.own = Some(own);
        }
        let number = state.segments.len() as u32 - 1;
        let Some(own) = &mut state.own else { return Ok(()) };
        let offset = own.append(kind, key, content)?;
        let segment = own.number.get_or_insert(number);
        let place = Place { segment: *segment, length: content.len() as u32, offset };
        match kind {
            Kind::Record => {
                state.refusals.remove(&key);
                state.index.insert(key, place);
            }
            Kind::Refused => drop(state.refusals.insert(key, place)),
            _ => {}
        }
        Ok(())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Every change is complete before the next statement that may panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Takes in what a segment has gained.
    fn follow(&mut self, place: usize) -> io::Result<()> {
        let State { segments, index, claims, refusals, others, .. } = self;
        let number = place as u32;
        let Some(segment) = segments.get_mut(place) else { return Ok(()) };
        let (mut is_closed, mut machine) = (segment.is_closed, None);
        segment.follow(|Entry { kind, key, offset, length }| {
            is_closed = kind == Kind::Closed;
            match kind {
                Kind::Record => {
                    claims.remove(&key);
                    refusals.remove(&key);
                    index.entry(key).or_insert_with(|| {
                        *others += 1;
                        Place { segment: number, length, offset }
                    });
                }
                Kind::Claim | Kind::Begun => {
                    let all = claims.entry(key).or_default();
                    all.retain(|claim| claim.segment != number);
                    all.push(Claim { segment: number, has_begun: kind == Kind::Begun });
                }
                Kind::Released | Kind::Refused => {
                    if kind == Kind::Refused && !index.contains_key(&key) {
                        refusals.insert(key, Place { segment: number, length, offset });
                    }
                    if let Some(all) = claims.get_mut(&key) {
                        all.retain(|claim| claim.segment != number);
                    }
                }
                Kind::Closed => claims.retain(|_, all| {
                    all.retain(|claim| claim.segment != number);
                    !all.is_empty()
                }),
                Kind::Machine => machine = Some((offset, length)),
                Kind::Header | Kind::Alive | Kind::Kept => {}
            }
        })?;
        if let Some((offset, length)) = machine {
            let name = segment.read(offset, length)?;
            segment.set_machine(&name);
        }
        segment.is_closed = is_closed;
        Ok(())
    }

    /// The claims of other processes that still grow.
    fn rivals(&self, key: Key) -> impl Iterator<Item = (&Segment, bool)> {
        let claims = self.claims.get(&key).into_iter().flatten();
        let segment = |claim: &Claim| Some((self.segments.get(claim.segment as usize)?, claim.has_begun));
        claims.filter_map(segment).filter(|(segment, _)| segment.is_alive())
    }

    /// The fate of a claim that this process has just made.
    fn verdict(&self, key: Key) -> Verdict {
        let own = self.own.as_ref().map(|own| own.path.as_path());
        let of_rival = |(rival, has_begun): (&Segment, bool)| {
            if has_begun || own.is_some_and(|own| rival.is_before(own)) { Verdict::Yields } else { Verdict::Open }
        };
        self.rivals(key).map(of_rival).max().unwrap_or(Verdict::Stands)
    }
}

fn run_path(folder: &Path, key: Key) -> PathBuf {
    let name = key.to_string();
    folder.join(RUNS).join(&name[..2]).join(format!("{name}.{RUN}"))
}

/// The segments in a folder, by name; none where there is no folder.
fn segments(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(vec![]),
        Err(error) => return Err(error),
    };
    let paths = entries.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<Vec<_>>>()?;
    let mut found: Vec<PathBuf> =
        paths.into_iter().filter(|path| path.extension().is_some_and(|extension| extension == SEGMENT)).collect();
    found.sort();
    Ok(found)
}
