use thorough::random;

use super::*;
use crate::lane::Lane3;
use crate::material::tests::{stiffnesses, turned, zero};
use crate::material::{Gradient, History};

const YOUNG: f64 = 2e8;

type Point = PlasticHistory<1>;

fn elastic() -> Elastic {
    Elastic { young: YOUNG, poisson: 0.45 }
}

fn table() -> Hardening {
    Hardening::Table(FlowCurve::new(&[[0.0, 8e6], [0.03, 10e6], [0.1, 11e6], [0.5, 20e6]]).unwrap())
}

fn voce() -> Hardening {
    Hardening::Voce(Voce { initial: 8e6, saturation: 20e6, rate: 6.0 })
}

fn orthotropic() -> Hill {
    Hill::from_strain_ratios([0.6, 1.5, 2.2])
}

fn by_rate() -> Plastic {
    let curve = |factor: f64| FlowCurve::new(&[[0.0, 8e6 * factor], [0.1, 11e6 * factor], [0.5, 20e6 * factor]]);
    let curves = [(0.01, 1.0), (1.0, 1.2), (100.0, 1.7)].map(|(rate, factor)| (rate, curve(factor).unwrap()));
    let (first, table) = RateTable::new(curves.to_vec()).unwrap();
    Plastic::new(elastic(), orthotropic(), Hardening::Table(first), FlowRate::Table(table))
}

fn slow(hill: Hill, hardening: Hardening) -> Plastic {
    Plastic::new(elastic(), hill, hardening, FlowRate::Independent)
}

/// Laws of every kind of hardening and rate dependence.
fn laws() -> Vec<Plastic> {
    let perfect = Hardening::Table(FlowCurve::new(&[[0.0, 8e6]]).unwrap());
    let stiffening = FlowCurve::new(&[[0.0, 8e6], [0.01, 8e6], [0.02, 14e6], [0.021, 14.1e6], [0.05, 40e6]]).unwrap();
    vec![
        slow(Hill::default(), perfect),
        slow(orthotropic(), table()),
        slow(Hill::from_strain_ratios([3.0, 0.2, 0.5]), Hardening::Table(stiffening)),
        slow(orthotropic(), voce()),
        by_rate(),
    ]
}

fn step(law: &Plastic, f: Gradient<1>, history: &mut Point, dt: f64) -> Stress<1> {
    law.stress(&Deformation::from(f), history, dt)
}

/// Film of the symmetric stretch exp of the logarithmic strain of components 11, 22 and 12.
fn strained([e11, e22, e12]: [f64; 3]) -> Gradient<1> {
    let (mean, apart) = (0.5 * (e11 + e22), 0.5 * (e11 - e22));
    let radius = apart.hypot(e12);
    let quotient = if radius < 1e-8 { 1.0 } else { radius.sinh() / radius };
    let (level, deviator) = (mean.exp() * radius.cosh(), mean.exp() * quotient);
    [[level + deviator * apart, deviator * e12, 0.0], [deviator * e12, level - deviator * apart, 0.0]].map(Lane3::splat)
}

/// The stress T that does work on E, of a history that includes this strain.
fn work_stress(law: &Plastic, f: Gradient<1>, history: &Point) -> [f64; 3] {
    let log = Logarithm::from_cauchy_green(&Deformation::from(f).metric());
    law.modes.stress(&law.amplitudes(&log, &history.strain)).map(|t| t[0])
}

fn effective(hill: &Hill, [a, b, c]: [f64; 3]) -> f64 {
    let [along, across] = hill.normal();
    (along * a * a - 2.0 * hill.h * a * b + across * b * b + 2.0 * hill.n * c * c).sqrt()
}

/// ½ ln C by its principal directions.
fn logarithm_of([c11, c22, c12]: [f64; 3]) -> [f64; 3] {
    let angle = 0.5 * (2.0 * c12).atan2(c11 - c22);
    let (s, c) = angle.sin_cos();
    let first = c11 * c * c + c22 * s * s + 2.0 * c12 * s * c;
    let second = c11 * s * s + c22 * c * c - 2.0 * c12 * s * c;
    let (a, b) = (0.5 * first.ln(), 0.5 * second.ln());
    [a * c * c + b * s * s, a * s * s + b * c * c, (a - b) * s * c]
}

fn metric_of(f: Gradient<1>) -> [f64; 3] {
    Deformation::from(f).metric().map(|c| c[0])
}

#[test]
fn the_strain_is_the_logarithm() {
    let mut random = random(5);
    for _ in 0..5000 {
        let stretches = [0, 1].map(|_| 0.2 * 25.0_f64.powf(random()));
        let f = turned(stretches, [6.3 * random(), 6.3 * random()]);
        let found = Logarithm::from_cauchy_green(&Deformation::from(f).metric()).strain;
        let expected = logarithm_of(metric_of(f));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found[0] - expected).abs() < 2e-13, "{stretches:?}: {found:?} {expected}");
        }
    }
}

/// Where the principal stretches are nearly equal the logarithm keeps all bits: E − ½ ln λ² = ½ δ/λ² to first order.
#[test]
fn nearly_equal_stretches_lose_no_bits() {
    for square in [0.3, 1.0, 5.0_f64] {
        for size in [0.0, 1e-300, 1e-200, 1e-30, 1e-15, 1e-9] {
            let c = [square, square, size * square].map(splat);
            let log = Logarithm::<1>::from_cauchy_green(&c);
            assert!((log.strain[2][0] - 0.5 * size).abs() <= 4e-16 * size, "{size}: {:?}", log.strain[2]);
            assert!((log.strain[0][0] - 0.5 * square.ln()).abs() < 2e-16 + 0.5 * size * size);
            let s = log.second_piola(&[1.0, 3.0, 2.0].map(splat));
            for (s, t) in s.iter().zip([1.0, 3.0, 2.0]) {
                assert!((s[0] * square - t).abs() < 1e-14 + 4.0 * size, "{s:?}");
            }
        }
    }
}

/// S : ½ dC = T : dE by central differences of the logarithm, on both sides of the stretches at which its evaluation
/// changes.
#[test]
fn stresses_do_the_same_work() {
    let mut random = random(9);
    for _ in 0..3000 {
        let stretches = [1.0 + random(), 0.4 + random()];
        let c = metric_of(turned(stretches, [6.3 * random(), 0.0]));
        let t = [0, 1, 2].map(|_| random() - 0.5);
        let s = Logarithm::<1>::from_cauchy_green(&c.map(splat)).second_piola(&t.map(splat));
        let motion = [0, 1, 2].map(|_| random() - 0.5);
        let at = |way: f64| logarithm_of([0, 1, 2].map(|i| c[i] + way * 1e-5 * motion[i]));
        let (above, below) = (at(1.0), at(-1.0));
        let change = [0, 1, 2].map(|i| (above[i] - below[i]) / 2e-5);
        let by_t = t[0] * change[0] + t[1] * change[1] + 2.0 * t[2] * change[2];
        let by_s = 0.5 * (s[0][0] * motion[0] + s[1][0] * motion[1] + 2.0 * s[2][0] * motion[2]);
        assert!((by_t - by_s).abs() < 1e-8, "{stretches:?}: {by_t} {by_s}");
    }
}

/// Flow of the trial by bisection alone, with the stress as the solution of (S + γP) T = E by Cramer's rule.
struct BruteForce<'a> {
    law: &'a Plastic,
    trial: [f64; 3],
    before: f64,
    dt: f64,
}

impl BruteForce<'_> {
    fn stress(&self, gamma: f64) -> [f64; 3] {
        let Elastic { young, poisson } = self.law.elastic;
        let ([along, across], h, n) = (self.law.hill.normal(), self.law.hill.h, self.law.hill.n);
        let (a, b) = (1.0 / young + gamma * along, 1.0 / young + gamma * across);
        let c = -poisson / young - gamma * h;
        let det = a * b - c * c;
        let [e1, e2, e3] = self.trial;
        let shear = 2.0 * (1.0 + poisson) / young + 2.0 * gamma * n;
        [(b * e1 - c * e2) / det, (a * e2 - c * e1) / det, 2.0 * e3 / shear]
    }

    /// Stress over flow stress, less one: falls with γ.
    fn excess(&self, gamma: f64) -> f64 {
        let stress = effective(&self.law.hill, self.stress(gamma));
        let growth = gamma * stress;
        let p = self.before + growth;
        let flow = match self.dt > 0.0 && growth > 0.0 {
            true => self.law.flow_stress(p, growth / self.dt),
            false => self.law.hardening.stress(p),
        };
        stress / flow - 1.0
    }

    fn solve(&self) -> f64 {
        if self.excess(0.0) <= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        while self.excess(high) > 0.0 {
            high *= 2.0;
        }
        for _ in 0..1200 {
            let middle = 0.5 * (low + high);
            if self.excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

/// 25 000 random trials, from strains far below yield to such as no step has.
#[test]
fn flow_is_solved_to_round_off() {
    let mut random = random(21);
    let (mut flowed, mut worst) = (0, 0.0_f64);
    for law in laws() {
        for _ in 0..5000 {
            let size = 10.0_f64.powf(-2.5 + 3.0 * random());
            let trial = [0, 1, 2].map(|_| size * (random() - 0.5));
            let before = if random() < 0.3 { 0.0 } else { random().powi(2) };
            let dt = if random() < 0.2 { 0.0 } else { 10.0_f64.powf(-9.0 + 10.0 * random()) };
            let mut history = Point::virgin();
            history.equivalent = one(before);
            let expected = BruteForce { law: &law, trial, before, dt };
            let gamma = expected.solve();
            let stress = expected.stress(gamma);
            step(&law, strained(trial), &mut history, dt);
            let found = work_stress(&law, strained(trial), &history);
            let scale = effective(&law.hill, stress);
            flowed += usize::from(gamma > 0.0);
            for i in 0..3 {
                let error = (found[i] - stress[i]).abs() / (scale + 1e-9 * YOUNG);
                // The strain itself is known to round-off of one.
                worst = worst.max(error / (1.0 + 1e-3 * YOUNG / scale.max(1e3)));
                let allowed = 1e-12 * (1.0 + YOUNG / scale.max(1e3));
                assert!(error < allowed, "{law:?} {trial:?} {before} {dt}: {found:?} {stress:?}");
            }
        }
    }
    assert!(flowed > 10_000, "{flowed} trials flowed");
    println!("worst {worst:e}, {flowed} flowed");
}

/// The end of a path by an explicit integration of the rate equations on ½ ln C: Ṫ = ℂ(Ė − ṗ N), N = ∂σ̄/∂T.
#[test]
fn a_path_is_that_of_the_rate_equations() {
    for (law, tolerance) in
        [(slow(orthotropic(), voce()), 2e-4), (slow(Hill::from_strain_ratios([1.0, 0.5, 1.0]), table()), 2e-4)]
    {
        let path = |time: f64| {
            let turn = 3.0 * time;
            [[1.0 + 0.3 * time, 0.1 * turn.sin(), 0.0], [0.25 * time, 1.0 - 0.1 * time, 0.2 * time]].map(Lane3::splat)
        };
        let mut history = Point::virgin();
        let steps = 4000;
        (1..=steps).for_each(|k| {
            step(&law, path(f64::from(k) / f64::from(steps)), &mut history, 1.0);
        });
        let found = work_stress(&law, path(1.0), &history);
        let (expected, p) = integrated(&law, &path, 400_000);
        for i in 0..3 {
            assert!((found[i] - expected[i]).abs() < tolerance * 1e7, "{found:?} {expected:?}");
        }
        assert!((history.equivalent[0] - p).abs() < tolerance * p, "{} {p}", history.equivalent[0]);
    }
}

/// T and p at the end of `path` by Euler's explicit method.
fn integrated(law: &Plastic, path: &dyn Fn(f64) -> Gradient<1>, steps: u32) -> ([f64; 3], f64) {
    let Elastic { young, poisson } = law.elastic;
    let response = |e: [f64; 3]| {
        let plane = young / (1.0 - poisson * poisson);
        [plane * (e[0] + poisson * e[1]), plane * (e[1] + poisson * e[0]), young / (1.0 + poisson) * e[2]]
    };
    let ([along, across], h, n) = (law.hill.normal(), law.hill.h, law.hill.n);
    let (mut stress, mut p, mut last) = ([0.0; 3], 0.0, [0.0; 3]);
    for k in 1..=steps {
        let now = logarithm_of(metric_of(path(f64::from(k) / f64::from(steps))));
        let change = [0, 1, 2].map(|i| now[i] - last[i]);
        last = now;
        let bar = effective(&law.hill, stress);
        let elastic = response(change);
        let mut growth = 0.0;
        let mut flow = [0.0; 3];
        if bar >= law.hardening.stress(p) {
            let [t1, t2, t3] = stress.map(|t| t / bar);
            flow = [along * t1 - h * t2, across * t2 - h * t1, n * t3];
            let resisting = response(flow);
            let work = |a: [f64; 3]| flow[0] * a[0] + flow[1] * a[1] + 2.0 * flow[2] * a[2];
            let slope = (law.hardening.stress(p + 1e-7) - law.hardening.stress(p)) / 1e-7;
            growth = (work(elastic) / (work(resisting) + slope)).max(0.0);
        }
        let plastic = response(flow);
        stress = [0, 1, 2].map(|i| stress[i] + elastic[i] - growth * plastic[i]);
        p += growth;
    }
    (stress, p)
}

/// Second derivatives of the stored energy along random motions against the bound, of film with random plastic strain,
/// stretched and compressed; the plastic strain stays as it is.
#[test]
fn the_bound_holds_at_random_states() {
    let mut random = random(13);
    for law in laws() {
        let mut closest = 0.0_f64;
        for _ in 0..1500 {
            let [first, second] = [0, 1].map(|_| 0.5 * 6.0_f64.powf(random()));
            let f = turned([first, second], [6.3 * random(), 6.3 * random()]);
            let mut history = Point::virgin();
            // An elastic strain of up to twice what the film yields at.
            let strain = Logarithm::from_cauchy_green(&Deformation::from(f).metric()).strain;
            history.strain = strain.map(|total| total + 0.08 * (random() - 0.5));
            let bound = law.stiffness(&Deformation::from(f), &history).any[0];
            let energy = |f: Gradient<1>| law.energy(&Deformation::from(f), &history).stored[0];
            for stiffness in stiffnesses(f, 2e-4 * first.min(second), &mut random, energy) {
                closest = closest.max(stiffness / bound);
                assert!(stiffness <= bound * (1.0 + 1e-4), "{stiffness} over {bound} at {first}, {second}");
            }
        }
        assert!(closest > 0.5, "the bound is {} of the largest stiffness found", 1.0 / closest);
    }
}

/// ∂W/∂F at a fixed plastic strain, by central differences; the stretch variance too.
#[test]
fn stress_is_the_derivative_of_the_stored_energy() {
    let mut random = random(17);
    let law = slow(orthotropic(), table());
    for _ in 0..300 {
        let f = turned([0.7 + random(), 0.5 + random()], [6.3 * random(), 6.3 * random()]);
        let d = Deformation { f, stretch_variance: [one(0.1 * random()), one(0.1 * random())] };
        let mut history = Point::virgin();
        history.strain = Logarithm::from_cauchy_green(&d.metric()).strain.map(|total| total + 0.05 * (random() - 0.5));
        let stress = law.stress_of(&d, &history);
        let energy = |d: &Deformation<1>| law.energy(d, &history).stored[0];
        for fibre in 0..2 {
            for axis in 0..3 {
                let at = |way: f64| {
                    let mut moved = d;
                    moved.f[fibre][axis][0] += 1e-6 * way;
                    energy(&moved)
                };
                let difference = (at(1.0) - at(-1.0)) / 2e-6;
                assert!((difference - stress.p[fibre][axis][0]).abs() < 1e-6 * YOUNG, "{difference}");
            }
            let at = |way: f64| {
                let mut moved = d;
                moved.stretch_variance[fibre][0] += 1e-6 * way;
                energy(&moved)
            };
            let difference = (at(1.0) - at(-1.0)) / 1e-6;
            assert!((difference - stress.tension[fibre][0]).abs() < 1e-6 * YOUNG, "{difference}");
        }
    }
}

/// Work of the forces, by the trapezoidal rule, against what is stored and absorbed, along a closed path that is not
/// proportional, and twice around; steps of half the length leave a quarter of the error.
#[test]
fn energy_is_closed_over_load_cycles() {
    let path = |time: f64| {
        let (s, c) = (std::f64::consts::TAU * time).sin_cos();
        [[1.1 + 0.1 * s, 0.08 * s * c, 0.05 * s], [0.05 * (1.0 - c), 1.05 - 0.05 * c, 0.1 * c]].map(Lane3::splat)
    };
    for law in laws() {
        let error = |steps: u32| {
            let mut history = Point::virgin();
            let mut before = path(0.0);
            let mut stress = step(&law, before, &mut history, 0.0).p;
            let energy = |f: Gradient<1>, history: &Point| {
                let Energy { stored, absorbed } = law.energy(&Deformation::from(f), history);
                stored[0] + absorbed[0]
            };
            let (start, mut work) = (energy(before, &history), 0.0);
            for k in 1..=2 * steps {
                let now = path(f64::from(k) / f64::from(steps));
                let next = step(&law, now, &mut history, 0.5 / f64::from(steps)).p;
                let parts = now.iter().flat_map(|p| &p.0).zip(before.iter().flat_map(|p| &p.0));
                let forces = stress.iter().flat_map(|p| &p.0).zip(next.iter().flat_map(|p| &p.0));
                work += parts.zip(forces).map(|((a, b), (p, q))| 0.5 * (p[0] + q[0]) * (a[0] - b[0])).sum::<f64>();
                (before, stress) = (now, next);
            }
            assert!(history.equivalent[0] > 0.05, "{:?}", history.equivalent);
            ((energy(before, &history) - start) / work - 1.0).abs()
        };
        let [coarse, fine] = [10_000, 20_000].map(error);
        assert!(fine < 1e-6, "{law:?}: {fine}");
        assert!(fine < 0.3 * coarse || fine < 2e-8, "{law:?}: {coarse} {fine}");
    }
}

#[test]
fn rotation_alone_gives_no_stress() {
    let law = slow(orthotropic(), voce());
    let stress = step(&law, turned([1.0, 1.0], [0.4, 0.9]), &mut Point::virgin(), 1.0);
    assert!(stress.p.iter().flat_map(|p| &p.0).all(|p| p[0].abs() < 1e-15 * 10.0 * YOUNG), "{:?}", stress.p);
}

#[test]
fn what_is_no_number_stays_none() {
    for law in laws() {
        let mut history = Point::virgin();
        let mut f = strained([0.1, 0.0, 0.0]);
        f[0][0][0] = f64::NAN;
        let stress = step(&law, f, &mut history, 1e-5);
        assert!(stress.p[0][0][0].is_nan() && stress.p[1][1][0].is_nan());
        assert!(law.energy(&Deformation::from(f), &history).stored[0].is_nan());
        assert!(law.stiffness(&Deformation::from(f), &history).any[0].is_nan());
        assert!(law.thickness_ratio(&Deformation::from(f), &stress)[0].is_nan());
    }
}

/// The logarithmic strain across at which film that is stretched by `along`, the direction `axis`, has no stress
/// across.
fn free_width(law: &Plastic, along: f64, axis: usize, history: &Point, dt: f64) -> f64 {
    let most = 0.6 + along.abs();
    zero(-most, most, |across| {
        let f = strained(if axis == 0 { [along, across, 0.0] } else { [across, along, 0.0] });
        step(law, f, &mut history.clone(), dt).tension[1 - axis][0]
    })
}

/// A strip that is stretched, unloaded, compressed and stretched again: T and the strains by hand, since in uniaxial
/// stress T = σ_y(p)/√(G+H), width by the strain ratio, and a set of E − T/Y is left.
#[test]
fn a_load_cycle_has_its_closed_form() {
    let hardening = voce();
    for hill in [Hill::default(), orthotropic()] {
        for axis in [0, 1] {
            let angle = std::f64::consts::FRAC_PI_2 * axis as f64;
            let (ratio, strain_ratio) = (hill.stress_ratio(angle), hill.strain_ratio(angle));
            let law = slow(hill, hardening.clone());
            let mut history = Point::virgin();
            let (mut plastic, mut p) = (0.0, 0.0_f64);
            let path = [0.01, 0.03, 0.06, 0.25, 0.24, 0.2, 0.15, 0.0, -0.1, -0.05, 0.02, 0.2, 0.4];
            for along in path {
                let across = free_width(&law, along, axis, &history, 0.0);
                let f = strained(if axis == 0 { [along, across, 0.0] } else { [across, along, 0.0] });
                let stress = step(&law, f, &mut history, 0.0);
                // By hand: |T| ≤ ratio σ_y(p), dp = |dE_p| ratio.
                let trial = YOUNG * (along - plastic);
                let flow = |growth: f64| ratio * hardening.stress(p + growth) + YOUNG * growth / ratio - trial.abs();
                let growth = zero(0.0, trial.abs() / YOUNG * ratio, flow);
                plastic += growth / ratio * trial.signum();
                p += growth;
                let expected = YOUNG * (along - plastic);
                let found = work_stress(&law, f, &history);
                assert!((found[axis] - expected).abs() < 1e-9 * YOUNG, "{hill:?} {axis} {along}: {found:?} {expected}");
                assert!(found[1 - axis].abs() < 1e-9 * YOUNG);
                assert!((history.equivalent[0] - p).abs() < 1e-9);
                let narrow = -0.45 * expected / YOUNG - plastic * strain_ratio / (1.0 + strain_ratio);
                assert!((across - narrow).abs() < 1e-9, "{across} {narrow}");
                // Nominal stress: P = T/λ.
                let nominal = stress.p[axis][axis][0];
                assert!((nominal - expected / along.exp()).abs() < 1e-9 * YOUNG);
                // Plastic flow keeps the volume.
                let thickness = law.thickness_ratio(&Deformation::from(f), &stress)[0].ln();
                let through = -0.45 * expected / YOUNG - plastic / (1.0 + strain_ratio);
                assert!((thickness - through).abs() < 1e-9, "{thickness} {through}");
            }
            assert!(p > 0.5, "{p}");
        }
    }
}

/// Equibiaxial tension and pure shear, strains prescribed: closed forms of film with r₀ = r₉₀.
#[test]
fn equibiaxial_tension_and_shear_have_their_closed_forms() {
    let hardening = table();
    let hill = Hill::from_strain_ratios([0.7, 1.6, 0.7]);
    let law = slow(hill, hardening.clone());
    // T = stiffness (strain − E_p) = ratio σ_y(p) with p σ̄ = 2 T E_p, σ̄ = T/ratio.
    let stress = |stiffness: f64, strain: f64, ratio: f64| {
        let off = |plastic: f64| ratio * hardening.stress(2.0 * ratio * plastic) - stiffness * (strain - plastic);
        stiffness * (strain - zero(0.0, strain, off))
    };
    let found = |strains: [f64; 3]| {
        let mut history = Point::virgin();
        step(&law, strained(strains), &mut history, 0.0);
        work_stress(&law, strained(strains), &history)
    };
    for strain in [0.01, 0.05, 0.2, 0.5] {
        let both = stress(YOUNG / (1.0 - 0.45), strain, 1.0 / (hill.f + hill.g).sqrt());
        let sheared = stress(YOUNG / 1.45, strain, 1.0 / (2.0 * hill.n).sqrt());
        let cases = [([strain, strain, 0.0], [both, both, 0.0]), ([0.0, 0.0, strain], [0.0, 0.0, sheared])];
        for (strains, expected) in cases {
            let found = found(strains);
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-9 * YOUNG), "{found:?} for {expected:?}");
        }
    }
}

/// Film at a constant rate of flow carries the flow stress of that rate, slower than the lowest of a table that of the
/// table's first curve.
#[test]
fn the_rate_raises_the_flow_stress() {
    let law = by_rate();
    for rate in [1e-4, 0.3, 20.0, 5e3] {
        let (mut history, steps, mut along) = (Point::virgin(), 600, 0.0);
        let mut before = 0.0;
        for _ in 0..steps {
            along += 0.3 / f64::from(steps);
            before = history.equivalent[0];
            let across = free_width(&law, along, 0, &history, 0.3 / f64::from(steps) / rate);
            step(&law, strained([along, across, 0.0]), &mut history, 0.3 / f64::from(steps) / rate);
        }
        let flowed = (history.equivalent[0] - before) * f64::from(steps) * rate / 0.3;
        assert!(flowed > 0.4 * rate, "{flowed} of {rate}");
        let p = history.equivalent[0];
        let expected = law.flow_stress(p, flowed);
        let found = law.hardening.stress(p) + history.overstress[0];
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

/// One step of virgin film, of any length and strain, ends at the flow stress of the rate of that step: no product overflows, and
/// no search ends early.
#[test]
fn a_step_ends_at_the_flow_stress_of_its_rate() {
    let law = by_rate();
    for (strain, dt) in [0.06, 0.1, 0.7, 3.0].into_iter().flat_map(|e| [1e-9, 1e-6, 1e-3, 1.0, 1e3].map(|dt| (e, dt))) {
        let (f, mut history) = (strained([strain, -0.4 * strain, 0.2 * strain]), Point::virgin());
        step(&law, f, &mut history, dt);
        let growth = history.equivalent[0];
        let found = effective(&law.hill, work_stress(&law, f, &history));
        assert!(growth > 0.0 && found.is_finite(), "{strain} {dt}: {growth} {found}");
        let expected = law.flow_stress(growth, growth / dt);
        assert!((found / expected - 1.0).abs() < 1e-8, "{strain} {dt}: {found} {expected}");
    }
}
