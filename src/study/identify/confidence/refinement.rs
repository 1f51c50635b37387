//! Profiles about the best point that they find.
//!
//! Where a profile finds a lower objective value than the estimate, the estimate is no minimum: the search continues
//! from the lowest point of the profiles, and the profiles are computed again about the point that it finds.

use super::linearization::{LinearizationError, linearize_at_start};
use super::profile::{Profile, ProfileError, lowest, profiles};
use crate::identify::bounds::Bounds;
use crate::identify::error::SearchError;
use crate::identify::iteration::{Iteration, StopReason};
use crate::identify::options::{Method, Search, Starts};
use crate::identify::point::Point;
use crate::identify::pool::trial_pool::Evaluator;
use crate::identify::result::SearchResult;
use crate::identify::search::minimize;
use crate::identify::warning::Warning;
use lab::confidence::Confidence;
use lab::confidence::{ConfidenceOptions, Linearization};

/// Largest number of continued searches.
const MAX_CONTINUED: usize = 3;

/// The settings of profiles.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileOptions {
    /// Options of the confidence intervals, whose half-widths are the unit of the values.
    pub confidence: ConfidenceOptions,
    /// Number of values on each side of the estimate.
    pub points: usize,
    /// Numbers of residuals of the parts that the residuals are joined from; none for one part.
    pub parts: Option<Vec<usize>>,
}

/// Profiles and the estimate that they are about.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// The estimate.
    pub x: Vec<f64>,
    /// ‖r‖ there.
    pub f: f64,
    /// The searches that profiles continued, in their order; none where the profiles find no lower value.
    pub continued: Vec<SearchResult>,
    /// Profiles along all parameters.
    pub profiles: Vec<Profile>,
    /// Whether these still find a lower value.
    pub is_lower: bool,
    /// Notes on the searches that continued.
    pub warnings: Vec<Warning>,
}

/// An event while profiles are computed.
#[derive(Clone, Copy, Debug)]
pub enum ProfileEvent<'a> {
    /// So many points have no value yet.
    OpenPoints(usize),
    /// An iteration of a continued search has ended.
    Iteration(&'a Iteration),
}

impl Refinement {
    /// Whether the estimate is a minimum as far as profiles and continued searches show, and why not or why the search
    /// stopped there; none where no search continued and the profiles find no lower value.
    pub fn state(&self, bounds: &Bounds) -> Option<(bool, StopReason)> {
        if self.is_lower {
            return Some((false, StopReason::LowerInProfile));
        }
        let Some(last) = self.continued.last().map(|result| &result.best) else {
            // The search that should have continued from a lower point had no value beside it.
            return (!self.warnings.is_empty()).then_some((false, StopReason::LowerInProfile));
        };
        match last.converged && !bounds.active(&self.x).is_empty() {
            true => Some((false, StopReason::OnBound)),
            false => Some((last.converged, last.reason.clone())),
        }
    }

    /// Profiles about the start of `search`, or about the best point that they lead to; the searches that they continue
    /// are by Levenberg and Marquardt, with the tolerances, limits and bounds of `search`. `observer` is called with
    /// each event.
    ///
    /// # Errors
    /// The errors of [`profiles`] and [`minimize`].
    pub fn run(
        search: &Search,
        options: &ProfileOptions,
        evaluator: &Evaluator<'_, '_>,
        observer: &mut (dyn FnMut(ProfileEvent<'_>) + Send),
    ) -> Result<Refinement, ProfileError> {
        let mut search = Search { method: Method::LevenbergMarquardt, starts: Starts::One, ..search.clone() };
        let (mut continued, mut warnings) = (Vec::new(), Vec::new());
        let mut round = 0;
        loop {
            let linearization = linearization(&search, options, evaluator)?;
            let confidence = Confidence::from_linearization(&linearization, &options.confidence)?;
            let mut open = |open| observer(ProfileEvent::OpenPoints(open));
            let profiles = profiles(&search, &linearization, &confidence, options.points, evaluator, &mut open)?;
            let estimate = linearization.norm();
            let lower = lowest(&profiles, estimate);
            let Some((parameter, found, x)) = lower.filter(|_| round < MAX_CONTINUED) else {
                let is_lower = lower.is_some();
                return Ok(Refinement { x: search.start, f: estimate, continued, profiles, is_lower, warnings });
            };
            let (parameter, point) = (search.names[parameter].clone(), Point::new(&search.names, x));
            // The lowest point of all profiles: the search continues from where another parameter was fixed.
            search.start = x.to_vec();
            let mut iterated = |iteration: &Iteration| observer(ProfileEvent::Iteration(iteration));
            let result = match minimize(&search, evaluator, &mut iterated) {
                // Beside a bound, where the search begins, the objective may have no value.
                Err(SearchError::Start { .. }) => None,
                result => Some(result?),
            };
            let end = result.as_ref().map(|result| result.best.f);
            // A search may begin a little beside the point, off a bound, and end above it: then the point itself is the
            // estimate.
            let best = result.as_ref().filter(|result| result.best.f < found).map(|result| &result.best);
            search.start = best.map_or_else(|| x.to_vec(), |best| best.x.clone());
            warnings.push(Warning::Continued { parameter, found, estimate, x: point, continued: end });
            continued.extend(result);
            round += 1;
        }
    }
}

/// The linearization at the start of `search`, of residuals that are joined from the parts of `options`.
pub(in crate::identify) fn linearization(
    search: &Search,
    options: &ProfileOptions,
    evaluator: &Evaluator<'_, '_>,
) -> Result<Linearization, LinearizationError> {
    let linearization = linearize_at_start(search, evaluator)?;
    match &options.parts {
        Some(parts) => Ok(linearization.joined_from(parts)?),
        None => Ok(linearization),
    }
}
