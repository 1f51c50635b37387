//! Contact between faces: against thicker film and against membranes of revolution.

use super::axisymmetric::Sheet;
use super::claims::Claims;
use super::tower::{channel, largest, run, written};

/// A drop on `faces` (heights in mm) of `layers` each; friction on the impactor and between faces.
fn drop(faces: &str, layers: u32, [friction, between]: [f64; 2], film: bool) -> droptower::simulate::Outcome {
    let contact = if faces.contains(',') {
        format!("contact = {{ film = {film}, film_friction = {between} }}")
    } else {
        String::new()
    };
    run(&written(&format!(
        "specimen.shape = {{ rectangle = [\"240 mm\", \"240 mm\"] }}
         specimen.material = {{ density = 915, thickness = 12e-6, elastic = {{ young = 2e8, poisson = 0.3 }} }}
         specimen.mesh = {{ element = \"quad4\", size = \"10 mm\" }}
         specimen.symmetry = \"quarter\"
         layers = {{ count = {layers}, faces = [{faces}], prestrain = {{ md = 0.01, td = 0.01 }} }}
         impactor = {{ shape = {{ sphere = {{ radius = \"60 mm\" }} }}, mass = 2.0, friction = {friction} }}
         loading.impact = {{ velocity = 2.0, duration = \"40 ms\" }}
         {contact}
         output.frames = 2"
    )))
}

/// Eight layers that lie on each other are one membrane of eightfold thickness where nothing drags on them: all have
/// the same shape. With friction they are not: each layer takes its own share of the normal force along, so the film
/// sticks to the impactor no more than it did, and layers whose coefficient among each other is lower slip.
#[test]
fn eight_separate_layers_act_as_one_of_eightfold_thickness() {
    let mut claims = Claims::of("film on film");
    let heights: Vec<String> = (0..8).map(|k| format!("\"{:.3} mm\"", -0.012 * f64::from(k))).collect();
    let apart = heights.join(", ");
    let cases =
        [("without friction", [0.0, 0.0], 1e-2), ("friction 0.3 on the impactor and between layers", [0.3, 0.3], 1e-2)];
    for (what, friction, tolerance) in thorough::first(1, cases) {
        let (one, eight) = (drop("\"0 mm\"", 8, friction, false), drop(&apart, 1, friction, true));
        for (name, figure) in [("acceleration_m_s2", "peak deceleration"), ("displacement_m", "travel")] {
            let claim = format!("eight layers for one of eightfold thickness, {what}, {figure}");
            let [eight, one] = [&eight, &one].map(|outcome| largest(channel(&outcome.signals, name)));
            claims.near(&claim, eight, one, tolerance);
        }
        let distance = channel(&eight.signals, "film_distance_m");
        let least = distance.iter().copied().fold(f64::INFINITY, f64::min);
        let claim = format!("least distance over the thickness, {what}");
        claims.holds(&claim, &format!("{:.3}, at least 0.7", least / 12e-6), least > 0.7 * 12e-6);
        claims.at_most(&format!("energy balance error, {what}"), eight.energy_balance_error, 1e-3);
    }
}

/// A disc blown up from below presses on another one above it: the one bulges more, the other carries a part of the
/// pressure.
#[test]
fn two_discs_pressed_into_each_other_are_two_membranes_of_revolution() {
    let mut claims = Claims::of("film on film");
    let (radius, thickness, young, poisson) = (0.05, 50e-6, 50e6, 0.44);
    let pressure = 0.3 * young * thickness / radius;
    let sheet = Sheet { young, poisson, thickness, wrinkling: false };
    for (gap, guess) in thorough::first(1, [(0.002, [1.089, 1.064, 0.0451]), (0.006, [1.107, 1.042, 0.0352])]) {
        let size = thorough::choose(5, 3);
        let exact = sheet.pressed_on_another(radius, gap, pressure, guess);
        let outcome = run(&written(&format!(
            "specimen.shape = {{ circle = {{ radius = {radius} }} }}
             specimen.material = {{ density = 915, thickness = {thickness}, elastic = {{ young = {young}, poisson = {poisson} }} }}
             specimen.mesh = {{ element = \"quad4\", size = \"{size} mm\" }}
             specimen.symmetry = \"quarter\"
             layers.faces = [{gap}, 0.0]
             contact = {{ film = true, film_friction = 0.0 }}
             loading.pressure = {{ pressure = {pressure}, ramp = 0.5 }}
             output.frames = 2"
        )));
        let what = |claim: &str| format!("pressed discs, gap {:.0} mm, {claim}", 1e3 * gap);
        let last = outcome.snapshots.last().expect("a state");
        let heights = |face: usize| last.films[face].positions.iter().map(|x| f64::from(x[2]));
        let top = |face: usize| heights(face).fold(f64::NEG_INFINITY, f64::max);
        // The pole of the upper disc is that of the lower one; each counts from its own clamp.
        claims.near(&what("height of the lower disc"), top(1), exact[0], 5e-3);
        claims.near(&what("height of the upper disc"), top(0) - gap, exact[1], 5e-3);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
    }
}
