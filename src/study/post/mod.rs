//! From an outcome to its results: filtered channel, measures, comparison, post script.

mod audit;
pub mod comparison;
mod field;
mod figures;
mod impact;
mod indent;
mod inflation;
mod reference;
mod remedies;
mod results;
pub(crate) mod run;
mod stretch;
#[cfg(test)]
mod tests;
mod warning;

pub use audit::{Audit, COST, Histogram, MeshFigures, OF_THE_MACHINE};
pub use comparison::RunComparison;
pub use field::{FieldFigures, FieldTime};
pub use figures::{
    FigureName, HEADLINES, Headline, LEAST_SHARE, TestKind, answer, badness, descends, figures, further, headlines_of,
    is_known, is_of_script, is_result, is_too_coarse, ranking_figure, reached, reading,
};
pub use impact::{BodyFigures, Impact, lowest_point};
pub use indent::Indent;
pub use inflation::Inflation;
pub use reference::{ReferenceComparison, ReferenceError};
pub use remedies::failure as failure_message;
pub use results::{EvaluateError, HEADER, Measures, Plan, PrepareError, Results};
pub use run::Run;
pub use stretch::Stretch;
pub use warning::{CODES, FAILED_RUN, RunFindings, VIRTUAL_REFERENCE, Warning};
