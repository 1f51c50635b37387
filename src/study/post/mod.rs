//! From an outcome to its results: filtered channel, measures, comparison, post script.

mod audit;
pub mod comparison;
mod field;
mod figures;
mod impact;
mod quasi_static;
mod reference;
mod remedies;
mod results;
pub(crate) mod run;
#[cfg(test)]
mod tests;
mod verdict;
mod warning;

pub use crate::post::audit::{Audit, COST, MeshFigures, OF_THE_MACHINE};
pub use crate::post::comparison::{ComparedRun, RunComparison};
pub use crate::post::field::{FieldFigures, FieldTime};
pub use crate::post::figures::{
    FigureName, HEADLINES, Headline, LEAST_SHARE, TestKind, answer, badness, descends, figures, further, headlines_of,
    is_known, is_of_script, is_result, ranking_figure, reached, reading,
};
pub use crate::post::impact::{BodyFigures, Impact, lowest_point};
pub use crate::post::quasi_static::{Indent, Inflation, Stretch};
pub use crate::post::reference::ReferenceComparison;
pub use crate::post::remedies::failure as failure_message;
pub use crate::post::results::{EvaluateError, HEADER, Measures, Plan, PrepareError, Results};
pub use crate::post::run::Run;
pub use crate::post::verdict::{VERDICT, Verdict};
pub use crate::post::warning::{CODES, FAILED_RUN, RunFindings, VIRTUAL_REFERENCE, Warning, left_open};
