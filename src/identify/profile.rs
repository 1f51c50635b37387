//! Profiles of the objective: one parameter held at several places, all others searched again (Venzon and Moolgavkar, Appl.
//! Statist. 37, 1988; Raue et al., Bioinformatics 25, 2009).
//!
//! The places are those of several half-widths of the parameter's interval. From each, the others start where the linear
//! model puts them and go on by damped least squares whose Jacobian is that of the estimate, corrected by what every trial
//! shows (secant version of Levenberg–Marquardt: Madsen, Nielsen and Tingleff, *Methods for Non-Linear Least Squares
//! Problems*, 2004; Broyden 1965). So a place costs two or three trials. All places take their steps together.
//!
//! The interval ends where ‖r‖² has risen by t² times the increase that a standard error makes in the linear model. Noise that
//! is correlated is thereby allowed for (Chandler and Bate, Biometrika 94, 2007), and both intervals agree where the model
//! is linear.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::confidence::{Confidence, ConfidenceError, Reach};
use super::crew::{CrewError, Desk};
use super::objective::Evaluation;
use super::options::{OnFailure, Search};
use super::search::Unfound;
use super::tangent::{Failed, Tangent, TangentError, residuals};

/// Farthest place, in half-widths of the interval.
const FARTHEST: f64 = 2.0;

/// Trials at one place, at most.
const MOST_TRIALS: usize = 6;

/// Improvement still to come, over the rise above the estimate or its threshold, at which a place is done.
const DONE: f64 = 0.01;

/// Damping over the curvature: at first, where a trial first fails to improve, and by how much it changes with success and
/// failure.
const LIGHT: f64 = 1e-8;
const FIRM: f64 = 1e-2;
const LESS: f64 = 0.1;
const MORE: f64 = 10.0;

/// Half-widths, as shares of the parameter, that are taken where the residuals tell nothing about it, and at most where
/// intervals are relative: a profile to the tenfold.
const BLIND: f64 = 0.45;
const WIDEST: f64 = 1.15;

/// Narrowest half-width, over the differences of the Jacobian, of an estimate without any scatter.
const CLOSEST: f64 = 0.05;

/// The objective along one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pub parameter: usize,
    /// By rising value of the parameter; the estimate is one of them.
    pub points: Vec<Point>,
    /// ‖r‖² at the ends of the interval.
    pub threshold: f64,
    /// Ends of the interval of 95 %; none where it is not reached within the points, or not before one without a value.
    pub interval: [Option<f64>; 2],
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// The smallest objective for one value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub value: f64,
    /// All parameters, the one that was held among them.
    pub x: Vec<f64>,
    /// ‖r‖; none where every trial failed.
    pub f: Option<f64>,
}

/// Why there are no profiles.
#[derive(Debug, Error)]
pub enum ProfileError {
    #[error(transparent)]
    Crew(#[from] CrewError),
    #[error(transparent)]
    Tangent(#[from] TangentError),
    #[error(transparent)]
    Confidence(#[from] ConfidenceError),
    #[error("a trial failed at {x:?}: {cause}")]
    Failed { x: Vec<f64>, cause: String, numerical: bool },
}

impl Unfound for ProfileError {
    fn is_numerical(&self) -> bool {
        match self {
            ProfileError::Tangent(error) => error.is_numerical(),
            ProfileError::Failed { numerical, .. } => *numerical,
            ProfileError::Crew(_) | ProfileError::Confidence(_) => false,
        }
    }
}

/// Profiles along all parameters, with `count` places on each side of the estimate as far as bounds allow; `listener` hears
/// of every round of trials: how many places are left.
///
/// # Errors
/// The objective cannot go on or gives another number of residuals than before; a trial fails where that is to stop it all.
pub fn profiles(
    search: &Search,
    tangent: &Tangent,
    confidence: &Confidence,
    count: usize,
    desk: &Desk<'_, '_>,
    listener: &mut (dyn FnMut(usize) + Send),
) -> Result<Vec<Profile>, ProfileError> {
    let mut walks: Vec<Walk> = (0..tangent.x.len())
        .flat_map(|place| values(search, confidence, place, count).into_iter().map(move |value| (place, value)))
        .map(|(place, value)| Walk::new(search, tangent, confidence, place, value))
        .collect();
    loop {
        let open: Vec<&mut Walk> = walks.iter_mut().filter(|walk| walk.next.is_some()).collect();
        if open.is_empty() {
            break;
        }
        listener(open.len());
        let points: Vec<Vec<f64>> = open.iter().filter_map(|walk| walk.next.clone()).collect();
        let found = desk.evaluate_all(&points)?;
        for ((walk, x), found) in open.into_iter().zip(points).zip(found) {
            let residuals = checked(search, tangent, &x, found)?;
            walk.take(search, x, residuals);
        }
    }
    let profile = |place| {
        let walks = walks.iter().filter(|walk| walk.held == place);
        profile(place, walks, tangent, confidence)
    };
    Ok((0..tangent.x.len()).map(profile).collect())
}

/// The residuals of a trial; none where it failed and counts as worst.
fn checked(
    search: &Search,
    tangent: &Tangent,
    x: &[f64],
    found: Evaluation,
) -> Result<Option<DVector<f64>>, ProfileError> {
    let expected = tangent.residuals.len();
    match residuals(found)? {
        Ok(found) if found.len() == expected => Ok(Some(DVector::from_vec(found))),
        Ok(found) => Err(TangentError::Residuals { x: x.into(), found: found.len(), expected }.into()),
        Err(Failed { cause, numerical }) if search.on_failure == OnFailure::Stop => {
            Err(ProfileError::Failed { x: x.into(), cause, numerical })
        }
        Err(_) => Ok(None),
    }
}

/// Places along one parameter, the estimate left out.
fn values(search: &Search, confidence: &Confidence, place: usize, count: usize) -> Vec<f64> {
    let x = confidence.x[place];
    let [lower, upper] = search.bounds.pairs().nth(place).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let size = if x == 0.0 { 1.0 } else { x.abs() };
    let half_width = confidence.quantile * confidence.standard_errors[place];
    let widest = if confidence.relative { WIDEST * size } else { f64::INFINITY };
    let half_width = if half_width.is_finite() { half_width.min(widest) } else { BLIND * size };
    let reach = Reach::new(x, half_width.max(CLOSEST * search.difference * size), confidence.relative);
    let [down, up] = [-FARTHEST, FARTHEST].map(|far| reach.at(far).clamp(lower, upper));
    let share = |step: usize| step as f64 / count as f64;
    let below = (1..=count).rev().map(|step| x + (down - x) * share(step));
    let above = (1..=count).map(|step| x + (up - x) * share(step));
    below.chain(above).filter(|value| *value != x).collect()
}

/// The search of the others for one value of a parameter.
struct Walk {
    held: usize,
    scale: Vec<f64>,
    /// The place that the next secant is drawn from: the estimate at first.
    from: (Vec<f64>, DVector<f64>),
    /// Best so far.
    best: Option<(Vec<f64>, DVector<f64>)>,
    jacobian: DMatrix<f64>,
    damping: f64,
    trials: usize,
    /// The first place that is tried.
    first: Vec<f64>,
    next: Option<Vec<f64>>,
    /// Where to go where the first trial fails.
    instead: Option<Vec<f64>>,
    /// Of the estimate: ‖r‖², and its rise to the threshold.
    least: f64,
    rise: f64,
}

impl Walk {
    fn new(search: &Search, tangent: &Tangent, confidence: &Confidence, held: usize, value: f64) -> Walk {
        let mut walk = Walk {
            held,
            scale: tangent.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect(),
            from: (tangent.x.clone(), tangent.residuals.clone()),
            best: None,
            jacobian: tangent.jacobian.clone(),
            damping: LIGHT,
            trials: 0,
            first: vec![],
            next: None,
            instead: None,
            least: tangent.residuals.norm_squared(),
            rise: rise(confidence, held),
        };
        let mut beside = tangent.x.clone();
        beside[held] = value;
        let moved = tangent.jacobian.column(held) * (value - tangent.x[held]);
        // The estimate is a minimum: what it leaves of the residuals is none of the others' business.
        let mut start = walk.stepped(search, &beside, &moved).unwrap_or_else(|| beside.clone());
        start[held] = value;
        walk.instead = Some(beside).filter(|beside| *beside != start);
        walk.first.clone_from(&start);
        walk.next = Some(start);
        walk
    }

    /// Takes what was found at `x`, and says where to go next.
    fn take(&mut self, search: &Search, x: Vec<f64>, found: Option<DVector<f64>>) {
        self.trials += 1;
        let improves = |found: &DVector<f64>| {
            self.best.as_ref().is_none_or(|(_, best)| found.norm_squared() < best.norm_squared())
        };
        match found {
            Some(found) => {
                let better = improves(&found);
                self.correct(&x, &found);
                self.damp(better);
                if better {
                    self.from = (x.clone(), found.clone());
                    self.best = Some((x, found));
                }
            }
            None => self.damp(false),
        }
        self.next = match &self.best {
            None => self.instead.take(),
            Some(_) if self.trials >= MOST_TRIALS => None,
            Some((x, residuals)) => self.worthwhile(search, x, residuals),
        };
    }

    fn damp(&mut self, better: bool) {
        self.damping = if better { LESS * self.damping } else { (MORE * self.damping).max(FIRM) };
    }

    /// Broyden's correction: the Jacobian with the least change that explains the difference from the place before.
    fn correct(&mut self, x: &[f64], found: &DVector<f64>) {
        let step: Vec<f64> = x.iter().zip(&self.from.0).zip(&self.scale).map(|((x, from), s)| (x - from) / s).collect();
        let square: f64 = step.iter().map(|step| step * step).sum();
        if square == 0.0 {
            return;
        }
        let mut missed = found - &self.from.1;
        for (place, step) in step.iter().enumerate() {
            missed.axpy(-step * self.scale[place], &self.jacobian.column(place), 1.0);
        }
        for (place, step) in step.iter().enumerate() {
            let change = step / square / self.scale[place];
            self.jacobian.column_mut(place).axpy(change, &missed, 1.0);
        }
    }

    /// The next trial, where what it promises is worth one.
    fn worthwhile(&self, search: &Search, x: &[f64], residuals: &DVector<f64>) -> Option<Vec<f64>> {
        let next = self.stepped(search, x, residuals)?;
        let mut there = residuals.clone();
        for (place, (next, x)) in next.iter().zip(x).enumerate() {
            there.axpy(next - x, &self.jacobian.column(place), 1.0);
        }
        let now = residuals.norm_squared();
        let gain = now - there.norm_squared();
        (gain > DONE * self.rise.max(now - self.least)).then_some(next)
    }

    /// A damped step of all but the held parameter, within the bounds; none where there is nowhere to go.
    fn stepped(&self, search: &Search, x: &[f64], residuals: &DVector<f64>) -> Option<Vec<f64>> {
        let free: Vec<usize> = (0..x.len()).filter(|place| *place != self.held).collect();
        let column = |place: usize| self.jacobian.column(place) * self.scale[place];
        let columns: Vec<DVector<f64>> = free.iter().map(|place| column(*place)).collect();
        let mut normal = DMatrix::from_fn(free.len(), free.len(), |i, j| columns[i].dot(&columns[j]));
        let least = f64::EPSILON * normal.diagonal().amax();
        for place in 0..free.len() {
            normal[(place, place)] = normal[(place, place)] * (1.0 + self.damping) + least;
        }
        let slope = DVector::from_iterator(free.len(), columns.iter().map(|column| -column.dot(residuals)));
        let step = normal.cholesky()?.solve(&slope);
        let mut next = x.to_vec();
        for (place, step) in free.iter().zip(&step) {
            next[*place] += step * self.scale[*place];
        }
        search.bounds.project(&mut next);
        (next != x && next.iter().all(|next| next.is_finite())).then_some(next)
    }

    /// What was found; the first place that was tried, where nothing was.
    fn point(&self) -> Point {
        match &self.best {
            Some((x, residuals)) => Point { value: x[self.held], x: x.clone(), f: Some(residuals.norm()) },
            None => Point { value: self.first[self.held], x: self.first.clone(), f: None },
        }
    }
}

/// Rise of ‖r‖² from the estimate to the ends of an interval.
fn rise(confidence: &Confidence, place: usize) -> f64 {
    confidence.quantile.powi(2) * confidence.increases[place]
}

fn profile<'w>(
    parameter: usize,
    walks: impl Iterator<Item = &'w Walk>,
    tangent: &Tangent,
    confidence: &Confidence,
) -> Profile {
    let estimate = tangent.x[parameter];
    let mut points: Vec<Point> = walks.map(Walk::point).collect();
    points.push(Point { value: estimate, x: tangent.x.clone(), f: Some(tangent.norm()) });
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    let threshold = tangent.residuals.norm_squared() + rise(confidence, parameter);
    let upwards = points.iter().filter(|point| point.value >= estimate);
    let downwards = points.iter().rev().filter(|point| point.value <= estimate);
    let interval = [
        crossing(downwards, tangent.norm(), rise(confidence, parameter)),
        crossing(upwards, tangent.norm(), rise(confidence, parameter)),
    ];
    let name = &confidence.names[parameter];
    let warnings = warnings(name, estimate, &points, interval, [tangent.norm(), threshold]);
    Profile { parameter, points, threshold, interval, warnings }
}

/// Where the objective has risen to the threshold, going from the estimate through `points`. The root of the rise is a
/// straight line in a linear model (Bates and Watts, *Nonlinear Regression Analysis*, 1988), so it is drawn straight from one
/// point to the next.
fn crossing<'p>(points: impl Iterator<Item = &'p Point>, least: f64, rise: f64) -> Option<f64> {
    let root = |f: f64| (f * f - least * least).max(0.0).sqrt();
    // What lies beyond a place without a value is not joined to what lies before it.
    let seen: Vec<[f64; 2]> = points.map_while(|point| Some([point.value, root(point.f?)])).collect();
    let beyond = |pair: &&[[f64; 2]]| pair[1][1] > pair[0][1] && pair[1][1] * pair[1][1] >= rise;
    let pair =
        seen.windows(2).find_map(|pair| <&[[f64; 2]; 2]>::try_from(pair).ok().filter(|pair| beyond(&&pair[..])))?;
    let [[near, low], [far, high]] = *pair;
    Some(near + (far - near) * ((rise.sqrt() - low) / (high - low)).clamp(0.0, 1.0))
}

fn warnings(
    name: &str,
    estimate: f64,
    points: &[Point],
    interval: [Option<f64>; 2],
    [least, threshold]: [f64; 2],
) -> Vec<String> {
    let mut warnings = Vec::new();
    let ends = [points.first(), points.last()];
    let before = points.iter().rev().find(|point| point.f.is_none() && point.value < estimate);
    let behind = points.iter().find(|point| point.f.is_none() && point.value > estimate);
    let sides = ["lower", "upper"].into_iter().zip(ends).zip([before, behind]).zip(interval);
    for (((side, end), gap), reached) in sides {
        match (end, gap, reached) {
            (_, Some(gap), None) => warnings.push(format!(
                "{name} has no {side} bound before {:.4}, where trials failed: that end of its interval is open",
                gap.value
            )),
            (Some(end), None, None) => warnings.push(format!(
                "{name} has no {side} bound within {:.4}: the others make up for it, and the objective rises less than noise would",
                end.value
            )),
            _ => {}
        }
    }
    let failed: Vec<String> =
        points.iter().filter(|point| point.f.is_none()).map(|point| format!("{:.4}", point.value)).collect();
    if !failed.is_empty() {
        warnings.push(format!("trials failed where {name} is held at {}", failed.join(", ")));
    }
    let square = |point: &Point| point.f.map(|f| f * f);
    let lower = points.iter().filter_map(|point| Some((square(point)?, point))).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((found, point)) = lower.filter(|(found, _)| least * least - found > DONE * (threshold - least * least))
    {
        let x: Vec<String> = point.x.iter().map(|x| format!("{x:.4}")).collect();
        warnings.push(format!(
            "where {name} is held at {:.4} the objective is lower than at the estimate, {:.6} for {least:.6}, at [{}]: the \
             search had not ended at the minimum",
            point.value,
            found.sqrt(),
            x.join(", ")
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::super::confidence::Question;
    use super::super::noise::Colour;
    use super::super::noise::tests::normals;
    use super::*;
    use crate::identify::{Answer, Bounds, Method, Objective};
    use crate::identify::{Crew, Task};
    use crate::simulate::Cancellation;

    struct Residuals<F>(F);

    impl<F: Fn(&[f64]) -> Vec<f64> + Sync> Objective for Residuals<F> {
        fn evaluate(&self, x: &[f64], _: &Cancellation) -> Evaluation {
            Answer::Residuals((self.0)(x)).checked()
        }
    }

    fn asked(names: &[&str], relative: bool) -> Question {
        Question { names: names.iter().map(|name| (*name).to_owned()).collect(), colour: Colour::White, relative }
    }

    /// Profiles around `search`'s start with three places a side, and how many trials they took.
    fn found(search: &Search, question: &Question, f: impl Fn(&[f64]) -> Vec<f64> + Sync) -> (Vec<Profile>, usize) {
        let trials = std::sync::atomic::AtomicUsize::new(0);
        let counted = Residuals(|x: &[f64]| {
            trials.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            f(x)
        });
        let task = Task { objective: &counted, on_failure: search.on_failure, history: None };
        let found = Crew::new(vec![task], 2).at_work(1 << 20, |desk, _| {
            let tangent = Tangent::at_start(search, desk)?;
            let confidence = Confidence::of(&tangent, question)?;
            profiles(search, &tangent, &confidence, 3, desk, &mut |_| {})
        });
        let found: Result<Vec<Vec<Profile>>, (usize, ProfileError)> = found;
        (found.unwrap().remove(0), trials.into_inner())
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
        let (profiles, trials) = found(&at(&x), &asked(&["a", "b", "c"], false), model);
        let inverse = (a.transpose() * &a).try_inverse().unwrap();
        let least = (&a * DVector::from_column_slice(&x) - &y).norm_squared();
        // 27 degrees of freedom.
        let half_width = |place: usize| 2.0518 * (least / 27.0 * inverse[(place, place)]).sqrt();
        for profile in &profiles {
            let place = profile.parameter;
            assert_eq!(profile.points.len(), 7);
            for point in &profile.points {
                let expected = least + (point.value - x[place]).powi(2) / inverse[(place, place)];
                assert!((point.f.unwrap().powi(2) / expected - 1.0).abs() < 1e-6, "{point:?} for {expected}");
            }
            for (end, side) in profile.interval.into_iter().zip([-1.0, 1.0]) {
                assert!((end.unwrap() - x[place] - side * half_width(place)).abs() < 1e-3 * half_width(place));
            }
            assert_eq!(profile.warnings, Vec::<String>::new());
        }
        assert_eq!(trials, 7 + 18, "a linear model needs one trial a place");
    }

    /// Against the minimum over a found directly: for a e^{−bt} at given b, a is a ratio of sums.
    #[test]
    fn a_decay_s_profile_is_the_minimum_over_the_other_parameter() {
        let noise = normals(21, 40);
        let time = |place: usize| 0.1 * place as f64;
        let data: Vec<f64> = (0..40).map(|place| 2.0 * (-0.8 * time(place)).exp() + 0.2 * noise[place]).collect();
        let model =
            |x: &[f64]| (0..40).map(|place| x[0] * (-x[1] * time(place)).exp() - data[place]).collect::<Vec<_>>();
        let amplitude = |b: f64| {
            let [top, bottom] = (0..40).fold([0.0, 0.0], |[top, bottom], place| {
                let decay = (-b * time(place)).exp();
                [top + decay * data[place], bottom + decay * decay]
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
        let (profiles, trials) = found(&at(&best), &asked(&["a", "b"], true), model);
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
        let bounds = Bounds::new(2, Some(vec![0.5; 2]), Some(vec![20.0; 2])).unwrap();
        let slope: f64 = noise.iter().enumerate().map(|(t, e)| t as f64 * e).sum::<f64>() / 2470.0;
        let search = Search { bounds, ..at(&[2.0, (6.0 + slope) / 2.0]) };
        let (profiles, _) = found(&search, &asked(&["a", "b"], true), model);
        for profile in profiles {
            assert_eq!(profile.interval, [None; 2]);
            assert_eq!(profile.warnings.len(), 2, "{:?}", profile.warnings);
            assert!(profile.warnings[0].contains("has no lower bound within"), "{:?}", profile.warnings);
            assert!(profile.points.iter().all(|point| (0.5..=20.0).contains(&point.value)));
        }
    }

    #[test]
    fn places_where_trials_fail_are_told() {
        let (x, a, y) = line(&normals(8, 30));
        let model = |beyond: &[f64]| {
            let ok = beyond[0] < x[0] + 0.1;
            if ok { (&a * DVector::from_column_slice(beyond) - &y).as_slice().to_vec() } else { vec![f64::NAN] }
        };
        let (profiles, _) = found(&at(&x), &asked(&["a", "b", "c"], false), model);
        let along_a = &profiles[0];
        assert!(along_a.interval[0].is_some() && along_a.interval[1].is_none(), "{along_a:?}");
        assert!(along_a.warnings.iter().any(|warning| warning.starts_with("trials failed where a is held at")));
        assert_eq!(along_a.points.iter().filter(|point| point.f.is_none()).count(), 3);
    }

    /// The end lies between the first place, at ⅔ of the half-width, and the second, which fails; at the third there is a
    /// value again.
    #[test]
    fn an_interval_does_not_reach_across_places_where_trials_fail() {
        let (x, a, y) = line(&normals(8, 30));
        let plain = |x: &[f64]| (&a * DVector::from_column_slice(x) - &y).as_slice().to_vec();
        let (whole, _) = found(&at(&x), &asked(&["a", "b", "c"], false), plain);
        let [second, third] = [5, 6].map(|place| whole[0].points[place].value);
        let end = whole[0].interval[1].unwrap();
        assert!(whole[0].points[4].value < end && end < second, "the end lies before the second place");
        let model = |beyond: &[f64]| {
            let ok = (beyond[0] - second).abs() > 0.1 * (third - second);
            if ok { plain(beyond) } else { vec![f64::NAN] }
        };
        let (profiles, _) = found(&at(&x), &asked(&["a", "b", "c"], false), model);
        let along_a = &profiles[0];
        assert!(along_a.points[5].f.is_none() && along_a.points[6].f.is_some(), "{along_a:?}");
        assert_eq!(along_a.interval, [whole[0].interval[0], None]);
        let told =
            format!("a has no upper bound before {second:.4}, where trials failed: that end of its interval is open");
        assert_eq!(along_a.warnings[0], told);
    }

    #[test]
    fn a_lower_objective_beside_the_estimate_is_told() {
        let (x, a, y) = line(&normals(8, 30));
        let beside = [x[0] + 0.5, x[1], x[2]];
        let model = |x: &[f64]| (&a * DVector::from_column_slice(x) - &y).as_slice().to_vec();
        let (profiles, _) = found(&at(&beside), &asked(&["a", "b", "c"], false), model);
        let told = profiles.iter().flat_map(|profile| &profile.warnings);
        assert!(
            told.filter(|warning| warning.contains("the search had not ended at the minimum")).count() > 0,
            "{profiles:?}"
        );
    }
}
