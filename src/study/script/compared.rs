//! Comparisons of an objective with its references, thinned for plots.

use lab::experiment::coupon::Curve;
use lab::signal::Series;
use plot::outline;

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
