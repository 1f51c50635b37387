//! Contact between faces of film.

use super::{Contact, Mistakes};
use crate::scenario::{self, Scenario};

pub(super) fn check(scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> Contact {
    let scenario::Contact { film, film_friction } = scenario.contact;
    let layers = scenario.layers.as_ref().map_or(1, |layers| layers.faces.len());
    let under_pressure = matches!(scenario.loading, scenario::Loading::Pressure(_));
    let has_faces = layers.max(scenario.layer.len()) > 1;
    let can_meet = has_faces && (!scenario.impactor.is_empty() || under_pressure);
    if film == Some(true) && !can_meet {
        mistakes.out_of_place("contact.film", "no two faces can meet");
    }
    if film_friction.is_some() && !can_meet {
        mistakes.out_of_place("contact.film_friction", "no two faces are pressed on each other");
    }
    if has_faces && under_pressure {
        if film == Some(false) {
            let hint = "the pressure acts on the lowest face, which has to press on those above it";
            mistakes.report_with("contact.film", "faces under pressure that do not meet", hint);
        }
        if film_friction.is_none() {
            mistakes.missing("contact.film_friction", "there is no impactor whose coefficient faces could have");
        }
    }
    Contact { film: can_meet && film.unwrap_or(true), film_friction }
}
