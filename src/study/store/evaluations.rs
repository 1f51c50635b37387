//! Records of evaluations and whole runs by their content, in a folder that any number of processes share, also over a network.
//!
//! Each is a file under its key: `<store>/<build>/records/ab/KEY.record`. It is written beside and renamed, so a reader finds
//! all of it or nothing. A process that is about to compute an evaluation creates the claim under its key, which only one can. It
//! touches its claims while it holds them, and locks them, by which others of its machine see that it lives. The claim of a
//! killed process ends at once on its machine, and on others once it is old by their clock. Where two processes nevertheless
//! compute the same (clocks differ, or both remove the claim of a killed one), both records hold the same.

use std::collections::HashMap;
use std::fmt;
use std::fs::{self, DirEntry, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant, SystemTime};

use serde::Serialize;
use sha2::{Digest as _, Sha256};

use base::file::{self, FileError};
use base::scratch;

/// Age from which a claim does not hold any more.
const STALE: Duration = Duration::from_secs(15);

/// Time between two touches of the claims of a process that is at work.
pub const HEARTBEAT: Duration = Duration::from_secs(2);

/// Age that a file must have to be removed: a process may be using it.
const STILL: Duration = Duration::from_secs(60);

/// Most bytes of a file.
const MOST: u64 = 1 << 30;

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

/// The kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An evaluation.
    Record,
    /// A run that is kept whole.
    Run,
    /// Why an evaluation failed last, for a cause that may pass.
    Refusal,
    /// A process computes the evaluation.
    Claim,
}

impl Kind {
    const ALL: [Kind; 4] = [Kind::Record, Kind::Run, Kind::Refusal, Kind::Claim];

    /// The folder of its files, and their extension.
    fn names(self) -> [&'static str; 2] {
        match self {
            Kind::Record => ["records", "record"],
            Kind::Run => ["runs", "run"],
            Kind::Refusal => ["refusals", "refusal"],
            Kind::Claim => ["claims", "claim"],
        }
    }
}

/// A store of evaluations.
#[derive(Debug)]
pub struct EvaluationStore {
    folder: PathBuf,
    build: String,
    claims: Mutex<Claims>,
    /// Records that this process has added.
    added: AtomicUsize,
}

/// The claims of this process.
#[derive(Debug)]
struct Claims {
    held: HashMap<Key, File>,
    /// When they were last touched.
    touched: Instant,
}

/// A claim of this process on an evaluation. It ends when it is dropped, however its thread ends: nobody would compute what
/// others wait for.
#[derive(Debug)]
#[must_use]
pub struct Claim<'a> {
    store: &'a EvaluationStore,
    key: Key,
}

impl Claim<'_> {
    /// Ends the claim of an evaluation that failed for a `cause` that may pass: others need not wait for it, and may
    /// try again.
    ///
    /// # Errors
    /// The cause cannot be written.
    pub fn refuse(self, cause: &str) -> io::Result<()> {
        self.store.write(Kind::Refusal, self.key, cause.as_bytes())
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        let held = self.store.claims().held.remove(&self.key);
        // One that cannot be removed ends with its lock, and on other machines with its age.
        let _ = fs::remove_file(self.store.path(Kind::Claim, self.key));
        drop(held);
    }
}

/// The figures of what one build has stored, for `droptower store list`.
#[derive(Clone, Debug, Serialize)]
pub struct BuildFigures {
    /// Their folder.
    pub path: PathBuf,
    /// Build of droptower that computed them.
    pub build: String,
    /// Records.
    pub evaluations: usize,
    /// Their size, bytes.
    pub bytes: u64,
    /// Runs that are kept whole.
    pub runs: usize,
    /// Their size, bytes.
    pub run_bytes: u64,
    /// Time since something was last added, s.
    pub age_s: f64,
}

/// Numbers of records after `droptower store prune`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pruned {
    /// Removed.
    pub removed: usize,
    /// All others.
    pub left: usize,
    /// Of the others, those that were to be removed and may be in use.
    pub spared: usize,
}

impl EvaluationStore {
    /// The store in `folder`, which need not exist, of what this `build` of droptower computes. Nothing is read yet.
    pub fn new(folder: &Path, build: &str) -> EvaluationStore {
        let claims = Mutex::new(Claims { held: HashMap::new(), touched: Instant::now() });
        EvaluationStore { folder: folder.into(), build: build.into(), claims, added: AtomicUsize::new(0) }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether there is a record under `key`.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn contains(&self, key: Key) -> io::Result<bool> {
        Ok(self.read(Kind::Record, key)?.is_some())
    }

    /// Number of records of other processes, now or before. All names are read for it.
    ///
    /// # Errors
    /// A folder cannot be read.
    pub fn others(&self) -> io::Result<usize> {
        // Fewer where the same was computed twice.
        let added = self.added.load(Ordering::Relaxed);
        Ok(files(&self.folder.join(&self.build), Kind::Record)?.len().saturating_sub(added))
    }

    /// Why the evaluation under `key`, of which there is no record, failed last for a cause that may pass.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn refusal(&self, key: Key) -> io::Result<Option<String>> {
        if self.contains(key)? {
            return Ok(None);
        }
        let cause = self.read(Kind::Refusal, key)?;
        Ok(cause.map(|cause| String::from_utf8_lossy(&cause).into_owned()))
    }

    /// Claims an evaluation for a thread of this process; none where another thread or another process computes it. The
    /// evaluation may have been added since the last look.
    ///
    /// # Errors
    /// The claim cannot be written.
    pub fn claim(&self, key: Key) -> io::Result<Option<Claim<'_>>> {
        let path = self.new_path(Kind::Claim, key)?;
        match is_held(&path)? {
            Some(true) => return Ok(None),
            Some(false) => file::remove(&path)?,
            None => {}
        }
        // Locked before others see it.
        let mut draft = scratch::file(path.parent().unwrap_or(&self.folder))?;
        draft.write_all(scratch::boot().as_bytes())?;
        match draft.persist_noclobber(&path) {
            Ok(file) => {
                self.claims().held.insert(key, file);
                Ok(Some(Claim { store: self, key }))
            }
            Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(None),
            Err(error) => Err(error.error),
        }
    }

    /// Shows other processes that this one is at work, where it has not shown it lately.
    ///
    /// # Errors
    /// A claim cannot be touched.
    pub fn keep_alive(&self) -> io::Result<()> {
        let mut claims = self.claims();
        if claims.touched.elapsed() < HEARTBEAT {
            return Ok(());
        }
        claims.touched = Instant::now();
        claims.held.values().try_for_each(|claim| claim.set_modified(SystemTime::now()))
    }

    /// What each build has stored in a folder.
    ///
    /// # Errors
    /// The folder, or something in it, cannot be read.
    pub fn list(folder: &Path) -> io::Result<Vec<BuildFigures>> {
        let mut found = Vec::new();
        for (build, path) in builds(folder)? {
            let [records, runs] = [files(&path, Kind::Record)?, files(&path, Kind::Run)?];
            let bytes = |files: &[StoredFile]| files.iter().map(|file| file.bytes).sum();
            let Some(age) = records.iter().chain(&runs).map(|file| file.age).min() else { continue };
            found.push(BuildFigures {
                path,
                build,
                evaluations: records.len(),
                bytes: bytes(&records),
                runs: runs.len(),
                run_bytes: bytes(&runs),
                age_s: age.as_secs_f64(),
            });
        }
        Ok(found)
    }

    /// Removes the files that `is_wanted` selects by their build and age, but those of the last minute.
    ///
    /// # Errors
    /// Something cannot be read or removed.
    pub fn prune(folder: &Path, is_wanted: impl Fn(&str, Duration) -> bool) -> io::Result<Pruned> {
        let mut pruned = Pruned::default();
        for (build, path) in builds(folder)? {
            let mut is_empty = true;
            for kind in Kind::ALL {
                for StoredFile { path, age, .. } in files(&path, kind)? {
                    let count = usize::from(kind == Kind::Record);
                    let is_wanted = is_wanted(&build, age);
                    if is_wanted && age > STILL {
                        file::remove(&path)?;
                        pruned.removed += count;
                        continue;
                    }
                    pruned.left += count;
                    pruned.spared += if is_wanted { count } else { 0 };
                    is_empty = false;
                }
            }
            if is_empty {
                // A process that writes there again makes it anew.
                fs::remove_dir_all(path)?;
            }
        }
        Ok(pruned)
    }

    fn path(&self, kind: Kind, key: Key) -> PathBuf {
        let (name, [folder, extension]) = (key.to_string(), kind.names());
        self.folder.join(&self.build).join(folder).join(&name[..2]).join(format!("{name}.{extension}"))
    }

    /// The path of a file whose folder exists.
    fn new_path(&self, kind: Kind, key: Key) -> io::Result<PathBuf> {
        create_folder(&self.folder)?;
        let path = self.path(kind, key);
        let mut folders: Vec<&Path> = path.ancestors().skip(1).take(3).collect();
        folders.reverse();
        folders.into_iter().try_for_each(file::own_folder)?;
        Ok(path)
    }

    /// Keeps a file of this kind under `key`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, kind: Kind, key: Key, content: &[u8]) -> io::Result<()> {
        let path = self.new_path(kind, key)?;
        file::replace(&path, &[&file::checksum(content).to_le_bytes(), content].concat())?;
        self.added.fetch_add(usize::from(kind == Kind::Record), Ordering::Relaxed);
        Ok(())
    }

    /// The file of this kind under `key`; none where there is none, or a damaged one.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(&self, kind: Kind, key: Key) -> io::Result<Option<Vec<u8>>> {
        let content = match file::read(&self.path(kind, key), MOST) {
            Ok(content) => content,
            Err(FileError::Io(error)) => return Err(error),
            Err(_) => return Ok(None),
        };
        let Some((checksum, rest)) = content.split_first_chunk::<4>() else { return Ok(None) };
        Ok((file::checksum(rest) == u32::from_le_bytes(*checksum)).then(|| rest.to_vec()))
    }

    fn claims(&self) -> MutexGuard<'_, Claims> {
        // Every change is complete before the next statement that may panic.
        base::lock(&self.claims)
    }
}

/// Whether the claim at `path` holds; none where there is none.
fn is_held(path: &Path) -> io::Result<Option<bool>> {
    let mut file = match file::open(path) {
        Ok(file) => file,
        Err(FileError::NotFound) => return Ok(None),
        Err(error) => return Err(io::Error::other(error)),
    };
    // By the clocks of two machines, which may differ: at worst a run is computed twice.
    let age = file.metadata()?.modified()?.elapsed().unwrap_or_else(|ahead| ahead.duration());
    let mut boot = Vec::new();
    (&mut file).take(64).read_to_end(&mut boot)?;
    // Of this machine, the lock of a process that was killed is gone. Where files cannot be locked, its age decides.
    let has_ended = boot == scratch::boot().as_bytes() && file.try_lock_shared().is_ok();
    Ok(Some(age < STALE && !has_ended))
}

/// A file of a store.
struct StoredFile {
    path: PathBuf,
    bytes: u64,
    age: Duration,
}

/// The builds of a folder, by name, and where what they have stored is.
fn builds(folder: &Path) -> io::Result<Vec<(String, PathBuf)>> {
    let is_build = |path: &Path| Kind::ALL.iter().any(|kind| path.join(kind.names()[0]).is_dir());
    let named = |entry: DirEntry| Some((entry.file_name().into_string().ok()?, entry.path()));
    let mut found: Vec<_> = entries(folder)?.into_iter().filter_map(named).filter(|(_, path)| is_build(path)).collect();
    found.sort();
    Ok(found)
}

/// The files of this kind of one build.
fn files(build: &Path, kind: Kind) -> io::Result<Vec<StoredFile>> {
    let [folder, extension] = kind.names();
    let mut found = Vec::new();
    for part in entries(&build.join(folder))?.into_iter().map(|part| part.path()).filter(|part| part.is_dir()) {
        for entry in entries(&part)? {
            let path = entry.path();
            if path.extension().is_none_or(|own| own != extension) {
                continue;
            }
            // Another process may have removed it.
            let Ok(about) = entry.metadata() else { continue };
            let age = about.modified()?.elapsed().unwrap_or_default();
            found.push(StoredFile { path, bytes: about.len(), age });
        }
    }
    Ok(found)
}

/// The entries of a folder; none where there is none.
fn entries(folder: &Path) -> io::Result<Vec<DirEntry>> {
    match fs::read_dir(folder) {
        Ok(entries) => entries.collect(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(vec![]),
        Err(error) => Err(error),
    }
}

/// The part of the runs of a study that a process takes first: of every `of` runs that numbered `number`, from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Which part, from one.
    pub number: usize,
    /// Number of parts.
    pub of: usize,
}

impl Share {
    /// The whole.
    pub const WHOLE: Share = Share { number: 1, of: 1 };

    /// Reads `3/16`.
    pub fn parse(text: &str) -> Option<Share> {
        let (number, of) = text.split_once('/')?;
        let share = Share { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? };
        (1..=share.of).contains(&share.number).then_some(share)
    }

    /// The places of `count` runs in the order in which the process with this share takes them: its own, then those of
    /// the others from the last one on, which they take last. Neighbours are taken far apart, so that those that are
    /// done tell how long the rest takes: the runs of a grid become longer from one end to the other.
    pub fn order(self, count: usize) -> Vec<usize> {
        let all = scattered(count);
        let own = all.iter().filter(|place| self.has(**place));
        let others = all.iter().rev().filter(|place| !self.has(**place));
        own.chain(others).copied().collect()
    }

    fn has(&self, place: usize) -> bool {
        place % self.of == self.number - 1
    }
}

/// The places of `count` runs, each once, in steps of the golden section, which cover them evenly at any time.
fn scattered(count: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let nearest = (GOLDEN * count as f64).round() as usize;
    let step = (nearest.max(1)..).find(|step| gcd(*step, count) == 1).unwrap_or(1);
    (0..count).map(|turn| turn * step % count).collect()
}

fn gcd(one: usize, other: usize) -> usize {
    if other == 0 { one } else { gcd(other, one % other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(number: u8) -> Key {
        Key([number; 16])
    }

    fn open(folder: &Path) -> EvaluationStore {
        EvaluationStore::new(folder, "1")
    }

    /// Makes a file older.
    fn age(path: &Path, age: Duration) {
        let file = fs::OpenOptions::new().append(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn records_are_read_back_by_the_same_build_only() {
        let folder = tempfile::tempdir().unwrap();
        let store = open(folder.path());
        assert!(!store.contains(key(1)).unwrap());
        assert!(entries(folder.path()).unwrap().is_empty(), "a store that is only read leaves nothing");
        store.write(Kind::Record, key(1), b"one").unwrap();
        store.write(Kind::Record, key(2), b"").unwrap();
        assert_eq!(store.read(Kind::Record, key(1)).unwrap().as_deref(), Some(&b"one"[..]));
        assert_eq!(store.others().unwrap(), 0);
        let again = open(folder.path());
        assert_eq!(again.others().unwrap(), 2);
        assert_eq!(again.read(Kind::Record, key(2)).unwrap().as_deref(), Some(&b""[..]));
        assert_eq!(again.read(Kind::Record, key(3)).unwrap(), None);
        assert!(!EvaluationStore::new(folder.path(), "2").contains(key(1)).unwrap());
        // What is added later is seen at once.
        again.write(Kind::Record, key(7), b"later").unwrap();
        assert_eq!(store.read(Kind::Record, key(7)).unwrap().as_deref(), Some(&b"later"[..]));
        assert_eq!(store.others().unwrap(), 1);
    }

    #[test]
    fn a_damaged_record_is_none_and_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let store = open(folder.path());
        store.write(Kind::Record, key(1), b"whole").unwrap();
        let path = store.path(Kind::Record, key(1));
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(!store.contains(key(1)).unwrap(), "{length} bytes");
        }
        let last = whole.len() - 1;
        fs::write(&path, [&whole[..last], &[whole[last] ^ 1]].concat()).unwrap();
        assert!(!store.contains(key(1)).unwrap());
        store.write(Kind::Record, key(1), b"whole").unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole);
    }

    /// Whether the store claims the evaluation; the claim is held, as by a process that is at work.
    fn claims(store: &EvaluationStore, key: Key) -> bool {
        store.claim(key).unwrap().map(std::mem::forget).is_some()
    }

    /// However a thread ends, nobody waits for what it does not compute any more.
    #[test]
    fn a_dropped_claim_ends() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = [open(folder.path()), open(folder.path())];
        let claim = one.claim(key(1)).unwrap();
        assert!(claim.is_some() && !claims(&one, key(1)) && !claims(&other, key(1)) && claims(&other, key(3)));
        drop(claim);
        assert!(!one.path(Kind::Claim, key(1)).exists() && claims(&other, key(1)));
    }

    #[test]
    fn a_refusal_is_told_and_may_pass() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = [open(folder.path()), open(folder.path())];
        for cause in ["too slow", "too slow again"] {
            one.claim(key(1)).unwrap().unwrap().refuse(cause).unwrap();
            for store in [&one, &other] {
                assert_eq!(store.refusal(key(1)).unwrap().as_deref(), Some(cause));
                assert!(!store.contains(key(1)).unwrap());
            }
        }
        assert!(claims(&other, key(1)));
        other.write(Kind::Record, key(1), b"done").unwrap();
        assert_eq!(one.refusal(key(1)).unwrap(), None);
    }

    #[test]
    fn of_claims_at_the_same_moment_one_stands() {
        const PROCESSES: usize = 3;
        const EVALUATIONS: u16 = 600;
        let evaluation = |number: u16| Key(std::array::from_fn(|place| number.to_le_bytes()[place % 2]));
        let folder = tempfile::tempdir().unwrap();
        let start = std::sync::Barrier::new(PROCESSES);
        let process = || {
            let store = open(folder.path());
            let claimed = |number: &u16| {
                start.wait();
                store.claim(evaluation(*number)).unwrap().map(std::mem::forget).is_some()
            };
            let claimed: Vec<u16> = (0..EVALUATIONS).filter(claimed).collect();
            // Claims end with their process.
            (claimed, store)
        };
        let ended = std::thread::scope(|scope| {
            let processes = [(); PROCESSES].map(|()| scope.spawn(process));
            processes.map(|process| process.join().unwrap())
        });
        let mut standing: Vec<u16> = ended.iter().flat_map(|(claimed, _)| claimed).copied().collect();
        standing.sort_unstable();
        assert_eq!(standing, (0..EVALUATIONS).collect::<Vec<u16>>());
    }

    #[test]
    fn an_old_claim_does_not_hold_unless_its_process_touches_it() {
        let folder = tempfile::tempdir().unwrap();
        let [silent, other] = [open(folder.path()), open(folder.path())];
        assert!(claims(&silent, key(1)));
        let path = silent.path(Kind::Claim, key(1));
        // Also one of a clock that is far ahead.
        for clock in [SystemTime::now() - 2 * STALE, SystemTime::now() + 2 * STALE] {
            File::options().append(true).open(&path).unwrap().set_modified(clock).unwrap();
            assert_eq!(is_held(&path).unwrap(), Some(false));
        }
        silent.claims().touched -= HEARTBEAT;
        silent.keep_alive().unwrap();
        assert!(!claims(&other, key(1)));
        age(&path, 2 * STALE);
        assert!(claims(&other, key(1)) && !claims(&silent, key(1)));
    }

    /// The lock of a killed process is gone, whatever the age of its claims.
    #[cfg(target_os = "linux")]
    #[test]
    fn claims_of_a_killed_process_of_this_machine_do_not_hold() {
        let folder = tempfile::tempdir().unwrap();
        let [killed, other] = [open(folder.path()), open(folder.path())];
        assert!(claims(&killed, key(1)) && !claims(&other, key(1)));
        drop(killed);
        assert!(claims(&other, key(1)));
    }

    #[test]
    fn builds_are_listed_and_old_files_removed() {
        let folder = tempfile::tempdir().unwrap();
        let [store, former] = ["1", "0"].map(|build| EvaluationStore::new(folder.path(), build));
        // Figures are kept under another key than the run that a script made them of.
        store.write(Kind::Record, key(5), b"figures").unwrap();
        store.write(Kind::Run, key(1), b"signals").unwrap();
        former.write(Kind::Record, key(5), b"figures").unwrap();
        assert_eq!(store.read(Kind::Run, key(1)).unwrap().as_deref(), Some(&b"signals"[..]));
        let listed = EvaluationStore::list(folder.path()).unwrap();
        let shown: Vec<_> = listed.iter().map(|own| (own.build.as_str(), own.evaluations, own.runs)).collect();
        assert_eq!(shown, [("0", 1, 0), ("1", 1, 1)]);
        assert_eq!((listed[1].bytes, listed[1].run_bytes), (11, 11));
        let prune = |build| EvaluationStore::prune(folder.path(), |own, _| own == build).unwrap();
        assert_eq!(prune("0"), Pruned { removed: 0, left: 2, spared: 1 });
        age(&former.path(Kind::Record, key(5)), 2 * STILL);
        assert_eq!(prune("0"), Pruned { removed: 1, left: 1, spared: 0 });
        assert!(!folder.path().join("0").exists() && store.contains(key(5)).unwrap());
    }

    #[test]
    fn shares_are_read_and_refused() {
        assert_eq!(Share::parse("3/16"), Some(Share { number: 3, of: 16 }));
        for text in ["0/4", "5/4", "3", "a/b", "1/0", "-1/2", ""] {
            assert_eq!(Share::parse(text), None, "{text}");
        }
    }

    /// The mean of any first part of a ramp is near that of the whole.
    #[test]
    fn what_is_done_tells_how_long_the_rest_takes() {
        for count in [50, 64, 200, 1000, 9973] {
            let order = Share::WHOLE.order(count);
            for part in [count / 10, count / 4, count / 2] {
                let mean = order[..part].iter().sum::<usize>() as f64 / part as f64;
                let of_all = (count - 1) as f64 / 2.0;
                assert!((mean / of_all - 1.0).abs() < 0.3, "{count} {part}: {}", mean / of_all);
            }
        }
    }

    #[test]
    fn all_runs_are_in_every_order_and_own_ones_first() {
        assert_eq!(Share::WHOLE.order(8), [0, 5, 2, 7, 4, 1, 6, 3]);
        assert_eq!(Share { number: 2, of: 3 }.order(7), [4, 1, 3, 6, 2, 5, 0]);
        assert_eq!((Share::WHOLE.order(0), Share::WHOLE.order(1)), (vec![], vec![0]));
        for number in 1..=5 {
            let mut all = Share { number, of: 5 }.order(23);
            all.sort_unstable();
            assert!(all.into_iter().eq(0..23));
        }
    }
}
