//! `droptower script` and `calibrate`: a Rhai script over scenarios, or a study in its place.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use rhai::{Dynamic, Engine, Scope};
use serde_json::{Map, Value, json};

use crate::args::{Changes, Given};
use crate::batch::{self, BatchArgs, Ends};
use crate::failure::{ExitStatus, both, reading, refuse, script};
use crate::folder::{self, ResultPlace};
use crate::live_page::LivePage;
use crate::shipped::{self, Named};
use crate::{Failure, Shared, print_figures, shell, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::file;
use base::finding::Finding;
use base::units::with_decimal_point;
use report::StudyPage;
use scene::scenario::Assignment;
use study::calibrate::{self, StudyFile};
use study::evaluate::Evaluations;
use study::identify::{self, SearchEvent, SearchHost};
use study::scenario_functions::{self, Scenarios};
use study::script::{
    About, Arguments, Fault, Limits, Message, OutputCollector, Script, ScriptOutput, Session, Warning, stop_beyond,
    to_json,
};
use study::store::evaluations::Share;
use study::store::{self, Draft, Origin, ProgressFolder, STOPPED, run_files};
use study::{functions, sweep};

#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub(crate) struct ScriptArgs {
    /// The Rhai script: a file, or the name of a shipped one (`--list`)
    #[arg(value_name = "SCRIPT", required_unless_present_any = ["help", "list"], add = shell::scripts())]
    pub path: Option<PathBuf>,
    /// Print what the script does and its arguments; without a script, what this command does
    #[arg(long, short)]
    pub help: bool,
    /// List the shipped scripts
    #[arg(long)]
    pub list: bool,
    /// Find mistakes in the script and its arguments without running it
    #[arg(long)]
    pub check: bool,
    #[command(flatten)]
    pub given: Given,
    #[command(flatten)]
    pub batch: BatchArgs,
    /// The study that is calibrated in the place of a script
    #[arg(skip)]
    pub study: Option<Arc<StudyFile>>,
}

/// Names that belong to the summary of a script.
const RESERVED: [&str; 10] =
    ["script", "droptower", "study", "answer", "warning", "warnings", "findings", "tables", "plots", "files"];

/// A script that was run, and its output.
struct ScriptRun {
    /// The script's name.
    name: String,
    /// Script, scenario, changes and arguments, which run it again.
    call: Map<String, Value>,
    /// The script and its modules.
    program: Script,
    output: ScriptOutput,
    /// The finding that recordings behind it are virtual, which its output begins with.
    virtual_recordings: Option<Finding>,
    /// Why it ended before its end, of a script that had results by then.
    failure: Option<Failure>,
}

impl ScriptArgs {
    /// The script; there is one unless help is asked for.
    fn path(&self) -> &Path {
        self.path.as_deref().unwrap_or(Path::new(""))
    }

    /// A fault of the script, in a study at its place there.
    fn fault(&self, fault: &Fault) -> Diagnostic {
        let own = script(fault);
        match self.study.as_ref().filter(|_| fault.file == self.path()) {
            Some(study) => Diagnostic { span: None, ..own }.at(&study.place()),
            None => own,
        }
    }
}

pub(crate) fn run(args: &ScriptArgs, shared: &Shared) -> Result<(), Failure> {
    let begin = Instant::now();
    if args.help {
        return shipped::show(args.path.as_deref(), shared);
    }
    if args.list {
        return shipped::list(shared);
    }
    if args.study.is_none() && args.path().extension().is_some_and(|extension| extension == "toml") {
        let mistake = Diagnostic::new(format!("{} is no script", shown_path(args.path())));
        let path = shown_path(args.path());
        let hint = format!("`droptower run {path}` runs a scenario, `droptower calibrate {path}` a study");
        return Err(mistake.hint(hint).into());
    }
    let name = args.path().file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let origin = Origin::of_script(args.path(), args.given.scenario.as_deref().map(Path::new));
    let place = args.batch.results.place(&name, origin)?;
    let (share, deadline) = both(args.batch.share(), args.batch.deadline(begin))?;
    if args.check {
        return check(args, &place.folder, shared);
    }
    let page = LivePage::new(&name, ProgressFolder::new(&place.folder, share), {
        let quiet = shared.quiet;
        move |line| tell(&format!("note: {line}"), quiet)
    });
    let evaluations = Arc::new(args.batch.evaluations(share, &page));
    let task = Task { args, shared, name, place, page, evaluations, deadline };
    task.complete().inspect_err(|failure| task.page.failed(failure))
}

/// Finds mistakes without running anything; no store of evaluations is opened.
fn check(args: &ScriptArgs, place: &Path, shared: &Shared) -> Result<(), Failure> {
    let (host, collector) = (SearchHost::new(|_| {}), OutputCollector::new(Vec::new()));
    let changes = args.given.changes.assignments()?;
    if let Some(study) = &args.study {
        study.check(&Scenarios { changes, evaluations: None })?;
    } else {
        let engine = engine(changes, &Arc::new(Evaluations::new(&args.batch.store)), &host, &collector, None);
        compiled(args, &engine, place)?;
    }
    let figures = json!({ "script": shown_path(args.path()), "mistakes": 0 });
    print_figures(shared, &figures, || format!("{}: no mistakes", shown_path(args.path())))
}

/// Prints a line on standard error, unless `quiet`; the report has every message of a script.
fn tell(line: &str, quiet: bool) {
    if !quiet {
        crate::tell(line);
    }
}

/// Words of scripts that compute runs, which have a page from their beginning; others from their first run on.
const RUNNING: [&str; 5] = ["simulate", "minimize", "sweep", "threshold", "calibrate"];

/// A script that is called: where its records and results go, and what shows how far it is.
struct Task<'a> {
    args: &'a ScriptArgs,
    shared: &'a Shared,
    name: String,
    place: ResultPlace,
    page: LivePage,
    evaluations: Arc<Evaluations>,
    deadline: Option<Instant>,
}

impl Task<'_> {
    /// Runs the script, stores its results and prints them.
    fn complete(&self) -> Result<(), Failure> {
        let (run, is_stopped) = self.run()?;
        if is_stopped {
            return self.unfinished(&run);
        }
        if self.evaluations.share() != Share::WHOLE {
            if let Some(failure) = run.failure {
                return Err(failure);
            }
            self.page.discard();
            return self.part();
        }
        let (stored, files) = self.store(&run)?;
        if let Some(Failure { diagnostics, .. }) = &run.failure {
            tell(&format!("note: {} has what was found before", shown_path(&stored)), self.shared.quiet);
            return Err(Failure { status: ExitStatus::OutputFailed, diagnostics: diagnostics.clone(), drawing: None });
        }
        self.page.ended(&run.name);
        print_figures(self.shared, &summary(&run), || {
            format!("{}\n{}{files}", run.name, terminal::script_output(&run.output))
        })
    }

    /// The answer of a process that computed a part of the runs.
    fn part(&self) -> Result<(), Failure> {
        let [cache_hits, computed] = self.evaluations.counts();
        let script = shown_path(self.args.path());
        let figures = json!({ "script": script, "reused": cache_hits, "computed": computed });
        print_figures(self.shared, &figures, || format!("{script}: {computed} runs computed here"))
    }

    /// A script that was stopped by a signal or its deadline: one of several processes has done its work, another one has not,
    /// and leaves what it knows.
    fn unfinished(&self, run: &ScriptRun) -> Result<(), Failure> {
        if self.evaluations.share() != Share::WHOLE {
            self.page.stopped();
            return self.part();
        }
        let mut summary_so_far = Map::from_iter([("stopped".to_owned(), Value::Bool(true))]);
        summary_so_far.extend(self.page.summary());
        summary_so_far.extend(summary(run));
        let folder = self.page.folder();
        let written = folder::json(&summary_so_far).and_then(|text| folder.write(STOPPED, &text));
        self.page.stopped();
        written.map_err(|error| Failure::unstored(&error))?;
        let mistake = Diagnostic::new(format!("{} was stopped before its end", shown_path(self.args.path())));
        let hint = "its runs are kept, and the same command goes on from there";
        Err(Failure::output(mistake.hint(format!("{hint}; {} has the best so far", shown_path(folder.path())))))
    }

    /// Runs the script; its messages are printed at once. With it, whether it was stopped.
    fn run(&self) -> Result<(ScriptRun, bool), Failure> {
        let Task { args, place, page, evaluations, .. } = self;
        let quiet = self.shared.quiet;
        let print_line = move |line: &str| tell(line, quiet);
        let collector = OutputCollector::new(RESERVED.map(String::from).into());
        let messages = page.clone();
        let collector = collector.with_listener(move |message| {
            let message = message.to_string();
            print_line(&message);
            messages.note_message(&message);
        });
        let (searches, shown) = (collector.clone(), page.clone());
        let host = SearchHost::new(move |event| {
            shown.note_search(&event);
            match event {
                SearchEvent::Progress(_, progress) => print_line(&progress.to_string()),
                SearchEvent::Followed(text) => print_line(text),
                SearchEvent::Finished(convergence) => searches.add_search(convergence.clone()),
                SearchEvent::Correlation(correlation) => searches.add_correlation(correlation.clone()),
                SearchEvent::Begun(_) | SearchEvent::Trial(..) | SearchEvent::Ended(_) => {}
            }
        });
        let mut engine = engine(args.given.changes.assignments()?, evaluations, &host, &collector, args.study.as_ref());
        let Compiled { program, scope, call } = compiled(args, &engine, &place.folder)?;
        let replaced = replaced(&place.folder, &call).filter(|_| !place.force && evaluations.share() == Share::WHOLE);
        replaced.iter().for_each(|note| print_line(&format!("note: {note}")));
        let stopped = |fault: Fault| match fault.numerical {
            true => Failure::numerical(args.fault(&fault)),
            false if fault.may_pass => Failure::output(args.fault(&fault)),
            false => Failure::from(args.fault(&fault)),
        };
        let session = Session::of_engine(&engine);
        let (stop, given_up) = (session.stop().clone(), session.cancellation().clone());
        stop_beyond(&mut engine, Limits::STUDY, &given_up);
        let ends = || Ends { stop: stop.clone(), given_up: given_up.clone() };
        let told = page.clone();
        batch::end_on_signals(ends(), move || {
            tell("note: stops once what runs has ended; Ctrl-C again gives it up", quiet);
            told.stopping();
        })?;
        let text = program.whole_text();
        // Without the scenario that it reads a script ends before its first run.
        let has_scenario = args.given.scenario.is_some() || !program.mentions_argument("scenario");
        if has_scenario && RUNNING.iter().any(|word| text.contains(word)) {
            page.begin();
        }
        let run = || page.during(|| program.run(&engine, scope));
        let ran = batch::watched(evaluations, &given_up, self.deadline, run);
        let (is_stopped, failure) = match ran {
            Err(_) if ends().is_over() => (true, None),
            Err(fault) if collector.output().tables.is_empty() => return Err(stopped(fault)),
            Err(fault) => (false, Some(stopped(fault))),
            Ok(_) => (false, None),
        };
        let [cache_hits, computed] = evaluations.counts();
        if cache_hits > 0 {
            let all = cache_hits + computed;
            print_line(&format!(
                "note: {cache_hits} of {all} runs were computed before ({})",
                shown_path(&args.batch.store)
            ));
        }
        let virtual_recordings = Warning::virtual_recordings(Session::of_engine(&engine).virtual_recordings());
        let virtual_recordings = virtual_recordings.map(|warning| Finding::new(&warning));
        if let Some(finding) = &virtual_recordings {
            print_line(&Message::Finding(finding).to_string());
        }
        let mut output = collector.output();
        let of_runs = terminal::findings_of_runs(&Session::of_engine(&engine).run_findings(), &output.findings);
        terminal::findings_of_run("", &of_runs).lines().for_each(print_line);
        output.findings.splice(..0, virtual_recordings.clone());
        output.findings.extend(of_runs);
        if let Some(failure) = &failure {
            let cause = failure.diagnostics.first().map_or_else(String::new, |own| own.message.clone());
            output.findings.insert(0, Finding::new(&Warning::EndedEarly { cause }));
        }
        Ok((ScriptRun { name: self.name.clone(), call, program, output, virtual_recordings, failure }, is_stopped))
    }

    /// Writes the results; those of a script that ended before its end go to a folder of their own. Where they are, and their files.
    fn store(&self, run: &ScriptRun) -> Result<(PathBuf, String), Failure> {
        let ScriptRun { name, call, program, output, .. } = run;
        let modules: Vec<(&str, &str)> = program.modules().map(|(name, source)| (name, &*source.text)).collect();
        let script = self.args.study.as_ref().map_or_else(|| program.text(), |study| &study.source.text);
        let page = report::study_page(&StudyPage { name, call, output, script, modules: &modules });
        let publish = if run.failure.is_some() { Draft::publish_failed } else { Draft::publish };
        self.place.store(&summary(run), |files| files.script_output(output), page, publish)
    }
}

/// The interpreter with all functions of studies, whose scenarios have these changes.
pub(crate) fn engine(
    changes: Vec<Assignment>,
    evaluations: &Arc<Evaluations>,
    host: &SearchHost,
    collector: &OutputCollector,
    study: Option<&Arc<StudyFile>>,
) -> Engine {
    let mut engine = functions::engine(Limits::STUDY);
    functions::register_output(&mut engine, collector);
    functions::register_reading(&mut engine);
    Session::of_engine(&engine).report_to(collector);
    let scenarios = Scenarios { changes, evaluations: Some(Arc::clone(evaluations)) };
    scenario_functions::register(&mut engine, &scenarios);
    identify::register(&mut engine, host);
    sweep::register(&mut engine, evaluations);
    calibrate::register(&mut engine, &scenarios, host, collector, study);
    Arguments::register(&mut engine);
    engine
}

/// A script that can run.
struct Compiled {
    program: Script,
    scope: Scope<'static>,
    call: Map<String, Value>,
}

/// The script and its arguments, without mistakes.
fn compiled(args: &ScriptArgs, engine: &Engine, place: &Path) -> Result<Compiled, Failure> {
    let given = args.given.values()?;
    let call = call(args, &given, place)?;
    let mut scope = Scope::new();
    // The arguments are checked against what the script declares, so its text comes first.
    scope.push_constant("args", Arguments::default());
    let of_study = || Named { path: args.path().to_owned(), text: Some(Cow::Borrowed(StudyFile::SCRIPT)) };
    let program = match args.study.as_ref().map_or_else(|| shipped::named(args.path()), |_| Ok(of_study()))? {
        Named { path, text: Some(text) } => Script::compile(engine, &scope, &path, &text)
            .map_err(|faults| faults.iter().map(|fault| args.fault(fault)).collect::<Vec<Diagnostic>>())?,
        Named { path, text: None } => Script::read(engine, &scope, &path).map_err(|error| reading(&error))?,
    };
    let about = About::read(args.path(), program.text())?;
    check_declared(&program, &about)?;
    refuse(about.check(&given))?;
    check_read(&program, &given)?;
    check_commas(&program, &about, &given)?;
    let mut scope = Scope::new();
    scope.push_constant("args", Arguments::new(about.complete(&given)));
    Ok(Compiled { program, scope, call })
}

/// Refuses declarations of arguments that the script does not read.
fn check_declared(script: &Script, about: &About) -> Result<(), Failure> {
    let unread = about.arguments.iter().filter(|one| !script.mentions_argument(&one.name));
    refuse(unread.map(|one| Diagnostic::new(format!("the script declares --arg {} and does not read it", one.name))))
}

/// Refuses arguments that the script does not read: one that is misspelt would have no effect.
fn check_read(script: &Script, given: &rhai::Map) -> Result<(), Failure> {
    let unread = given.keys().filter(|name| !script.mentions_argument(name));
    let mistake = |name: &rhai::Identifier| {
        let how = if name == "scenario" { "--scenario".into() } else { format!("--arg {name}") };
        Diagnostic::new(format!("the script does not read `args.{name}`"))
            .hint(format!("leave {how} out, or correct it"))
    };
    refuse(unread.map(mistake))
}

/// Refuses `8,9`, which may be one number or two, unless the script declares or reads a list of numbers or a text.
fn check_commas(script: &Script, about: &About, given: &rhai::Map) -> Result<(), Failure> {
    let mistake = |(name, value): (&rhai::Identifier, &Dynamic)| {
        let value = value.to_string();
        let point = with_decimal_point(&value).filter(|point| point.parse::<f64>().is_ok())?;
        if name == "scenario" || about.has_commas(name) || script.reads_list_or_text(name) {
            return None;
        }
        let hint =
            format!("write one number with a decimal point: {point}; a list with a space: \"{}\"", spaced(&value));
        Some(Diagnostic::new(format!("decimal comma in --arg {name}={value}")).hint(hint))
    };
    refuse(given.iter().filter_map(mistake))
}

/// Script, scenario, changes and arguments as they were given, and the working folder seen from the results at `place`.
fn call(args: &ScriptArgs, given: &rhai::Map, place: &Path) -> Result<Map<String, Value>, Failure> {
    let mut own = Map::new();
    for (name, value) in given.iter().filter(|(name, _)| *name != "scenario") {
        let value = to_json(value).map_err(|error| Diagnostic::new(format!("--arg {name}: {error}")))?;
        own.insert(name.to_string(), value);
    }
    let call = [
        ("script", json!(shown_path(args.path()))),
        ("scenario", json!(args.given.scenario)),
        ("set", json!(args.given.changes.set)),
        ("unset", json!(args.given.changes.unset)),
        ("args", Value::Object(own)),
        (run_files::WORKING_FOLDER, json!(store::path_from(place, Path::new(".")))),
    ];
    Ok(call.map(|(name, value)| (name.into(), value)).into_iter().collect())
}

/// Says which changes and arguments of results at `place`, which are about to be replaced, were others than those of `call`.
fn replaced(place: &Path, call: &Map<String, Value>) -> Option<String> {
    let text = file::read(&place.join(run_files::SUMMARY), run_files::MOST_BYTES).ok()?;
    let former: Value = serde_json::from_slice(&text).ok()?;
    folder::replaced(place, "results", [given(former["study"].as_object()?), given(call)])
}

/// What a call gives beside script and scenario, by key and argument.
fn given(call: &Map<String, Value>) -> BTreeMap<String, String> {
    let list = |name: &str| call.get(name).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    let pair =
        |change: &str| change.split_once('=').map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()));
    let args = call.get("args").and_then(Value::as_object).into_iter().flatten();
    let args = args.map(|(name, value)| (format!("--arg {name}"), value.to_string()));
    let left_out = list("unset").map(|key| (key.to_owned(), String::new()));
    list("set").filter_map(pair).chain(left_out).chain(args).collect()
}

/// A list with a space behind its commas.
fn spaced(list: &str) -> String {
    list.trim().replace(',', ", ")
}

fn summary(run: &ScriptRun) -> Map<String, Value> {
    let ScriptRun { name, call, output, virtual_recordings, .. } = run;
    let mut summary = Map::new();
    summary.insert("script".into(), json!(name));
    summary.insert("droptower".into(), json!(env!("CARGO_PKG_VERSION")));
    summary.insert("study".into(), Value::Object(call.clone()));
    summary.extend(report::study_answer(output).map(|answer| ("answer".into(), json!(answer))));
    summary.extend(virtual_recordings.iter().map(|finding| ("warning".into(), json!(finding.message))));
    let warnings = output.findings.iter().filter(|finding| finding.is_warning());
    summary.insert("warnings".into(), warnings.map(|warning| json!(warning.message)).collect());
    summary.insert("findings".into(), json!(output.findings));
    summary.extend(output.measures.clone());
    let tables = output.tables.iter().map(|(name, rows)| (name.clone(), json!(rows)));
    summary.insert("tables".into(), Value::Object(tables.collect()));
    summary.insert("plots".into(), output.plots.iter().map(|plot| plot.title.clone()).collect());
    summary.insert("files".into(), output.files.names().into());
    summary
}

#[derive(Clone, Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// The study: tests, parameters, predictions (`droptower new study study.toml`)
    #[arg(value_name = "STUDY", add = shell::scenarios())]
    path: PathBuf,
    #[command(flatten)]
    changes: Changes,
    /// Find mistakes in the study without running it
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    batch: BatchArgs,
}

pub(crate) fn calibrate(args: &CalibrateArgs, shared: &Shared) -> Result<(), Failure> {
    let study = Some(Arc::new(StudyFile::read(&args.path)?));
    let CalibrateArgs { path, changes, check, batch } = args.clone();
    let given = Given { scenario: None, arg: Vec::new(), changes };
    run(&ScriptArgs { path: Some(path), help: false, list: false, check, given, batch, study }, shared)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use study::script::{self, argument_value};

    use super::*;

    /// One comma between digits is a list where the script reads a list, a text where it reads a text, and otherwise one
    /// number or two.
    #[test]
    fn a_comma_between_digits_is_what_the_script_reads() {
        let given = |text: &str, value: &str| {
            let mut engine = functions::engine(Limits::STUDY);
            Arguments::register(&mut engine);
            let mut scope = Scope::new();
            scope.push_constant("args", Arguments::default());
            let script = Script::compile(&engine, &scope, Path::new("s.rhai"), text).expect("a script");
            let about = About::read(Path::new("s.rhai"), text).expect("declarations");
            check_commas(&script, &about, &[("a".into(), argument_value(value))].into())
        };
        for script in ["args.a", "args.number(\"a\", 1)", "args.a; args.numbers(\"b\", [1, 2])"] {
            let mistakes = given(script, "8,9").expect_err("a mistake").diagnostics;
            assert_eq!(mistakes[0].message, "decimal comma in --arg a=8,9");
            let hint = "write one number with a decimal point: 8.9; a list with a space: \"8, 9\"";
            assert_eq!(mistakes[0].hint.as_deref(), Some(hint));
            for value in ["8, 9", "2.75,3.41", "2,3,4", "a,b", "8"] {
                assert!(given(script, value).is_ok(), "{script} {value}");
            }
        }
        let declared = ["//! --arg a=1, 2  ends\nargs.a", "//! --arg a=x,y  names\nargs.a"];
        let read = ["args.numbers(\"a\", [1, 2])", "let f = || { let t = args.text(\"a\", \"\"); t };"];
        for script in [declared, read].concat() {
            assert!(given(script, "8,9").is_ok(), "{script}");
        }
    }

    #[test]
    fn every_field_of_the_summary_is_reserved() {
        let run = ScriptRun {
            name: "study".into(),
            call: Map::new(),
            program: Script::compile(&script::engine(Limits::STUDY), &Scope::new(), Path::new("s.rhai"), "")
                .expect("a script"),
            output: ScriptOutput { answer: Some("yes".into()), ..ScriptOutput::default() },
            virtual_recordings: Some(Finding::of_script("virtual-recording", "a recording is virtual")),
            failure: None,
        };
        let fields: BTreeSet<String> = summary(&run).into_iter().map(|(name, _)| name).collect();
        assert_eq!(fields, RESERVED.map(String::from).into());
        let refused = OutputCollector::new(RESERVED.map(String::from).into()).measure("warnings", json!(["none"]));
        let message = refused.unwrap_err().to_string();
        let expected = "`warnings` is a field of the summary and cannot be replaced: report a warning with";
        assert!(message.starts_with(expected), "{message}");
    }
}
