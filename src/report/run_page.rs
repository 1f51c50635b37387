//! The page of one run.

use serde_json::{Map, Value};

use super::html::{self, escape};
use super::script_output::Fold;
use super::{drawn, error_maps, figure, film, key_figures, run_plots, script_output};
use base::diagnostic::shown_path;
use base::number::{duration, significant};
use lab::experiment::drop::Figures;
use plot::thinned;
use scene::model::{Model, Window};
use scene::scenario::{Assumption, assumptions};
use scene::simulate::Outcome;
use study::post::{self, COST, HEADER, ReferenceComparison, Results};
use study::store::run_files::{RUN_FILES, SNAPSHOTS};

/// The content of the page of a run.
#[derive(Clone, Copy)]
pub struct RunPage<'a> {
    /// The checked scenario.
    pub model: &'a Model,
    /// The run.
    pub outcome: &'a Outcome,
    /// Its figures and findings.
    pub results: &'a Results,
    /// The resolved scenario.
    pub scenario: &'a str,
    /// Why the run failed; `None` of a complete one.
    pub failure: Option<&'a str>,
    /// Names of the other files in the run's folder.
    pub files: &'a [String],
}

/// Most points of the signals, of the energies and of the script's plots, which keep the page below 3 MB.
const MOST_POINTS: [usize; 3] = [35_000, 10_000, 40_000];

/// `report.html` of a run.
pub fn run_page(run: &RunPage) -> String {
    let RunPage { model, outcome, results, .. } = run;
    let summary = results.summary(model);
    let body = [
        format!("<h1>{}</h1>\n{}", escape(&model.title), lead(run)),
        findings(run),
        key_figures::cards(model, results, run.failure.is_some(), &summary),
        html::section("Film", &film::figure(model, outcome, &results.signals)),
        html::section("Field", &error_maps::section(run)),
        html::section("Signals", &drawn::figures(&thinned(run_plots::signals(results), MOST_POINTS[0]))),
        script_output::sections(&results.script_output, MOST_POINTS[2], Fold::Long),
        html::section("Figures", &figures(&summary)),
        html::section("Assumed", &html::list(&assumed(run.scenario))),
        html::section("Audit", &audit(run)),
        html::section("Reference", &reference(run)),
        html::section("Log", &html::list(&results.script_output.log)),
        html::section("Files", &files(run)),
        html::section("Run it again", &again(run)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&model.title, &body.concat())
}

/// The opening of the page: what the run answers, then its subject and its reference.
fn lead(run: &RunPage) -> String {
    let RunPage { model, results, .. } = run;
    let file = |path: &std::path::Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let against = model.reference.as_ref().and_then(|reference| file(reference.files().next()?));
    let is_virtual = results.comparison.as_ref().is_some_and(ReferenceComparison::is_virtual);
    let has_signals = model.reference.as_ref().is_some_and(|reference| reference.signals.is_some());
    let kind = if has_signals { "recording" } else { "field" };
    let kind = if is_virtual { format!("the virtual {kind}") } else { format!("the {kind}") };
    let against = against.map_or(String::new(), |file| format!(", against {kind} {file}"));
    let answer = match &results.script_output.answer {
        Some(answer) => answer.clone(),
        None => post::answer(model, results, run.failure.is_some()),
    };
    let subject = format!("{}: {}{against}", model.name, model.subject());
    format!("<p class=\"lead\">{}</p>\n<p class=\"note\">{}</p>\n", escape(&answer), escape(&subject))
}

/// Failure and warnings, then notes.
fn findings(run: &RunPage) -> String {
    let failure = run.failure.map(|cause| format!("The run failed: {cause}"));
    html::findings(failure.into_iter().collect(), run.results.measures.findings().iter())
}

/// All figures of the summary, those of the machine after the others.
fn figures(summary: &Map<String, Value>) -> String {
    let is_cost = |name: &String| COST.contains(&name.as_str());
    let own = |name: &String| !HEADER.contains(&name.as_str());
    let figures = figure::table(summary.iter().filter(|(name, _)| own(name) && !is_cost(name)));
    let cost = figure::table(summary.iter().filter(|(name, _)| is_cost(name)));
    format!("{figures}<h3>Mesh and machine</h3>\n{cost}")
}

/// Energies, strain rates and element quality.
fn audit(run: &RunPage) -> String {
    let audit = run.results.measures.audit();
    let (energies, negligible) = run_plots::energies(&run.outcome.energies);
    let note = match negligible.as_slice() {
        [] => String::new(),
        names => format!(
            "<p class=\"note\">below {} % of the largest: {}</p>\n",
            run_plots::NEGLIGIBLE * 100.0,
            escape(&names.join(", "))
        ),
    };
    let rates = drawn::rates("Strain rates while loading", &audit.strain_rates);
    let energies = drawn::figures(&thinned(vec![energies], MOST_POINTS[1]));
    let energies = format!("<div>\n{energies}{note}</div>\n");
    let header =
        ["face", "elements", "shortest edge (mm)", "longest edge (mm)", "aspect ratio", "scaled Jacobian", "skew"];
    let row = |(face, mesh): (usize, &study::post::MeshFigures)| {
        let sizes = [mesh.shortest_edge_m * 1e3, mesh.longest_edge_m * 1e3];
        let shape = [mesh.aspect_ratio, mesh.scaled_jacobian, mesh.skew];
        let numbers = sizes.into_iter().chain(shape).map(|number| significant(number, figure::DIGITS));
        [(face + 1).to_string(), mesh.elements.to_string()].into_iter().chain(numbers).collect()
    };
    let meshes: Vec<Vec<String>> = audit.meshes.iter().enumerate().map(row).collect();
    let meshes = html::table_of_numbers(0, &header.map(String::from), &meshes);
    [drawn::side_by_side([energies, rates]), format!("<h3>Worst elements of each face</h3>\n{meshes}")].concat()
}

/// The reference: the window of the comparison, the notes of its file, and how it was reduced.
fn reference(run: &RunPage) -> String {
    let (Some(reference), Some(comparison)) = (&run.model.reference, &run.results.comparison) else {
        return String::new();
    };
    let [from, to] = comparison.window;
    let window = match reference.window {
        Window::Loading => "loading",
        Window::All => "the whole recording",
        Window::Range(_) => "as given",
    };
    let mut files = reference.files();
    let first = files.next().map_or_else(String::new, |path| shown_path(path));
    let more = match files.count() {
        0 => String::new(),
        more => format!(" and {more} more files"),
    };
    let over = format!("{first}{more}; errors are taken from {} to {} ({window}).", duration(from), duration(to));
    let notes = comparison.notes();
    let reduced = comparison.drop.as_ref().map_or_else(String::new, reduced);
    format!("<p>{}</p>\n{reduced}{}", escape(&over), html::list(&notes))
}

/// The figures of a raw recording with their intervals.
fn reduced(drop: &Figures) -> String {
    let row = |name: &str, value: Option<f64>, interval: Option<[f64; 2]>, [factor, decimals]: [f64; 2], unit: &str| {
        let shown = |value: f64| format!("{:.*}", decimals as usize, factor * value);
        let interval = interval.map(|[low, high]| format!("{} to {} {unit}", shown(low), shown(high)));
        value.map(|value| vec![name.to_owned(), format!("{} {unit}", shown(value)), interval.unwrap_or_default()])
    };
    let speed = Some(drop.impact_velocity_m_s);
    let rows = [
        row("impact speed", speed, drop.impact_velocity_interval_m_s, [1.0, 3.0], "m/s"),
        row("lowest point", drop.peak_displacement_m, drop.peak_displacement_interval_m, [1e3, 1.0], "mm"),
        row("first contact", Some(drop.contact_time_s), drop.contact_time_interval_s, [1.0, 4.0], "s"),
        row("energy absorbed", drop.energy_absorption, drop.energy_absorption_interval, [100.0, 1.0], "%"),
    ];
    let time_constant = drop.time_constant_interval_s.map(|ends| {
        let [low, high] = ends.map(|end| end.map_or_else(|| "no limit".to_owned(), |end| format!("{:.1}", 1e3 * end)));
        let value =
            drop.time_constant_s.map_or_else(|| "DC-coupled, or not told".into(), |t| format!("{:.1} ms", 1e3 * t));
        vec!["time constant of the accelerometer".to_owned(), value, format!("{low} to {high} ms")]
    });
    let rows: Vec<Vec<String>> = rows.into_iter().flatten().chain(time_constant).collect();
    let head = ["the recording", "value", "interval of 95 %"].map(String::from);
    html::table(&head, &rows)
}

/// The files of the run folder with their content; those that are not of the run were written by the script.
fn files(run: &RunPage) -> String {
    let content = |name: &String| RUN_FILES.iter().find(|(known, _)| known == name).map(|(_, content)| *content);
    let row = |name: &String| vec![name.clone(), content(name).unwrap_or("written by the script").to_owned()];
    let is_snapshot = |name: &&String| name.split('/').next() == Some(SNAPSHOTS);
    let (snapshots, named): (Vec<&String>, Vec<&String>) = run.files.iter().partition(is_snapshot);
    let mut rows: Vec<Vec<String>> = named.into_iter().map(row).collect();
    if !snapshots.is_empty() {
        rows.push(vec![format!("{SNAPSHOTS}/"), format!("{} snapshots for ParaView", snapshots.len())]);
    }
    html::table(&["file", "what it holds"].map(String::from), &rows)
}

/// The values that the scenario assumes, each with its comment.
fn assumed(scenario: &str) -> Vec<String> {
    let line = |Assumption { key, value, comment }| format!("{key} = {value}: {comment}");
    assumptions(scenario).into_iter().map(line).collect()
}

/// The command and the scenario that repeat the run.
fn again(run: &RunPage) -> String {
    let command = html::verbatim("droptower run scenario.toml --out again");
    let scenario = html::verbatim(run.scenario);
    format!(
        "<p>In the folder of this run, with droptower {}; the same version gives the same signals to the bit:</p>\n\
         {command}\
         <details open>\n<summary>scenario.toml</summary>\n{scenario}</details>\n",
        env!("CARGO_PKG_VERSION")
    )
}
