//! Runs within an objective, which end with the window of the comparison.

use crate::post::ReferenceComparison;
use scene::model::loading::Impact;
use scene::model::{Loading, Model};

/// Time after the window that the channel filter needs, times its class.
///
/// The backward pass of the filter (both poles at ω_d e^{±3πi/4}, ω_d = 2π · 2.08333 · class) forgets its initial state
/// as e^{−ω_d t/√2} = e^{−9.26 class t}: after 2/class to a hundred-millionth. For CFC 1000 that is 2 ms.
const SETTLING: f64 = 2.0;

/// Samples after the window: the reference is interpolated between two samples of the run, and the last samples need
/// their half steps.
const SAMPLES: f64 = 3.0;

/// `model` cut to what a comparison needs: an impact that is compared with a reference ends with the window of the
/// comparison and what the filter needs behind it; any other run is complete. No snapshots are stored.
///
/// Up to there, its signals are those of the whole run bit for bit, but for the filtered channel close to the end.
pub fn cut(model: &Model, comparison: Option<&ReferenceComparison>) -> Model {
    let mut model = model.clone();
    model.output.frames = 0;
    let Some(ReferenceComparison { window: [_, end], .. }) = comparison else {
        return model;
    };
    if let Loading::Impact(Impact { duration, .. }) = &mut model.loading {
        let filter = model.output.filter.map_or(0.0, |class| SETTLING / class);
        *duration = duration.min(end + filter + SAMPLES / model.output.sample_rate);
    }
    model
}
