//! `droptower repl`: a script that is typed line by line, each answered at once.

mod command;
mod complete;
mod history;
mod input;
mod show;
mod signals;

use std::io::{self, BufRead, IsTerminal, Write};
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;

use clap::Args;
use rhai::{Dynamic, Engine, Scope};
use rustyline::completion::FilenameCompleter;
use rustyline::error::ReadlineError;
use rustyline::history::FileHistory;
use rustyline::{CompletionType, Config, Editor};

use self::command::Command;
use self::complete::{Assistant, Words};
use self::history::History;
use self::input::Open;
use self::signals::Signals;
use super::given::Given;
use super::{
    DiagnosticFormat, Failure, Shared, faults, print, print_diagnostics, print_line, print_records, script, table,
};
use base::cancellation::Cancellation;
use base::diagnostic::{Diagnostic, printable};
use study::evaluate::Evaluations;
use study::identify::{SearchEvent, SearchHost};
use study::script::{
    Arguments, Console, Fault, LONGEST_SCRIPT, Limits, Message, OutputCollector, STACK, ScriptOutput, Session,
    stop_beyond, to_json,
};
use study::store;

#[derive(Debug, Args)]
pub(super) struct ReplArgs {
    #[command(flatten)]
    pub given: Given,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

/// Before a line, and before those that continue it.
const PROMPT: &str = "> ";

pub(super) fn run(args: &ReplArgs, shared: &Shared) -> Result<(), Failure> {
    let evaluations = Evaluations::open(&args.store).map_err(|error| script::unkept(&error))?;
    let evaluations = Arc::new(evaluations);
    let session = || {
        let mut repl = Repl::new(args, &evaluations, shared)?;
        if io::stdin().is_terminal() { repl.talk() } else { repl.read(io::stdin().lock()) }
    };
    // Values nested as deep as an interpreter may nest them are shown and dropped here, too.
    let ended = thread::scope(|threads| {
        let started = thread::Builder::new().name("repl".into()).stack_size(STACK).spawn_scoped(threads, session);
        let started = started.map_err(|error| Diagnostic::new(format!("cannot start a thread: {error}")))?;
        started.join().unwrap_or_else(|panic| resume_unwind(panic))
    });
    evaluations.store().close().map_err(|error| script::unkept(&evaluations.failed(error)))?;
    ended
}

struct Repl<'a> {
    engine: Engine,
    console: Console,
    /// The arguments of the command line, and those with what loaded scripts declare.
    given: rhai::Map,
    arguments: rhai::Map,
    collector: OutputCollector,
    /// The part of the output that was shown so far.
    shown: ScriptOutput,
    signals: Signals,
    evaluations: &'a Arc<Evaluations>,
    shared: &'a Shared,
}

impl<'a> Repl<'a> {
    fn new(args: &ReplArgs, evaluations: &'a Arc<Evaluations>, shared: &'a Shared) -> Result<Repl<'a>, Failure> {
        let quiet = shared.quiet;
        let tell = move |line: &str| {
            if !quiet {
                // With standard error closed, the session goes on.
                let _ = writeln!(io::stderr(), "{}", printable(line));
            }
        };
        let collector = OutputCollector::new(Vec::new()).with_listener(move |message| tell(&message.to_string()));
        let host = SearchHost::new(None, move |event| match event {
            SearchEvent::Progress(_, progress) => tell(&progress.to_string()),
            SearchEvent::Followed(text) => tell(text),
            SearchEvent::Warning(warning) => tell(&Message::Finding(&base::finding::Finding::new(warning)).to_string()),
            _ => {}
        });
        let engine = script::engine(args.given.changes.assignments()?, evaluations, &host, &collector);
        let given = args.given.values()?;
        let mut scope = Scope::new();
        scope.push_constant("args", Arguments::new(given.clone()));
        Ok(Repl {
            engine,
            console: Console::new(scope),
            arguments: given.clone(),
            given,
            collector,
            shown: ScriptOutput::default(),
            signals: Signals::default(),
            evaluations,
            shared,
        })
    }

    /// A session on a terminal.
    fn talk(&mut self) -> Result<(), Failure> {
        let evaluations = Arc::clone(self.evaluations);
        // What cannot be written there ends with this process anyway.
        self.signals.watch(self.shared.diagnostics, move || drop(evaluations.store().close()))?;
        let unusable =
            |error: ReadlineError| Failure::output(Diagnostic::new(format!("cannot read the terminal: {error}")));
        let config = Config::builder().auto_add_history(true).completion_type(CompletionType::List);
        let config = config.max_history_size(history::MOST_LINES).map_err(unusable)?.build();
        let mut editor = Editor::<Assistant, FileHistory>::with_config(config).map_err(unusable)?;
        let history = History::open(&mut editor);
        print(concat!("droptower ", env!("CARGO_PKG_VERSION"), "   :help lists commands, Ctrl-D ends"))?;
        while !self.signals.is_over() {
            let words = Words::from_engine(&self.engine, &self.console, &Command::NAMES);
            editor.set_helper(Some(Assistant { words, files: FilenameCompleter::new() }));
            let line = match editor.readline(PROMPT) {
                Ok(line) => line,
                Err(ReadlineError::Interrupted) => continue,
                Err(ReadlineError::Eof) => return Ok(()),
                Err(error) => return Err(unusable(error)),
            };
            history.keep(&mut editor);
            match self.answer(&line) {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(failure) => self.complain(&failure.diagnostics),
            }
        }
        Err(signals::ended())
    }

    /// A session without a terminal: no prompt, and the first mistake ends it.
    fn read(&mut self, lines: impl BufRead) -> Result<(), Failure> {
        let mut lines = lines.take(LONGEST_SCRIPT);
        let mut entered = String::new();
        let mut open = Open::default();
        loop {
            let before = entered.len();
            let length = lines.read_line(&mut entered);
            let length = length.map_err(|error| Diagnostic::new(format!("cannot read standard input: {error}")))?;
            if lines.limit() == 0 {
                let mistake = Diagnostic::new(format!("standard input is longer than {LONGEST_SCRIPT} bytes"));
                return Err(mistake.hint("run long texts with `droptower script`").into());
            }
            open.read(&entered[before..]);
            if length > 0 && !entered.starts_with(':') && open.is_any() {
                continue;
            }
            if !self.answer(&entered)? || length == 0 {
                return Ok(());
            }
            entered.clear();
            open = Open::default();
        }
    }

    /// Answers an input, which Ctrl-C stops; whether the session goes on.
    fn answer(&mut self, input: &str) -> Result<bool, Failure> {
        let cancellation = Cancellation::default();
        self.engine.set_default_tag(Session::of_engine(&self.engine).with_cancellation(&cancellation));
        stop_beyond(&mut self.engine, Limits::STUDY, &cancellation);
        self.signals.set_current(Some(cancellation));
        let found = self.answered(input);
        self.signals.set_current(None);
        found
    }

    fn answered(&mut self, input: &str) -> Result<bool, Failure> {
        if let Some(command) = input.trim().strip_prefix(':') {
            return self.command(&Command::read(command)?);
        }
        if !input.trim().is_empty() {
            let value = self.evaluate(|engine, console| console.run(engine, input))?;
            self.show(&value, input)?;
        }
        Ok(true)
    }

    /// The value of what is run.
    fn evaluate(
        &mut self,
        run: impl FnOnce(&Engine, &mut Console) -> Result<Dynamic, Vec<Fault>>,
    ) -> Result<Dynamic, Failure> {
        let found = run(&self.engine, &mut self.console);
        found.map_err(|found| match Session::of_engine(&self.engine).cancellation().is_cancelled() {
            true => Diagnostic::new("stopped").into(),
            false => found.iter().map(faults::script).collect::<Vec<_>>().into(),
        })
    }

    /// Prints the value of an input, and the figures, tables and plots that it left.
    fn show(&mut self, value: &Dynamic, input: &str) -> Result<(), Failure> {
        let output = self.collector.output();
        let before = std::mem::replace(&mut self.shown, output.clone());
        if self.shared.json {
            let shown = to_json(value).unwrap_or_else(|_| show::brief(&self.engine, value).into());
            return if value.is_unit() { Ok(()) } else { print_line(&shown) };
        }
        if self.shared.quiet {
            return Ok(());
        }
        let fresh = ScriptOutput {
            measures: output
                .measures
                .into_iter()
                .filter(|(name, value)| before.measures.get(name) != Some(value))
                .collect(),
            tables: output.tables.into_iter().filter(|table| !before.tables.contains(table)).collect(),
            ..ScriptOutput::default()
        };
        let plots = output.plots.iter().filter(|plot| !before.plots.contains(plot)).map(show::plot);
        let files = output.files.names().into_iter().filter(|name| !before.files.names().contains(name));
        let files = files.map(|name| format!("{name} is written by `droptower script` alone\n"));
        let text: String = [table::script_output(&fresh)].into_iter().chain(plots).chain(files).collect();
        let value = show::value(&self.engine, value, input).unwrap_or_default();
        let text = format!("{text}{value}");
        if text.is_empty() { Ok(()) } else { print(text.trim_end()) }
    }

    fn complain(&self, diagnostics: &[Diagnostic]) {
        match self.shared.diagnostics {
            DiagnosticFormat::Json => print_records(diagnostics),
            _ => print_diagnostics(diagnostics),
        }
    }
}
