//! The plots of one run.

use lab::signal::column::{self, Column};
use lab::signal::{Channel, Recording, Series};
use plot::{Curve, Plot, TIME, Window};
use study::post::{Impact, Measures, ReferenceComparison, Results};

/// Signals over time and against each other, by kind of loading.
pub(super) fn signals(results: &Results) -> Vec<Plot> {
    let signals = &results.signals;
    let own = match &results.measures {
        Measures::Impact(measures) => impact(measures, signals, results.comparison.as_ref()),
        Measures::Stretch(_) => stretch(signals),
        Measures::Indent(_) => indent(signals),
        Measures::Inflation(_) => inflation(signals),
    };
    own.into_iter().chain(frame(signals)).chain(slip(signals)).chain(tears(signals).into_iter().flatten()).collect()
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

/// The plots of Figures 23 to 27 of the paper, and those of the film. Of several impactors, a curve each.
fn impact(measures: &Impact, signals: &Recording, comparison: Option<&ReferenceComparison>) -> Vec<Plot> {
    let names: Vec<&str> = measures.bodies.iter().map(|body| body.prefix.as_str()).collect();
    let (whose, several) = if names.len() > 1 { ("impactors", true) } else { ("impactor", false) };
    let curve = |name: &str, prefix: &str, column: Column| {
        let series = signals.series(&format!("{prefix}{}", column.name))?;
        Some(over_time(&of_body(prefix, name), &series, column.factor))
    };
    // The curve of each impactor, by its name or by the words of a single one.
    let simulated = |words: &str, column: Column| -> Vec<Option<Curve>> {
        names.iter().map(|prefix| curve(if several { "" } else { words }, prefix, column)).collect()
    };
    let measured = |of: fn(&ReferenceComparison) -> &Option<Series>, name: &str, factor| {
        let comparison = comparison?;
        Some(over_time(&format!("{name}{}", comparison.label()), of(comparison).as_ref()?, factor).dashed())
    };
    let window = comparison
        .map(|comparison| Window { label: "error window".into(), range: comparison.window.map(|time| time * 1e3) });
    let compared = |title: String, column: Column, measured: Option<Curve>| Plot {
        window: window.clone(),
        ..over_time_plot(&title, column.axis, simulated("simulated", column).into_iter().chain([measured]))
    };
    let each = |columns: &[(&str, Column)]| -> Vec<Option<Curve>> {
        columns.iter().flat_map(|(words, column)| names.iter().map(|prefix| curve(words, prefix, *column))).collect()
    };
    let energies =
        [("kinetic", column::KINETIC_ENERGY), ("potential", column::POTENTIAL_ENERGY), ("total", column::TOTAL_ENERGY)];
    let strains = [("along MD", column::MAX_STRAIN_MD), ("along TD", column::MAX_STRAIN_TD)];
    let strains = strains.map(|(name, column)| Some(over_time(name, &signals.series(column.name)?, column.factor)));
    let across = [("along x", column::DISPLACEMENT_X), ("along y", column::DISPLACEMENT_Y)];
    let travel = names.iter().map(|prefix| path(signals, prefix, [column::DISPLACEMENT, column::CONTACT_FORCE]));
    let plots = [
        compared(
            format!("Displacement of the {whose}"),
            column::DISPLACEMENT,
            measured(|c| &c.displacement, "", column::DISPLACEMENT.factor),
        ),
        compared(
            format!("Acceleration of the {whose}"),
            column::ACCELERATION_FILTERED,
            measured(|c| &c.acceleration, "", 1.0),
        ),
        compared(
            format!("Energy loss of the {whose}"),
            column::ABSORBED_ENERGY,
            measured(|c| &c.absorbed_energy, "", 1.0),
        ),
        over_time_plot(
            &format!("Total energy of the {whose}"),
            column::TOTAL_ENERGY.axis,
            each(&energies).into_iter().chain([measured(|c| &c.total_energy, "total, ", 1.0)]),
        ),
        Plot::new("Force and travel", [column::DISPLACEMENT.axis, column::CONTACT_FORCE.axis], travel.collect()),
        over_time_plot("Contact force", column::CONTACT_FORCE.axis, simulated("simulated", column::CONTACT_FORCE)),
        over_time_plot("Largest strain of the film", column::MAX_STRAIN_MD.axis, strains),
        over_time_plot(
            "Acceleration before the filter",
            column::ACCELERATION.axis,
            simulated("simulated", column::ACCELERATION),
        ),
    ];
    let further = [
        over_time_plot(
            "Force of the impactors on each other",
            column::COLLISION_FORCE.axis,
            simulated("simulated", column::COLLISION_FORCE),
        ),
        over_time_plot(
            &format!("Displacement of the {whose} along x and y"),
            column::DISPLACEMENT_X.axis,
            each(&across),
        ),
        over_time_plot(
            "Size of the acceleration before the filter",
            column::ACCELERATION_RESULTANT.axis,
            simulated("simulated", column::ACCELERATION_RESULTANT),
        ),
    ];
    plots.into_iter().chain(further.into_iter().filter(|plot| !plot.curves.is_empty())).collect()
}

/// The name of a curve of the impactor whose channels begin with `prefix`.
fn of_body(prefix: &str, words: &str) -> String {
    match prefix.strip_suffix('_') {
        None => words.to_owned(),
        Some(name) if words.is_empty() => name.to_owned(),
        Some(name) => format!("{name}, {words}"),
    }
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

/// The force on the frame, where sides of a rectangle are held, or where it has bars.
fn frame(signals: &Recording) -> Option<Plot> {
    let force = |name: &str, column: Column| Some(over_time(name, &signals.series(column.name)?, column.factor));
    let curves = [
        force("along x", column::FRAME_FORCE_X),
        force("along y", column::FRAME_FORCE_Y),
        force("downwards, on the bars", column::FRAME_FORCE),
    ];
    let any = curves.iter().any(Option::is_some);
    any.then(|| over_time_plot("Force of the film on the frame", column::FRAME_FORCE_X.axis, curves))
}

/// Slip in the frame's clamp, where film may slip there.
fn slip(signals: &Recording) -> Option<Plot> {
    let Column { name, axis, factor, .. } = column::CLAMP_SLIP;
    let slip = over_time("simulated", &signals.series(name)?, factor);
    Some(over_time_plot("Slip in the clamp of the frame", axis, [Some(slip)]))
}

/// Length of the tears of film that can tear, and the energy that they took.
fn tears(signals: &Recording) -> [Option<Plot>; 2] {
    let of = |Column { name, axis, factor, .. }: Column, title: &str| {
        let curve = over_time("simulated", &signals.series(name)?, factor);
        Some(over_time_plot(title, axis, [Some(curve)]))
    };
    [of(column::TORN_LENGTH, "Length of the tears"), of(column::FRACTURE_ENERGY, "Energy that the tears took")]
}

/// One column over another.
fn against(signals: &Recording, title: &str, [x, y]: [Column; 2]) -> Plot {
    Plot::new(title, [x.axis, y.axis], vec![path(signals, "", [x, y])])
}

/// One column over another, of the impactor whose channels begin with `prefix`.
fn path(signals: &Recording, prefix: &str, [x, y]: [Column; 2]) -> Curve {
    let values = |column: &Column| signals.channel(&format!("{prefix}{}", column.name)).unwrap_or_default();
    let points = values(&x).iter().zip(values(&y)).map(|(a, b)| [a * x.factor, b * y.factor]);
    Curve::line(prefix.strip_suffix('_').unwrap_or("simulated"), points)
}

fn over_time_plot(title: &str, y: &str, curves: impl IntoIterator<Item = Option<Curve>>) -> Plot {
    Plot::new(title, [TIME, y], curves.into_iter().flatten().collect())
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
