//! A strip that is stiff beside the springs on which it hangs, against the motion of a rigid body.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::{Engine, Film, Loads, Mesh, Nodes, Section, Spring, SpringLaw, Springs};
use crate::material::{Elastic, Law};

/// Half the length and the width of the strip, m; elements along it.
const HALF: f64 = 0.1;
const WIDTH: f64 = 0.02;
const ELEMENTS: u32 = 12;
const THICKNESS: f64 = 1e-3;
const DENSITY: f64 = 1000.0;
/// kg.
const STRIP: f64 = 2.0 * HALF * WIDTH * THICKNESS * DENSITY;
/// Springs at each end, their stiffness (N/m), mass (kg) and length as mounted (m).
const COUNT: usize = 3;
const STIFFNESS: f64 = 10.0;
const MASS: f64 = 6e-4;
const LENGTH: f64 = 0.05;
/// Mass that moves, kg: Rayleigh's third of each spring.
const MOVING: f64 = STRIP + 2.0 * COUNT as f64 * MASS / 3.0;

/// The strip between springs at both ends with this `preload` (N) and `damping` (N s/m) of each, at a velocity (m/s) along
/// it.
fn engine(preload: f64, damping: f64, velocity: impl Fn(f64) -> Vector3<f64>) -> Engine {
    hung(SpringLaw::linear(STIFFNESS, false), preload, [damping, MASS], velocity)
}

/// The strip between springs of a `law`, with a dashpot and a mass of each.
fn hung(law: SpringLaw, preload: f64, of_each: [f64; 2], velocity: impl Fn(f64) -> Vector3<f64>) -> Engine {
    let at = |n: u32, y: f64| Point3::new((f64::from(n) / f64::from(ELEMENTS) * 2.0 - 1.0) * HALF, y, 0.0);
    let places = (0..=ELEMENTS).flat_map(|n| [at(n, -0.5 * WIDTH), at(n, 0.5 * WIDTH)]).collect();
    let quads = (0..ELEMENTS).map(|n| [2 * n, 2 * n + 2, 2 * n + 3, 2 * n + 1]).collect();
    let mesh = Mesh { nodes: places, quads, ..Mesh::default() };
    let section = Section::new(Law::Elastic(Elastic { young: 1e9, poisson: 0.3 }), DENSITY, THICKNESS);
    let mut nodes = Nodes::default();
    let film = Film::mount(&mesh, &section, 0.0, &mut nodes).expect("a film");
    (0..nodes.mass.len()).for_each(|n| nodes.velocity.set(n, velocity(nodes.position_of(n).x).into()));
    let unstretched = LENGTH - law.elongation_at(preload);
    let last = 2 * ELEMENTS as usize;
    let springs = [([0, 1], -1.0), ([last, last + 1], 1.0)].into_iter().flat_map(|(ends, side)| {
        (0..COUNT).map(move |number| {
            let share = (number as f64 + 0.5) / COUNT as f64;
            let anchor = Point3::new(side * (HALF + LENGTH), (share - 0.5) * WIDTH, 0.0);
            Spring { nodes: ends, shares: [1.0 - share, share], anchor, unstretched, count: 1.0 }
        })
    });
    let springs = Springs::new(springs.collect(), law, of_each, 1.0);
    let loads = Loads { multiplicity: 1.0, step_factor: 1.0, ..Loads::default() };
    Engine::new(vec![film], nodes, [], loads).with_springs(springs)
}

/// The strip at a step.
struct Step {
    time: f64,
    /// Of its middle along the axis, m.
    position: f64,
    /// Of all mass half a step later, kg m/s.
    momentum: f64,
    /// Force of the springs on the frame along the axis, N.
    frame: f64,
    /// J.
    energy: f64,
}

/// The steps until `end` (s), along an axis.
fn steps(engine: &mut Engine, axis: usize, end: f64) -> Vec<Step> {
    let all: Vec<usize> = (0..2 * COUNT).collect();
    let mut steps = vec![];
    while engine.time() < end {
        let step = engine.read_step(|view| {
            let nodes = view.nodes;
            let momentum = |n: usize| nodes.mass[n] * nodes.velocity.value_at(n)[axis];
            Step {
                time: view.time,
                position: (0..nodes.mass.len()).map(|n| nodes.position.value_at(n)[axis]).sum::<f64>()
                    / nodes.mass.len() as f64,
                momentum: (0..nodes.mass.len()).map(momentum).sum(),
                frame: view.spring_force_of(&all, axis).expect("springs"),
                energy: view.energies().total(),
            }
        });
        steps.push(step.expect("a step"));
    }
    steps
}

/// Times at which the strip passes the middle upwards, s.
fn passes(steps: &[Step]) -> Vec<f64> {
    let pairs = steps.array_windows().filter(|[a, b]| a.position < 0.0 && b.position >= 0.0);
    pairs.map(|[a, b]| a.time - a.position * (b.time - a.time) / (b.position - a.position)).collect()
}

fn period(steps: &[Step]) -> f64 {
    let passes = passes(steps);
    (passes[passes.len() - 1] - passes[0]) / (passes.len() - 1) as f64
}

/// Along the springs both sides are taut: ω² = 2nk/M. Across them, in the plane, they are pendulums under tension:
/// ω² = 2nF/(ℓM).
#[test]
fn frequencies_are_those_of_a_rigid_body_on_springs() {
    // Across, so slow that the strip hardly bends in its plane, and so narrow that the springs hardly lengthen.
    for (axis, preload, stiffness, amplitude) in [(0, 0.2, STIFFNESS, 1e-3), (1, 0.01, 0.01 / LENGTH, 2e-4)] {
        let expected = TAU * (MOVING / (2.0 * COUNT as f64 * stiffness)).sqrt();
        let mut velocity = Vector3::zeros();
        velocity[axis] = amplitude * TAU / expected;
        let steps = steps(&mut engine(preload, 0.0, |_| velocity), axis, 2.5 * expected);
        let found = period(&steps);
        println!("axis {axis}: period off by {:.1e}", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 2e-3, "axis {axis}: {found} for {expected}");
    }
}

/// Out of its plane the strip is a string under the force S of its springs, which are pendulums of the stiffness S/ℓ at
/// its ends, with a third of their mass: of the symmetric mode cos βx, S β tan βa = S/ℓ − m ω², with ω² = β² S/µ.
#[test]
fn a_strip_swings_on_its_springs_as_a_string_does() {
    let preload = 0.2;
    let force = COUNT as f64 * preload;
    let (line, end) = (STRIP / (2.0 * HALF), COUNT as f64 * MASS / 3.0);
    let excess = |wave: f64| force * wave * (wave * HALF).tan() + end * wave * wave * force / line - force / LENGTH;
    let (mut low, mut high) = (0.0, 0.25 * TAU / HALF * (1.0 - 1e-12));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { high = middle } else { low = middle }
    }
    let expected = TAU / (low * (force / line).sqrt());
    // An amplitude of 0.5 % of the length of a spring.
    let velocity = |x: f64| Vector3::z() * (2.5e-4 * TAU / expected * (low * x).cos());
    let steps = steps(&mut engine(preload, 0.0, velocity), 2, 4.5 * expected);
    let found = period(&steps);
    println!("string: period off by {:.1e}", found / expected - 1.0);
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} for {expected}");
}

/// x = e^(−δt) … with δ = 2nc/(2M), counted over whole periods.
#[test]
fn dashpots_damp_a_mass_as_they_should() {
    let damping = 0.02;
    let rate = COUNT as f64 * damping / MOVING;
    let natural = (2.0 * COUNT as f64 * STIFFNESS / MOVING).sqrt();
    let expected = TAU / (natural * natural - rate * rate).sqrt();
    let mut engine = engine(0.2, damping, |_| Vector3::new(0.1, 0.0, 0.0));
    let steps = steps(&mut engine, 0, 4.5 * expected);
    assert!((period(&steps) / expected - 1.0).abs() < 2e-3);
    let peak = |from: f64| {
        let within = steps.iter().filter(|step| (from..from + expected).contains(&step.time));
        within.map(|step| step.position).fold(0.0, f64::max)
    };
    let found = (peak(0.0) / peak(3.0 * expected)).ln() / (3.0 * expected);
    println!("decay off by {:.1e}", found / rate - 1.0);
    assert!((found / rate - 1.0).abs() < 1e-2, "{found} for {rate}");
    let (first, last) = (&steps[0], &steps[steps.len() - 1]);
    let exchanged = 0.5 * MOVING * 0.01;
    assert!(((last.energy - first.energy) / exchanged).abs() < 1e-3, "{} from {}", last.energy, first.energy);
}

/// A strip thrown so far that one side goes slack: Δp of each kick is the impulse of the springs, and energy is constant.
#[test]
fn momentum_and_energy_balance_with_slack_springs() {
    for damping in [0.0, 0.05] {
        let velocity = Vector3::new(1.5, 0.0, 0.7);
        let mut engine = engine(0.05, damping, |_| velocity);
        let mut slack = 0.0;
        while engine.time() < 0.05 {
            slack =
                f64::max(slack, engine.read_step(|view| view.springs_state().expect("springs").slack).expect("a step"));
        }
        assert_eq!(slack, 0.5, "those of one side are slack");
        let mut engine = self::engine(0.05, damping, |_| velocity);
        let steps = steps(&mut engine, 0, 0.3);
        for [before, now, after] in steps.array_windows() {
            let impulse = -now.frame * 0.5 * (after.time - before.time);
            let change = now.momentum - before.momentum;
            assert!((change - impulse).abs() < 1e-12 * MOVING, "{change} for {impulse} at {}", now.time);
        }
        let exchanged = 0.5 * MOVING * velocity.norm_squared();
        let gaps = steps.iter().map(|step| (step.energy - steps[0].energy).abs());
        let gap = gaps.fold(0.0, f64::max) / exchanged;
        println!("energy with slack springs off by {gap:.1e}");
        assert!(gap < 1e-3, "energy is off by {gap}");
    }
}

/// Springs of much stiffness and no mass on light film: the step bounds their frequency (theory.md, equation 344).
#[test]
fn stiff_springs_shorten_the_step() {
    let massless = |stiffness: f64, damping: f64, velocity: Vector3<f64>| {
        hung(SpringLaw::linear(stiffness, true), 0.0, [damping, 0.0], |_| velocity)
    };
    let step = |stiffness: f64, damping: f64| massless(stiffness, damping, Vector3::zeros()).time_step();
    let free = step(1e-9, 0.0);
    assert!(step(1e8, 0.0) < 0.5 * free && step(1.0, 1e4) < 0.5 * free);
    for (stiffness, damping) in [(1e8, 0.0), (1.0, 1e4), (1e8, 1e3)] {
        let mut engine = massless(stiffness, damping, Vector3::new(0.1, 0.0, 0.1));
        let start = engine.read_step(|view| view.energies().total()).expect("a step");
        for _ in 0..5000 {
            engine.step(&mut super::Unobserved).expect("a step");
        }
        let end = engine.read_step(|view| view.energies().total()).expect("a step");
        let exchanged = 0.5 * STRIP * 0.02;
        assert!(((end - start) / exchanged).abs() < 2e-2, "{stiffness} {damping}: {end} from {start}");
    }
}
