//! `droptower store why`: whether an evaluation would be computed, and what differs from the nearest that is stored.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::Folder;
use crate::changes::Changes;
use crate::scenarios::{self, Checked};
use crate::{Failure, Shared, checkpoint, complete, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::{grouped, wall_time};
use scene::model;
use scene::scenario::{Assignment, Document};
use study::evaluate::{
    Description, Difference, EvaluationError, EvaluationKeys, Evaluations, Found, KnownParts, Nearest,
    build_differences, build_name,
};
use study::store;

#[derive(Debug, Args)]
pub(crate) struct WhyArgs {
    /// The scenario
    #[arg(add = complete::scenarios())]
    pub scenario: PathBuf,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub folder: Folder,
}

/// Most keys that are named.
const MOST_KEYS: usize = 12;

/// Most differences of which it is tried whether they decide anything.
const MOST_TRIED: usize = 60;

pub(super) fn run(args: &WhyArgs, shared: &Shared) -> Result<(), Failure> {
    let document = scenarios::changed(&args.scenario, &args.changes.assignments()?)?;
    let checked = scenarios::of_document(document)?;
    let folder = &args.folder.store;
    let evaluations = Evaluations::open(folder).map_err(|error| failed(&error))?;
    let keys = keys(&checked).map_err(|error| failed(&error))?;
    let known = evaluations.known_parts(keys).map_err(|error| failed(&error))?;
    let here = Description::of_figures(&checked.document, &checked.model, &checked.plan);
    let nearest = match known.figures && known.run {
        true => Nearest::default(),
        false => Nearest::find(folder, &here).map_err(|error| failed(&evaluations.failed(error)))?,
    };
    let decided = nearest.found.iter().map(|found| (found, decisive(&checked, keys, found)));
    let decided = decided.min_by_key(|(found, differences)| (differences.len(), found.build != build_name()));
    let resumed = resumed(&checked);
    let figures = json!({
        "scenario": checked.model.name,
        "sweep": if known.figures { "stored" } else if known.run { "evaluated" } else { "computed" },
        "simulate": if known.run { "stored" } else { "computed" },
        "described": nearest.described,
        "undescribed": nearest.undescribed,
        "nearest": decided.as_ref().map(|(found, differences)| of_found(found, differences)),
        "checkpoint": resumed.as_ref().map(|verdict| match verdict {
            Ok(path) => json!({ "resumes_from": path }),
            Err(why) => json!({ "refused": why }),
        }),
    });
    print_figures(shared, &figures, || {
        let name = &checked.model.name;
        let mut lines = verdict(name, known);
        if !(known.figures && known.run) {
            lines.extend(nearest_lines(&nearest, decided.as_ref(), folder));
        }
        lines.extend(resumed.iter().map(|verdict| match verdict {
            Ok(path) => format!("  `droptower run --resume` continues from {}", shown_path(path)),
            Err(why) => format!("  `droptower run --resume` does not continue: {why}"),
        }));
        lines.join("\n")
    })
}

fn failed(error: &EvaluationError) -> Failure {
    let hint = error.hint().map(str::to_owned);
    Failure::output(Diagnostic { hint, ..Diagnostic::new(error.to_string()) })
}

fn keys(checked: &Checked) -> Result<EvaluationKeys, EvaluationError> {
    Evaluations::keys(&checked.model, &checked.plan)
}

/// What is computed, and by whom.
fn verdict(name: &str, known: KnownParts) -> Vec<String> {
    match known {
        KnownParts { figures: true, run: true } => vec![format!("{name}: is stored, nothing would be computed")],
        KnownParts { figures: true, run: false } => vec![
            format!("{name}: its figures are stored, a sweep would compute nothing"),
            "  `simulate()` in a script would compute it: its signals are not stored".into(),
        ],
        KnownParts { figures: false, run: true } => {
            vec![format!("{name}: its run is stored, only its figures would be evaluated again")]
        }
        KnownParts { figures: false, run: false } => vec![format!("{name}: would be computed")],
    }
}

/// What differs from the nearest evaluation.
fn nearest_lines(nearest: &Nearest, decided: Option<&(&Found, Vec<Difference>)>, folder: &Path) -> Vec<String> {
    let Nearest { described, undescribed, .. } = nearest;
    let mut lines = vec![];
    match decided {
        Some((found, differences)) => {
            let age = wall_time(found.age_s);
            let count = grouped(*described as u64);
            lines.push(format!("  the nearest of {count} in {} ({age} old):", shown_path(&found.segment)));
            lines.extend(differences.iter().take(MOST_KEYS).map(|difference| format!("    {}", words(difference))));
            if differences.len() > MOST_KEYS {
                lines.push(format!("    and {} more", differences.len() - MOST_KEYS));
            }
            let parts = build_differences(&found.build, build_name());
            if !parts.is_empty() {
                let parts: Vec<&str> = parts.into_iter().map(|part| part.words()).collect();
                lines.push(format!(
                    "    droptower {} computed it, this is {}: another {}",
                    found.build,
                    build_name(),
                    parts.join(", ")
                ));
            } else if differences.is_empty() {
                lines.push("    its description is the same: its record was removed, or is of a run alone".into());
            }
        }
        None => lines.push(format!("  nothing in {} has a description to compare with", shown_path(folder))),
    }
    if *undescribed > 0 {
        lines.push(format!(
            "  {} evaluations have no description: an older droptower wrote them",
            grouped(*undescribed as u64)
        ));
    }
    lines
}

/// A difference in words; that of a file names what changed.
fn words(difference: &Difference) -> String {
    let is_digest = |value: &Option<String>| value.as_deref().is_none_or(|value| value.contains(" bytes, checksum "));
    match difference {
        Difference { key, there: Some(_), here: Some(_) }
            if is_digest(&difference.there) && is_digest(&difference.here) =>
        {
            format!("the file of `{key}` has changed")
        }
        difference => difference.to_string(),
    }
}

fn of_found(found: &Found, differences: &[Difference]) -> Value {
    json!({
        "file": found.segment,
        "age_s": found.age_s,
        "build": found.build,
        "build_differs": build_differences(&found.build, build_name()),
        "differences": differences,
    })
}

/// The differences without those that decide nothing: another unit of the same quantity, a default that is written out.
fn decisive(checked: &Checked, keys: EvaluationKeys, found: &Found) -> Vec<Difference> {
    let decides = |difference: &Difference| {
        let same = with_theirs(&checked.document, difference).is_some_and(|keys_of| {
            let (own, theirs) = match found.description.has_figures() {
                true => (keys.figures, keys_of.figures),
                false => (keys.run, keys_of.run),
            };
            own == theirs
        });
        !same
    };
    let tried = found.differences.iter().take(MOST_TRIED).filter(|difference| decides(difference));
    tried.chain(found.differences.iter().skip(MOST_TRIED)).cloned().collect()
}

/// The keys of the evaluation with the value of the other one under one key; none where that is no scenario.
fn with_theirs(document: &Document, difference: &Difference) -> Option<EvaluationKeys> {
    let Difference { key, there, .. } = difference;
    let change = match there {
        Some(there) => Assignment::from_argument(&format!("{key}={there}")).ok()?,
        None => Assignment::unset(key, "why"),
    };
    let model = model::check(&document.with(&[change])).ok()?;
    let plan = study::post::Plan::prepare(&model).ok()?;
    Evaluations::keys(&model, &plan).ok()
}

/// What `--resume` would do at the place of the run's results.
fn resumed(checked: &Checked) -> Option<Result<PathBuf, String>> {
    let place = store::default_place(&checked.model.name).ok()?;
    checkpoint::verdict(checked, &place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_has_changed_is_named_by_its_key() {
        let value = |text: &str| Some(text.to_owned());
        let file = |there: &str, here: &str| Difference {
            key: "reference.signals".into(),
            there: value(there),
            here: value(here),
        };
        let words = words(&file("5 bytes, checksum 00000001", "5 bytes, checksum 00000002"));
        assert_eq!(words, "the file of `reference.signals` has changed");
        assert_eq!(super::words(&file("1", "2")), "there `reference.signals` is 1, here it is 2");
    }
}
