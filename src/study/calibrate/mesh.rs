//! What the elements of the tests are off by at the best point: each test is run on elements of half and of twice the size, the
//! order of convergence follows, the limit corrects the simulated signals, and what the limit is uncertain by is an error of the
//! whole signal (docs/methods.md, equation 331d). At two points of a posterior the runs on half the size show by how much the
//! correction changes there (equation 331e).

use base::number::significant;
use nalgebra::{DMatrix, DVector};

use super::parameter::Unknown;
use super::plan::Plan;
use super::verdict::{information, inverse};
use super::warning::Warning;
use crate::script::{HostResult, Session, run_list};
use lab::signal::Series;

/// Factors of the size of elements: the check, and the run that shows the order.
const FINER: f64 = 0.5;
const COARSER: f64 = 2.0;
/// Orders of convergence that are believed: contact is of the first, smooth film of the second.
const ORDERS: [f64; 2] = [1.0, 2.0];

/// Whether simulated signals are corrected for their elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Elements {
    /// Recordings are of film, which has none.
    Corrected,
    /// Recordings are virtual ones on the same elements.
    Exact,
}

/// What is known of the elements of all tests.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// By how much the correction moves each unknown, and its standard deviation without what the correction is uncertain by, both in
    /// its coordinate.
    shifts: Vec<(Unknown, [f64; 2])>,
    /// Tests whose elements are coarse in contact.
    coarse: Vec<usize>,
}

impl Known {
    /// At the end of a search with this Jacobian; of virtual recordings on the same elements nothing limits anything.
    pub(super) fn new(plan: &Plan, jacobian: &DMatrix<f64>, share: f64, coarse: Vec<usize>) -> Known {
        match plan.elements {
            Elements::Exact => Known::default(),
            Elements::Corrected => Known { shifts: shifts(plan, jacobian, share), coarse },
        }
    }

    /// By how much the correction moves an unknown, and its deviation without the correction's own; of a parameter whose tests had
    /// values of their own, the largest of them.
    pub(super) fn shift(&self, unknown: &Unknown) -> Option<[f64; 2]> {
        let own = self.shifts.iter().find(|(own, _)| own == unknown);
        let of_tests = || self.shifts.iter().filter(|(own, _)| own.parameter == unknown.parameter);
        let largest = || of_tests().max_by(|(_, a), (_, b)| (a[0].abs() / a[1]).total_cmp(&(b[0].abs() / b[1])));
        own.or_else(largest).map(|(_, shift)| *shift)
    }

    /// The tests of an unknown whose elements are coarse in contact.
    pub(super) fn coarse_of(&self, plan: &Plan, unknown: &Unknown) -> impl Iterator<Item = usize> {
        let tests = plan.tests_of(unknown);
        self.coarse.iter().copied().filter(move |test| tests.contains(test))
    }
}

/// The error of the means of a signal over its bins.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeshError {
    /// What is added to the simulated means.
    pub(super) correction: DVector<f64>,
    /// One standard deviation of what the correction is uncertain by, of all bins together.
    pub(super) remainder: DVector<f64>,
    /// The same of its shape: the part of the change before that is across the last one, as the order has it after that.
    across: Option<DVector<f64>>,
    /// By how much it changes where the posterior is, in the same way: in proportion to the way from the best point, and beside it.
    moving: Vec<DVector<f64>>,
    /// The order of convergence.
    pub(super) order: f64,
}

impl MeshError {
    /// All that the correction is uncertain by, each part one standard deviation long.
    pub(super) fn doubts(&self) -> impl Iterator<Item = &DVector<f64>> {
        std::iter::once(&self.remainder).chain(&self.across).chain(&self.moving)
    }

    /// What a run on elements of half the size corrects by, with this order.
    fn corrected(&self, own: &DVector<f64>, finer: &DVector<f64>) -> DVector<f64> {
        (finer - own) * (1.0 + (self.order.exp2() - 1.0).recip())
    }

    /// From means on elements as they are and of half the size, and of twice the size where there are any (Richardson).
    fn new(own: &DVector<f64>, finer: &DVector<f64>, coarser: Option<&DVector<f64>>) -> MeshError {
        let change = finer - own;
        let before = coarser.map(|coarser| (own - coarser).dot(&change) / change.norm_squared());
        let order = before.filter(|ratio| *ratio > 0.0).map_or(ORDERS[0], f64::log2);
        // Rounding aside, and not where a refinement turns back, or where there is no coarser run.
        let is_regular = before.is_some_and(|ratio| ratio >= ORDERS[0].exp2() * (1.0 - 1e-9));
        let order = order.clamp(ORDERS[0], ORDERS[1]);
        let beyond = (order.exp2() - 1.0).recip();
        let correction = &change * (1.0 + beyond);
        // Where elements are too coarse for an order, all of the correction is in doubt.
        let remainder = if is_regular { &change * beyond } else { correction.clone() };
        let across = coarser.map(|coarser| {
            let before = own - coarser;
            let along = before.dot(&change) / change.norm_squared();
            (before - change * along) * (-order).exp2()
        });
        MeshError { correction, remainder, across, moving: Vec::new(), order }
    }
}

/// What came of the runs on other elements.
#[derive(Default)]
pub(super) struct Added {
    pub(super) warnings: Vec<Warning>,
    /// Largest change of a correction, root mean square over the bins, over the noise.
    pub(super) change: f64,
}

/// The signals of a test on elements of this factor of their size, or why there are none, as where its film breaks; nothing of a
/// test without elements.
type OnElements = Option<Result<Vec<Series>, String>>;

/// Runs of all tests at these values on elements of these factors of their size: a row a test.
fn on_elements(plan: &Plan, factors: &[f64], values: &[f64], session: &Session) -> HostResult<Vec<Vec<OnElements>>> {
    let run = |(test, factor): &(usize, f64)| {
        let own = &plan.tests[*test];
        let is_compared = own.signals.iter().any(|signal| signal.distance.is_residuals());
        if own.pull.is_some() || !is_compared {
            return Ok(None);
        }
        let study = own.compared_study().with(plan.changes(*test, values), session)?;
        let Some(study) = study.with_elements(*factor, session) else {
            return Ok(Some(Err("its mesh is a file".to_owned())));
        };
        Ok(Some(plan.simulated(*test, &study, session)))
    };
    let jobs: Vec<(usize, f64)> =
        (0..plan.tests.len()).flat_map(|test| factors.iter().map(move |factor| (test, *factor))).collect();
    let runs = run_list(session, &jobs, run)?;
    Ok(runs.chunks_exact(factors.len()).map(<[OnElements]>::to_vec).collect())
}

/// Takes the error of the elements at these values up into the signals of all tests; the findings of tests where that cannot be.
pub(super) fn add(plan: &mut Plan, simulated: &[Vec<Series>], values: &[f64], session: &Session) -> HostResult<Added> {
    if plan.elements == Elements::Exact {
        return Ok(Added::default());
    }
    let all = on_elements(plan, &[FINER, COARSER], values, session)?;
    let (mut warnings, mut change) = (Vec::new(), 0.0_f64);
    for ((test, simulated), runs) in plan.tests.iter_mut().zip(simulated).zip(&all) {
        let Some(finer) = &runs[0] else { continue };
        let coarser = runs[1].as_ref().and_then(|found| found.as_ref().ok());
        for (place, (signal, simulated)) in test.signals.iter_mut().zip(simulated).enumerate() {
            let means = |series: &Series| signal.errors.means(series).map(DVector::from_vec).ok();
            let found = finer.as_ref().map_err(String::clone).and_then(|finer| {
                let both = means(simulated).zip(means(&finer[place]));
                let (own, finer) = both.ok_or_else(|| format!("its {} ends before the window", signal.name))?;
                let coarser = coarser.and_then(|all| means(&all[place]));
                Ok(MeshError::new(&own, &finer, coarser.as_ref()))
            });
            match found {
                Ok(error) => change = change.max(signal.errors.set_mesh(Some(error))),
                Err(cause) => {
                    warnings.push(Warning::MeshNotChecked { test: test.name.clone(), cause });
                    signal.errors.set_mesh(None);
                }
            }
        }
    }
    Ok(Added { warnings, change })
}

/// By how much corrections change at two points, one standard deviation of the posterior to either side of its middle: the plan
/// whose signals have that as an error, too, and the findings of tests that fail there; none where no signal is corrected.
pub(super) fn with_moving(
    plan: &Plan,
    points: &[Vec<f64>; 2],
    session: &Session,
) -> HostResult<Option<(Plan, Vec<Warning>)>> {
    let is_corrected = plan.tests.iter().flat_map(|test| &test.signals).any(|signal| signal.errors.mesh().is_some());
    if plan.elements == Elements::Exact || !is_corrected {
        return Ok(None);
    }
    let [above, below] = [&points[0], &points[1]].map(|values| on_elements(plan, &[1.0, FINER], values, session));
    let (above, below) = (above?, below?);
    let (mut plan, mut warnings) = (plan.clone(), Vec::new());
    for ((test, above), below) in plan.tests.iter_mut().zip(&above).zip(&below) {
        let failed = above.iter().chain(below).flatten().find_map(|run| run.as_ref().err());
        if let Some(cause) = failed {
            warnings.push(Warning::MeshNotFollowed { test: test.name.clone(), cause: cause.clone() });
            continue;
        }
        for (place, signal) in test.signals.iter_mut().enumerate() {
            let at = |runs: &[OnElements]| {
                let means = |run: &OnElements| {
                    let series = run.as_ref()?.as_ref().ok()?.get(place)?;
                    signal.errors.means(series).map(DVector::from_vec).ok()
                };
                Some(signal.errors.mesh()?.corrected(&means(&runs[0])?, &means(&runs[1])?))
            };
            let Some(error) = signal.errors.mesh() else { continue };
            let (Some(above), Some(below)) = (at(above), at(below)) else {
                let cause = format!("its {} ends before the window", signal.name);
                warnings.push(Warning::MeshNotFollowed { test: test.name.clone(), cause });
                continue;
            };
            let moving = vec![(&above - &below) / 2.0, (&above + &below) / 2.0 - &error.correction];
            let error = MeshError { moving, ..error.clone() };
            signal.errors.set_mesh(Some(error));
        }
    }
    Ok(Some((plan, warnings)))
}

/// By how much the corrections move the unknowns, in the linear model of residuals with this Jacobian, and their deviations. What the
/// corrections are uncertain by is taken out of the covariance again (Woodbury 1950): it would hide them.
fn shifts(plan: &Plan, jacobian: &DMatrix<f64>, share: f64) -> Vec<(Unknown, [f64; 2])> {
    let mut known = information(plan, jacobian);
    let mut pull = DVector::zeros(jacobian.ncols());
    let mut from = 0;
    for test in &plan.tests {
        for signal in &test.signals {
            let parts = signal.errors.whitened_mesh(share).filter(|_| signal.distance.is_residuals());
            if let Some((correction, doubts)) = parts {
                let weight = (test.weight * test.of_signals).sqrt();
                let slopes = jacobian.rows(from, correction.len());
                pull += slopes.tr_mul(&correction) * weight;
                let left = DMatrix::identity(doubts.ncols(), doubts.ncols()) - doubts.tr_mul(&doubts);
                if let Some(left) = left.cholesky() {
                    let along = slopes.tr_mul(&doubts);
                    pull += &along * left.solve(&doubts.tr_mul(&correction)) * weight;
                    known += &along * left.solve(&along.transpose());
                }
            }
            from += signal.count();
        }
        from += test.outcomes.as_ref().map_or(0, super::outcome::Outcomes::residual_count);
    }
    let covariance = inverse(&known);
    let moved = &covariance * pull;
    let of =
        |(index, unknown): (usize, &Unknown)| (unknown.clone(), [-moved[index], covariance[(index, index)].sqrt()]);
    plan.unknowns.iter().enumerate().map(of).collect()
}

/// The sizes that the elements of the tests of an unknown should have, where it may move by `half` and is moved by `shift`; half
/// the size of a test whose signals say nothing of that, and whose elements are coarse.
pub(super) fn sizes(plan: &Plan, unknown: &Unknown, shift: f64, half: f64) -> Vec<String> {
    let size = |place: usize| {
        let test = &plan.tests[place];
        let is_compared = test.signals.iter().any(|signal| signal.distance.is_residuals());
        if test.pull.is_some() || !(is_compared || plan.mesh.coarse.contains(&place)) {
            return None;
        }
        let order = test.signals.iter().filter_map(|signal| signal.errors.mesh_order()).fold(ORDERS[1], f64::min);
        // Where elements are coarse in contact, no order tells how much finer they must be.
        let is_told = is_compared && !plan.mesh.coarse.contains(&place);
        let factor = if is_told { (half / shift.abs()).powf(order.recip()).clamp(0.1, FINER) } else { FINER };
        let own = test.study.smallest_element()?;
        Some(format!("{} mm for {}", significant(1e3 * factor * own, 2), test.name))
    };
    plan.tests_of(unknown).into_iter().filter_map(size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means that differ from their limit by c hᵖ: the limit is found, exactly where the order is one that is believed.
    #[test]
    fn the_limit_of_a_power_of_the_size_is_found() {
        let limit = DVector::from_fn(20, |row, _| (0.3 * row as f64).sin());
        let error = DVector::from_fn(20, |row, _| 0.1 * (0.1 * row as f64).cos());
        for order in [1.0, 1.5, 2.0] {
            let at = |size: f64| &limit + &error * size.powf(order);
            let found = MeshError::new(&at(1.0), &at(0.5), Some(&at(2.0)));
            assert!((at(1.0) + &found.correction - &limit).norm() < 1e-12, "{order}");
            let left = &error * 0.5_f64.powf(order);
            assert!((found.remainder.norm() - left.norm()).abs() < 1e-12 && (found.order - order).abs() < 1e-9);
        }
        // A refinement that turns back, and one without a coarser run: all of it is in doubt.
        let own = &limit + &error;
        let back = MeshError::new(&own, &(&limit - 0.2 * &error), Some(&(&limit - &error)));
        assert_eq!(back.remainder, back.correction);
        let alone = MeshError::new(&own, &(&limit + 0.5 * &error), None);
        assert_eq!(alone.remainder, alone.correction);
        // Slower than the first order: as far as the first order goes, and all of that in doubt.
        let slow = MeshError::new(&(&limit + &error), &(&limit + 0.8 * &error), Some(&(&limit + 1.1 * &error)));
        assert_eq!((slow.remainder.clone(), slow.order), (slow.correction.clone(), 1.0));
        assert!((slow.correction + 0.4 * error).norm() < 1e-12);
    }

    /// What the change before has across the last one is in doubt, half of it where the order is the first.
    #[test]
    fn a_change_of_shape_is_in_doubt() {
        let at = |first: f64, second: f64| DVector::from_vec(vec![first, second, 1.0]);
        let found = MeshError::new(&at(2.0, 0.0), &at(1.0, 0.0), Some(&at(4.0, 0.6)));
        assert_eq!(found.correction, DVector::from_vec(vec![-2.0, 0.0, 0.0]));
        let across = found.across.as_ref().unwrap();
        assert!((across - DVector::from_vec(vec![0.0, -0.3, 0.0])).norm() < 1e-12, "{across}");
        assert_eq!(found.doubts().count(), 2);
        // Of film whose elements err elsewhere in the same way, runs there say the same.
        assert_eq!(found.corrected(&at(2.0, 0.0), &at(1.0, 0.0)), found.correction);
        assert_eq!(MeshError::new(&at(2.0, 0.0), &at(1.0, 0.0), None).across, None);
    }
}
