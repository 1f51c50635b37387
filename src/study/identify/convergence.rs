//! The course of a search: its progress, and its history, thinned for plots.

use std::fmt;

use super::options::Search;
use super::search::{Iteration, SearchResult, StartResult};
use crate::script::{Compared, ConvergenceHistory, Fit, Iterate, Over};
use base::units::{Pressure, Unit};

/// Largest number of iterations in a plot.
const MAX_ITERATIONS: usize = 500;

/// Title of a search, and names of its signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Title of the search.
    pub title: Option<String>,
    /// Which part it is of a search in several, each of which begins where the one before ended.
    pub phase: Option<Phase>,
    /// The signals that the objective compares, as many as are given.
    pub signals: Vec<SignalLabel>,
}

/// A part of a search in several.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its number, from zero.
    pub number: usize,
    /// Such as `stage 1 of 2`.
    pub name: String,
}

impl Labels {
    /// The title, or that of the search of this number, from zero.
    pub fn common_title(&self, number: usize) -> String {
        self.title.clone().unwrap_or_else(|| format!("search {}", number + 1))
    }

    /// The same with the phase where there is one.
    pub fn full_title(&self, number: usize) -> String {
        let title = self.common_title(number);
        self.phase.as_ref().map_or_else(|| title.clone(), |phase| format!("{title}, {}", phase.name))
    }

    /// Whether it goes on where the phase before it ended.
    pub fn continues(&self) -> bool {
        self.phase.as_ref().is_some_and(|phase| phase.number > 0)
    }

    /// The curve that the objective compares with its reference as number `index`.
    pub fn fit(&self, index: usize, Compared { target, values }: Compared) -> Fit {
        let SignalLabel { quantity, unit } = SignalLabel::for_signal(self, index, target.over);
        Fit { quantity, unit, target, values }
    }
}

/// The label of a signal: its quantity and its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalLabel {
    quantity: String,
    unit: Option<Unit>,
}

impl SignalLabel {
    /// The label that a script writes, such as `acceleration (m/s²)`. What ends with no unit in parentheses is a
    /// quantity as a whole.
    pub fn parse(text: &str) -> SignalLabel {
        let parts = text.strip_suffix(')').and_then(|text| text.rsplit_once('('));
        match parts.and_then(|(quantity, symbol)| Some((quantity.trim_end(), Unit::parse(symbol).ok()?))) {
            Some((quantity, unit)) if !quantity.is_empty() => {
                SignalLabel { quantity: quantity.into(), unit: Some(unit) }
            }
            _ => SignalLabel { quantity: text.into(), unit: None },
        }
    }

    /// The label of a stress in MPa.
    fn stress(quantity: &str) -> SignalLabel {
        SignalLabel { quantity: quantity.into(), unit: Unit::parse("MPa").ok() }
    }

    /// The label of signal `index`: of a stress, where it is compared over strain.
    fn for_signal(labels: &Labels, index: usize, over: Over) -> SignalLabel {
        let is_stress = |unit: &Unit| unit.measures(Pressure::DIMENSION);
        match (labels.signals.get(index), over) {
            (None, Over::Time | Over::Travel) => SignalLabel { quantity: format!("signal {}", index + 1), unit: None },
            (None, Over::Strain) => SignalLabel::stress("stress"),
            (Some(label), Over::Strain) if !label.unit.as_ref().is_some_and(is_stress) => {
                SignalLabel::stress(&label.quantity)
            }
            (Some(label), _) => label.clone(),
        }
    }
}

/// The convergence history of `result` over unknowns with these `names`; the objective compared these curves
/// at its best point, and `is_virtual` says whether all references are virtual recordings.
pub(crate) fn convergence_history(
    result: &SearchResult,
    title: String,
    names: &[String],
    labels: &Labels,
    is_virtual: bool,
    compared: Vec<Compared>,
) -> ConvergenceHistory {
    let iterate = |own: &Iteration| Iterate { iteration: own.iteration, f: own.f, x: own.x.clone() };
    let objective = |start: &StartResult| thinned(&start.history, MAX_ITERATIONS).map(|i| (i.iteration, i.f)).collect();
    ConvergenceHistory {
        title,
        continues: labels.continues(),
        unknowns: names.to_vec(),
        objectives: result.starts.iter().map(objective).collect(),
        history: thinned(&result.best.history, MAX_ITERATIONS).map(iterate).collect(),
        fits: compared.into_iter().enumerate().map(|(index, compared)| labels.fit(index, compared)).collect(),
        is_virtual,
    }
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

/// Progress of a search after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Title of the search, where it has one or is one of several.
    pub search: Option<String>,
    /// Names of the unknowns.
    pub names: Vec<String>,
    /// Number of starts.
    pub starts: usize,
    /// The iteration.
    pub iteration: Iteration,
    /// Limit of evaluations of one start.
    pub max_evaluations: usize,
}

impl Progress {
    /// Of a search with this title after an iteration. It has no time to go: a search ends where it converges.
    pub(crate) fn after(iteration: &Iteration, search: &Search, title: Option<&str>) -> Progress {
        Progress {
            search: title.map(str::to_owned),
            names: search.names.clone(),
            starts: search.starts.count(),
            iteration: iteration.clone(),
            max_evaluations: search.max_evaluations,
        }
    }
}

impl fmt::Display for Progress {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Iteration { iteration, evaluations, x, f, size, .. } = &self.iteration;
        if let Some(name) = &self.search {
            write!(out, "{name}")?;
        }
        if self.starts > 1 {
            write!(out, " start {} of {}", self.iteration.start + 1, self.starts)?;
        }
        let x: Vec<String> = self.names.iter().zip(x).map(|(name, x)| format!("{name} {x:.5}")).collect();
        write!(out, "{iteration:>5}  f {f:<11.6}  {}", x.join("  "))?;
        if let Some(size) = size {
            write!(out, "  size {size:.2e}")?;
        }
        write!(out, "  {evaluations} of at most {} evaluations", self.max_evaluations)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::options::Method;

    /// Quantity and symbol of the unit.
    fn parts(label: &SignalLabel) -> (&str, Option<&str>) {
        (&label.quantity, label.unit.as_ref().map(Unit::symbol))
    }

    #[test]
    fn a_label_ends_with_its_unit() {
        for (text, expected) in [
            ("acceleration (m/s²)", ("acceleration", Some("m/s²"))),
            ("force (frame) (kN)", ("force (frame)", Some("kN"))),
            ("force (frame)", ("force (frame)", None)),
            ("(mm)", ("(mm)", None)),
            ("MD", ("MD", None)),
        ] {
            assert_eq!(parts(&SignalLabel::parse(text)), expected);
        }
    }

    #[test]
    fn a_signal_over_strain_is_a_stress() {
        for (texts, over, expected) in [
            (&["stress (kPa)"][..], Over::Strain, ("stress", Some("kPa"))),
            (&["MD"], Over::Strain, ("MD", Some("MPa"))),
            (&["MD (mm)"], Over::Strain, ("MD", Some("MPa"))),
            (&[], Over::Strain, ("stress", Some("MPa"))),
            (&["MD (mm)"], Over::Time, ("MD", Some("mm"))),
            (&[], Over::Time, ("signal 1", None)),
        ] {
            let signals = texts.iter().map(|text| SignalLabel::parse(text)).collect();
            let labels = Labels { signals, ..Labels::default() };
            assert_eq!(parts(&SignalLabel::for_signal(&labels, 0, over)), expected, "{texts:?}");
        }
    }

    #[test]
    fn progress_shows_the_names_of_unknowns() {
        let names = vec!["k1".into(), "ke".into()];
        let search = Search { names, ..Search::new(Method::CmaEs, vec![1.0, 2.0]) };
        let (x, step) = (vec![2.75, 1.0 / 3.0], "shrunk");
        let iteration =
            Iteration { start: 0, iteration: 7, evaluations: 15, x, f: 0.1, size: None, spread: None, step };
        let progress = Progress::after(&iteration, &search, Some("1008"));
        let text = "7  f 0.100000     k1 2.75000  ke 0.33333  15 of at most 400 evaluations";
        assert_eq!(progress.to_string(), format!("1008    {text}"));
        assert_eq!(Progress { starts: 3, ..progress }.to_string(), format!("1008 start 1 of 3    {text}"));
    }
}
