//! Film that hardens by a power of its strain: its stress with the width held, and the strain from which it strains on under
//! a falling force (Swift, J. Mech. Phys. Solids 1, 1952).

use droptower::material::{Elastic, FlowCurve, FlowRate, Hardening, Hill, Law, Material, Plastic};
use droptower::model::Model;
use droptower::simulate::{self, Across, Warning};

use super::claims::Claims;
use super::sheet;
use super::tower::{channel, codes, run, written};

/// σ = K pⁿ.
const STRENGTH: f64 = 50e6;
/// Young's modulus of one element: stiff against the flow stress, so that elastic strains do not count.
const STIFF: f64 = 50e9;
/// That of a strip, whose elastic strains are a hundredth and whose time step is five times as long.
const YOUNG: f64 = 2e9;

/// Von Mises film that hardens with the exponent `n`.
fn film(n: f64, young: f64) -> Material {
    let curve: Vec<[f64; 2]> =
        (0..=2000).map(|k| 5e-4 * f64::from(k)).map(|p| [p, STRENGTH * p.max(1e-4).powf(n)]).collect();
    let hardening = Hardening::Table(FlowCurve::new(&curve).expect("a flow curve"));
    let elastic = Elastic { young, poisson: 0.49 };
    let law = Law::Plastic(Plastic::new(elastic, Hill::default(), hardening, FlowRate::Independent));
    Material { law, ..sheet::elastic(1.0, 0.0) }
}

/// A strip of that film between jaws, until the engineering strain `until`.
fn strip(n: f64, young: f64, lengths: &str, until: f64) -> Model {
    let mut model = written(&format!(
        "specimen.shape = {{ rectangle = {lengths} }}
         specimen.mesh = {{ element = \"quad4\", size = \"1 mm\" }}
         specimen.material = {{ density = 920, thickness = 1e-4, plastic = {{ young = \"1 GPa\", poisson = 0.49, hardening = {{ curve = [[0, \"8 MPa\"], [1, \"20 MPa\"]] }} }} }}
         loading.stretch = {{ direction = \"MD\", velocity = \"5 m/s\", until = {until} }}
         output = {{ sample_rate = \"100 kHz\", frames = 2 }}"
    ));
    model.faces[0].material = film(n, young);
    model
}

/// Of von Mises film whose width is held: p = 2 ε/√3 and σ = 2 σ_y(p)/√3.
#[test]
fn film_whose_width_is_held_has_the_stress_of_plane_strain() {
    let mut claims = Claims::of("plane strain");
    let factor = 2.0 / 3.0_f64.sqrt();
    for n in [0.0, 0.1, 0.3] {
        let strains = [0.05, 0.1, 0.2, 0.4, 0.6_f64];
        let model = strip(n, STIFF, "[\"1 mm\", \"1 mm\"]", 0.5);
        let found = simulate::pull(&model, &strains.map(f64::exp_m1), Across::Held).expect("stresses");
        for (strain, nominal) in strains.iter().zip(found) {
            let expected = factor * STRENGTH * (factor * strain).powf(n);
            claims.near(&format!("n {n}, logarithmic strain {strain}, Pa"), nominal * strain.exp(), expected, 5e-3);
        }
    }
}

/// Logarithmic strain at which the nominal stress of a single element is largest, by a parabola through three points.
fn of_largest_force(n: f64, across: Across) -> f64 {
    let strains: Vec<f64> = (1..=300).map(|k| 1.5 * n * f64::from(k) / 300.0).collect();
    let stretched: Vec<f64> = strains.iter().map(|strain| strain.exp_m1()).collect();
    let found = simulate::pull(&strip(n, STIFF, "[\"1 mm\", \"1 mm\"]", 0.5), &stretched, across).expect("stresses");
    let top = (1..found.len() - 1).max_by(|a, b| found[*a].total_cmp(&found[*b])).expect("a largest");
    let [before, at, after] = [found[top - 1], found[top], found[top + 1]];
    strains[top] + 0.5 * (before - after) / (before - 2.0 * at + after) * (strains[1] - strains[0])
}

/// The force of uniaxial tension is largest at ε = n, that of plane strain at ε = n, p = 2 n/√3, and that of equibiaxial
/// tension at ε = n in either direction, p = 2 n.
#[test]
fn the_largest_force_is_at_swifts_strain() {
    let mut claims = Claims::of("instability, one element");
    for n in thorough::first(1, [0.2, 0.1, 0.3]) {
        for (name, across) in
            [("uniaxial", Across::Free), ("plane strain", Across::Held), ("equibiaxial", Across::Equal)]
        {
            claims.near(&format!("{name}, n {n}, logarithmic strain"), of_largest_force(n, across), n, 2e-2);
        }
    }
}

/// A meshed strip, which strains evenly up to the largest force and necks beyond. The neck is as long as the strip is wide
/// at first, so that an element is strained as its neighbours are; the finding comes when the neck has become a row of
/// elements, while the force falls: by then the strip has become longer than at the largest force by up to twice its width,
/// all of it the neck's.
#[test]
fn a_strip_localises_beyond_swifts_strain_and_says_so() {
    let mut claims = Claims::of("instability, strip");
    let [length, width] = [0.04, 0.005];
    for n in thorough::first(1, [0.2_f64, 0.1]) {
        // With the elastic strain e = σ/E, σ is largest as dσ/dε = σ: p = n (1 − e), ε = p + e.
        let elastic = STRENGTH * n.powf(n) / YOUNG;
        let (even, swift) = ((n * (1.0 - elastic) + elastic).exp_m1(), n.exp_m1());
        for (until, expected) in thorough::first(1, [(2.5 * swift, true), (swift, false)]) {
            let outcome = run(&strip(n, YOUNG, "[\"40 mm\", \"5 mm\"]", until));
            let found = outcome.warnings.iter().find_map(|warning| match warning {
                Warning::StrainLocalisation { time, strain, .. } => Some((*time, *strain)),
                _ => None,
            });
            claims.holds(&format!("n {n}, until {until:.3}"), &codes(&outcome).join(", "), found.is_some() == expected);
            let Some((time, largest)) = found.filter(|_| expected) else { continue };
            let [strain, stress] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
            let top = (0..stress.len()).max_by(|a, b| stress[*a].total_cmp(&stress[*b])).expect("a largest");
            let at = outcome.signals.time.partition_point(|sampled| *sampled < time);
            claims.near(&format!("n {n}, engineering strain at the largest force"), strain[top], even, 0.1);
            claims.at_most(&format!("n {n}, Swift's strain over the mean one at the finding"), swift / strain[at], 1.0);
            let longer = (strain[at] - strain[top]) * length / width;
            let claim = format!("n {n}, elongation from the largest force to the finding, over the width");
            claims.at_most(&claim, longer, 2.0);
            claims.at_most(&format!("n {n}, Swift's strain over that of the element"), swift / largest, 0.5);
            claims.at_most(&format!("n {n}, force at the finding over the largest"), stress[at] / stress[top], 0.9);
            claims.at_most(&format!("n {n}, energy balance error"), outcome.energy_balance_error, 1e-3);
        }
    }
}
