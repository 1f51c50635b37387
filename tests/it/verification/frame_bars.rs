//! Bars of the frame, over which film bends, and the clamp in which it slips: a strip over two bars against its closed
//! form, and bodies that meet a bar.

use droptower::post::BodyFigures;
use droptower::simulate::Outcome;

use super::claims::Claims;
use super::solve::zero;
use super::tower::{apart, channel, codes, last, measured, run, written};

/// Half the span from crest to crest, width, thickness, m.
const HALF_SPAN: f64 = 0.05;
const WIDTH: f64 = 1.25e-3;
const SHEET: f64 = 50e-6;
/// Radii of bars and body, m.
const BAR: f64 = 0.01;
const BODY: f64 = 0.01;
const YOUNG: f64 = 50e6;
const DEPTH: f64 = 0.03;

/// A quarter of a strip over two bars, pressed down by a lying shaft without friction.
fn strip(frame: &str, size: f64) -> Outcome {
    run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh = {{ element = \"quad4\", size = {size} }}
         frame.hold = [\"x-\", \"x+\"]
         {frame}
         impactor = {{ shape.hemisphere = {{ radius = {BODY}, length = 0.05 }}, friction = 0.0, \
         orientation = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
         loading.indent = {{ depth = {DEPTH}, velocity = 0.3 }}
         output = {{ frames = 2, sample_rate = 2000 }}",
        2.0 * HALF_SPAN,
    )))
}

/// The strip under the body at a depth: it leaves bar and body along their common tangent.
struct Tangent {
    /// Angle of the tangent, which is the angle of wrap, rad.
    angle: f64,
    /// Its length between the two, m.
    length: f64,
    /// Radii of the middle surface on bar and body, m.
    radii: [f64; 2],
}

impl Tangent {
    fn at(depth: f64) -> Tangent {
        let radii = [BAR, BODY].map(|radius| radius + 0.5 * SHEET);
        let both = radii[0] + radii[1];
        let apart = HALF_SPAN.hypot(both - depth);
        let angle = (depth - both).atan2(HALF_SPAN) + (both / apart).asin();
        Tangent { angle, length: (apart * apart - both * both).sqrt(), radii }
    }

    /// Length of half the strip, m.
    fn half_strip(&self) -> f64 {
        self.length + (self.radii[0] + self.radii[1]) * self.angle
    }
}

/// Tension of the strip at a stretch (St. Venant–Kirchhoff, ν = 0), N.
fn tension(stretch: f64) -> f64 {
    YOUNG * 0.5 * (stretch * stretch - 1.0) * stretch * SHEET * WIDTH
}

/// The stretch at a tension (N).
fn stretch(wanted: f64) -> f64 {
    zero(1.0, 3.0, |stretch| tension(stretch) - wanted)
}

/// Tension at the edge (N) at which the strip has its stress-free length under Euler's and Eytelwein's law on the bar.
fn edge_tension(tangent: &Tangent, friction: f64) -> f64 {
    let parts = 400;
    let length = |edge: f64| {
        let on_bar: f64 = (0..parts)
            .map(|k| tangent.angle * (f64::from(k) + 0.5) / f64::from(parts))
            .map(|angle| tangent.radii[0] * tangent.angle / f64::from(parts) / stretch(edge * (friction * angle).exp()))
            .sum();
        let beyond = tangent.length + tangent.radii[1] * tangent.angle;
        on_bar + beyond / stretch(edge * (friction * tangent.angle).exp())
    };
    zero(0.0, tension(2.0), |edge| HALF_SPAN - length(edge))
}

/// The stretch is that of the path from crest to crest; the shaft gets 2 T sin θ, the bars the same, each side of the
/// frame T.
#[test]
fn a_strip_over_smooth_bars_has_the_force_of_its_length() {
    let mut claims = Claims::of("frame, smooth bars");
    let outcome = strip(&format!("frame.bars = {{ radius = {BAR}, friction = 0.0 }}"), 1.25e-3);
    let [depth, force, sides, bars] =
        ["depth_m", "force_N", "frame_force_x_N", "frame_force_N"].map(|name| channel(&outcome.signals, name));
    for share in [0.6, 0.8, 1.0] {
        let k = (share * (depth.len() - 1) as f64) as usize;
        let tangent = Tangent::at(depth[k]);
        let pull = tension(tangent.half_strip() / HALF_SPAN);
        let what = |what: &str| {
            format!("{:.0} mm deep, wrap {:.1} deg, {what}, N", 1e3 * depth[k], tangent.angle.to_degrees())
        };
        claims.near(&what("force on the body"), force[k], 2.0 * pull * tangent.angle.sin(), 5e-3);
        claims.near(&what("force on the bars"), bars[k], 2.0 * pull * tangent.angle.sin(), 5e-3);
        claims.near(&what("force on a side"), sides[k], pull, 5e-3);
    }
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-3);
    claims.holds("findings", &format!("{:?}", outcome.warnings), outcome.warnings.is_empty());
}

/// Euler and Eytelwein: the tension grows by e^{μφ} over the angle of wrap, and no tension where there is no friction.
#[test]
fn friction_on_a_bar_is_that_of_a_capstan() {
    let mut claims = Claims::of("frame, capstan");
    // The edge on the crest takes the friction of half an element.
    for (friction, size) in thorough::first(2, [(0.0, 1.25e-3), (0.2, 0.625e-3), (0.5, 0.3125e-3)]) {
        let outcome = strip(&format!("frame.bars = {{ radius = {BAR}, friction = {friction} }}"), size);
        let tangent = Tangent::at(last(&outcome.signals, "depth_m"));
        let [force, edge] = ["force_N", "frame_force_x_N"].map(|name| last(&outcome.signals, name));
        let span = force / (2.0 * tangent.angle.sin());
        let what = |what: &str| format!("coefficient {friction}, wrap {:.1} deg, {what}", tangent.angle.to_degrees());
        claims.near(&what("ratio of tensions"), span / edge, (friction * tangent.angle).exp(), 1e-2);
        let expected = edge_tension(&tangent, friction);
        claims.near(&what("tension at the edge, N"), edge, expected, 1e-2);
        let pressed = expected * (friction * tangent.angle).exp() * 2.0 * tangent.angle.sin();
        claims.near(&what("force on the body, N"), force, pressed, 5e-3);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
    }
}

/// The clamps of both ends hold µF each, 2 µF in all; what the strip does not stretch at this tension, it slips.
#[test]
fn a_clamp_slips_at_its_force_of_friction() {
    let mut claims = Claims::of("frame, clamp");
    let (force, friction) = (1.5, 0.25);
    let bound = friction * force;
    let clamp = format!("frame.clamp = {{ force = {force}, friction = {friction} }}");
    for bars in ["", "frame.bars = { radius = 0.01, friction = 0.0 }"] {
        let outcome = strip(&format!("{bars}\n{clamp}"), 1.25e-3);
        let with = if bars.is_empty() { "no bars" } else { "bars" };
        let [depth, slip, side] =
            ["depth_m", "clamp_slip_m", "frame_force_x_N"].map(|name| channel(&outcome.signals, name));
        let slips = slip.iter().position(|slip| *slip > 0.0).expect("it slips");
        let before = side[..slips].iter().copied().fold(0.0, f64::max);
        claims.near(&format!("{with}, force on a side when it begins to slip, N"), before, bound, 2e-2);
        let later = &side[slips + side.len() / 20..];
        if bars.is_empty() {
            let mean = later.iter().sum::<f64>() / later.len() as f64;
            claims.near(&format!("{with}, force on a side while it slips, N"), mean, bound, 5e-3);
            let worst = later.iter().map(|force| (force / bound - 1.0).abs()).fold(0.0, f64::max);
            claims.at_most(&format!("{with}, largest deviation from it"), worst, 5e-3);
        }
        claims.at_most(&format!("{with}, energy balance error"), outcome.energy_balance_error, 1e-3);
        if !bars.is_empty() {
            let expected = Tangent::at(last(&outcome.signals, "depth_m")).half_strip() - HALF_SPAN * stretch(bound);
            let pressed = 2.0 * bound * Tangent::at(last(&outcome.signals, "depth_m")).angle.sin();
            claims.near(&format!("{with}, force on the body, N"), last(&outcome.signals, "force_N"), pressed, 5e-3);
            claims.near(&format!("{with}, slip, m"), last(&outcome.signals, "clamp_slip_m"), chord(expected), 1e-2);
        }
        let dissipated = last(&outcome.energies, "clamp_J");
        let work: f64 = (1..slip.len()).map(|k| (slip[k] - slip[k - 1]) * 2.0 * bound).sum();
        let work = if bars.is_empty() { work } else { 2.0 * bound * arc(slip[slip.len() - 1]) };
        claims.near(&format!("{with}, dissipated, J"), dissipated, work, 1e-2);
        let codes = codes(&outcome);
        let claim = format!("{with}, findings");
        claims.holds(&claim, &format!("{codes:?} at {:.0} mm", 1e3 * depth[slips]), codes == ["clamp-slip"]);
    }
}

/// Distance from the crest of the bar of what has slipped along it by `arc` (m).
fn chord(arc: f64) -> f64 {
    let radius = BAR + 0.5 * SHEET;
    2.0 * radius * (0.5 * arc / radius).sin()
}

/// The reverse.
fn arc(chord: f64) -> f64 {
    let radius = BAR + 0.5 * SHEET;
    2.0 * radius * (0.5 * chord / radius).asin()
}

/// Film that has slipped by the width of the clamp is free: nothing pulls any more.
#[test]
fn film_that_leaves_its_clamp_is_free() {
    let mut claims = Claims::of("frame, clamp left");
    let outcome = run(&written(&format!(
        "specimen.shape.rectangle = [{}, {WIDTH}]
         specimen.material = {{ density = 915, thickness = {SHEET}, elastic = {{ young = {YOUNG}, poisson = 0.0 }} }}
         specimen.mesh = {{ element = \"quad4\", size = 0.0025 }}
         frame.hold = [\"x-\", \"x+\"]
         frame.clamp = {{ force = 3, friction = 0.25, width = 0.002 }}
         impactor = {{ shape.sphere.radius = 0.03, mass = 0.05, friction = 0.0 }}
         loading.impact = {{ velocity = 3.0, gravity = 0, duration = \"30 ms\" }}
         output = {{ frames = 2, filter = \"none\" }}",
        2.0 * HALF_SPAN,
    )));
    let codes = codes(&outcome);
    claims.holds("findings", &format!("{codes:?}"), codes.contains(&"clamp-slip") && codes.contains(&"clamp-left"));
    claims.near("largest slip, m", last(&outcome.signals, "clamp_slip_m"), 0.002, 1e-12);
    let force = channel(&outcome.signals, "contact_force_N");
    let peak = force.iter().copied().fold(0.0, f64::max);
    let end = force[force.len() * 9 / 10..].iter().sum::<f64>() / (force.len() - force.len() * 9 / 10) as f64;
    claims.at_most("force on the body at the end over its peak", end.abs() / peak, 0.05);
    // Film that nothing holds whips.
    claims.at_most("energy balance error", outcome.energy_balance_error, 5e-3);
}

/// A ball on the crest of a bar, with film between the two: v' = −e v, and the bar gets m v (1 + e). The film takes
/// nothing of it.
#[test]
fn a_ball_bounces_from_a_bar() {
    let mut claims = Claims::of("frame, bounce");
    let (mass, speed) = (0.3, 2.0);
    // The edge of the polygon lies beside the axes.
    for (shape, offset) in [
        ("rectangle = [0.2, 0.2]", "\"100 mm\", \"0 mm\""),
        ("polygon.points = [[0.1, 0], [0, 0.1], [-0.1, 0], [0, -0.1]]", "\"50 mm\", \"50 mm\""),
    ] {
        for restitution in [0.0, 0.6, 1.0] {
            let model = written(&format!(
                "specimen.shape.{shape}
                 specimen.material = {{ density = 915, thickness = 20e-6, elastic = {{ young = 1e6, poisson = 0.3 }} }}
                 specimen.mesh = {{ element = \"quad4\", size = 0.02 }}
                 frame.bars = {{ radius = 0.01, friction = 0.2 }}
                 impactor = {{ shape.sphere.radius = 0.02, mass = {mass}, friction = 0.0, restitution = {restitution}, \
                 position = [{offset}, \"30 mm\"] }}
                 loading.impact = {{ velocity = {speed}, gravity = 0, duration = \"8 ms\" }}
                 output = {{ frames = 2, filter = \"none\" }}"
            ));
            let outcome = run(&model);
            let what = |what: &str| format!("{}, restitution {restitution}, {what}", &shape[..6]);
            let after = last(&outcome.signals, "velocity_m_s");
            claims.at_most(&what("velocity off, m/s"), (after - restitution * speed).abs(), 1e-3 * speed);
            let time = &outcome.signals.time;
            let impulse: f64 =
                channel(&outcome.signals, "frame_force_N").iter().map(|force| force * (time[1] - time[0])).sum();
            claims.near(&what("impulse on the bars, N s"), impulse, mass * speed * (1.0 + restitution), 5e-3);
            let lost = 0.5 * mass * speed * speed * (1.0 - restitution * restitution);
            claims.at_most(&what("energy lost off, J"), (last(&outcome.energies, "collision_J") - lost).abs(), 2e-3);
            claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
            for code in ["frame-hit", "no-film-contact"] {
                claims.holds(&what("finding"), code, codes(&outcome).contains(&code));
            }
            let measures = measured(&model, &outcome);
            let BodyFigures {
                peak_displacement_m,
                rebound_velocity_m_s,
                energy_absorption,
                film_energy_absorption,
                ..
            } = *measures.first();
            let of_film = [peak_displacement_m, rebound_velocity_m_s, energy_absorption, film_energy_absorption];
            claims.holds(&what("figures of the film"), "none", of_film == [None; 4]);
        }
    }
}

/// A drop on film over bars and in a clamp, two faces: the quarter is the whole, which stays symmetric.
#[test]
fn a_drop_over_bars_is_that_of_its_quarter() {
    let mut claims = Claims::of("frame, drop");
    let of = |symmetry: &str| {
        run(&written(&format!(
            "specimen.shape.rectangle = [0.16, 0.16]
             specimen.symmetry = \"{symmetry}\"
             specimen.material = {{ density = 915, thickness = 50e-6, elastic = {{ young = 20e6, poisson = 0.3, wrinkling = true }} }}
             specimen.mesh = {{ element = \"quad4\", size = 0.005 }}
             layers = {{ faces = [0.0, -0.03], prestrain = {{ md = 0.02, td = 0.02 }} }}
             frame.bars = {{ radius = 0.01, friction = 0.3 }}
             frame.clamp = {{ force = 30, friction = 0.5 }}
             impactor = {{ shape.sphere.radius = 0.03, mass = 0.5, friction = 0.3 }}
             loading.impact = {{ velocity = 2.0, duration = \"25 ms\" }}
             output = {{ frames = 2, filter = \"none\" }}"
        )))
    };
    let [quarter, whole] = ["quarter", "none"].map(of);
    for (name, bound) in
        [("displacement_m", 2e-3), ("contact_force_N", 3e-2), ("frame_force_N", 3e-2), ("clamp_slip_m", 2e-2)]
    {
        let [a, b] = [&quarter, &whole].map(|outcome| channel(&outcome.signals, name));
        claims.at_most(&format!("{name}, quarter and whole apart"), apart(a, b), bound);
    }
    for (words, outcome) in [("quarter", &quarter), ("whole", &whole)] {
        claims.at_most(&format!("{words}, energy balance error"), outcome.energy_balance_error, 1e-3);
    }
}
