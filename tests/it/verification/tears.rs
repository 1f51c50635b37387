//! When tears start on outlines meshed by the mesher, against the energy balance of a wide strip.

use std::fs;

use droptower::model::Model;

use super::axisymmetric::root;
use super::claims::Claims;
use super::tower::{last, run, written};

/// Length of the strip, its height as it is mounted, and length of its cut, mm.
const LENGTHS: [f64; 3] = [240.0, 105.0, 100.0];

/// Shear modulus of the rubber, Pa, and Γ, J/m².
const RUBBER: [f64; 2] = [395e3, 25e3];

/// Pre-strain along TD with which W H is so many times Γ: H is the height of the stress-free film (theory.md, equation 305).
fn prestrain(share: f64) -> f64 {
    let ([_, height, _], [mu, energy]) = (LENGTHS, RUBBER);
    let released = |strain: f64| {
        let stretch = 1.0 + strain;
        0.5 * mu * (stretch * stretch + stretch.powi(-2) - 2.0) * 1e-3 * height / stretch
    };
    root(|strain| released(strain) - share * energy, 3.0)
}

/// A place (mm) of the strip, from the middle of the edge that is cut, turned by so many degrees.
fn place([along, across]: [f64; 2], turned: f64) -> [f64; 2] {
    let (sin, cos) = turned.to_radians().sin_cos();
    [cos * along - sin * across, sin * along + cos * across]
}

/// Corners of the strip that is turned by so many degrees, mm.
fn corners(turned: f64) -> [[f64; 2]; 4] {
    let [length, height, _] = LENGTHS;
    let half = 0.5 * height;
    [[0.0, -half], [length, -half], [length, half], [0.0, half]].map(|corner| place(corner, turned))
}

/// The outline in the scenario.
fn polygon(turned: f64) -> String {
    let corners = corners(turned).map(|[x, y]| format!("[\"{x} mm\", \"{y} mm\"]"));
    format!("{{ points = [{}] }}", corners.join(", "))
}

/// The outline as a drawing, in which y points down.
fn drawing(turned: f64) -> String {
    let corners = corners(turned).map(|[x, y]| format!("{x},{}", -y));
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='600mm' height='600mm' viewBox='-300 -300 600 600'>\
         <polygon points='{}'/></svg>",
        corners.join(" ")
    )
}

/// The strip of this outline with a cut from one end along its middle, clamped all around and strained across the cut with the
/// energy of so many times Γ; a sphere far above the film falls beside it.
fn strip(outline: &str, turned: f64, element: &str, share: f64) -> Model {
    let ([_, _, cut], [mu, energy]) = (LENGTHS, RUBBER);
    let [[x0, y0], [x1, y1]] = [1.0, cut].map(|along| place([along, 0.0], turned));
    written(&format!(
        "specimen.shape = {{ polygon = {outline} }}
         specimen.cuts = [[[\"{x0} mm\", \"{y0} mm\"], [\"{x1} mm\", \"{y1} mm\"]]]
         specimen.md_angle = \"{turned} deg\"
         specimen.mesh = {{ element = \"{element}\", size = \"8.75 mm\" }}
         specimen.damping = \"100 1/s\"
         layers.prestrain = {{ md = 0.0, td = {} }}
         impactor = {{ shape = {{ sphere = {{ radius = \"10 mm\" }} }}, mass = \"1 g\", friction = 0.0, position = [\"0 mm\", \"0 mm\", \"300 mm\"] }}
         loading.impact = {{ velocity = \"0.01 m/s\", duration = \"25 ms\" }}
         output = {{ sample_rate = \"1 kHz\", filter = \"none\", frames = 1 }}
         [specimen.material]
         density = \"930 kg/m3\"
         thickness = \"0.5 mm\"
         hyperelastic = {{ law = \"neo-hookean\", mu = \"{mu} Pa\", wrinkling = true }}
         rupture = {{ criterion = \"strain\", limit = 8, energy = \"{energy} J/m2\" }}",
        prestrain(share)
    ))
}

/// A strip that rests with 1.05 Γ tears, and one with 0.95 Γ does not.
#[test]
fn a_cut_in_an_outline_tears_at_its_energy() {
    let mut claims = Claims::of("tears of outlines");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("outline.svg");
    fs::write(&file, drawing(0.0)).expect("a file");
    let drawn = format!("{{ file = '{}' }}", file.display());
    for (outline, turned) in thorough::first(1, [(drawn, 0.0), (polygon(22.5), 22.5), (polygon(45.0), 45.0)]) {
        for element in thorough::first(1, ["quad4", "tri3"]) {
            let [held, torn] = [0.95, 1.05]
                .map(|share| 1e3 * last(&run(&strip(&outline, turned, element, share)).signals, "torn_length_m"));
            let figures = format!("{held:.1} mm at 0.95 Γ, {torn:.1} mm at 1.05 Γ");
            claims.holds(&format!("{element}, turned by {turned}°, torn"), &figures, held == 0.0 && torn > 50.0);
        }
    }
}
