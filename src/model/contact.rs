//! Contact between faces of film.

use super::Mistakes;
use crate::scenario::Scenario;

/// Coefficient between faces, where it is given.
pub fn check(scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> Option<f64> {
    let friction = scenario.contact.film_friction?;
    let layers = scenario.layers.as_ref().map_or(1, |layers| layers.faces.len());
    if scenario.impactor.is_empty() || layers.max(scenario.layer.len()) < 2 {
        mistakes.out_of_place("contact.film_friction", "no two faces are pressed on each other by an impactor");
    }
    Some(friction)
}
