//! Film on springs: a strip between springs under a lying shaft against the roots of its equilibrium, the balance of preload and
//! film, a mass that swings on them, parts between mirror planes against the whole.

use droptower::simulate::{self, Outcome};

use super::claims::Claims;
use super::solve::zero;
use super::tower::{apart, channel, codes, run, written};

/// Half the length of the strip as mounted, its width and thickness, m.
const HALF: f64 = 0.05;
const WIDTH: f64 = 0.005;
const SHEET: f64 = 50e-6;
const YOUNG: f64 = 50e6;
/// Elements, m: at four springs at each end, one to an element, so that the edge stays straight.
const SIZE: f64 = 1.25e-3;
/// Radius of the shaft, m.
const SHAFT: f64 = 0.01;
/// Springs at each end, and their length as mounted, m.
const COUNT: f64 = 4.0;
const LENGTH: f64 = 0.02;

/// Force of the strip at a stretch, N: St. Venant–Kirchhoff without Poisson's ratio.
fn tension(stretch: f64) -> f64 {
    0.5 * YOUNG * (stretch * stretch - 1.0) * stretch * SHEET * WIDTH
}

/// Of one spring, N/m.
const STIFFNESS: f64 = 100.0;

/// The strip between springs with further keys, under a body.
fn strip(further: &str, body: &str) -> Outcome {
    run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = {SIZE}
         frame.hold = [\"x-\", \"x+\"]
         frame.springs = {{ stiffness = {STIFFNESS}, count = 8, length = {LENGTH}{further} }}
         {body}
         output.frames = 2",
        2.0 * HALF
    )))
}

/// Film leaves the shaft along its tangent of the angle θ, which film and spring share up to the frame: of the path from
/// the middle, ℓ is the spring, and λa the rest, so that T(λ) = n F(ℓ − ℓ₀).
#[test]
fn a_strip_between_springs_is_in_equilibrium_under_a_shaft() {
    let mut claims = Claims::of("springs, strip under a shaft");
    let shaft = format!(
        "impactor = {{ shape.hemisphere = {{ radius = {SHAFT}, length = 0.05 }}, friction = 0.0, \
         orientation = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
         loading.indent = {{ depth = 0.02, velocity = 0.3 }}"
    );
    for (what, further, preload) in [("as long as it is", "", 0.0), ("preloaded", ", preload = 0.15", 0.15)] {
        let outcome = strip(further, &shaft);
        let unstretched = LENGTH - preload / STIFFNESS;
        let pull = |length: f64| STIFFNESS * (length - unstretched).max(0.0);
        let [depth, force, frame, elongation, spring] =
            ["depth_m", "force_N", "frame_force_x_N", "spring_elongation_m", "spring_force_N"]
                .map(|name| channel(&outcome.signals, name));
        // Of a spring its force and elongation, and the angle.
        let at = |depth: f64| {
            let radius = SHAFT + 0.5 * SHEET;
            let apart = (HALF + LENGTH).hypot(radius - depth);
            let angle = (depth - radius).atan2(HALF + LENGTH) + (radius / apart).asin();
            let path = (apart * apart - radius * radius).sqrt() + radius * angle;
            let film = |length: f64| tension((path - length) / HALF);
            let length = zero(unstretched, path, |length| COUNT * pull(length) - film(length));
            (pull(length), length - unstretched, angle)
        };
        let half = depth.len() / 2;
        let of_shaft = |depth: &f64| {
            let (pull, _, angle) = at(*depth);
            2.0 * COUNT * pull * angle.sin()
        };
        let expected: f64 = depth[half..].iter().map(of_shaft).sum();
        let claim = format!("{what}: force of the shaft over its second half, N");
        claims.near(&claim, force[half..].iter().sum(), expected, 1e-2);
        for share in [0.6, 1.0] {
            let k = (share * (depth.len() - 1) as f64) as usize;
            let (pull, elongated, angle) = at(depth[k]);
            let what = |name: &str| format!("{what}, {:.0} mm deep: {name}", 1e3 * depth[k]);
            claims.near(&what("force on each side, N"), frame[k], COUNT * pull * angle.cos(), 1e-2);
            claims.near(&what("elongation of a spring, m"), elongation[k], elongated, 1e-2);
            claims.near(&what("force of a spring, N"), spring[k], pull, 1e-2);
        }
        claims.at_most(&format!("{what}: energy balance"), outcome.energy_balance_error, 2e-3);
    }
}

/// Springs give way, so that film on them is not as tense as within a rigid edge: no more mass than its own follows from that.
#[test]
fn film_on_springs_is_indented_with_its_own_mass() {
    let step = |scaling: &str| {
        let model = written(&format!(
            "specimen = {{ shape.rectangle = [0.1, 0.1], mesh.size = 0.01, material = {{ density = 1000, thickness = 1e-4, \
             elastic = {{ young = 2e9, poisson = 0.3 }} }} }}
             frame.springs = {{ stiffness = 1e3, count = 40, length = 0.2 }}
             impactor = {{ shape.sphere.radius = 0.04, friction = 0.2 }}
             loading.indent = {{ depth = 0.015, velocity = 0.05{scaling} }}"
        ));
        simulate::engine(&model).expect("an engine").time_step()
    };
    assert_eq!(step(""), step(", mass_scaling = 1"));
}

/// A strip that is mounted without stretch, under the preload of its springs: n F(e₀ − (λ − 1)a) = T(λ).
#[test]
fn preload_and_film_come_into_balance() {
    let mut claims = Claims::of("springs, preload");
    let preload = 0.5;
    let ball = "impactor = { shape.sphere.radius = 0.01, mass = 0.1, friction = 0.0, position = [0, 0, 0.1] }
        loading.impact = { velocity = 0.001, duration = 0.001, gravity = 0 }";
    let outcome = strip(&format!(", preload = {preload}"), ball);
    let stretch = zero(1.0, 1.1, |stretch| tension(stretch) - COUNT * (preload - STIFFNESS * (stretch - 1.0) * HALF));
    let relaxation = outcome.relaxation.expect("a relaxation");
    claims.holds("it was relaxed", &format!("{} steps", relaxation.steps), relaxation.steps > 0);
    claims.at_most("residual", relaxation.residual, 1e-6);
    claims.near("displacement, m", relaxation.displacement, (stretch - 1.0) * HALF, 1e-4);
    let first = |name: &str| channel(&outcome.signals, name)[0];
    claims.near("force on a side, N", first("frame_force_x_N"), tension(stretch), 1e-4);
    claims.near("force of a spring, N", first("spring_force_N"), tension(stretch) / COUNT, 1e-4);
    claims.near("strain", first("max_strain_md"), stretch - 1.0, 1e-4);
}

/// Film with pre-strain on one spring an element whose preload follows from it stays where it is, and its frame has its stress
/// resultants.
#[test]
fn springs_are_mounted_in_balance_with_the_pre_strain() {
    let mut claims = Claims::of("springs, pre-strain");
    let (x, y, strain) = (0.2, 0.12, 0.02);
    for symmetry in ["none", "half-x", "half-y", "quarter"] {
        let outcome = run(&written(&format!(
            "specimen.shape.rectangle = [{x}, {y}]
             specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.4 }} }}
             specimen.mesh.size = 0.01
             specimen.symmetry = \"{symmetry}\"
             layers.prestrain = {{ md = {strain}, td = {strain} }}
             frame.springs = {{ stiffness = 2000, count = 64, length = 0.03 }}
             impactor = {{ shape.sphere.radius = 0.02, mass = 0.1, friction = 0.0, position = [0, 0, 0.1] }}
             loading.impact = {{ velocity = 0.001, duration = 0.001, gravity = 0 }}
             output.frames = 2"
        )));
        // St. Venant–Kirchhoff, stretched alike in both directions: nominal stress times stress-free section.
        let stretch = 1.0 + strain;
        let line = 0.5 * YOUNG / 0.6 * (stretch * stretch - 1.0) * stretch * SHEET / stretch;
        let first = |name: &str| channel(&outcome.signals, name)[0];
        let what = |name: &str| format!("{symmetry}: {name}");
        claims.at_most(&what("residual as mounted"), outcome.relaxation.expect("a relaxation").mounted, 1e-9);
        claims.near(&what("force along x, N"), first("frame_force_x_N"), line * y, 1e-9);
        claims.near(&what("force along y, N"), first("frame_force_y_N"), line * x, 1e-9);
        claims.near(&what("force of a spring, N"), first("spring_force_N"), line * 0.01, 1e-9);
    }
}

/// A shaft thrown on a strip between preloaded springs swings half a period: one degree of freedom, whose force is that of the
/// equilibrium above with a shaft without radius, by quadrature.
#[test]
fn a_body_bounces_as_one_degree_of_freedom() {
    let mut claims = Claims::of("springs, period");
    let (mass, velocity, thickness, length, preload) = (0.05, 0.4, 2e-4, 0.05, 0.25);
    let model = written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {thickness}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = {SIZE}
         frame.hold = [\"x-\", \"x+\"]
         frame.springs = {{ stiffness = 100, count = 8, length = {length}, preload = {preload} }}
         impactor = {{ shape.hemisphere = {{ radius = 0.002, length = 0.05 }}, mass = {mass}, friction = 0.0, \
         orientation = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
         loading.impact = {{ velocity = {velocity}, duration = 0.2, gravity = 0 }}
         output = {{ frames = 2, sample_rate = 4000, filter = \"none\" }}",
        2.0 * HALF
    ));
    let outcome = run(&model);
    let unstretched = length - preload / 100.0;
    let force = |depth: f64| {
        let line = (HALF + length).hypot(depth);
        let pull = |length: f64| COUNT * 100.0 * (length - unstretched);
        let film = |length: f64| tension((line - length) / HALF) * thickness / SHEET;
        2.0 * pull(zero(unstretched, line, |length| pull(length) - film(length))) * depth / line
    };
    let energy = 0.5 * mass * velocity * velocity;
    // Depth over speed: the energy that is left falls as the force has done work; midpoints of steps of the depth.
    let step = 1e-6;
    let (mut depth, mut left, mut time) = (0.0, energy, 0.0);
    loop {
        let work = force(depth + 0.5 * step) * step;
        if left <= work {
            // From its last place with a constant force.
            let force = force(depth);
            time += (2.0 * left * mass).sqrt() / force;
            depth += left / force;
            break;
        }
        let mean = 0.5 * ((2.0 * left / mass).sqrt() + (2.0 * (left - work) / mass).sqrt());
        time += step / mean;
        (depth, left) = (depth + step, left - work);
    }
    let [times, travel] = [&outcome.signals.time[..], channel(&outcome.signals, "displacement_m")];
    let k = (0..travel.len()).min_by(|a, b| travel[*a].total_cmp(&travel[*b])).expect("a lowest point");
    claims.near("lowest point, m", -travel[k], depth, 5e-3);
    let back = (k..travel.len()).find(|k| travel[*k] >= 0.0).expect("it comes back");
    let back = times[back - 1] - travel[back - 1] * (times[back] - times[back - 1]) / (travel[back] - travel[back - 1]);
    claims.near("half a period, s", back, 2.0 * time, 5e-3);
    claims.at_most("energy balance", outcome.energy_balance_error, 5e-3);
}

/// A drop on springs: parts between mirror planes have the motion and the forces of the whole, on a square with discrete
/// springs and on a disc; energy and momentum.
#[test]
fn parts_have_the_motion_of_the_whole() {
    let mut claims = Claims::of("springs, mirror planes");
    // Meshes of a disc and of its parts differ. Four of twelve springs stand on the corners of the square.
    for (shape, hold, count, travel) in [
        ("rectangle = [0.2, 0.2]", "\"all\"", 24, 1e-4),
        ("rectangle = [0.2, 0.2]", "\"all\"", 12, 1e-4),
        ("circle.radius = 0.1", "\"all\"", 24, 5e-3),
        ("rectangle = [0.2, 0.1]", "[\"x-\", \"x+\"]", 24, 1e-4),
    ] {
        let drop = |symmetry: &str| {
            run(&written(&format!(
                "specimen.shape.{shape}
                 specimen.material = {{ density = 915, thickness = 2e-4, elastic = {{ young = {YOUNG}, poisson = 0.4 }} }}
                 specimen.mesh.size = 0.01
                 specimen.symmetry = \"{symmetry}\"
                 frame.hold = {hold}
                 frame.springs = {{ stiffness = 1000, count = {count}, length = 0.05, preload = 3 }}
                 impactor = {{ shape.sphere.radius = 0.04, mass = 0.5, friction = 0.0 }}
                 loading.impact = {{ velocity = 2, duration = 0.06, gravity = 9.81 }}
                 output.frames = 2"
            )))
        };
        let whole = drop("none");
        for symmetry in ["half-x", "half-y", "quarter"] {
            let part = drop(symmetry);
            for name in ["displacement_m", "contact_force_N", "frame_force_N", "spring_force_N"] {
                let [a, b] = [&whole, &part].map(|outcome| channel(&outcome.signals, name));
                let what = format!("{shape}, {count} springs, {symmetry} and the whole apart, {name}");
                claims.at_most(&what, apart(a, b), if name == "displacement_m" { travel } else { 2e-2 });
            }
        }
        claims.at_most(&format!("{shape}, {count} springs: energy balance"), whole.energy_balance_error, 5e-3);
    }
}

/// A square that hangs by its corners pulls alike in both directions, with the force of its pre-strain along each diagonal:
/// that of half a side of each of two sides, N s √2 / 2.
#[test]
fn film_hangs_by_its_corners() {
    let model = written(&format!(
        "specimen.shape.rectangle = [0.2, 0.2]
         specimen.material = {{ density = 915, thickness = 2e-4, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = 0.02
         layers.prestrain = {{ md = 0.01, td = 0.01 }}
         frame.springs = {{ stiffness = 1000, count = 4, length = 0.2 }}
         impactor = {{ shape.sphere.radius = 0.04, mass = 0.1, friction = 0.0 }}
         loading.impact = {{ velocity = 0.5, duration = 0.005, gravity = 0 }}
         layers.settle = false
         output.frames = 2"
    ));
    let outcome = run(&model);
    let [x, y] = ["frame_force_x_N", "frame_force_y_N"].map(|name| channel(&outcome.signals, name));
    assert!(x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-6 * x.abs()), "{x:?} {y:?}");
    // Two corners on each side, of which each has a part along its diagonal.
    let line = 0.5 * YOUNG * (1.01_f64.powi(2) - 1.0) * 2e-4;
    assert!((x[0] / (line * 0.2) - 1.0).abs() < 1e-9, "{} for {}", x[0], line * 0.2);
}

/// A body that drags film along: springs behind it go slack.
#[test]
fn slack_springs_are_found() {
    let outcome = run(&written(&format!(
        "specimen.shape.rectangle = [0.2, 0.2]
         specimen.material = {{ density = 915, thickness = 2e-4, elastic = {{ young = {YOUNG}, poisson = 0.4 }} }}
         specimen.mesh.size = 0.01
         frame.springs = {{ stiffness = 500, count = 24, length = 0.05 }}
         impactor = {{ shape.sphere.radius = 0.04, mass = 0.1, friction = 1.0, guide = \"free\", velocity = [4, 0, -4] }}
         loading.impact = {{ duration = 0.03, gravity = 0 }}
         output.frames = 2"
    )));
    assert!(codes(&outcome).contains(&"springs-slack"), "{:?}", codes(&outcome));
}
