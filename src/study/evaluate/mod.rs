//! Runs that leave figures instead of a folder, each computed once, and what a search takes from them.

mod evaluations;
pub(crate) mod trial;

pub use evaluations::{
    BUILD, Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, Figure, NoOutcome, is_cost,
};
