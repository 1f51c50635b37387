//! `--trace` and `--profile`: the lines of a script and its modules as they are reached, and what they took.

use std::collections::BTreeMap;
use std::io::{self, Write};

use rhai::Engine;

use super::ScriptArgs;
use base::diagnostic::printable;
use study::script::{Line, LineUse, Profile, Script, SourceText};

/// Watches the lines of the script; with `--trace` each is printed.
pub(super) fn watch(engine: &mut Engine, args: &ScriptArgs) -> Profile {
    let is_traced = args.trace;
    let script = SourceText::new(args.path(), "").file;
    Profile::watch(
        engine,
        Box::new(move |line, source| {
            if is_traced {
                let module = if source.file == script { String::new() } else { format!("{}:", line.file) };
                // With standard error closed, the script still runs.
                let _ = writeln!(io::stderr(), "{module}{:>5}  {}", line.number, printable(&text(source, line.number)));
            }
        }),
    )
}

/// The line `number` of a text.
fn text(source: &SourceText, number: usize) -> String {
    let line = source.text.lines().nth(number.saturating_sub(1)).unwrap_or_default();
    printable(line.trim_end()).into_owned()
}

/// A row for each line that was reached: how often, how long, its text; the script first, then each module under its name.
pub(super) fn table(lines: &BTreeMap<Line, LineUse>, script: &Script) -> String {
    let whole: f64 = lines.values().map(|line| line.time_s).sum();
    let mut rows = vec![format!("{:>5} {:>9} {:>10} {:>6}  text", "line", "calls", "time (s)", "%")];
    for (place, source) in script.sources().enumerate() {
        let file = source.file.to_string_lossy();
        let own = lines.iter().filter(|(line, _)| line.file == file);
        let own: Vec<String> = own.map(|(line, used)| row(line.number, *used, whole, source)).collect();
        if place > 0 && !own.is_empty() {
            rows.push(printable(&file).into_owned());
        }
        rows.extend(own);
    }
    rows.join("\n")
}

fn row(number: usize, LineUse { calls, time_s }: LineUse, whole: f64, source: &SourceText) -> String {
    let share = 100.0 * time_s / whole.max(f64::MIN_POSITIVE);
    format!("{number:>5} {calls:>9} {time_s:>10.3} {share:>6.1}  {}", text(source, number))
}
