//! The page of one run.

use serde_json::Value;

use super::html::{self, escape};
use super::plot;
use super::{Figure, duration, study_page, subject};
use crate::model::Model;
use crate::plot::{Curve, Plot};
use crate::post::{Measures, Results};
use crate::signal::{Channel, Recording, Series};
use crate::simulate::Outcome;

/// What the page of a run is made of.
#[derive(Clone, Copy)]
pub struct RunPage<'a> {
    pub model: &'a Model,
    pub outcome: &'a Outcome,
    pub results: &'a Results,
    /// The fully resolved scenario.
    pub scenario: &'a str,
    /// Why the run broke off, where it did.
    pub failure: Option<&'a str>,
}

/// Figures of the machine and the mesh, not of the film.
const COST: [&str; 5] = ["elements", "steps", "time_step_s", "wall_s", "ns_per_element_step"];

/// `report.html` of a run.
pub fn run_page(run: &RunPage) -> String {
    let RunPage { model, results, .. } = run;
    let summary = results.summary(model);
    let is_one_of = |names: &[&str], name: &String| names.contains(&name.as_str());
    let (cost, figures): (Vec<_>, Vec<_>) = summary
        .iter()
        .filter(|(name, _)| !is_one_of(&["scenario", "title", "droptower"], name))
        .partition(|(name, _)| is_one_of(&COST, name));
    let body = [
        format!(
            "<h1>{}</h1>\n<p class=\"lead\">{}</p>\n",
            escape(&model.title),
            escape(&format!("{}: {}", model.name, subject(model)))
        ),
        warnings(run),
        html::section("Figures", &table(&figures)),
        html::section("Signals", &plots(run)),
        study_page::tables(&results.findings),
        html::section("Cost", &table(&cost)),
        html::section("Log", &html::list(&results.findings.log)),
        html::section("Scenario", &html::verbatim(run.scenario)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&model.title, &body.concat())
}

fn table(figures: &[(&String, &Value)]) -> String {
    let figures = figures.iter().filter_map(|(name, value)| Figure::of(name, value));
    html::table("figures", &[], &figures.map(|figure| figure.cells().into()).collect::<Vec<_>>())
}

fn warnings(run: &RunPage) -> String {
    let failure = run.failure.map(|cause| format!("The run broke off: {cause}"));
    let rupture = run.outcome.rupture_time.map(|time| format!("The film ruptured at {}", duration(time)));
    let warnings = run.results.measures.warnings().iter().cloned();
    let lines: Vec<String> = failure.into_iter().chain(rupture).chain(warnings).collect();
    if lines.is_empty() {
        return String::new();
    }
    format!("<div class=\"warnings\">\n<h2>Warnings</h2>\n{}</div>\n", html::list(&lines))
}

fn plots(run: &RunPage) -> String {
    let signals = &run.results.signals;
    let own = match &run.results.measures {
        Measures::Impact(_) => impact_plots(run),
        Measures::Stretch(_) => stretch_plots(signals),
        Measures::Indent(_) => indent_plots(signals),
        Measures::Inflation(_) => inflation_plots(signals),
    };
    let histogram = &run.results.measures.audit().strain_rates;
    let mut figures: Vec<String> = own.iter().chain(&frame_plot(signals)).map(plot::figure).collect();
    figures.push(audit(&run.outcome.energies));
    figures.push(plot::rates("Strain rates while loading", histogram));
    plot::side_by_side(figures)
}

fn impact_plots(run: &RunPage) -> Vec<Plot> {
    let signals = &run.results.signals;
    let comparison = run.results.comparison.as_ref();
    let simulated = |name: &str, column: &str, factor| Some(over_time(name, &signals.series(column)?, factor));
    let reference = |series: Option<&Series>, factor| Some(over_time("reference", series?, factor).dashed());
    let energy = |name: &str| simulated(name, &format!("{name}_energy_J"), 1.0);
    let displacement = reference(comparison.and_then(|c| c.displacement.as_ref()), 1e3);
    let acceleration = reference(comparison.and_then(|c| c.acceleration.as_ref()), 1.0);
    vec![
        time_plot(
            "Displacement of the impactor",
            "displacement (mm)",
            [simulated("simulated", "displacement_m", 1e3), displacement],
        ),
        time_plot(
            "Acceleration of the impactor",
            "acceleration (m/s²)",
            [
                simulated("raw", "acceleration_m_s2", 1.0),
                acceleration,
                simulated("filtered", "acceleration_filtered_m_s2", 1.0),
            ],
        ),
        time_plot(
            "Largest strain of the film",
            "engineering strain",
            [simulated("along MD", "max_strain_md", 1.0), simulated("along TD", "max_strain_td", 1.0)],
        ),
        time_plot("Energy of the impactor", "energy (J)", ["kinetic", "potential", "absorbed", "total"].map(energy)),
    ]
}

fn stretch_plots(signals: &Recording) -> Vec<Plot> {
    let strain = Axis { words: "engineering strain", column: "strain", factor: 1.0 };
    let stress = Axis { words: "stress (MPa)", column: "stress_Pa", factor: 1e-6 };
    let travel = Axis { words: "travel of the jaws (mm)", column: "displacement_m", factor: 1e3 };
    let force = Axis { words: "force (N)", column: "force_N", factor: 1.0 };
    vec![against(signals, "Stress and strain", [strain, stress]), against(signals, "Force and travel", [travel, force])]
}

fn indent_plots(signals: &Recording) -> Vec<Plot> {
    let depth = Axis { words: "depth (mm)", column: "depth_m", factor: 1e3 };
    let force = Axis { words: "force (N)", column: "force_N", factor: 1.0 };
    vec![against(signals, "Force and depth", [depth, force])]
}

fn inflation_plots(signals: &Recording) -> Vec<Plot> {
    let deflection = Axis { words: "deflection (mm)", column: "deflection_m", factor: 1e3 };
    let pressure = Axis { words: "pressure (kPa)", column: "pressure_Pa", factor: 1e-3 };
    let over_time = signals.series("deflection_m").map(|series| over_time("simulated", &series, 1e3));
    vec![
        against(signals, "Pressure and deflection", [deflection, pressure]),
        time_plot("Deflection of the highest point", "deflection (mm)", [over_time]),
    ]
}

/// The pull on the frame, where sides of a rectangle are held.
fn frame_plot(signals: &Recording) -> Option<Plot> {
    let pull = |name: &str, column: &str| Some(over_time(name, &signals.series(column)?, 1.0));
    let curves = [pull("along x", "frame_force_x_N"), pull("along y", "frame_force_y_N")];
    curves.iter().any(Option::is_some).then(|| time_plot("Pull of the film on the frame", "force (N)", curves))
}

/// One axis of a plot: what it says, and the column that it shows times a factor.
struct Axis {
    words: &'static str,
    column: &'static str,
    factor: f64,
}

/// One column over another.
fn against(signals: &Recording, title: &str, [x, y]: [Axis; 2]) -> Plot {
    let column = |axis: &Axis| signals.channel(axis.column).unwrap_or_default();
    let points = column(&x).iter().zip(column(&y)).map(|(a, b)| [a * x.factor, b * y.factor]);
    Plot::new(title, [x.words, y.words], vec![Curve::line("simulated", points)])
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
const NEGLIGIBLE: f64 = 1e-3;

fn audit(energies: &Recording) -> String {
    let magnitude = |channel: &Channel| channel.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let largest = energies.channels.iter().map(magnitude).fold(0.0, f64::max);
    let (small, drawn): (Vec<&Channel>, Vec<&Channel>) = energies
        .channels
        .iter()
        .filter(|channel| magnitude(channel) > 0.0)
        .partition(|channel| magnitude(channel) < NEGLIGIBLE * largest);
    let words = |channel: &Channel| channel.name.trim_end_matches("_J").replace('_', " ");
    let curve = |channel: &Channel| {
        let series = Series::new(energies.time.as_slice(), channel.values.as_slice());
        over_time(&words(channel), &series, 1.0)
    };
    let plot = time_plot("Energy audit", "energy (J)", drawn.into_iter().map(|channel| Some(curve(channel))));
    let small: Vec<String> = small.into_iter().map(words).collect();
    let note = match small.as_slice() {
        [] => String::new(),
        names => format!("<p class=\"note\">below {} %: {}</p>\n", NEGLIGIBLE * 100.0, escape(&names.join(", "))),
    };
    format!("<div>\n{}{note}</div>\n", plot::figure(&plot))
}

fn time_plot(title: &str, y: &str, curves: impl IntoIterator<Item = Option<Curve>>) -> Plot {
    Plot::new(title, ["time (ms)", y], curves.into_iter().flatten().collect())
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
