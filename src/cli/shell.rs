//! `droptower completions`, `man` and `schema`: what shells, manuals and editors know of the program.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::{fs, io};

use clap::{Args, Command};
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate, PathCompleter};
use clap_complete::env::{CompleteEnv, Shells};
use serde_json::Value as Json;

use crate::args::{Choice, choice};
use crate::{Failure, print, print_json};
use base::diagnostic::{Diagnostic, shown_path};
use base::shell::quoted;
use scene::scenario::FileKind;
use scene::scenario::grammar::{self, Key, Rule};
use study::calibrate;

/// Variable by which a shell asks for completions.
const VARIABLE: &str = "DROPTOWER_COMPLETE";

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// bash, zsh, fish, powershell or elvish
    shell: String,
}

/// Answers a shell that asks for completions, and ends; does nothing where none asks.
pub(crate) fn answer(command: fn() -> Command) {
    CompleteEnv::with_factory(command).var(VARIABLE).complete();
}

/// Prints the script that a shell reads once.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let shells = Shells::builtins();
    let Some(shell) = shells.completer(&args.shell) else {
        let names: Vec<&str> = shells.names().collect();
        let mistake = Diagnostic::new(format!("there is no completion for the shell \"{}\"", args.shell));
        return Err(mistake.hint(format!("there is one for {}", names.join(", "))).into());
    };
    let program = std::env::current_exe().unwrap_or_else(|_| "droptower".into());
    let mut script = Vec::new();
    let written = shell.write_registration(VARIABLE, "droptower", "droptower", &program.to_string_lossy(), &mut script);
    written.map_err(|error: io::Error| Failure::output(Diagnostic::new(error.to_string())))?;
    print(String::from_utf8_lossy(&script).trim_end())
}

/// Scenario files.
pub(crate) fn scenarios() -> ArgValueCompleter {
    files("toml")
}

/// Script files.
pub(crate) fn scripts() -> ArgValueCompleter {
    files("rhai")
}

fn files(extension: &'static str) -> ArgValueCompleter {
    let is_wanted = move |path: &std::path::Path| path.extension().is_some_and(|own| own == extension);
    ArgValueCompleter::new(PathCompleter::file().filter(is_wanted))
}

/// Keys of a scenario.
pub(crate) fn keys() -> ArgValueCompleter {
    ArgValueCompleter::new(|written: &OsStr| candidates(written, ""))
}

/// Changes of keys: a key with its equals sign, then the words that it may have.
pub(crate) fn changes() -> ArgValueCompleter {
    ArgValueCompleter::new(|written: &OsStr| match written.to_str().and_then(|text| text.split_once('=')) {
        Some((path, value)) => words(path, value),
        None => candidates(written, "="),
    })
}

/// The keys that begin as it is written, one step deeper at a time.
fn candidates(written: &OsStr, after: &str) -> Vec<CompletionCandidate> {
    let Some(written) = written.to_str() else { return vec![] };
    let (table, begun) = written.rsplit_once('.').unwrap_or(("", written));
    let mut rule = grammar::scenario();
    for step in table.split('.').filter(|step| !step.is_empty()) {
        match rule.under(step) {
            Some(below) => rule = below,
            None => return vec![],
        }
    }
    let keys = rule.table().into_iter().flat_map(|table| &table.keys);
    let candidate = |key: &Key| {
        let path = if table.is_empty() { key.name.clone() } else { format!("{table}.{}", key.name) };
        let has_keys = key.rule.table().is_some();
        let text = format!("{path}{}", if has_keys { "." } else { after });
        let help = key.sentence.clone().map(Into::into);
        CompletionCandidate::new(OsString::from(text)).help(help)
    };
    keys.filter(|key| key.name.starts_with(begun)).map(candidate).collect()
}

/// The words that the key at the path may have.
fn words(path: &str, begun: &str) -> Vec<CompletionCandidate> {
    let rule = path.split('.').try_fold(grammar::scenario(), Rule::under);
    let words = rule.map(Rule::words).unwrap_or_default().into_iter();
    let candidate = |(word, sentence): (&str, Option<&str>)| {
        let help = sentence.map(|sentence| sentence.to_owned().into());
        CompletionCandidate::new(OsString::from(format!("{path}={word}"))).help(help)
    };
    words.filter(|(word, _)| word.starts_with(begun)).map(candidate).collect()
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Write the pages of all commands to this folder, in place of printing that of the program
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

pub(crate) fn man(args: &ManArgs) -> Result<(), Failure> {
    let command = crate::command();
    let Some(folder) = &args.folder else {
        let mut page = Vec::new();
        let written = clap_mangen::Man::new(command).render(&mut page);
        written.map_err(|error| Failure::output(Diagnostic::new(error.to_string())))?;
        return print(String::from_utf8_lossy(&page).trim_end());
    };
    let written = || {
        fs::create_dir_all(folder)?;
        clap_mangen::generate_to(command, folder)
    };
    written().map_err(|error| Failure::output(Diagnostic::new(format!("cannot write {}: {error}", shown_path(folder)))))
}

#[derive(Debug, Args)]
pub(crate) struct SchemaArgs {
    /// The kind of file
    #[arg(value_parser = choice(&SCHEMAS), default_value = "scenario")]
    kind: fn() -> Json,
}

/// The schemas by kind of file.
const SCHEMAS: [Choice<fn() -> Json>; 4] = [
    ("scenario", "Scenarios", || FileKind::Scenario.schema()),
    ("material", "Material files of one layer", || FileKind::Material.schema()),
    ("expect", "`expect.toml`: what a run must give", || FileKind::Expectations.schema()),
    ("study", "Studies: calibrations of several tests", calibrate::schema),
];

pub(crate) fn schema(args: &SchemaArgs) -> Result<(), Failure> {
    print_json(&(args.kind)())
}

/// The command as it was given, in words that a shell takes again.
pub(crate) fn command_line() -> String {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("droptower".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
