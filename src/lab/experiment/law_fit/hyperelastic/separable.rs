//! The stresses of an energy as a linear function of its moduli, and a nonlinear one of the rest.

use nalgebra::{DMatrix, DVector};

use super::Energy;
use crate::experiment::law_fit::{DataSet, Measured};
use crate::experiment::nonnegative::{least_squares, nonnegative_least_squares};
use membrane::material::{
    CompressibleNeoHookean, Gent, Hyperelastic, HyperelasticLaw, Ogden, OgdenTerm, Polynomial, Tension,
};

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
pub(super) enum Sign {
    /// Any.
    Free,
    /// None is negative, so that each term alone is stable.
    NotNegative,
}

/// A fit of one energy: its tests, and what stresses are multiplied by.
pub(super) struct Separable<'a> {
    pub(super) energy: Energy,
    sets: &'a [DataSet],
    factors: DVector<f64>,
    /// Measured stresses times their factors.
    target: DVector<f64>,
    /// Largest I₁ − 3 of the tests.
    largest: f64,
}

/// Moduli and shape of an energy, and the residuals that they leave.
pub(super) struct Solved {
    pub(super) moduli: Vec<f64>,
    pub(super) residuals: DVector<f64>,
}

impl<'a> Separable<'a> {
    pub(super) fn new(energy: Energy, sets: &'a [DataSet], factors: Vec<f64>) -> Separable<'a> {
        let measured = sets.iter().flat_map(|set| set.measured.stresses());
        let target = DVector::from_iterator(factors.len(), measured.zip(&factors).map(|(p, factor)| p * factor));
        Separable { energy, sets, factors: factors.into(), target, largest: largest_invariant(sets) }
    }

    /// Starts of the unknowns u of the shape; one without unknowns where the law is linear.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        match self.energy {
            Energy::NeoHookean | Energy::MooneyRivlin | Energy::Yeoh => vec![vec![]],
            Energy::CompressibleNeoHookean => [-2.0, 0.0, 2.0].map(|u| vec![u]).into(),
            Energy::Gent => [-4.0, -2.0, 0.0, 2.0, 4.0].map(|u| vec![u]).into(),
            Energy::Ogden { terms } => combinations(terms),
        }
    }

    /// Exponents, limit or Poisson's ratio of the unknowns.
    pub(super) fn shape(&self, u: &[f64]) -> Vec<f64> {
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
    pub(super) fn solve(&self, shape: &[f64], sign: Sign) -> Option<Solved> {
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
    pub(super) fn is_on_bound(&self, name: &str, value: f64) -> bool {
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
    pub(super) fn is_cancelled(&self, moduli: &[f64]) -> bool {
        let size = moduli.iter().map(|modulus| modulus.abs()).sum::<f64>();
        matches!(self.energy, Energy::Ogden { .. }) && size > MOST_CANCELLED * moduli.iter().sum::<f64>().abs()
    }

    /// The residuals of a law (methods.md, equation 231).
    pub(super) fn residuals(&self, law: &HyperelasticLaw) -> DVector<f64> {
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
        let polynomial = |first: [f64; 3], second: f64| law_of(Polynomial { first, second });
        match self {
            Energy::NeoHookean => vec![law_of(Polynomial::neo_hookean(1.0))],
            Energy::MooneyRivlin => vec![polynomial([1.0, 0.0, 0.0], 0.0), polynomial([0.0; 3], 1.0)],
            Energy::Yeoh => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|c| polynomial(c, 0.0)).into(),
            Energy::CompressibleNeoHookean => vec![law_of(CompressibleNeoHookean { young: 1.0, poisson: shape[0] })],
            Energy::Gent => vec![law_of(Gent { mu: 1.0, jm: shape[0] })],
            Energy::Ogden { .. } => {
                let term = |alpha: &f64| law_of(Ogden::new(&[OgdenTerm { mu: 2.0 / alpha, alpha: *alpha }]));
                shape.iter().map(term).collect()
            }
        }
    }

    /// The coefficients of a material file, SI, in the order of [`Energy::names`]. Terms of Ogden's without a modulus
    /// are left out, the largest comes first.
    pub(super) fn coefficients(self, moduli: &[f64], shape: &[f64]) -> Vec<f64> {
        let Energy::Ogden { .. } = self else {
            return moduli.iter().chain(shape).copied().collect();
        };
        let mut terms: Vec<[f64; 2]> = moduli.iter().zip(shape).map(|(modulus, alpha)| [*modulus, *alpha]).collect();
        terms.retain(|[modulus, _]| *modulus != 0.0);
        terms.sort_by(|a, b| b[0].abs().total_cmp(&a[0].abs()));
        terms.into_iter().flat_map(|[modulus, alpha]| [2.0 * modulus / alpha, alpha]).collect()
    }

    /// The law of these coefficients.
    pub(super) fn of_coefficients(self, x: &[f64]) -> HyperelasticLaw {
        match self {
            Energy::NeoHookean => law_of(Polynomial::neo_hookean(x[0])),
            Energy::MooneyRivlin => law_of(Polynomial::mooney_rivlin(x[0], x[1])),
            Energy::Yeoh => law_of(Polynomial::yeoh([x[0], x[1], x[2]])),
            Energy::CompressibleNeoHookean => law_of(CompressibleNeoHookean { young: x[0], poisson: x[1] }),
            Energy::Gent => law_of(Gent { mu: x[0], jm: x[1] }),
            Energy::Ogden { .. } => {
                let terms: Vec<OgdenTerm> = x.chunks(2).map(|term| OgdenTerm { mu: term[0], alpha: term[1] }).collect();
                law_of(Ogden::new(&terms))
            }
        }
    }
}

/// A law of one of the energies.
trait IntoLaw {
    fn law(self) -> HyperelasticLaw;
}

macro_rules! into_law {
    ($($energy:ident),+) => {
        $(impl IntoLaw for $energy {
            fn law(self) -> HyperelasticLaw {
                HyperelasticLaw::$energy(Hyperelastic { energy: self, wrinkling: false })
            }
        })+
    };
}
into_law!(Polynomial, Gent, Ogden, CompressibleNeoHookean);

fn law_of(energy: impl IntoLaw) -> HyperelasticLaw {
    energy.law()
}

/// Largest I₁ − 3 of incompressible film at the stretches of the tests.
fn largest_invariant(sets: &[DataSet]) -> f64 {
    let rest = law_of(Polynomial::neo_hookean(1.0));
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
    pub(super) fn states(&self, law: &HyperelasticLaw) -> Vec<[f64; 2]> {
        match self {
            Measured::Tension(tension, points) => {
                points.iter().map(|point| law.stretches(*tension, point[0])).collect()
            }
            Measured::Biaxial(points) => points.iter().map(|point| point.stretches).collect(),
        }
    }
}

/// The law's stresses (Pa) in the order of the measured ones.
pub(super) fn stresses(law: &HyperelasticLaw, measured: &Measured) -> Vec<f64> {
    let states = measured.states(law).into_iter().map(|state| law.nominal_stress(state));
    match measured {
        Measured::Tension(..) => states.map(|stress| stress[0]).collect(),
        Measured::Biaxial(_) => states.flatten().collect(),
    }
}

/// The law's stress (Pa) over the stretch between two stretches.
pub(super) fn curve(law: &HyperelasticLaw, tension: Tension, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let stretches = (0..=POINTS).map(|k| from + (to - from) * f64::from(k) / f64::from(POINTS));
    stretches.map(|stretch| [stretch, law.nominal_stress(law.stretches(tension, stretch))[0]]).collect()
}
