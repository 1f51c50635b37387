use thorough::random;

use super::*;
use crate::lane::{Lane3, one};
use crate::material::tests::{check_bound, check_derivative, check_work, stiffnesses, turned, zero};
use crate::material::{Gradient, History};

/// Shear modulus of the laws, Pa.
const MU: f64 = 4e5;

/// Calls `$check` with every law, taut and wrinkling.
macro_rules! each_law {
    ($check:expr) => {
        for wrinkling in [false, true] {
            for energy in [
                Polynomial::neo_hookean(MU),
                Polynomial::mooney_rivlin(0.4 * MU, 0.1 * MU),
                Polynomial::yeoh([0.5 * MU, -0.005 * MU, 2e-4 * MU]),
            ] {
                $check(&Hyperelastic { energy, wrinkling });
            }
            $check(&Hyperelastic { energy: Gent { mu: MU, jm: 90.0 }, wrinkling });
            $check(&Hyperelastic { energy: rubber(), wrinkling });
            for poisson in [0.0, 0.3, 0.49] {
                $check(&Hyperelastic { energy: CompressibleNeoHookean { young: 1e6, poisson }, wrinkling });
            }
        }
    };
}

fn rubber() -> Ogden {
    Ogden::new(&Ogden::TRELOAR)
}

fn virgin_stress(law: &impl MembraneLaw<History<1> = PeakStrains<1>>, f: Gradient<1>) -> Stress<1> {
    law.stress(&Deformation::from(f), &mut History::virgin(), 0.0)
}

fn stored(law: &impl MembraneLaw<History<1> = PeakStrains<1>>, f: Gradient<1>) -> f64 {
    law.energy(&Deformation::from(f), &History::virgin()).stored[0]
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    each_law!(|law| check_derivative(law, 0.0));
}

#[test]
fn engineering_stresses_do_work_on_the_strains() {
    each_law!(check_work);
}

#[test]
fn the_bound_holds_in_general_position() {
    each_law!(check_bound);
}

/// Second differences of the energy along random motions of unit size against the bound, at random stretches and at
/// those within the strain for which it holds.
fn check_random_bound<E: StrainEnergy>(law: &Hyperelastic<E>, largest: f64) {
    let mut random = random(7);
    let mut closest = 0.0_f64;
    for _ in 0..1500 {
        let [first, second] = [0, 1].map(|_| 0.6 * (largest / 0.6).powf(random()));
        let angles = [6.3 * random(), 6.3 * random()];
        let f = turned([first, second], angles);
        let bound = law.stiffness(&Deformation::from(f), &PeakStrains::virgin()).any[0];
        let near = [0, 1].map(|_| 1.0 + NEAR * (2.0 * random() - 1.0));
        let f = turned([first * near[0], second * near[1]], angles);
        for stiffness in stiffnesses(f, 2e-4 * first.min(second), &mut random, |f| stored(law, f)) {
            closest = closest.max(stiffness / bound);
            assert!(stiffness <= 1.08 * bound + 10.0, "{stiffness} over {bound} at {first}, {second}, {near:?}");
        }
    }
    assert!(closest > 0.6, "the bound is {} of the largest stiffness found", 1.0 / closest);
}

#[test]
fn the_bound_holds_at_random_stretches() {
    each_law!(|law| check_random_bound(law, 4.0));
}

/// Up to stretches whose I₁ − 3 is 0.98 of the limit.
#[test]
fn the_bound_holds_near_the_limit_of_gent() {
    for wrinkling in [false, true] {
        let law = Hyperelastic { energy: Gent { mu: MU, jm: 10.0 }, wrinkling };
        let mut random = random(3);
        let (mut compared, mut closest) = (0, 0.0_f64);
        for _ in 0..400 {
            let second = 0.7 + 1.5 * random();
            let reach = |first: f64| {
                let natural = if wrinkling { second.max(1.0 / first.sqrt()) } else { second };
                first * first + natural * natural + (first * natural).powi(-2) - 3.0
            };
            let share = 0.9 + 0.08 * random();
            let first = zero(1.0, 5.0, |first| reach(first) - share * 10.0);
            let f = turned([first, second], [0.0; 2]);
            let bound = law.stiffness(&Deformation::from(f), &PeakStrains::virgin()).any[0];
            let near = first * (1.0 + 0.9 * NEAR);
            let energy = |t: f64| stored(&law, turned([near * (1.0 + 1e-5 * t), second], [0.0; 2]));
            let stiffness = (energy(1.0) - 2.0 * energy(0.0) + energy(-1.0)) / (1e-5 * near).powi(2);
            if bound.is_nan() || stiffness.is_nan() || reach(near * (1.0 + 1e-5)) >= 10.0 {
                continue;
            }
            (compared, closest) = (compared + 1, closest.max(stiffness / bound));
            assert!(stiffness <= 1.01 * bound, "{stiffness} {bound} {first} {second}");
        }
        assert!(compared > 100 && closest > 0.3, "{compared} states, {closest} of the bound");
    }
}

#[test]
fn beyond_the_limit_of_gent_there_is_no_stress() {
    let law = Hyperelastic { energy: Gent { mu: MU, jm: 10.0 }, wrinkling: true };
    let f = turned([4.0, 1.0], [0.3, 0.2]);
    assert!(virgin_stress(&law, f).p.iter().flat_map(|p| &p.0).all(|p| p[0].is_nan()));
    assert!(stored(&law, f).is_nan());
    assert!(law.stiffness(&Deformation::from(f), &PeakStrains::virgin()).any[0].is_nan());
    assert!(law.has_limit());
}

#[test]
fn rotation_alone_gives_no_stress() {
    each_law!(|law| {
        let stress = virgin_stress(law, turned([1.0, 1.0], [0.4, 0.9]));
        assert!(stress.p.iter().flat_map(|p| &p.0).all(|p| p[0].abs() < 1e-14 * 1e7), "{:?}", stress.p);
    });
}

/// Compressible film: σ_i J = μ(λ_i² − 1) + λ ln J, and no σ₃.
#[test]
fn stresses_of_compressible_film_are_their_closed_form() {
    for poisson in [0.0, 0.1, 0.3, 0.45, 0.4999] {
        let young = 2e6;
        let energy = CompressibleNeoHookean { young, poisson };
        let mu = young / (2.0 * (1.0 + poisson));
        let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        for stretch in [1.0 + 1e-4, 1.3, 2.5, 6.0_f64] {
            let narrow = energy.natural_width(one(stretch * stretch))[0].sqrt();
            for at in [[stretch, narrow], [stretch; 2], [stretch, 1.0]] {
                let law = Hyperelastic { energy: energy.clone(), wrinkling: false };
                let f = [[at[0], 0.0, 0.0], [0.0, at[1], 0.0]].map(Lane3::splat);
                let third = law.thickness_ratio(&Deformation::from(f), &virgin_stress(&law, f))[0];
                let volume = (at[0] * at[1] * third).ln();
                let kirchhoff = |stretch: f64| mu * (stretch * stretch - 1.0) + lame * volume;
                assert!(kirchhoff(third).abs() < 1e-9 * mu * (1.0 + lame / mu), "{poisson} {at:?}");
                let stress = virgin_stress(&law, f);
                let scale = kirchhoff(at[0]) / at[0];
                for i in 0..2 {
                    let error = (stress.p[i][i][0] - kirchhoff(at[i]) / at[i]).abs();
                    assert!(error < 1e-9 * scale * (1.0 + 1e-3 * lame / mu), "{poisson} {at:?} {i}: {error} {scale}");
                }
                if at[1] == narrow {
                    assert!(stress.p[1][1][0].abs() < 1e-9 * scale * (1.0 + lame / mu), "uniaxial {poisson} {at:?}");
                }
            }
        }
    }
}

#[test]
fn the_thickness_is_solved_to_round_off() {
    for poisson in [0.0, 1e-3, 0.1, 0.3, 0.45, 0.499, 0.499_999] {
        let energy = CompressibleNeoHookean { young: 1.0, poisson };
        let k = energy.ratio();
        for step in -90..=90 {
            let det = 10.0_f64.powf(0.1 * f64::from(step));
            let [x, y] = energy.squared_thickness(one(det));
            let residual = x[0] - 1.0 + k * (y[0] + det.ln());
            let terms = x[0] + 1.0 + k * (y[0].abs() + det.ln().abs());
            assert!(residual.abs() < 2e-15 * terms, "ν {poisson}, D {det}: {residual} of {terms}");
        }
    }
}

/// The least energy over all lengths that wrinkles may take up.
#[test]
fn the_energy_of_wrinkled_film_is_relaxed() {
    fn check<E: StrainEnergy + Clone>(law: &Hyperelastic<E>) {
        let own = Hyperelastic { energy: law.energy.clone(), wrinkling: false };
        let relaxing = Hyperelastic { energy: law.energy.clone(), wrinkling: true };
        for stretches in [[1.4, 0.5], [3.0, 0.3], [1.1, 0.95], [2.0, 1.5]] {
            let wider = (0..20_000)
                .map(|k| stored(&own, turned([stretches[0], stretches[1] + 1e-4 * f64::from(k)], [0.3, 0.1])));
            let least = wider.fold(f64::INFINITY, f64::min);
            let relaxed = stored(&relaxing, turned(stretches, [0.3, 0.1]));
            let is_least = (relaxed - least).abs() < 1e-7 * 1e6 && relaxed <= least * (1.0 + 1e-12);
            assert!(is_least, "{stretches:?} {relaxed} {least}");
        }
        assert_eq!(stored(&relaxing, turned([0.99, 0.4], [0.3, 0.1])), 0.0);
        let stress = virgin_stress(&relaxing, turned([0.99, 0.4], [0.3, 0.1]));
        assert!(stress.p.iter().flat_map(|p| &p.0).all(|p| p[0] == 0.0));
    }
    each_law!(check);
}

#[test]
fn wrinkled_film_is_in_uniaxial_tension() {
    let law = Hyperelastic { energy: rubber(), wrinkling: true };
    let stretch = 1.7_f64;
    let expected = virgin_stress(&law, turned([stretch, 1.0 / stretch.sqrt()], [0.0; 2])).tension[0][0];
    let d = turned([stretch, 0.4], [0.0; 2]);
    let stress = virgin_stress(&law, d);
    assert!((stress.tension[0][0] / expected - 1.0).abs() < 1e-12);
    assert!(stress.tension[1][0].abs() < 1e-12 * expected);
    let thickness = law.thickness_ratio(&Deformation::from(d), &stress)[0];
    assert!((thickness * stretch.sqrt() - 1.0).abs() < 1e-12, "{thickness}");
}
