//! Contact of film with film.

use super::{Contact, Face, Impactor, Loading, ModelDiagnostics, layers};
use crate::scenario::{self, Scenario};
use base::number::significant;

/// Share of a distance that is round-off.
const ROUND_OFF: f64 = 1e-9;

pub(super) fn check(
    scenario: &Scenario,
    loading: &Loading,
    faces: Option<&[Face]>,
    impactors: &[Impactor],
    mistakes: &mut ModelDiagnostics<'_>,
) -> Contact {
    let scenario::Contact { film, itself, film_friction } = scenario.contact;
    let layers = scenario.layers.as_ref().map_or(1, |layers| layers.faces.len());
    let under_pressure = loading.is_by_gas() && loading.refuses_faces().is_none();
    let has_faces = layers.max(scenario.layer.len()) > 1;
    let can_meet = has_faces && (!scenario.impactor.is_empty() || under_pressure);
    let can_fold = !scenario.impactor.is_empty() || loading.is_by_gas();
    let meets_itself = itself && can_fold;
    if itself && !can_fold {
        mistakes.out_of_place("contact.itself", "neither an impactor nor a pressure folds the film");
    }
    if film && !can_meet {
        mistakes.out_of_place("contact.film", "no two faces can meet");
    }
    if film_friction.is_some() && !can_meet && !itself {
        mistakes.out_of_place("contact.film_friction", "no two faces are pressed on each other");
    }
    if has_faces && under_pressure {
        if !film {
            mistakes
                .missing("contact.film", "true: the pressure acts on the lowest face, which presses on those above it");
        }
        if film_friction.is_none() {
            mistakes.missing("contact.film_friction", "there is no impactor whose coefficient faces could have");
        }
    } else if meets_itself && scenario.impactor.is_empty() && film_friction.is_none() {
        mistakes.missing("contact.film_friction", "there is no impactor whose coefficient film on film could have");
    }
    for (place, pair) in faces.unwrap_or_default().windows(2).enumerate().filter(|_| film) {
        let thickness = |face: &Face| face.material.thickness * f64::from(face.layers);
        let [apart, needed] = [pair[0].height - pair[1].height, 0.5 * (thickness(&pair[0]) + thickness(&pair[1]))];
        if apart > 0.0 && apart < needed * (1.0 - ROUND_OFF) {
            let [apart, needed] = [apart, needed].map(|length| significant(1e6 * length, 3));
            let message = format!("the faces are {apart} um apart, closer than they are thick");
            let hint = format!("mount their middle surfaces at least {needed} um apart");
            mistakes.report_with(&layers::height_path(scenario, place + 1), message, hint);
        }
    }
    let film_friction = match film_friction {
        None if can_meet || meets_itself => of_impactors(impactors, mistakes),
        given => given,
    };
    Contact { film: can_meet && film, itself: meets_itself, film_friction }
}

/// The coefficient that film has on film where none is given: that of the impactors, which is assumed where they have
/// one in common. None where they differ: no impactor comes before another.
fn of_impactors(impactors: &[Impactor], mistakes: &mut ModelDiagnostics<'_>) -> Option<f64> {
    let (first, others) = impactors.split_first()?;
    let Some(place) = others.iter().position(|other| other.friction != first.friction) else {
        return Some(first.friction);
    };
    mistakes.missing("contact.film_friction", "the impactors differ in `friction`, so faces have none of theirs");
    mistakes.label(&format!("impactor.{}.friction", place + 1), "another coefficient than that of the first impactor");
    None
}
