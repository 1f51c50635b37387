//! The `droptower` command.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::process::{self, ExitCode};

/// The system's memory; where there is none left, the command ends with a message and a status instead of being aborted.
struct Memory;

#[global_allocator]
static MEMORY: Memory = Memory;

fn main() -> ExitCode {
    droptower::cli::main()
}

/// Ends the process. Nothing is written half: drafts have names of their own until they are whole.
#[cold]
fn exhausted(bytes: usize) -> ! {
    // Numbers are formatted without memory, and standard error has no buffer.
    let _ = writeln!(
        std::io::stderr(),
        "error: no memory is left: {bytes} bytes were asked for\n |\n = help: what was stored before is unchanged; take \
         fewer threads (--threads), frames or elements, or a higher `ulimit -v`"
    );
    process::exit(1)
}

// SAFETY: every call is passed on to the system's allocator, which keeps the contract; a null pointer is never returned.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise is that of the system's allocator.
        let place = unsafe { System.alloc(layout) };
        if place.is_null() { exhausted(layout.size()) } else { place }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as in `alloc`.
        let place = unsafe { System.alloc_zeroed(layout) };
        if place.is_null() { exhausted(layout.size()) } else { place }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as in `alloc`; `place` is of the system's allocator, as all are.
        let place = unsafe { System.realloc(place, layout, size) };
        if place.is_null() { exhausted(size) } else { place }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as in `realloc`.
        unsafe { System.dealloc(place, layout) }
    }
}
