//! From an outcome to what a user asks of it: filtered channel, measures, comparison, post script.

mod audit;
mod coupon_material;
mod impact;
mod indent;
mod inflation;
mod plan;
mod reference;
mod results;
mod run;
mod stretch;
mod study;
#[cfg(test)]
mod tests;
mod trial;

pub use audit::{Audit, Histogram};
pub use coupon_material::ENTRIES as COUPON_MATERIAL_ENTRIES;
pub use impact::Impact;
pub use indent::Indent;
pub use inflation::Inflation;
pub use plan::{Plan, PrepareError};
pub use reference::{Comparison, ReferenceError};
pub use results::{EvaluateError, Measures, Results};
pub use run::{ENTRIES as RUN_ENTRIES, Run};
pub use stretch::Stretch;
pub use study::{ENTRIES as STUDY_ENTRIES, Study, register as register_studies};
