//! Force of the film on its frame, compared with stress resultants of flat film and with the equilibrium under a bar.

use std::fs;
use std::path::Path;

use droptower::signal::Recording;

use super::claims::Claims;
use super::tower::{apart, channel, loading_of_1008, run, written};

/// Yield points of the fibres, strain and Pa (Table 5 of the study); pre-strain stays below the first.
const MD: [[f64; 2]; 2] = [[0.26, 8.4e6], [0.84, 20e6]];
const TD: [[f64; 2]; 2] = [[0.33, 8e6], [0.69, 10e6]];
const NAMES: [&str; 2] = ["frame_force_x_N", "frame_force_y_N"];
const THICKNESS: f64 = 12e-6;
const LAYERS: f64 = 3.0;
/// Spans along x and y, m.
const SPANS: [f64; 2] = [0.2, 0.12];
/// Pre-strain of the first face along MD and TD; the second has that of MD alone.
const STRAINED: [f64; 2] = [0.1, 0.05];

/// Pull across a side, N, of a face that is strained by `strain` along its normal and `across` along itself: the
/// nominal stress on the stress-free section.
fn resultant([[strain_1, stress_1], _]: [[f64; 2]; 2], strain: f64, across: f64, side: f64) -> f64 {
    stress_1 * strain / strain_1 * THICKNESS * LAYERS * side / (1.0 + across)
}

/// Two faces of stretched film before a small ball reaches them.
fn mounted(md_angle: f64, element: &str, symmetry: &str) -> [f64; 2] {
    let [x, y] = SPANS;
    let [md, td] = STRAINED;
    let curve = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/materials/lldpe-shear.csv");
    let outcome = run(&written(&format!(
        "specimen.shape.rectangle = [{x}, {y}]
         specimen.material = {{ density = 915, thickness = {THICKNESS}, fabric.md = {{ yield = {MD:?}, break = [1.39, 29e6] }}, \
         fabric.td = {{ yield = {TD:?}, break = [7.0, 16e6] }}, fabric.shear.curve = {curve:?} }}
         specimen.mesh = {{ element = \"{element}\", size = 0.01 }}
         specimen.symmetry = \"{symmetry}\"
         impactor = {{ shape.sphere.radius = 0.02, mass = 0.1, friction = 0.3 }}
         loading.impact = {{ velocity = 1.0, duration = 0.001 }}
         output.frames = 2
         [[layer]]
         count = {LAYERS}
         height = 0.0
         md_angle = {md_angle}
         prestrain = {{ md = {md}, td = {td} }}
         [[layer]]
         count = {LAYERS}
         height = -0.03
         md_angle = {md_angle}
         prestrain = {{ md = {md}, td = 0.0 }}"
    )));
    NAMES.map(|name| channel(&outcome.signals, name)[0])
}

#[test]
fn film_at_rest_has_its_resultants() {
    let mut claims = Claims::of("force on the frame, at rest");
    let [x, y] = SPANS;
    let [md, td] = STRAINED;
    let along = |side: f64| resultant(MD, md, td, side) + resultant(MD, md, 0.0, side);
    let across = |side: f64| resultant(TD, td, md, side);
    for element in ["quad4", "quad4-full", "tri3"] {
        for symmetry in ["none", "half-x", "half-y", "quarter"] {
            let what = |claim: &str| format!("{element}, {symmetry}, {claim}");
            let lying = mounted(0.0, element, symmetry);
            claims.near(&what("MD along x: x, N"), lying[0], along(y), 1e-12);
            claims.near(&what("MD along x: y, N"), lying[1], across(x), 1e-12);
            let rotated = mounted(std::f64::consts::FRAC_PI_2, element, symmetry);
            claims.near(&what("MD along y: x, N"), rotated[0], across(y), 1e-12);
            claims.near(&what("MD along y: y, N"), rotated[1], along(x), 1e-12);
        }
    }
}

/// Root mean square of the difference of the forces from those of a quarter, relative to these, along each axis.
fn quarter_apart(claims: &mut Claims, what: &str, bound: f64, signals: impl Fn(&str) -> Recording) {
    let quarter = signals("quarter");
    for symmetry in ["half-x", "half-y", "none"] {
        let other = signals(symmetry);
        for name in NAMES {
            let [quarter, other] = [&quarter, &other].map(|signals| channel(signals, name));
            claims.at_most(&format!("{what}, {name}, {symmetry} and quarter apart"), apart(quarter, other), bound);
        }
    }
}

/// To round-off under pressure. In an impact, round-off decides when a node slips.
#[test]
fn a_quarter_has_the_forces_of_the_whole() {
    let mut claims = Claims::of("force on the frame, quarter");
    quarter_apart(&mut claims, "inflated", 1e-9, |symmetry| {
        run(&written(&format!(
            "specimen.shape.rectangle = [0.1, 0.08]
             specimen.material = {{ density = 915, thickness = 50e-6, elastic = {{ young = 50e6, poisson = 0.44 }} }}
             specimen.mesh.size = 0.01
             specimen.symmetry = \"{symmetry}\"
             loading.pressure = {{ pressure = \"2 kPa\", ramp = \"50 ms\" }}
             output.frames = 2"
        )))
        .signals
    });
    quarter_apart(&mut claims, "1008", 5e-3, |symmetry| {
        run(&loading_of_1008(&["specimen.mesh.size=40 mm", &format!("specimen.symmetry={symmetry}")])).signals
    });
}

const HALF_SPAN: f64 = 0.05;
const WIDTH: f64 = 0.02;
const BAR: f64 = 0.01;
const YOUNG: f64 = 50e6;
const SHEET: f64 = 50e-6;

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

/// A strip between x- and x+, ν = 0, under a smooth bar at the depth d: both flanks have the slope tan θ = d/(a − b),
/// the stress is the same all along, and the force on the bar is 2 T sin θ, that on each side of the frame T cos θ.
#[test]
fn a_bar_and_the_frame_are_in_equilibrium() {
    let mut claims = Claims::of("force on the frame, bar");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bar.obj");
    fs::write(&path, bar()).expect("a file");
    let size = thorough::choose(0.005, 0.0025);
    let outcome = run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh.size = {size}
         frame.hold = [\"x-\", \"x+\"]
         impactor = {{ shape.mesh = {path:?}, friction = 0.0 }}
         loading.indent = {{ depth = 0.012, velocity = 0.3 }}
         output.frames = 2",
        2.0 * HALF_SPAN,
    )));
    claims.holds("no force along y", "columns", outcome.signals.channel("frame_force_y_N").is_none());
    let [depth, force, frame] = ["depth_m", "force_N", "frame_force_x_N"].map(|name| channel(&outcome.signals, name));
    let half = depth.len() / 2;
    let slope = |depth: f64| depth / (HALF_SPAN - BAR);
    let vertical: f64 = (half..depth.len()).map(|k| 2.0 * frame[k] * slope(depth[k])).sum();
    claims.near("force of the bar over its second half, N", vertical, force[half..].iter().sum(), 2e-2);
    for share in [0.5, 0.75, 1.0] {
        let k = (share * (depth.len() - 1) as f64) as usize;
        let cosine = 1.0 / slope(depth[k]).hypot(1.0);
        let stretch = ((HALF_SPAN - BAR) / cosine + BAR) / HALF_SPAN;
        let tension = YOUNG * 0.5 * (stretch * stretch - 1.0) * stretch * SHEET * WIDTH;
        claims.near(&format!("{:.0} mm deep, force on the frame, N", 1e3 * depth[k]), frame[k], tension * cosine, 3e-2);
    }
}
