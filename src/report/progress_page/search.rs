//! A search while it runs: its trials, the best so far, and its curves.

use crate::progress_page::runs::{Causes, Counts};
use crate::script_output::{simulated, target};
use plot::{Axis, Curve, Plot, Scale};
use study::identify::{Evaluation, Labels, Progress, SearchStart, TrialEvent};
use study::script::{Compared, Fit};

/// Most trials whose errors are stored.
const MOST_TRIALS: usize = 20_000;

/// A search, or an estimate about its result, as far as it is.
#[derive(Clone, Debug)]
pub(super) struct Search {
    /// Its number among those of the script, from zero.
    pub(super) number: usize,
    /// The function that the script called.
    pub(super) function: String,
    labels: Labels,
    pub(super) unknowns: Vec<String>,
    is_virtual: bool,
    /// Whether it asks for trials.
    pub(super) is_active: bool,
    /// Number, from one, and error of the trials that have one.
    trials: Vec<[f64; 2]>,
    best: Option<Best>,
    counts: Counts,
    pub(super) causes: Causes,
    running: Vec<Vec<f64>>,
    fits: Vec<Curves>,
    /// Its last iteration.
    pub(super) progress: Option<Progress>,
}

/// The best trial so far.
#[derive(Clone, Debug)]
pub(super) struct Best {
    /// Number of the trial, from one.
    pub(super) number: usize,
    /// The point.
    pub(super) x: Vec<f64>,
    /// The value of the objective.
    pub(super) f: f64,
}

/// A reference, and the simulated curves that are compared with it.
#[derive(Clone, Debug)]
struct Curves {
    current: Fit,
    best: Option<Fit>,
}

impl Search {
    pub(super) fn new(start: &SearchStart<'_>) -> Search {
        Search {
            number: start.number,
            function: start.function.to_owned(),
            labels: start.labels.clone(),
            unknowns: start.unknowns.to_vec(),
            is_virtual: start.is_virtual,
            is_active: true,
            trials: vec![],
            best: None,
            counts: Counts::default(),
            causes: Causes::default(),
            running: vec![],
            fits: vec![],
            progress: None,
        }
    }

    /// Takes note of a trial.
    pub(super) fn note(&mut self, event: &TrialEvent<'_>) {
        match event {
            TrialEvent::Begun { x, waiting } => {
                self.counts.waiting = *waiting;
                self.running.push(x.to_vec());
            }
            TrialEvent::Ended { x, trial, waiting } => {
                self.counts.waiting = *waiting;
                if let Some(place) = self.running.iter().position(|other| other == x) {
                    self.running.swap_remove(place);
                }
                if let Some(trial) = trial {
                    self.end(x, &trial.evaluation, &trial.compared);
                }
            }
        }
    }

    fn end(&mut self, x: &[f64], evaluation: &Evaluation, compared: &[Compared]) {
        let f = match evaluation {
            Evaluation::Value(value) => Some(value.value()),
            Evaluation::Failed { cause, .. } => {
                self.causes.add(cause);
                None
            }
            // The search ends; this is no trial.
            Evaluation::Fatal(_) => return,
        };
        self.counts.done += usize::from(f.is_some());
        let number = self.counts.done + self.causes.total();
        let is_better = f.is_some_and(|f| self.best.as_ref().is_none_or(|best| f < best.f));
        if let Some(f) = f.filter(|_| is_better) {
            self.best = Some(Best { number, x: x.to_vec(), f });
        }
        self.compare(compared, is_better);
        let Some(f) = f else { return };
        if self.trials.len() == MOST_TRIALS && is_better {
            // The last one makes room.
            self.trials.pop();
        }
        if self.trials.len() < MOST_TRIALS {
            self.trials.push([number as f64, f]);
        }
    }

    /// Takes note of the curves of the last trial.
    fn compare(&mut self, compared: &[Compared], is_better: bool) {
        for (index, compared) in compared.iter().enumerate() {
            let current = self.labels.fit(index, compared.clone());
            if index == self.fits.len() {
                self.fits.push(Curves { current: current.clone(), best: None });
            }
            // An objective that chooses its reference by its unknowns has no curves.
            let Some(own) = self.fits.get_mut(index).filter(|own| own.current.target == current.target) else {
                continue;
            };
            if is_better {
                own.best = Some(current.clone());
            }
            own.current = current;
        }
    }

    /// Title of the search, its phase, and what it does where it is no search.
    pub(super) fn title(&self) -> String {
        let title = self.labels.full_title(self.number);
        if self.is_search() { title } else { format!("{title}, {}", self.function) }
    }

    /// The title that all its phases have.
    pub(super) fn common_title(&self) -> String {
        self.labels.common_title(self.number)
    }

    /// The name of its phase; empty of a search in one.
    pub(super) fn phase(&self) -> &str {
        self.labels.phase.as_ref().map_or("", |phase| &phase.name)
    }

    /// Whether it goes on where the phase before it ended.
    pub(super) fn continues(&self) -> bool {
        self.labels.continues()
    }

    /// Whether it looks for a minimum.
    pub(super) fn is_search(&self) -> bool {
        ["minimize", "minimize_all", "calibrate", "left_out"].contains(&self.function.as_str())
    }

    pub(super) fn best(&self) -> Option<&Best> {
        self.best.as_ref()
    }

    pub(super) fn counts(&self) -> Counts {
        Counts { running: self.running.len(), failed: self.causes.total(), ..self.counts }
    }

    /// The reference, the best and the current curve of each test, and the error of all trials.
    pub(super) fn plots(&self) -> Vec<Plot> {
        self.fits.iter().map(|fit| self.curves(fit)).chain(self.errors()).collect()
    }

    fn curves(&self, Curves { current, best }: &Curves) -> Plot {
        let own = [best.as_ref().map(|best| simulated("best so far", best)), Some(simulated("current", current))];
        let mut plot = target(&self.title(), self.is_virtual, current);
        plot.curves.splice(..0, own.into_iter().flatten());
        plot
    }

    /// The error of every trial, and the least so far; none before the first has ended.
    fn errors(&self) -> Option<Plot> {
        let mut least = f64::INFINITY;
        let falling = self.trials.iter().map(|[number, f]| {
            least = least.min(*f);
            [*number, least]
        });
        let falling = Curve::line("best so far", falling);
        let [_, _, ..] = &self.trials[..] else { return None };
        let is_positive = self.trials.iter().all(|[_, f]| *f > 0.0);
        let mut trials = Curve::line("trials", self.trials.iter().copied());
        trials.look = plot::Look::Points;
        let curves = vec![falling, trials];
        let mut plot = Plot::new(format!("{}: error", self.title()), ["trial", "error"], curves);
        if is_positive {
            plot.y = Axis { scale: Scale::Logarithmic, ..plot.y };
        }
        Some(plot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::identify::{ObjectiveValue, SignalLabel};
    use study::script::{Over, Target};

    fn trial(f: f64, compared: &[(&Target, [f32; 2])]) -> study::identify::Trial {
        let compared =
            compared.iter().map(|(target, values)| Compared { target: (*target).clone(), values: values.to_vec() });
        study::identify::Trial { evaluation: ObjectiveValue::Scalar(f).into(), compared: compared.collect() }
    }

    fn search() -> Search {
        let signals = ["acceleration (m/s²)", "force (kN)"].map(SignalLabel::parse).to_vec();
        let labels = Labels { title: Some("1008".into()), phase: None, signals };
        let unknowns = ["k1".to_owned(), "ke".to_owned()];
        Search::new(&SearchStart {
            number: 0,
            function: "minimize",
            labels: &labels,
            unknowns: &unknowns,
            is_virtual: true,
        })
    }

    #[test]
    fn a_search_shows_its_reference_its_best_and_its_current_curve() {
        let target = |last| Target { over: Over::Time, places: vec![0.0, 0.05], values: vec![0.0, last] };
        let (first, second) = (target(10.0), target(2.0));
        let mut search = search();
        for (f, height) in [(0.5, 5.0), (0.1, 9.0), (0.3, 13.0)] {
            let x = [f, 1.0];
            search.note(&TrialEvent::Begun { x: &x, waiting: 1 });
            assert_eq!(search.counts().running, 1);
            let trial = trial(f, &[(&first, [0.0, height]), (&second, [0.0, 2.0])]);
            search.note(&TrialEvent::Ended { x: &x, trial: Some(&trial), waiting: 0 });
        }
        let plots = search.plots();
        let titles: Vec<&str> = plots.iter().map(|plot| plot.title.as_str()).collect();
        assert_eq!(titles, ["1008: acceleration", "1008: force", "1008: error"]);
        let shown: Vec<(&str, f64)> =
            plots[0].curves.iter().map(|curve| (curve.name.as_str(), curve.points[1][1])).collect();
        assert_eq!(shown, [("best so far", 9.0), ("current", 13.0), ("reference (virtual)", 10.0)]);
        assert_eq!(plots[2].curves[0].points, [[1.0, 0.5], [2.0, 0.1], [3.0, 0.1]]);
        assert_eq!((search.best().unwrap().number, &search.best().unwrap().x[..]), (2, &[0.1, 1.0][..]));
    }

    #[test]
    fn trials_that_failed_are_told_apart() {
        let mut search = search();
        let failed = study::identify::Trial::from(Evaluation::failed("the film broke"));
        search.note(&TrialEvent::Begun { x: &[2.0, 1.0], waiting: 3 });
        search.note(&TrialEvent::Ended { x: &[2.0, 1.0], trial: Some(&failed), waiting: 2 });
        search.note(&TrialEvent::Begun { x: &[3.0, 1.0], waiting: 1 });
        search.note(&TrialEvent::Ended { x: &[3.0, 1.0], trial: None, waiting: 1 });
        assert_eq!(search.counts(), Counts { waiting: 1, running: 0, done: 0, known: 0, failed: 1 });
        assert!(search.causes.table("trials").contains("the film broke"));
    }
}
