//! `frame.clamp`: a clamp in which film slips.

use crate::model::{Clamp, Hold, Loading, ModelDiagnostics};
use crate::scenario::{self, Scenario};

const PATH: &str = "frame.clamp";

/// The clamp; none where there is a mistake in it.
pub(super) fn check(
    written: &scenario::Clamp,
    scenario: &Scenario,
    loading: &Loading,
    hold: &Hold,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Clamp> {
    match loading {
        Loading::Stretch { .. } => {
            let hint = "leave it out; the jaws of a stretch test hold without slip";
            mistakes.report_with(PATH, "film that slips in jaws is not supported", hint);
            return None;
        }
        Loading::Pressure { .. } | Loading::Volume { .. } => {
            let hint = "leave it out; the edge of film under pressure is held without slip";
            mistakes.report_with(PATH, "film that slips in its clamp under pressure is not supported", hint);
            return None;
        }
        Loading::Impact { .. } | Loading::Indent { .. } => {}
    }
    if *hold == Hold::None {
        mistakes.out_of_place(PATH, "no edge is held");
        return None;
    }
    if scenario.air.as_ref().is_some_and(|air| air.cushion.is_some()) {
        let hint = "leave the clamp or `air.cushion` out";
        mistakes.report_with(PATH, "air between faces that slip in their clamp is not supported", hint);
        mistakes.label("air.cushion", "the air between the faces");
        return None;
    }
    let scenario::Clamp { force, friction, width } = written;
    Some(Clamp { force: force.0, friction: *friction, width: width.map(|width| width.0) })
}
