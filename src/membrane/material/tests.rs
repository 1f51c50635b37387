//! Stress as the derivative of energy, bounds on the stiffness, of fabric and elastic film.

use super::*;

pub(in crate::material) fn film(absorption: f64) -> Fabric {
    let md = Curve::new(vec![[0.03, 8.4e6], [0.2, 20e6], [0.75, 29e6]]).unwrap();
    let td = Curve::new(vec![[0.04, 8e6], [0.14, 10e6], [6.0, 16e6]]).unwrap();
    let shear = Curve::new(vec![[0.3, 4e6], [1.2, 7e6]]).unwrap();
    Fabric::new(md, td, shear, absorption)
}

/// Where `f`, negative at `low` and positive at `high`, is zero, by halves.
pub(super) fn zero(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Principal stretches along directions that are turned in the film and in space.
pub(super) fn turned([first, second]: [f64; 2], angles: [f64; 2]) -> Gradient<1> {
    let [(s, c), (t, d)] = angles.map(f64::sin_cos);
    let [u, v] = [[0.8 * d, t, 0.6 * d], [-0.8 * t, d, -0.6 * t]];
    let f = |a: f64, b: f64| Lane3::splat([0, 1, 2].map(|i| first * a * u[i] + second * b * v[i]));
    [f(c, -s), f(s, c)]
}

/// Deformations in general position: stretched, sheared, turned out of the plane, one direction slack or both,
/// uneven.
fn deformations() -> Vec<Deformation<1>> {
    let rows: [([[f64; 3]; 2], [f64; 2]); 8] = [
        ([[1.13, 0.05, 0.2], [0.1, 1.3, -0.3]], [0.0, 0.0]),
        ([[1.5, 0.7, 0.1], [0.6, 1.4, 0.5]], [0.0, 0.0]),
        ([[0.3, 0.2, 1.1], [-0.9, 0.4, 0.6]], [0.0, 0.0]),
        ([[0.7, 0.1, 0.2], [0.2, 1.2, 0.1]], [0.0, 0.0]),
        ([[1.05, 0.95, 0.0], [0.98, 1.05, 0.02]], [0.0, 0.0]),
        ([[1.13, 0.05, 0.2], [0.1, 1.3, -0.3]], [0.2, 0.1]),
        ([[0.7, 0.1, 0.2], [0.2, 1.2, 0.1]], [0.05, 0.02]),
        ([[0.8, 0.1, 0.0], [0.05, 0.9, 0.1]], [0.01, 0.02]),
    ];
    rows.map(|(f, variance)| Deformation { f: f.map(Lane3::splat), stretch_variance: variance.map(splat) }).to_vec()
}

/// Central differences of the energy against stress and tension, on the way up (peaks follow the strain) or on the
/// way down from peaks that lie `above` the strain.
pub(super) fn check_derivative(law: &impl MembraneLaw<History<1> = PeakStrains<1>>, above: f64) {
    let step = 1e-6;
    for d in deformations() {
        let mut history = PeakStrains::virgin();
        law.stress(&d, &mut history, 0.0);
        let mut raised = history;
        raised.fibres.iter_mut().chain([&mut raised.biaxial, &mut raised.shear]).for_each(|peak| peak[0] += above);
        let stress = law.stress(&d, &mut raised.clone(), 0.0);
        let energy = |d: &Deformation<1>| {
            let mut history = if above > 0.0 { raised } else { PeakStrains::virgin() };
            law.stress(d, &mut history, 0.0);
            law.energy(d, &history).stored[0]
        };
        let scale = stress.p.iter().flat_map(|p| &p.0).fold(1.0, |m: f64, v| m.max(v[0].abs()));
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
                moved.stretch_variance[fibre] = splat(d.stretch_variance[fibre][0] + sign * step);
                energy(&moved)
            };
            let difference = (at(1.0) - at(-1.0)) / step;
            assert!((difference - stress.tension[fibre][0]).abs() < 3e-7 * scale, "{d:?} tension {fibre}");
        }
    }
}

/// Film of the strains ε_md, ε_td and γ, taut in both directions.
fn strained([md, td, shear]: [f64; 3]) -> Deformation<1> {
    let (sine, cosine) = shear.sin_cos();
    let (first, second) = (1.0 + md, 1.0 + td);
    Deformation::from([[first, 0.0, 0.0], [second * sine, second * cosine, 0.0]])
}

/// Central differences of the energy by the strains against the nominal stresses.
pub(super) fn check_work(law: &impl MembraneLaw<History<1> = PeakStrains<1>>) {
    let step = 1e-6;
    for at in [[0.1, 0.3, 0.2], [0.5, 0.02, -0.4], [0.25, 0.1, 0.0]] {
        let energy = |at: [f64; 3]| {
            let (d, mut history) = (strained(at), PeakStrains::virgin());
            law.stress(&d, &mut history, 0.0);
            law.energy(&d, &history).stored[0]
        };
        let d = strained(at);
        let Stresses { md, td, shear } = stresses(&d, &law.stress(&d, &mut PeakStrains::virgin(), 0.0));
        for (measure, stress) in [md, td, shear].into_iter().enumerate() {
            let moved = |sign: f64| {
                let mut moved = at;
                moved[measure] += sign * step;
                energy(moved)
            };
            let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            assert!((difference - stress[0]).abs() < 1e-7 * 5e7, "{at:?} {measure}: {} {difference}", stress[0]);
        }
    }
}

#[test]
fn engineering_stresses_do_work_on_the_strains() {
    check_work(&film(0.0));
    check_work(&film(0.0).with_biaxial(0.8));
    check_work(&Elastic { young: 5e7, poisson: 0.44 });
    check_work(&TensionField(Elastic { young: 5e7, poisson: 0.44 }));
}

#[test]
fn engineering_stresses_of_fabric_are_those_of_its_curves() {
    let film = film(0.6);
    for at in [[0.1, 0.3, 0.2], [0.5, -0.2, -0.4], [0.2, 0.1, 0.0]] {
        let d = strained(at);
        let Stresses { md, td, shear } = stresses(&d, &film.stress(&d, &mut PeakStrains::virgin(), 0.0));
        let Strains { shear: angle, .. } = strains(&d);
        let expected =
            [film.md().stress(at[0]), film.td().stress(at[1]), film.shear().stress(angle[0].abs()).copysign(angle[0])];
        for (stress, expected) in [md, td, shear].iter().zip(expected) {
            assert!((stress[0] - expected).abs() < 1e-6 * expected.abs().max(1.0), "{at:?}: {} {expected}", stress[0]);
        }
    }
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    for (absorption, above) in [(0.0, 0.0), (0.6, 0.05)] {
        check_derivative(&film(absorption), above);
        check_derivative(&film(absorption).with_biaxial(0.8), above);
    }
    check_derivative(&Elastic { young: 5e7, poisson: 0.44 }, 0.0);
    check_derivative(&TensionField(Elastic { young: 5e7, poisson: 0.44 }), 0.0);
    check_derivative(&TensionField(Elastic { young: 5e7, poisson: -0.3 }), 0.0);
}

/// Second differences of the energy along motions b ⊗ n of unit size, in the film along b and in space along n,
/// against the bound that follows from the law's stiffness.
pub(super) fn check_bound(law: &impl MembraneLaw<History<1> = PeakStrains<1>>) {
    let (step, turn) = (1e-4, std::f64::consts::PI / 8.0);
    for d in deformations() {
        for b in (0..8).map(|k| (turn * f64::from(k)).sin_cos()) {
            let (first, second) = b;
            let g = [[first * first, first * second], [first * second, second * second]];
            let bound = law.stiffness(&d, &PeakStrains::virgin()).eigenvalue_bound(&g.map(|row| row.map(splat)))[0];
            for n in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.6, -0.48, 0.64]] {
                let energy = |t: f64| {
                    let mut moved = d;
                    for axis in 0..3 {
                        moved.f[0][axis][0] += t * first * n[axis];
                        moved.f[1][axis][0] += t * second * n[axis];
                    }
                    law.energy(&moved, &PeakStrains::virgin()).stored[0]
                };
                let stiffness = (energy(step) - 2.0 * energy(0.0) + energy(-step)) / (step * step);
                assert!(stiffness <= bound * (1.0 + 1e-6) + 1.0, "{stiffness} over {bound} at {d:?}, {b:?}, {n:?}");
            }
        }
    }
}

#[test]
fn stiffness_is_bounded() {
    check_bound(&film(0.0));
    check_bound(&film(0.0).with_biaxial(0.8));
    for poisson in [0.0, 0.44, -0.3] {
        let elastic = Elastic { young: 5e7, poisson };
        check_bound(&elastic);
        check_bound(&TensionField(elastic));
    }
}

/// Second differences of the energy along random motions of unit size from `f`.
pub(super) fn stiffnesses(
    f: Gradient<1>,
    step: f64,
    random: &mut impl FnMut() -> f64,
    energy: impl Fn(Gradient<1>) -> f64,
) -> [f64; 12] {
    std::array::from_fn(|_| {
        let motion: [f64; 6] = std::array::from_fn(|_| random() - 0.5);
        let size = motion.iter().map(|m| m * m).sum::<f64>().sqrt();
        let at = |way: f64| {
            let mut moved = f;
            moved.iter_mut().flat_map(|f| &mut f.0).zip(motion).for_each(|(f, m)| f[0] += way * step * m / size);
            energy(moved)
        };
        (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (step * step)
    })
}
