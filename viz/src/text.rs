//! Texts of a recording in Markdown, and its log.

use crate::scene::{Document, Event, Severity};
use base::number::duration;
use lab::signal::Recording;
use lab::signal::column::{self, Column};
use report::{RunPage, cell, columns, escaped};
use study::post::lowest_point;
use study::script::{File, Row, ScriptOutput};

/// Most files that are shown, lines of each, and characters of each line.
const MOST_FILES: usize = 20;
const MOST_LINES: usize = 10;
const MOST_LETTERS: usize = 160;

/// A text of its own.
pub(crate) fn document(title: &str, markdown: String) -> Document {
    let letters = title.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' });
    Document { path: format!("texts/{}", letters.collect::<String>()), title: title.to_owned(), text: markdown }
}

/// A file as it is, such as a scenario or a script.
pub(crate) fn verbatim(content: &str) -> String {
    // A fence is longer than any run of backticks within.
    let longest = content.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    let fence = "`".repeat(longest.max(2) + 1);
    format!("{fence}\n{}\n{fence}\n", content.trim_end())
}

/// The tables of a script; `None` without any.
pub(crate) fn tables(output: &ScriptOutput) -> Option<Document> {
    let tables: Vec<String> = output.tables.iter().map(|(name, rows)| table(name, rows)).collect();
    (!tables.is_empty()).then(|| document("Tables", tables.join("\n")))
}

/// The beginnings of the files of a script; `None` without any.
pub(crate) fn files(output: &ScriptOutput) -> Option<Document> {
    let files: Vec<String> = output.files.iter().take(MOST_FILES).map(file).collect();
    let more = match output.files.iter().count().saturating_sub(MOST_FILES) {
        0 => String::new(),
        more => format!("\nand {more} more in the folder\n"),
    };
    (!files.is_empty()).then(|| document("Files", files.join("\n") + more.as_str()))
}

/// Name, length and first lines of a file.
fn file(File { name, content }: &File) -> String {
    let lines: Vec<String> =
        content.lines().take(MOST_LINES).map(|line| line.chars().take(MOST_LETTERS).collect()).collect();
    let shown = verbatim(&lines.join("\n"));
    format!("## {}\n\n{} lines, {} bytes\n\n{shown}", escaped(name), content.lines().count(), content.len())
}

/// Rows under the names of all their columns, under a heading.
pub(crate) fn table(name: &str, rows: &[Row]) -> String {
    let columns = columns(rows);
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let heads = line(columns.iter().map(|name| escaped(name)).collect());
    let rule = format!("|{}\n", "---|".repeat(columns.len()));
    let cells = |row: &Row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect::<Vec<_>>();
    let rows = rows.iter().map(|row| line(cells(row).iter().map(|cell| escaped(cell)).collect()));
    format!("## {}\n\n{heads}{rule}{}", escaped(&name.replace('_', " ")), rows.collect::<String>())
}

/// First contact, extremes, release, rupture and findings in the order of time, and the log of the post script.
pub(crate) fn listed(run: &RunPage) -> Vec<Event> {
    let signals = &run.results.signals;
    let end = signals.time.last().copied().unwrap_or_default();
    let rupture = run.outcome.rupture_time.map(|time| (time, Severity::Warning, "first element fails".to_owned()));
    let failure = run.failure.map(|cause| (end, Severity::Warning, format!("the run failed: {cause}")));
    let warnings = run.results.findings.iter().map(|found| {
        let severity = if found.is_warning() { Severity::Warning } else { Severity::Info };
        (end, severity, format!("{} [{}]", found.message, found.code))
    });
    let logged = run.results.script_output.log.iter().map(|text| (end, Severity::Info, text.clone()));
    let named = run.model.names().into_iter().zip(run.model.prefixes());
    let motion = named.flat_map(|(name, prefix)| {
        let of = name.map_or_else(String::new, |name| format!("{name}: "));
        motion(signals, &prefix).into_iter().map(move |(time, text)| (time, Severity::Info, format!("{of}{text}")))
    });
    // The column of times in the viewer is too narrow for them.
    let timed = |(time, severity, text)| (time, severity, format!("{}: {text}", duration(time)));
    let mut all: Vec<_> = motion.chain(rupture).map(timed).chain(failure).chain(warnings).chain(logged).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(time, severity, text)| Event { time, severity, text }).collect()
}

/// First contact, largest deceleration, lowest point and release of the impactor whose channels begin with `prefix`.
fn motion(signals: &Recording, prefix: &str) -> Vec<(f64, String)> {
    let name = |column: Column| format!("{prefix}{}", column.name);
    let Some(force) = signals.channel(&name(column::CONTACT_FORCE)) else { return vec![] };
    let contact = force.iter().position(|force| *force != 0.0).map(|k| (k, "first contact".to_owned()));
    let braking = largest(signals, &name(column::ACCELERATION_FILTERED))
        .map(|(k, peak)| (k, format!("largest deceleration, {peak:.1} m/s²")));
    let lowest = lowest_point(signals, prefix);
    let velocity = signals.channel(&name(column::VELOCITY)).unwrap_or_default();
    let release = lowest.and_then(|[time, _]| release(&signals.time, [force, velocity], time));
    let lowest = lowest.map(|[time, depth]| (time, format!("lowest point, {:.1} mm", 1e3 * depth)));
    let timed = |(k, text)| Some((*signals.time.get(k)?, text));
    [contact, braking].into_iter().flatten().filter_map(timed).chain(lowest).chain(release).collect()
}

/// Share of the largest contact force below which the impactor is released: slack film may come into contact with it
/// as it rises.
const RELEASED: f64 = 0.01;

/// When contact ends after the lowest point at the time `lowest` (s), and the speed of the impactor then.
fn release(time: &[f64], [force, velocity]: [&[f64]; 2], lowest: f64) -> Option<(f64, String)> {
    let least = RELEASED * force.iter().copied().fold(0.0, f64::max);
    let left = force.iter().rposition(|force| *force > least)? + 1;
    let speed = velocity.get(left)?;
    let time = *time.get(left)?;
    (time > lowest && *speed > 0.0).then(|| (time, format!("release at {speed:.2} m/s")))
}

/// Index and value of the largest sample of a channel.
fn largest(signals: &Recording, channel: &str) -> Option<(usize, f64)> {
    let samples = signals.channel(channel)?.iter().copied().enumerate();
    let finite = samples.filter(|(_, value)| value.is_finite());
    finite.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use lab::signal::Channel;

    use super::*;

    #[test]
    fn a_fence_is_longer_than_those_within() {
        assert_eq!(verbatim("let a = `b`;\n// ````\n"), "`````\nlet a = `b`;\n// ````\n`````\n");
    }

    #[test]
    fn the_first_lines_of_a_long_file_are_shown() {
        let content: String = (0..50).map(|i| format!("{i},1\n")).collect();
        let text = file(&File { name: "tests_a.csv".into(), content });
        assert!(text.starts_with("## tests\\_a.csv\n\n50 lines, 240 bytes\n\n```\n0,1\n1,1\n"), "{text}");
        assert!(text.ends_with("\n9,1\n```\n"), "{text}");
        assert!(files(&ScriptOutput::default()).is_none());
    }

    #[test]
    fn cells_are_escaped() {
        let row = |cell: &str| serde_json::json!({ "k1": 2.75, "note": cell }).as_object().cloned().unwrap();
        let expected = "## best of all\n\n| k1 | note |\n|---|---|\n| 2.750 | a \\| b \\<i\\> |\n";
        assert_eq!(table("best_of_all", &[row("a | b <i>")]), expected);
    }

    #[test]
    fn contact_lowest_point_and_release_are_logged() {
        let channel = |name: &str, values: [f64; 5]| Channel { name: name.to_owned(), values: values.to_vec() };
        let signals = |force| Recording {
            time: vec![0.0, 0.1, 0.2, 0.3, 0.4],
            channels: vec![
                channel("contact_force_N", force),
                channel("displacement_m", [0.0, -0.1, -0.2, -0.1, f64::NAN]),
                channel("velocity_m_s", [-4.0, -3.0, 0.0, 1.0, 1.5]),
            ],
        };
        let texts = |force| motion(&signals(force), "").into_iter().map(|(time, text)| format!("{time} {text}"));
        let bounced: Vec<String> = texts([0.0, 3.0, 5.0, 1.0, 0.0]).collect();
        assert_eq!(bounced, ["0.1 first contact", "0.2 lowest point, -200.0 mm", "0.4 release at 1.50 m/s"]);
        assert_eq!(texts([0.0, 3.0, 5.0, 1.0, 1.0]).count(), 2, "the impactor stays in contact");
        let is_released = texts([0.0, 300.0, 500.0, 1.0, 1.0]).any(|line| line == "0.3 release at 1.00 m/s");
        assert!(is_released, "slack film may come into contact with it");
        assert_eq!(motion(&Recording::default(), ""), []);
    }
}
