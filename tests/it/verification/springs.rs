//! Film on springs: a strip between springs under a bar against the roots of its equilibrium, the balance of preload and
//! film, a mass that swings on them, parts between mirror planes against the whole.

use std::f64::consts::PI;
use std::fs;

use droptower::simulate::Outcome;

use super::claims::Claims;
use super::tower::{channel, measured, run, written};

/// Half the length of the strip as mounted, its width and thickness, m.
const HALF: f64 = 0.05;
const WIDTH: f64 = 0.02;
const SHEET: f64 = 50e-6;
const YOUNG: f64 = 50e6;
/// Half the width of the bar, m.
const BAR: f64 = 0.01;
/// Springs at each end, and their length as mounted, m.
const COUNT: f64 = 4.0;
const LENGTH: f64 = 0.02;

/// Force of the strip at a stretch, N: St. Venant–Kirchhoff without Poisson's ratio.
fn tension(stretch: f64) -> f64 {
    0.5 * YOUNG * (stretch * stretch - 1.0) * stretch * SHEET * WIDTH
}

/// The root of a function that increases, between `low` and `high`.
fn root(low: f64, high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Force of one spring over its elongation, as written and as a function.
type Law = (&'static str, fn(f64) -> f64);

const LINEAR: Law = ("stiffness = 400", |elongation| 400.0 * elongation.max(0.0));

/// A spring that stiffens, then softens.
const CURVE: Law = ("curve = [[0, 0], [0.004, 0.8], [0.008, 4], [0.03, 9.5]]", |elongation| match elongation {
    e if e < 0.004 => 200.0 * e,
    e if e < 0.008 => 0.8 + 800.0 * (e - 0.004),
    e => 4.0 + 250.0 * (e - 0.008),
});

/// A bar with a flat underside, wider than the film, as a surface.
fn bar() -> String {
    let corners = (0..8).map(|n| {
        let at = |bit: u32, half: f64| if n >> bit & 1 == 0 { -half } else { half };
        format!("v {} {} {}\n", at(0, BAR), at(1, WIDTH), at(2, 0.01))
    });
    let faces = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
    let faces = faces.map(|[a, b, c, d]| format!("f {a} {b} {c}\nf {a} {c} {d}\n"));
    corners.chain(faces).collect()
}

/// The strip between springs under a smooth bar.
fn pressed(law: Law, further: &str) -> Outcome {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bar.obj");
    fs::write(&path, bar()).expect("a file");
    run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = 0.0025
         frame.hold = [\"x-\", \"x+\"]
         frame.springs = {{ {}, length = {LENGTH}, {further} }}
         impactor = {{ shape.mesh = {path:?}, friction = 0.0 }}
         loading.indent = {{ depth = 0.02, velocity = 0.3 }}
         output.frames = 2",
        2.0 * HALF,
        law.0
    )))
}

/// Flank of film and spring are one straight line from the edge of the bar to the frame, at the depth d: with D its
/// length and ℓ that of the spring, the film has the stretch λ = (b + D − ℓ)/a, and T(λ) = n F(ℓ − ℓ₀).
#[test]
fn a_strip_between_springs_is_in_equilibrium_under_a_bar() {
    let mut claims = Claims::of("springs, strip under a bar");
    for (what, law, further, preload) in [
        ("linear", LINEAR, "count = 8", 0.0),
        ("linear, preloaded", LINEAR, "count = 8, preload = 0.6, mass = 1e-5", 0.6),
        ("curve", CURVE, "spacing = 0.005, damping = 0.01", 0.0),
        ("linear, continuous", LINEAR, "count = 8, continuous = true", 0.0),
        ("curve, continuous", CURVE, "spacing = 0.005, continuous = true, preload = 0.4", 0.4),
    ] {
        let outcome = pressed(law, further);
        let elongated = root(0.0, 0.02, |elongation| (law.1)(elongation) - preload);
        let unstretched = LENGTH - elongated;
        let [depth, force, frame, elongation, spring] =
            ["depth_m", "force_N", "frame_force_x_N", "spring_elongation_m", "spring_force_N"]
                .map(|name| channel(&outcome.signals, name));
        let at = |depth: f64| {
            let line = (HALF + LENGTH - BAR).hypot(depth);
            let stretch = |length: f64| (BAR + line - length) / HALF;
            let length =
                root(unstretched, line, |length| COUNT * (law.1)(length - unstretched) - tension(stretch(length)));
            (COUNT * (law.1)(length - unstretched), length - unstretched, depth / line)
        };
        let half = depth.len() / 2;
        let expected: f64 = depth[half..]
            .iter()
            .map(|depth| {
                let (pull, _, sine) = at(*depth);
                2.0 * pull * sine
            })
            .sum();
        claims.near(
            &format!("{what}: force of the bar over its second half, N"),
            force[half..].iter().sum(),
            expected,
            1e-2,
        );
        for share in [0.6, 1.0] {
            let k = (share * (depth.len() - 1) as f64) as usize;
            let (pull, elongated, sine) = at(depth[k]);
            let what = |name: &str| format!("{what}, {:.0} mm deep: {name}", 1e3 * depth[k]);
            claims.near(&what("force on each side, N"), frame[k], pull * (1.0 - sine * sine).sqrt(), 1e-2);
            claims.near(&what("elongation of a spring, m"), elongation[k], elongated, 2e-2);
            claims.near(&what("force of a spring, N"), spring[k], pull / COUNT, 2e-2);
        }
        claims.at_most(&format!("{what}: energy balance"), outcome.energy_balance_error, 2e-3);
    }
    claims.judge();
}

/// A strip that is mounted without stretch, under the preload of its springs: n F(e₀ − (λ − 1)a) = T(λ).
#[test]
fn preload_and_film_come_into_balance() {
    let mut claims = Claims::of("springs, preload");
    let preload = 2.0;
    let outcome = run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = 0.0025
         frame.hold = [\"x-\", \"x+\"]
         frame.springs = {{ stiffness = 400, count = 8, continuous = true, length = {LENGTH}, preload = {preload} }}
         impactor = {{ shape.sphere.radius = 0.01, mass = 0.1, friction = 0.0, height = 0.1 }}
         loading.impact = {{ velocity = 0.001, duration = 0.001, gravity = 0 }}
         output.frames = 2",
        2.0 * HALF
    )));
    let stretch = root(1.0, 1.1, |stretch| tension(stretch) - COUNT * (preload - 400.0 * (stretch - 1.0) * HALF));
    let relaxation = outcome.relaxation.expect("a relaxation");
    claims.holds("it was relaxed", &format!("{} steps", relaxation.steps), relaxation.steps > 0);
    claims.at_most("residual", relaxation.residual, 1e-6);
    claims.near("displacement, m", relaxation.displacement, (stretch - 1.0) * HALF, 1e-4);
    let first = |name: &str| channel(&outcome.signals, name)[0];
    claims.near("force on a side, N", first("frame_force_x_N"), tension(stretch), 1e-4);
    claims.near("force of a spring, N", first("spring_force_N"), tension(stretch) / COUNT, 1e-4);
    claims.near("strain", first("max_strain_md"), stretch - 1.0, 1e-4);
    claims.judge();
}

/// Film with pre-strain on a continuous support whose preload follows from it stays where it is, and its frame has its
/// stress resultants.
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
             frame.springs = {{ stiffness = 2000, spacing = 0.02, continuous = true, length = 0.03 }}
             impactor = {{ shape.sphere.radius = 0.02, mass = 0.1, height = 0.1 }}
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
        claims.near(&what("force of a spring, N"), first("spring_force_N"), line * 0.02, 1e-9);
    }
    claims.judge();
}

/// A body that rides on a strip under its weight, released above its equilibrium: with film that is stiff beside its springs, both
/// sides are straight lines, and the period is that of one degree of freedom by quadrature.
#[test]
fn a_body_bounces_as_one_degree_of_freedom() {
    let mut claims = Claims::of("springs, period");
    let (mass, stiffness, preload) = (2.0, 400.0, 4.0);
    // A shaft across a strip of five hundred times the stiffness of its springs.
    let (half, radius, thickness) = (0.05, 1e-3, 4e-4);
    let velocity = 0.35;
    let model = written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 300, thickness = {thickness}, elastic = {{ young = 2e9, poisson = 0.0 }} }}
         specimen.mesh.size = 0.0025
         specimen.symmetry = \"quarter\"
         frame.hold = [\"x-\", \"x+\"]
         frame.springs = {{ stiffness = {stiffness}, count = 8, length = 0.05, preload = {preload} }}
         impactor = {{ shape.hemisphere = {{ radius = {radius}, length = 0.05 }}, mass = {mass}, friction = 0.0, \
         orientation = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
         loading.impact = {{ velocity = {velocity}, duration = 0.4, gravity = 0 }}
         output = {{ frames = 2, sample_rate = 4000 }}",
        2.0 * half
    ));
    let outcome = run(&model);
    // Without weight the body sinks from contact to rest and back: half an oscillation. Energy of the springs at a depth,
    // film without stretch.
    let unstretched = 0.05 - preload / stiffness;
    let stored = |depth: f64| {
        let line = (half + 0.05f64).hypot(depth);
        let elongation = line - half - unstretched;
        8.0 * 0.5 * stiffness * elongation * elongation
    };
    let energy = 0.5 * mass * velocity * velocity;
    let lowest = root(0.0, 0.05, |depth| stored(depth) - stored(0.0) - energy);
    // ∫ dz/v, with z = z₀ sin φ, which removes the root at the lowest point.
    let steps = 20_000;
    let time: f64 = (0..steps)
        .map(|k| {
            let angle = (f64::from(k) + 0.5) / f64::from(steps) * 0.5 * PI;
            let depth = lowest * angle.sin();
            let speed = (2.0 * (energy + stored(0.0) - stored(depth)) / mass).sqrt();
            lowest * angle.cos() / speed * (0.5 * PI / f64::from(steps))
        })
        .sum();
    let [times, travel] = [&outcome.signals.time[..], channel(&outcome.signals, "displacement_m")];
    let k = (0..travel.len()).min_by(|a, b| travel[*a].total_cmp(&travel[*b])).expect("a lowest point");
    claims.near("lowest point, m", -travel[k], lowest, 1e-2);
    let back = (k..travel.len()).find(|k| travel[*k] >= 0.0).expect("it comes back");
    let back = times[back - 1] - travel[back - 1] * (times[back] - times[back - 1]) / (travel[back] - travel[back - 1]);
    claims.near("half a period, s", back, 2.0 * time, 1e-2);
    claims.at_most("energy balance", outcome.energy_balance_error, 5e-3);
    claims.judge();
}

/// A drop on springs: parts between mirror planes have the motion and the forces of the whole, on a square with discrete
/// springs and on a disc; energy and momentum.
#[test]
fn parts_have_the_motion_of_the_whole() {
    let mut claims = Claims::of("springs, mirror planes");
    for (shape, hold) in [
        ("rectangle = [0.2, 0.2]", "\"all\""),
        ("circle.radius = 0.1", "\"all\""),
        ("rectangle = [0.2, 0.1]", "[\"x-\", \"x+\"]"),
    ] {
        let drop = |symmetry: &str| {
            run(&written(&format!(
                "specimen.shape.{shape}
                 specimen.material = {{ density = 915, thickness = 2e-4, elastic = {{ young = {YOUNG}, poisson = 0.4 }} }}
                 specimen.mesh.size = 0.01
                 specimen.symmetry = \"{symmetry}\"
                 frame.hold = {hold}
                 frame.springs = {{ stiffness = 1000, count = 24, length = 0.05, preload = 3, mass = 0.001, damping = 1 }}
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
                let square: f64 = a.iter().map(|value| value * value).sum();
                let apart: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
                let what = format!("{shape}, {symmetry} and the whole apart, {name}");
                claims.at_most(&what, (apart / square).sqrt(), if name == "displacement_m" { 1e-3 } else { 2e-2 });
            }
        }
        claims.at_most(&format!("{shape}: energy balance"), whole.energy_balance_error, 5e-3);
    }
    claims.judge();
}

/// Findings of a spring that goes slack, and of one whose curve ends too early.
#[test]
fn slack_springs_and_short_curves_are_found() {
    let model = written(&format!(
        "specimen.shape.rectangle = [0.2, 0.2]
         specimen.material = {{ density = 915, thickness = 2e-4, elastic = {{ young = {YOUNG}, poisson = 0.4 }} }}
         specimen.mesh.size = 0.01
         specimen.symmetry = \"quarter\"
         frame.springs = {{ curve = [[0, 0], [0.01, 5], [0.012, 10]], count = 24, length = 0.05, preload = 1 }}
         impactor = {{ shape.sphere.radius = 0.04, mass = 0.5, friction = 0.0 }}
         loading.impact = {{ velocity = 2, duration = 0.1, gravity = 9.81 }}
         output.frames = 2"
    ));
    let outcome = run(&model);
    let codes: Vec<&str> =
        outcome.warnings.iter().map(|warning| droptower::finding::Report::code(warning).name).collect();
    assert!(codes.contains(&"springs-beyond-curve") && codes.contains(&"springs-slack"), "{codes:?}");
    assert!(measured(&model, &outcome).first().peak_displacement_m.is_some());
}
