//! The plots of one run.

use super::RunPage;
use crate::plot::{Curve, Plot, TIME, Window};
use crate::post::{Measures, ReferenceComparison};
use crate::signal::{Channel, Recording, Series};

/// Signals over time and against each other, by kind of loading.
pub(super) fn signals(run: &RunPage) -> Vec<Plot> {
    let signals = &run.results.signals;
    let own = match &run.results.measures {
        Measures::Impact(_) => impact(signals, run.results.comparison.as_ref()),
        Measures::Stretch(_) => stretch(signals),
        Measures::Indent(_) => indent(signals),
        Measures::Inflation(_) => inflation(signals),
    };
    own.into_iter().chain(frame(signals)).collect()
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
pub(super) const NEGLIGIBLE: f64 = 1e-3;

/// Where the energy went, and the terms too small to be drawn.
pub(super) fn energies(energies: &Recording) -> (Plot, Vec<String>) {
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

/// As Figures 23 to 27 of the paper, and what the film does besides.
fn impact(signals: &Recording, comparison: Option<&ReferenceComparison>) -> Vec<Plot> {
    let simulated = |name: &str, column: &str, factor| Some(over_time(name, &signals.series(column)?, factor));
    let measured = |of: fn(&ReferenceComparison) -> &Option<Series>, name: &str, factor| {
        let comparison = comparison?;
        Some(over_time(&format!("{name}{}", comparison.label()), of(comparison).as_ref()?, factor).dashed())
    };
    let window = comparison
        .map(|comparison| Window { words: "error window".into(), range: comparison.window.map(|time| time * 1e3) });
    let compared = |title: &str, y: &str, curves: [Option<Curve>; 2]| Plot {
        window: window.clone(),
        ..over_time_plot(title, y, curves)
    };
    let energy = |name: &str| simulated(name, &format!("{name}_energy_J"), 1.0);
    vec![
        compared(
            "Displacement of the impactor",
            "displacement (mm)",
            [simulated("simulated", "displacement_m", 1e3), measured(|c| &c.displacement, "", 1e3)],
        ),
        compared(
            "Acceleration of the impactor",
            "acceleration (m/s²)",
            [simulated("simulated", "acceleration_filtered_m_s2", 1.0), measured(|c| &c.acceleration, "", 1.0)],
        ),
        compared(
            "Energy loss of the impactor",
            "energy (J)",
            [simulated("simulated", "absorbed_energy_J", 1.0), measured(|c| &c.absorbed_energy, "", 1.0)],
        ),
        over_time_plot(
            "Total energy of the impactor",
            "energy (J)",
            [energy("kinetic"), energy("potential"), energy("total"), measured(|c| &c.total_energy, "total, ", 1.0)],
        ),
        against(signals, "Force and travel", [DISPLACEMENT, Axis { column: "contact_force_N", ..FORCE }]),
        over_time_plot("Contact force", "force (N)", [simulated("simulated", "contact_force_N", 1.0)]),
        over_time_plot(
            "Largest strain of the film",
            "engineering strain (%)",
            [simulated("along MD", "max_strain_md", 100.0), simulated("along TD", "max_strain_td", 100.0)],
        ),
        over_time_plot(
            "Acceleration before the filter",
            "acceleration (m/s²)",
            [simulated("simulated", "acceleration_m_s2", 1.0)],
        ),
    ]
}

fn stretch(signals: &Recording) -> Vec<Plot> {
    let strain = Axis { words: "engineering strain (%)", column: "strain", factor: 100.0 };
    let stress = Axis { words: "stress (MPa)", column: "stress_Pa", factor: 1e-6 };
    let travel = Axis { words: "travel of the jaws (mm)", ..DISPLACEMENT };
    vec![against(signals, "Stress and strain", [strain, stress]), against(signals, "Force and travel", [travel, FORCE])]
}

fn indent(signals: &Recording) -> Vec<Plot> {
    let depth = Axis { words: "depth (mm)", column: "depth_m", factor: 1e3 };
    vec![against(signals, "Force and depth", [depth, FORCE])]
}

fn inflation(signals: &Recording) -> Vec<Plot> {
    let deflection = Axis { words: "deflection (mm)", column: "deflection_m", factor: 1e3 };
    let pressure = Axis { words: "pressure (kPa)", column: "pressure_Pa", factor: 1e-3 };
    let over_time = signals.series("deflection_m").map(|series| over_time("simulated", &series, 1e3));
    vec![
        against(signals, "Pressure and deflection", [deflection, pressure]),
        over_time_plot("Deflection of the highest point", "deflection (mm)", [over_time]),
    ]
}

/// The pull on the frame, where sides of a rectangle are held.
fn frame(signals: &Recording) -> Option<Plot> {
    let pull = |name: &str, column: &str| Some(over_time(name, &signals.series(column)?, 1.0));
    let curves = [pull("along x", "frame_force_x_N"), pull("along y", "frame_force_y_N")];
    let any = curves.iter().any(Option::is_some);
    any.then(|| over_time_plot("Pull of the film on the frame", "force (N)", curves))
}

/// One axis of a plot: what it says, and the column that it shows times a factor.
struct Axis {
    words: &'static str,
    column: &'static str,
    factor: f64,
}

const DISPLACEMENT: Axis = Axis { words: "displacement (mm)", column: "displacement_m", factor: 1e3 };
const FORCE: Axis = Axis { words: "force (N)", column: "force_N", factor: 1.0 };

/// One column over another.
fn against(signals: &Recording, title: &str, [x, y]: [Axis; 2]) -> Plot {
    let column = |axis: &Axis| signals.channel(axis.column).unwrap_or_default();
    let points = column(&x).iter().zip(column(&y)).map(|(a, b)| [a * x.factor, b * y.factor]);
    Plot::new(title, [x.words, y.words], vec![Curve::line("simulated", points)])
}

fn over_time_plot(title: &str, y: &str, curves: impl IntoIterator<Item = Option<Curve>>) -> Plot {
    Plot::new(title, [TIME, y], curves.into_iter().flatten().collect())
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
