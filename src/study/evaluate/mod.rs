//! Runs that leave figures instead of a folder, each computed once, and what a search takes from them.

mod build_name;
mod evaluations;
pub(crate) mod trial;

pub use build_name::build_name;
pub use evaluations::{
    Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, Figure, NoOutcome, RunEvent, is_cost,
};
