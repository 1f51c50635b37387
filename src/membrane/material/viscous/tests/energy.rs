//! Stored and absorbed energy, and the bound on the stiffness.

use std::f64::consts::PI;

use super::super::ViscousStep;
use super::{Point, elastic, plane, rubber, series, straight};
use crate::lane::splat;
use crate::material::tests::film;
use crate::material::{Deformation, MembraneLaw, PeakStrains, TensionField};

/// Springs and dashpots of linear film, integrated by themselves: dε_v/dt = q/(g E τ), q = g E (ε − ε_v).
#[test]
fn stored_and_absorbed_energy_are_those_of_springs_and_dashpots() {
    let terms = [[0.3, 2e-3], [0.25, 3e-2]];
    let strain = |t: f64| 0.05 * (40.0 * t).sin() + 0.08 * (1.0 - (-t / 0.05).exp()) + 0.06;
    let (young, dt) = (5e7, 1e-5);
    let mut point = Point::new(straight(), series(&terms)).mounted(&plane(1.0 + strain(0.0), 0.0, 1.0));
    let mut dashpots = [strain(0.0); 2];
    let (mut dissipated, mut before) = (0.0, point.energy(&plane(1.0 + strain(0.0), 0.0, 1.0))[1]);
    let start = before;
    for k in 1..=10_000 {
        let t = dt * f64::from(k);
        let (from, to) = (strain(t - dt), strain(t));
        for (dashpot, [share, time]) in dashpots.iter_mut().zip(terms) {
            // Exact for a strain that changes steadily within the step.
            let (rate, decay) = ((to - from) / dt, (-dt / time).exp());
            let (first, last) = (from - *dashpot, rate * time + (from - *dashpot - rate * time) * decay);
            *dashpot = to - last;
            dissipated += dt * share * young / time * 0.5 * (first * first + last * last);
        }
        let d = plane(1.0 + to, 0.0, 1.0);
        point.moved(&d, dt);
        let [stored, absorbed] = point.energy(&d);
        let spring = |(dashpot, [share, _]): (&f64, [f64; 2])| 0.5 * share * young * (to - dashpot).powi(2);
        let expected = 0.5 * 0.45 * young * to * to + dashpots.iter().zip(terms).map(spring).sum::<f64>();
        assert!((stored / expected - 1.0).abs() < 1e-7, "{t}: {stored} {expected}");
        assert!(absorbed >= before - 1e-9 * stored, "{t}");
        before = absorbed;
    }
    assert!(((before - start) / dissipated - 1.0).abs() < 1e-4, "{} {dissipated}", before - start);
}

/// Nothing that is absorbed comes back on random paths of linear film; of other film at most a small part of it.
#[test]
fn absorbed_energy_grows_on_random_paths() {
    fn check<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone>(name: &str, law: M, strain: f64, tolerance: f64) {
        let viscosity = series(&[[0.3, 1e-3], [0.3, 3e-2]]);
        let mut point = Point::new(law, viscosity).mounted(&plane(1.0, 0.0, 1.0));
        let mut random = thorough::random(1);
        let (mut from, mut most, mut fall) = ([1.0, 0.0, 1.0], 0.0_f64, 0.0_f64);
        for _ in 0..60 {
            let to = [1.0 + strain * random(), strain * (random() - 0.5), 1.0 + strain * random()];
            let duration = 1e-3 * 30.0_f64.powf(random());
            for k in 1..=200 {
                let at: [f64; 3] = std::array::from_fn(|i| from[i] + (to[i] - from[i]) * f64::from(k) / 200.0);
                let d = plane(at[0], at[1], at[2]);
                point.moved(&d, duration / 200.0);
                let [_, absorbed] = point.energy(&d);
                most = most.max(absorbed);
                fall = fall.max(most - absorbed);
            }
            from = to;
        }
        println!("{name}: {fall:.3e} of {most:.3e} J/m3, {:.4}", fall / most);
        assert!(most > 0.0 && fall <= tolerance * most, "{name}: {fall} of {most}");
    }
    check("elastic", elastic(), 0.1, 1e-6);
    check("fabric of straight curves", straight(), 0.1, 1e-3);
    check("neo-Hookean", rubber(), 0.5, 0.02);
    check("fabric", film(0.0), 0.5, 0.1);
    check("fabric with absorption", film(0.5), 0.5, 0.04);
    check("tension field", TensionField(elastic()), 0.1, 1e-3);
}

/// The force of a small motion within an instant over that motion, along any direction, after film was held, stretched or
/// compressed, against the bound.
#[test]
fn stiffness_of_viscous_film_is_bounded() {
    fn check<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone>(law: M, held: Deformation<1>, then: Deformation<1>) {
        let viscosity = series(&[[0.5, 1e-3], [0.3, 3e-2]]);
        let mut point = Point::new(law, viscosity).mounted(&held);
        point.moved(&then, 0.0);
        let instant = ViscousStep::over(&point.viscous.viscosity, 0.0);
        let stiffness = point.viscous.stiffness(&then, point.law.stiffness(&then, &point.history), &point.variables);
        for angle in (0..8).map(|k| PI / 8.0 * f64::from(k)) {
            let b = [angle.cos(), angle.sin()];
            let g = b.map(|i| b.map(|j| splat(i * j)));
            let bound = stiffness.eigenvalue_bound(&g)[0];
            for n in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.6, -0.48, 0.64]] {
                let force = |t: f64| {
                    let mut d = then;
                    for axis in 0..3 {
                        for fibre in 0..2 {
                            d.f[fibre][axis][0] += t * b[fibre] * n[axis];
                        }
                    }
                    let mut stress = point.law.stress(&d, &mut point.history.clone(), 0.0);
                    point.viscous.advance(M::MEASURE.unwrap(), &instant, &d, &mut stress, &mut point.variables.clone());
                    (0..3)
                        .map(|axis| n[axis] * (b[0] * stress.p[0][axis][0] + b[1] * stress.p[1][axis][0]))
                        .sum::<f64>()
                };
                let found = (force(1e-6) - force(-1e-6)) / 2e-6;
                assert!(found <= bound * (1.0 + 1e-6) + 1.0, "{found} over {bound}: {b:?} {n:?}");
            }
        }
    }
    for (held, then) in [
        (plane(1.0, 0.0, 1.0), plane(1.2, 0.1, 1.1)),
        (plane(1.2, 0.1, 1.1), plane(1.2, 0.1, 1.1)),
        (plane(1.3, -0.2, 1.2), plane(1.05, 0.1, 1.1)),
        (plane(0.9, 0.2, 0.8), plane(1.1, -0.1, 1.02)),
    ] {
        check(elastic(), held, then);
        check(TensionField(elastic()), held, then);
        check(rubber(), held, then);
        check(film(0.0), held, then);
        check(film(0.0).with_biaxial(0.8), held, then);
    }
}
