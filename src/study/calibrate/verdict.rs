//! What the tests tell of each parameter: determined, only together with others, at its bound, or not at all.

use std::fmt;

use nalgebra::{DMatrix, SymmetricEigen};

use super::plan::Plan;
use crate::identify::Side;

/// Two-sided quantile of 95 % of the normal distribution.
pub(super) const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Share of the width before the tests from which on the tests say next to nothing of a parameter.
const OF_PRIOR: f64 = 0.8;
/// Correlation from which on a parameter counts as a partner of another.
const PARTNER: f64 = 0.7;

/// The verdict on one unknown.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Its interval is as narrow as was asked for.
    Determined,
    /// It would be, if these were known.
    OnlyTogether(Vec<String>),
    /// The search ended at a bound.
    AtBound(Side),
    /// Its interval is wide whatever the others are.
    NotDetermined,
    /// The elements of its tests move it by more than its interval, or are coarse in contact.
    MeshLimited,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Determined => f.write_str("determined"),
            Verdict::OnlyTogether(others) => write!(f, "determined only together with {}", others.join(" and ")),
            Verdict::AtBound(side) => write!(f, "at its {side} bound"),
            Verdict::NotDetermined => f.write_str("not determined by these tests"),
            Verdict::MeshLimited => f.write_str("limited by the mesh"),
        }
    }
}

/// What is known of one unknown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Knowledge {
    /// Standard deviation of its coordinate.
    pub(super) deviation: f64,
    /// Interval of 95 % of its value, within the bounds.
    pub(super) interval: [f64; 2],
    /// Half width of an interval of 95 %, relative to the value.
    pub(super) half_width: f64,
    /// Half width if all other unknowns were known.
    pub(super) half_width_alone: f64,
    /// Standard deviation over that before the tests.
    pub(super) prior_share: f64,
    /// By how much its coordinate is moved by the correction for the elements.
    pub(super) mesh_shift: f64,
    pub(super) verdict: Verdict,
}

/// What residuals with this Jacobian tell of the unknowns at `x`, where noise and model error are what they are assumed
/// to be: the inverse of JᵀJ and of what is known before (Laplace's approximation of the posterior).
pub(super) fn linear(plan: &Plan, x: &[f64], jacobian: &DMatrix<f64>, at_bounds: &[(usize, Side)]) -> Vec<Knowledge> {
    let information = information(plan, jacobian);
    let covariance = inverse(&information);
    let known = (0..x.len()).map(|index| {
        let alone = information[(index, index)].sqrt().recip();
        judged(plan, x, index, &covariance, alone, at_bounds)
    });
    known.collect()
}

/// The verdicts on all unknowns with this covariance about `x`, of which these are at their bounds; the Jacobian tells what each
/// would be if the others were known.
pub(super) fn of_covariance(
    plan: &Plan,
    x: &[f64],
    covariance: &DMatrix<f64>,
    jacobian: &DMatrix<f64>,
    at_bounds: &[(usize, Side)],
) -> Vec<Knowledge> {
    let information = information(plan, jacobian);
    let alone = |index: usize| information[(index, index)].sqrt().recip().min(covariance[(index, index)].sqrt());
    (0..x.len()).map(|index| judged(plan, x, index, covariance, alone(index), at_bounds)).collect()
}

/// JᵀJ with what is known before the tests: the residuals have the rows of distributions, bounds count as uniform ones, and
/// these as bounds.
pub(super) fn information(plan: &Plan, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let mut information = jacobian.transpose() * jacobian;
    for (index, unknown) in plan.unknowns.iter().enumerate() {
        let parameter = plan.parameter_of(unknown);
        if !parameter.is_scored() {
            information[(index, index)] += parameter.prior_deviation().powi(-2);
        }
    }
    information
}

/// The inverse of an information matrix, scaled to a unit diagonal first; what nothing is known of has a large variance.
pub(super) fn inverse(information: &DMatrix<f64>) -> DMatrix<f64> {
    let scale = |entry: &f64| if *entry > 0.0 { entry.sqrt().recip() } else { 1.0 };
    let scale: Vec<f64> = information.diagonal().iter().map(scale).collect();
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |r, c| information[(r, c)] * scale[r] * scale[c]);
    // Positive definite, since something is known of every unknown before; rounding may leave it a hair short of that.
    let ridge = DMatrix::identity(scale.len(), scale.len()) * 1e-12;
    let inverse = SymmetricEigen::new(scaled + ridge);
    let of = |value: f64| value.max(1e-12).recip();
    let inverse =
        &inverse.eigenvectors * DMatrix::from_diagonal(&inverse.eigenvalues.map(of)) * inverse.eigenvectors.transpose();
    DMatrix::from_fn(scale.len(), scale.len(), |r, c| inverse[(r, c)] * scale[r] * scale[c])
}

/// The verdict on an unknown with this covariance; `alone` is its deviation if all others were known.
pub(super) fn judged(
    plan: &Plan,
    x: &[f64],
    index: usize,
    covariance: &DMatrix<f64>,
    alone: f64,
    at_bounds: &[(usize, Side)],
) -> Knowledge {
    let unknown = &plan.unknowns[index];
    let parameter = plan.parameter_of(unknown);
    let [low, high] = parameter.ends();
    let deviation = covariance[(index, index)].sqrt();
    let half_width = |deviation: f64| match parameter.is_logarithmic {
        true => (NORMAL_95 * deviation).exp_m1(),
        // Of a value near zero, relative to a twentieth of the distance of its bounds.
        false => NORMAL_95 * deviation / x[index].abs().max(0.05 * (high - low)),
    };
    let ends = [x[index] - NORMAL_95 * deviation, x[index] + NORMAL_95 * deviation];
    let of_prior = |deviation: f64| (deviation / parameter.prior_deviation()).min(1.0);
    let (prior_share, prior_share_alone) = (of_prior(deviation), of_prior(alone));
    let (wide, alone) = (half_width(deviation), half_width(alone));
    let correlation =
        |other: usize| covariance[(index, other)] / (covariance[(index, index)] * covariance[(other, other)]).sqrt();
    let partners = || {
        let mut partners: Vec<usize> = (0..x.len()).filter(|other| *other != index).collect();
        partners.sort_by(|a, b| correlation(*b).abs().total_cmp(&correlation(*a).abs()));
        let first = partners.first().copied();
        let strong = partners.into_iter().filter(|other| Some(*other) == first || correlation(*other).abs() > PARTNER);
        strong.map(|other| plan.unknowns[other].name.clone()).collect::<Vec<_>>()
    };
    let [mesh_shift, without_mesh] = plan.mesh.shift(unknown).unwrap_or([0.0, deviation]);
    let is_coarse = plan.mesh.coarse_of(plan, unknown).next().is_some();
    let bound = at_bounds.iter().find(|(own, _)| *own == index);
    let verdict = match bound {
        Some((_, side)) => Verdict::AtBound(*side),
        None if mesh_shift.abs() > NORMAL_95 * without_mesh || is_coarse => Verdict::MeshLimited,
        None if wide <= plan.precision && prior_share < OF_PRIOR => Verdict::Determined,
        None if alone <= plan.precision && prior_share_alone < OF_PRIOR && x.len() > 1 => {
            Verdict::OnlyTogether(partners())
        }
        None => Verdict::NotDetermined,
    };
    Knowledge {
        deviation,
        interval: ends.map(|end| parameter.value(end.clamp(low, high))),
        half_width: wide,
        half_width_alone: alone,
        prior_share,
        mesh_shift,
        verdict,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nothing_is_known_of_has_a_variance() {
        let found = inverse(&DMatrix::from_row_slice(3, 3, &[4.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 4.0]));
        assert!((found[(0, 0)] - 4.0 / 15.0).abs() < 1e-9 && (found[(0, 2)] + 1.0 / 15.0).abs() < 1e-9, "{found}");
        assert!(found[(1, 1)].is_finite() && found[(1, 1)] > 1e9 && found[(0, 1)].abs() < 1e-3, "{found}");
    }
}
