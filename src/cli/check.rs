//! `droptower check`: scenarios, materials and studies checked without running them, all mistakes at once.

use std::path::Path;
use std::{fs, io};

use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use crate::failure::refuse;
use crate::scenarios::{self, Selection};
use crate::{Failure, Shared, print_json, print_unless_quiet, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number;
use scene::model::{self, Guide, Impactor, Variation};
use scene::scenario::{Assignment, Document};
use scene::simulate;
use study::calibrate::StudyFile;
use study::scenario_functions::Scenarios;
use study::sweep;

/// Significant digits of lengths and moments.
const DIGITS: usize = 4;

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    pub selection: Selection,
}

/// The keys that vary from run to run of a sweep.
#[derive(Serialize)]
struct Varies {
    /// How the values are chosen.
    method: String,
    /// Number of runs; none where `-n` must give it.
    runs: Option<usize>,
    /// The keys, with their units, and their values in words.
    keys: Vec<[String; 2]>,
}

/// Centre of mass and moments of inertia of an impactor that may turn.
#[derive(Serialize)]
struct Inertia {
    impactor: String,
    #[serde(rename = "mass_kg")]
    mass: f64,
    /// In the coordinates of its shape.
    #[serde(rename = "centre_m")]
    centre: [f64; 3],
    /// About its own x, y and z through the centre of mass.
    #[serde(rename = "moments_kg_m2")]
    moments: [f64; 3],
}

/// The facts that are printed about a correct file.
#[derive(Default, Serialize)]
struct Facts {
    findings: Vec<Finding>,
    /// Of the impactors that may turn.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    inertias: Vec<Inertia>,
    /// Of a scenario that varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    variation: Option<Varies>,
}

/// The mistakes of one file, or what is reported of it without them, for a program.
#[derive(Serialize)]
struct Verdict<'a> {
    path: &'a str,
    ok: bool,
    mistakes: Vec<Value>,
    #[serde(flatten)]
    facts: &'a Facts,
}

/// The facts of a file, or its mistakes.
type Checked = Result<Facts, Failure>;

pub(super) fn run(args: &CheckArgs, shared: &Shared) -> Result<(), Failure> {
    let found = args.selection.each(check)?.into_iter();
    let found: Vec<(String, Checked)> = found.map(|(file, checked)| (shown_path(&file), checked)).collect();
    let mistakes = found.iter().filter_map(|(_, checked)| checked.as_ref().err());
    let wrong: Vec<Diagnostic> = mistakes.flat_map(|failure| &failure.diagnostics).cloned().collect();
    if shared.json {
        print_json(&found.iter().map(|(path, checked)| verdict(path, checked)).collect::<Vec<_>>())?;
        return if wrong.is_empty() { Ok(()) } else { Err(Failure::from(vec![])) };
    }
    let good = found.iter().filter_map(|(path, checked)| Some((path, checked.as_ref().ok()?)));
    let text = |(path, facts): (&String, &Facts)| {
        let inertias: String = facts.inertias.iter().map(Inertia::line).collect();
        let variation = facts.variation.as_ref().map_or_else(String::new, Varies::lines);
        format!("ok  {path}\n{inertias}{variation}{}", terminal::findings("  ", &facts.findings))
    };
    let good: String = good.map(text).collect();
    if !good.is_empty() {
        print_unless_quiet(shared, good.trim_end())?;
    }
    refuse(wrong)
}

/// Checks a scenario, a material or a study.
fn check(path: &Path, assignments: &[Assignment]) -> Checked {
    if StudyFile::is_study(path) {
        StudyFile::read(path)?.check(&Scenarios { changes: assignments.to_vec(), evaluations: None })?;
        return Ok(Facts::default());
    }
    if !Document::read(path).is_ok_and(|document| document.is_material()) {
        let checked = scenarios::check(path, assignments)?;
        let inertias = checked.model.impactors.iter().filter_map(Inertia::from_impactor).collect();
        let variation = model::variation(&checked.document)?;
        let mut findings = checked.plan.findings().to_vec();
        if let Some(variation) = &variation {
            let base = checked.document.without_variation();
            sweep::check_words(&base, variation)?;
            findings.extend(sweep::warnings(&base, variation).iter().map(Finding::new));
        }
        return Ok(Facts { findings, inertias, variation: variation.as_ref().map(Varies::from_variation) });
    }
    let material = Document::read_material(path)?.with(assignments);
    model::check_material(&material)?;
    let implausible = material.implausible().into_iter();
    let findings = implausible.map(|value| Finding::new(&model::Warning::Value(value))).collect();
    Ok(Facts { findings, ..Facts::default() })
}

/// Refuses a material that `droptower check` would refuse: the names and texts of its files, its own first.
pub(crate) fn material_texts(files: &[(&str, &str)]) -> Result<(), Failure> {
    let unwritten = |error: io::Error| Diagnostic::new(format!("no material: {error}"));
    let scratch = tempfile::tempdir().map_err(unwritten)?;
    let place = |name: &str| scratch.path().join(name);
    files.iter().try_for_each(|(name, text)| fs::write(place(name), text)).map_err(unwritten)?;
    model::check_material(&Document::read_material(&place(files[0].0))?)?;
    Ok(())
}

impl Varies {
    fn from_variation(variation: &Variation) -> Varies {
        let keys = variation.factors.iter().map(|factor| [factor.column(), factor.values.to_string()]);
        Varies { method: variation.description(), runs: variation.runs(), keys: keys.collect() }
    }

    fn lines(&self) -> String {
        let runs = self
            .runs
            .map_or_else(|| "runs as -n says".to_owned(), |runs| format!("{} runs", number::grouped(runs as u64)));
        let keys: String = self.keys.iter().map(|[key, values]| format!("    {key}: {values}\n")).collect();
        format!("  sweep: {runs}, {}\n{keys}", self.method)
    }
}

impl Inertia {
    /// The inertia of an impactor that may turn; none where its mesh cannot be used, which ends its run.
    fn from_impactor(impactor: &Impactor) -> Option<Inertia> {
        if !matches!(impactor.guide, Guide::Free | Guide::Hinge { .. }) {
            return None;
        }
        let surface = simulate::surface(&impactor.shape).ok()?;
        let homogeneous = surface.inertia_per_mass() * impactor.mass;
        let moments = impactor.inertia.unwrap_or_else(|| homogeneous.diagonal().into());
        Some(Inertia {
            impactor: impactor.words().to_owned(),
            mass: impactor.mass,
            centre: surface.centre().into(),
            moments,
        })
    }

    fn line(&self) -> String {
        let listed = |values: [f64; 3]| values.map(|value| number::figure(value, DIGITS)).join(", ");
        let (centre, moments) = (listed(self.centre.map(|x| 1e3 * x)), listed(self.moments));
        let Inertia { impactor, mass, .. } = self;
        format!(
            "  {impactor}: {mass} kg, centre of mass at {centre} mm of its shape, moments of inertia {moments} kg m2\n"
        )
    }
}

fn verdict(path: &str, checked: &Checked) -> Value {
    let (no_facts, no_mistakes) = (Facts::default(), vec![]);
    let (facts, mistakes) = match checked {
        Ok(facts) => (facts, &no_mistakes),
        Err(failure) => (&no_facts, &failure.diagnostics),
    };
    json!(Verdict { path, ok: checked.is_ok(), mistakes: mistakes.iter().map(mistake).collect(), facts })
}

fn mistake(found: &Diagnostic) -> Value {
    let start = found.span.as_ref().map(|span| span.start());
    json!({
        "message": found.message,
        "file": found.span.as_ref().map(|span| &span.source.name),
        "line": start.map(|(line, _)| line),
        "column": start.map(|(_, column)| column),
        "hint": found.hint,
    })
}
