//! Hints are followed: the message that a hint is of is gone once its value, key or option is taken.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use droptower::diagnostic::Diagnostic;
use droptower::model;
use droptower::scenario::{Assignment, Document};
use droptower::simulate;

use crate::workbench::{error, root};

/// The text between the first `open` behind `words` and the next `close`.
fn behind<'h>(hint: &'h str, words: &str, [open, close]: [&str; 2]) -> Option<&'h str> {
    let (_, rest) = hint.split_once(words)?;
    Some(rest.strip_prefix(open)?.split_once(close)?.0)
}

/// What the place of a mistake is to hold by its hint.
fn replacement(hint: &str) -> Option<String> {
    let quoted = ["did you mean ", "write it like ", "write it with a decimal point: "];
    let value = quoted.iter().find_map(|words| behind(hint, words, ["\"", "\""]));
    let key = || behind(hint, "did you mean ", ["`", "`"]).map(str::to_owned);
    value.map(|value| format!("\"{value}\"")).or_else(key)
}

/// The change of a scenario that its hint names.
fn change(hint: &str) -> Option<String> {
    let key = behind(hint, "set ", ["`", "`"])?;
    Some(format!("{key}={}", behind(hint, &format!("`{key}` to "), ["\"", "\""])?))
}

fn mistakes(path: &Path, changes: &[Assignment]) -> Vec<Diagnostic> {
    let checked = Document::read(path).and_then(|document| {
        let document = document.with(changes);
        let model = model::check(&document)?;
        simulate::check(&document, &model)
    });
    checked.err().unwrap_or_default()
}

fn copied(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let (source, target) = entry.map(|entry| (entry.path(), to.join(entry.file_name()))).expect("an entry");
        if source.is_dir() { copied(&source, &target) } else { fs::copy(&source, &target).map(drop).expect("a copy") }
    }
}

#[test]
fn hints_of_scenarios_are_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    copied(&root().join("tests/it/broken"), folder.path());
    let (mut followed, mut wrong) = (0, Vec::new());
    for path in glob::glob(&format!("{}/*.toml", folder.path().display())).expect("a pattern").flatten() {
        let all = mistakes(&path, &[]);
        for mistake in &all {
            let Some(hint) = mistake.hint.as_deref() else { continue };
            let left = match (change(hint), replacement(hint), &mistake.span) {
                (Some(change), ..) => mistakes(&path, &[Assignment::from_argument(&change).expect("a change")]),
                (None, Some(new), Some(span)) => {
                    let (file, text) = (PathBuf::from(&span.source.name), &span.source.text);
                    let is_quoted = text[span.range.clone()].starts_with('"') && !new.starts_with('"');
                    let new = if is_quoted { format!("\"{new}\"") } else { new };
                    fs::write(&file, [&text[..span.range.start], &new, &text[span.range.end..]].concat())
                        .expect("a file");
                    let left = mistakes(&path, &[]);
                    fs::write(&file, text.as_bytes()).expect("a file");
                    left
                }
                _ => continue,
            };
            followed += 1;
            let count = |all: &[Diagnostic]| all.iter().filter(|other| other.message == mistake.message).count();
            if count(&left) >= count(&all) {
                wrong.push(format!("{}: {} (hint: {hint})", path.display(), mistake.message));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(followed > 50, "{followed} hints");
}

/// The option that a hint gives with its value, as a shell takes it.
fn option(hint: &str) -> Option<String> {
    let words = ["give it: ", "give ", "name one: ", "such as ", "steps: "];
    let is_given = |at: &usize| words.iter().any(|words| hint[..*at].ends_with(words));
    let at = hint.match_indices("--").map(|(at, _)| at).find(is_given)?;
    let (name, value) = hint[at..].split_once(' ').unwrap_or((&hint[at..], ""));
    let value = match value.strip_prefix('"') {
        Some(quoted) => format!("\"{}\"", quoted.split_once('"')?.0),
        None => value.split([' ', ',', ';']).next().unwrap_or_default().to_owned(),
    };
    (name == "--force" || !value.is_empty()).then(|| format!("{name} {value}"))
}

/// The error and the hint that follow a command.
type Said<'p> = Option<(&'p str, &'p str)>;

/// The commands of a page.
fn commands(page: &str) -> Vec<(&str, Said<'_>)> {
    fn command(block: &str) -> Option<(&str, Said<'_>)> {
        let (command, output) = block.split_once('\n')?;
        let line = |start: &str| output.lines().find_map(|line| line.trim_start().strip_prefix(start));
        Some((command, line("error: ").zip(line("= help: "))))
    }
    page.split("\n$ ").skip(1).filter_map(|text| command(text.split("\n```").next()?)).collect()
}

#[test]
fn hints_of_commands_are_followed() {
    let program = Path::new(env!("CARGO_BIN_EXE_droptower"));
    let path = format!("{}:/usr/bin:/bin", program.parent().expect("a folder").display());
    let run = |folder: &Path, command: &str| {
        let output = Command::new("sh").args(["-c", command]).current_dir(folder).env("PATH", &path).output();
        error(&output.expect("a shell"))
    };
    let (mut followed, mut wrong) = (0, Vec::new());
    for path in glob::glob(&format!("{}/tests/cmd/*.trycmd", root().display())).expect("a pattern").flatten() {
        let page = fs::read_to_string(&path).expect("a page");
        let commands = commands(&page);
        let is_followed = |(_, said): &(&str, Said<'_>)| said.is_some_and(|(_, hint)| option(hint).is_some());
        let Some(last) = commands.iter().rposition(is_followed) else { continue };
        let folder = tempfile::tempdir().expect("a folder");
        let (own, place) = (path.with_extension("in"), folder.path());
        if own.is_dir() {
            copied(&own, place);
        } else {
            // The repository, in which nothing is written.
            for entry in fs::read_dir(root()).expect("the repository").flatten() {
                std::os::unix::fs::symlink(entry.path(), place.join(entry.file_name())).expect("a link");
            }
        }
        for (command, said) in &commands[..=last] {
            if let Some((message, option)) = said.and_then(|(message, hint)| Some((message, option(hint)?))) {
                followed += 1;
                let told = run(place, &format!("{command} {option}"));
                let message = message.split("[..]").max_by_key(|part| part.len()).unwrap_or_default();
                if told.contains(message) {
                    wrong.push(format!("{}: {command} {option}\n{told}", path.display()));
                }
            } else if own.is_dir() {
                run(place, command);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(followed > 8, "{followed} hints");
}
