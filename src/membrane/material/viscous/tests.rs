//! Relaxation, creep, constant rate and oscillation against closed forms and quadrature; energy and stiffness.

mod energy;

use std::f64::consts::PI;

use super::*;
use crate::lane::{Lane, one, splat};
use crate::material::hyperelastic::{Hyperelastic, Polynomial};
use crate::material::tests::film;
use crate::material::{
    Curve, Deformation, Elastic, Energy, Fabric, History, Measure, MembraneLaw, PeakStrains, Stress, TensionField,
};

/// A viscous point of a law.
struct Point<M> {
    law: M,
    viscous: ViscousLaw,
    history: PeakStrains<1>,
    variables: Vec<Lane<1>>,
}

impl<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone> Point<M> {
    fn new(law: M, viscosity: Viscosity) -> Point<M> {
        let base = law.viscous().unwrap();
        assert_eq!(M::MEASURE, Some(base.measure));
        let viscous = ViscousLaw::new(viscosity, base);
        let mut variables = vec![splat(0.0); viscous.viscosity.variables()];
        viscous.reset(&mut variables);
        Point { law, viscous, history: History::virgin(), variables }
    }

    /// Film mounted at `d`.
    fn mounted(mut self, d: &Deformation<1>) -> Point<M> {
        let step = ViscousStep::mounting(&self.viscous.viscosity);
        self.taken(&step, d);
        let Energy { stored, absorbed } = self.law.energy(d, &self.history);
        self.viscous.set_work(&mut self.variables, one(self.viscous.instant() * (stored[0] + absorbed[0])));
        self
    }

    fn taken(&mut self, step: &ViscousStep<1>, d: &Deformation<1>) -> Stress<1> {
        let mut stress = self.law.stress(d, &mut self.history, 0.0);
        self.viscous.advance(M::MEASURE.unwrap(), step, d, &mut stress, &mut self.variables);
        stress
    }

    /// Stress at `d`, reached after `dt`.
    fn moved(&mut self, d: &Deformation<1>, dt: f64) -> Stress<1> {
        self.taken(&ViscousStep::over(&self.viscous.viscosity, dt), d)
    }

    fn energy(&self, d: &Deformation<1>) -> [f64; 2] {
        let stress = self.law.stress(d, &mut self.history.clone(), 0.0);
        let energy = self.law.energy(d, &self.history);
        let Energy { stored, absorbed } = self.viscous.energy(d, &stress, &energy, &self.variables);
        [stored[0], absorbed[0]]
    }
}

fn series(terms: &[[f64; 2]]) -> Viscosity {
    Viscosity::new(terms.iter().map(|[share, time]| PronyTerm { share: *share, time: *time }).collect()).unwrap()
}

/// Film with the tangent vectors (a, 0, 0) and (b, c, 0).
fn plane(a: f64, b: f64, c: f64) -> Deformation<1> {
    Deformation::from([[a, 0.0, 0.0], [b, c, 0.0]])
}

fn elastic() -> Elastic {
    Elastic { young: 5e7, poisson: 0.44 }
}

fn rubber() -> Hyperelastic<Polynomial> {
    Hyperelastic { energy: Polynomial::neo_hookean(4e5), wrinkling: false }
}

/// A fabric of straight curves.
fn straight() -> Fabric {
    let line = || Curve::new(vec![[1.0, 5e7]]).unwrap();
    Fabric::new(line(), line(), line(), 0.0)
}

#[test]
fn the_decay_of_a_step_is_that_of_the_library() {
    for k in -400..400 {
        let x = 10.0_f64.powf(0.02 * f64::from(k));
        let [kept, mean] = decay(x);
        assert!((kept - (-x).exp()).abs() <= 2e-15 * (-x).exp() + 1e-300, "{x}");
        assert!((mean + (-x).exp_m1() / x).abs() <= 2e-15 * mean, "{x}");
    }
    assert_eq!(decay(0.0), [1.0, 1.0]);
}

/// S(t)/S° = 1 − Σ g (1 − e^(−t/τ)) of film that is held, at any strain, in steps of any length.
#[test]
fn held_film_relaxes_by_the_series() {
    fn check<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone>(law: M, d: &Deformation<1>) {
        let viscosity = series(&[[0.3, 1e-3], [0.2, 2e-2], [0.1, 0.5]]).rested(0.0);
        let mut point = Point::new(law, viscosity.clone()).mounted(d);
        let instant = point.law.stress(d, &mut History::virgin(), 0.0).p;
        let scale = instant.iter().flat_map(|p| &p.0).fold(0.0_f64, |most, p| most.max(p[0].abs()));
        let mut time = 0.0;
        for step in 0..60 {
            let dt = 1e-6 * 1.3_f64.powi(step) * (1.0 + 0.5 * f64::from(step).sin());
            time += dt;
            let stress = point.moved(d, dt).p;
            let of_term = |term: &PronyTerm| term.share * (1.0 - (-time / term.time).exp());
            let left = 1.0 - viscosity.terms().iter().map(of_term).sum::<f64>();
            for (found, instant) in stress.iter().flat_map(|p| &p.0).zip(instant.iter().flat_map(|p| &p.0)) {
                assert!((found[0] - left * instant[0]).abs() < 1e-12 * scale, "{time}: {} {}", found[0], instant[0]);
            }
        }
        let [stored, absorbed] = point.energy(d);
        let whole = point.law.energy(d, &point.history).stored[0];
        // Film mounted at once has done all its work before it relaxes.
        assert!((stored + absorbed - whole).abs() < 1e-9 * whole && absorbed > 0.55 * whole, "{stored} {absorbed}");
    }
    check(elastic(), &plane(1.1, 0.05, 1.05));
    check(TensionField(elastic()), &plane(1.1, 0.05, 0.7));
    check(rubber(), &plane(2.0, 0.5, 1.4));
    check(film(0.0), &plane(1.6, 0.3, 1.4));
    check(film(0.0).with_biaxial(0.8), &plane(1.6, 0.3, 1.4));
}

/// The hereditary integral S° − Σ g/τ ∫ e^(−(t−s)/τ) S°(s) ds of a motion, by Simpson's rule, of each component in the
/// measure of the law.
fn convolution(viscosity: &Viscosity, stress: &dyn Fn(f64) -> f64, time: f64) -> f64 {
    let intervals = 20_000;
    let h = time / f64::from(intervals);
    let of_term = |term: &PronyTerm| {
        let at = |k: i32| {
            let s = h * f64::from(k);
            (-(time - s) / term.time).exp() * stress(s)
        };
        let inner: f64 = (1..intervals).map(|k| if k % 2 == 1 { 4.0 * at(k) } else { 2.0 * at(k) }).sum();
        term.share / term.time * h / 3.0 * (at(0) + inner + at(intervals))
    };
    stress(time) - viscosity.terms().iter().map(of_term).sum::<f64>()
}

/// Film stretched along MD at a constant rate from no stress: nominal stress against quadrature of the law's own.
#[test]
fn stress_at_constant_rate_is_the_hereditary_integral() {
    let viscosity = series(&[[0.3, 5e-3], [0.25, 4e-2]]);
    fn check<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone>(
        law: M,
        viscosity: &Viscosity,
        rate: f64,
        fibres: bool,
    ) {
        let d = |time: f64| plane(1.0 + rate * time, 0.0, 1.0);
        let measured = |law: &M, time: f64| {
            let tension = law.stress(&d(time), &mut History::virgin(), 0.0).tension[0][0];
            if fibres { tension * (1.0 + rate * time) } else { tension }
        };
        let mut point = Point::new(law.clone(), viscosity.clone()).mounted(&d(0.0));
        let (end, steps) = (0.1, 4000);
        let mut found = 0.0;
        for k in 1..=steps {
            found = point.moved(&d(end * f64::from(k) / f64::from(steps)), end / f64::from(steps)).p[0][0][0];
        }
        let integral = convolution(viscosity, &|s| measured(&law, s), end);
        let expected = if fibres { integral } else { integral * (1.0 + rate * end) };
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
    }
    check(elastic(), &viscosity, 1.0, false);
    check(rubber(), &viscosity, 15.0, false);
    check(film(0.0), &viscosity, 6.0, true);
    // A straight curve: σ = E ε̇ (t − Σ g (t − τ + τ e^(−t/τ))).
    let (rate, end) = (2.0, 0.1);
    let relaxed = |term: &PronyTerm| term.share * (end - term.time + term.time * (-end / term.time).exp());
    let expected = 5e7 * rate * (end - viscosity.terms().iter().map(relaxed).sum::<f64>());
    let mut point = Point::new(straight(), viscosity).mounted(&plane(1.0, 0.0, 1.0));
    let steps = [1, 2, 5, 7, 10].map(|part| 0.004 * f64::from(part));
    let mut time = 0.0;
    let mut found = 0.0;
    for dt in steps {
        time += dt;
        found = point.moved(&plane(1.0 + rate * time, 0.0, 1.0), dt).p[0][0][0];
    }
    assert!((time - end).abs() < 1e-15 && (found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
}

/// ε(t) = σ/E (1/(1 − g) − g/(1 − g) e^(−(1 − g) t/τ)) under a constant stress.
#[test]
fn creep_of_a_fibre_has_the_closed_form() {
    let (share, time, stress, young) = (0.4, 0.02, 4e6, 5e7);
    let mut point = Point::new(straight(), series(&[[share, time]]).rested(0.0));
    let mut strain = stress / young;
    point = point.mounted(&plane(1.0 + strain, 0.0, 1.0));
    let dt = time / 200.0;
    for k in 1..=1000 {
        // The stress is linear in the strain within a step.
        let tried = |strain: f64| {
            let mut trial = Point {
                law: straight(),
                viscous: point.viscous.clone(),
                history: point.history,
                variables: point.variables.clone(),
            };
            trial.moved(&plane(1.0 + strain, 0.0, 1.0), dt).p[0][0][0] - stress
        };
        let (low, high) = (tried(strain), tried(strain + 1e-3));
        strain -= 1e-3 * low / (high - low);
        point.moved(&plane(1.0 + strain, 0.0, 1.0), dt);
        let t = dt * f64::from(k);
        let expected = stress / young * (1.0 - share * (-(1.0 - share) * t / time).exp()) / (1.0 - share);
        assert!((strain / expected - 1.0).abs() < 1e-5, "{t}: {strain} for {expected}");
    }
}

/// Storage and loss modulus over E: 1 − Σ g + Σ g (ωτ)²/(1 + (ωτ)²) and Σ g ωτ/(1 + (ωτ)²).
fn moduli(viscosity: &Viscosity, omega: f64) -> [f64; 2] {
    let x = |term: &PronyTerm| omega * term.time;
    let storage = |term: &PronyTerm| term.share * x(term).powi(2) / (1.0 + x(term).powi(2));
    let loss = |term: &PronyTerm| term.share * x(term) / (1.0 + x(term).powi(2));
    let of = |part: &dyn Fn(&PronyTerm) -> f64| viscosity.terms().iter().map(part).sum::<f64>();
    [viscosity.long_term() + of(&storage), of(&loss)]
}

/// Film that is already stretched, of which one strain oscillates: amplitude, loss angle and what is absorbed per
/// cycle.
#[test]
fn loss_angle_and_absorption_of_a_cycle_are_those_of_the_loss_modulus() {
    fn check<M: MembraneLaw<History<1> = PeakStrains<1>> + Clone>(law: M, mean: f64, energy: f64) {
        let viscosity = series(&[[0.3, 1e-3], [0.2, 1e-2]]);
        for omega in [20.0, 100.0, 300.0, 1000.0, 5000.0] {
            let amplitude = 1e-4;
            let d = |phase: f64| plane(1.0 + mean + amplitude * phase.sin(), 0.0, 1.0);
            let slope = {
                let at = |phase: f64| law.stress(&d(phase), &mut History::virgin(), 0.0).p[0][0][0];
                (at(0.5 * PI) - at(-0.5 * PI)) / (2.0 * amplitude)
            };
            let geometric = {
                // The force turns and lengthens with the film: of S that is the stress itself over the stretch.
                let p = law.stress(&d(0.0), &mut History::virgin(), 0.0).p[0][0][0];
                if law.viscous().unwrap().measure == Measure::Fibres { 0.0 } else { p / (1.0 + mean) }
            };
            let [storage, loss] = moduli(&viscosity, omega);
            let held = viscosity.long_term() * geometric;
            let expected = [(slope - geometric) * storage + held, (slope - geometric) * loss];
            let mut point = Point::new(law.clone(), viscosity.clone()).mounted(&d(0.0));
            let (per_cycle, cycles) = (800, 2 + (20.0 * omega * 1e-2 / (2.0 * PI)) as i32);
            let dt = 2.0 * PI / omega / f64::from(per_cycle);
            let (mut in_phase, mut out_of_phase, mut absorbed) = (0.0, 0.0, 0.0);
            let mean_stress = viscosity.long_term() * law.stress(&d(0.0), &mut History::virgin(), 0.0).p[0][0][0];
            for k in 1..=cycles * per_cycle {
                let phase = 2.0 * PI * f64::from(k) / f64::from(per_cycle);
                let stress = point.moved(&d(phase), dt).p[0][0][0] - mean_stress;
                if k == (cycles - 1) * per_cycle {
                    absorbed = -point.energy(&d(phase))[1];
                }
                if k > (cycles - 1) * per_cycle {
                    in_phase += 2.0 * stress * phase.sin() / f64::from(per_cycle);
                    out_of_phase += 2.0 * stress * phase.cos() / f64::from(per_cycle);
                }
            }
            absorbed += point.energy(&d(0.0))[1];
            let [storage, loss] = [in_phase / amplitude, out_of_phase / amplitude];
            let (angle, angle_expected) = (loss.atan2(storage), expected[1].atan2(expected[0]));
            assert!((storage / expected[0] - 1.0).abs() < 1e-3, "{omega}: {storage} {}", expected[0]);
            assert!((angle / angle_expected - 1.0).abs() < 1e-3, "{omega}: {angle} {angle_expected}");
            let per_cycle = PI * expected[1] * amplitude * amplitude;
            assert!((absorbed / per_cycle - 1.0).abs() < energy, "{omega}: {absorbed} {per_cycle}");
        }
    }
    check(elastic(), 0.1, 2e-3);
    check(rubber(), 0.8, 2e-3);
    check(straight(), 0.3, 2e-3);
    check(film(0.0), 0.1, 2e-3);
}

#[test]
fn mounted_film_has_relaxed_for_its_rest() {
    let d = plane(1.1, 0.02, 1.05);
    let viscosity = series(&[[0.3, 1.0], [0.2, 100.0]]);
    let instant = elastic().stress(&d, &mut History::virgin(), 0.0).p[0][0][0];
    let of = |viscosity: &Viscosity| {
        let mut point = Point::new(elastic(), viscosity.clone()).mounted(&d);
        let found = point.moved(&d, 0.0).p[0][0][0] / instant;
        assert!((found / viscosity.mounted() - 1.0).abs() < 1e-14);
        found
    };
    assert!((of(&viscosity) - 0.5).abs() < 1e-14);
    assert!((of(&viscosity.clone().rested(0.0)) - 1.0).abs() < 1e-14);
    let ten = 0.5 + 0.3 * (-10.0_f64).exp() + 0.2 * (-0.1_f64).exp();
    assert!((of(&viscosity.clone().rested(10.0)) - ten).abs() < 1e-14);
    assert!((of(&viscosity.with_written(Written::LongTerm)) - 1.0).abs() < 1e-14);
}

/// Film that is written as relaxed is the film of an instantaneous law that is stiffer, to round-off.
#[test]
fn a_law_of_relaxed_film_is_scaled() {
    let viscosity = series(&[[0.3, 1e-3], [0.2, 2e-2]]);
    let stiffer = Elastic { young: 1e8, ..elastic() };
    let mut written =
        Point::new(elastic(), viscosity.clone().with_written(Written::LongTerm)).mounted(&plane(1.0, 0.0, 1.0));
    let mut scaled = Point::new(stiffer, viscosity).mounted(&plane(1.0, 0.0, 1.0));
    for k in 1..200 {
        let d = plane(1.0 + 0.1 * (0.05 * f64::from(k)).sin(), 0.02, 1.0 + 1e-4 * f64::from(k));
        let [one, other] = [written.moved(&d, 1e-4), scaled.moved(&d, 1e-4)].map(|stress| stress.p[0][0][0]);
        assert!((one - other).abs() < 1e-12 * 1e8, "{one} {other}");
        for (one, other) in written.energy(&d).into_iter().zip(scaled.energy(&d)) {
            assert!((one - other).abs() < 1e-9 * 1e6, "{one} {other}");
        }
    }
}

/// Film that is shortened faster than it relaxes becomes slack before its law does, and taut again at the strain to
/// which it has recovered.
#[test]
fn film_shortened_at_once_carries_no_compression() {
    let (share, time) = (0.5, 1.0);
    let mut point = Point::new(straight(), series(&[[share, time]])).mounted(&plane(1.2, 0.0, 1.0));
    // At 0.2 all has relaxed. With E (1 − g) ε + g E (ε − 0.2) = 0 the film is slack below the strain 0.1.
    for (strain, expected) in [(0.15, 0.05), (0.1, 0.0), (0.02, 0.0), (-0.1, 0.0), (0.1, 0.0), (0.12, 0.02)] {
        let found = point.moved(&plane(1.0 + strain, 0.0, 1.0), 0.0).p[0][0][0];
        assert!((found - 5e7 * expected).abs() < 1e-6 * 5e7, "{strain}: {found}");
    }
    // Slack film recovers: it is slack below ε, and dε_v/dt = (ε − ε_v)/τ with ε = g ε_v.
    point.moved(&plane(1.0, 0.0, 1.0), 0.0);
    for _ in 0..1000 {
        point.moved(&plane(1.0, 0.0, 1.0), 1e-3);
    }
    let recovered = share * 0.2 * (-(1.0 - share) / time).exp();
    let found = point.moved(&plane(1.0 + recovered + 0.01, 0.0, 1.0), 0.0).p[0][0][0];
    assert!((found / (5e7 * 0.01) - 1.0).abs() < 1e-3, "{found}");
    // Wrinkling film in any direction does so too.
    let mut point = Point::new(TensionField(elastic()), series(&[[share, time]])).mounted(&plane(1.1, 0.05, 1.1));
    for k in 0..200 {
        let shortened = 0.001 * f64::from(k);
        let d = plane(1.1 - shortened, 0.05 - 0.3 * shortened, 1.1 - 0.5 * shortened);
        let s = point.moved(&d, 1e-3);
        let (sum, product) =
            (s.tension[0][0] + s.tension[1][0], s.tension[0][0] * s.tension[1][0] - s.cross[0] * s.cross[0]);
        assert!(sum >= 0.0 && product >= -1e-9 * sum * sum, "{k}: {sum} {product}");
    }
}

/// Times at T are those at the reference times a_T: the stress is the same to the bit where time is stretched by it.
#[test]
fn temperature_shifts_time() {
    let (wlf, arrhenius) =
        (Wlf { c1: 10.0, c2: 50.0, reference: 293.15 }, Arrhenius { energy: 1e5, reference: 293.15 });
    assert_eq!([wlf.factor_at(293.15), arrhenius.factor_at(293.15)], [Some(1.0); 2]);
    // −10·10/60 decades, and E/R (1/303.15 − 1/293.15).
    assert!((wlf.factor_at(303.15).unwrap() / 10.0_f64.powf(-100.0 / 60.0) - 1.0).abs() < 1e-12);
    let expected = 1e5 / 8.314_462_618 * (1.0 / 303.15 - 1.0 / 293.15);
    assert!((arrhenius.factor_at(303.15).unwrap().ln() / expected - 1.0).abs() < 1e-9);
    assert_eq!(wlf.factor_at(243.0), None);
    // A power of two shifts exactly.
    let terms = series(&[[0.3, 1e-3], [0.2, 2e-2]]);
    let d = |k: i32| plane(1.0 + 0.1 * (0.1 * f64::from(k)).sin(), 0.02, 1.0);
    let of = |viscosity: Viscosity, dt: f64| {
        let mut point = Point::new(elastic(), viscosity).mounted(&d(0));
        (1..100).map(|k| point.moved(&d(k), dt).p[0][0][0].to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(of(terms.clone(), 1e-4), of(terms.shifted(0.125), 1e-4 / 8.0));
}

#[test]
fn terms_that_are_no_series_are_refused() {
    let of = |terms: &[[f64; 2]]| {
        Viscosity::new(terms.iter().map(|[share, time]| PronyTerm { share: *share, time: *time }).collect())
    };
    assert_eq!(of(&[]), Err(ViscosityError::Empty));
    assert_eq!(of(&[[0.5, 1.0], [0.1, 0.0]]), Err(ViscosityError::InvalidTerm { index: 1 }));
    assert_eq!(of(&[[f64::NAN, 1.0]]), Err(ViscosityError::InvalidTerm { index: 0 }));
    assert_eq!(of(&[[0.5, 1.0], [0.5, 2.0]]), Err(ViscosityError::NothingLeft { sum: 1.0 }));
}

/// Fibres that break take their overstress along.
#[test]
fn broken_fibres_carry_nothing() {
    let mut point = Point::new(film(0.0), series(&[[0.4, 1e-2]])).mounted(&plane(1.0, 0.0, 1.0));
    point.moved(&plane(1.3, 0.1, 1.2), 1e-3);
    let before = point.viscous.stress(&plane(1.3, 0.1, 1.2), &point.variables);
    point.viscous.break_fibres(&mut point.variables, 0, [1.0, 1.0], [0.5, 1.0]);
    let after = point.viscous.stress(&plane(1.3, 0.1, 1.2), &point.variables);
    assert!((after.tension[0][0] / before.tension[0][0] - 0.5).abs() < 1e-14);
    assert!((after.cross[0] / before.cross[0] - 0.5).abs() < 1e-14);
    assert_eq!(after.tension[1], before.tension[1]);
}
