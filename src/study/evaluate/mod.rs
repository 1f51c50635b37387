//! Runs that leave figures instead of a folder, each computed once, and what a search takes from them.

mod build_name;
mod description;
mod evaluations;
mod nearest;
pub(crate) mod trial;

pub use build_name::build_name;
pub use description::{Description, Difference, differences};
pub use evaluations::{
    Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, Figure, KnownParts, NoOutcome, RunEvent,
    is_cost,
};
pub use nearest::{Found, Nearest, OfBuild, build_differences};
