//! `frame.springs`: springs on which film hangs.

use super::super::specimen::symmetry;
use crate::model::{Hold, Loading, ModelDiagnostics, Spread, SpringForce, Springs, Symmetry};
use crate::scenario::{self, Scenario, SpringPoint};
use base::number::significant;
use membrane::engine::SpringLaw;

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
    let (law, spread) = (law(written, mistakes), spread(written, multiple(scenario, hold), mistakes));
    let law = law?;
    let preload = written.preload.map(|force| force.0);
    let is_possible = preload.is_none_or(|force| can_be_preloaded(&law, force, written, mistakes));
    Some(Springs {
        law,
        spread: spread.filter(|_| is_possible)?,
        multiple: multiple(scenario, hold),
        continuous: written.continuous,
        length: written.length.0,
        preload,
        mass: written.mass.0,
        damping: written.damping.0,
    })
}

impl SpringForce {
    /// It as the engine computes it.
    pub fn law(&self) -> SpringLaw {
        match self {
            SpringForce::Linear { stiffness, pushes } => SpringLaw::linear(*stiffness, *pushes),
            SpringForce::Curve(points) => SpringLaw::curve(points),
        }
    }
}

/// Force over elongation: the schema admits a stiffness or a curve of two points or more.
fn law(written: &scenario::Springs, mistakes: &mut ModelDiagnostics<'_>) -> Option<SpringForce> {
    if let Some(stiffness) = written.stiffness {
        return Some(SpringForce::Linear { stiffness: stiffness.0, pushes: written.compression });
    }
    let curve = written.curve.as_deref().unwrap_or_default();
    let path = |place: usize| format!("{PATH}.curve.{place}");
    let before = mistakes.found.0.len();
    if written.compression {
        let message = "springs with a curve that push are not supported";
        mistakes.report_with(&format!("{PATH}.compression"), message, "leave it out, or give a `stiffness`");
    }
    if let Some(SpringPoint(elongation, force)) = curve.first()
        && (elongation.0, force.0) != (0.0, 0.0)
    {
        let hint = "begin with [\"0 mm\", \"0 N\"]; `preload` says which force the springs are mounted with";
        mistakes.report_with(&path(0), "the curve does not begin at zero", hint);
    }
    for (place, [before, after]) in curve.array_windows().enumerate() {
        let falls = [
            (after.0.0 <= before.0.0, "elongation", format!("{} follows {}", after.0, before.0)),
            (after.1.0 <= before.1.0, "force", format!("{} follows {}", after.1, before.1)),
        ];
        if let Some((_, what, hint)) = falls.into_iter().find(|(falls, ..)| *falls) {
            mistakes.report_with(&path(place + 1), format!("the curve is not increasing in {what}"), hint);
            mistakes.label(&path(place), "the point before it");
        }
    }
    let points = curve.iter().map(|SpringPoint(elongation, force)| [elongation.0, force.0]).collect();
    (mistakes.found.0.len() == before && curve.len() > 1).then_some(SpringForce::Curve(points))
}

/// What the number of springs of the whole film is a multiple of, so that they have its mirror planes.
fn multiple(scenario: &Scenario, hold: &Hold) -> u32 {
    match symmetry(&scenario.specimen) {
        // They are counted from the positive x axis: half of their number up to the mirror plane across x has to be even.
        Symmetry::HalfX if *hold == Hold::All => 4,
        symmetry => symmetry.copies() as u32,
    }
}

/// How many there are.
fn spread(written: &scenario::Springs, multiple: u32, mistakes: &mut ModelDiagnostics<'_>) -> Option<Spread> {
    match (written.count, written.spacing) {
        (Some(_), Some(_)) => {
            let hint = "`frame.springs.count` says how many there are; `--unset frame.springs.count` leaves one out that is inherited";
            mistakes.out_of_place(&format!("{PATH}.spacing"), hint);
            None
        }
        (None, None) => {
            mistakes.missing(&format!("{PATH}.count"), "or give the distance between two as `frame.springs.spacing`");
            None
        }
        (None, Some(spacing)) => Some(Spread::Spacing(spacing.0)),
        (Some(count), None) => {
            if !written.continuous && !count.is_multiple_of(multiple) {
                let message =
                    format!("{count} springs have no mirror planes: the computed part would have a share of one");
                let fits = count.next_multiple_of(multiple);
                let hint = format!("use {fits} springs, or set `specimen.symmetry` to \"none\"");
                mistakes.report_with(&format!("{PATH}.count"), message, hint);
                return None;
            }
            Some(Spread::Count(count))
        }
    }
}

/// Whether a spring of this law has the preload `force` (N) at its length as mounted.
fn can_be_preloaded(
    law: &SpringForce,
    force: f64,
    written: &scenario::Springs,
    mistakes: &mut ModelDiagnostics<'_>,
) -> bool {
    let (law, key) = (law.law(), format!("{PATH}.preload"));
    let elongation = law.elongation_at(force);
    if elongation > law.end() {
        let last = significant(law.force(law.end()), 4);
        let hint = format!("its last force is {last} N: extend the curve, or use less preload");
        mistakes.report_with(&key, "the curve ends below the preload", hint);
        return false;
    }
    // A stiffness that is refused itself tells nothing.
    if elongation >= written.length.0 && elongation.is_finite() {
        let message = format!(
            "a spring under this preload is elongated by {} mm, and is not that long",
            significant(1e3 * elongation, 4)
        );
        mistakes.report_with(&key, message, "use less preload, a larger `stiffness` or a larger `length`");
        mistakes.label(&format!("{PATH}.length"), "its length under the preload");
        return false;
    }
    true
}
