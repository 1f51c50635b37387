//! How a search came to its result, as people look at it.

use thiserror::Error;

use super::crew::Desk;
use super::search::{Best, Ended, Iteration};
use crate::script::{ConvergenceHistory, FitHistory, Improvement, Iterate, Over};

/// Most iterations that a picture shows; of longer courses every second, every third, and so on.
const MOST_ITERATIONS: usize = 500;

/// Most improvements whose curves are kept.
const MOST_IMPROVEMENTS: usize = 200;

/// Longest title of a search, name of an unknown or of a signal, characters.
const LONGEST: usize = 200;

/// What people call a search, its unknowns and its signals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Labels {
    /// Of the unknowns.
    pub(super) names: Vec<String>,
    pub(super) title: Option<String>,
    /// Of the signals that the objective compares, with units; as many as the script gave.
    pub(super) signals: Vec<String>,
}

/// A name that is none.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("a search's `title`, `names` and `signals` are texts of 1 to {LONGEST} characters")]
pub(super) struct LabelError;

impl Labels {
    pub(super) fn check(&self) -> Result<(), LabelError> {
        let mut all = self.names.iter().chain(&self.signals).chain(&self.title);
        let sound = |text: &String| !text.trim().is_empty() && text.chars().count() <= LONGEST;
        if all.all(sound) { Ok(()) } else { Err(LabelError) }
    }
}

/// What `best` went through; what was compared on the way, which `is_virtual` or measured, is asked for at `desk`.
pub(super) fn of(
    best: &Best,
    title: String,
    labels: &Labels,
    is_virtual: bool,
    desk: &Desk<'_, '_>,
) -> ConvergenceHistory {
    let objective = |ended: &Ended| thinned(&ended.history, MOST_ITERATIONS).map(|i| (i.iteration, i.f)).collect();
    let history = thinned(&best.best.history, MOST_ITERATIONS).map(iterate);
    ConvergenceHistory {
        title,
        unknowns: labels.names.clone(),
        objectives: best.starts.iter().map(objective).collect(),
        history: history.collect(),
        fits: fits(&best.best, labels, desk),
        is_virtual,
    }
}

fn iterate(Iteration { iteration, f, x, .. }: &Iteration) -> Iterate {
    Iterate { iteration: *iteration, f: *f, x: x.clone() }
}

/// The curves of the trials that were better than all before, one list for each reference.
fn fits(ended: &Ended, labels: &Labels, desk: &Desk<'_, '_>) -> Vec<FitHistory> {
    let better: Vec<&Iteration> = improvements(&ended.history);
    let mut fits: Vec<FitHistory> = Vec::new();
    for iteration in thinned(&better, MOST_IMPROVEMENTS) {
        for (place, compared) in desk.compared(&iteration.x).into_iter().enumerate() {
            let improvement = Improvement { at: iterate(iteration), values: compared.values };
            match fits.get_mut(place) {
                // An objective that chooses its reference by its unknowns has no fit history.
                Some(fit) if fit.target == compared.target => fit.improvements.push(improvement),
                Some(_) => {}
                None => fits.push(FitHistory {
                    words: words(labels, place, compared.target.over),
                    target: compared.target,
                    improvements: vec![improvement],
                }),
            }
        }
    }
    fits
}

fn words(labels: &Labels, place: usize, over: Over) -> String {
    match (labels.signals.get(place), over) {
        (Some(words), _) => words.clone(),
        (None, Over::Time) => format!("signal {}", place + 1),
        (None, Over::Strain) => "stress (MPa)".into(),
    }
}

/// The first iteration, and each that is better than those before.
fn improvements(history: &[Iteration]) -> Vec<&Iteration> {
    let mut least = f64::INFINITY;
    let is_better = |iteration: &&Iteration| {
        let better = iteration.f < least;
        least = least.min(iteration.f);
        better
    };
    history.iter().filter(is_better).collect()
}

/// At most `most` of the items, even from the first on, and the last.
pub(super) fn thinned<T>(items: &[T], most: usize) -> impl Iterator<Item = &T> {
    let every = items.len().div_ceil(most.saturating_sub(1).max(1)).max(1);
    items
        .iter()
        .enumerate()
        .filter(move |(place, _)| place % every == 0 || place + 1 == items.len())
        .map(|(_, item)| item)
}
