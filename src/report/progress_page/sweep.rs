//! The worst run of a sweep so far.

use base::written::Reading;
use study::evaluate::Evaluation;
use study::post::badness;

/// The figure by which the runs of a sweep are ranked, and the run that is worst by it.
#[derive(Clone, Debug)]
pub(super) struct SweepRuns {
    ranked: String,
    /// Place and value.
    worst: Option<(usize, f64)>,
}

impl SweepRuns {
    pub(super) fn new(ranked: &str) -> SweepRuns {
        SweepRuns { ranked: ranked.to_owned(), worst: None }
    }

    /// Takes note of a run; a failed one has no figures.
    pub(super) fn add(&mut self, place: usize, evaluation: &Evaluation) {
        if evaluation.failure.is_some() {
            return;
        }
        let ranked = evaluation.figures.iter().find(|(name, _)| *name == self.ranked);
        if let Some(value) = ranked.and_then(|(_, figure)| figure.number())
            && self.worst.is_none_or(|(_, worst)| badness(&self.ranked, value) > badness(&self.ranked, worst))
        {
            self.worst = Some((place, value));
        }
    }

    /// The run that is worst by the figure by which runs are ranked: number, words, and the value as it is read.
    pub(super) fn worst(&self) -> Option<(usize, String, String)> {
        let (place, value) = self.worst?;
        let (words, reading) = Reading::of_name(&self.ranked, value);
        Some((place + 1, words, reading.text(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::evaluate::Figure;

    #[test]
    fn the_worst_run_is_named_in_the_unit_in_which_it_is_read() {
        let mut runs = SweepRuns::new("peak_force_N");
        assert_eq!(runs.worst(), None);
        let evaluation = |force: f64, failure: Option<&str>| Evaluation {
            figures: vec![
                ("peak_displacement_m".into(), Figure::Number(-0.1 * force)),
                ("peak_force_N".into(), Figure::Number(force)),
            ],
            failure: failure.map(str::to_owned),
            ..Evaluation::failed(String::new())
        };
        runs.add(7, &evaluation(1.0, None));
        runs.add(3, &evaluation(2.0, None));
        runs.add(5, &evaluation(9.0, Some("the film tore")));
        assert_eq!(runs.worst(), Some((4, "peak force".into(), "2 N".into())));
        // The deepest run, although its displacement is the smallest number.
        let mut deep = SweepRuns::new("peak_displacement_m");
        deep.add(7, &evaluation(1.0, None));
        deep.add(3, &evaluation(2.0, None));
        assert_eq!(deep.worst(), Some((4, "peak displacement".into(), "\u{2212}200 mm".into())));
    }
}
