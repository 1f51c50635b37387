//! Viscous film in runs: a coupon at a constant rate, film that is held, a mass caught by film, a drop.

use std::f64::consts::PI;

use droptower::engine::{Engine, Loads, Nodes};
use droptower::material::{Elastic, Law, Material, PronyTerm, Viscosity};
use droptower::mesh::Element;
use droptower::simulate;

use super::claims::Claims;
use super::scene::{mounted, observe_step, positions};
use super::sheet;
use super::solve::runge_kutta;
use super::tower::{channel, run, shipped};

const YOUNG: f64 = 50e6;

fn series(terms: &[[f64; 2]]) -> Viscosity {
    Viscosity::new(terms.iter().map(|[share, time]| PronyTerm { share: *share, time: *time }).collect())
        .expect("a series")
}

/// Viscous elastic film in place of the shipped fabric.
const VISCOUS: &str = r#"specimen.material={ density = 915, thickness = 12e-6, elastic = { young = 50e6, poisson = 0.44 }, prony = [{ share = 0.3, time = 0.05 }, { share = 0.2, time = 0.5 }] }"#;

/// S = Ē ( e + e²/2 ) of film that is as wide as its jaws, with e = v t/L: of S° = a t + b t² a term leaves
/// a ( t − τ + τ x ) + b ( t² − 2 τ t + 2 τ² − 2 τ² x ), x = e^(−t/τ).
#[test]
fn a_coupon_at_constant_rate_has_the_stress_of_the_hereditary_integral() {
    let mut claims = Claims::of("viscous, constant rate");
    for velocity in [0.002, 0.02] {
        let changes = [VISCOUS, &format!("loading.stretch.velocity={velocity}"), "loading.stretch.until=0.5"];
        let model = shipped("stretch/single-element.toml", &changes);
        let outcome = run(&model);
        let [strains, stress] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
        let rate = velocity / 0.005;
        let modulus = YOUNG / (1.0 - 0.44 * 0.44);
        let exact = |strain: f64| {
            let t = strain / rate;
            let (a, b) = (modulus * rate, 0.5 * modulus * rate * rate);
            let relaxed = |[share, time]: [f64; 2]| {
                let x = (-t / time).exp();
                let (first, second) = (t - time + time * x, t * t - 2.0 * time * (t - time + time * x));
                share * (a * first + b * second)
            };
            let s = a * t + b * t * t - [[0.3, 0.05], [0.2, 0.5]].map(relaxed).iter().sum::<f64>();
            (1.0 + strain) * s
        };
        let samples = strains.iter().zip(stress).filter(|(strain, _)| **strain > 0.02);
        let apart = samples.map(|(strain, stress)| (stress / exact(*strain) - 1.0).abs()).fold(0.0, f64::max);
        claims.at_most(&format!("{velocity} m/s, stress off the closed form"), apart, 1e-3);
        claims.at_most(&format!("{velocity} m/s, energy balance error"), outcome.energy_balance_error, 1e-3);
        let pulled = simulate::pull(&model, strains, simulate::Across::Held).expect("a pull");
        let samples = strains.iter().zip(stress.iter().zip(&pulled)).filter(|(strain, _)| **strain > 0.02);
        let apart = samples.map(|(_, (run, pulled))| (run / pulled - 1.0).abs()).fold(0.0, f64::max);
        claims.at_most(&format!("{velocity} m/s, stress off the quasi-static one"), apart, 1e-3);
    }
}

/// Under a volume that no longer changes the shape stays, so that the pressure relaxes as the stress does.
#[test]
fn the_pressure_of_a_held_volume_relaxes_by_the_series() {
    let mut claims = Claims::of("viscous, relaxation");
    let outcome = run(&shipped("../tests/golden/inflation-viscous/scenario.toml", &[]));
    let [time, pressure] = [&outcome.signals.time[..], channel(&outcome.signals, "pressure_Pa")];
    // The golden case: neo-Hookean film filled in 100 ms, 30 % with 20 ms. Long after filling, one decay is left.
    let at = |wanted: f64| {
        let after = time.partition_point(|t| *t < wanted - 1e-9);
        pressure[after]
    };
    let [first, second, third] = [0.105, 0.125, 0.145].map(at);
    let ratio = (second - third) / (first - second);
    claims.near("decay of the pressure within a relaxation time", ratio, (-1.0_f64).exp(), 1e-2);
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-3);
}

/// A mass on a strip of film without Poisson's ratio, which it strains alone: speed and state of the branches by the
/// method of Runge and Kutta, from the mass's speed at the start to its return.
struct Caught {
    stiffness: f64,
    mass: f64,
    terms: [[f64; 2]; 2],
}

impl Caught {
    /// x, v and q of both branches, differentiated by time.
    fn slope(&self, [x, v, first, second]: [f64; 4]) -> [f64; 4] {
        let long_term = 1.0 - self.terms[0][0] - self.terms[1][0];
        let force = self.stiffness * long_term * x + first + second;
        let rate = |q: f64, [share, time]: [f64; 2]| self.stiffness * share * v - q / time;
        [v, -force / self.mass, rate(first, self.terms[0]), rate(second, self.terms[1])]
    }

    /// Time and speed at each of the first `count` returns of a mass that starts with `speed`.
    fn returns(&self, speed: f64, count: usize) -> Vec<[f64; 2]> {
        let mut y = [0.0, speed, 0.0, 0.0];
        let dt = 1e-4 * PI / (self.stiffness / self.mass).sqrt();
        let (mut time, mut found) = (0.0, vec![]);
        while found.len() < count {
            let next = runge_kutta(&|_, y| self.slope(y), time, y, dt);
            if next[0] * y[0] < 0.0 {
                let part = y[0] / (y[0] - next[0]);
                found.push([time + part * dt, y[1] + part * (next[1] - y[1])]);
            }
            (y, time) = (next, time + dt);
        }
        found
    }
}

#[test]
fn film_that_catches_a_mass_absorbs_by_its_loss_modulus() {
    let mut claims = Claims::of("viscous, mass caught");
    let (length, width, thickness) = (0.1, 0.1, 12e-6);
    let stiffness = YOUNG * thickness * width / length;
    for (mass, terms) in [
        (10.0, [[0.02, 0.13], [0.01, 0.03]]),
        (0.1, [[0.02, 0.013], [0.01, 0.003]]),
        (1.0, [[0.1, 0.04], [0.05, 0.01]]),
    ] {
        let law = Law::Elastic(Elastic { young: YOUNG, poisson: 0.0 });
        let viscosity = Some(series(&terms));
        let material = Material { viscosity, ..Material::new(law, 1.0, thickness) };
        let face = sheet::face(material, Element::Quad4, [0.0; 2]);
        let mesh = sheet::sheet([1, 1], Element::Quad4, 0.0, |[u, v]| [length * u, width * v]);
        let (film, light) = mounted(&mesh, &face);
        let mut nodes = Nodes::default();
        let is_right = |x: &[f64; 3]| x[0] > 0.5 * length;
        let masses: Vec<f64> = positions(&light).iter().map(|x| if is_right(x) { 0.5 * mass } else { 1.0 }).collect();
        nodes.extend(positions(&light), &masses);
        let speed = 1e-4 * length * (stiffness / mass).sqrt();
        for (n, x) in positions(&light).iter().enumerate() {
            nodes.hold([n], [!is_right(x), true, true]);
            if is_right(x) {
                nodes.velocity.set(n, [speed, 0.0, 0.0]);
            }
        }
        let loads = Loads { multiplicity: 1.0, ..Loads::default() };
        let mut engine = Engine::new(vec![film], nodes, [], loads);
        let (mut last, mut returns) = ([0.0; 5], vec![]);
        while returns.len() < 9 {
            let now = observe_step(&mut engine, |view| {
                let right = positions(view.nodes).iter().position(is_right).expect("a node");
                let energies = view.energies();
                let displacement = view.nodes.position.value_at(right)[0] - length;
                [view.time, displacement, energies.kinetic_film, energies.stored, energies.absorbed]
            });
            if now[1] * last[1] < 0.0 {
                let part = last[1] / (last[1] - now[1]);
                returns.push([0, 2, 3, 4].map(|i| last[i] + part * (now[i] - last[i])));
            }
            last = now;
        }
        let start = 0.5 * mass * speed * speed;
        let [time, kinetic, _, absorbed] = returns[0];
        let exact = Caught { stiffness, mass, terms }.returns(speed, 9);
        let what = |claim: &str| format!("{mass} kg, {claim}");
        claims.near(&what("time of the return"), time, exact[0][0], 1e-3);
        claims.near(&what("speed at the return"), (kinetic / start).sqrt(), exact[0][1].abs() / speed, 1e-3);
        // What the branches still store is not absorbed yet.
        claims.at_most(&what("absorbed over lost energy at the return"), absorbed / (start - kinetic), 1.0);
        // Once the film has settled to the oscillation, four half cycles: kinetic energy and energy in all fall alike.
        let [[from, before, stored, absorbed_before], [to, after, _, absorbed_after]] = [returns[4], returns[8]];
        let lost = 1.0 - after / before;
        let expected = 1.0 - (exact[8][1] / exact[4][1]).powi(2);
        claims.near(&what("energy lost in two cycles"), lost, expected, 1e-5);
        let absorbed = (absorbed_after - absorbed_before) / (before + stored);
        claims.near(&what("energy absorbed in two cycles"), absorbed, expected, 1e-5);
        // The loss modulus is that of an oscillation that does not decay: to first order in tan δ it is the same.
        let omega = 4.0 * PI / (to - from);
        let x = |[_, time]: [f64; 2]| omega * time;
        let loss: f64 = terms.iter().map(|term| term[0] * x(*term) / (1.0 + x(*term).powi(2))).sum();
        let storage = 1.0 - terms.iter().map(|term| term[0] / (1.0 + x(*term).powi(2))).sum::<f64>();
        let tangent = loss / storage;
        let by_modulus = 1.0 - (-4.0 * PI * tangent).exp();
        let claim = what("energy lost off 1 - exp(-4 pi tan δ), over tan δ of it");
        claims.at_most(&claim, (lost / by_modulus - 1.0).abs() / tangent, 0.5);
    }
}

/// The shipped drop: energies close, film without series is met by one whose terms are far slower than the test, and a
/// stiffer film is caught earlier.
#[test]
fn a_drop_on_viscous_film_keeps_its_energy() {
    let mut claims = Claims::of("viscous, drop");
    let of = |change: &str| {
        let outcome = run(&shipped("../tests/golden/drop-viscous/scenario.toml", &[change]));
        let displacement = channel(&outcome.signals, "displacement_m").iter().copied().fold(0.0, f64::min);
        (outcome.energy_balance_error, -displacement)
    };
    let slow = "specimen.material.prony=[{ share = 0.4, time = 1e6 }]";
    let cases = [of("specimen.rest=\"1 s\""), of(slow), of("specimen.material.prony=[{ share = 0.4, time = 1e-9 }]")];
    for (number, (error, _)) in cases.iter().enumerate() {
        claims.at_most(&format!("energy balance error, case {number}"), *error, 1e-3);
    }
    let [between, stiff, soft] = cases.map(|(_, depth)| depth);
    claims.holds("depth", &format!("{stiff:.4} < {between:.4} < {soft:.4} m"), stiff < between && between < soft);
}
