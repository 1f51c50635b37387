//! From an outcome to its results: filtered channel, measures, comparison, post script.

mod audit;
pub mod comparison;
mod field;
mod figures;
mod headline;
mod impact;
mod indent;
mod inflation;
mod plan;
mod reference;
mod remedies;
mod results;
pub(crate) mod run;
mod stretch;
#[cfg(test)]
mod tests;
mod warning;

use crate::script::Chapter;

pub use audit::{Audit, COST, Histogram, MeshFigures, OF_THE_MACHINE};
pub use comparison::RunComparison;
pub use field::{FieldFigures, FieldTime};
pub use figures::{FigureName, figures, is_known, is_of_script};
pub use headline::{
    HEADLINES, Headline, LEAST_SHARE, TestKind, answer, badness, descends, further, headlines_of, is_result,
    is_too_coarse, ranking_figure, reached,
};
pub use impact::{BodyFigures, Impact, lowest_point};
pub use indent::Indent;
pub use inflation::Inflation;
pub use plan::{Plan, PrepareError};
pub use reference::{ReferenceComparison, ReferenceError};
pub use remedies::failure as failure_message;
pub use results::{EvaluateError, HEADER, Measures, Results};
pub use run::Run;
pub use stretch::Stretch;
pub use warning::{CODES, RunFindings, Warning};
pub use warning::{FAILED_RUN, VIRTUAL_REFERENCE};

/// The reference of runs in scripts.
pub const REFERENCE: &[Chapter] = &[Chapter { title: "the run ([post] script)", entries: run::ENTRIES }];
