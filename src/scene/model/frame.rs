//! The mounting frame.

mod bars;
mod springs;

use super::specimen::symmetry;
use super::{Clamp, Face, Frame, Hold, Loading, ModelDiagnostics, Specimen};
use crate::mesh::Side;
use crate::scenario::{self, EdgeChoice, Scenario, Shape};

const PATH: &str = "frame.hold";

/// The frame around `faces` of `specimen`, which are left out where there are mistakes in them.
pub fn check(
    scenario: &Scenario,
    loading: &Loading,
    specimen: Option<&Specimen>,
    faces: Option<&[Face]>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Frame {
    let hold = held(scenario, loading, mistakes);
    let shape = specimen.map(|specimen| &specimen.shape);
    let of_bars = |bars| self::bars::check(bars, scenario, (loading, &hold), shape, faces, mistakes);
    let bars = scenario.frame.bars.as_ref().and_then(of_bars);
    let of_clamp = |clamp| check_clamp(clamp, scenario, loading, &hold, mistakes);
    let clamp = scenario.frame.clamp.as_ref().and_then(of_clamp);
    let of_springs = |springs| self::springs::check(springs, scenario, loading, &hold, mistakes);
    let springs = scenario.frame.springs.as_ref().and_then(of_springs);
    Frame { hold, bars, clamp, springs }
}

/// The clamped edges; under a stretch the jaws.
fn held(scenario: &Scenario, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) -> Hold {
    let hold = match &scenario.frame.hold {
        Some(scenario::Hold::Word(EdgeChoice::All)) => Hold::All,
        Some(scenario::Hold::Word(EdgeChoice::None)) => Hold::None,
        Some(scenario::Hold::Sides(sides)) => self::sides(sides, scenario, loading, mistakes),
        None => loading.default_hold(),
    };
    if let Some(refusal) = loading.refuses_hold(&hold) {
        refusal.report(PATH, mistakes);
    }
    hold
}

impl Hold {
    /// Whether a side is held.
    pub fn holds(&self, side: Side) -> bool {
        match self {
            Hold::All => true,
            Hold::Sides(sides) => sides.contains(&side),
            Hold::None => false,
        }
    }
}

fn sides(
    written: &[scenario::Side],
    scenario: &Scenario,
    loading: &Loading,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Hold {
    let round = matches!(scenario.specimen.shape, Shape::Circle(_));
    if round {
        let may_be_free = loading.refuses_hold(&Hold::None).is_none();
        let hint = if may_be_free { "hold \"all\" or \"none\"" } else { "hold \"all\"" };
        mistakes.report_with(PATH, "a circle has no sides", hint);
    }
    let mut sides = Vec::new();
    for (place, side) in written.iter().map(side).enumerate() {
        if sides.contains(&side) {
            mistakes.report(&format!("{PATH}.{place}"), "this side is already held");
            if let Some(first) = written.iter().position(|other| self::side(other) == side) {
                mistakes.label(&format!("{PATH}.{first}"), "here");
            }
        } else {
            sides.push(side);
        }
    }
    let [x, y] = symmetry(&scenario.specimen).mirrors();
    let alike = |a, b| sides.contains(&a) == sides.contains(&b);
    let differ = (x && !alike(Side::XMinus, Side::XPlus)) || (y && !alike(Side::YMinus, Side::YPlus));
    if differ {
        mistakes.report_with(
            PATH,
            "of two sides across a mirror plane, only one is held",
            "hold both, or set `specimen.symmetry` to \"none\"",
        );
    }
    // Further mistakes would name sides that a circle does not have.
    if round || is_rim(&sides, scenario) { Hold::All } else { Hold::Sides(sides) }
}

/// Whether the sides are the whole edge; that of an imported outline may have more to it.
fn is_rim(sides: &[Side], scenario: &Scenario) -> bool {
    matches!(scenario.specimen.shape, Shape::Rectangle(_)) && sides.len() == 4
}

fn side(written: &scenario::Side) -> Side {
    match written {
        scenario::Side::XMinus => Side::XMinus,
        scenario::Side::XPlus => Side::XPlus,
        scenario::Side::YMinus => Side::YMinus,
        scenario::Side::YPlus => Side::YPlus,
    }
}

/// The clamp; none where there is a mistake in it.
fn check_clamp(
    written: &scenario::Clamp,
    scenario: &Scenario,
    loading: &Loading,
    hold: &Hold,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Clamp> {
    const PATH: &str = "frame.clamp";
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
