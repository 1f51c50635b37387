//! Contact: momentum, sticking, sliding.

use std::collections::BTreeMap;

use droptower::engine::View;
use nalgebra::Vector3;

use super::claims::Claims;
use super::scene::{Scene, observe_step, positions};
use super::tower::{channel, loading_of_1008, run};

/// A free film under the eccentric impact of a light sphere, without gravity.
const ADRIFT: [&str; 9] = [
    "specimen.symmetry=none",
    "frame.hold=none",
    "layers.prestrain.md=0.0",
    "impactor.mass=0.05",
    "impactor.position=[0.03, 0.02]",
    "loading.impact.gravity=0",
    "loading.impact.duration=10ms",
    "impactor.friction=0.4",
    "impactor.shape.sphere.radius=120mm",
];

/// Radius of that sphere, m.
const SMALL: f64 = 0.12;

/// Momentum and angular momentum about the origin of film and impactor, and the film's share of the first. Positions
/// belong to the full step and velocities to the half step after it, which does not matter to x × v.
fn momenta(view: &View<'_>) -> [Vector3<f64>; 3] {
    let body = view.bodies().next().expect("a body");
    let inertia = 0.4 * body.mass * SMALL * SMALL;
    let mut film = [Vector3::zeros(); 2];
    for (n, x) in positions(view.nodes).into_iter().enumerate() {
        let momentum = view.nodes.velocity_of(n) * view.nodes.mass[n];
        film[0] += momentum;
        film[1] += Vector3::from(x).cross(&momentum);
    }
    let own = body.velocity * body.mass;
    [film[0] + own, film[1] + body.centre().coords.cross(&own) + body.spin * inertia, film[0]]
}

/// The momentum of film and impactor is conserved in every step to round-off, with and without spin.
#[test]
fn momentum_is_conserved_in_every_step() {
    let mut claims = Claims::of("momentum");
    for (guide, axes, spin) in [("free", 0..3, [0.0; 3]), ("free", 0..3, [40.0, -25.0, 60.0]), ("z", 2..3, [0.0; 3])] {
        let what = |claim: &str| format!("guide {guide}, spin {spin:?} rad/s, {claim}");
        let model = loading_of_1008(&[&ADRIFT[..], &[&format!("impactor.guide={guide}")]].concat());
        let mut scene = Scene::spinning(&model, spin.into());
        let start = 0.05 * 4.16;
        let mut last: Option<[Vector3<f64>; 3]> = None;
        let [mut drift, mut event, mut angular, mut taken] = [0.0_f64; 4];
        let mut sum = Vector3::zeros();
        while scene.engine.time() < 0.01 {
            let now = observe_step(&mut scene.engine, momenta);
            if let Some(last) = last {
                let [change, moment] = [0, 1].map(|i| now[i] - last[i]);
                let largest = axes.clone().map(|axis| change[axis].abs()).fold(0.0, f64::max);
                event = event.max(largest / start);
                sum += moment;
                angular = angular.max(sum.norm() / (start * SMALL));
            }
            let whole = now[0] + Vector3::new(0.0, 0.0, start);
            drift = axes.clone().map(|axis| whole[axis].abs() / start).fold(drift, f64::max);
            taken = taken.max(now[2].norm() / start);
            last = Some(now);
        }
        claims.at_most(&what("change of momentum in a step"), event, 1e-14);
        claims.at_most(&what("drift of film + impactor"), drift, 1e-12);
        claims.holds(&what("share of the film"), &format!("{taken:.3}"), taken > 0.01);
        if guide == "free" {
            claims.at_most(&what("drift of angular momentum over m v R"), angular, 1e-5);
        }
        if spin == [0.0; 3] {
            claims.at_most(&what("energy balance error"), run(&model).energy_balance_error, 1e-3);
        }
    }
}

#[test]
fn the_contact_force_decelerates_the_impactor() {
    let mut claims = Claims::of("impulse");
    let outcome = run(&loading_of_1008(&[]));
    let [force, velocity] = ["contact_force_N", "velocity_m_s"].map(|name| channel(&outcome.signals, name));
    let sample = outcome.signals.time[1];
    let count = force.len() - 1;
    let impulse: f64 = force.windows(2).map(|f| 0.5 * (f[0] + f[1]) * sample).sum();
    let change = 10.72 * (velocity[count] - velocity[0] + 9.81 * sample * count as f64);
    claims.near("integral of the force, N s", impulse, change, 1e-3);
}

/// Distance from the sphere within which a node is in contact itself, and not as a corner of an element, m.
const NODE_CONTACT: f64 = 2e-4;

/// Radius of [`ROUND`], m.
const RADIUS: f64 = 0.3;

/// A sphere so large relative to the elements that there is node contact alone.
const ROUND: [&str; 5] = [
    "impactor.shape.sphere.radius=300mm",
    r#"specimen.shape={ rectangle = ["1 m", "1 m"] }"#,
    "specimen.mesh.size=20mm",
    "impactor.mass=5kg",
    "loading.impact.duration=150ms",
];

/// Largest slip of a node near the pole of the sphere during its contact, over the radius; the search ends at `enough`,
/// or at the lowest point.
fn creep(friction: &str, enough: f64) -> f64 {
    let model = loading_of_1008(&[&ROUND[..], &[&format!("impactor.friction={friction}")]].concat());
    let mut scene = Scene::impact(&model);
    let mut since: BTreeMap<usize, (u32, Vector3<f64>)> = BTreeMap::new();
    let mut farthest = 0.0_f64;
    loop {
        let (falling, arms) = observe_step(&mut scene.engine, |view| {
            let body = view.bodies().next().expect("a body");
            let arm = |n: &usize| Vector3::from(view.nodes.position.value_at(*n)) - body.pose.translation.vector;
            let arms: BTreeMap<usize, Vector3<f64>> = view
                .nodes_in_contact()
                .iter()
                .map(|n| (*n, arm(n)))
                .filter(|(_, arm)| arm.norm() < RADIUS + NODE_CONTACT)
                .collect();
            (body.velocity.z < 0.0, arms)
        });
        if !falling || farthest > enough {
            return farthest;
        }
        since.retain(|n, _| arms.contains_key(n));
        for (n, arm) in arms.into_iter().filter(|(_, arm)| -arm.z > 0.8 * arm.norm()) {
            let (steps, place) = since.entry(n).or_insert((0, arm));
            *steps += 1;
            // The first step of contact ends on the surface.
            if *steps == 2 {
                *place = arm;
            }
            farthest = farthest.max((arm - *place).norm() / RADIUS * f64::from(u8::from(*steps > 1)));
        }
    }
}

#[test]
fn sticking_nodes_do_not_creep() {
    let mut claims = Claims::of("sticking");
    claims.at_most("drift of nodes near the pole over the radius, friction 10", creep("10", 1.0), 1e-3);
    let sliding = creep("0", 2e-2);
    claims.holds("the same without friction", &format!("{sliding:.3e}"), sliding > 1e-2);
}

#[test]
fn friction_dissipates_energy() {
    let mut claims = Claims::of("friction");
    let mut losses = vec![];
    for friction in thorough::first(3, ["0", "0.1", "10", "0.4"]) {
        // Film that sticks wants the finer mesh.
        let is_coarse = friction != "10" && !thorough::thorough();
        let size = if is_coarse { "specimen.mesh.size=20mm" } else { "specimen.mesh.size=10mm" };
        let outcome = run(&loading_of_1008(&[size, &format!("impactor.friction={friction}")]));
        let lost = channel(&outcome.energies, "friction_J");
        let returned = lost.windows(2).map(|w| w[0] - w[1]).fold(0.0, f64::max);
        let impact = 0.5 * 10.72 * 4.16 * 4.16;
        let claim = format!("friction {friction}, energy returned over that of the impact");
        claims.at_most(&claim, returned / impact, 1e-9);
        losses.push(lost[lost.len() - 1] / impact);
    }
    claims.at_most("loss without friction", losses[0].abs(), 0.0);
    claims.holds("losses over the energy of the impact", &format!("{losses:.3?}"), losses[1] > 0.0 && losses[2] > 0.0);
}

/// An eccentric free sphere rotates with friction alone.
#[test]
fn a_sphere_rotates_with_friction_alone() {
    let mut claims = Claims::of("spin");
    let free = [
        "specimen.mesh.size=20mm",
        "specimen.symmetry=none",
        "impactor.guide=free",
        "impactor.position=[0.05, 0.02]",
        "layers.faces=[\"0 mm\"]",
    ];
    for (friction, rolls) in [("0", false), ("0.4", true)] {
        let model = loading_of_1008(&[&free[..], &[&format!("impactor.friction={friction}")]].concat());
        let mut scene = Scene::impact(&model);
        let mut spin = 0.0;
        while scene.engine.time() < 0.03 {
            spin = observe_step(&mut scene.engine, |view| view.bodies().next().expect("a body").spin.norm());
        }
        // The normal passes through the centre to round-off.
        let holds = if rolls { spin > 1e-2 } else { spin < 1e-10 };
        claims.holds(&format!("friction {friction}, spin after 30 ms"), &format!("{spin:.3e} rad/s"), holds);
    }
}
