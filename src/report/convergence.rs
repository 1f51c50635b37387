//! Plots of a search: its objective, its unknowns, and its best simulations over the targets.

use plot::{Axis, Curve, Plot, Scale, TIME};
use study::script::{ConvergenceHistory, Fit, Over};

/// Objective and unknowns over iterations, then every fit; no objective and no unknowns of a search without iterations.
pub(super) fn plots(convergence: &ConvergenceHistory) -> Vec<Plot> {
    let own = [objective(convergence), unknowns(convergence)].into_iter().filter(has_lines);
    own.chain(convergence.fits.iter().map(|fit| best(convergence, fit, "best"))).collect()
}

/// The reference of a fit alone.
pub(super) fn target(convergence: &ConvergenceHistory, fit: &Fit) -> Plot {
    let x = match fit.target.over {
        Over::Time => TIME,
        Over::Strain => "strain",
        Over::Travel => "travel (mm)",
    };
    let name = if convergence.is_virtual { "reference (virtual)" } else { "reference" };
    let reference = Curve::line(name, points(fit, &fit.target.values)).dashed();
    Plot::new(format!("{}: {}", convergence.title, fit.quantity), [x, fit.label().as_str()], vec![reference])
}

/// Factors from the values of a fit to the units of its axes. Signals over time are in the unit that the script
/// computes them in, stresses over strain in Pa.
fn factors(Fit { unit, target, .. }: &Fit) -> [f64; 2] {
    match target.over {
        Over::Time | Over::Travel => [1e3, 1.0],
        Over::Strain => [1.0, unit.as_ref().map_or(1.0, |unit| 1.0 / unit.to_si(1.0))],
    }
}

/// A simulation of the search, in the units of [`target`].
pub(super) fn simulated(name: impl Into<String>, fit: &Fit) -> Curve {
    Curve::line(name, points(fit, &fit.values))
}

/// Best values of the objective; one curve a start.
fn objective(ConvergenceHistory { title, objectives, .. }: &ConvergenceHistory) -> Plot {
    let name = |start: usize| if objectives.len() == 1 { "objective".into() } else { format!("start {}", start + 1) };
    let curve = |(start, history): (usize, &Vec<(usize, f64)>)| {
        Curve::line(name(start), history.iter().map(|(iteration, f)| [*iteration as f64, *f]))
    };
    let curves = objectives.iter().enumerate().map(curve).collect();
    let mut plot = Plot::new(format!("{title}: objective"), ["iteration", "objective"], curves);
    if objectives.iter().flatten().all(|(_, f)| *f > 0.0) {
        plot.y = Axis { scale: Scale::Logarithmic, ..plot.y };
    }
    plot
}

fn unknowns(ConvergenceHistory { title, unknowns, history, .. }: &ConvergenceHistory) -> Plot {
    let curve = |(place, name): (usize, &String)| {
        Curve::line(name, history.iter().map(|at| [at.iteration as f64, at.x[place]]))
    };
    let curves = unknowns.iter().enumerate().map(curve).collect();
    Plot::new(format!("{title}: unknowns"), ["iteration", "value"], curves)
}

fn has_lines(plot: &Plot) -> bool {
    plot.curves.iter().any(|curve| curve.points.len() > 1)
}

/// The best simulation, by this name, over its target.
pub(super) fn best(convergence: &ConvergenceHistory, fit: &Fit, name: &str) -> Plot {
    let mut plot = target(convergence, fit);
    plot.curves.insert(0, simulated(name, fit));
    plot
}

fn points(fit: &Fit, values: &[f32]) -> Vec<[f64; 2]> {
    let [x, y] = factors(fit);
    fit.target.places.iter().zip(values).map(|(place, value)| [f64::from(*place) * x, f64::from(*value) * y]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::units::Unit;
    use study::script::{Iterate, Target};

    fn search(objectives: &[f64]) -> ConvergenceHistory {
        let target = Target { over: Over::Time, places: vec![0.0, 0.05], values: vec![0.0, 150.0] };
        let at = |place: usize| Iterate { iteration: place + 1, f: objectives[place], x: vec![objectives[place]] };
        ConvergenceHistory {
            continues: false,
            title: "1008".into(),
            unknowns: vec!["k1".into()],
            objectives: vec![objectives.iter().enumerate().map(|(place, f)| (place + 1, *f)).collect()],
            history: (0..objectives.len()).map(at).collect(),
            fits: vec![Fit {
                quantity: "acceleration".into(),
                unit: Unit::parse("m/s²").ok(),
                target,
                values: vec![0.0, 2.0],
            }],
            is_virtual: false,
        }
    }

    #[test]
    fn a_search_shows_its_objective_its_unknowns_and_its_curves() {
        let falling: Vec<f64> = (0..60).map(|step| 2.0 * 0.9_f64.powi(step)).collect();
        let plots = plots(&search(&falling));
        let [objective, unknowns, curves] = &plots[..] else { panic!("{plots:?}") };
        assert_eq!((objective.y.scale, objective.curves[0].points[0]), (Scale::Logarithmic, [1.0, 2.0]));
        assert_eq!(unknowns.curves[0].name, "k1");
        assert_eq!((curves.title.as_str(), curves.x.label.as_str()), ("1008: acceleration", "time (ms)"));
        assert_eq!(curves.y.label, "acceleration (m/s²)");
        let names: Vec<&str> = curves.curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["best", "reference"]);
        let [time, value] = curves.curves[0].points[1];
        assert!((time - 50.0).abs() < 1e-5 && value == 2.0);
    }

    #[test]
    fn stresses_have_the_unit_that_their_axis_names() {
        let target = Target { over: Over::Strain, places: vec![0.0, 0.5], values: vec![0.0, 8e6] };
        for (symbol, expected) in
            [("MPa", ("stress (MPa)", 8.0)), ("kPa", ("stress (kPa)", 8e3)), ("Pa", ("stress (Pa)", 8e6))]
        {
            let (quantity, unit) = ("stress".into(), Unit::parse(symbol).ok());
            let fit = Fit { quantity, unit, target: target.clone(), values: vec![] };
            let plot = super::target(&ConvergenceHistory { is_virtual: true, ..search(&[1.0]) }, &fit);
            assert_eq!((plot.y.label.as_str(), plot.curves[0].points[1][1]), expected);
            assert_eq!(plot.curves[0].name, "reference (virtual)");
        }
    }

    #[test]
    fn a_search_that_stays_where_it_began_has_curves_alone() {
        let found = plots(&search(&[0.0]));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].curves.len(), 2);
        assert_eq!(plots(&search(&[1.0, -1.0]))[0].y.scale, Scale::Linear);
    }
}
