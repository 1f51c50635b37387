//! Shear of a square of film that is stretched along its diagonal (equations 4 to 8).
//!
//! The four sides keep their length while the square becomes a rhombus with the angle ψ at the stretched corners.
//! Where the fibres are known, they stretch as well (methods.md, equations 180 to 183): stress and strain are uniform in the
//! coupon at 45°, and both fibre sets have the same stretch.

use std::f64::consts::{FRAC_PI_2, SQRT_2};
use std::str::FromStr;

use super::curve::lengths;
use super::{Coupon, Curve, JITTER};
use crate::error::{Error, refusal};
use base::words;
use membrane::material;

/// A square of film, unstretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Side L, m.
    pub side: f64,
    /// Thickness h, m.
    pub thickness: f64,
}

/// Shear of the stretched square.
#[derive(Clone, Debug, PartialEq)]
pub struct Shear {
    /// Shear stress τ (Pa) over the shear angle γ (rad).
    pub curve: Curve,
    /// How many samples lay beyond the displacement that the square can follow; they are cut off.
    pub cut: usize,
}

impl Square {
    /// The square whose diagonal √2 L is `diagonal` (m).
    pub fn with_diagonal(diagonal: f64, thickness: f64) -> Square {
        Square { side: diagonal / SQRT_2, thickness }
    }

    /// Length √2 L of the diagonal, m.
    pub fn diagonal(&self) -> f64 {
        SQRT_2 * self.side
    }

    /// Displacement (2 − √2) L at which the rhombus is a line, cos ψ/2 = 1, m.
    pub fn limit(&self) -> f64 {
        (2.0 - SQRT_2) * self.side
    }

    /// Shear angle γ (5) and shear stress τ (Pa, 7) at the `force` F₃ (N) and the `displacement` d (m) of the diagonal:
    /// cos ψ/2 = (√2 L + d)/(2L) (6), γ = π/2 − ψ (5), Q = F₃/(2 cos ψ/2) (4), τ = Q/(L h) (7).
    ///
    /// None beyond [`Square::limit`].
    pub fn state(&self, force: f64, displacement: f64) -> Option<[f64; 2]> {
        if displacement > self.limit() {
            return None;
        }
        let cosine = ((self.diagonal() + displacement) / (2.0 * self.side)).min(1.0);
        let side_force = force / (2.0 * cosine);
        Some([FRAC_PI_2 - 2.0 * cosine.acos(), side_force / (self.side * self.thickness)])
    }

    /// The shear curve of a recording; samples beyond [`Square::limit`] are cut off and counted.
    pub fn shear(&self, force: &[f64], displacement: &[f64]) -> Result<Shear, Error> {
        if force.len() != displacement.len() {
            return Err(lengths(displacement.len(), force.len()));
        }
        let states = force.iter().zip(displacement).map_while(|(force, d)| self.state(*force, *d));
        let (angle, stress) = states.map(|[angle, stress]| (angle, stress)).unzip::<_, _, Vec<_>, Vec<_>>();
        let cut = force.len() - angle.len();
        Ok(Shear { curve: Curve::new(angle, stress)?, cut })
    }
}

impl Shear {
    /// Resultant shear stress τ_h = τ h (N/m) over γ, sample by sample (equation 8).
    pub fn resultant(&self, thickness: f64) -> Vec<f64> {
        self.curve.resultant(thickness)
    }
}

/// Largest |sin γ| at which the angle of a fabric is the arcsine (theory.md, equation 7).
const LARGEST_SINE: f64 = 0.95;

/// Halvings of the interval of fibre strains: to the last bit.
const HALVINGS: usize = 60;

words! {
    /// How the curve of a coupon at 45° becomes a shear curve.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum ShearMethod {
        /// Fibres stretch, and the sides of the coupon are free: a strip that is long for its width.
        #[default]
        Free = "free",
        /// Fibres stretch, and the jaws hold the width: a strip that is short for its width.
        Held = "held",
        /// Fibres do not stretch: the rhombus of the paper's equations 4 to 8.
        Rhombus = "rhombus",
    }
}

impl ShearMethod {
    /// All of them.
    pub const ALL: [ShearMethod; 3] = [ShearMethod::Free, ShearMethod::Held, ShearMethod::Rhombus];
}

impl ShearMethod {
    /// Shear angle and stress of a coupon at 45° with these fibres at an engineering strain and a stress (Pa).
    fn state(self, fibres: &Fibres<'_>, [strain, stress]: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            ShearMethod::Free => fibres.free(strain, stress),
            ShearMethod::Held => fibres.held(strain, stress),
            // Equations 5 to 7 of a square of unit area.
            ShearMethod::Rhombus => {
                let square = Square { side: 1.0, thickness: 1.0 };
                square.state(SQRT_2 * stress, SQRT_2 * strain)
            }
        }
    }

    /// Strain at which a `curve` that was recorded at 45° comes to the shear `angle`; none where it does not.
    pub(crate) fn strain_at(self, curve: &Curve, fibres: &Fibres<'_>, angle: f64) -> Option<f64> {
        let reaches = |sample: &[f64; 2]| self.state(fibres, *sample).is_some_and(|[found, _]| found >= angle);
        curve.samples().find(reaches).map(|[strain, _]| strain)
    }
}

impl FromStr for ShearMethod {
    type Err = Error;

    fn from_str(text: &str) -> Result<ShearMethod, Error> {
        let found = ShearMethod::ALL.into_iter().find(|method| method.name() == text);
        found.ok_or_else(|| refusal!("expected free, held or rhombus, found `{text}`"))
    }
}

/// The curves of both fibre sets.
#[derive(Clone, Copy, Debug)]
pub struct Fibres<'f> {
    /// Along the machine direction.
    pub md: &'f material::Curve,
    /// Along the transverse direction.
    pub td: &'f material::Curve,
}

impl Fibres<'_> {
    /// Sum of both stresses at the common `strain`, Pa.
    fn stress(&self, strain: f64) -> f64 {
        self.md.stress(strain) + self.td.stress(strain)
    }

    /// Strain at which the first of them breaks.
    fn end(&self) -> f64 {
        self.md.end().min(self.td.end())
    }

    /// Shear angle γ (rad) and shear stress τ (Pa) of a coupon with free sides at the engineering `strain` and `stress`
    /// (Pa), by equations 181 and 182; none past the break of the fibres, or where the fibres nearly coincide.
    pub fn free(&self, strain: f64, stress: f64) -> Option<[f64; 2]> {
        let along = 1.0 + strain;
        let force = |fibre: f64| (1.0 + fibre) * self.stress(fibre);
        let [mut low, mut high] = [0.0, self.end()];
        if force(high) < along * stress {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if force(middle) < along * stress {
                low = middle;
            } else {
                high = middle;
            }
        }
        let fibre = 1.0 + high;
        let across = (2.0 * fibre * fibre - along * along).max(0.0).sqrt();
        sheared((along / fibre).powi(2) - 1.0, 0.5 * stress * across)
    }

    /// Shear angle and stress of a coupon whose width is held, by equation 183.
    pub fn held(&self, strain: f64, stress: f64) -> Option<[f64; 2]> {
        let along = 1.0 + strain;
        let squared = 0.5 * (along * along + 1.0);
        let fibre = squared.sqrt();
        if fibre - 1.0 > self.end() {
            return None;
        }
        let of_fibres = self.stress(fibre - 1.0) * along / (2.0 * fibre);
        sheared(along * along / squared - 1.0, squared * (stress - of_fibres))
    }
}

impl Fibres<'_> {
    /// Nominal stress (Pa) along a coupon at 45° of these fibres and a `shear` curve at the engineering `strain`, by equation 180:
    /// of one whose sides are free, or whose width `is_held`. None past the break of the fibres, or where they nearly coincide.
    pub(crate) fn coupon_stress(&self, shear: &material::Curve, strain: f64, is_held: bool) -> Option<f64> {
        let along = 1.0 + strain;
        // Stretch and stress of the fibres, sine of the shear angle and shear stress at the width.
        let state = |across: f64| {
            let squared = 0.5 * (along * along + across * across);
            let (fibre, sine) = (squared.sqrt(), 0.5 * (along * along - across * across) / squared);
            (fibre, self.stress(fibre - 1.0), sine, shear.stress(sine.abs().min(1.0).asin()).copysign(sine))
        };
        let free = || {
            let [mut narrow, mut wide] = [0.0, along];
            for _ in 0..HALVINGS {
                let across = 0.5 * (narrow + wide);
                let (fibre, stress, _, tau) = state(across);
                if 0.5 * stress * across / fibre > tau * along / (fibre * fibre) {
                    wide = across;
                } else {
                    narrow = across;
                }
            }
            wide
        };
        let across = if is_held { 1.0 } else { free() };
        let (fibre, stress, sine, tau) = state(across);
        let is_whole = fibre - 1.0 <= self.end() && sine.abs() <= LARGEST_SINE;
        is_whole.then(|| 0.5 * stress * along / fibre + tau * across / (fibre * fibre))
    }
}

fn sheared(sine: f64, stress: f64) -> Option<[f64; 2]> {
    (sine.abs() <= LARGEST_SINE).then(|| [sine.asin(), stress])
}

impl Coupon {
    /// Shear of the film from a `curve` recorded at 45° (D3) by `method`; samples beyond what it can follow are cut off
    /// and counted.
    ///
    /// # Errors
    /// Samples that make no [`Curve`].
    pub fn shear_by(&self, method: ShearMethod, curve: &Curve, fibres: Fibres) -> Result<Shear, Error> {
        let states = curve.samples().map_while(|sample| method.state(&fibres, sample));
        let (mut angle, mut stress): (Vec<f64>, Vec<f64>) = states.map(|[angle, stress]| (angle, stress)).unzip();
        // Fibres that yield may stretch faster than the coupon, whose angle then falls by more than its jitter.
        let jitter = JITTER * angle.iter().fold(0.0_f64, |most, angle| most.max(*angle));
        let mut largest = f64::NEG_INFINITY;
        let falls = angle.iter().position(|angle| {
            largest = largest.max(*angle);
            *angle < largest - jitter
        });
        let length = falls.unwrap_or(angle.len());
        angle.truncate(length);
        stress.truncate(length);
        let cut = curve.strain().len() - angle.len();
        Ok(Shear { curve: Curve::new(angle, stress)?, cut })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Square = Square { side: 0.1, thickness: 12e-6 };

    #[test]
    fn the_square_at_rest_is_not_sheared() {
        let [angle, stress] = SQUARE.state(1.0, 0.0).unwrap();
        // Q = F/√2 on the side: equilibrium of a corner with two sides at 45 degrees.
        assert!(angle.abs() < 1e-15);
        assert!((stress / (1.0 / SQRT_2 / (0.1 * 12e-6)) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_third_of_the_right_angle_left_is_sheared_by_the_rest() {
        // ψ = 60°: the diagonal is √3 L.
        let [angle, stress] = SQUARE.state(3.0, (3.0_f64.sqrt() - SQRT_2) * 0.1).unwrap();
        assert!((angle - 30.0_f64.to_radians()).abs() < 1e-14);
        assert!((stress * 12e-6 * 0.1 - 3.0 / 3.0_f64.sqrt()).abs() < 1e-14);
    }

    /// Virtual work: F dd = τ h A dγ for every d, on the rhombus' present area A = L² cos γ.
    #[test]
    fn stress_and_angle_do_the_work_of_the_force() {
        for part in [0.1, 0.4, 0.8] {
            let (d, step) = (part * SQUARE.limit(), 1e-8);
            let [before, after] = [d - step, d + step].map(|d| SQUARE.state(7.0, d).unwrap()[0]);
            let [angle, stress] = SQUARE.state(7.0, d).unwrap();
            let work = stress * 12e-6 * 0.1 * 0.1 * angle.cos() * (after - before);
            assert!((work / (7.0 * 2.0 * step) - 1.0).abs() < 1e-6, "{part}: {work}");
        }
    }

    #[test]
    fn beyond_the_closed_rhombus_the_curve_is_cut_and_that_is_counted() {
        let d: Vec<f64> = (0..=10).map(|i| 0.01 * f64::from(i)).collect();
        let sheared = SQUARE.shear(&[1.0; 11], &d).unwrap();
        assert!((SQUARE.limit() - 0.0585786).abs() < 1e-7);
        assert_eq!((sheared.curve.strain().len(), sheared.cut), (6, 5));
        let closed = Square::with_diagonal(5e-3, 12e-6);
        let [angle, _] = closed.state(1.0, closed.limit()).unwrap();
        assert!((angle - FRAC_PI_2).abs() < 1e-7);
    }

    fn curves() -> [material::Curve; 2] {
        [vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]], vec![[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]]]
            .map(|points| material::Curve::new(points).unwrap())
    }

    /// Uniform stretches `along` and `across` of a fabric with the shear curve `tau`: stress along and across over the
    /// stress-free sections, by differences of the energy (theory.md, equations 4 and 5).
    fn stresses(fibres: Fibres, tau: &material::Curve, along: f64, across: f64) -> [f64; 2] {
        let energy = |along: f64, across: f64| {
            let squared = 0.5 * (along * along + across * across);
            let (fibre, sine) = (squared.sqrt() - 1.0, 0.5 * (along * along - across * across) / squared);
            fibres.md.energy(fibre) + fibres.td.energy(fibre) + tau.energy(sine.asin())
        };
        let step = 1e-6;
        [
            (energy(along + step, across) - energy(along - step, across)) / (2.0 * step),
            (energy(along, across + step) - energy(along, across - step)) / (2.0 * step),
        ]
    }

    #[test]
    fn angle_and_stress_are_those_of_the_law() {
        let [md, td] = curves();
        let tau = material::Curve::new(vec![[0.2, 3e6], [0.7, 6e6]]).unwrap();
        let fibres = Fibres { md: &md, td: &td };
        for along in [1.02, 1.15, 1.4, 1.6] {
            let angle = |across: f64| ((along * along - across * across) / (along * along + across * across)).asin();
            // The width at which nothing acts across, by halving.
            let [mut low, mut high] = [0.6, 1.3];
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if stresses(fibres, &tau, along, middle)[1] > 0.0 { high = middle } else { low = middle }
            }
            for (across, state) in [(low, Fibres::free as fn(&_, _, _) -> _), (1.0, Fibres::held)] {
                let stress = stresses(fibres, &tau, along, across)[0];
                let found: Option<[f64; 2]> = state(&fibres, along - 1.0, stress);
                let [found, shear] = found.unwrap();
                assert!((found - angle(across)).abs() < 1e-5, "{along}: {found}");
                assert!((shear / tau.stress(found) - 1.0).abs() < 1e-3, "{along}: {shear}");
                let back = fibres.coupon_stress(&tau, along - 1.0, across == 1.0).unwrap();
                assert!((back / stress - 1.0).abs() < 1e-4, "{along}: {back} for {stress}");
            }
        }
    }

    /// With fibres that hardly stretch, the work of shear per stress-free volume is left: half of the paper's shear
    /// stress times cos γ, since the sides of a square within the coupon carry tension of the fibres besides shear.
    #[test]
    fn of_stiff_fibres_the_angle_is_that_of_the_rhombus() {
        let stiff = material::Curve::new(vec![[1.0, 1e15]]).unwrap();
        let fibres = Fibres { md: &stiff, td: &stiff };
        for strain in [0.05, 0.2, 0.3] {
            let [angle, stress] = fibres.free(strain, 5e6).unwrap();
            let sine: f64 = (1.0 + strain) * (1.0 + strain) - 1.0;
            assert!((angle - sine.asin()).abs() < 1e-6, "{strain}: {angle}");
            let rhombus = 5e6 / (1.0 + strain);
            assert!((stress / (0.5 * rhombus * angle.cos()) - 1.0).abs() < 1e-6, "{strain}: {stress}");
        }
    }

    #[test]
    fn a_coupon_stronger_than_its_fibres_ends_with_them() {
        let [md, td] = curves();
        let fibres = Fibres { md: &md, td: &td };
        assert_eq!(fibres.free(0.5, 1e9), None);
        assert_eq!(fibres.held(2.5, 1e6), None);
        let coupon = Coupon::new(5e-3, 10e-3, 12e-6).unwrap();
        let curve = Curve::new(vec![0.0, 0.1, 0.2, 0.9], vec![0.0, 3e6, 5e6, 1e9]).unwrap();
        let sheared = coupon.shear_by(ShearMethod::Free, &curve, fibres).unwrap();
        assert_eq!((sheared.curve.strain().len(), sheared.cut), (3, 1));
        let other = "sheared".parse::<ShearMethod>().unwrap_err().to_string();
        assert_eq!(other, "expected free, held or rhombus, found `sheared`");
        assert!(ShearMethod::ALL.iter().all(|method| method.name().parse() == Ok(*method)));
    }
}
