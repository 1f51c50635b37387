//! Several impactors: against single runs and closed forms, and the energy balance where they meet.

use super::claims::Claims;
use super::tower::{channel, largest, last, off, run, written};
use droptower::model::Model;
use droptower::simulate::{self, Fault, Outcome, RunError};

/// A square film with bodies over it; `impactors` are the items of `impactor`.
fn model(film: &str, impactors: &[String], loading: &str) -> Model {
    let impactors: Vec<String> =
        impactors.iter().map(|one| format!("{{ friction = 0.3, {} }}", one.replace('\n', " "))).collect();
    written(&format!(
        "specimen.material = {{ density = 915, thickness = 96e-6, elastic = {{ young = 50e6, poisson = 0.4, wrinkling = true }} }}
         {film}
         impactor = [{}]
         loading.impact = {{ {loading} }}
         output = {{ frames = 2, filter = \"none\" }}",
        impactors.join(", ")
    ))
}

/// A pre-strained square of `side` (m) with elements of 10 mm.
fn square(side: f64) -> String {
    format!(
        "specimen.shape = {{ rectangle = [{side}, {side}] }}
         specimen.mesh = {{ element = \"quad4\", size = \"10 mm\" }}
         layers.prestrain = {{ md = 0.02, td = 0.02 }}"
    )
}

fn ball(name: &str, radius: f64, mass: f64, more: &str) -> String {
    format!("name = \"{name}\", shape = {{ sphere = {{ radius = {radius} }} }}, mass = {mass}, {more}")
}

fn values<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    channel(&outcome.signals, name)
}

/// Two balls fall on a sheet a metre wide, so far from each other that no wave comes from one to the other within the
/// run: at 170 m/s in 2 ms 0.34 m. Then the second one later.
#[test]
fn bodies_far_from_each_other_are_single_runs() {
    let mut claims = Claims::of("several");
    let at = |place: f64| format!("position = [{place}, 0], velocity = [0, 0, -5]");
    let balls = [ball("left", 0.03, 0.2, &at(-0.25)), ball("right", 0.03, 0.1, &at(0.25))];
    let sheet = square(1.0);
    let both = run(&model(&sheet, &balls, "duration = 0.002"));
    for (name, alone) in ["left", "right"].into_iter().zip(&balls) {
        let alone = run(&model(&sheet, std::slice::from_ref(alone), "duration = 0.002"));
        // Both have one time step, which decides at which sample nodes come into contact.
        for (column, bound) in
            [("displacement_m", 1e-5), ("velocity_m_s", 1e-5), ("contact_force_N", 5e-3), ("absorbed_energy_J", 1e-3)]
        {
            let figure = off(values(&both, &format!("{name}_{column}")), values(&alone, column));
            claims.at_most(&format!("two bodies apart, {name}, {column} off that of the body alone"), figure, bound);
        }
    }
    claims.at_most("two bodies apart, energy balance error", both.energy_balance_error, 1e-3);
}

/// A ball that is released over a film at rest is a ball that starts there.
#[test]
fn a_release_starts_the_run_of_its_body() {
    let mut claims = Claims::of("several");
    let start = "position = [0.05, 0, 0.05], velocity = [0, 0, -3]";
    let late = ball("late", 0.04, 0.5, &format!("{start}, at = 0.01"));
    // Beside the film.
    let idle = ball("idle", 0.01, 1.0, "position = [1, 1, 0], velocity = [0, 0, 0]");
    let outcome = run(&model(&square(0.4), &[idle, late], "duration = 0.04"));
    let alone = run(&model(&square(0.4), &[ball("late", 0.04, 0.5, start)], "duration = 0.03"));
    let shift = (0.01 / (outcome.signals.time[1] - outcome.signals.time[0])).round() as usize;
    for column in ["displacement_m", "velocity_m_s", "contact_force_N"] {
        let figure = off(&values(&outcome, &format!("late_{column}"))[shift..], values(&alone, column));
        // It is released at the first full step after its time.
        claims.at_most(&format!("released after 10 ms, {column} off that of the run that starts then"), figure, 5e-3);
    }
    let before = |name: &str| largest(&values(&outcome, name)[..shift]);
    let still = before("late_velocity_m_s").max(before("late_acceleration_m_s2"));
    claims.at_most("held before, largest velocity or acceleration", still, 0.0);
    claims.at_most("released, energy balance error", outcome.energy_balance_error, 1e-3);
}

/// Two balls in flight meet head on, and beside their line of flight, without friction.
#[test]
fn impactors_collide_by_the_closed_form() {
    let mut claims = Claims::of("several");
    let film = "specimen.shape = { rectangle = [0.1, 0.1] }\nspecimen.mesh = { element = \"quad4\", size = \"20 mm\" }";
    for (e, beside) in [(0.0, 0.0), (0.6, 0.0), (0.6, 0.06), (1.0, 0.0)] {
        let free = |name: &str, mass: f64, place: [f64; 2], speed: f64, e: f64| {
            let [x, y] = place;
            format!(
                "name = \"{name}\", shape = {{ sphere = {{ radius = 0.05 }} }}, mass = {mass}, guide = \"free\",
                 position = [{x}, {y}, 1], velocity = [{speed}, 0, 0], restitution = {e}"
            )
        };
        let line = [(1.0 - (beside / 0.1_f64).powi(2)).sqrt(), beside / 0.1];
        let other = [1.0 + 0.1 * line[0] + 1e-3, beside];
        let bodies = [free("a", 2.0, [1.0, 0.0], 3.0, e), free("b", 0.7, other, -1.0, 1.0)];
        let outcome = run(&without_friction(film, &bodies));
        // Along the line of centres the impulse of two masses, across it nothing.
        let impulse = 2.0 * 0.7 / 2.7 * (1.0 + e) * 4.0 * line[0];
        // Balls that meet beside their line of flight turn it in the step in which they meet.
        let bound = if beside == 0.0 { 1e-9 } else { 5e-3 };
        for (body, start, sign) in [("a", 3.0, -1.0 / 2.0), ("b", -1.0, 1.0 / 0.7)] {
            for (name, start, along) in [("x", start, line[0]), ("y", 0.0, line[1])] {
                let found = last(&outcome.signals, &format!("{body}_velocity_{name}_m_s"));
                let what = format!("restitution {e}, {beside} m beside, {body}, off its velocity along {name}, m/s");
                claims.at_most(&what, (found - (start + sign * impulse * along)).abs(), bound);
            }
        }
        let of = |body: &str, axis: &str| last(&outcome.signals, &format!("{body}_velocity_{axis}_m_s"));
        let momentum = |axis: &str| 2.0 * of("a", axis) + 0.7 * of("b", axis);
        claims.at_most("momentum along x off the first, N s", (momentum("x") - 5.3).abs(), 1e-12);
        claims.at_most("momentum along y, N s", momentum("y").abs(), 1e-12);
        let lost = last(&outcome.energies, "collision_J");
        let formula = 0.5 * (1.0 - e * e) * 2.0 * 0.7 / 2.7 * (4.0 * line[0]).powi(2);
        claims.at_most("energy lost off the closed form, J", (lost - formula).abs(), 2.0 * bound);
        claims.at_most("energy balance error", outcome.energy_balance_error, 1e-9);
    }
}

fn without_friction(film: &str, bodies: &[String]) -> Model {
    let mut model = model(film, bodies, "duration = 0.002, gravity = 0");
    model.impactors.iter_mut().for_each(|impactor| impactor.friction = 0.0);
    model
}

/// What overlaps is refused by name, at the start and at a release.
#[test]
fn bodies_inside_each_other_are_refused() {
    let fails = |bodies: &[String]| {
        simulate::run(&model(&square(0.4), bodies, "duration = 0.02"), &mut |_| {}).expect_err("an error")
    };
    let inside = fails(&[
        ball("one", 0.05, 1.0, "velocity = [0, 0, -1]"),
        ball("other", 0.05, 1.0, "position = [0.06, 0], velocity = [0, 0, -1]"),
    ]);
    assert_eq!(inside.to_string(), "the impactors \"one\" and \"other\" start 40 mm inside each other");
    let late =
        |z: f64| ball("late", 0.05, 1.0, &format!("position = [0.06, 0, {z}], velocity = [0, 0, -1], at = 0.005"));
    for (z, into) in [(0.02, "the film"), (0.06, "the impactor \"one\"")] {
        let released = fails(&[ball("one", 0.05, 1.0, "velocity = [0, 0, -1]"), late(z)]);
        let RunError::Failure(failure) = &released else { panic!("{released}") };
        let Fault::ReleasedInside { name, inside, time, .. } = &failure.cause else { panic!("{released}") };
        assert_eq!((name.as_str(), inside.as_str()), ("late", into), "{released}");
        assert!((time - 0.005).abs() < 1e-4, "{released}");
    }
}
