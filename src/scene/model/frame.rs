//! The mounting frame, contact of film with film, and the air around it.

use super::exclusions::Scene;
use super::loading::Inertia;
use super::specimen::height_path;
use super::{Air, Bars, Checker, Contact, Face, Frame, Hold, Impactor, Loading, Specimen, Springs, Symmetry};
use crate::mesh::{Mesh, Outline, Side};
use crate::scenario::{self, EdgeChoice, Scenario, Shape};
use base::number::significant;

const HOLD: &str = "frame.hold";
const BARS: &str = "frame.bars";
const RADIUS: &str = "frame.bars.radius";

/// The frame of a scene around `faces` of `specimen`, which are left out where there are mistakes in them,
/// as are the parts that are `refused`.
pub(super) fn check(
    scene: &Scene<'_>,
    specimen: Option<&Specimen>,
    faces: Option<&[Face]>,
    refused: &[&str],
    checker: &mut Checker<'_>,
) -> Frame {
    let scenario::Frame { bars, clamp, springs, .. } = &scene.scenario.frame;
    let bars = bars.as_ref().filter(|_| !refused.contains(&BARS));
    let shape = specimen.map(|specimen| &specimen.shape);
    let bars = bars.and_then(|bars| check_bars(bars, scene, shape, faces, checker));
    let springs = springs.filter(|_| !refused.contains(&"frame.springs"));
    let springs = springs.filter(|springs| are_possible(springs, scene, checker));
    Frame { hold: scene.hold.clone(), bars, clamp: *clamp, springs }
}

/// The clamped edges; under a stretch the jaws.
pub(super) fn check_hold(scenario: &Scenario, loading: &Loading, checker: &mut Checker<'_>) -> Hold {
    match &scenario.frame.hold {
        Some(scenario::Hold::Word(EdgeChoice::All)) => Hold::All,
        Some(scenario::Hold::Word(EdgeChoice::None)) => Hold::None,
        Some(scenario::Hold::Sides(sides)) => check_sides(sides, scenario, loading, checker),
        None => loading.default_hold(),
    }
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

    /// The nodes of `mesh` that are held: those of each edge.
    pub fn nodes<'m>(&self, mesh: &'m Mesh) -> Vec<&'m [u32]> {
        match self {
            Hold::All => vec![mesh.rim.as_slice()],
            Hold::Sides(sides) => sides.iter().map(|side| mesh.sides[*side as usize].as_slice()).collect(),
            Hold::None => vec![],
        }
    }
}

fn check_sides(written: &[Side], scenario: &Scenario, loading: &Loading, checker: &mut Checker<'_>) -> Hold {
    let round = matches!(scenario.specimen.shape, Shape::Circle(_));
    if round {
        let hint = if loading.impact().is_some() { "hold \"all\" or \"none\"" } else { "hold \"all\"" };
        checker.report_with(HOLD, "a circle has no sides", hint);
    }
    let mut sides: Vec<Side> = Vec::new();
    for (place, side) in written.iter().enumerate() {
        if sides.contains(side) {
            checker.report(&format!("{HOLD}.{place}"), "this side is already held");
            if let Some(first) = written.iter().position(|other| other == side) {
                checker.label(&format!("{HOLD}.{first}"), "here");
            }
        } else {
            sides.push(*side);
        }
    }
    let [x, y] = scenario.specimen.symmetry.mirrors();
    let alike = |a, b| sides.contains(&a) == sides.contains(&b);
    if (x && !alike(Side::XMinus, Side::XPlus)) || (y && !alike(Side::YMinus, Side::YPlus)) {
        let hint = "hold both, or set `specimen.symmetry` to \"none\"";
        checker.report_with(HOLD, "of two sides across a mirror plane, only one is held", hint);
    }
    // The whole edge of a rectangle; that of an imported outline may have more to it.
    let is_rim = matches!(scenario.specimen.shape, Shape::Rectangle(_)) && sides.len() == 4;
    // Further mistakes would name sides that a circle does not have.
    if round || is_rim { Hold::All } else { Hold::Sides(sides) }
}

/// Most edges of an outline with bars: film and bodies are looked for at each of them.
const MOST_EDGES: usize = 256;

/// Share of a length that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// The bars; none where there is a mistake in them.
fn check_bars(
    written: &scenario::Bars,
    scene: &Scene<'_>,
    shape: Option<&Outline>,
    faces: Option<&[Face]>,
    checker: &mut Checker<'_>,
) -> Option<Bars> {
    let radius = written.round.radius();
    if let Some(faces) = faces {
        fit_between(radius, faces, scene.scenario, checker);
    }
    let opening = match (shape?, scene.hold) {
        (Outline::Mesh { .. }, _) => {
            let hint = "give the outline as a rectangle or a polygon";
            return checker.refuse(BARS, "bars along the edge of an imported mesh are not supported", hint);
        }
        (Outline::Circle { .. }, _) => {
            let hint = "give the outline as a polygon with many corners";
            return checker.refuse(BARS, "bars along a circle are not supported", hint);
        }
        (Outline::Polygon(_), Hold::Sides(_)) => {
            let message = "bars along some sides of a polygon are not supported";
            return checker.refuse(BARS, message, "hold \"all\", or use a rectangle");
        }
        (Outline::Polygon(polygon), _) if polygon.outer.len() > MOST_EDGES => {
            let message = format!("the outline has {} edges; bars may lie along {MOST_EDGES}", polygon.outer.len());
            return checker.refuse(BARS, message, "draw curves with fewer corners");
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
        let hint = checker.meant(RADIUS).unwrap_or(hint);
        return checker.refuse(RADIUS, "bars of this radius leave no free film between them", hint);
    }
    Some(Bars { radius, friction: written.friction })
}

/// Bars must fit between two faces.
fn fit_between(radius: f64, faces: &[Face], scenario: &Scenario, checker: &mut Checker<'_>) {
    match faces {
        [] | [_] => {}
        [upper, lower] => {
            let film = 0.5 * (upper.thickness() + lower.thickness());
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
                let hint = checker.meant(RADIUS).unwrap_or(hint);
                checker.report_with(RADIUS, message, hint);
                checker.label(&height_path(scenario, 1), "the lower face");
            }
        }
        [_, _, ..] => {
            let hint = "bars lie below one face, or between two";
            checker.report_with(BARS, "bars with more than two faces are not supported", hint);
        }
    }
}

/// Whether there are as many springs as the mirror planes of the film allow, with a preload that they can have.
fn are_possible(springs: &Springs, scene: &Scene<'_>, checker: &mut Checker<'_>) -> bool {
    let multiple = match scene.scenario.specimen.symmetry {
        // They are counted from the positive x axis: half of their number up to the mirror plane across x has to be even.
        Symmetry::HalfX if *scene.hold == Hold::All => 4,
        symmetry => symmetry.copies() as u32,
    };
    let count = springs.count;
    let is_mirrored = count.is_multiple_of(multiple);
    if !is_mirrored {
        let message = format!("{count} springs have no mirror planes: the computed part would have a share of one");
        let fits = count.next_multiple_of(multiple);
        let hint = format!("use {fits} springs, or set `specimen.symmetry` to \"none\"");
        checker.report_with("frame.springs.count", message, hint);
    }
    let elongation = springs.preload.map_or(0.0, |force| force.0 / springs.stiffness.0);
    // A stiffness that is refused itself tells nothing.
    let is_too_long = springs.preload.is_some() && elongation >= springs.length.0 && elongation.is_finite();
    if is_too_long {
        let elongation = significant(1e3 * elongation, 4);
        let message = format!("a spring under this preload is elongated by {elongation} mm, and is not that long");
        let hint = "use less preload, a larger `stiffness` or a larger `length`";
        checker.report_with("frame.springs.preload", message, hint);
        checker.label("frame.springs.length", "its length under the preload");
    }
    is_mirrored && !is_too_long
}

/// Contact between `faces`, with the coefficient of the `impactors` where none is given.
pub(super) fn check_contact(
    scene: &Scene<'_>,
    faces: Option<&[Face]>,
    impactors: &[Impactor],
    checker: &mut Checker<'_>,
) -> Contact {
    const FRICTION: &str = "contact.film_friction";
    let scenario = scene.scenario;
    let Contact { film, itself, film_friction } = scenario.contact;
    let meets_itself = itself && scene.film_folds();
    if scene.gas_joins_faces() {
        if !film {
            let hint = "true: the pressure acts on the lowest face, which presses on those above it";
            checker.missing("contact.film", hint);
        }
        if film_friction.is_none() {
            checker.missing(FRICTION, "there is no impactor whose coefficient faces could have");
        }
    } else if meets_itself && scenario.impactor.is_empty() && film_friction.is_none() {
        checker.missing(FRICTION, "there is no impactor whose coefficient film on film could have");
    }
    for (place, pair) in faces.unwrap_or_default().windows(2).enumerate().filter(|_| film) {
        let [apart, needed] = [pair[0].height - pair[1].height, 0.5 * (pair[0].thickness() + pair[1].thickness())];
        if apart > 0.0 && apart < needed * (1.0 - ROUND_OFF) {
            let [apart, needed] = [apart, needed].map(|length| significant(1e6 * length, 3));
            let message = format!("the faces are {apart} um apart, closer than they are thick");
            let hint = format!("mount their middle surfaces at least {needed} um apart");
            checker.report_with(&height_path(scenario, place + 1), message, hint);
        }
    }
    let film_friction = match film_friction {
        None if scene.faces_meet() || meets_itself => friction_of(impactors, checker),
        given => given,
    };
    Contact { film, itself, film_friction }
}

/// The coefficient that film has on film where none is given: that of the impactors, which is assumed where they have
/// one in common. None where they differ: no impactor comes before another.
fn friction_of(impactors: &[Impactor], checker: &mut Checker<'_>) -> Option<f64> {
    let (first, others) = impactors.split_first()?;
    let Some(place) = others.iter().position(|other| other.friction != first.friction) else {
        return Some(first.friction);
    };
    checker.missing("contact.film_friction", "the impactors differ in `friction`, so faces have none of theirs");
    checker.label(&format!("impactor.{}.friction", place + 1), "another coefficient than that of the first impactor");
    None
}

/// The air, whose cushion lies between two faces.
pub(super) fn check_air(scene: &Scene<'_>, faces: Option<&[Face]>, checker: &mut Checker<'_>) -> Option<Air> {
    let air = scene.scenario.air.filter(|_| scene.loading.inertia() == Inertia::Dynamic)?;
    if air.cushion.is_none() {
        return Some(air);
    }
    if faces.is_some_and(|faces| faces.len() != 2) {
        let hint = "a cushion has two faces; air between more of them is not supported yet";
        checker.report_with("air.cushion", "there is no air between exactly two faces of film", hint);
    }
    if let Some([upper, lower]) = faces {
        let needed = 0.5 * (upper.thickness() + lower.thickness());
        // Faces in the wrong order are refused elsewhere.
        let apart = upper.height - lower.height;
        if apart > 0.0 && apart <= needed {
            let [apart, needed] = [apart, needed].map(|length| significant(1e6 * length, 3));
            let message = format!("faces {apart} um apart are as thick as that: there is no air between them");
            let hint = format!("mount their middle surfaces more than {needed} um apart");
            checker.report_with(&height_path(scene.scenario, 1), message, hint);
            checker.label("air.cushion", "the air");
        }
    }
    Some(air)
}
