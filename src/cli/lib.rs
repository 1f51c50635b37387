//! The command line: one file a command, one failure with its exit status, and the one place that prints.
#![warn(missing_docs)]

mod args;
mod batch;
mod check;
mod checkpoint;
mod compare;
mod deck;
mod explain;
mod export;
mod failure;
mod fit;
mod folder;
mod list;
#[cfg_attr(not(feature = "rerun"), path = "live_off.rs")]
mod live;
mod live_page;
mod new;
mod output;
mod picture;
mod progress;
mod reduce;
mod run;
mod scenarios;
mod script;
mod shell;
mod shipped;
mod signal;
mod store;
mod sweep;
mod terminal;
mod test_command;
mod view;
mod watch;

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use clap::{Arg, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use serde::Serialize;
use serde_json::{Value, json};

use base::diagnostic::{self, Diagnostic};
use base::finding::Finding;
use base::removed;

#[cfg(unix)]
use std::sync::Arc;

pub(crate) use crate::failure::Failure;

/// A scripted virtual drop tower for thin films and membranes.
#[derive(Debug, Parser)]
#[command(name = "droptower", version, max_term_width = 100)]
struct Droptower {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    shared: Shared,
}

/// The options of every command.
#[derive(Clone, Debug, Args)]
pub(crate) struct Shared {
    /// Print figures as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print errors only
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// How mistakes are printed on standard error
    #[arg(long, global = true, value_enum, default_value_t, value_name = "FORMAT")]
    pub diagnostics: DiagnosticFormat,
}

/// How mistakes are printed.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum DiagnosticFormat {
    /// With the lines that they are on
    #[default]
    Text,
    /// As one JSON object a line: message, hint, source, line, column, labels
    Json,
}

impl DiagnosticFormat {
    /// The format that a command line asks for which cannot be parsed.
    fn from_words(words: &[String]) -> DiagnosticFormat {
        let is_json = words.iter().any(|word| word == "--diagnostics=json")
            || words.windows(2).any(|pair| pair[0] == "--diagnostics" && pair[1] == "json");
        if is_json { DiagnosticFormat::Json } else { DiagnosticFormat::Text }
    }
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run scenarios and write signals, figures, a page and a recording
    Run(run::RunArgs),
    /// Run a scenario many times, with the values of its table [variation]
    Sweep(sweep::SweepArgs),
    /// Find the parameters of a film from several tests, how well they are known, and what follows
    Calibrate(script::CalibrateArgs),
    /// Run a Rhai script over scenarios: one of yours, or a shipped one by its name
    Script(script::ScriptArgs),
    /// Check scenarios and materials without running them
    Check(check::CheckArgs),
    /// Write a commented scenario, test or material to start from
    New(new::NewArgs),
    /// Explain a key (unit, range, default), a script function or the code of a finding
    Explain(explain::ExplainArgs),
    /// Compare runs with what they must give: folders with scenario.toml and expect.toml
    Test(test_command::TestArgs),
    /// Compare runs with the first of them: scenarios, figures and signals
    Compare(compare::CompareArgs),
    /// Run a scenario again whenever it, or a file that it names, is saved
    Watch(watch::WatchArgs),
    /// Open the recordings of runs in the Rerun viewer
    View(view::ViewArgs),
    /// Draw the scene of a stored run, or a plot of its page, as PNG, SVG or, in 3-D, glTF
    Picture(picture::PictureArgs),
    /// Reduce measured drops and coupons to a material: drop, coupon, bulge, wide
    #[command(subcommand)]
    Reduce(reduce::ReduceCommand),
    /// Fit laws to measured data, and write them as a material: rubber, prony
    #[command(subcommand)]
    Fit(fit::FitCommand),
    /// Read, filter, convert and rate recordings: info, filter, convert, hic, clip, rate
    #[command(subcommand)]
    Signal(signal::SignalCommand),
    /// Write films and whole tests for other solvers: card, deck
    #[command(subcommand)]
    Export(export::ExportCommand),
    /// Read the films of other solvers as materials: card
    #[command(subcommand)]
    Import(export::ImportCommand),
    /// Print the JSON Schema of scenarios, or of another kind of file, for editors
    Schema(shell::SchemaArgs),
    /// Print what lets a shell complete commands, options, keys and scenarios
    Completions(shell::CompletionsArgs),
    /// Print the manual page, or write those of all commands
    Man(shell::ManArgs),
    /// List or remove the evaluations that are never computed twice
    #[command(subcommand)]
    Store(store::StoreCommand),
    /// List the scenarios of a folder
    List(list::ListArgs),
}

/// The headings of the help, each with the first command below it.
const HEADINGS: [(&str, &str); 3] =
    [("Jobs", "run"), ("Recordings, materials, other solvers", "reduce"), ("More", "schema")];

/// The command line: the options of every command stand once, in the top help, and the commands there by what they are for.
fn command() -> clap::Command {
    let command = Droptower::command();
    let shared: Vec<Arg> = command.get_arguments().filter(|arg| arg.is_global_set()).cloned().collect();
    let hidden = shared.into_iter().map(|arg| arg.hide(true));
    let command = command.mut_subcommands(|one| one.args(hidden.clone()));
    let header = *command.get_styles().get_header();
    let literal = *command.get_styles().get_literal();
    let line = |one: &clap::Command| {
        let (name, about) = (one.get_name(), one.get_about().map(ToString::to_string).unwrap_or_default());
        let heading = HEADINGS.iter().find(|(_, first)| *first == name);
        let heading = heading.map(|(title, _)| format!("\n{header}{title}:{header:#}\n")).unwrap_or_default();
        format!("{heading}  {literal}{name:<11}{literal:#}  {about}\n")
    };
    let lines: String = command.get_subcommands().map(line).collect();
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n{lines}\n{header}Options:{header:#}\n{{options}}"
    );
    command.help_template(template)
}

impl Command {
    /// Whether it may compute for long without a bar of its own and without printing before the end.
    fn works_without_runs(&self) -> bool {
        matches!(
            self,
            Command::Check(_)
                | Command::Compare(_)
                | Command::List(_)
                | Command::Picture(_)
                | Command::Signal(_)
                | Command::Reduce(_)
                | Command::Fit(_)
        )
    }
}

/// Runs the command that the arguments name; usage errors exit with status 2.
pub fn main() -> ExitCode {
    shell::answer(command);
    let given = command().try_get_matches().and_then(|matches| Droptower::from_arg_matches(&matches));
    let Droptower { command, shared } = match given {
        Ok(given) => given,
        Err(error) => return unusable(&error),
    };
    match run(&command, &shared) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(shared.diagnostics, shared.json),
    }
}

/// Reports arguments that no command takes; what earlier versions took with what to use instead.
fn unusable(error: &clap::Error) -> ExitCode {
    let words: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let json = words.iter().any(|word| word == "--json");
    let is_unknown = error.kind() == clap::error::ErrorKind::InvalidSubcommand;
    let gone = || removed::command(&words).map(|(name, hint)| (name.to_owned(), hint));
    let meant = || if is_unknown { guess(&words) } else { None };
    match Some(()).filter(|()| error.use_stderr()).and_then(|()| gone().or_else(meant)) {
        Some((name, hint)) => Failure::from(Diagnostic::new(format!("droptower has no `{name}`")).hint(hint))
            .report(DiagnosticFormat::from_words(&words), json),
        None if json && error.use_stderr() => {
            let _ = print_json(&json!({ "errors": [{ "message": error.to_string().trim_end() }] }));
            error.exit()
        }
        None => error.exit(),
    }
}

/// The word of a command line that is no command, and which one is meant: the command of that name below another, the shipped
/// script, or else the name that is spelt most like it.
fn guess(words: &[String]) -> Option<(String, String)> {
    let mut command = command();
    command.build();
    let mut written = words.iter().filter(|word| !word.starts_with('-'));
    let (word, path) = match written.next()? {
        first if command.find_subcommand(first).is_some_and(clap::Command::has_subcommands) => {
            (written.next()?, Some(first))
        }
        first => (first, None),
    };
    let top = command.get_subcommands().filter(|one| path.is_none_or(|path| one.get_name() == path));
    let mut known: Vec<(String, String)> = Vec::new();
    for one in top.filter(|one| !one.is_hide_set()) {
        let name = one.get_name().to_owned();
        let below =
            one.get_subcommands().map(|below| (below.get_name().to_owned(), format!("{name} {}", below.get_name())));
        let below: Vec<_> = below.filter(|(own, _)| own != "help").collect();
        known.extend(path.is_none().then(|| (name.clone(), name.clone())));
        known.extend(below);
    }
    // `coupon` is rather a recording than a template.
    known.sort_by_key(|(_, whole)| whole.starts_with("new "));
    if path.is_none() {
        known.extend(shipped::names().map(|name| (name.to_owned(), format!("script {name}"))));
    }
    let find = |name: &str| known.iter().find(|(own, _)| own == name).map(|(_, whole)| format!("`droptower {whole}`"));
    let hint = find(word).map(|whole| format!("it is {whole}")).or_else(|| {
        let sought = removed::sought_commands().filter(|_| path.is_none());
        let names: Vec<String> = known.iter().map(|(own, _)| own.clone()).chain(sought.map(str::to_owned)).collect();
        let nearest = diagnostic::closest(word, names.iter().map(String::as_str))?;
        Some(match find(nearest) {
            Some(whole) => format!("did you mean {whole}?"),
            None => removed::command(&[nearest.to_owned()])?.1,
        })
    });
    let shown = path.map_or_else(|| word.clone(), |path| format!("{path} {word}"));
    let others = path.map_or_else(|| "droptower --help".to_owned(), |path| format!("droptower {path} --help"));
    Some((shown, hint.unwrap_or_else(|| format!("`{others}` lists the commands"))))
}

/// Checks and sets what the whole program needs of the system.
///
/// # Errors
/// The clock is before 1970: recordings and names of files could not carry its time.
fn prepare() -> Result<(), Failure> {
    if SystemTime::now() < UNIX_EPOCH {
        let mistake = Diagnostic::new("the clock of this machine is before 1970");
        return Err(Failure::output(mistake.hint("set it: recordings carry its time")));
    }
    // A file that reaches the limit of its size (`ulimit -f`) is then an error of the write, as a full disk is, and does
    // not end the program.
    #[cfg(unix)]
    if let Err(error) = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default()) {
        return Err(Failure::output(Diagnostic::new(format!("cannot handle signals: {error}"))));
    }
    Ok(())
}

fn run(command: &Command, shared: &Shared) -> Result<(), Failure> {
    prepare()?;
    study::script::silence_panics();
    if let Some(threads) = shared.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        let started = pool.build_global();
        started.map_err(|error| Diagnostic::new(format!("cannot start {threads} threads: {error}")))?;
    }
    if command.works_without_runs() {
        progress::begin_work(shared.quiet);
    }
    let done = run_command(command, shared);
    progress::end_of_work();
    done
}

fn run_command(command: &Command, shared: &Shared) -> Result<(), Failure> {
    match command {
        Command::Run(args) => run::run(args, shared),
        Command::Sweep(args) => sweep::run(args, shared),
        Command::Store(command) => store::run(command, shared),
        Command::Check(args) => check::run(args, shared),
        Command::Schema(args) => shell::schema(args),
        Command::Explain(args) => explain::run(args, shared),
        Command::New(args) => new::run(args, shared),
        Command::Compare(args) => compare::run(args, shared),
        Command::Test(args) => test_command::run(args, shared),
        Command::List(args) => list::run(args, shared),
        Command::View(args) => view::run(args, shared),
        Command::Picture(args) => picture::run(args, shared),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
        Command::Watch(args) => watch::run(args, shared),
        Command::Calibrate(args) => script::calibrate(args, shared),
        Command::Script(args) => script::run(args, shared),
        Command::Reduce(command) => reduce::run(command, shared),
        Command::Fit(command) => fit::run(command, shared),
        Command::Signal(command) => signal::run(command, shared),
        Command::Export(command) => export::run_export(command, shared),
        Command::Import(command) => export::run_import(command, shared),
    }
}

/// Prints diagnostics on standard error, with colours on a terminal.
pub(crate) fn print_diagnostics(diagnostics: &[Diagnostic]) {
    progress::end_of_work();
    let styled = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
    // With standard error closed, the exit status is left.
    let _ = writeln!(io::stderr(), "{}", diagnostic::render(diagnostics, styled));
}

/// Prints a line on standard error, such as a note or the state of what runs.
pub(crate) fn tell(line: &str) {
    progress::end_of_work();
    // With standard error closed, there is nowhere to print.
    let _ = writeln!(io::stderr(), "{}", diagnostic::printable(line));
}

/// Prints an event as one line of JSON on standard error, for a program that follows.
pub(crate) fn tell_event(event: &Value) {
    // Whoever follows may have gone.
    let _ = writeln!(io::stderr(), "{}", diagnostic::printable_json(&event.to_string()));
}

/// Prints a drawing in characters on standard error, above the diagnostics that it belongs to.
pub(crate) fn print_drawing(drawing: &str) {
    progress::end_of_work();
    // With standard error closed, the exit status is left.
    let _ = write!(io::stderr(), "{}", diagnostic::printable(drawing));
}

/// Prints diagnostics on standard error for a program that reads them.
pub(crate) fn print_records(diagnostics: &[Diagnostic]) {
    progress::end_of_work();
    diagnostics.iter().for_each(|diagnostic| tell_event(&json!(diagnostic.record())));
}

/// Set by the first print on standard output.
static HAS_PRINTED: AtomicBool = AtomicBool::new(false);

/// Whether standard output has something.
pub(crate) fn has_printed() -> bool {
    HAS_PRINTED.load(Ordering::Relaxed)
}

/// Prints text on standard output without control characters; a reader that closes the pipe (`| head`) is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    progress::end_of_work();
    HAS_PRINTED.store(true, Ordering::Relaxed);
    match writeln!(io::stdout(), "{}", diagnostic::printable(text)) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::output(Diagnostic::new(format!("cannot print: {error}"))))
        }
        _ => Ok(()),
    }
}

/// Prints text as [`print`] does, unless `--quiet`.
pub(crate) fn print_unless_quiet(shared: &Shared, text: &str) -> Result<(), Failure> {
    if shared.quiet { Ok(()) } else { print(text) }
}

/// Prints figures as JSON on standard output.
pub(crate) fn print_json(figures: &impl Serialize) -> Result<(), Failure> {
    print_as_json(serde_json::to_string_pretty(figures))
}

/// Prints an event as one line of JSON on standard output.
pub(crate) fn print_line(event: &impl Serialize) -> Result<(), Failure> {
    print_as_json(serde_json::to_string(event))
}

fn print_as_json(text: serde_json::Result<String>) -> Result<(), Failure> {
    let text = text.map_err(|error| Failure::output(Diagnostic::new(format!("cannot print as JSON: {error}"))))?;
    print(&diagnostic::printable_json(&text))
}

/// Prints the figures of a command as JSON, as text, or not at all, as `--json` and `--quiet` ask for.
pub(crate) fn print_figures(
    shared: &Shared,
    figures: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    match (shared.json, shared.quiet) {
        (true, _) => print_json(figures),
        (false, true) => Ok(()),
        (false, false) => print(text().trim_end()),
    }
}

/// Prints the figures of a command as [`print_figures`] does, with its findings and the files that it wrote behind them.
pub(crate) fn print_results(
    shared: &Shared,
    mut figures: Value,
    findings: &[Finding],
    written: &[String],
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    figures["findings"] = json!(findings);
    figures["written"] = json!(written);
    let written = || written.iter().map(|file| format!("wrote {file}\n")).collect();
    print_figures(shared, &figures, || [text(), terminal::findings("", findings), written()].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guessed_name_leads_to_what_is_meant() {
        for (written, hint) in [
            ("rn", "did you mean `droptower run`?"),
            ("reduse", "did you mean `droptower reduce`?"),
            ("hic", "it is `droptower signal hic`"),
            ("info", "it is `droptower signal info`"),
            ("rate", "it is `droptower signal rate`"),
            ("convert", "it is `droptower signal convert`"),
            ("filter", "it is `droptower signal filter`"),
            ("bulge", "it is `droptower reduce bulge`"),
            ("wide", "it is `droptower reduce wide`"),
            ("coupon", "it is `droptower reduce coupon`"),
            ("failure-mass", "it is `droptower script failure-mass`"),
            ("reduce coupn", "did you mean `droptower reduce coupon`?"),
            ("validate", "`droptower check` checks scenarios, materials and studies"),
            ("template", "`droptower new KIND FILE` writes a file to start from"),
            ("predict", "`droptower calibrate STUDY` predicts the scenarios of the study's table [predict]"),
            ("plott", "`droptower picture RUN --plot NAME` draws a plot of a run; its report.html has all of them"),
            ("xyzzyx", "`droptower --help` lists the commands"),
        ] {
            let words: Vec<String> = written.split(' ').map(str::to_owned).collect();
            let found = removed::command(&words).map(|(name, hint)| (name.to_owned(), hint)).or_else(|| guess(&words));
            assert_eq!(found, Some((written.to_owned(), hint.to_owned())));
        }
    }
}
