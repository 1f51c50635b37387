//! Names of several impactors, and the times at which they are released.

use super::written::Written;
use crate::model::loading::{Impact, Impactors};
use crate::model::{Loading, ModelDiagnostics};
use crate::scenario::Guide;

/// Names that tell several impactors apart, and releases within the run.
pub(super) fn check(all: &[Written<'_>], loading: &Loading, has_bars: bool, mistakes: &mut ModelDiagnostics<'_>) {
    names(all, mistakes);
    let earliest = all.iter().min_by(|a, b| a.at.0.total_cmp(&b.at.0)).filter(|one| one.at.0 > 0.0);
    let earliest = earliest.filter(|_| loading.impactors() == Impactors::Free);
    // Of one whose `at` is to be left out, nothing else about it matters.
    let released_later = all.iter().filter(|one| earliest.is_none_or(|earliest| earliest.path != one.path));
    released_later.for_each(|one| released(one, loading, mistakes));
    if let Some(one) = earliest {
        let message = "no impactor is released at the start";
        mistakes.report_with(&one.key("at"), message, "the run starts with the first one: leave its `at` out");
    }
    if let [one] = all {
        let key = one.key("restitution");
        if mistakes.is_written(&key) && !has_bars {
            mistakes.out_of_place(&key, "there is no other impactor to meet, and the frame has no bars");
        }
    }
}

fn names(all: &[Written<'_>], mistakes: &mut ModelDiagnostics<'_>) {
    for (place, one) in all.iter().enumerate() {
        let key = one.key("name");
        let Some(name) = &one.name else {
            if all.len() > 1 {
                mistakes.missing(&key, "several impactors have names, with which those of their signals begin");
            }
            continue;
        };
        if !is_identifier(name) {
            let hint = "give a letter, then letters, digits and underscores: it is the beginning of names of columns";
            mistakes.report_with(&key, format!("\"{name}\" is no name of an impactor"), hint);
        }
        for earlier in &all[..place] {
            let Some(other) = &earlier.name else { continue };
            let begins = |long: &str, short: &str| long.strip_prefix(short).is_some_and(|rest| rest.starts_with('_'));
            if name == other {
                mistakes.report(&key, format!("two impactors have the name \"{name}\""));
            } else if name.eq_ignore_ascii_case(other) {
                let message = format!("the names \"{name}\" and \"{other}\" differ by case alone");
                mistakes.report_with(&key, message, "give names that nobody confuses");
            } else if begins(name, other) || begins(other, name) {
                let message = format!("columns of \"{name}\" and \"{other}\" cannot be told apart");
                mistakes.report_with(&key, message, "a name must not begin with another one and an underscore");
            } else {
                continue;
            }
            mistakes.label(&earlier.key("name"), "the other impactor");
        }
    }
}

/// Most letters of a name.
const LONGEST: usize = 32;

fn is_identifier(name: &str) -> bool {
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_word && name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.len() <= LONGEST && !name.ends_with('_')
}

/// A release after the start.
fn released(one: &Written<'_>, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) {
    let key = one.key("at");
    let Some(Impact { duration, .. }) = loading.impact() else {
        if mistakes.is_written(&key) {
            mistakes.out_of_place(&key, "an indentation prescribes the motion of the impactor");
        }
        return;
    };
    if one.at.0 <= 0.0 {
        return;
    }
    if one.guide == Guide::Fixed {
        mistakes.out_of_place(&key, "a fixed impactor is not released");
        return;
    }
    if one.at.0 >= *duration {
        mistakes.report(&key, "the impactor is released after the end of the run");
        mistakes.label("loading.impact.duration", "the run ends here");
    }
    if one.position.len() < 3 {
        let message = "an impactor that is released later needs a height";
        let hint = "give x, y and z: film moves, so that none is in contact with it by itself";
        mistakes.report_with(&one.key("position"), message, hint);
    }
}
