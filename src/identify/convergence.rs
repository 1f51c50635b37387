//! The convergence history of a search, thinned for plots.

use super::iteration::Iteration;
use super::pool::trial_pool::Evaluator;
use super::result::{SearchResult, StartResult};
use crate::script::{ConvergenceHistory, FitHistory, Improvement, Iterate, Over};

/// Largest number of iterations in a plot.
const MAX_ITERATIONS: usize = 500;

/// Largest number of improvements whose curves are stored.
const MAX_IMPROVEMENTS: usize = 200;

/// Title of a search, and names of its unknowns and signals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Labels {
    /// Names of the unknowns.
    pub(crate) names: Vec<String>,
    /// Title of the search.
    pub(crate) title: Option<String>,
    /// Names and units of the signals that the objective compares, as many as are given.
    pub(crate) signals: Vec<String>,
}

/// The convergence history of `result`; the curves that its objective compared come from `evaluator`, and `is_virtual`
/// says whether all references are virtual recordings.
pub(crate) fn convergence_history(
    result: &SearchResult,
    title: String,
    labels: &Labels,
    is_virtual: bool,
    evaluator: &Evaluator<'_, '_>,
) -> ConvergenceHistory {
    let objective = |start: &StartResult| thinned(&start.history, MAX_ITERATIONS).map(|i| (i.iteration, i.f)).collect();
    ConvergenceHistory {
        title,
        unknowns: labels.names.clone(),
        objectives: result.starts.iter().map(objective).collect(),
        history: thinned(&result.best.history, MAX_ITERATIONS).map(iterate).collect(),
        fits: fits(&result.best, labels, evaluator),
        is_virtual,
    }
}

fn iterate(Iteration { iteration, f, x, .. }: &Iteration) -> Iterate {
    Iterate { iteration: *iteration, f: *f, x: x.clone() }
}

/// The curves of the improvements of one start, one fit history for each reference.
fn fits(result: &StartResult, labels: &Labels, evaluator: &Evaluator<'_, '_>) -> Vec<FitHistory> {
    let better: Vec<&Iteration> = improvements(&result.history);
    let mut fits: Vec<FitHistory> = Vec::new();
    for iteration in thinned(&better, MAX_IMPROVEMENTS) {
        for (index, compared) in evaluator.compared(&iteration.x).into_iter().enumerate() {
            let improvement = Improvement { at: iterate(iteration), values: compared.values };
            match fits.get_mut(index) {
                // An objective that chooses its reference by its unknowns has no fit history.
                Some(fit) if fit.target == compared.target => fit.improvements.push(improvement),
                Some(_) => {}
                None => fits.push(FitHistory {
                    words: words(labels, index, compared.target.over),
                    target: compared.target,
                    improvements: vec![improvement],
                }),
            }
        }
    }
    fits
}

fn words(labels: &Labels, index: usize, over: Over) -> String {
    match (labels.signals.get(index), over) {
        (Some(words), _) => words.clone(),
        (None, Over::Time) => format!("signal {}", index + 1),
        (None, Over::Strain) => "stress (MPa)".into(),
    }
}

/// The first iteration, and each one that is better than all before it.
fn improvements(history: &[Iteration]) -> Vec<&Iteration> {
    let mut least = f64::INFINITY;
    let is_better = |iteration: &&Iteration| {
        let better = iteration.f < least;
        least = least.min(iteration.f);
        better
    };
    history.iter().filter(is_better).collect()
}

/// At most `max` of the items, evenly from the first on, and the last.
pub(crate) fn thinned<T>(items: &[T], max: usize) -> impl Iterator<Item = &T> {
    let every = items.len().div_ceil(max.saturating_sub(1).max(1)).max(1);
    items
        .iter()
        .enumerate()
        .filter(move |(index, _)| index % every == 0 || index + 1 == items.len())
        .map(|(_, item)| item)
}
