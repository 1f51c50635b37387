//! Energies of rubber-like film, fitted through the kernels of [`HyperelasticLaw`].
//!
//! The stresses of each energy are linear in its moduli and nonlinear in the rest: exponents, a limit, Poisson's
//! ratio. The search is over these alone, and each of its points has the best moduli (variable projection, Golub and
//! Pereyra, SIAM J. Numer. Anal. 10, 1973). Every start is searched with moduli of any sign and with none that is
//! negative; of all minima the fit is the best one that is stable (methods.md, section 22).

use std::fmt;
use std::str::FromStr;

use nalgebra::{DMatrix, DVector};

use crate::confidence::{Confidence, ConfidenceOptions, Linearization};
use crate::error::{Error, refusal};
use crate::experiment::fit::{descend, moved};
use crate::experiment::law_fit::{
    Coefficient, DataSet, FitOptions, LawFit, Measured, Quality, TestFit, TestKind, Warning, range,
};
use crate::experiment::nonnegative::{least_squares, nonnegative_least_squares};
use membrane::material::{
    CompressibleNeoHookean, Gent, Hyperelastic, HyperelasticLaw, Law, Ogden, OgdenTerm, Polynomial, Tension,
};

/// Energies with their names in a material file, and the keys of their coefficients there; `ogden` alone has three terms.
pub const ENERGIES: [(Energy, &str, &[&str]); 6] = [
    (Energy::NeoHookean, "neo-hookean", &["mu"]),
    (Energy::CompressibleNeoHookean, "compressible-neo-hookean", &["young", "poisson"]),
    (Energy::MooneyRivlin, "mooney-rivlin", &["c10", "c01"]),
    (Energy::Yeoh, "yeoh", &["c10", "c20", "c30"]),
    (Energy::Gent, "gent", &["mu", "jm"]),
    (Energy::Ogden { terms: 3 }, "ogden", &["mu", "alpha"]),
];

/// An energy of rubber-like film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Energy {
    /// `mu`.
    NeoHookean,
    /// `young`, `poisson`.
    CompressibleNeoHookean,
    /// `c10`, `c01`.
    MooneyRivlin,
    /// `c10`, `c20`, `c30`.
    Yeoh,
    /// `mu`, `jm`.
    Gent,
    /// `mu` and `alpha` of as many terms.
    Ogden {
        /// Number of terms, 1 to [`Ogden::TERMS`].
        terms: usize,
    },
}

impl Energy {
    /// The words of all energies.
    pub const WORDS: &'static str =
        "neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent or ogden:N with 1 to 6 terms";

    /// Its row among the [`ENERGIES`].
    fn row(self) -> &'static (Energy, &'static str, &'static [&'static str]) {
        let is_own = |row: &&(Energy, _, _)| std::mem::discriminant(&row.0) == std::mem::discriminant(&self);
        ENERGIES.iter().find(is_own).expect("a row of each energy")
    }

    /// Its name in a material file.
    pub fn law(self) -> &'static str {
        self.row().1
    }

    /// Names of the coefficients; those of Ogden's law up to `most`, a modulus and an exponent a term.
    pub fn names(self, most: usize) -> Vec<String> {
        let keys = self.row().2.iter();
        match self {
            Energy::Ogden { terms } => {
                let of_term = |term: usize| keys.clone().map(move |key| format!("{key}_{term}"));
                (1..=terms).flat_map(of_term).take(most).collect()
            }
            _ => keys.map(|key| (*key).to_owned()).collect(),
        }
    }

    /// Whether the coefficient of this name is in Pa.
    pub(in crate::experiment::law_fit) fn is_modulus(name: &str) -> bool {
        !(name == "jm" || name == "poisson" || name.starts_with("alpha"))
    }
}

impl FromStr for Energy {
    type Err = Error;

    fn from_str(word: &str) -> Result<Energy, Error> {
        let unknown = || refusal!("`{word}` is not a law that can be fitted: expected {}", Energy::WORDS);
        if let Some((energy, ..)) = ENERGIES.into_iter().find(|(_, law, _)| *law == word) {
            return Ok(energy);
        }
        let terms = word.strip_prefix("ogden:").and_then(|terms| terms.parse().ok()).ok_or_else(unknown)?;
        (1..=Ogden::TERMS).contains(&terms).then_some(Energy::Ogden { terms }).ok_or_else(unknown)
    }
}

impl fmt::Display for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Energy::Ogden { terms } => write!(f, "ogden:{terms}"),
            other => f.write_str(other.law()),
        }
    }
}

/// Largest size of an exponent.
const LARGEST_EXPONENT: f64 = 20.0;

/// Smallest size of an exponent: that of zero is a logarithm, which the law has not.
const SMALLEST_EXPONENT: f64 = 1e-3;

/// Largest Poisson's ratio: from 0.5 on film is incompressible.
const LARGEST_POISSON: f64 = 0.4999;

/// Largest J_m over the largest I₁ − 3 of the tests: beyond, the law is neo-Hookean as far as they go.
const LARGEST_LIMIT: f64 = 1e4;

/// Share of a range within which a coefficient lies on its bound.
const ON_BOUND: f64 = 1e-3;

/// Largest sum of the sizes of the terms over the size of their sum: beyond, terms cancel each other.
const MOST_CANCELLED: f64 = 100.0;

/// Exponents from which the starts of Ogden's law are combined.
const EXPONENTS: [f64; 8] = [-8.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0];

/// Whether moduli may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    /// Any.
    Free,
    /// None is negative, so that each term alone is stable.
    NotNegative,
}

/// A fit of one energy: its tests, and what stresses are multiplied by.
struct Separable<'a> {
    energy: Energy,
    sets: &'a [DataSet],
    factors: DVector<f64>,
    /// Measured stresses times their factors.
    target: DVector<f64>,
    /// Largest I₁ − 3 of the tests.
    largest: f64,
}

/// Moduli and shape of an energy, and the residuals that they leave.
struct Solved {
    moduli: Vec<f64>,
    residuals: DVector<f64>,
}

impl<'a> Separable<'a> {
    fn new(energy: Energy, sets: &'a [DataSet], factors: Vec<f64>) -> Separable<'a> {
        let measured = sets.iter().flat_map(|set| set.measured.stresses());
        let target = DVector::from_iterator(factors.len(), measured.zip(&factors).map(|(p, factor)| p * factor));
        Separable { energy, sets, factors: factors.into(), target, largest: largest_invariant(sets) }
    }

    /// Starts of the unknowns u of the shape; one without unknowns where the law is linear.
    fn starts(&self) -> Vec<Vec<f64>> {
        match self.energy {
            Energy::NeoHookean | Energy::MooneyRivlin | Energy::Yeoh => vec![vec![]],
            Energy::CompressibleNeoHookean => [-2.0, 0.0, 2.0].map(|u| vec![u]).into(),
            Energy::Gent => [-4.0, -2.0, 0.0, 2.0, 4.0].map(|u| vec![u]).into(),
            Energy::Ogden { terms } => combinations(terms),
        }
    }

    /// Exponents, limit or Poisson's ratio of the unknowns.
    fn shape(&self, u: &[f64]) -> Vec<f64> {
        let of = |u: &f64| match self.energy {
            Energy::CompressibleNeoHookean => LARGEST_POISSON / (1.0 + (-u).exp()),
            Energy::Gent => self.largest * (1.0 + LARGEST_LIMIT / (1.0 + LARGEST_LIMIT * (-u).exp())),
            _ => {
                let exponent = LARGEST_EXPONENT * (u / LARGEST_EXPONENT).tanh();
                exponent.abs().max(SMALLEST_EXPONENT).copysign(exponent)
            }
        };
        u.iter().map(of).collect()
    }

    /// The moduli with the least residuals for a shape; none where a stress is not finite.
    fn solve(&self, shape: &[f64], sign: Sign) -> Option<Solved> {
        // Variable projection (Golub and Pereyra 1973): for each shape the moduli are linear, so that only the shape is
        // searched, and polynomials need no search.
        let laws = self.energy.unit_laws(shape);
        let columns: Vec<DVector<f64>> =
            laws.iter().map(|law| DVector::from_vec(self.stresses(law)).component_mul(&self.factors)).collect();
        let matrix = DMatrix::from_columns(&columns);
        let moduli = match sign {
            Sign::Free => least_squares(&matrix, &self.target)?,
            Sign::NotNegative => nonnegative_least_squares(&matrix, &self.target)?,
        };
        let residuals = &matrix * &moduli - &self.target;
        Some(Solved { moduli: moduli.as_slice().to_vec(), residuals })
    }

    /// Whether the coefficient of this name lies on the bound of its range.
    fn is_on_bound(&self, name: &str, value: f64) -> bool {
        match name {
            "poisson" => !(ON_BOUND..LARGEST_POISSON * (1.0 - ON_BOUND)).contains(&value),
            "jm" => value > self.largest * LARGEST_LIMIT * (1.0 - ON_BOUND),
            name if name.starts_with("alpha") => {
                let size = value.abs();
                size > LARGEST_EXPONENT * (1.0 - ON_BOUND) || size <= SMALLEST_EXPONENT
            }
            _ => false,
        }
    }

    /// Whether terms of Ogden's law cancel each other, which is a rounding error of the fit and not a film.
    fn is_cancelled(&self, moduli: &[f64]) -> bool {
        let size = moduli.iter().map(|modulus| modulus.abs()).sum::<f64>();
        matches!(self.energy, Energy::Ogden { .. }) && size > MOST_CANCELLED * moduli.iter().sum::<f64>().abs()
    }

    /// The residuals of a law (methods.md, equation 231).
    fn residuals(&self, law: &HyperelasticLaw) -> DVector<f64> {
        DVector::from_vec(self.stresses(law)).component_mul(&self.factors) - &self.target
    }

    fn stresses(&self, law: &HyperelasticLaw) -> Vec<f64> {
        self.sets.iter().flat_map(|set| stresses(law, &set.measured)).collect()
    }
}

impl Energy {
    /// The laws whose stresses add up to those of the energy, each times its modulus: all but the shape is linear.
    /// The modulus of a term of Ogden's is its share ½ μ_k α_k of the shear modulus.
    fn unit_laws(self, shape: &[f64]) -> Vec<HyperelasticLaw> {
        if let Energy::Ogden { .. } = self {
            return shape.iter().map(|alpha| self.of_coefficients(&[2.0 / alpha, *alpha])).collect();
        }
        let moduli = self.names(usize::MAX).len() - shape.len();
        let unit = |place: usize| {
            let first = (0..moduli).map(|modulus| f64::from(u8::from(modulus == place)));
            self.of_coefficients(&first.chain(shape.iter().copied()).collect::<Vec<_>>())
        };
        (0..moduli).map(unit).collect()
    }

    /// The coefficients of a material file, SI, in the order of [`Energy::names`]. Terms of Ogden's without a modulus
    /// are left out, the largest comes first.
    fn coefficients(self, moduli: &[f64], shape: &[f64]) -> Vec<f64> {
        let Energy::Ogden { .. } = self else {
            return moduli.iter().chain(shape).copied().collect();
        };
        let mut terms: Vec<[f64; 2]> = moduli.iter().zip(shape).map(|(modulus, alpha)| [*modulus, *alpha]).collect();
        terms.retain(|[modulus, _]| *modulus != 0.0);
        terms.sort_by(|a, b| b[0].abs().total_cmp(&a[0].abs()));
        terms.into_iter().flat_map(|[modulus, alpha]| [2.0 * modulus / alpha, alpha]).collect()
    }

    /// The law of these coefficients.
    fn of_coefficients(self, x: &[f64]) -> HyperelasticLaw {
        match self {
            Energy::NeoHookean => HyperelasticLaw::Polynomial(film(Polynomial::neo_hookean(x[0]))),
            Energy::MooneyRivlin => HyperelasticLaw::Polynomial(film(Polynomial::mooney_rivlin(x[0], x[1]))),
            Energy::Yeoh => HyperelasticLaw::Polynomial(film(Polynomial::yeoh([x[0], x[1], x[2]]))),
            Energy::CompressibleNeoHookean => {
                HyperelasticLaw::CompressibleNeoHookean(film(CompressibleNeoHookean { young: x[0], poisson: x[1] }))
            }
            Energy::Gent => HyperelasticLaw::Gent(film(Gent { mu: x[0], jm: x[1] })),
            Energy::Ogden { .. } => {
                let terms: Vec<OgdenTerm> = x.chunks(2).map(|term| OgdenTerm { mu: term[0], alpha: term[1] }).collect();
                HyperelasticLaw::Ogden(film(Ogden::new(&terms)))
            }
        }
    }
}

/// Film of an energy that carries compression.
fn film<E>(energy: E) -> Hyperelastic<E> {
    Hyperelastic { energy, wrinkling: false }
}

/// Largest I₁ − 3 of incompressible film at the stretches of the tests.
fn largest_invariant(sets: &[DataSet]) -> f64 {
    let rest = Energy::NeoHookean.of_coefficients(&[1.0]);
    let stretches = sets.iter().flat_map(|set| set.measured.states(&rest));
    stretches.map(|[a, b]| a * a + b * b + (a * b).powi(-2) - 3.0).fold(f64::MIN_POSITIVE, f64::max)
}

/// All sets of so many of the exponents.
fn combinations(count: usize) -> Vec<Vec<f64>> {
    let sets = (0..1_u32 << EXPONENTS.len()).filter(|bits| bits.count_ones() as usize == count);
    let exponents = |bits: u32| (0..EXPONENTS.len()).filter(move |at| bits >> at & 1 == 1).map(|at| EXPONENTS[at]);
    sets.map(|bits| exponents(bits).collect()).collect()
}

/// Points of a curve.
const POINTS: u32 = 120;

impl Measured {
    /// Principal stretches of all points in the plane, for film of this law.
    fn states(&self, law: &HyperelasticLaw) -> Vec<[f64; 2]> {
        match self {
            Measured::Tension(tension, points) => {
                points.iter().map(|point| law.stretches(*tension, point[0])).collect()
            }
            Measured::Biaxial(points) => points.iter().map(|point| point.stretches).collect(),
        }
    }
}

/// The law's stresses (Pa) in the order of the measured ones.
fn stresses(law: &HyperelasticLaw, measured: &Measured) -> Vec<f64> {
    let states = measured.states(law).into_iter().map(|state| law.nominal_stress(state));
    match measured {
        Measured::Tension(..) => states.map(|stress| stress[0]).collect(),
        Measured::Biaxial(_) => states.flatten().collect(),
    }
}

/// The law's stress (Pa) over the stretch between two stretches.
fn curve(law: &HyperelasticLaw, tension: Tension, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let stretches = (0..=POINTS).map(|k| from + (to - from) * f64::from(k) / f64::from(POINTS));
    stretches.map(|stretch| [stretch, law.nominal_stress(law.stretches(tension, stretch))[0]]).collect()
}

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

/// Fits `energy` to the `sets` and predicts the stresses of `predicted`. In one piece, since all warnings are of one minimum.
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
        let [above, below] = [step, -step].map(|step| at(&moved(x, index, step)));
        roughness = roughness.max((&above - 2.0 * &here + &below).norm());
        (above - below) / (2.0 * step)
    });
    let jacobian = DMatrix::from_columns(&columns.collect::<Vec<_>>());
    let parts = sets.iter().filter(|set| set.weight > 0.0).map(|set| set.measured.stresses().len()).collect();
    let linearization = Linearization { x: x.to_vec(), residuals: here, parts, jacobian, roughness, one_sided: vec![] };
    Confidence::from_linearization(&linearization, &ConfidenceOptions::new(names.to_vec()))
}

#[cfg(test)]
mod tests {
    //! Recovery of known coefficients, Treloar's and Kawabata's rubber, stability.

    use std::path::Path;

    use super::super::*;
    use super::*;

    fn rubber(name: &str) -> DataSet {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/rubber").join(name);
        StressReader::default().read(&path).expect("a test")
    }

    fn treloar() -> Vec<DataSet> {
        ["treloar-ut.csv", "treloar-et.csv", "treloar-ps.csv"].map(rubber).into()
    }

    fn fitted(law: &str, sets: &[DataSet], predicted: &[DataSet], weighting: Weighting) -> LawFit {
        let law = law.parse().expect("a law");
        fit_law(law, sets, predicted, &FitOptions { weighting, stable_to: None }).expect("a fit")
    }

    /// The stresses of film with these coefficients in four kinds of tests.
    fn virtual_sets(energy: Energy, x: &[f64]) -> Vec<DataSet> {
        let law = energy.of_coefficients(x);
        let stretches = || (1..=20).map(|k| 1.0 + 0.1 * f64::from(k));
        let biaxial =
            stretches().map(|stretch| BiaxialPoint { stretches: [stretch, stretch.sqrt()], stresses: [1.0; 2] });
        let tension = |tension| Measured::Tension(tension, stretches().map(|stretch| [stretch, 1.0]).collect());
        let kinds = [Tension::Uniaxial, Tension::Equibiaxial, Tension::Plane].map(tension);
        let with_stresses = |measured: Measured| {
            let found = stresses(&law, &measured);
            let measured = match measured {
                Measured::Tension(tension, points) => {
                    Measured::Tension(tension, points.iter().zip(found).map(|(point, p)| [point[0], p]).collect())
                }
                Measured::Biaxial(points) => {
                    let pairs = points.iter().zip(found.chunks(2));
                    Measured::Biaxial(pairs.map(|(b, p)| BiaxialPoint { stresses: [p[0], p[1]], ..*b }).collect())
                }
            };
            DataSet::new("virtual", measured).expect("a test")
        };
        kinds.into_iter().chain([Measured::Biaxial(biaxial.collect())]).map(with_stresses).collect()
    }

    #[test]
    fn known_coefficients_of_each_law_are_found_again() {
        let [first, third, second] = Ogden::TRELOAR;
        let treloar = [first, second, third].map(|term| [term.mu, term.alpha]);
        for (law, known) in [
            ("neo-hookean", &[4e5][..]),
            ("compressible-neo-hookean", &[1.1e6, 0.31]),
            ("mooney-rivlin", &[1.6e5, 4e4]),
            ("yeoh", &[1.8e5, -2e3, 5e1]),
            ("gent", &[4e5, 60.0]),
            ("ogden:1", &[3e5, 2.4]),
            ("ogden:2", &[4.6e5, 1.4, -1.2e4, -2.2]),
            ("ogden:3", treloar.as_flattened()),
        ] {
            let Ok(energy) = law.parse() else { panic!("{law}") };
            let sets = virtual_sets(energy, known);
            for weighting in [Weighting::Absolute, Weighting::Relative] {
                let fit = fitted(law, &sets, &[], weighting);
                assert_eq!(fit.coefficients.len(), known.len(), "{law}");
                for (found, known) in fit.coefficients.iter().zip(known) {
                    let error = (found.value / known - 1.0).abs();
                    assert!(error < 1e-6, "{law} {weighting}: {} is {} and not {known}", found.name, found.value);
                }
                assert!(fit.tests.iter().all(|test| test.quality.r_squared > 1.0 - 1e-12), "{law}: {:?}", fit.tests);
            }
        }
    }

    /// Fitted to the uniaxial test, the law fails in equibiaxial tension, as the warning says.
    #[test]
    fn a_fit_to_uniaxial_tests_alone_is_unsafe_for_biaxial_film() {
        let sets = treloar();
        let (alone, all) = (&sets[..1], &sets[..]);
        let [alone, all] = [alone, all].map(|fitted_to| fitted("ogden:3", fitted_to, &sets[1..2], Weighting::Absolute));
        assert!(alone.warnings.contains(&Warning::UniaxialOnly) && !all.warnings.contains(&Warning::UniaxialOnly));
        let [uniaxial, wrong, right] = [&alone.tests[0], &alone.predictions[0], &all.predictions[0]];
        println!("equibiaxial error: {:?} alone, {:?} together", wrong.quality, right.quality);
        assert!(uniaxial.quality.r_squared > 0.998, "{:?}", uniaxial.quality);
        assert!(wrong.quality.relative_rms > 0.3 && right.quality.relative_rms < 0.04);
        assert!(wrong.quality.r_squared < 0.7 && right.quality.r_squared > 0.995);
    }

    #[test]
    fn kawabatas_biaxial_stresses_are_predicted_from_three_tests() {
        let sets = ["kawabata-ut.csv", "kawabata-et.csv", "kawabata-ps.csv"].map(rubber);
        let biaxial = [rubber("kawabata-biaxial.csv")];
        assert_eq!(biaxial[0].measured.len(), 117);
        let fit = fitted("ogden:3", &sets, &biaxial, Weighting::Absolute);
        let quality = &fit.predictions[0].quality;
        println!("{quality:?}");
        assert!(fit.confidence.expect("intervals").standard_errors.iter().all(|error| error.is_finite()));
        assert!(quality.samples == 234 && quality.relative_rms < 0.03 && quality.r_squared > 0.997, "{quality:?}");
    }

    /// The free fit of Mooney and Rivlin's law to Treloar's uniaxial test has a negative c₀₁, with which equibiaxial tension
    /// is unstable.
    #[test]
    fn a_fit_that_is_unstable_is_not_taken_where_a_stable_one_exists() {
        let fit = fitted("mooney-rivlin", &treloar()[..1], &[], Weighting::Absolute);
        let rejected = |warning: &Warning| matches!(warning, Warning::UnstableRejected { .. });
        assert!(fit.warnings.iter().any(rejected), "{:?}", fit.warnings);
        let Law::Hyperelastic(law) = &fit.law else { panic!("{:?}", fit.law) };
        assert_eq!((law.instability(), fit.unstable_from), (None, None));
    }

    #[test]
    fn weights_choose_what_is_fitted() {
        let weigh = |weights: [f64; 3]| -> Vec<DataSet> {
            treloar().into_iter().zip(weights).map(|(set, weight)| set.with_weight(weight).expect("a weight")).collect()
        };
        let of = |weights| fitted("neo-hookean", &weigh(weights), &[], Weighting::Absolute);
        let fits = [[1.0, 1.0, 1.0], [0.0, 1.0, 0.0]].map(of);
        let alone = fitted("neo-hookean", &treloar()[1..2], &[], Weighting::Absolute);
        assert!(fits[0].coefficients[0].value != alone.coefficients[0].value);
        assert!((fits[1].coefficients[0].value / alone.coefficients[0].value - 1.0).abs() < 1e-12);
        let error = treloar().remove(0).with_weight(-1.0).expect_err("a weight below zero");
        assert_eq!(error.to_string(), "expected a weight that is zero or above, found -1");
    }

    /// Neo-Hookean film has no limit.
    #[test]
    fn a_coefficient_that_is_not_determined_is_named() {
        let sets = virtual_sets(Energy::NeoHookean, &[4e5]);
        let fit = fitted("gent", &sets[..3], &[], Weighting::Absolute);
        let on_bound =
            |warning: &Warning| matches!(warning, Warning::OnBound { coefficient, .. } if coefficient == "jm");
        assert!(fit.warnings.iter().any(on_bound), "{:?} {:?}", fit.warnings, fit.coefficients);
    }

    #[test]
    fn stresses_that_fall_have_no_law() {
        let points = vec![[1.5, -1e5], [2.0, -2e5], [2.5, -3e5]];
        let set = DataSet::new("wrong", Measured::Tension(Tension::Uniaxial, points)).expect("a test");
        let fit =
            |law: &str| fit_law(law.parse().expect("a law"), std::slice::from_ref(&set), &[], &FitOptions::default());
        let refused = |law: &str| fit(law).expect_err("no law").to_string();
        assert_eq!(refused("neo-hookean"), "no coefficients that fit have a stiffness at rest");
        assert!(refused("yeoh").starts_with("3 measured stresses for 3 coefficients"));
    }

    #[test]
    fn words_are_laws() {
        for word in ["neo-hookean", "compressible-neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden:1", "ogden:6"] {
            assert_eq!(word.parse::<Energy>().map(|law| law.to_string()), Ok(word.to_owned()));
        }
        assert_eq!("ogden".parse::<Energy>().map(|law| law.to_string()), Ok("ogden:3".to_owned()));
        for word in ["", "ogden:0", "ogden:7", "ogden:", "yeoh:3", "Ogden:3 "] {
            let error = word.parse::<Energy>().expect_err(word).to_string();
            assert!(error.contains("is not a law that can be fitted: expected neo-hookean, "), "{error}");
        }
    }
}
