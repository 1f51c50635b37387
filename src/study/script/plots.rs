//! Plots of a script, comparisons of an objective with its references, and the convergence of searches.

use crate::Error;
use base::units::Unit;
use lab::experiment::coupon::Curve;
use lab::signal::Series;
use plot::{Plot, outline};

/// Most plots of one script, and most curves of one plot.
const MOST_PLOTS: usize = 100;
const MOST_CURVES: usize = 60;

/// Most points that the plots of one script hold together.
const MOST_POINTS: usize = 80_000;

/// Longest title, name or axis label, characters.
const LONGEST: usize = 200;

/// Adds the plot, or replaces the one of this title.
pub(super) fn put(plots: &mut Vec<Plot>, plot: Plot) -> Result<(), Error> {
    if let Some(text) = texts(&plot).find(|text| text.trim().is_empty() || text.chars().count() > LONGEST) {
        return Err(Error::new(format!(
            "a title, an axis label or a name of a plot has 1 to {LONGEST} characters, not `{}`",
            text.chars().take(40).collect::<String>()
        )));
    }
    if !(1..=MOST_CURVES).contains(&plot.curves.len()) {
        return Err(Error::new(format!(
            "the plot `{title}` has {count} curves; a plot has 1 to {MOST_CURVES}",
            title = plot.title,
            count = plot.curves.len()
        )));
    }
    let points = |plot: &Plot| plot.curves.iter().map(|curve| curve.points.len()).sum::<usize>();
    let same = plots.iter().position(|other| other.title == plot.title);
    let others = plots.iter().filter(|other| other.title != plot.title);
    let together = others.map(points).sum::<usize>() + points(&plot);
    if together > MOST_POINTS || (same.is_none() && plots.len() >= MOST_PLOTS) {
        return Err(Error::new(format!(
            "a script leaves at most {MOST_PLOTS} plots of {MOST_POINTS} points together: take slices, or resample signals"
        )));
    }
    match same {
        Some(place) => plots[place] = plot,
        None => plots.push(plot),
    }
    Ok(())
}

/// All its texts.
fn texts(plot: &Plot) -> impl Iterator<Item = &String> {
    let names = plot.curves.iter().map(|curve| &curve.name);
    let own = [&plot.title, &plot.x.label, &plot.y.label].into_iter();
    own.chain(names).chain(plot.window.iter().map(|window| &window.label))
}

/// Most samples of a comparison.
const MOST_SAMPLES: usize = 200;

/// The abscissa of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Time, s.
    Time,
    /// Engineering strain of a coupon; the values are stresses, Pa.
    Strain,
    /// Travel or depth, m.
    Travel,
}

/// The part of a reference that simulations are compared with; compared bit by bit.
#[derive(Clone, Debug)]
pub struct Target {
    /// The abscissa.
    pub over: Over,
    /// Times, strains or travels, increasing.
    pub places: Vec<f32>,
    /// The reference at these abscissae; NaN where it was not measured.
    pub values: Vec<f32>,
}

/// Simulated values at the abscissae of a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The reference.
    pub target: Target,
    /// Simulated values; NaN where there is none.
    pub values: Vec<f32>,
}

impl PartialEq for Target {
    fn eq(&self, other: &Target) -> bool {
        let same = |a: &[f32], b: &[f32]| a.iter().map(|a| a.to_bits()).eq(b.iter().map(|b| b.to_bits()));
        self.over == other.over && same(&self.places, &other.places) && same(&self.values, &other.values)
    }
}

impl Compared {
    /// `signal` over the samples of `reference` with `from <= time <= to`.
    pub fn signals(signal: &Series, reference: &Series, window: [f64; 2]) -> Compared {
        let samples = reference.window(window);
        Compared::sampled(Over::Time, samples.samples(), |time| signal.value_at(time))
    }

    /// `signal` over the samples of `reference`, both over a travel or a depth (m).
    pub fn over_travel(signal: &Series, reference: &Series) -> Compared {
        Compared::sampled(Over::Travel, reference.samples(), |place| signal.value_at(place))
    }

    /// `curve` over the samples of `reference`.
    pub fn curves(curve: &Curve, reference: &Curve) -> Compared {
        let samples = reference.strain().iter().zip(reference.stress()).map(|(strain, stress)| [*strain, *stress]);
        Compared::sampled(Over::Strain, samples, |strain| curve.stress_at(strain))
    }

    fn sampled(over: Over, samples: impl Iterator<Item = [f64; 2]>, found: impl Fn(f64) -> Option<f64>) -> Compared {
        let samples = outline(&samples.collect::<Vec<_>>(), MOST_SAMPLES);
        let values = samples.iter().map(|[place, _]| found(*place).unwrap_or(f64::NAN) as f32).collect();
        let places = samples.iter().map(|[place, _]| *place as f32).collect();
        let target = Target { over, places, values: samples.iter().map(|[_, value]| *value as f32).collect() };
        Compared { target, values }
    }
}

/// The convergence history of one search.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceHistory {
    /// The title that the script gave, or `search 1`.
    pub title: String,
    /// Whether it goes on where the search before it ended: both are phases of one search.
    pub continues: bool,
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Lowest objective value after each iteration, one list for each start: iteration and value.
    pub objectives: Vec<Vec<(usize, f64)>>,
    /// The iterates of the best start.
    pub history: Vec<Iterate>,
    /// The fits to the references that the objective compares with, at the best point.
    pub fits: Vec<Fit>,
    /// Whether all references are virtual recordings.
    pub is_virtual: bool,
}

impl ConvergenceHistory {
    /// This phase of a search behind those `before` it: iterations are counted on. Objective values are of this phase alone, since each weighs its signals in its own way.
    pub(super) fn behind(mut self, before: ConvergenceHistory) -> ConvergenceHistory {
        let offset = before.history.last().map_or(0, |at| at.iteration);
        self.history.iter_mut().for_each(|at| at.iteration += offset);
        self.objectives.iter_mut().flatten().for_each(|(iteration, _)| *iteration += offset);
        self.history.splice(..0, before.history);
        ConvergenceHistory { continues: before.continues, ..self }
    }
}

/// A simulated curve and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The quantity of the curves, such as `acceleration`.
    pub quantity: String,
    /// Its unit, where one is known; a curve over strain is shown in it.
    pub unit: Option<Unit>,
    /// The reference.
    pub target: Target,
    /// Simulated values at the abscissae of the reference.
    pub values: Vec<f32>,
}

impl Fit {
    /// Quantity and unit, such as `acceleration (m/s²)`.
    pub fn label(&self) -> String {
        self.unit
            .as_ref()
            .map_or_else(|| self.quantity.clone(), |unit| format!("{} ({})", self.quantity, unit.symbol()))
    }
}

/// The best trial up to an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Number of the iteration, from one.
    pub iteration: usize,
    /// Objective value.
    pub f: f64,
    /// Values of the unknowns.
    pub x: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_peak_is_not_thinned_out() {
        let values: Vec<f64> = (0..5000).map(|i| if i == 1234 { -90.0 } else { 0.0 }).collect();
        let reference = Series::new((0..5000).map(|i| i as f64 * 1e-4).collect::<Vec<_>>(), values);
        let Compared { target, .. } = Compared::signals(&reference, &reference, [0.0, 1.0]);
        assert!(target.values.contains(&-90.0));
    }

    #[test]
    fn comparisons_are_thinned_to_samples_of_the_signal() {
        for count in [1, 2, 199, 200, 201, 5000] {
            let time: Vec<f64> = (0..count).map(|i| i as f64 * 1e-4).collect();
            let reference = Series::new(time.clone(), time.iter().map(|t| t.sin()).collect::<Vec<_>>());
            let signal = reference.with_values(time.iter().map(|t| 2.0 * t).collect());
            let Compared { target, values } = Compared::signals(&signal, &reference, [0.0, 1.0]);
            assert!(values.len() <= 200 && values.len() == count.min(values.len()), "{count}");
            assert_eq!(target.places.first().zip(target.places.last()), Some((&0.0, &(time[count - 1] as f32))));
            for (place, value) in target.places.iter().zip(&values) {
                let at = time.iter().position(|time| *time as f32 == *place).unwrap();
                assert_eq!(*value, signal.values()[at] as f32);
            }
        }
    }
}
