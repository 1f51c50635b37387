//! `frame.bars`: bars along the held edge, over which film bends.

use crate::mesh::{Outline, Side};
use crate::model::{Bars, Face, Hold, Loading, ModelDiagnostics};
use crate::scenario::{self, Scenario};
use base::number::significant;

const PATH: &str = "frame.bars";
const RADIUS: &str = "frame.bars.radius";

/// Most edges of an outline with bars: film and bodies are looked for at each of them.
const MOST_EDGES: usize = 256;

/// Share of a length that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// The bars; none where there are none, or where there is a mistake in them.
pub(super) fn check(
    written: &scenario::Bars,
    scenario: &Scenario,
    (loading, hold): (&Loading, &Hold),
    shape: Option<&Outline>,
    faces: Option<&[Face]>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Bars> {
    let radius = written.round.radius();
    if let Some(refusal) = loading.refuses_bars() {
        refusal.report(PATH, mistakes);
        return None;
    }
    if *hold == Hold::None {
        mistakes.out_of_place(PATH, "bars lie where film is held, and no edge is");
        return None;
    }
    if let Some(faces) = faces {
        between(radius, faces, scenario, mistakes);
    }
    let opening = match (shape?, hold) {
        (Outline::Mesh { .. }, _) => {
            let hint = "give the outline as a rectangle or a polygon";
            mistakes.report_with(PATH, "bars along the edge of an imported mesh are not supported", hint);
            return None;
        }
        (Outline::Circle { .. }, _) => {
            let hint = "give the outline as a polygon with many corners";
            mistakes.report_with(PATH, "bars along a circle are not supported", hint);
            return None;
        }
        (Outline::Polygon(_), Hold::Sides(_)) => {
            let message = "bars along some sides of a polygon are not supported";
            mistakes.report_with(PATH, message, "hold \"all\", or use a rectangle");
            return None;
        }
        (Outline::Polygon(polygon), _) if polygon.outer.len() > MOST_EDGES => {
            let message = format!("the outline has {} edges; bars may lie along {MOST_EDGES}", polygon.outer.len());
            mistakes.report_with(PATH, message, "draw curves with fewer corners");
            return None;
        }
        // No circle in a polygon is larger.
        (Outline::Polygon(polygon), _) => 2.0 * polygon.area() / polygon.perimeter(),
        (Outline::Rectangle { x, y }, hold) => {
            let spans = |low, high, length: f64| {
                let held = [low, high].into_iter().filter(|side| hold.holds(*side)).count();
                match held {
                    0 => f64::INFINITY,
                    1 => length,
                    _ => 0.5 * length,
                }
            };
            spans(Side::XMinus, Side::XPlus, *x).min(spans(Side::YMinus, Side::YPlus, *y))
        }
    };
    if radius >= opening {
        let hint = format!("the radius must be below {} mm", significant(1e3 * opening, 4));
        let hint = mistakes.meant(RADIUS).unwrap_or(hint);
        mistakes.report_with(RADIUS, "bars of this radius leave no free film between them", hint);
        return None;
    }
    Some(Bars { radius, friction: written.friction })
}

/// Bars must fit between two faces.
fn between(radius: f64, faces: &[Face], scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) {
    let thickness = |face: &Face| face.material.thickness * f64::from(face.layers);
    match faces {
        [] | [_] => {}
        [upper, lower] => {
            let film = 0.5 * (thickness(upper) + thickness(lower));
            let apart = upper.height - lower.height;
            if 2.0 * radius + film > apart * (1.0 + ROUND_OFF) {
                let down = |millimetres: f64| (1e3 * millimetres).floor() / 1e3;
                let room = down(0.5e3 * (apart - film));
                let needed = -down(-1e3 * (2.0 * radius + film));
                let message =
                    format!("bars of this radius do not fit between faces {} mm apart", significant(1e3 * apart, 4));
                let hint = if room > 0.0 {
                    format!("a radius of at most {room} mm fits; these bars need faces {needed} mm apart")
                } else {
                    format!("these bars need faces {needed} mm apart")
                };
                let hint = mistakes.meant(RADIUS).unwrap_or(hint);
                mistakes.report_with(RADIUS, message, hint);
                mistakes.label(&super::super::layers::height_path(scenario, 1), "the lower face");
            }
        }
        [_, _, ..] => {
            let hint = "bars lie below one face, or between two";
            mistakes.report_with(PATH, "bars with more than two faces are not supported", hint);
        }
    }
}
