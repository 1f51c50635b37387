//! The mounting frame.

mod bars;
mod clamp;

use super::specimen::symmetry;
use super::{Face, Frame, Hold, ModelDiagnostics, Specimen};
use crate::mesh::Side;
use crate::scenario::{self, EdgeChoice, Loading, Scenario, Shape};

const PATH: &str = "frame.hold";

/// The frame around `faces` of `specimen`, which are left out where there are mistakes in them.
pub fn check(
    scenario: &Scenario,
    loading: &super::Loading,
    specimen: Option<&Specimen>,
    faces: Option<&[Face]>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Frame {
    let hold = held(scenario, mistakes);
    let shape = specimen.map(|specimen| &specimen.shape);
    let of_bars = |bars| self::bars::check(bars, scenario, (loading, &hold), shape, faces, mistakes);
    let bars = scenario.frame.bars.as_ref().and_then(of_bars);
    let of_clamp = |clamp| self::clamp::check(clamp, scenario, loading, &hold, mistakes);
    let clamp = scenario.frame.clamp.as_ref().and_then(of_clamp);
    Frame { hold, bars, clamp }
}

/// The clamped edges; under a stretch the jaws.
fn held(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Hold {
    let hold = match &scenario.frame.hold {
        Some(scenario::Hold::Word(EdgeChoice::All)) => Hold::All,
        Some(scenario::Hold::Word(EdgeChoice::None)) => Hold::None,
        Some(scenario::Hold::Sides(sides)) => self::sides(sides, scenario, mistakes),
        None if is_stretch(scenario) => Hold::Sides(vec![Side::XMinus, Side::XPlus]),
        None => Hold::All,
    };
    if is_stretch(scenario) && !is_jaws(&hold) {
        mistakes.report_with(PATH, "the jaws of a stretch test hold the sides x- and x+", "leave the key out");
    }
    unheld(&hold, scenario, mistakes);
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

/// Edges that a slow loading needs to be held.
fn unheld(hold: &Hold, scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) {
    match scenario.loading {
        Loading::Indent(_) if !is_spanned(hold) => {
            let hint = "hold \"all\", or at least two opposite sides";
            mistakes.report_with(PATH, "the film is not held on both sides of the impactor", hint);
        }
        Loading::Pressure(_) | Loading::Volume(_) if *hold != Hold::All => {
            let hint = "leave the key out, or hold \"all\"";
            mistakes.report_with(PATH, "pressure escapes past an edge that is not held", hint);
        }
        _ => {}
    }
}

/// Whether two opposite sides are held.
fn is_spanned(hold: &Hold) -> bool {
    match hold {
        Hold::All => true,
        Hold::Sides(sides) => {
            let both = |a, b| sides.contains(&a) && sides.contains(&b);
            both(Side::XMinus, Side::XPlus) || both(Side::YMinus, Side::YPlus)
        }
        Hold::None => false,
    }
}

fn is_stretch(scenario: &Scenario) -> bool {
    matches!(scenario.loading, Loading::Stretch(_))
}

fn is_jaws(hold: &Hold) -> bool {
    let Hold::Sides(sides) = hold else { return false };
    sides.len() == 2 && sides.contains(&Side::XMinus) && sides.contains(&Side::XPlus)
}

fn sides(written: &[scenario::Side], scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Hold {
    let round = matches!(scenario.specimen.shape, Shape::Circle(_));
    if round {
        let hint = if may_be_free(scenario) { "hold \"all\" or \"none\"" } else { "hold \"all\"" };
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

/// Whether the loading allows free edges.
fn may_be_free(scenario: &Scenario) -> bool {
    matches!(scenario.loading, Loading::Impact(_))
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
