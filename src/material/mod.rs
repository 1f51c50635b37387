//! Constitutive laws of films: stress and energy of one layer as functions of its deformation.
//!
//! A law knows no mesh and no time. It is asked in lanes ([`crate::lane`]) for the stress that belongs to a
//! deformation gradient, and in the same letters for the energy that stress is the gradient of.

mod absorption;
mod curve;
mod elastic;
mod fabric;
mod multipliers;

pub use absorption::Absorption;
pub use curve::{Curve, CurveError, Reading};
pub use elastic::Elastic;
pub use fabric::Fabric;
pub use multipliers::Multipliers;

use crate::lane::{Lane, Lane3};

/// Deformation gradient of a membrane: the images f₁ = F a₁ and f₂ = F a₂ of the unit vectors along MD and TD
/// of the stress-free film.
pub type Gradient = [Lane3; 2];

/// Deformation of a membrane element at one integration point.
#[derive(Clone, Copy, Debug)]
pub struct Deformation {
    /// The gradient at the point.
    pub f: Gradient,
    /// Mean square by which f₁ and f₂ vary over the part of the element that the point stands for; the stretch that a
    /// law sees is the root mean square √(|f_I|² + s_I) (theory.md, equation 13).
    pub spread: [Lane; 2],
}

impl From<Gradient> for Deformation {
    /// The same gradient everywhere.
    fn from(f: Gradient) -> Deformation {
        Deformation { f, spread: [[0.0; crate::lane::LANES]; 2] }
    }
}

/// Largest strains so far of the MD fibres, the TD fibres and in shear.
pub type Peaks = [Lane; 3];

/// Answer of a law to a deformation.
pub struct Stress {
    /// First Piola–Kirchhoff stress ∂W/∂f₁, ∂W/∂f₂, Pa of one layer.
    pub p: Gradient,
    /// 2 ∂W/∂|f_I|², Pa of one layer: tension over stretch, with which a stretched fibre resists motion in any direction.
    pub tension: [Lane; 2],
}

/// Energy density of a film, J/m³.
#[derive(Clone, Copy, Debug)]
pub struct Energy {
    /// Comes back on unloading.
    pub stored: Lane,
    /// Turned into heat and damage.
    pub absorbed: Lane,
}

/// Strains of a film in the measures of its law.
#[derive(Clone, Copy, Debug)]
pub struct Strains {
    /// Engineering strain |f₁| − 1 along MD.
    pub md: Lane,
    /// Engineering strain |f₂| − 1 along TD.
    pub td: Lane,
    /// Angle by which MD and TD left their right angle, rad.
    pub shear: Lane,
}

/// Bounds on the tangent stiffness of a film, Pa, for the stable time step.
#[derive(Clone, Copy, Debug)]
pub struct Stiffness {
    /// Against motion along the fibres: MD, TD.
    pub along: [Lane; 2],
    /// Against motion across the fibres (tension): MD, TD.
    pub across: [Lane; 2],
    /// In shear, on top of both directions.
    pub shear: Lane,
}

/// What an element asks of a law.
pub trait MembraneLaw {
    /// Stress at deformation `d`; raises `peaks` to the strains reached.
    fn stress(&self, d: &Deformation, peaks: &mut Peaks) -> Stress;
    /// Energy at deformation `d` and largest strains `peaks`.
    fn energy(&self, d: &Deformation, peaks: &Peaks) -> Energy;
    /// Largest tangent stiffness at and near deformation `d`, whichever way it goes on.
    fn stiffness(&self, d: &Deformation, peaks: &Peaks) -> Stiffness;
    /// Slopes of the law at rest along MD and TD, Pa.
    fn moduli(&self) -> [f64; 2];
    /// Strains at which the MD and TD fibres break.
    fn break_strains(&self) -> [f64; 2];
}

/// The law of a film.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// Two fibre sets and shear.
    Fabric(Fabric),
    /// St. Venant–Kirchhoff plane stress.
    Elastic(Elastic),
}

/// What one layer of film is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// kg/m³.
    pub density: f64,
    /// Thickness of one layer, m.
    pub thickness: f64,
    /// Its constitutive law.
    pub law: Law,
    /// Lowest and highest strain rate (1/s) at which the curves were measured.
    pub measured_rates: Option<[f64; 2]>,
}

/// Strains of a deformation; measures that every law shares.
pub fn strains(d: &Deformation) -> Strains {
    let fibres = fabric::Fibres::of(d);
    Strains { md: fibres.strain(0), td: fibres.strain(1), shear: fibres.angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{LANES, splat};

    fn film(absorption: f64) -> Fabric {
        let md = Curve::new(vec![[0.03, 8.4e6], [0.2, 20e6], [0.75, 29e6]]).unwrap();
        let td = Curve::new(vec![[0.04, 8e6], [0.14, 10e6], [6.0, 16e6]]).unwrap();
        let shear = Curve::new(vec![[0.3, 4e6], [1.2, 7e6]]).unwrap();
        Fabric::new(md, td, shear, absorption)
    }

    /// Deformations in general position: stretched, sheared, turned out of the plane, one direction slack, uneven.
    fn deformations() -> Vec<Deformation> {
        let rows: [([[f64; 3]; 2], [f64; 2]); 6] = [
            ([[1.13, 0.05, 0.2], [0.1, 1.3, -0.3]], [0.0, 0.0]),
            ([[1.5, 0.7, 0.1], [0.6, 1.4, 0.5]], [0.0, 0.0]),
            ([[0.3, 0.2, 1.1], [-0.9, 0.4, 0.6]], [0.0, 0.0]),
            ([[0.7, 0.1, 0.2], [0.2, 1.2, 0.1]], [0.0, 0.0]),
            ([[1.05, 0.95, 0.0], [0.98, 1.05, 0.02]], [0.0, 0.0]),
            ([[1.13, 0.05, 0.2], [0.1, 1.3, -0.3]], [0.2, 0.1]),
        ];
        rows.map(|(f, spread)| Deformation { f: f.map(|v| v.map(splat)), spread: spread.map(splat) }).to_vec()
    }

    /// Central differences of the energy against stress and tension, on the way up (peaks follow the strain) or on the
    /// way down from peaks that lie `above` the strain.
    fn check_derivative(law: &impl MembraneLaw, above: f64) {
        let step = 1e-6;
        for d in deformations() {
            let mut peaks = [splat(0.0); 3];
            law.stress(&d, &mut peaks);
            let raised = peaks.map(|p| p.map(|p| p + above));
            let stress = law.stress(&d, &mut raised.clone());
            let energy = |d: &Deformation| {
                let mut peaks = if above > 0.0 { raised } else { [splat(0.0); 3] };
                law.stress(d, &mut peaks);
                law.energy(d, &peaks).stored[LANES - 1]
            };
            let scale = stress.p.iter().flatten().fold(1.0, |m: f64, v| m.max(v[0].abs()));
            for fibre in 0..2 {
                for axis in 0..3 {
                    let at = |sign: f64| {
                        let mut moved = d;
                        moved.f[fibre][axis] = splat(d.f[fibre][axis][0] + sign * step);
                        energy(&moved)
                    };
                    let difference = (at(1.0) - at(-1.0)) / (2.0 * step);
                    let error = (difference - stress.p[fibre][axis][0]).abs();
                    assert!(error < 3e-7 * scale, "{d:?} fibre {fibre} axis {axis}: {difference}");
                }
                let at = |sign: f64| {
                    let mut moved = d;
                    moved.spread[fibre] = splat(d.spread[fibre][0] + sign * step);
                    energy(&moved)
                };
                let difference = (at(1.0) - at(-1.0)) / step;
                assert!((difference - stress.tension[fibre][0]).abs() < 3e-7 * scale, "{d:?} tension {fibre}");
            }
        }
    }

    #[test]
    fn fabric_stress_is_the_derivative_of_its_energy() {
        check_derivative(&film(0.0), 0.0);
    }

    #[test]
    fn fabric_stress_is_the_derivative_of_its_energy_on_unloading() {
        check_derivative(&film(0.6), 0.05);
    }

    #[test]
    fn elastic_stress_is_the_derivative_of_its_energy() {
        check_derivative(&Elastic { young: 5e7, poisson: 0.44 }, 0.0);
    }

    #[test]
    fn rotation_alone_gives_no_stress() {
        let (s, c) = 0.7_f64.sin_cos();
        let d = Deformation::from([[c, s * 0.6, s * 0.8].map(splat), [-s, c * 0.6, c * 0.8].map(splat)]);
        let laws: [&dyn MembraneLaw; 2] = [&film(0.9), &Elastic { young: 5e7, poisson: 0.4 }];
        for law in laws {
            let p = law.stress(&d, &mut [splat(0.0); 3]).p;
            assert!(p.iter().flatten().all(|v| v[0].abs() < 1e-6), "{p:?}");
        }
    }
}
