//! Meshes that are fine where they need to be: a dart ruptures film as on a mesh that is fine everywhere.

use droptower::model::Model;
use droptower::simulate::Outcome;

use super::claims::Claims;
use super::tower::{measured, run, written};

/// The template of `droptower new dart` with another mesh, a dart heavy enough to rupture the film, and `more` keys.
fn dart(mesh: &str, more: &str) -> Model {
    let template = include_str!("../../../src/cli/templates/dart.toml");
    let changed = |from: &str, to: &str, text: String| {
        assert!(text.contains(from), "the template has no {from}");
        text.replace(from, to)
    };
    let text = changed("mesh     = { element = \"quad4\", size = \"2 mm\" }", mesh, template.to_owned());
    let text = changed("\"100 g\"", "\"400 g\"", text);
    let text = changed("\"40 ms\"", "\"23 ms\"", text);
    written(&format!("{text}\n[layers]\nsettle = false\n{more}"))
}

/// Time, travel and peak force of a rupture.
fn rupture(model: &Model, outcome: &Outcome) -> [f64; 3] {
    let impact = measured(model, outcome);
    let time = outcome.rupture_time.expect("a rupture");
    let of =
        |name: &str| &outcome.signals.channels.iter().find(|channel| channel.name == name).expect("a channel").values;
    let sample = outcome.signals.time.partition_point(|at| *at < time);
    let force = of("contact_force_N").iter().copied().fold(0.0, f64::max);
    assert!(impact.audit.ruptured);
    [time, -of("displacement_m")[sample], force]
}

const FINE: &str = "mesh     = { element = \"quad4\", size = \"1.5 mm\" }";
const GRADED: &str = "mesh     = { element = \"quad4\", size = \"12 mm\", fine = \"1.5 mm\", around = \"impactor\" }";

/// docs/verification.md has the same with 0.5 mm under the tip.
#[test]
fn a_dart_ruptures_a_graded_film_as_one_that_is_fine_everywhere() {
    let mut claims = Claims::of("graded film");
    let cost = |outcome: &Outcome| outcome.elements as f64 * outcome.steps as f64;
    let reference = dart(FINE, "");
    let fine = run(&reference);
    let wanted = rupture(&reference, &fine);
    let scaled = "[solver]\nsmallest_step = \"2 us\"\n";
    for (name, more, least_steps) in [("graded", "", 1.0), ("graded, mass added", scaled, 0.9)] {
        let model = dart(GRADED, more);
        let graded = run(&model);
        claims.at_most(
            &format!("{name}: element steps over those of the fine film"),
            cost(&graded) / cost(&fine),
            0.25,
        );
        for ((what, found), wanted) in
            ["time, s", "travel, m", "peak force, N"].into_iter().zip(rupture(&model, &graded)).zip(wanted)
        {
            claims.near(&format!("{name}: {what}"), found, wanted, 0.01);
        }
        claims.at_most(&format!("{name}: balance error"), graded.energy_balance_error, 1e-3);
        let steps = graded.steps as f64 / fine.steps as f64;
        claims.at_most(&format!("{name}: steps over those of the fine film"), steps, least_steps);
        assert_eq!(graded.added_mass.len(), usize::from(!more.is_empty()));
    }
    claims.judge();
}
