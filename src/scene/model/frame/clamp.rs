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
    if let Some(refusal) = loading.refuses_clamp() {
        refusal.report(PATH, mistakes);
        return None;
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
