//! The plots of one run.

use crate::plot::{Curve, Plot, TIME, Window};
use crate::post::{Measures, ReferenceComparison, Results};
use crate::signal::column::{self, Column};
use crate::signal::{Channel, Recording, Series};

/// Signals over time and against each other, by kind of loading.
pub(super) fn signals(results: &Results) -> Vec<Plot> {
    let signals = &results.signals;
    let own = match &results.measures {
        Measures::Impact(_) => impact(signals, results.comparison.as_ref()),
        Measures::Stretch(_) => stretch(signals),
        Measures::Indent(_) => indent(signals),
        Measures::Inflation(_) => inflation(signals),
    };
    own.into_iter().chain(frame(signals)).collect()
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
pub(super) const NEGLIGIBLE: f64 = 1e-3;

/// The energy audit, and the terms too small to be drawn.
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

/// The plots of Figures 23 to 27 of the paper, and those of the film.
fn impact(signals: &Recording, comparison: Option<&ReferenceComparison>) -> Vec<Plot> {
    let simulated = |name: &str, column: Column| Some(over_time(name, &signals.series(column.name)?, column.factor));
    let measured = |of: fn(&ReferenceComparison) -> &Option<Series>, name: &str, factor| {
        let comparison = comparison?;
        Some(over_time(&format!("{name}{}", comparison.label()), of(comparison).as_ref()?, factor).dashed())
    };
    let window = comparison
        .map(|comparison| Window { label: "error window".into(), range: comparison.window.map(|time| time * 1e3) });
    let compared = |title: &str, y: &str, curves: [Option<Curve>; 2]| Plot {
        window: window.clone(),
        ..over_time_plot(title, y, curves)
    };
    vec![
        compared(
            "Displacement of the impactor",
            column::DISPLACEMENT.axis,
            [
                simulated("simulated", column::DISPLACEMENT),
                measured(|c| &c.displacement, "", column::DISPLACEMENT.factor),
            ],
        ),
        compared(
            "Acceleration of the impactor",
            column::ACCELERATION_FILTERED.axis,
            [simulated("simulated", column::ACCELERATION_FILTERED), measured(|c| &c.acceleration, "", 1.0)],
        ),
        compared(
            "Energy loss of the impactor",
            column::ABSORBED_ENERGY.axis,
            [simulated("simulated", column::ABSORBED_ENERGY), measured(|c| &c.absorbed_energy, "", 1.0)],
        ),
        over_time_plot(
            "Total energy of the impactor",
            column::TOTAL_ENERGY.axis,
            [
                simulated("kinetic", column::KINETIC_ENERGY),
                simulated("potential", column::POTENTIAL_ENERGY),
                simulated("total", column::TOTAL_ENERGY),
                measured(|c| &c.total_energy, "total, ", 1.0),
            ],
        ),
        against(signals, "Force and travel", [column::DISPLACEMENT, column::CONTACT_FORCE]),
        over_time_plot("Contact force", column::CONTACT_FORCE.axis, [simulated("simulated", column::CONTACT_FORCE)]),
        over_time_plot(
            "Largest strain of the film",
            column::MAX_STRAIN_MD.axis,
            [simulated("along MD", column::MAX_STRAIN_MD), simulated("along TD", column::MAX_STRAIN_TD)],
        ),
        over_time_plot(
            "Acceleration before the filter",
            column::ACCELERATION.axis,
            [simulated("simulated", column::ACCELERATION)],
        ),
    ]
}

fn stretch(signals: &Recording) -> Vec<Plot> {
    let travel = Column { axis: "travel of the jaws (mm)", ..column::DISPLACEMENT };
    vec![
        against(signals, "Stress and strain", [column::STRAIN, column::STRESS]),
        against(signals, "Force and travel", [travel, column::FORCE]),
    ]
}

fn indent(signals: &Recording) -> Vec<Plot> {
    vec![against(signals, "Force and depth", [column::DEPTH, column::FORCE])]
}

fn inflation(signals: &Recording) -> Vec<Plot> {
    let Column { name, axis, factor, .. } = column::DEFLECTION;
    let over_time = signals.series(name).map(|series| over_time("simulated", &series, factor));
    vec![
        against(signals, "Pressure and deflection", [column::DEFLECTION, column::PRESSURE]),
        over_time_plot("Deflection of the highest point", axis, [over_time]),
    ]
}

/// The force on the frame, where sides of a rectangle are held.
fn frame(signals: &Recording) -> Option<Plot> {
    let force = |name: &str, column: Column| Some(over_time(name, &signals.series(column.name)?, column.factor));
    let curves = [force("along x", column::FRAME_FORCE_X), force("along y", column::FRAME_FORCE_Y)];
    let any = curves.iter().any(Option::is_some);
    any.then(|| over_time_plot("Force of the film on the frame", column::FRAME_FORCE_X.axis, curves))
}

/// One column over another.
fn against(signals: &Recording, title: &str, [x, y]: [Column; 2]) -> Plot {
    let values = |column: &Column| signals.channel(column.name).unwrap_or_default();
    let points = values(&x).iter().zip(values(&y)).map(|(a, b)| [a * x.factor, b * y.factor]);
    Plot::new(title, [x.axis, y.axis], vec![Curve::line("simulated", points)])
}

fn over_time_plot(title: &str, y: &str, curves: impl IntoIterator<Item = Option<Curve>>) -> Plot {
    Plot::new(title, [TIME, y], curves.into_iter().flatten().collect())
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
