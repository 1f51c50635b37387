//! The common part of the targets: files for readers that take a path, and the limits that every input is held to.
//!
//! libFuzzer limits the time of an input and looks at the memory once a second. The allocator here counts what is held, so that
//! an input that takes much for a moment is found too. A panic ends the process, also one that a reader would catch.
#![warn(missing_docs)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::hint::black_box;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use base::diagnostic::{self, Diagnostic};
use lab::signal::ReadOptions;
use lab::signal::file::{self, ChannelSelection};
use scene::mesh::{Element, import};

/// Most bytes that are held at once.
const MOST_BYTES: usize = 500 << 20;

/// The line between two files in one input.
const SEPARATOR: &[u8] = b"\n%%\n";

/// The allocator of the system, which ends the process once more than [`MOST_BYTES`] are held.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);

// Safety: every call is passed on to the allocator of the system as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        claim(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn claim(bytes: usize) {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
    if held > MOST_BYTES {
        // What is written here may allocate.
        HELD.store(0, Ordering::Relaxed);
        let _ = writeln!(std::io::stderr(), "an input takes more than {} MB: {bytes} bytes more", MOST_BYTES >> 20);
        process::abort();
    }
}

/// Gives `read` the path of a file called `name` that holds `content`.
///
/// # Panics
/// Anything else was written beside it or in the working folder.
pub fn with_file<T>(name: &str, content: &[u8], read: impl FnOnce(&Path) -> T) {
    with_files(&[(name, content)], |folder| read(&folder.join(name)));
}

/// Gives `read` a folder of these files.
///
/// # Panics
/// As of [`with_file`].
pub fn with_files<T>(files: &[(&str, &[u8])], read: impl FnOnce(&Path) -> T) {
    with_folder(|folder| {
        let mut expected = BTreeSet::new();
        for (name, content) in files {
            let path = folder.join(name);
            let parent = path.parent().expect("a parent");
            fs::create_dir_all(parent).expect("a folder");
            fs::write(&path, content).expect("a file");
            expected.extend(parent.ancestors().take_while(|above| *above != folder).map(Path::to_path_buf));
            expected.insert(path);
        }
        black_box(read(folder));
        let found = list(folder);
        assert!(found == expected, "files appeared or vanished: {found:?} instead of {expected:?}");
    });
}

/// Gives `read` an empty folder, the only one in the working folder, in which it may write.
///
/// # Panics
/// Anything was written beside it.
pub fn with_folder<T>(read: impl FnOnce(&Path) -> T) {
    // A name of its own for each input: a reader may know a file again by its path, length and time.
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let folder = scratch().join(NUMBER.fetch_add(1, Ordering::Relaxed).to_string());
    fs::create_dir(&folder).expect("a folder");
    black_box(read(&folder));
    fs::remove_dir_all(&folder).expect("a folder that is removed");
    let found = list(scratch());
    assert!(found.is_empty(), "files appeared in the working folder: {found:?}");
}

/// Splits an input into files called `names`, each after a line `%%`; those without a part are left out.
pub fn split<'a>(names: &[&'a str], input: &'a [u8]) -> Vec<(&'a str, &'a [u8])> {
    let mut rest = Some(input);
    let mut parts = Vec::new();
    for name in names {
        let Some(text) = rest else { break };
        let end = text.windows(SEPARATOR.len()).position(|window| window == SEPARATOR);
        let (part, after) = match end {
            Some(end) => (&text[..end + 1], Some(&text[end + SEPARATOR.len()..])),
            None => (text, None),
        };
        parts.push((*name, part));
        rest = after;
    }
    parts
}

/// Reads a mesh of this name, as film and as the surface of an impactor.
pub fn read_mesh(name: &str, input: &[u8]) {
    with_file(name, input, |path| {
        let extent = import::extent(path).map_err(|error| error.to_string());
        if extent.is_ok() {
            for (mirrored, element) in [([false, false], Element::Tri3), ([true, true], Element::Quad4)] {
                drop(import::film(path, 1e-3, mirrored, element).map_err(|error| error.to_string()));
            }
            drop(import::surface(path).map_err(|error| error.to_string()));
        }
    });
}

/// Reads an outline of this name, with a unit and without.
pub fn read_outline(name: &str, input: &[u8]) {
    with_file(name, input, |path| {
        for unit in [None, Some(1e-3)] {
            match import::polygon(path, unit) {
                Ok(polygon) => drop(polygon.check([false, true]).map_err(|fault| fault.to_string())),
                Err(fault) => drop(fault.to_string()),
            }
        }
    });
}

/// Reads a recording of this name: all its channels, the only one, and its columns without time.
pub fn read_recording(name: &str, input: &[u8]) {
    with_file(name, input, |path| {
        let only = ReadOptions { channels: ChannelSelection::Only, ..ReadOptions::default() };
        for options in [ReadOptions::default(), only] {
            match file::read(path, &options) {
                Ok(measurement) => drop(measurement.recording()),
                Err(error) => drop((error.to_string(), error.place(), error.hint())),
            }
            drop(file::columns(path, &options));
        }
    });
}

/// The text of mistakes, as a terminal shows it.
pub fn show(mistakes: &[Diagnostic]) -> String {
    diagnostic::render(mistakes, true)
}

/// The folder of this process, which is its working folder too: whatever is written by a relative path appears in it.
fn scratch() -> &'static Path {
    static SCRATCH: OnceLock<PathBuf> = OnceLock::new();
    SCRATCH.get_or_init(|| {
        let folder = env::temp_dir().join(format!("droptower-fuzz-{}", process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        env::set_current_dir(&folder).expect("a working folder");
        folder
    })
}

/// Everything in a folder and below.
fn list(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(list(&path));
        }
        found.insert(path);
    }
    found
}
