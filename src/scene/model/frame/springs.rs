//! `frame.springs`: springs on which film hangs.

use super::super::specimen::symmetry;
use crate::model::{Hold, Loading, ModelDiagnostics, Springs, Symmetry};
use crate::scenario::{self, Scenario};
use base::number::significant;

const PATH: &str = "frame.springs";

/// The springs; none where there is a mistake in them.
pub(super) fn check(
    written: &scenario::Springs,
    scenario: &Scenario,
    loading: &Loading,
    hold: &Hold,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Springs> {
    if let Some(refusal) = loading.refuses_springs() {
        refusal.report(PATH, mistakes);
        return None;
    }
    if *hold == Hold::None {
        mistakes.out_of_place(PATH, "no edge is held");
        return None;
    }
    let beside = [
        (scenario.frame.bars.is_some(), "frame.bars", "bars under film on springs are not supported"),
        (scenario.frame.clamp.is_some(), "frame.clamp", "springs at film that slips in its clamp are not supported"),
        (
            scenario.air.as_ref().is_some_and(|air| air.cushion.is_some()),
            "air.cushion",
            "air between faces on springs is not supported",
        ),
    ];
    for (_, path, message) in beside.into_iter().filter(|(is_written, ..)| *is_written) {
        mistakes.report_with(PATH, message, format!("leave the springs or `{path}` out"));
        mistakes.label(path, "here");
    }
    let (stiffness, length) = (written.stiffness.0, written.length.0);
    let preload = written.preload.map(|force| force.0);
    let is_mirrored = is_mirrored(written.count, multiple(scenario, hold), mistakes);
    let is_possible = preload.is_none_or(|force| can_be_preloaded(force / stiffness, length, mistakes));
    (is_mirrored && is_possible).then_some(Springs { stiffness, count: written.count, length, preload })
}

/// What the number of springs of the whole film is a multiple of, so that they have its mirror planes.
fn multiple(scenario: &Scenario, hold: &Hold) -> u32 {
    match symmetry(&scenario.specimen) {
        // They are counted from the positive x axis: half of their number up to the mirror plane across x has to be even.
        Symmetry::HalfX if *hold == Hold::All => 4,
        symmetry => symmetry.copies() as u32,
    }
}

/// Whether `count` springs have the mirror planes of the film.
fn is_mirrored(count: u32, multiple: u32, mistakes: &mut ModelDiagnostics<'_>) -> bool {
    if !count.is_multiple_of(multiple) {
        let message = format!("{count} springs have no mirror planes: the computed part would have a share of one");
        let fits = count.next_multiple_of(multiple);
        let hint = format!("use {fits} springs, or set `specimen.symmetry` to \"none\"");
        mistakes.report_with(&format!("{PATH}.count"), message, hint);
        return false;
    }
    true
}

/// Whether a spring that its preload elongates by `elongation` (m) can have the `length` (m) as mounted.
fn can_be_preloaded(elongation: f64, length: f64, mistakes: &mut ModelDiagnostics<'_>) -> bool {
    // A stiffness that is refused itself tells nothing.
    if elongation >= length && elongation.is_finite() {
        let message = format!(
            "a spring under this preload is elongated by {} mm, and is not that long",
            significant(1e3 * elongation, 4)
        );
        let hint = "use less preload, a larger `stiffness` or a larger `length`";
        mistakes.report_with(&format!("{PATH}.preload"), message, hint);
        mistakes.label(&format!("{PATH}.length"), "its length under the preload");
        return false;
    }
    true
}
