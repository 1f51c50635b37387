//! droptower on a terminal: a pseudo-terminal whose keyboard and screen are the test.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::fd::FromRawFd;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::ptr;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use rustix::termios::{LocalModes, tcgetattr};

use crate::workbench::{command, root};

/// Longest wait for what must appear: far longer than a busy machine needs.
const PATIENCE: Duration = Duration::from_secs(600);

/// Ends the editing of a line.
const PLAIN_PASTE: &str = "\x1b[?2004l";

/// Both ends of a new pseudo-terminal: that of the keyboard and the screen, and that of the program.
fn pseudo_terminal() -> [File; 2] {
    let mut ends = [-1; 2];
    let [keyboard, line] = &mut ends;
    // SAFETY: both places are valid; name, modes and size are left to the system.
    let status = unsafe { libc::openpty(keyboard, line, ptr::null_mut(), ptr::null_mut(), ptr::null_mut()) };
    assert_eq!(status, 0, "a pseudo-terminal");
    // SAFETY: the descriptors were just opened and belong to no one else.
    ends.map(|end| unsafe { File::from_raw_fd(end) })
}

struct Terminal {
    keyboard: File,
    screen: Receiver<String>,
    /// What the screen showed since the last wait.
    shown: String,
    /// The other end, as the program sees it.
    line: File,
    program: Child,
}

impl Terminal {
    /// A session in `folder`, whose earlier lines are kept there too; the prompt waits.
    fn start(folder: &Path, options: &[&str]) -> Terminal {
        let mut terminal = Terminal::of(folder, &[&["repl"], options].concat());
        terminal.wait_for("Ctrl-D ends");
        terminal.wait_for("> ");
        terminal
    }

    /// A command in `folder`.
    fn of(folder: &Path, arguments: &[&str]) -> Terminal {
        let [keyboard, line] = pseudo_terminal();
        let end = || Stdio::from(line.try_clone().expect("its other end"));
        let mut program = command(folder, arguments);
        program.env("TERM", "xterm").env("HOME", folder).env("XDG_DATA_HOME", folder);
        let program = program.stdin(end()).stdout(end()).stderr(end()).spawn().expect("the binary starts");
        let (tell, screen) = channel();
        let mut from = keyboard.try_clone().expect("a reader");
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = from.read(&mut bytes) {
                if tell.send(String::from_utf8_lossy(&bytes[..count]).into_owned()).is_err() {
                    break;
                }
            }
        });
        Terminal { keyboard, screen, shown: String::new(), line, program }
    }

    fn press(&mut self, keys: &str) {
        self.keyboard.write_all(keys.as_bytes()).expect("the keyboard");
    }

    /// Waits for this; what was shown before it.
    fn wait_for(&mut self, text: &str) -> String {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Some(place) = self.shown.find(text) {
                let before = self.shown[..place].to_owned();
                self.shown.drain(..place + text.len());
                return before;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            match self.screen.recv_timeout(left) {
                Ok(more) => self.shown += &more,
                Err(_) => panic!("`{text}` is not shown: {:?}", self.shown),
            }
        }
    }

    /// Types an input; waits for its value, and for the next prompt.
    fn ask(&mut self, keys: &str, value: &str) {
        self.press(keys);
        self.wait_for(&format!("\n{value}\r\n"));
        self.wait_for("> ");
    }

    fn signal(&self, signal: i32) {
        // SAFETY: the process is a child that was not waited for, so that its number is its own.
        let status = unsafe { libc::kill(self.program.id() as i32, signal) };
        assert_eq!(status, 0, "it runs");
    }

    /// Waits for the end; the terminal must be as it was before.
    fn end(mut self) -> ExitStatus {
        let deadline = Instant::now() + PATIENCE;
        let status = loop {
            match self.program.try_wait().expect("a child") {
                Some(status) => break status,
                None if Instant::now() > deadline => panic!("the session does not end: {:?}", self.shown),
                None => thread::sleep(Duration::from_millis(10)),
            }
        };
        let modes = tcgetattr(&self.line).expect("its modes").local_modes;
        assert!(modes.contains(LocalModes::ECHO | LocalModes::ICANON | LocalModes::ISIG), "{modes:?}");
        status
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // It has ended unless the test fails.
        let _ = self.program.kill();
    }
}

#[test]
fn lines_are_completed_continued_given_up_and_repeated() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut one = Terminal::start(folder.path(), &[]);
    one.ask("fn twofold(x) { 2 * x } 0\r", "0");
    one.ask("twof\t(21)\r", "42");
    one.ask("(1 +\r10)\r", "11");
    one.ask("\"20 °C\" // °\r", "20 °C");
    one.press("nonsense(");
    one.wait_for("nonsense(");
    one.press("\x03");
    one.wait_for(PLAIN_PASTE);
    one.wait_for("> ");
    one.ask("5 * 5\r", "25");
    // A signal that is not of the keyboard: its thread may get to it late, and stop one input.
    one.signal(libc::SIGINT);
    let is_answered = |_| {
        one.press("6 * 6\r");
        one.wait_for(PLAIN_PASTE);
        one.wait_for("> ").contains("\n36\r\n")
    };
    assert!((0..2).any(is_answered));
    // Two sessions at a time keep the lines of both.
    let mut other = Terminal::start(folder.path(), &[]);
    other.ask("700 + 7\r", "707");
    one.ask("800 + 8\r", "808");
    other.press("\x04");
    assert!(other.end().success());
    one.press(":quit\r");
    assert!(one.end().success());
    let kept = fs::read_to_string(folder.path().join("droptower/repl-history")).expect("the lines");
    assert!(kept.contains("700 + 7\n") && kept.contains("800 + 8\n") && kept.contains("twofold(21)\n"), "{kept}");
}

#[test]
fn signals_end_a_session_and_leave_the_terminal_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    for signal in [libc::SIGTERM, libc::SIGHUP] {
        let mut terminal = Terminal::start(folder.path(), &[]);
        terminal.ask("1000 + 24\r", "1024");
        terminal.signal(signal);
        assert_eq!(terminal.end().code(), Some(1));
    }
    // What was typed is not lost.
    let mut terminal = Terminal::start(folder.path(), &[]);
    terminal.ask("\x1b[A\r", "1024");
    terminal.press("\x04");
    assert!(terminal.end().success());
}

#[test]
fn a_computation_is_stopped_and_the_session_goes_on_or_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/drop/1008.toml");
    let options = ["--scenario", scenario.to_str().expect("UTF-8"), "--set", "specimen.mesh.size=2mm"];
    let mut terminal = Terminal::start(folder.path(), &options);
    let long = "log(\"be\" + \"gun\"); let run = scenario(args.scenario).simulate();\r";
    terminal.press(long);
    terminal.wait_for("begun");
    terminal.signal(libc::SIGINT);
    terminal.wait_for("stopped");
    terminal.wait_for("> ");
    terminal.ask("6 * 7\r", "42");
    // Within one of our functions, which alone would take seconds.
    terminal.press("let s = signal([0.0, 9.0], [0.0, 1.0]).resampled(0.1); log(\"be\" + \"gun\"); rate(s, s); 7 * 7\r");
    terminal.wait_for("begun");
    terminal.signal(libc::SIGINT);
    terminal.wait_for("stopped");
    terminal.wait_for("> ");
    terminal.press(long);
    terminal.wait_for("begun");
    terminal.signal(libc::SIGTERM);
    terminal.wait_for("a signal ended the session");
    assert_eq!(terminal.end().code(), Some(1));
}

#[test]
fn a_command_that_computes_for_long_shows_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // Nine seconds of recording are rated in far more than one.
    let rows: String = (0..=90_000).map(|i| format!("{},{}\n", f64::from(i) * 1e-4, i % 7)).collect();
    fs::write(folder.path().join("a.csv"), format!("time_s,force_N\n{rows}")).expect("a table");
    let mut terminal = Terminal::of(folder.path(), &["signal", "rate", "a.csv", "a.csv"]);
    terminal.wait_for(" 2s");
    // Not SIGINT, which a shell lets its background jobs ignore.
    terminal.signal(libc::SIGTERM);
    assert!(!terminal.end().success());
}
