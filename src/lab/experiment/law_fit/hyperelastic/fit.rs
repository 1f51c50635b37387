//! The fit of an energy: the best minimum that is stable.

use nalgebra::{DMatrix, DVector};

use super::Energy;
use super::separable::{Separable, Sign, curve, stresses};
use crate::confidence::{Confidence, ConfidenceOptions, Linearization};
use crate::error::{Error, refusal};
use crate::experiment::descent::descend;
use crate::experiment::law_fit::{
    Coefficient, DataSet, FitOptions, LawFit, Measured, Quality, TestFit, TestKind, Warning, range,
};
use membrane::material::{HyperelasticLaw, Law, Tension};

/// Starts that are searched of those with the least residuals.
const SEARCHED: usize = 8;

/// Share by which residuals must be smaller to be called so.
const SMALLER: f64 = 1e-3;

/// How stable a law is, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stability {
    /// In all kinds of tension up to the stretch that is asked for, and in all states that were measured.
    InRange,
    /// In all states that were measured.
    WhereMeasured,
    /// Not even there, but there is a stiffness at rest.
    AtRest,
    /// Not even at rest.
    Nowhere,
}

/// A minimum of the residuals.
struct Minimum {
    coefficients: Vec<f64>,
    law: HyperelasticLaw,
    /// |r|²
    squares: f64,
    stability: Stability,
}

/// Fits `energy` to the `sets` and predicts the stresses of `predicted`.
pub fn fit_law(energy: Energy, sets: &[DataSet], predicted: &[DataSet], options: &FitOptions) -> Result<LawFit, Error> {
    if !sets.iter().any(|set| set.weight > 0.0) {
        return Err(refusal!("no test has a weight above zero"));
    }
    if let Some(stretch) = options.stable_to.filter(|stretch| !(stretch.is_finite() && *stretch > 1.0)) {
        return Err(refusal!("expected a largest stretch above 1, found {stretch}"));
    }
    let factors = options.weighting.factors(sets);
    let (samples, unknowns) = (factors.iter().filter(|factor| **factor > 0.0).count(), energy.names(usize::MAX).len());
    if samples <= unknowns {
        return Err(refusal!(
            "{samples} measured stresses for {unknowns} coefficients: there must be more stresses than coefficients"
        )
        .with_hint("fit a law with fewer coefficients, or add tests"));
    }
    let problem = Separable::new(energy, sets, factors);
    let stable_to = options.stable_to.unwrap_or_else(|| range(sets)[1].max(1.0));
    let minima = minima(&problem, sets, stable_to);
    let lowest = minima.iter().map(|minimum| minimum.squares).fold(f64::INFINITY, f64::min);
    // Stability counts before residuals: a run with a law that is unstable in its range has no solution.
    let best =
        minima.iter().min_by(|a, b| (a.stability, a.squares).partial_cmp(&(b.stability, b.squares)).expect("finite"));
    let refused = |error: Error| {
        error.with_hint("check signs, units and the order of the columns: nominal stress grows with stretch")
    };
    let no_value = || refused(refusal!("the law has no finite stress at the measured stretches"));
    let best = best.ok_or_else(no_value)?;
    if best.stability == Stability::Nowhere {
        return Err(refused(refusal!("no coefficients that fit have a stiffness at rest")));
    }
    let mut warnings = stability_warnings(best, lowest, stable_to);
    let kinds: Vec<TestKind> = sets.iter().filter(|set| set.weight > 0.0).map(DataSet::kind).collect();
    if kinds.iter().all(|kind| *kind == TestKind::Tension(Tension::Uniaxial)) {
        warnings.push(Warning::UniaxialOnly);
    }
    let names = energy.names(best.coefficients.len());
    if names.len() < unknowns {
        warnings.push(Warning::TermsLeftOut { asked: unknowns / 2, left: names.len() / 2 });
    }
    let on_bound = names.iter().zip(&best.coefficients).filter(|(name, value)| problem.is_on_bound(name, **value));
    warnings.extend(on_bound.map(|(name, value)| Warning::OnBound { coefficient: name.clone(), value: *value }));
    let residuals = |x: &[f64]| problem.residuals(&energy.of_coefficients(x)).as_slice().to_vec();
    let confidence = intervals(&names, &best.coefficients, sets, &residuals);
    let confidence = confidence.map_err(|error| warnings.push(Warning::NoIntervals { why: error.to_string() })).ok();
    let test = |set: &DataSet| {
        let found = stresses(&best.law, &set.measured);
        let curve = match set.measured {
            Measured::Tension(tension, _) => curve(&best.law, tension, range(std::slice::from_ref(set))),
            Measured::Biaxial(_) => vec![],
        };
        TestFit { set: set.clone(), quality: Quality::from_stresses(&set.measured, &found), predicted: found, curve }
    };
    Ok(LawFit {
        choice: match energy {
            Energy::Ogden { .. } => Energy::Ogden { terms: names.len() / 2 },
            other => other,
        },
        coefficients: Coefficient::all(names, &best.coefficients, Energy::is_modulus, confidence.as_ref()),
        law: Law::Hyperelastic(best.law.clone()),
        tests: sets.iter().map(test).collect(),
        predictions: predicted.iter().map(test).collect(),
        weighting: options.weighting,
        stable_to,
        unstable_from: best.law.instability(),
        confidence,
        warnings,
    })
}

/// Reports on the stability of the best minimum.
fn stability_warnings(best: &Minimum, lowest: f64, stable_to: f64) -> Vec<Warning> {
    let unstable = best.law.instability_up_to(stable_to);
    match (best.stability, unstable) {
        (Stability::InRange, _) if best.squares > (1.0 + SMALLER) * lowest => {
            vec![Warning::UnstableRejected { stable: best.squares.sqrt(), unstable: lowest.sqrt(), stable_to }]
        }
        (Stability::InRange, _) => vec![],
        (_, Some((tension, stretch))) => vec![Warning::UnstableInRange { tension, stretch, stable_to }],
        (_, None) => vec![Warning::UnstableWhereMeasured],
    }
}

/// The minima from the best starts, with moduli of either sign and with none that is negative.
fn minima(problem: &Separable<'_>, sets: &[DataSet], stable_to: f64) -> Vec<Minimum> {
    let of_sign = |sign: Sign| {
        let squares = |u: &[f64]| {
            let solved = problem.solve(&problem.shape(u), sign)?;
            Some(solved.residuals.norm_squared()).filter(|squares| squares.is_finite())
        };
        let mut starts: Vec<(f64, Vec<f64>)> =
            problem.starts().into_iter().filter_map(|u| Some((squares(&u)?, u))).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(SEARCHED);
        starts.into_iter().filter_map(move |(_, start)| minimum(problem, start, sign, sets, stable_to))
    };
    [Sign::Free, Sign::NotNegative].into_iter().flat_map(of_sign).collect()
}

fn minimum(problem: &Separable<'_>, start: Vec<f64>, sign: Sign, sets: &[DataSet], stable_to: f64) -> Option<Minimum> {
    let residuals = |u: &[f64]| match problem.solve(&problem.shape(u), sign) {
        Some(solved) => solved.residuals.as_slice().to_vec(),
        None => vec![f64::NAN; sets.iter().map(|set| set.measured.stresses().len()).sum()],
    };
    let u = if start.is_empty() { start } else { descend(start, &residuals) };
    let shape = problem.shape(&u);
    let solved = problem.solve(&shape, sign)?;
    let squares = solved.residuals.norm_squared();
    let coefficients = problem.energy.coefficients(&solved.moduli, &shape);
    if coefficients.is_empty() || !squares.is_finite() || problem.is_cancelled(&solved.moduli) {
        return None;
    }
    let law = problem.energy.of_coefficients(&coefficients);
    let stability = stability(&law, sets, stable_to);
    Some(Minimum { coefficients, law, squares, stability })
}

fn stability(law: &HyperelasticLaw, sets: &[DataSet], stable_to: f64) -> Stability {
    if !law.is_stable_at([1.0, 1.0]) {
        return Stability::Nowhere;
    }
    let where_measured =
        sets.iter().flat_map(|set| set.measured.states(law)).all(|stretches| law.is_stable_at(stretches));
    match (where_measured, law.instability_up_to(stable_to)) {
        (false, _) => Stability::AtRest,
        (true, Some(_)) => Stability::WhereMeasured,
        (true, None) => Stability::InRange,
    }
}

/// Difference of a coefficient over its size by which residuals are differentiated.
const DIFFERENCE: f64 = 1e-5;

/// The intervals of the coefficients `x` with these residuals, of which each test has noise of its own.
fn intervals(
    names: &[String],
    x: &[f64],
    sets: &[DataSet],
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Confidence, Error> {
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
