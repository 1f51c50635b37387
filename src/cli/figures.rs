//! `droptower explain FIGURE` and `droptower explain figures`: what a figure of `summary.json` is, and of which runs.

use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use lab::signal::column;
use study::post::{self, FigureName, HEADLINES, Headline};

/// The word in place of a key that lists all figures.
pub(super) const WORD: &str = "figures";

/// A figure as it is explained.
#[derive(Serialize)]
struct Explanation {
    figure: String,
    /// The beginning of its name, where it is that of one of several impactors.
    impactor: Option<String>,
    sentence: String,
    unit: &'static str,
    loadings: Vec<&'static str>,
    script: String,
}

/// Prints what the figure `name` is; false where no run has one.
pub(super) fn run(name: &str, shared: &Shared) -> Result<bool, Failure> {
    let all = post::figures();
    // `E_a` of a page and of the terminal is `acceleration_error`.
    let symbol = |headline: &&Headline| headline.words.rsplit(' ').next() == Some(name) && name.contains('_');
    let name = HEADLINES.iter().find(symbol).map_or(name, |headline| headline.name);
    let exact = all.iter().filter(|figure| figure.name == name).map(|figure| (None, figure));
    let mut found: Vec<Explanation> = exact.map(|found| explanation(name, found)).collect();
    if found.is_empty() {
        let of_impactor = |figure: &FigureName| {
            let prefix = name.strip_suffix(&figure.name)?.strip_suffix('_')?;
            (figure.is_of_each_impactor && !prefix.is_empty()).then(|| prefix.to_owned())
        };
        let all = all.iter().filter_map(|figure| Some((Some(of_impactor(figure)?), figure)));
        let shortest = all.min_by_key(|(prefix, _)| prefix.as_ref().map(String::len));
        found.extend(shortest.map(|found| explanation(name, found)));
    }
    if !found.is_empty() {
        show(&found, shared)?;
    }
    Ok(!found.is_empty())
}

/// Prints what every figure is.
pub(super) fn all(shared: &Shared) -> Result<(), Failure> {
    show(&post::figures().iter().map(|figure| explanation(&figure.name, (None, figure))).collect::<Vec<_>>(), shared)
}

/// All names of figures.
pub(super) fn names() -> impl Iterator<Item = String> {
    post::figures().into_iter().map(|figure| figure.name)
}

fn explanation(name: &str, (impactor, figure): (Option<String>, &FigureName)) -> Explanation {
    Explanation {
        figure: name.to_owned(),
        impactor,
        sentence: figure.sentence.clone(),
        unit: column::dimension(&figure.name).map_or("", |dimension| dimension.unit),
        loadings: figure.loadings.clone(),
        script: format!("run.summary.{name}"),
    }
}

fn show(explanations: &[Explanation], shared: &Shared) -> Result<(), Failure> {
    if shared.json {
        return print_json(&explanations);
    }
    print(&explanations.iter().map(text).collect::<Vec<_>>().join("\n\n"))
}

fn text(explanation: &Explanation) -> String {
    let Explanation { figure, impactor, sentence, unit, loadings, script } = explanation;
    let unit = if unit.is_empty() { String::new() } else { format!("; in {unit}") };
    let whose = impactor.as_ref().map_or_else(String::new, |name| format!("\n    of the impactor \"{name}\""));
    let of = loadings.join(", ");
    format!(
        "{figure}\n    {sentence}{whose}\n    figure of summary.json{unit}; of loading.{of}\n    in scripts `{script}`"
    )
}
