//! The energy balance of scenes that are written down as data.

use toml::{Table, Value};

use super::claims::Claims;
use super::tower::{last, run, written};

#[test]
fn energy_is_balanced_in_any_motion_and_where_bodies_meet() {
    let mut claims = Claims::of("energy balance");
    let text = include_str!("balanced.toml").replace("SIZE", thorough::choose("14 mm", "10 mm"));
    let file: Table = text.parse().expect("TOML");
    let cases = file["case"].as_array().expect("cases").iter().filter_map(Value::as_table);
    for case in cases.filter(|case| thorough::thorough() || !case.contains_key("thorough")) {
        let (name, mut scene) =
            (case["name"].as_str().expect("a name"), file["scene"].as_table().expect("keys").clone());
        let own = case.iter().filter(|(key, _)| !["name", "thorough", "collision", "force"].contains(&key.as_str()));
        scene.extend(own.map(|(key, value)| (key.clone(), value.clone())));
        let outcome = run(&written(&scene.to_string()));
        claims.at_most(&format!("{name}, energy balance error"), outcome.energy_balance_error, 1e-3);
        let forces = outcome.signals.channels.iter().filter(|channel| channel.name.ends_with("contact_force_N"));
        let least = case.get("force").and_then(Value::as_float).unwrap_or(10.0);
        let pressed = forces.flat_map(|channel| &channel.values).fold(0.0_f64, |most, force| most.max(force.abs()));
        let claim = format!("{name}, contact");
        claims.holds(&claim, &format!("largest force of the film {pressed:.1} N"), pressed > least);
        if let Some(least) = case.get("collision").and_then(Value::as_float) {
            let lost = last(&outcome.energies, "collision_J");
            claims.holds(&format!("{name}, they met"), &format!("{lost:.2} J lost in collisions"), lost > least);
        }
    }
}
