//! Searches: minimization of an objective over the parameters of a scenario or of any other model, and how well these
//! are known.
//!
//! [`minimize`] searches with one of three [methods](Method) from one or several starts. A [`TrialPool`] evaluates the
//! trials of one or several searches in parallel, also some that the search may not use, which does not change the result, to the
//! bit. [`Confidence`](lab::confidence::Confidence) says how well the parameters are known. The bindings offer all of it to
//! scripts.
//!
//! ```
//! use droptower_study::identify::{Method, Search, SearchError, minimize, with_evaluator};
//!
//! let line = |x: &[f64]| vec![x[0] - 3.1, x[0] + x[1] - 4.9, x[0] + 2.0 * x[1] - 7.0];
//! let search = Search::new(Method::LevenbergMarquardt, vec![1.0, 1.0]);
//! let result = with_evaluator(&line, 2, |evaluator| minimize(&search, evaluator, &mut |_| {}))?;
//! assert!((result.best.x[1] - 1.95).abs() < 1e-6);
//! # Ok::<(), SearchError>(())
//! ```

mod bindings;
mod convergence;
mod evaluator;
mod method;
mod objective;
mod options;
mod search;
mod warning;

pub(crate) use crate::identify::bindings::{HostSearch, failure};
pub use crate::identify::bindings::{SearchEvent, SearchHost, SearchStart, register};
pub use crate::identify::convergence::{Labels, Phase, Progress, SignalLabel};
pub use crate::identify::evaluator::{
    Evaluator, TrialEvent, TrialPool, linearize_at_start, weigh_at_start, with_evaluator,
};
pub use crate::identify::objective::{Evaluation, FatalError, Objective, ObjectiveValue, SearchError, Trial};
pub use crate::identify::options::{Bounds, Method, Point, Search, Side, Starts};
pub use crate::identify::search::{Iteration, SearchResult, StartResult, minimize};
pub use crate::identify::warning::{CODES, Warning};
