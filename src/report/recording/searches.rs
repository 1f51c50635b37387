//! The recording of a study: curves of a search along its iterations, plots, tables and texts.

use viz::{Chart, Diagram, Event, Moment, Places, Scene, Severity, SignalTrack, State, Stroke};

use super::diagram::{self, diagram};
use super::text::Text;
use base::finding::Finding;
use plot::{Curve, Look, Plot};

/// The content of the recording of a study.
#[derive(Clone, Debug, Default)]
pub(super) struct StudyRecording {
    /// The study's name.
    pub(super) name: String,
    /// Texts, the summary first.
    pub(super) texts: Vec<Text>,
    /// The history of each search.
    pub(super) searches: Vec<Approach>,
    /// Plots that are not over time.
    pub(super) plots: Vec<Plot>,
    /// Plots over the time of a test in ms, which also go on the timeline `time` of a study without a search.
    pub(super) over_time: Vec<Plot>,
    /// The findings of the script.
    pub(super) findings: Vec<Finding>,
    /// The lines of its log.
    pub(super) log: Vec<String>,
}

/// How the simulations of a search converged to a target.
#[derive(Clone, Debug)]
pub(super) struct Approach {
    /// Name of the target, e.g. `drop/1008`.
    pub(super) name: String,
    /// Axes, and the curves of the target.
    pub(super) target: Plot,
    /// In the order of their numbers.
    pub(super) iterations: Vec<Iteration>,
}

/// The state of a search after an iteration.
#[derive(Clone, Debug)]
pub(super) struct Iteration {
    /// Its number.
    pub(super) number: u32,
    /// The smallest value of the objective so far.
    pub(super) objective: f64,
    /// Names and values of the parameters that gave it.
    pub(super) parameters: Vec<(String, f64)>,
    /// The simulation with them: equally many curves in every iteration, none where the search stored none.
    pub(super) curves: Vec<Curve>,
}

/// The scene of a study.
pub(super) fn scene(study: &StudyRecording) -> Scene {
    let approaches = study.searches.iter().enumerate().map(|(index, search)| approach(search, index));
    let plots = diagram::diagrams("plots", study.over_time.iter().chain(&study.plots));
    let (charts, signals): (Vec<Chart>, Vec<Vec<SignalTrack>>) = match study.searches.as_slice() {
        // The viewer is on one timeline at a time.
        [] => study.over_time.iter().enumerate().map(|(index, plot)| over_time(plot, index)).unzip(),
        _ => objectives(study).into_iter().unzip(),
    };
    let ends = study.over_time.iter().flat_map(|plot| &plot.curves).filter_map(|curve| curve.points.last());
    Scene {
        name: study.name.clone(),
        duration: ends.map(|[time, _]| time * 1e-3).fold(0.0, f64::max),
        documents: study.texts.iter().map(Text::document).collect(),
        signals: signals.concat(),
        charts,
        diagrams: approaches.chain(plots).collect(),
        events: events(study),
        ..Scene::default()
    }
}

/// The target and the curves of every iteration.
fn approach(search: &Approach, index: usize) -> Diagram {
    let state = |iteration: &Iteration| State {
        at: Moment::Iteration(iteration.number),
        curves: iteration.curves.iter().map(diagram::curve).collect(),
    };
    let states = search.iterations.iter().map(state).collect();
    Diagram { states, ..diagram(format!("searches/{index}"), &search.target) }
}

/// One chart of all objectives, and one a parameter.
fn objectives(study: &StudyRecording) -> Vec<(Chart, Vec<SignalTrack>)> {
    let mut names: Vec<&String> = vec![];
    for (name, _) in study.searches.iter().flat_map(|search| &search.iterations).flat_map(|at| &at.parameters) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let objective = along_iterations(study, "objective", "objective", |at| Some(at.objective));
    let parameter = |(number, name): (usize, &&String)| {
        let value = |at: &Iteration| at.parameters.iter().find(|(other, _)| other == *name).map(|(_, value)| *value);
        along_iterations(study, name, &format!("unknowns/{number}"), value)
    };
    let charts = std::iter::once(objective).chain(names.iter().enumerate().map(parameter));
    charts.filter(|(_, signals)| !signals.is_empty()).collect()
}

/// A figure of every search along its iterations, at the entity `part` of each. Names may hold any characters, so
/// entities are numbered.
fn along_iterations(
    study: &StudyRecording,
    name: &str,
    part: &str,
    figure: impl Fn(&Iteration) -> Option<f64>,
) -> (Chart, Vec<SignalTrack>) {
    let track = |(index, search): (usize, &Approach)| {
        let places = search.iterations.iter().map(|at| at.number).collect();
        let values: Vec<f64> = search.iterations.iter().map(|at| figure(at).unwrap_or(f64::NAN)).collect();
        values.iter().any(|value| value.is_finite()).then(|| SignalTrack {
            path: format!("searches/{index}/{part}"),
            label: search.name.clone(),
            places: Places::Iterations(places),
            values: values.into_iter().map(|value| value as f32).collect(),
            stroke: Stroke::nth(index),
        })
    };
    let signals: Vec<SignalTrack> = study.searches.iter().enumerate().filter_map(track).collect();
    (chart(name, &signals), signals)
}

/// A plot over the time of a test, on the timeline `time`.
fn over_time(plot: &Plot, index: usize) -> (Chart, Vec<SignalTrack>) {
    let track = |(number, curve): (usize, &Curve)| SignalTrack {
        path: format!("over_time/{index}/{number}"),
        label: curve.name.clone(),
        places: Places::Times(curve.points.iter().map(|[time, _]| 1e-3 * time).collect()),
        values: curve.points.iter().map(|[_, value]| *value as f32).collect(),
        stroke: if curve.look == Look::Dashed { Stroke::target() } else { Stroke::nth(number) },
    };
    let signals: Vec<SignalTrack> = plot.curves.iter().enumerate().map(track).collect();
    (chart(&format!("{}: {}", plot.title, plot.y.label), &signals), signals)
}

fn chart(title: &str, signals: &[SignalTrack]) -> Chart {
    Chart { title: title.to_owned(), signals: signals.iter().map(|signal| signal.path.clone()).collect() }
}

/// Every iteration of every search, then the log of the script, which has no iterations: at the last iteration, or at
/// the beginning without a search.
fn events(study: &StudyRecording) -> Vec<Event> {
    let event = |at, text| Event { at, severity: Severity::Info, text };
    let iterations = study.searches.iter().flat_map(|search| search.iterations.iter().map(move |at| (search, at)));
    let last = iterations.clone().map(|(_, at)| at.number).max();
    let end = last.map_or(Moment::Time(0.0), Moment::Iteration);
    let words = |(search, at): (&Approach, &Iteration)| {
        let parameters = at.parameters.iter().map(|(name, value)| format!(", {name} {value:.4}"));
        event(
            Moment::Iteration(at.number),
            format!("{}: objective {:.5}{}", search.name, at.objective, parameters.collect::<String>()),
        )
    };
    let findings = study.findings.iter().map(|finding| Event {
        at: end,
        severity: if finding.is_warning() { Severity::Warning } else { Severity::Info },
        text: format!("{} [{}]", finding.message, finding.code),
    });
    let lines = study.log.iter().map(|line| event(end, line.clone()));
    iterations.map(words).chain(findings).chain(lines).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study() -> StudyRecording {
        let line = |name: &str, height: f64| Curve::line(name, [[0.0, 0.0], [50.0, height]]);
        let iteration = |number: u32| Iteration {
            number,
            objective: 1.0 / f64::from(number + 1),
            parameters: vec![("k1".into(), 2.0), ("objective".into(), f64::from(number))],
            curves: vec![line("simulated", 10.0 * f64::from(number))],
        };
        let target = Plot::new("acceleration", ["time (ms)", "m/s²"], vec![line("target", 30.0).dashed()]);
        StudyRecording {
            name: "identify".into(),
            over_time: vec![target.clone()],
            searches: vec![Approach { name: "1008".into(), target, iterations: (0..3).map(iteration).collect() }],
            findings: vec![],
            log: vec!["done".into()],
            ..StudyRecording::default()
        }
    }

    #[test]
    fn a_search_is_shown_along_its_iterations() {
        let scene = scene(&study());
        let titles = scene.charts.iter().map(|chart| chart.title.as_str());
        assert_eq!(titles.collect::<Vec<_>>(), ["objective", "k1", "objective"]);
        let mut paths: Vec<&str> = scene.signals.iter().map(|signal| signal.path.as_str()).collect();
        paths.dedup();
        assert_eq!(paths.len(), 3, "an unknown may have any name: {paths:?}");
        assert_eq!(scene.diagrams.iter().map(|plot| plot.title.as_str()).collect::<Vec<_>>(), ["acceleration"; 2]);
        let objective = &scene.signals[0];
        assert_eq!(objective.places, Places::Iterations(vec![0, 1, 2]));
        assert_eq!(objective.values, [1.0, 0.5, 1.0 / 3.0]);
        assert_eq!(scene.diagrams[0].states.len(), 3);
        assert_eq!(scene.diagrams[0].states[2].curves[0].points[1], [50.0, 20.0]);
        let last = scene.events.last().map(|event| (event.at, event.text.as_str()));
        assert_eq!(last, Some((Moment::Iteration(2), "done")));
    }

    #[test]
    fn without_a_search_the_timeline_is_the_time_of_the_test() {
        let scene = scene(&StudyRecording { searches: vec![], ..study() });
        assert_eq!((scene.charts.len(), scene.charts[0].title.as_str()), (1, "acceleration: m/s²"));
        assert_eq!(scene.signals[0].places, Places::Times(vec![0.0, 0.05]));
        assert_eq!((scene.duration, scene.events[0].at), (0.05, Moment::Time(0.0)));
    }
}
