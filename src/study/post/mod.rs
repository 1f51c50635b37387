//! From an outcome to its results: filtered channel, measures, comparison, post script.

mod audit;
pub mod comparison;
mod coupon_material;
mod evaluations;
mod figures;
mod impact;
mod indent;
mod inflation;
mod modules;
mod plan;
mod reference;
mod remedies;
mod results;
mod run;
mod stretch;
mod study;
#[cfg(test)]
mod tests;
mod trial;
mod warning;

use crate::script::Chapter;

pub use audit::{Audit, COST, Histogram, MeshFigures};
pub use comparison::RunComparison;
pub use evaluations::{
    BUILD, Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, Figure, NoOutcome, is_cost,
};
pub use figures::{FigureName, figures};
pub use impact::{BodyFigures, Impact, lowest_point};
pub use indent::Indent;
pub use inflation::Inflation;
pub use plan::{Plan, PrepareError};
pub use reference::{ReferenceComparison, ReferenceError};
pub use remedies::failure as failure_message;
pub use results::{EvaluateError, HEADER, Measures, Results};
pub use run::Run;
pub use stretch::Stretch;
pub use study::{Study, register as register_studies};
pub use warning::FAILED_RUN;
pub use warning::{CODES, RunFindings, Warning};

/// The reference of runs and scenarios in scripts.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "the run ([post] script)", entries: run::ENTRIES },
    Chapter { title: "scenarios (droptower script)", entries: study::ENTRIES },
    Chapter { title: "the module droptower/film (droptower script)", entries: modules::ENTRIES },
    Chapter { title: "materials from coupon tests (droptower script)", entries: coupon_material::ENTRIES },
];
