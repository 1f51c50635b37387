//! `droptower script`: a Rhai script over scenarios.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use rhai::{Dynamic, Scope};
use serde_json::{Map, Value, json};

use super::faults::{reading, script, storing};
use super::{Failure, Shared, digest, folder, print_figures, scenarios, table};
use crate::diagnostic::{Diagnostic, printable, shown_path};
use crate::finding::Finding;
use crate::functions;
use crate::identify::{self, Identity, SearchEvent, SearchHost};
use crate::post::{self, Evaluations};
use crate::report::StudyPage;
use crate::script::{
    Arguments, Fault, Limits, Message, OutputCollector, Script, ScriptOutput, Session, Warning, to_json,
};
use crate::store::{self, Draft, Origin, StoreError, run_files};
use crate::sweep;
use crate::units::with_decimal_point;

#[derive(Debug, Args)]
pub(super) struct ScriptArgs {
    /// The Rhai script
    pub path: PathBuf,
    /// The scenario that the script finds in args.scenario
    #[arg(long, value_name = "SCENARIO")]
    pub scenario: Option<String>,
    /// A value that the script finds in args: key=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub arg: Vec<String>,
    /// Change a key of every scenario: key.path=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Leave out a key that every scenario gives or inherits: key.path
    #[arg(long, value_name = "KEY")]
    pub unset: Vec<String>,
    /// Folder for the results, in place of runs/<name of the script>
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace results of another scenario or script in the same folder
    #[arg(long)]
    pub force: bool,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

/// Names that belong to a study's summary.
const RESERVED: [&str; 9] =
    ["script", "droptower", "study", "warning", "warnings", "findings", "tables", "plots", "files"];

/// A script that was run, and its output.
struct Studied {
    /// The script's name.
    name: String,
    /// Script, scenario, changes and arguments, which run the study again.
    call: Map<String, Value>,
    /// The text of the script.
    text: String,
    output: ScriptOutput,
    /// The finding that recordings behind it are virtual, which its output begins with.
    virtual_recordings: Option<Finding>,
}

pub(super) fn run(args: &ScriptArgs, shared: &Shared) -> Result<(), Failure> {
    if args.path.extension().is_some_and(|extension| extension == "toml") {
        let mistake = Diagnostic::new(format!("{} is a scenario", shown_path(&args.path)));
        return Err(mistake.hint(format!("run it with `droptower run {}`", shown_path(&args.path))).into());
    }
    let name = args.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let place = place(args.out.as_deref(), &name).map_err(|error| storing(&error))?;
    let origin = Origin::of_script(&args.path, args.scenario.as_deref().map(Path::new));
    if !args.force {
        origin.check(&place).map_err(|error| storing(&error))?;
    }
    let studied = studied(args, name, &place, shared.quiet)?;
    let files =
        store_results(&studied, &place, origin, args.force).map_err(|error| Failure::output(storing(&error)))?;
    print_figures(shared, &summary(&studied), || {
        let Studied { name, output, .. } = &studied;
        format!("{name}\n{}{}", table::script_output(output), digest::folder(&place, &files))
    })
}

/// Runs the script, whose results go to `place`; its messages are printed at once.
fn studied(args: &ScriptArgs, name: String, place: &Path, quiet: bool) -> Result<Studied, Failure> {
    let changes = scenarios::changes(&args.set, &args.unset)?;
    let print_line = move |line: &str| {
        if !quiet {
            // The report has every message, so one that cannot be printed is dropped.
            let _ = writeln!(io::stderr(), "{}", printable(line));
        }
    };
    let collector = OutputCollector::new(RESERVED.map(String::from).into());
    let collector = collector.with_listener(move |message| print_line(&message.to_string()));
    let searches = collector.clone();
    let host = SearchHost::new(Some(store::history_of(place)), move |event| match event {
        SearchEvent::Progress(progress) => print_line(&progress.to_string()),
        SearchEvent::OpenPoints(open) => print_line(&format!("note: profiles: {open} points remain")),
        SearchEvent::Warning(warning) => print_line(&Message::Finding(&Finding::new(warning)).to_string()),
        SearchEvent::Finished(convergence) => searches.add_search(convergence.clone()),
        SearchEvent::Correlation(correlation) => searches.add_correlation(correlation.clone()),
    });
    let evaluations =
        Evaluations::open(&args.store).map_err(|error| Failure::output(Diagnostic::new(error.to_string())))?;
    let evaluations = Arc::new(evaluations);
    let mut engine = functions::engine(Limits::STUDY);
    functions::register_output(&mut engine, &collector);
    functions::register_reading(&mut engine);
    Session::of_engine(&engine).report_to(&collector);
    post::register_studies(&mut engine, changes, Some(Arc::clone(&evaluations)));
    identify::register(&mut engine, &host);
    sweep::register(&mut engine, &evaluations);
    Arguments::register(&mut engine);
    let mut scope = Scope::new();
    let given = arguments(args)?;
    let call = call(args, &given, place)?;
    scope.push_constant("args", Arguments::new(given.clone()));
    let program = Script::read(&engine, &scope, &args.path).map_err(|error| reading(&error))?;
    check_read(&program, &given)?;
    check_commas(&program, &given)?;
    host.identify(Identity { script: program.text().into(), given: decisive(&call) });
    let stopped = |fault: Fault| match fault.numerical {
        true => Failure::numerical(script(&fault)),
        false => Failure::from(script(&fault)),
    };
    program.run(&engine, scope).map_err(stopped)?;
    let [taken, computed] = evaluations.counts();
    if taken > 0 {
        let all = taken + computed;
        print_line(&format!("note: {taken} of {all} runs were computed before ({})", shown_path(&args.store)));
    }
    let virtual_recordings = Warning::virtual_recordings(Session::of_engine(&engine).virtual_recordings());
    let virtual_recordings = virtual_recordings.map(|warning| Finding::new(&warning));
    if let Some(finding) = &virtual_recordings {
        print_line(&Message::Finding(finding).to_string());
    }
    let mut output = collector.output();
    output.findings.splice(..0, virtual_recordings.clone());
    Ok(Studied { name, call, text: program.text().into(), output, virtual_recordings })
}

/// Refuses arguments that the script does not read: one that is misspelt would have no effect.
fn check_read(script: &Script, given: &rhai::Map) -> Result<(), Vec<Diagnostic>> {
    let unread = given.keys().filter(|name| !script.mentions_argument(name));
    let mistake = |name: &rhai::Identifier| {
        let how = if name == "scenario" { "--scenario".into() } else { format!("--arg {name}") };
        Diagnostic::new(format!("the script does not read `args.{name}`"))
            .hint(format!("leave {how} out, or correct it"))
    };
    let mistakes: Vec<Diagnostic> = unread.map(mistake).collect();
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

/// Refuses `8,9`, which may be one number or two, unless the script reads a list of numbers or a text.
fn check_commas(script: &Script, given: &rhai::Map) -> Result<(), Vec<Diagnostic>> {
    let mistake = |(name, value): (&rhai::Identifier, &Dynamic)| {
        let value = value.to_string();
        let point = with_decimal_point(&value).filter(|point| point.parse::<f64>().is_ok())?;
        if name == "scenario" || script.reads_list_or_text(name) {
            return None;
        }
        let hint =
            format!("write one number with a decimal point: {point}; a list with a space: \"{}\"", spaced(&value));
        Some(Diagnostic::new(format!("decimal comma in --arg {name}={value}")).hint(hint))
    };
    let mistakes: Vec<Diagnostic> = given.iter().filter_map(mistake).collect();
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

/// Script, scenario, changes and arguments as they were given, and the working folder seen from the results at `place`.
fn call(args: &ScriptArgs, given: &rhai::Map, place: &Path) -> Result<Map<String, Value>, Vec<Diagnostic>> {
    let mut own = Map::new();
    for (name, value) in given.iter().filter(|(name, _)| *name != "scenario") {
        let value = to_json(value).map_err(|error| vec![Diagnostic::new(format!("--arg {name}: {error}"))])?;
        own.insert(name.to_string(), value);
    }
    let call = [
        ("script", json!(shown_path(&args.path))),
        ("scenario", json!(args.scenario)),
        ("set", json!(args.set)),
        ("unset", json!(args.unset)),
        ("args", Value::Object(own)),
        (run_files::STUDY_FOLDER, json!(store::path_from(place, Path::new(".")))),
    ];
    Ok(call.map(|(name, value)| (name.into(), value)).into_iter().collect())
}

/// The part of the call on which trials of a search depend: all but the path of the script and the working folder.
fn decisive(call: &Map<String, Value>) -> Map<String, Value> {
    let decisive = call.iter().filter(|(name, _)| *name != "script" && *name != run_files::STUDY_FOLDER);
    decisive.map(|(name, value)| (name.clone(), value.clone())).collect()
}

fn place(out: Option<&Path>, name: &str) -> Result<PathBuf, StoreError> {
    let place = match out {
        Some(folder) => folder.into(),
        None => store::place(Path::new("runs"), name)?,
    };
    store::check_places(std::slice::from_ref(&place))?;
    Ok(place)
}

/// The constant `args` of the script: numbers, booleans and text.
fn arguments(args: &ScriptArgs) -> Result<rhai::Map, Vec<Diagnostic>> {
    let mut map = rhai::Map::new();
    let mut mistakes = Vec::new();
    for argument in &args.arg {
        match argument.split_once('=') {
            Some((key, value)) => drop(map.insert(key.trim().into(), value_of(value.trim()))),
            None => mistakes.push(Diagnostic::new(format!("expected key=value after --arg, found `{argument}`"))),
        }
    }
    if let Some(scenario) = &args.scenario {
        map.insert("scenario".into(), scenario.clone().into());
    }
    if mistakes.is_empty() { Ok(map) } else { Err(mistakes) }
}

/// A list with a space behind its commas.
fn spaced(list: &str) -> String {
    list.trim().replace(',', ", ")
}

fn value_of(text: &str) -> Dynamic {
    let integer = text.parse::<i64>().map(Dynamic::from);
    let float = || text.parse::<f64>().map(Dynamic::from);
    let boolean = || text.parse::<bool>().map(Dynamic::from);
    integer.or_else(|_| float()).or_else(|_| boolean()).unwrap_or_else(|_| text.to_owned().into())
}

fn summary(studied: &Studied) -> Map<String, Value> {
    let Studied { name, call, output, virtual_recordings, .. } = studied;
    let mut summary = Map::new();
    summary.insert("script".into(), json!(name));
    summary.insert("droptower".into(), json!(env!("CARGO_PKG_VERSION")));
    summary.insert("study".into(), Value::Object(call.clone()));
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

fn store_results(studied: &Studied, place: &Path, origin: Origin, force: bool) -> Result<Vec<String>, StoreError> {
    let Studied { name, call, text, output, .. } = studied;
    let draft = Draft::begin(place, origin, force)?;
    let page = StudyPage { name, call, output, script: text };
    let files = folder::fill_study(&draft, &page, &summary(studied))?;
    draft.publish()?;
    Ok(files)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// One comma between digits is a list where the script reads a list, a text where it reads a text, and otherwise one
    /// number or two.
    #[test]
    fn a_comma_between_digits_is_what_the_script_reads() {
        let given = |script: &str, value: &str| {
            let mut engine = functions::engine(Limits::STUDY);
            Arguments::register(&mut engine);
            let mut scope = Scope::new();
            scope.push_constant("args", Arguments::default());
            let script = Script::compile(&engine, &scope, Path::new("s.rhai"), script).expect("a script");
            check_commas(&script, &[("a".into(), value_of(value))].into())
        };
        for script in ["args.a", "args.number(\"a\", 1)", "args.a; args.numbers(\"b\", [1, 2])"] {
            let mistakes = given(script, "8,9").expect_err("a mistake");
            assert_eq!(mistakes[0].message, "decimal comma in --arg a=8,9");
            let hint = "write one number with a decimal point: 8.9; a list with a space: \"8, 9\"";
            assert_eq!(mistakes[0].hint.as_deref(), Some(hint));
            for value in ["8, 9", "2.75,3.41", "2,3,4", "a,b", "8"] {
                assert!(given(script, value).is_ok(), "{script} {value}");
            }
        }
        for script in ["args.numbers(\"a\", [1, 2])", "let f = || { let t = args.text(\"a\", \"\"); t };"] {
            assert!(given(script, "8,9").is_ok(), "{script}");
        }
    }

    #[test]
    fn every_field_of_the_summary_is_reserved() {
        let studied = Studied {
            name: "study".into(),
            call: Map::new(),
            text: String::new(),
            output: ScriptOutput::default(),
            virtual_recordings: Some(Finding::of_script("virtual-recording", "a recording is virtual")),
        };
        let fields: BTreeSet<String> = summary(&studied).into_iter().map(|(name, _)| name).collect();
        assert_eq!(fields, RESERVED.map(String::from).into());
        let refused = OutputCollector::new(RESERVED.map(String::from).into()).measure("warnings", json!(["none"]));
        let message = refused.unwrap_err().to_string();
        let expected = "`warnings` is a field of the summary and cannot be replaced: report a warning with";
        assert!(message.starts_with(expected), "{message}");
    }
}
