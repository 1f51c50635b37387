//! Where the samples of a posterior begin: the best point of a search, in the unknowns that the posterior has.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::calibrate::fit::Fit;
use crate::calibrate::plan::Plan;
use crate::script::HostResult;

/// The best point of a search. What tests had of their own there, but scatters about a mean here, is one unknown, which each
/// test has another value of.
pub(in crate::calibrate) struct Beginning {
    pub(in crate::calibrate) plan: Arc<Plan>,
    /// Coordinates of the unknowns; the mean over the tests of what they had of their own.
    pub(super) x: Vec<f64>,
    /// Coordinates of the unknowns in each test.
    pub(super) in_tests: Vec<Vec<f64>>,
    /// Derivatives of the residuals of tests and distributions by the coordinates.
    pub(in crate::calibrate) jacobian: DMatrix<f64>,
    /// The model's error, as a share of each signal.
    pub(super) share: f64,
}

impl Beginning {
    /// At the end of a search, where no test has these parameters of its own.
    pub(in crate::calibrate) fn new(plan: &Plan, fit: &Fit, pooled: &[usize]) -> HostResult<Beginning> {
        let joint = plan.without_own(pooled)?;
        // What an unknown was in the search: itself, or the same parameter of one test and of another.
        let of_search = |index: usize| -> Vec<usize> {
            let own = &joint.unknowns[index];
            let is_same = |other: &usize| {
                let other = &plan.unknowns[*other];
                other.parameter == own.parameter && (pooled.contains(&own.parameter) || other.test == own.test)
            };
            (0..plan.unknowns.len()).filter(is_same).collect()
        };
        let places: Vec<Vec<usize>> = (0..joint.unknowns.len()).map(of_search).collect();
        let mean = |places: &Vec<usize>| places.iter().map(|place| fit.x[*place]).sum::<f64>() / places.len() as f64;
        let x: Vec<f64> = places.iter().map(mean).collect();
        let in_test = |test: usize| {
            let acts = |place: &&usize| plan.tests_of(&plan.unknowns[**place]).contains(&test);
            let own =
                |(places, mean): (&Vec<usize>, &f64)| places.iter().find(acts).map_or(*mean, |place| fit.x[*place]);
            places.iter().zip(&x).map(own).collect()
        };
        let in_tests = (0..plan.tests.len()).map(in_test).collect();
        let jacobian = if pooled.is_empty() { fit.jacobian.clone() } else { jacobian([plan, &joint], fit, &places) };
        Ok(Beginning { plan: Arc::new(joint), x, in_tests, jacobian, share: fit.share })
    }
}

/// Of what every test had of its own, one column: residuals of a test depend on its own value alone. Each distribution counts
/// once.
fn jacobian([searched, joint]: [&Plan; 2], fit: &Fit, places: &[Vec<usize>]) -> DMatrix<f64> {
    let with_prior = |plan: &Plan| -> Vec<usize> {
        (0..plan.unknowns.len()).filter(|index| plan.parameter_of(&plan.unknowns[*index]).prior.is_some()).collect()
    };
    let of_tests = fit.jacobian.nrows() - with_prior(searched).len();
    let priors = with_prior(joint);
    DMatrix::from_fn(of_tests + priors.len(), places.len(), |row, column| {
        match priors.get(row.wrapping_sub(of_tests)) {
            None => places[column].iter().map(|place| fit.jacobian[(row, *place)]).sum(),
            Some(index) if *index == column => joint.parameter_of(&joint.unknowns[column]).prior_deviation().recip(),
            Some(_) => 0.0,
        }
    })
}
