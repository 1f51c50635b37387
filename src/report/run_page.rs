//! The page of one run.

use serde_json::{Map, Value};

use crate::html::{self, escape};
use crate::panes::{self, Pane, PaneCurve, Shown};
use crate::script_output::{self, Fold};
use crate::{drawn, error_maps, figure, film};
use base::diagnostic::shown_path;
use base::number::{duration, significant};
use base::written::digits;
use lab::experiment::drop::Figures;
use lab::signal::column::Column;
use lab::signal::{Channel, Recording, Series};
use membrane::material::{self, Law, RateCurves};
use plot::{Curve, Plot, TIME, thinned};
use scene::model::{Model, Window};
use scene::scenario::{Assumption, Phase, assumptions};
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
    let parts = [
        subject(run),
        findings(run),
        figure::cards(model, results, run.failure.is_some(), &summary),
        html::section("Film", &film::figure(model, outcome, &results.signals)),
        html::section("Field", &error_maps::section(run)),
        html::section("Signals", &drawn::figures(&thinned(signals(results), MOST_POINTS[0]))),
        script_output::sections(&results.script_output, MOST_POINTS[2], Fold::Long),
        html::section("Material", &drawn::medium(&materials(model))),
        html::section("Figures", &figures(&summary)),
        html::section("Assumed", &html::list(&assumed(run.scenario))),
        html::section("Audit", &audit(run)),
        html::section("Reference", &reference(run)),
        html::section("Log", &html::list(&results.script_output.log)),
        html::section("Files", &files(run)),
        html::section("Run it again", &again(run)),
    ];
    let answer = results.script_output.answer.clone();
    let answer = answer.unwrap_or_else(|| post::answer(model, results, run.failure.is_some()));
    html::finished(&model.title, &answer, &parts)
}

/// The subject of the run and its reference.
fn subject(run: &RunPage) -> String {
    let RunPage { model, results, .. } = run;
    let file = |path: &std::path::Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let against = model.reference.as_ref().and_then(|reference| file(reference.files().next()?));
    let is_virtual = results.comparison.as_ref().is_some_and(ReferenceComparison::is_virtual);
    let has_signals = model.reference.as_ref().is_some_and(|reference| reference.signals.is_some());
    let kind = if has_signals { "recording" } else { "field" };
    let kind = if is_virtual { format!("the virtual {kind}") } else { format!("the {kind}") };
    let against = against.map_or(String::new(), |file| format!(", against {kind} {file}"));
    html::note(&format!("{}: {}{against}", model.name, model.subject()))
}

/// Failure and warnings, then notes.
fn findings(run: &RunPage) -> String {
    let failure = run.failure.map(|cause| format!("The run failed: {cause}"));
    html::findings(failure.into_iter().collect(), run.results.findings.iter())
}

/// Nominal stress over strain of MD and TD up to the break as the run computes them, with their multipliers: a plot for each
/// different film with such curves.
fn materials(model: &Model) -> Vec<Plot> {
    let mut plots: Vec<Plot> = Vec::new();
    for (face, number) in model.faces.iter().zip(1..) {
        let curves = fibre_curves(&face.material.law);
        if !curves.is_empty() && plots.iter().all(|plot| plot.curves != curves) {
            let of = if plots.is_empty() { String::new() } else { format!(" of face {number}") };
            plots.push(Plot::new(format!("Stress over strain{of}"), ["strain (%)", "nominal stress (MPa)"], curves));
        }
    }
    plots
}

/// The curves of MD and TD by the names of their keys; none of film without them.
fn fibre_curves(law: &Law) -> Vec<Curve> {
    let line = |name: String, curve: &material::Curve| {
        let points = std::iter::once(&[0.0, 0.0]).chain(curve.points());
        Curve::line(name, points.map(|[strain, stress]| [100.0 * strain, 1e-6 * stress]))
    };
    let by_rate = |side: &str, curves: &RateCurves| match curves.single() {
        Some(curve) => vec![line(format!("{side}.curve"), curve)],
        None => {
            curves.curves().iter().map(|(rate, curve)| line(format!("{side}, {} 1/s", digits(*rate)), curve)).collect()
        }
    };
    match law {
        Law::Fabric(fabric) => vec![line("md.curve".into(), fabric.md()), line("td.curve".into(), fabric.td())],
        Law::RateFabric(fabric) => [by_rate("md", fabric.md()), by_rate("td", fabric.td())].concat(),
        _ => vec![],
    }
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
    let audit = &run.results.audit;
    let (energies, negligible) = energies(&run.outcome.energies);
    let note = match negligible.as_slice() {
        [] => String::new(),
        names => html::note(&format!("below {} % of the largest: {}", NEGLIGIBLE * 100.0, names.join(", "))),
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
    let meshes = html::table_of_numbers(0, &header, &meshes);
    [drawn::side_by_side([energies, rates]), format!("<h3>Worst elements of each face</h3>\n{meshes}")].concat()
}

/// The reference: the window of the comparison, the notes of its file, and how it was reduced.
fn reference(run: &RunPage) -> String {
    let (Some(reference), Some(comparison)) = (&run.model.reference, &run.results.comparison) else {
        return String::new();
    };
    let [from, to] = comparison.window;
    let window = match reference.written.window {
        Window::Phase(Phase::Loading) => "loading",
        Window::Phase(Phase::All) => "the whole recording",
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
        row("loading energy absorbed", drop.energy_absorption, drop.energy_absorption_interval, [100.0, 1.0], "%"),
    ];
    let time_constant = drop.time_constant_interval_s.map(|ends| {
        let [low, high] = ends.map(|end| end.map_or_else(|| "no limit".to_owned(), |end| format!("{:.1}", 1e3 * end)));
        let value =
            drop.time_constant_s.map_or_else(|| "DC-coupled, or not told".into(), |t| format!("{:.1} ms", 1e3 * t));
        vec!["time constant of the accelerometer".to_owned(), value, format!("{low} to {high} ms")]
    });
    let rows: Vec<Vec<String>> = rows.into_iter().flatten().chain(time_constant).collect();
    html::table(&["the recording", "value", "interval of 95 %"], &rows)
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
    html::table(&["file", "what it holds"], &rows)
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

/// Signals over time and against each other.
pub(crate) fn signals(results: &Results) -> Vec<Plot> {
    let on_page = panes::panes().filter(|pane| matches!(pane.shown, Shown::Page | Shown::PageAndTab));
    on_page.filter_map(|pane| plot(&pane, &results.signals, results.comparison.as_ref())).collect()
}

/// The plot of a pane; none where the run has none of its channels.
fn plot(pane: &Pane, signals: &Recording, comparison: Option<&ReferenceComparison>) -> Option<Plot> {
    let title = pane.title(signals)?;
    let own = pane.curves(signals);
    let y = pane.columns[0].0.axis;
    if let Some(x) = pane.over {
        let curves: Vec<Curve> = own.into_iter().filter_map(|curve| path(signals, x, curve)).collect();
        return (!curves.is_empty()).then(|| Plot::new(title, [x.axis, y], curves));
    }
    if own.is_empty() {
        return None;
    }
    let simulated = own.into_iter().map(|PaneCurve { column, label, values, .. }| {
        over_time(&label, &Series::new(signals.time.as_slice(), values), column.factor)
    });
    let measured = pane.measured.iter().filter_map(|measured| {
        let comparison = comparison?;
        let label = format!("{}{}", measured.label, comparison.label());
        Some(over_time(&label, (measured.series)(comparison)?, measured.column.factor).dashed())
    });
    let curves = simulated.chain(measured).collect();
    // Of a column alone beside what was measured of it, errors are taken.
    let is_compared = pane.columns.len() == pane.measured.len();
    let window = |comparison: &ReferenceComparison| plot::Window {
        label: "error window".into(),
        range: comparison.window.map(|time| time * 1e3),
    };
    let window = comparison.filter(|_| is_compared).map(window);
    Some(Plot { window, ..Plot::new(title, [TIME, y], curves) })
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
const NEGLIGIBLE: f64 = 1e-3;

/// The energy audit, and the terms too small to be drawn.
pub(crate) fn energies(energies: &Recording) -> (Plot, Vec<String>) {
    let magnitude = |channel: &Channel| channel.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let largest = energies.channels.iter().map(magnitude).fold(0.0, f64::max);
    let there = energies.channels.iter().filter(|channel| magnitude(channel) > 0.0);
    let (small, drawn): (Vec<&Channel>, Vec<&Channel>) =
        there.partition(|channel| magnitude(channel) < NEGLIGIBLE * largest);
    let words = |channel: &Channel| channel.name.trim_end_matches("_J").replace('_', " ");
    let curve = |channel: &Channel| {
        let series = Series::new(energies.time.as_slice(), channel.values.as_slice());
        let curve = over_time(&words(channel), &series, 1.0);
        if channel.name.starts_with("sum") { curve.dashed() } else { curve }
    };
    let plot = Plot::new("Energy audit", [TIME, "energy (J)"], drawn.into_iter().map(curve).collect());
    (plot, small.into_iter().map(words).collect())
}

/// A channel over another of the same impactor, that of the column `x`.
fn path(signals: &Recording, x: Column, curve: PaneCurve<'_>) -> Option<Curve> {
    let PaneCurve { column: y, prefix, label, values } = curve;
    let along = signals.channel(&format!("{prefix}{}", x.name))?;
    let points = along.iter().zip(values).map(|(a, b)| [a * x.factor, b * y.factor]);
    Some(Curve::line(label, points))
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
