//! droptower on a terminal: a pseudo-terminal whose screen is the test.

use std::fs::{self, File};
use std::io::Read;
use std::os::fd::FromRawFd;
use std::process::Stdio;
use std::ptr;

use crate::workbench::command;

/// Both ends of a new pseudo-terminal: that of the screen, and that of the program.
fn pseudo_terminal() -> [File; 2] {
    let mut ends = [-1; 2];
    let [screen, line] = &mut ends;
    // SAFETY: both places are valid; name, modes and size are left to the system.
    let status = unsafe { libc::openpty(screen, line, ptr::null_mut(), ptr::null_mut(), ptr::null_mut()) };
    assert_eq!(status, 0, "a pseudo-terminal");
    // SAFETY: the descriptors were just opened and belong to no one else.
    ends.map(|end| unsafe { File::from_raw_fd(end) })
}

#[test]
fn a_command_that_computes_for_long_shows_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // Nine seconds of recording are rated in far more than one.
    let rows: String = (0..=90_000).map(|i| format!("{},{}\n", f64::from(i) * 1e-4, i % 7)).collect();
    fs::write(folder.path().join("a.csv"), format!("time_s,force_N\n{rows}")).expect("a table");
    let [mut screen, line] = pseudo_terminal();
    let end = || Stdio::from(line.try_clone().expect("its other end"));
    let mut program = command(folder.path(), &["signal", "rate", "a.csv", "a.csv"]);
    let program = program.env("TERM", "xterm").stdin(end()).stdout(end()).stderr(end()).spawn();
    let mut program = program.expect("the binary starts");
    drop(line);
    let (mut shown, mut bytes) = (String::new(), [0; 4096]);
    while !shown.contains(" 1s") {
        match screen.read(&mut bytes) {
            Ok(count @ 1..) => shown += &String::from_utf8_lossy(&bytes[..count]),
            _ => panic!("it ended without the time: {shown:?}"),
        }
    }
    program.kill().expect("it runs");
    program.wait().expect("it ends");
}
