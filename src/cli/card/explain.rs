//! `droptower explain solvers` and `droptower explain SOLVER`: what a solver is written for each kind of film.

use serde::Serialize;

use crate::{Failure, Shared, print, print_json};
use ::card::{About, Target};

/// The word in place of a key that lists all solvers.
pub(crate) const WORD: &str = "solvers";

/// The solver of this name on the command line.
pub(crate) fn find(name: &str) -> Option<Target> {
    Target::ALL.into_iter().find(|target| target.key() == name)
}

/// A solver as it is explained.
#[derive(Serialize)]
struct Explanation {
    solver: &'static str,
    write: String,
    #[serde(flatten)]
    about: About,
}

impl Explanation {
    fn new(target: Target) -> Explanation {
        let key = target.key();
        Explanation {
            solver: target.name(),
            write: format!("droptower card write FILM --for {key} -o film.{}", target.ending()),
            about: target.about(),
        }
    }

    fn text(&self) -> String {
        let laws = self.about.laws.iter().map(|(film, keyword)| format!("{film}: {keyword}"));
        let advice = self.about.advice.iter().map(|sentence| format!("note: {sentence}"));
        let lines: Vec<String> =
            std::iter::once(self.write.clone()).chain(laws).chain(advice).map(|line| format!("\n    {line}")).collect();
        format!("{}{}", self.solver, lines.concat())
    }
}

/// Prints what `target` is written, or what all are.
pub(crate) fn run(target: Option<Target>, shared: &Shared) -> Result<(), Failure> {
    let targets = target.map_or_else(|| Target::ALL.to_vec(), |target| vec![target]);
    let explanations: Vec<Explanation> = targets.into_iter().map(Explanation::new).collect();
    if shared.json {
        return print_json(&explanations);
    }
    print(&explanations.iter().map(Explanation::text).collect::<Vec<_>>().join("\n\n"))
}
