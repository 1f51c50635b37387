//! Profiles of the objective: one parameter is fixed at several values, and all others are fitted again (Venzon and
//! Moolgavkar, Appl. Statist. 37, 1988; Raue et al., Bioinformatics 25, 2009).
//!
//! The values span several half-widths of the interval of the parameter; all are fitted at the same time, see
//! [`ConstrainedFit`]. The interval ends where ‖r‖² has risen by t² times the increase at one standard error of the
//! linear model. Correlated noise is thereby allowed for (Chandler and Bate, Biometrika 94, 2007), and the intervals of
//! a linear model are those of its covariance.

use nalgebra::DVector;
use thiserror::Error;

use super::constrained_fit::{ConstrainedFit, NEGLIGIBLE, rise};
use super::linearization::{Failed, LinearizationError, residuals};
use crate::identify::bounds::Side;
use crate::identify::error::{SearchError, SearchFailure};
use crate::identify::objective::Evaluation;
use crate::identify::options::{OnFailure, Search};
use crate::identify::point::Point;
use crate::identify::pool::trial_pool::{Evaluator, PoolError};
use crate::identify::warning::Warning;
use base::number;
use lab::confidence::{Confidence, ConfidenceError, Interval, Linearization};

/// Farthest value, in half-widths of the interval.
const FARTHEST: f64 = 2.0;

/// Relative half-width without effect on the residuals, and the largest one of relative intervals: a profile to the
/// tenfold.
const UNDETERMINED: f64 = 0.45;
const WIDEST: f64 = 1.15;

/// Smallest half-width in steps of the differences, for an estimate without scatter.
const NARROWEST: f64 = 0.05;

/// The objective along one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The parameter, from zero.
    pub parameter: usize,
    /// By increasing value of the parameter; one of them is the estimate.
    pub points: Vec<ProfilePoint>,
    /// ‖r‖² at the ends of the interval.
    pub threshold: f64,
    /// Ends of the interval of 95 %; none where the threshold is not reached, or not before a point without a value.
    pub interval: [Option<f64>; 2],
    /// Doubts about the profile.
    pub warnings: Vec<Warning>,
}

impl Profile {
    /// Why the interval has no end on this side; none where it has one.
    pub fn why_open(&self, end: Side) -> Option<String> {
        self.warnings.iter().find_map(|warning| match warning {
            Warning::NoBound { side, limit, .. } if *side == end => {
                Some(format!("rises too little to {}", number::significant(*limit, 4)))
            }
            Warning::OpenInterval { side, limit, .. } if *side == end => {
                Some(format!("trials failed at {}", number::significant(*limit, 4)))
            }
            _ => None,
        })
    }
}

/// The smallest objective value for one value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfilePoint {
    /// The value of the parameter.
    pub value: f64,
    /// All parameters.
    pub x: Vec<f64>,
    /// ‖r‖; none where all trials failed.
    pub f: Option<f64>,
}

/// Why there are no profiles.
#[derive(Debug, Error)]
pub enum ProfileError {
    /// There are no more trials.
    #[error(transparent)]
    Pool(#[from] PoolError),
    /// There is no linearization at the estimate.
    #[error(transparent)]
    Linearization(#[from] LinearizationError),
    /// There are no confidence intervals.
    #[error(transparent)]
    Confidence(#[from] ConfidenceError),
    /// A search that continued from a lower point has no result.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A trial failed where failures stop the search.
    #[error("a trial failed at {x:?}: {cause}")]
    Failed {
        /// The point.
        x: Vec<f64>,
        /// Why.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
}

impl SearchFailure for ProfileError {
    fn is_numerical(&self) -> bool {
        match self {
            ProfileError::Linearization(error) => error.is_numerical(),
            ProfileError::Search(error) => error.is_numerical(),
            ProfileError::Failed { numerical, .. } => *numerical,
            ProfileError::Pool(_) | ProfileError::Confidence(_) => false,
        }
    }

    fn cause_of_trial(&self) -> Option<&str> {
        match self {
            ProfileError::Linearization(error) => error.cause_of_trial(),
            ProfileError::Search(error) => error.cause_of_trial(),
            ProfileError::Failed { cause, .. } => Some(cause),
            ProfileError::Pool(_) | ProfileError::Confidence(_) => None,
        }
    }
}

/// Profiles along all parameters, with `count` values on each side of the estimate as far as the bounds allow;
/// `observer` is called before each round of trials with the number of fits that it continues.
///
/// # Errors
/// A fatal error of the objective, a changed number of residuals, or a failed trial where failures stop the search.
pub fn profiles(
    search: &Search,
    linearization: &Linearization,
    confidence: &Confidence,
    count: usize,
    evaluator: &Evaluator<'_, '_>,
    observer: &mut (dyn FnMut(usize) + Send),
) -> Result<Vec<Profile>, ProfileError> {
    let mut fits: Vec<ConstrainedFit> = (0..linearization.x.len())
        .flat_map(|index| values(search, confidence, index, count).into_iter().map(move |value| (index, value)))
        .map(|(index, value)| ConstrainedFit::new(search, linearization, confidence, index, value))
        .collect();
    loop {
        let open: Vec<&mut ConstrainedFit> = fits.iter_mut().filter(|fit| fit.next.is_some()).collect();
        if open.is_empty() {
            break;
        }
        observer(open.len());
        // The next trials of all fits in one round: they do not depend on one another, and fill the threads.
        let points: Vec<Vec<f64>> = open.iter().filter_map(|fit| fit.next.clone()).collect();
        let outcomes = evaluator.evaluate_all(&points)?;
        for ((fit, x), outcome) in open.into_iter().zip(points).zip(outcomes) {
            let residuals = checked(search, linearization, &x, outcome)?;
            fit.update(search, x, residuals);
        }
    }
    let profile = |index| {
        let fits = fits.iter().filter(|fit| fit.fixed() == index);
        profile(index, fits, linearization, confidence)
    };
    Ok((0..linearization.x.len()).map(profile).collect())
}

/// The residuals of a trial; none where it failed.
fn checked(
    search: &Search,
    linearization: &Linearization,
    x: &[f64],
    found: Evaluation,
) -> Result<Option<DVector<f64>>, ProfileError> {
    let expected = linearization.residuals.len();
    match residuals(found)? {
        Ok(found) if found.len() == expected => Ok(Some(DVector::from_vec(found))),
        Ok(found) => Err(LinearizationError::Residuals { x: x.into(), found: found.len(), expected }.into()),
        Err(Failed { cause, numerical }) if search.on_failure == OnFailure::Stop => {
            Err(ProfileError::Failed { x: x.into(), cause, numerical })
        }
        Err(_) => Ok(None),
    }
}

/// Values of one parameter without the estimate.
fn values(search: &Search, confidence: &Confidence, index: usize, count: usize) -> Vec<f64> {
    let x = confidence.x[index];
    let [lower, upper] = search.bounds.pairs().nth(index).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let size = if x == 0.0 { 1.0 } else { x.abs() };
    let half_width = confidence.quantile * confidence.standard_errors[index];
    let widest = if confidence.relative { WIDEST * size } else { f64::INFINITY };
    let half_width = if half_width.is_finite() { half_width.min(widest) } else { UNDETERMINED * size };
    let interval = Interval::new(x, half_width.max(NARROWEST * search.difference * size), confidence.relative);
    let [down, up] = [-FARTHEST, FARTHEST].map(|far| interval.value_at(far).clamp(lower, upper));
    let share = |step: usize| step as f64 / count as f64;
    let below = (1..=count).rev().map(|step| x + (down - x) * share(step));
    let above = (1..=count).map(|step| x + (up - x) * share(step));
    // With the estimate on a bound, all values of that side fall on it.
    below.chain(above).filter(|value| *value != x).collect()
}

fn point(fit: &ConstrainedFit) -> ProfilePoint {
    let (x, f) = fit.result();
    ProfilePoint { value: x[fit.fixed()], x: x.to_vec(), f }
}

fn profile<'f>(
    parameter: usize,
    fits: impl Iterator<Item = &'f ConstrainedFit>,
    linearization: &Linearization,
    confidence: &Confidence,
) -> Profile {
    let estimate = linearization.x[parameter];
    let mut points: Vec<ProfilePoint> = fits.map(point).collect();
    points.push(ProfilePoint { value: estimate, x: linearization.x.clone(), f: Some(linearization.norm()) });
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    let threshold = linearization.residuals.norm_squared() + rise(confidence, parameter);
    let upwards = points.iter().filter(|point| point.value >= estimate);
    let downwards = points.iter().rev().filter(|point| point.value <= estimate);
    let interval = [
        crossing(downwards, linearization.norm(), rise(confidence, parameter)),
        crossing(upwards, linearization.norm(), rise(confidence, parameter)),
    ];
    let warnings =
        warnings(&confidence.names, parameter, estimate, &points, interval, [linearization.norm(), threshold]);
    Profile { parameter, points, threshold, interval, warnings }
}

/// The value at which the objective reaches the threshold, going from the estimate through `points`. The root of the
/// rise is linear for a linear model (Bates and Watts, *Nonlinear Regression Analysis*, 1988) and is interpolated
/// linearly.
fn crossing<'p>(points: impl Iterator<Item = &'p ProfilePoint>, least: f64, rise: f64) -> Option<f64> {
    // A point below the estimate, where that is no minimum, counts as one without a rise.
    let root = |f: f64| (f * f - least * least).max(0.0).sqrt();
    // No interpolation across a point without a value.
    let rises: Vec<[f64; 2]> = points.map_while(|point| Some([point.value, root(point.f?)])).collect();
    // Where the objective falls from one point to the next, there is no slope to interpolate with.
    let is_beyond = |pair: &&[[f64; 2]]| pair[1][1] > pair[0][1] && pair[1][1] * pair[1][1] >= rise;
    let pair =
        rises.windows(2).find_map(|pair| <&[[f64; 2]; 2]>::try_from(pair).ok().filter(|pair| is_beyond(&&pair[..])))?;
    let [[near, low], [far, high]] = *pair;
    Some(near + (far - near) * ((rise.sqrt() - low) / (high - low)).clamp(0.0, 1.0))
}

fn warnings(
    names: &[String],
    index: usize,
    estimate: f64,
    points: &[ProfilePoint],
    interval: [Option<f64>; 2],
    [least, threshold]: [f64; 2],
) -> Vec<Warning> {
    let parameter = || names[index].clone();
    let mut warnings = Vec::new();
    let ends = [points.first(), points.last()];
    let below = points.iter().rev().find(|point| point.f.is_none() && point.value < estimate);
    let above = points.iter().find(|point| point.f.is_none() && point.value > estimate);
    let sides = [Side::Lower, Side::Upper].into_iter().zip(ends).zip([below, above]).zip(interval);
    for (((side, end), failed), reached) in sides {
        // An end that was not reached has two reasons: the model has no value there, or the objective does not rise enough.
        match (end, failed, reached) {
            (_, Some(failed), None) => {
                warnings.push(Warning::OpenInterval { parameter: parameter(), side, limit: failed.value });
            }
            (Some(end), None, None) => {
                warnings.push(Warning::NoBound { parameter: parameter(), side, limit: end.value });
            }
            _ => {}
        }
    }
    let values: Vec<f64> = points.iter().filter(|point| point.f.is_none()).map(|point| point.value).collect();
    if !values.is_empty() {
        warnings.push(Warning::ProfileFailed { parameter: parameter(), values });
    }
    if let Some((found, x)) = lower(points, least, threshold) {
        let x = Point::new(names, x);
        warnings.push(Warning::LowerThanEstimate { parameter: parameter(), found, estimate: least, x });
    }
    warnings
}

/// The lowest of `points` and its ‖r‖, where it is lower than the estimate by more than a negligible share of the rise.
fn lower(points: &[ProfilePoint], least: f64, threshold: f64) -> Option<(f64, &[f64])> {
    let lowest = points.iter().filter_map(|point| Some((point.f?, &point.x[..]))).min_by(|a, b| a.0.total_cmp(&b.0));
    lowest.filter(|(found, _)| least * least - found * found > NEGLIGIBLE * (threshold - least * least))
}

/// The lowest point of all `profiles` with its parameter and its ‖r‖, where it is lower than the estimate, whose ‖r‖ is
/// `least`.
pub(super) fn lowest(profiles: &[Profile], least: f64) -> Option<(usize, f64, &[f64])> {
    let lower = profiles.iter().filter_map(|profile| {
        let (found, x) = lower(&profile.points, least, profile.threshold)?;
        Some((profile.parameter, found, x))
    });
    lower.min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use lab::confidence::Colour;
    use lab::confidence::ConfidenceOptions;

    use super::super::linearization::linearize_at_start;
    use crate::identify::bounds::Bounds;
    use crate::identify::options::Method;
    use crate::identify::point::unnamed;
    use crate::identify::pool::trial_pool::{Problem, with_evaluator};

    /// White noise of deviation one.
    fn normals(seed: u64, count: usize) -> Vec<f64> {
        StandardNormal.sample_iter(ChaCha8Rng::seed_from_u64(seed)).take(count).collect()
    }

    fn options(names: &[&str], relative: bool) -> ConfidenceOptions {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        ConfidenceOptions { colour: Colour::White, relative, ..ConfidenceOptions::new(names) }
    }

    /// Profiles around `search`'s start with three places a side, and how many trials they took.
    fn found(
        search: &Search,
        options: &ConfidenceOptions,
        f: impl Fn(&[f64]) -> Vec<f64> + Sync,
    ) -> (Vec<Profile>, usize) {
        let trials = std::sync::atomic::AtomicUsize::new(0);
        let counted = |x: &[f64]| {
            trials.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            f(x)
        };
        let problem = Problem { on_failure: search.on_failure, ..Problem::new(&counted) };
        let found: Result<Vec<Profile>, ProfileError> = with_evaluator(problem, 2, |evaluator| {
            let linearization = linearize_at_start(search, evaluator)?;
            let confidence = Confidence::from_linearization(&linearization, options)?;
            profiles(search, &linearization, &confidence, 3, evaluator, &mut |_| {})
        });
        (found.unwrap(), trials.into_inner())
    }

    fn at(x: &[f64]) -> Search {
        Search::new(Method::LevenbergMarquardt, x.into())
    }

    /// Least squares of A x − y, and A.
    fn line(noise: &[f64]) -> (Vec<f64>, DMatrix<f64>, DVector<f64>) {
        let a = DMatrix::from_fn(noise.len(), 3, |row, column| (row as f64 / 10.0).powi(column as i32));
        let y = &a * DVector::from_vec(vec![1.0, -2.0, 0.5]) + DVector::from_column_slice(noise);
        let x = (a.transpose() * &a).try_inverse().unwrap() * a.transpose() * &y;
        (x.as_slice().to_vec(), a, y)
    }

    /// ‖r‖² rises by (x_j − x̂_j)²/[(JᵀJ)⁻¹]_jj, and the interval is x̂ ± t·s.
    #[test]
    fn a_linear_model_has_a_parabola_and_the_interval_of_the_covariance() {
        let (x, a, y) = line(&normals(8, 30));
        let model = |x: &[f64]| (&a * DVector::from_column_slice(x) - &y).as_slice().to_vec();
        let (profiles, trials) = found(&at(&x), &options(&["a", "b", "c"], false), model);
        let inverse = (a.transpose() * &a).try_inverse().unwrap();
        let least = (&a * DVector::from_column_slice(&x) - &y).norm_squared();
        // 27 degrees of freedom.
        let half_width = |index: usize| 2.0518 * (least / 27.0 * inverse[(index, index)]).sqrt();
        for profile in &profiles {
            let index = profile.parameter;
            assert_eq!(profile.points.len(), 7);
            for point in &profile.points {
                let expected = least + (point.value - x[index]).powi(2) / inverse[(index, index)];
                assert!((point.f.unwrap().powi(2) / expected - 1.0).abs() < 1e-6, "{point:?} for {expected}");
            }
            for (end, side) in profile.interval.into_iter().zip([-1.0, 1.0]) {
                assert!((end.unwrap() - x[index] - side * half_width(index)).abs() < 1e-3 * half_width(index));
            }
            assert_eq!(profile.warnings, []);
        }
        assert_eq!(trials, 7 + 18, "a linear model needs one trial for each value");
    }

    /// Against the minimum over a found directly: for a e^{−bt} at given b, a is a ratio of sums.
    #[test]
    fn a_decay_s_profile_is_the_minimum_over_the_other_parameter() {
        let noise = normals(21, 40);
        let time = |index: usize| 0.1 * index as f64;
        let data: Vec<f64> = (0..40).map(|index| 2.0 * (-0.8 * time(index)).exp() + 0.2 * noise[index]).collect();
        let model =
            |x: &[f64]| (0..40).map(|index| x[0] * (-x[1] * time(index)).exp() - data[index]).collect::<Vec<_>>();
        let amplitude = |b: f64| {
            let [top, bottom] = (0..40).fold([0.0, 0.0], |[top, bottom], index| {
                let decay = (-b * time(index)).exp();
                [top + decay * data[index], bottom + decay * decay]
            });
            top / bottom
        };
        let value = |b: f64| model(&[amplitude(b), b]).iter().map(|r| r * r).sum::<f64>();
        let (mut low, mut high) = (0.3, 2.0);
        for _ in 0..200 {
            let [left, right] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if value(left) < value(right) { high = right } else { low = left }
        }
        let best = [amplitude(low), low];
        let (profiles, trials) = found(&at(&best), &options(&["a", "b"], true), model);
        let along_b = &profiles[1];
        for point in &along_b.points {
            let rise = value(point.value) - value(low);
            assert!((point.f.unwrap().powi(2) - value(point.value)).abs() < 0.02 * rise + 1e-9, "{point:?}");
        }
        let [lower, upper] = along_b.interval.map(Option::unwrap);
        for end in [lower, upper] {
            assert!((value(end) / along_b.threshold - 1.0).abs() < 0.03, "{end}: {} {}", value(end), along_b.threshold);
        }
        assert!(lower < 0.8 && upper > 0.8 && trials < 5 + 12 * 4, "{trials} trials");
        assert!(profiles.iter().all(|profile| profile.warnings.is_empty()), "{profiles:?}");
    }

    #[test]
    fn a_product_has_no_bounds_on_its_factors() {
        let noise = normals(3, 20);
        let model = |x: &[f64]| (0..20).map(|t| (x[0] * x[1] - 6.0) * f64::from(t) - noise[t as usize]).collect();
        let bounds = Bounds::new(&unnamed(2), Some(vec![0.5; 2]), Some(vec![20.0; 2])).unwrap();
        let slope: f64 = noise.iter().enumerate().map(|(t, e)| t as f64 * e).sum::<f64>() / 2470.0;
        let search = Search { bounds, ..at(&[2.0, (6.0 + slope) / 2.0]) };
        let (profiles, _) = found(&search, &options(&["a", "b"], true), model);
        for profile in profiles {
            assert_eq!(profile.interval, [None; 2]);
            assert_eq!(profile.warnings.len(), 2, "{:?}", profile.warnings);
            assert!(
                matches!(profile.warnings[0], Warning::NoBound { side: Side::Lower, .. }),
                "{:?}",
                profile.warnings
            );
            assert!(profile.points.iter().all(|point| (0.5..=20.0).contains(&point.value)));
        }
    }

    #[test]
    fn points_where_trials_fail_have_a_warning() {
        let (x, a, y) = line(&normals(8, 30));
        let model = |beyond: &[f64]| {
            let ok = beyond[0] < x[0] + 0.1;
            if ok { (&a * DVector::from_column_slice(beyond) - &y).as_slice().to_vec() } else { vec![f64::NAN] }
        };
        let (profiles, _) = found(&at(&x), &options(&["a", "b", "c"], false), model);
        let along_a = &profiles[0];
        assert!(along_a.interval[0].is_some() && along_a.interval[1].is_none(), "{along_a:?}");
        let failed =
            |warning: &Warning| matches!(warning, Warning::ProfileFailed { parameter, .. } if parameter == "a");
        assert!(along_a.warnings.iter().any(failed));
        assert_eq!(along_a.points.iter().filter(|point| point.f.is_none()).count(), 3);
    }

    /// The end lies between the first index, at ⅔ of the half-width, and the second, which fails; at the third there is
    /// a value again.
    #[test]
    fn an_interval_does_not_extend_across_failed_trials() {
        let (x, a, y) = line(&normals(8, 30));
        let plain = |x: &[f64]| (&a * DVector::from_column_slice(x) - &y).as_slice().to_vec();
        let (whole, _) = found(&at(&x), &options(&["a", "b", "c"], false), plain);
        let [second, third] = [5, 6].map(|index| whole[0].points[index].value);
        let end = whole[0].interval[1].unwrap();
        assert!(whole[0].points[4].value < end && end < second, "the end lies before the second value");
        let model = |beyond: &[f64]| {
            let ok = (beyond[0] - second).abs() > 0.1 * (third - second);
            if ok { plain(beyond) } else { vec![f64::NAN] }
        };
        let (profiles, _) = found(&at(&x), &options(&["a", "b", "c"], false), model);
        let along_a = &profiles[0];
        assert!(along_a.points[5].f.is_none() && along_a.points[6].f.is_some(), "{along_a:?}");
        assert_eq!(along_a.interval, [whole[0].interval[0], None]);
        let open = Warning::OpenInterval { parameter: "a".into(), side: Side::Upper, limit: second };
        assert_eq!(along_a.warnings[0], open);
    }

    #[test]
    fn a_lower_objective_beside_the_estimate_has_a_warning() {
        let (x, a, y) = line(&normals(8, 30));
        let beside = [x[0] + 0.5, x[1], x[2]];
        let model = |x: &[f64]| (&a * DVector::from_column_slice(x) - &y).as_slice().to_vec();
        let (profiles, _) = found(&at(&beside), &options(&["a", "b", "c"], false), model);
        let mut warnings = profiles.iter().flat_map(|profile| &profile.warnings);
        assert!(warnings.any(|warning| matches!(warning, Warning::LowerThanEstimate { .. })), "{profiles:?}");
    }
}
