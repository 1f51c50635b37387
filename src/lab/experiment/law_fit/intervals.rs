//! Intervals of fitted coefficients, as searches have them.

use nalgebra::{DMatrix, DVector};

use super::DataSet;
use crate::confidence::{Confidence, ConfidenceError, ConfidenceOptions, Linearization};

/// Difference of a coefficient over its size by which residuals are differentiated.
const DIFFERENCE: f64 = 1e-5;

/// The intervals of the coefficients `x` with these residuals, of which each test has noise of its own.
pub(super) fn intervals(
    names: &[String],
    x: &[f64],
    sets: &[DataSet],
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Confidence, ConfidenceError> {
    let mut roughness = 0.0_f64;
    let counted: Vec<bool> =
        sets.iter().flat_map(|set| vec![set.weight > 0.0; set.measured.stresses().len()]).collect();
    let at = |x: &[f64]| {
        let kept = residuals(x).into_iter().zip(&counted).filter(|(_, counted)| **counted).map(|(r, _)| r);
        DVector::from_vec(kept.collect())
    };
    let here = at(x);
    let columns = (0..x.len()).map(|index| {
        let step = DIFFERENCE * if x[index] == 0.0 { 1.0 } else { x[index].abs() };
        let beside = |step: f64| {
            let mut x = x.to_vec();
            x[index] += step;
            at(&x)
        };
        let (above, below) = (beside(step), beside(-step));
        roughness = roughness.max((&above - 2.0 * &here + &below).norm());
        (above - below) / (2.0 * step)
    });
    let jacobian = DMatrix::from_columns(&columns.collect::<Vec<_>>());
    let parts = sets.iter().filter(|set| set.weight > 0.0).map(|set| set.measured.stresses().len()).collect();
    let linearization = Linearization { x: x.to_vec(), residuals: here, parts, jacobian, roughness, one_sided: vec![] };
    Confidence::from_linearization(&linearization, &ConfidenceOptions::new(names.to_vec()))
}
