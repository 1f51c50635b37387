//! Screening of many factors by elementary effects (Morris 1991): which matter, in how many runs.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::random::Stream;
use crate::statistics::{self, Bootstrap, Estimate, present};

/// Why there is no screening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ScreeningError {
    /// There is nothing to vary.
    #[error("a screening needs at least one factor")]
    NoFactors,
    /// The number of levels is not even.
    #[error("the number of levels is {levels}, but must be even and at least 2")]
    Levels {
        /// Number of levels.
        levels: usize,
    },
    /// The outputs are not those of whole trajectories.
    #[error("{outputs} outputs are not whole trajectories of {rows} rows")]
    Outputs {
        /// Number of outputs.
        outputs: usize,
        /// Rows of a trajectory.
        rows: usize,
    },
}

/// Trajectories through the unit cube: `trajectories` times d + 1 points, of which each but the first differs from the
/// one before in one factor.
///
/// Every factor takes the middles of `levels` equal parts of the unit interval, (i + ½)/levels, and steps by half of
/// it: Morris's own levels include 0 and 1, where an unbounded distribution has no value. Start and order of the
/// factors are random, not chosen for a large spread. More trajectories keep the first ones.
///
/// # Errors
/// There is no factor, or the number of levels is odd or zero.
pub fn trajectories(
    factors: usize,
    trajectories: usize,
    levels: usize,
    seed: u64,
) -> Result<Vec<Vec<f64>>, ScreeningError> {
    if factors == 0 {
        return Err(ScreeningError::NoFactors);
    }
    if levels == 0 || !levels.is_multiple_of(2) {
        return Err(ScreeningError::Levels { levels });
    }
    let mut stream = Stream::new(seed);
    let mut points = Vec::with_capacity(trajectories * (factors + 1));
    for _ in 0..trajectories {
        let mut at: Vec<usize> = (0..factors).map(|_| stream.below(levels)).collect();
        let middle = |at: &Vec<usize>| at.iter().map(|&level| (level as f64 + 0.5) / levels as f64).collect();
        points.push(middle(&at));
        for factor in stream.permutation(factors) {
            // Half the levels on, around the end: with an even number, every level is reached equally often (theory.md,
            // equation 311).
            at[factor] = (at[factor] + levels / 2) % levels;
            points.push(middle(&at));
        }
    }
    Ok(points)
}

/// Elementary effects of one factor: change of the output over change of the factor's probability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// μ: mean.
    pub mean: f64,
    /// μ*: mean of the magnitudes (Campolongo, Cariboni, Saltelli 2007), by which factors are ranked: effects of either
    /// sign do not cancel. With its bootstrap interval.
    pub mean_magnitude: Estimate,
    /// σ: standard deviation, large where the factor acts non-linearly or with others; none of one effect.
    pub deviation: Option<f64>,
    /// Number of effects.
    pub count: usize,
    /// Number of effects that were left out because an output is missing or no finite number.
    pub missing: usize,
}

/// Effects of every factor from the outputs at `points`, which [`trajectories`] made; none where all are missing.
///
/// # Errors
/// There is not one output a point, or the points are not whole trajectories.
pub fn effects(
    points: &[Vec<f64>],
    outputs: &[Option<f64>],
    bootstrap: &Bootstrap,
) -> Result<Vec<Option<Effects>>, ScreeningError> {
    let factors = points.first().map_or(0, Vec::len);
    let rows = factors + 1;
    if points.len() != outputs.len() || factors == 0 || !points.len().is_multiple_of(rows) {
        return Err(ScreeningError::Outputs { outputs: outputs.len(), rows });
    }
    let mut found = vec![Vec::new(); factors];
    for (points, outputs) in points.chunks(rows).zip(outputs.chunks(rows)) {
        for (pair, ends) in points.windows(2).zip(outputs.windows(2)) {
            // From the points instead of the seed, so that effects need no memory of how the design was made.
            let changed = (0..factors).find(|&factor| pair[0][factor] != pair[1][factor]);
            if let (Some(factor), Some(from), Some(to)) = (changed, present(ends[0]), present(ends[1])) {
                found[factor].push((to - from) / (pair[1][factor] - pair[0][factor]));
            }
        }
    }
    Ok(found.iter().map(|effects| reduced(effects, points.len() / rows, bootstrap)).collect())
}

fn reduced(effects: &[f64], trajectories: usize, bootstrap: &Bootstrap) -> Option<Effects> {
    let magnitudes: Vec<f64> = effects.iter().map(|effect| effect.abs()).collect();
    let [interval] = bootstrap.percentiles(effects.len(), |indices| {
        [Some(indices.iter().map(|&index| magnitudes[index]).sum::<f64>() / indices.len() as f64)]
    });
    Some(Effects {
        mean: statistics::mean(effects)?,
        mean_magnitude: Estimate { value: statistics::mean(&magnitudes)?, interval },
        deviation: statistics::deviation(effects),
        count: effects.len(),
        missing: trajectories - effects.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Function of 20 factors by Morris (1991), section 4, with its random coefficients of the first and second order
    /// from a stream.
    fn morris(u: &[f64], first: &[f64], second: &[Vec<f64>]) -> f64 {
        let w: Vec<f64> = (0..20)
            .map(|i| match i {
                2 | 4 | 6 => 2.0 * (1.1 * u[i] / (u[i] + 0.1) - 0.5),
                _ => 2.0 * (u[i] - 0.5),
            })
            .collect();
        let mut y = 0.0;
        for i in 0..20 {
            y += if i < 10 { 20.0 } else { first[i] } * w[i];
            for j in i + 1..20 {
                y += if j < 6 { -15.0 } else { second[i][j] } * w[i] * w[j];
                for l in j + 1..20 {
                    y += if l < 5 { -10.0 * w[i] * w[j] * w[l] } else { 0.0 };
                    for s in l + 1..20 {
                        y += if s < 4 { 5.0 * w[i] * w[j] * w[l] * w[s] } else { 0.0 };
                    }
                }
            }
        }
        y
    }

    fn evaluated(points: &[Vec<f64>]) -> Vec<Option<f64>> {
        let mut stream = Stream::new(99);
        let first: Vec<f64> = (0..20).map(|_| stream.normal()).collect();
        let second: Vec<Vec<f64>> = (0..20).map(|_| (0..20).map(|_| stream.normal()).collect()).collect();
        points.iter().map(|u| Some(morris(u, &first, &second))).collect()
    }

    /// Morris's figure 1: ten of twenty factors matter, of which the eighth to tenth act linearly.
    #[test]
    fn morriss_function_is_ranked_as_in_his_paper() {
        let points = trajectories(20, 10, 4, 1).unwrap();
        let effects = effects(&points, &evaluated(&points), &Bootstrap::default()).unwrap();
        let effects: Vec<Effects> = effects.into_iter().map(Option::unwrap).collect();
        for (factor, e) in effects.iter().enumerate() {
            let interval = e.mean_magnitude.interval.unwrap();
            println!(
                "x{:<2} μ* {:6.1} ({:6.1} … {:6.1})  μ {:6.1}  σ {:6.1}",
                factor + 1,
                e.mean_magnitude.value,
                interval.low,
                interval.high,
                e.mean,
                e.deviation.unwrap()
            );
        }
        let important = effects[..10].iter().map(|e| e.mean_magnitude.value).fold(f64::INFINITY, f64::min);
        let others = effects[10..].iter().map(|e| e.mean_magnitude.value).fold(0.0, f64::max);
        assert!(important > 2.0 * others, "{important} {others}");
        for factor in [7, 8, 9] {
            assert!((effects[factor].mean - 40.0).abs() < 10.0, "{factor}: a slope of 20 over a width of 2");
            assert!(effects[factor].deviation.unwrap() < 15.0, "{factor}");
        }
        for factor in 0..6 {
            assert!(effects[factor].deviation.unwrap() > 15.0, "{factor} acts with others");
        }
    }

    #[test]
    fn a_linear_function_has_its_slopes_and_no_deviation() {
        let points = trajectories(3, 6, 8, 4).unwrap();
        assert_eq!(points.len(), 24);
        let outputs: Vec<Option<f64>> = points.iter().map(|u| Some(3.0 * u[0] - 2.0 * u[1])).collect();
        let effects = effects(&points, &outputs, &Bootstrap::default()).unwrap();
        for (effects, slope) in effects.iter().map(|effects| effects.as_ref().unwrap()).zip([3.0, -2.0, 0.0_f64]) {
            assert!((effects.mean - slope).abs() < 1e-12);
            assert!((effects.mean_magnitude.value - slope.abs()).abs() < 1e-12);
            assert!(effects.deviation.unwrap() < 1e-12);
            assert_eq!((effects.count, effects.missing), (6, 0));
        }
    }

    #[test]
    fn effects_beside_a_missing_output_are_left_out_and_counted() {
        let points = trajectories(3, 5, 4, 4).unwrap();
        let mut outputs: Vec<Option<f64>> = points.iter().map(|u| Some(u[0] + 2.0 * u[1])).collect();
        // The second point of the first trajectory: two of its effects need it.
        outputs[1] = None;
        let found = effects(&points, &outputs, &Bootstrap::default()).unwrap();
        let missing: Vec<usize> = found.iter().map(|effects| effects.as_ref().unwrap().missing).collect();
        assert_eq!(missing.iter().sum::<usize>(), 2);
        assert!(
            found.iter().flatten().zip([1.0, 2.0, 0.0]).all(|(effects, slope)| (effects.mean - slope).abs() < 1e-12)
        );
        let none = effects(&points, &vec![None; points.len()], &Bootstrap::default()).unwrap();
        assert_eq!(none, [None, None, None]);
    }

    #[test]
    fn points_lie_within_the_cube_and_more_trajectories_keep_the_first() {
        let (few, many) = (trajectories(5, 3, 6, 8).unwrap(), trajectories(5, 9, 6, 8).unwrap());
        assert_eq!(few, many[..few.len()]);
        assert!(many.iter().flatten().all(|&u| u > 0.0 && u < 1.0));
        for trajectory in many.chunks(6) {
            for pair in trajectory.windows(2) {
                let steps: Vec<f64> =
                    (0..5).map(|i| (pair[1][i] - pair[0][i]).abs()).filter(|&step| step > 0.0).collect();
                assert!(steps.len() == 1 && (steps[0] - 0.5).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn impossible_screenings_are_refused() {
        assert_eq!(trajectories(0, 3, 4, 0), Err(ScreeningError::NoFactors));
        assert_eq!(trajectories(2, 3, 5, 0), Err(ScreeningError::Levels { levels: 5 }));
        let refused = effects(&[vec![0.5; 2], vec![0.5; 2]], &[None, None], &Bootstrap::default());
        assert_eq!(refused, Err(ScreeningError::Outputs { outputs: 2, rows: 3 }));
    }
}
