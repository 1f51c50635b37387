//! A strip that is stiff beside the springs on which it hangs, against the motion of a rigid body.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::{Engine, Film, Loads, Mesh, Nodes, Section, Spring, Springs};
use crate::material::{Elastic, Law};

/// Half the length and the width of the strip, m; elements along it.
const HALF: f64 = 0.1;
const WIDTH: f64 = 0.02;
const ELEMENTS: u32 = 12;
const THICKNESS: f64 = 1e-3;
const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 1e9;
/// kg.
const STRIP: f64 = 2.0 * HALF * WIDTH * THICKNESS * DENSITY;
/// Springs at each end, their stiffness (N/m) and length as mounted (m).
const COUNT: usize = 3;
const STIFFNESS: f64 = 10.0;
const LENGTH: f64 = 0.05;

/// The strip between springs at both ends of this `stiffness` (N/m) and `preload` (N) each, at a velocity (m/s) along it.
fn engine(stiffness: f64, preload: f64, velocity: impl Fn(f64) -> Vector3<f64>) -> Engine {
    hung([stiffness, preload], 0.0, velocity)
}

/// The same, mounted with a `strain` along it, across as it then contracts.
fn hung([stiffness, preload]: [f64; 2], strain: f64, velocity: impl Fn(f64) -> Vector3<f64>) -> Engine {
    let at = |n: u32, y: f64| Point3::new((f64::from(n) / f64::from(ELEMENTS) * 2.0 - 1.0) * HALF, y, 0.0);
    let places = (0..=ELEMENTS).flat_map(|n| [at(n, -0.5 * WIDTH), at(n, 0.5 * WIDTH)]).collect();
    let quads = (0..ELEMENTS).map(|n| [2 * n, 2 * n + 2, 2 * n + 3, 2 * n + 1]).collect();
    let mesh = Mesh { nodes: places, quads, ..Mesh::default() };
    let mut section = Section::new(Law::Elastic(Elastic { young: YOUNG, poisson: 0.3 }), DENSITY, THICKNESS);
    section.prestrain = [strain, -0.3 * strain];
    let mut nodes = Nodes::default();
    let film = Film::mount(&mesh, &section, 0.0, &mut nodes).expect("a film");
    (0..nodes.mass.len()).for_each(|n| nodes.velocity.set(n, velocity(nodes.position_of(n).x).into()));
    let unstretched = LENGTH - preload / stiffness;
    let last = 2 * ELEMENTS as usize;
    let springs = [([0, 1], -1.0), ([last, last + 1], 1.0)].into_iter().flat_map(|(ends, side)| {
        (0..COUNT).map(move |number| {
            let share = (number as f64 + 0.5) / COUNT as f64;
            let anchor = Point3::new(side * (HALF + LENGTH), (share - 0.5) * WIDTH, 0.0);
            Spring { nodes: ends, shares: [1.0 - share, share], anchor, unstretched }
        })
    });
    let springs = Springs::new(springs.collect(), stiffness, 1.0);
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
                frame: view.springs().expect("springs").frame_force(all.iter().copied(), axis),
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
        let expected = TAU * (STRIP / (2.0 * COUNT as f64 * stiffness)).sqrt();
        let mut velocity = Vector3::zeros();
        velocity[axis] = amplitude * TAU / expected;
        let steps = steps(&mut engine(STIFFNESS, preload, |_| velocity), axis, 2.5 * expected);
        let found = period(&steps);
        println!("axis {axis}: period off by {:.1e}", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 2e-3, "axis {axis}: {found} for {expected}");
    }
}

/// Out of its plane the strip is a string under the force S of its springs, which are pendulums of the stiffness S/ℓ at
/// its ends: of the symmetric mode cos βx, β tan βa = 1/ℓ, with ω² = β² S/µ.
#[test]
fn a_strip_swings_on_its_springs_as_a_string_does() {
    let preload = 0.2;
    let force = COUNT as f64 * preload;
    let line = STRIP / (2.0 * HALF);
    let excess = |wave: f64| wave * (wave * HALF).tan() - 1.0 / LENGTH;
    let (mut low, mut high) = (0.0, 0.25 * TAU / HALF * (1.0 - 1e-12));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { high = middle } else { low = middle }
    }
    let expected = TAU / (low * (force / line).sqrt());
    // An amplitude of 0.5 % of the length of a spring.
    let velocity = |x: f64| Vector3::z() * (2.5e-4 * TAU / expected * (low * x).cos());
    let steps = steps(&mut engine(STIFFNESS, preload, velocity), 2, 4.5 * expected);
    let found = period(&steps);
    println!("string: period off by {:.1e}", found / expected - 1.0);
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} for {expected}");
}

/// A strip thrown so far that one side goes slack: Δp of each kick is the impulse of the springs, and energy is constant.
#[test]
fn momentum_and_energy_balance_with_slack_springs() {
    let velocity = Vector3::new(1.5, 0.0, 0.7);
    let mut first = engine(STIFFNESS, 0.05, |_| velocity);
    let mut slack = 0.0;
    while first.time() < 0.05 {
        slack = f64::max(
            slack,
            first.read_step(|view| view.springs().expect("springs").state(view.nodes).slack).expect("a step"),
        );
    }
    assert_eq!(slack, 0.5, "those of one side are slack");
    let steps = steps(&mut engine(STIFFNESS, 0.05, |_| velocity), 0, 0.3);
    for [before, now, after] in steps.array_windows() {
        let impulse = -now.frame * 0.5 * (after.time - before.time);
        let change = now.momentum - before.momentum;
        assert!((change - impulse).abs() < 1e-12 * STRIP, "{change} for {impulse} at {}", now.time);
    }
    let exchanged = 0.5 * STRIP * velocity.norm_squared();
    let gaps = steps.iter().map(|step| (step.energy - steps[0].energy).abs());
    let gap = gaps.fold(0.0, f64::max) / exchanged;
    println!("energy with slack springs off by {gap:.1e}");
    assert!(gap < 1e-3, "energy is off by {gap}");
}

/// Stiff springs on light film: the step bounds their frequency (theory.md, equation 344).
#[test]
fn stiff_springs_shorten_the_step() {
    let step = |stiffness: f64| engine(stiffness, 0.0, |_| Vector3::zeros()).time_step();
    assert!(step(1e8) < 0.5 * step(1e-9));
    // As taut as the film, so that none goes slack.
    let strain = 1e-3;
    let preload = YOUNG * strain * THICKNESS * WIDTH / COUNT as f64;
    let velocity = Vector3::new(0.01, 0.0, 0.01);
    let mut engine = hung([1e8, preload], strain, |_| velocity);
    let start = engine.read_step(|view| view.energies().total()).expect("a step");
    for _ in 0..5000 {
        engine.step(&mut super::Unobserved).expect("a step");
    }
    let end = engine.read_step(|view| view.energies().total()).expect("a step");
    let exchanged = 0.5 * STRIP * velocity.norm_squared();
    assert!(((end - start) / exchanged).abs() < 2e-2, "{end} from {start}");
}
