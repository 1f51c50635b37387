//! A segment: a file that one process appends records to and others read while it grows.
//!
//! After its first line come entries: length of the content, checksum of the rest, kind, key, content.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::{Key, STALE, SegmentFigures};
use base::file::{self, FileError};
use base::scratch;

/// The first line of a segment.
const MAGIC: &[u8] = b"droptower evaluations 01\n";

/// Bytes of an entry before its content: length and checksum, then kind and key, which the checksum covers.
const FRAME: usize = 8;
const LEAD: usize = FRAME + 17;

/// Most bytes of a content.
const MOST: u32 = 64 << 20;

/// The kind of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Build of droptower that writes the segment; its first entry.
    Header = 0,
    /// An evaluation.
    Record = 1,
    /// The process wants to compute an evaluation.
    Claim = 2,
    /// The process is at work.
    Alive = 3,
    /// The process has given up its claims.
    Closed = 4,
    /// The process has given up one claim.
    Released = 5,
    /// The process keeps a run whole beside its segment.
    Kept = 6,
    /// The process computes an evaluation that it has claimed: no other claim has begun, or stands before it.
    Begun = 7,
    /// The evaluation failed for a cause that may pass, which is the content; the process gives up its claim.
    Refused = 8,
    /// The machine of the process, since it was started.
    Machine = 9,
}

/// An entry of a segment, with the place of its content.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub kind: Kind,
    pub key: Key,
    pub offset: u64,
    pub length: u32,
}

/// A segment that is read.
#[derive(Debug)]
pub(super) struct Segment {
    pub path: PathBuf,
    file: File,
    /// End of the last complete entry.
    end: u64,
    /// Length of the file when it was last looked at; what a killed process leaves may end in an incomplete entry.
    length: u64,
    /// When it last grew; none of one that was old already.
    pub grown: Option<Instant>,
    /// Whether its process has given up its claims.
    pub is_closed: bool,
    /// Whether its process is one of this machine, which shows by a lock that it lives.
    is_local: bool,
}

/// The segment of this process.
#[derive(Debug)]
pub(super) struct OwnSegment {
    pub path: PathBuf,
    file: File,
    end: u64,
    /// Whether an entry that could not be written whole may stand behind the end.
    is_torn: bool,
    /// When it last grew.
    pub written: Instant,
    /// Its place among the segments.
    pub number: Option<u32>,
}

impl Kind {
    fn from_byte(byte: u8) -> Option<Kind> {
        use Kind::{Alive, Begun, Claim, Closed, Header, Kept, Machine, Record, Refused, Released};
        const ALL: [Kind; 10] = [Header, Record, Claim, Alive, Closed, Released, Kept, Begun, Refused, Machine];
        ALL.into_iter().find(|kind| *kind as u8 == byte)
    }
}

impl Segment {
    /// The segment at `path`; none where it is damaged or another build wrote it.
    pub(super) fn open(path: &Path, build: &str) -> io::Result<Option<Segment>> {
        let Some(mut segment) = Segment::open_any(path)? else { return Ok(None) };
        Ok((segment.build()?.as_deref() == Some(build)).then_some(segment))
    }

    /// The segment at `path`; none where it is damaged.
    pub(super) fn open_any(path: &Path) -> io::Result<Option<Segment>> {
        let mut file = match file::open(path) {
            Ok(file) => file,
            Err(FileError::NotAFile) => return Ok(None),
            Err(error) => return Err(io::Error::other(error)),
        };
        let mut start = Vec::new();
        (&mut file).take(MAGIC.len() as u64).read_to_end(&mut start)?;
        // By the clocks of two machines, which may differ: at worst a claim is taken for alive or dead a while too long.
        let about = file.metadata()?;
        let age = about.modified()?.elapsed().unwrap_or_default();
        let grown = Instant::now().checked_sub(age);
        let segment = Segment {
            path: path.into(),
            file,
            end: MAGIC.len() as u64,
            length: about.len(),
            grown,
            is_closed: false,
            is_local: false,
        };
        Ok((start == MAGIC).then_some(segment))
    }

    /// The segment of this process, of which nothing remains to be read.
    pub(super) fn of_own(own: &OwnSegment) -> io::Result<Segment> {
        let file = File::open(&own.path)?;
        let (path, end) = (own.path.clone(), u64::MAX);
        Ok(Segment { path, file, end, length: end, grown: None, is_closed: false, is_local: false })
    }

    /// Whether its claims hold.
    pub(super) fn is_alive(&self) -> bool {
        !self.is_closed && self.grown.is_some_and(|at| at.elapsed() < STALE) && !self.has_ended()
    }

    /// Whether its process was one of this machine and lives no longer, which another machine learns by its silence alone.
    fn has_ended(&self) -> bool {
        let ended = self.is_local && self.file.try_lock_shared().is_ok();
        if ended {
            // Whatever becomes of the lock, nobody waits for it.
            let _ = self.file.unlock();
        }
        ended
    }

    /// Takes note of the machine of its process.
    pub(super) fn set_machine(&mut self, machine: &[u8]) {
        self.is_local = machine == scratch::boot().as_bytes();
    }

    /// Whether it comes before the segment at `path`: of two claims that were made at once and have not begun, that of the
    /// first segment stands.
    pub(super) fn is_before(&self, path: &Path) -> bool {
        self.path.file_name() < path.file_name()
    }

    /// The figures of the segment at `path`, whose runs that are kept whole are at `run_path`.
    pub(super) fn figures(path: &Path, run_path: impl Fn(Key) -> PathBuf) -> io::Result<SegmentFigures> {
        let about = std::fs::metadata(path)?;
        let age = about.modified()?.elapsed().unwrap_or_default();
        let (mut build, mut evaluations, mut run_bytes) = (None, 0, vec![]);
        if let Some(mut segment) = Segment::open_any(path)? {
            build = segment.build()?;
            segment.follow(|Entry { kind, key, .. }| match kind {
                Kind::Record => evaluations += 1,
                Kind::Kept => run_bytes.extend(std::fs::metadata(run_path(key)).map(|about| about.len())),
                _ => {}
            })?;
        }
        Ok(SegmentFigures {
            path: path.into(),
            build,
            evaluations,
            bytes: about.len(),
            runs: run_bytes.len(),
            run_bytes: run_bytes.iter().sum(),
            age_s: age.as_secs_f64(),
        })
    }

    /// The build in its first entry.
    fn build(&mut self) -> io::Result<Option<String>> {
        self.file.seek(SeekFrom::Start(self.end))?;
        let first = next(&mut &self.file, self.end, self.length, &mut Vec::new())?;
        let Some(Entry { kind: Kind::Header, offset, length, .. }) = first else { return Ok(None) };
        Ok(String::from_utf8(self.read(offset, length)?).ok())
    }

    /// The content at a place.
    pub(super) fn read(&mut self, offset: u64, length: u32) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(offset))?;
        let mut content = vec![0; length as usize];
        self.file.read_exact(&mut content)?;
        Ok(content)
    }

    /// Gives the entries that were added. One that is not complete is looked for again the next time.
    pub(super) fn follow(&mut self, mut take: impl FnMut(Entry)) -> io::Result<()> {
        let length = self.file.metadata()?.len();
        if length <= self.end {
            return Ok(());
        }
        self.file.seek(SeekFrom::Start(self.end))?;
        let mut reader = io::BufReader::with_capacity(1 << 20, &self.file);
        let mut content = Vec::new();
        while let Some(entry) = next(&mut reader, self.end, length, &mut content)? {
            self.end = entry.offset + u64::from(entry.length);
            take(entry);
        }
        if length > self.length {
            self.length = length;
            self.grown = Some(Instant::now());
        }
        Ok(())
    }
}

/// The entry at `start` of a file of this length; none where it is not complete.
fn next(reader: &mut impl Read, start: u64, length: u64, content: &mut Vec<u8>) -> io::Result<Option<Entry>> {
    if length.saturating_sub(start) < LEAD as u64 {
        return Ok(None);
    }
    let mut lead = [0; LEAD];
    reader.read_exact(&mut lead)?;
    let word = |at: usize| u32::from_le_bytes([lead[at], lead[at + 1], lead[at + 2], lead[at + 3]]);
    let (size, checksum) = (word(0), word(4));
    let offset = start + LEAD as u64;
    if size > MOST || length - offset < u64::from(size) {
        return Ok(None);
    }
    content.clear();
    content.extend_from_slice(&lead[FRAME..]);
    content.resize(LEAD - FRAME + size as usize, 0);
    reader.read_exact(&mut content[LEAD - FRAME..])?;
    let mut key = [0; 16];
    key.copy_from_slice(&lead[FRAME + 1..]);
    let kind = Kind::from_byte(lead[FRAME]).filter(|_| file::checksum(content) == checksum);
    Ok(kind.map(|kind| Entry { kind, key: Key(key), offset, length: size }))
}

/// An entry as it is written.
fn entry(kind: Kind, key: Key, content: &[u8]) -> io::Result<Vec<u8>> {
    let size = u32::try_from(content.len()).ok().filter(|size| *size <= MOST);
    let size = size.ok_or_else(|| io::Error::other("an evaluation is too large to be kept"))?;
    let mut entry = Vec::with_capacity(LEAD + content.len());
    entry.extend_from_slice(&[0; FRAME]);
    entry.push(kind as u8);
    entry.extend_from_slice(&key.0);
    entry.extend_from_slice(content);
    let checksum = file::checksum(&entry[FRAME..]);
    entry[..4].copy_from_slice(&size.to_le_bytes());
    entry[4..FRAME].copy_from_slice(&checksum.to_le_bytes());
    Ok(entry)
}

impl OwnSegment {
    /// A new segment in `folder`, which has its header by the time that others see it.
    pub(super) fn create(folder: &Path, extension: &str, build: &str) -> io::Result<OwnSegment> {
        let mut draft = scratch::file(folder)?;
        let header = entry(Kind::Header, Key([0; 16]), build.as_bytes())?;
        let machine = entry(Kind::Machine, Key([0; 16]), scratch::boot().as_bytes())?;
        let start = [MAGIC, &header, &machine].concat();
        draft.write_all(&start)?;
        let name = draft.path().file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = name.rsplit('-').next().unwrap_or_default();
        let path = folder.join(name).with_extension(extension);
        draft.persist_noclobber(&path).map_err(|error| error.error)?;
        let file = OpenOptions::new().append(true).open(&path)?;
        // Before the first claim. Another process may hold the lock for a moment to see whether this one lives; a lock that does not
        // answer is not waited for. Where files cannot be locked, others cannot lock it either, and wait for its silence.
        for _ in 0..200 {
            let Err(TryLockError::WouldBlock) = file.try_lock() else { break };
            thread::sleep(Duration::from_millis(1));
        }
        Ok(OwnSegment { path, file, end: start.len() as u64, is_torn: false, written: Instant::now(), number: None })
    }

    /// Adds an entry; the place of its content.
    pub(super) fn append(&mut self, kind: Kind, key: Key, content: &[u8]) -> io::Result<u64> {
        let entry = entry(kind, key, content)?;
        if self.is_torn {
            // What a full disk took of an entry would hide all that follows.
            self.file.set_len(self.end)?;
        }
        self.is_torn = true;
        // One call, so that a killed process leaves at most its last entry incomplete.
        self.file.write_all(&entry)?;
        self.is_torn = false;
        let offset = self.end + LEAD as u64;
        self.end += entry.len() as u64;
        self.written = Instant::now();
        Ok(offset)
    }

    /// Makes sure that it is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}
