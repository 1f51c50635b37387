//! Meshes that are fine where they need to be: a dart ruptures film as on a mesh that is fine everywhere.

use droptower::model::Model;
use droptower::simulate::{self, Outcome, Warning};

use super::claims::Claims;
use super::tower::{run, written};

/// A dart of 400 g on `mesh` of film of 50 um, which it ruptures, with `more` keys.
fn dart(mesh: &str, more: &str) -> Model {
    written(&format!(
        "specimen.shape = {{ circle = {{ radius = \"63.5 mm\" }} }}
         specimen.symmetry = \"quarter\"
         specimen.mesh = {mesh}
         layers.settle = false
         impactor = {{ shape = {{ hemisphere = {{ radius = \"19.05 mm\" }} }}, mass = \"400 g\", friction = 0.3 }}
         loading.impact = {{ drop_height = \"0.66 m\", duration = \"23 ms\" }}
         output = {{ sample_rate = \"20 kHz\", filter = \"none\" }}
         {more}
         [specimen.material]
         density = \"915 kg/m3\"
         thickness = \"50 um\"
         [specimen.material.fabric]
         md = {{ yield = [[0.26, \"8.4 MPa\"], [0.84, \"20 MPa\"]], break = [1.39, \"29.3 MPa\"] }}
         td = {{ yield = [[0.33, \"8 MPa\"], [0.69, \"10 MPa\"]], break = [7.01, \"16.2 MPa\"] }}
         shear = {{ curve = [[0.3, \"4 MPa\"], [1.5, \"8 MPa\"]] }}
         absorption = 0.89"
    ))
}

/// Time, travel and peak force of a rupture.
fn rupture(outcome: &Outcome) -> [f64; 3] {
    let time = outcome.rupture_time.expect("a rupture");
    let of =
        |name: &str| &outcome.signals.channels.iter().find(|channel| channel.name == name).expect("a channel").values;
    let sample = outcome.signals.time.partition_point(|at| *at < time);
    let force = of("contact_force_N").iter().copied().fold(0.0, f64::max);
    [time, -of("displacement_m")[sample], force]
}

const FINE: &str = "{ element = \"quad4\", size = \"1.5 mm\" }";
const GRADED: &str = "{ element = \"quad4\", size = \"12 mm\", fine = \"1.5 mm\", around = \"impactor\" }";

#[test]
fn a_dart_ruptures_a_graded_film_as_one_that_is_fine_everywhere() {
    let mut claims = Claims::of("graded film");
    let cost = |outcome: &Outcome| outcome.elements as f64 * outcome.steps as f64;
    let reference = dart(FINE, "");
    let fine = run(&reference);
    let wanted = rupture(&fine);
    let scaled = "solver.smallest_step = \"2 us\"";
    for (name, more, least_steps) in [("graded", "", 1.0), ("graded, mass added", scaled, 0.9)] {
        let model = dart(GRADED, more);
        let graded = run(&model);
        let claim = format!("{name}: element steps over those of the fine film");
        claims.at_most(&claim, cost(&graded) / cost(&fine), 0.25);
        for ((what, found), wanted) in
            ["time, s", "travel, m", "peak force, N"].into_iter().zip(rupture(&graded)).zip(wanted)
        {
            claims.near(&format!("{name}: {what}"), found, wanted, 0.01);
        }
        claims.at_most(&format!("{name}: balance error"), graded.energy_balance_error, 1e-3);
        let steps = graded.steps as f64 / fine.steps as f64;
        claims.at_most(&format!("{name}: steps over those of the fine film"), steps, least_steps);
        assert_eq!(graded.added_mass.len(), usize::from(!more.is_empty()));
    }
}

/// An elastic sheet of equal squares, whose elements all have one stable time step, under a ball.
fn sheet(mesh: &str, impactor: &str, more: &str) -> Model {
    written(&format!(
        "[specimen]
shape = {{ rectangle = [\"0.4 m\", \"0.4 m\"] }}
mesh = {mesh}
material = {{ density = \"1000 kg/m3\", thickness = \"50 um\", elastic = {{ young = \"50 MPa\", poisson = 0.3 }} }}
[impactor]
shape = {{ sphere = {{ radius = \"20 mm\" }} }}
mass = \"100 g\"
friction = 0.2
{impactor}
[output]
sample_rate = \"10 kHz\"
filter = \"none\"
{more}"
    ))
}

const FALLING: &str = "[loading.impact]\nvelocity = \"2 m/s\"\nduration = \"20 ms\"";

/// Along a line of 45 degrees, whatever its speed and gravity, the ball goes as far across as it comes down.
#[test]
fn elements_are_fine_where_a_line_meets_the_film() {
    let line = "guide = { line = [1, 0, -1] }\nposition = [\"-100 mm\", \"30 mm\", \"140 mm\"]";
    let model = sheet("{ size = \"20 mm\", fine = \"5 mm\" }", line, FALLING);
    let zones = &model.faces[0].meshing.grading.as_ref().expect("fine elements").zones;
    let [x, y] = zones[0].at;
    assert!((x - 0.02).abs() < 1e-12 && (y - 0.03).abs() < 1e-12, "{x} {y}");
}

/// Theory, equation (17d): twice the step takes four times the mass where all elements are alike, and where they are
/// not just the small ones get mass.
#[test]
fn added_mass_gives_elements_the_step_that_was_asked_for() {
    let mut claims = Claims::of("added mass");
    let equal = "{ size = \"20 mm\" }";
    let graded = "{ size = \"20 mm\", fine = \"5 mm\" }";
    let step = |model: &Model| simulate::engine(model).expect("an engine").time_step();
    for (name, mesh, share) in [("equal squares", equal, Some(3.0)), ("graded", graded, None)] {
        let own = step(&sheet(mesh, FALLING, ""));
        let model = sheet(mesh, FALLING, &format!("[solver]\nsmallest_step = {:e}", 2.0 * own));
        claims.near(&format!("{name}: step, s"), step(&model), 2.0 * own, 1e-12);
        let outcome = run(&model);
        let [added] = outcome.added_mass[..] else { panic!("one face") };
        claims.near(&format!("{name}: mass of the film, kg"), added.own, 0.4 * 0.4 * 50e-6 * 1000.0, 1e-12);
        match share {
            Some(share) => {
                claims.near(&format!("{name}: added mass over it"), added.mass / added.own, share, 1e-12);
                assert_eq!(added.elements, outcome.elements);
            }
            None => {
                claims.at_most(&format!("{name}: added mass over it"), added.mass / added.own, 1.0);
                assert!(0 < added.elements && added.elements < outcome.elements, "{}", added.elements);
            }
        }
        claims.at_most(&format!("{name}: balance error"), outcome.energy_balance_error, 1e-3);
        assert!(outcome.warnings.iter().any(|warning| matches!(warning, Warning::AddedMass { face: 1, .. })));
    }
}

/// The place where a ball thrown obliquely meets the film, from its flight.
#[test]
fn elements_are_fine_where_the_impactor_meets_the_film() {
    let mut claims = Claims::of("graded around the impactor");
    let mesh = "{ size = \"20 mm\", fine = \"5 mm\", around = \"impactor\" }";
    let thrown = "guide = \"free\"
position = [\"-30 mm\", \"10 mm\", \"100 mm\"]
velocity = [\"1 m/s\", \"0.5 m/s\", \"-2 m/s\"]
[loading.impact]
duration = \"10 ms\"";
    let model = sheet(mesh, thrown, "");
    let [zone] = model.faces[0].meshing.grading.as_ref().expect("a grading").zones[..] else { panic!("one zone") };
    // 80 mm down at 2 m/s and 9.81 m/s2.
    let time = ((4.0_f64 + 2.0 * 9.81 * 0.08).sqrt() - 2.0) / 9.81;
    claims.near("x, m", zone.at[0], -0.03 + time, 1e-12);
    claims.near("y, m", zone.at[1], 0.01 + 0.5 * time, 1e-12);
    claims.near("radius, m", zone.within, 0.02, 1e-12);
}
