//! The page of one run.

use serde_json::Value;

use super::html::{self, escape};
use super::plot::{self, Curve, Plot, PlotError};
use super::{Figure, duration, study_page, subject};
use crate::model::Model;
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
pub fn run_page(run: &RunPage) -> Result<String, PlotError> {
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
        html::section("Signals", &plots(run)?),
        study_page::tables(&results.findings),
        html::section("Cost", &table(&cost)),
        html::section("Log", &html::list(&results.findings.log)),
        html::section("Scenario", &html::verbatim(run.scenario)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    Ok(html::page(&model.title, &body.concat()))
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

fn plots(run: &RunPage) -> Result<String, PlotError> {
    let (histogram, own) = match &run.results.measures {
        Measures::Impact(impact) => (&impact.audit.strain_rates, impact_plots(run)),
        Measures::Stretch(stretch) => (&stretch.audit.strain_rates, stretch_plots(run)),
    };
    let mut figures = own.iter().map(Plot::draw).collect::<Result<Vec<_>, _>>()?;
    figures.push(audit(&run.outcome.energies)?);
    figures.push(plot::rates("Strain rates while loading", histogram)?);
    Ok(format!("<div class=\"plots\">\n{}</div>\n", figures.concat()))
}

fn impact_plots(run: &RunPage) -> Vec<Plot> {
    let signals = &run.results.signals;
    let comparison = run.results.comparison.as_ref();
    let simulated = |name: &str, column: &str, factor| Some(over_time(name, &signals.series(column)?, factor));
    let reference = |series: Option<&Series>, factor| Some(over_time("reference", series?, factor));
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

fn stretch_plots(run: &RunPage) -> Vec<Plot> {
    let signals = &run.results.signals;
    let against = |title: &str, [x, y]: [&str; 2], columns: [&str; 2], factors: [f64; 2]| {
        let [xs, ys] = columns.map(|column| signals.channel(column).unwrap_or_default());
        let points = xs.iter().zip(ys).map(|(x, y)| (x * factors[0], y * factors[1])).collect();
        let curves = vec![Curve { name: "simulated".into(), points }];
        Plot { title: title.into(), x: x.into(), y: y.into(), curves }
    };
    vec![
        against("Stress and strain", ["engineering strain", "stress (MPa)"], ["strain", "stress_Pa"], [1.0, 1e-6]),
        against(
            "Force and travel",
            ["travel of the jaws (mm)", "force (N)"],
            ["displacement_m", "force_N"],
            [1e3, 1.0],
        ),
    ]
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
const NEGLIGIBLE: f64 = 1e-3;

fn audit(energies: &Recording) -> Result<String, PlotError> {
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
    Ok(format!("<div>\n{}{note}</div>\n", plot.draw()?))
}

fn time_plot(title: &str, y: &str, curves: impl IntoIterator<Item = Option<Curve>>) -> Plot {
    Plot { title: title.into(), x: "time (ms)".into(), y: y.into(), curves: curves.into_iter().flatten().collect() }
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve { name: name.into(), points: series.samples().map(|[t, v]| (t * 1e3, v * factor)).collect() }
}
