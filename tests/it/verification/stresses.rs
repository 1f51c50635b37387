//! Stress and thickness of snapshots, against what the run itself measures and against a closed form.

use droptower::model::Model;
use droptower::simulate::{self, Detail, FilmState, Outcome, RunOptions};

use super::axisymmetric::Sheet;
use super::claims::Claims;
use super::tower::{run, shipped, written};

/// Runs `model` with detailed states.
fn detailed(model: &Model) -> Outcome {
    let options = RunOptions { detailed: true, ..RunOptions::default() };
    simulate::run_with(model, options, &mut |_| {}).unwrap_or_else(|error| panic!("{}: {error}", model.name))
}

fn detail(state: &FilmState) -> &Detail {
    state.detail.as_ref().expect("a detailed state")
}

/// The force of the jaws over the stress-free section is the stress along the fibres.
#[test]
fn the_stress_of_a_fibre_is_that_of_the_jaws() {
    let mut claims = Claims::of("stress of snapshots");
    for (name, fibre) in [("md", 0), ("td", 1)] {
        let model = shipped(&format!("stretch/{name}-0.02.toml"), &[]);
        let outcome = detailed(&model);
        claims.holds(&format!("{name}: the same signals without"), "", outcome.signals == run(&model).signals);
        let signal = outcome.signals.series("stress_Pa").expect("a stress");
        let largest = signal.largest().expect("a peak")[1];
        let held = outcome.snapshots.iter().filter(|snapshot| !snapshot.films[0].failed[0]);
        let off = held.filter_map(|snapshot| {
            let stress = detail(&snapshot.films[0]).stresses[0][fibre];
            Some((f64::from(stress) - signal.value_at(snapshot.time)?).abs() / largest)
        });
        let off: Vec<f64> = off.collect();
        claims.at_most(&format!("{name}: states without one, of 60"), 60.0 - off.len() as f64, 2.0);
        claims.at_most(&format!("{name}: stress off the signal"), off.iter().fold(0.0, |m, o| m.max(*o)), 1e-5);
    }
}

/// At the pole of an inflated disc the stretch is equal in all directions, and stress and thickness follow from it.
#[test]
fn the_pole_of_an_inflated_disc_is_in_equibiaxial_tension() {
    let mut claims = Claims::of("stress and thickness at the pole");
    let (radius, pressure) = (0.05, 15e3);
    let sheet = Sheet { young: 50e6, poisson: 0.44, thickness: 50e-6, wrinkling: false };
    let outcome = detailed(&written(&format!(
        "specimen.shape = {{ circle = {{ radius = {radius} }} }}
         specimen.material = {{ density = 915, thickness = {}, elastic = {{ young = {}, poisson = {} }} }}
         specimen.mesh.size = \"5 mm\"
         specimen.symmetry = \"quarter\"
         loading.pressure = {{ pressure = {pressure}, ramp = 0.1 }}
         output.frames = 2",
        sheet.thickness, sheet.young, sheet.poisson
    )));
    let stretch = sheet.inflated(radius, radius, pressure).stretch[0][0];
    let (film, state) = (&outcome.films[0], &outcome.snapshots.last().expect("a state").films[0]);
    let pole = |node: &u32| state.positions[*node as usize][..2].iter().all(|c| c.abs() < 1e-6);
    let element = film.quads.iter().position(|quad| quad.iter().any(pole)).expect("the pole");
    let Detail { stresses, .. } = detail(state);
    let stress = sheet.first(stretch, stretch);
    for (fibre, name) in ["MD", "TD"].iter().enumerate() {
        claims.near(&format!("stress along {name}, Pa"), stresses[element][fibre].into(), stress, 1e-2);
    }
    claims.at_most("shear over stress", f64::from(stresses[element][2].abs()) / stress, 2e-2);
    // E33 = −ν/(1−ν)·(E11 + E22) in plane stress.
    let across = -sheet.poisson / (1.0 - sheet.poisson) * (stretch * stretch - 1.0);
    let claim = "thickness over stress-free thickness";
    claims.near(claim, state.thickness_ratio[element].into(), (1.0 + 2.0 * across).sqrt(), 5e-3);
}
