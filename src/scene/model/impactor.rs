//! The impactors as written, with the paths of their tables, and checked: their names and releases, then each by itself.

use nalgebra::Vector3;

use super::exclusions::{self, Body};
use super::loading::{Impact, Impactors};
use super::{Checker, Guide, Hinge, Impactor, ImpactorShape, Loading, Part};
use crate::scenario::{self, BodyShape, FrictionPoint, Orientation, Scenario};
use base::number::significant;
use membrane::engine::GuideFriction;

/// Default length of the shaft of a dart, in radii.
const SHAFT: f64 = 4.0;

/// Component of a velocity across a guide over its length from which it is meant.
const ACROSS: f64 = 1e-9;

/// The impactors, where the `loading` needs any; empty where it needs none.
pub fn check(scenario: &Scenario, loading: &Loading, checker: &mut Checker<'_>) -> Option<Vec<Impactor>> {
    if loading.impactors() == Impactors::None {
        return Some(vec![]);
    }
    let all = impactors(scenario, checker);
    if all.is_empty() {
        checker.missing("impactor", format!("`loading.{}` needs an impactor", loading.name()));
        return None;
    }
    if let (Impactors::Prescribed, [_, second, ..]) = (loading.impactors(), all.as_slice()) {
        let hint = "give one `[impactor]`, or a `[loading.impact]`";
        return checker.refuse(&second.path, "an indentation has one impactor", hint);
    }
    check_several(&all, loading, checker);
    let is_alone = all.len() == 1 && scenario.frame.bars.is_none();
    let one = |written: &Written<'_>| {
        let body = Body { body: written, loading, symmetry: scenario.specimen.symmetry, is_alone };
        checker.exclude(&format!("{}.", written.path), &exclusions::impactor(), &body);
        check_one(written, loading, checker)
    };
    let checked: Vec<Option<Impactor>> = all.iter().map(one).collect();
    checked.into_iter().collect()
}

fn check_one(written: &Written<'_>, loading: &Loading, checker: &mut Checker<'_>) -> Option<Impactor> {
    let guide = guide(written, checker);
    let orientation = rotation(written.orientation.as_ref(), &written.key("orientation"), checker);
    let shape = shape(written, checker);
    let mass = mass(written, loading, checker);
    let guide = guide?;
    let velocity = velocity(written, loading, guide, checker);
    Some(Impactor {
        name: written.name.clone(),
        shape: shape?,
        mass: mass?,
        guide,
        guide_friction: guide_friction(written, checker),
        friction: written.friction,
        restitution: written.restitution,
        inertia: inertia(written, checker),
        release: written.at.0,
        position: [0, 1].map(|axis| written.position.get(axis).map_or(0.0, |length| length.0)),
        height: written.position.get(2).map(|length| length.0),
        orientation: orientation?,
        velocity,
        spin: spin(written, guide, checker),
    })
}

/// Mass of an impactor that falls; infinite where its motion is prescribed or it is fixed.
fn mass(written: &Written<'_>, loading: &Loading, checker: &mut Checker<'_>) -> Option<f64> {
    let key = written.key("mass");
    if loading.impactors() == Impactors::Prescribed {
        return Some(f64::INFINITY);
    }
    if written.guide == Guide::Fixed {
        if written.mass.is_some() && !checker.is_inherited(&key) {
            checker.out_of_place(&key, "a fixed impactor does not move");
        }
        return Some(f64::INFINITY);
    }
    if written.mass.is_none() {
        checker.missing(&key, "`loading.impact` needs the mass of what falls");
    }
    written.mass.map(|mass| mass.0)
}

/// The guide with directions of length one.
fn guide(written: &Written<'_>, checker: &mut Checker<'_>) -> Option<Guide> {
    Some(match written.guide {
        Guide::Line(line) => Guide::Line(direction(line, &written.key("guide.line"), checker)?),
        Guide::Hinge(Hinge { axis, at }) => {
            Guide::Hinge(Hinge { axis: direction(axis, &written.key("guide.hinge.axis"), checker)?, at })
        }
        guide => guide,
    })
}

/// The unit vector along `written`.
fn direction(written: [f64; 3], path: &str, checker: &mut Checker<'_>) -> Option<[f64; 3]> {
    let unit = Vector3::from(written).try_normalize(0.0);
    if unit.is_none() {
        checker.report_with(path, "a direction of no length", "along z it is [0, 0, 1]");
    }
    unit.map(Into::into)
}

/// A rotation as an axis times an angle, rad.
fn rotation(written: Option<&Orientation>, path: &str, checker: &mut Checker<'_>) -> Option<[f64; 3]> {
    let Some(written) = written else { return Some([0.0; 3]) };
    let axis = direction(written.axis, &format!("{path}.axis"), checker)?;
    Some(axis.map(|component| component * written.angle.0))
}

/// Velocity of the centre of mass at the start, which the guide must admit, m/s.
fn velocity(written: &Written<'_>, loading: &Loading, guide: Guide, checker: &mut Checker<'_>) -> [f64; 3] {
    let key = &written.key("velocity");
    let Some(Impact { velocity: downward, .. }) = loading.impact() else { return [0.0; 3] };
    let velocity = written.velocity.map_or([0.0, 0.0, -downward], |velocity| velocity.map(|component| component.0));
    let along = match guide {
        Guide::Free => return velocity,
        Guide::Z => Vector3::z(),
        Guide::Line(line) => line.into(),
        Guide::Fixed | Guide::Hinge(_) => return [0.0; 3],
    };
    let velocity = Vector3::from(velocity);
    if written.velocity.is_none() && along.z == 0.0 {
        let message = "the speed of `loading.impact` has no direction on a level line";
        let hint = format!("give `{key}`, a vector along the line");
        checker.report_with(&written.key("guide.line"), message, hint);
    }
    let speed = match written.velocity {
        Some(_) => velocity.dot(&along),
        // Down the line.
        None => -downward.copysign(along.z),
    };
    if written.velocity.is_some() && (velocity - along * speed).norm() > ACROSS * velocity.norm() {
        let message = "the guide admits no velocity across it";
        let guide = written.key("guide");
        checker.report_with(key, message, format!("set `{guide}` to \"free\", or to the line of flight"));
        checker.label(&guide, "the guide");
    }
    (along * speed).into()
}

/// Moments of inertia, none of which a body can have above the sum of the other two, kg m².
fn inertia(written: &Written<'_>, checker: &mut Checker<'_>) -> Option<[f64; 3]> {
    let key = &written.key("inertia");
    let moments = written.inertia?.map(|moment| moment.0);
    let [x, y, z] = moments;
    if x > y + z || y > x + z || z > x + y {
        let message = "no body has a moment of inertia above the sum of the other two";
        checker.report_with(key, message, "give those about x, y and z through the centre of mass");
    }
    Some(moments)
}

/// Angular velocity at the start, rad/s.
fn spin(written: &Written<'_>, guide: Guide, checker: &mut Checker<'_>) -> [f64; 3] {
    let key = &written.key("spin");
    let Some(spin) = written.spin else { return [0.0; 3] };
    let spin = Vector3::from(spin.map(|component| component.0));
    if let Guide::Hinge(Hinge { axis, .. }) = guide {
        let axis = Vector3::from(axis);
        if (spin - axis * spin.dot(&axis)).norm() > ACROSS * spin.norm() {
            let message = "the hinge admits no rotation about another axis";
            checker.report_with(key, message, "give a spin along the axis of the hinge");
            checker.label(&written.key("guide.hinge.axis"), "the axis");
        }
    }
    spin.into()
}

/// Friction of the guide of a falling impactor.
fn guide_friction(written: &Written<'_>, checker: &mut Checker<'_>) -> GuideFriction {
    let key = &written.key("guide_friction");
    let Some(friction) = &written.guide_friction else {
        return GuideFriction::default();
    };
    for (index, [before, after]) in friction.curve.array_windows().enumerate() {
        if after.0.0 <= before.0.0 {
            let message = "the curve is not increasing in speed";
            let hint = format!("{} follows {}", after.0, before.0);
            checker.report_with(&format!("{key}.curve.{}", index + 1), message, hint);
            checker.label(&format!("{key}.curve.{index}"), "the point before it");
        }
    }
    let curve = friction.curve.iter().map(|FrictionPoint(speed, force)| [speed.0, force.0]).collect();
    GuideFriction { constant: friction.constant.0, per_speed: friction.per_speed.0, curve }
}

fn shape(written: &Written<'_>, checker: &mut Checker<'_>) -> Option<ImpactorShape> {
    let key = &written.key("shape");
    let parts = match &written.shape {
        scenario::ImpactorShape::One(shape) => return one(shape, key, checker),
        scenario::ImpactorShape::Compound(compound) => &compound.compound,
    };
    let parts: Vec<Option<Part>> = parts
        .iter()
        .enumerate()
        .map(|(place, part)| {
            let path = format!("{key}.compound.{place}");
            let orientation = rotation(part.orientation.as_ref(), &format!("{path}.orientation"), checker);
            let shape = one(&part.shape, &format!("{path}.shape"), checker);
            Some(Part { shape: shape?, at: part.at.map(|length| length.0), orientation: orientation? })
        })
        .collect();
    parts.into_iter().collect::<Option<Vec<Part>>>().map(ImpactorShape::Compound)
}

/// A shape whose table has the key path `path`.
fn one(written: &BodyShape, path: &str, checker: &mut Checker<'_>) -> Option<ImpactorShape> {
    Some(match written {
        BodyShape::Sphere(round) => ImpactorShape::Sphere { radius: round.radius() },
        BodyShape::Hemisphere { round, length } => {
            let radius = round.radius();
            ImpactorShape::Hemisphere { radius, length: length.map_or(SHAFT * radius, |length| length.0) }
        }
        BodyShape::Capsule { round, length } => ImpactorShape::Capsule { radius: round.radius(), length: length.0 },
        BodyShape::Cylinder { round, length, edge } => {
            let (radius, length, edge) = (round.radius(), length.0, edge.0);
            rounded(edge, radius.min(0.5 * length), &format!("{path}.cylinder.edge"), checker)?;
            ImpactorShape::Cylinder { radius, length, edge }
        }
        BodyShape::Cone { round, length, edge } => {
            let (radius, length, edge) = (round.radius(), length.0, edge.0);
            // The radius of the ball that touches flank and flat end all around.
            let largest = radius * length / (radius + radius.hypot(length));
            rounded(edge, largest, &format!("{path}.cone.edge"), checker)?;
            ImpactorShape::Cone { radius, length, edge }
        }
        BodyShape::Box { size, edge } => {
            let (size, edge) = (size.map(|length| length.0), edge.0);
            let smallest = size.into_iter().fold(f64::INFINITY, f64::min);
            rounded(edge, 0.5 * smallest, &format!("{path}.box.edge"), checker)?;
            ImpactorShape::Box { size, edge }
        }
        BodyShape::Mesh(file) => {
            let (path, scale) = checker.mesh(&format!("{path}.mesh"), file)?;
            ImpactorShape::Mesh { path, scale }
        }
    })
}

/// Refuses a radius of the edges beside which no flat face remains.
fn rounded(edge: f64, largest: f64, path: &str, checker: &mut Checker<'_>) -> Option<()> {
    // A size that is refused itself leaves no radius.
    if edge < largest || largest.is_nan() || largest <= 0.0 {
        return Some(());
    }
    let hint = format!("it must be below {} mm", significant(1e3 * largest, 4));
    checker.refuse(path, "this radius is too large", hint)
}

/// Names that tell several impactors apart, and releases within the run.
fn check_several(all: &[Written<'_>], loading: &Loading, checker: &mut Checker<'_>) {
    names(all, checker);
    let earliest = all.iter().min_by(|a, b| a.at.0.total_cmp(&b.at.0)).filter(|one| one.at.0 > 0.0);
    let earliest = earliest.filter(|_| loading.impactors() == Impactors::Free);
    // Of one whose `at` is to be left out, nothing else about it matters.
    let released_later = all.iter().filter(|one| earliest.is_none_or(|earliest| earliest.path != one.path));
    released_later.for_each(|one| released(one, loading, checker));
    if let Some(one) = earliest {
        let message = "no impactor is released at the start";
        checker.report_with(&one.key("at"), message, "the run starts with the first one: leave its `at` out");
    }
}

fn names(all: &[Written<'_>], checker: &mut Checker<'_>) {
    for (place, one) in all.iter().enumerate() {
        let key = one.key("name");
        let Some(name) = &one.name else {
            if all.len() > 1 {
                checker.missing(&key, "several impactors have names, with which those of their signals begin");
            }
            continue;
        };
        if !is_identifier(name) {
            let hint = "give a letter, then letters, digits and underscores: it is the beginning of names of columns";
            checker.report_with(&key, format!("\"{name}\" is no name of an impactor"), hint);
        }
        for earlier in &all[..place] {
            let Some(other) = &earlier.name else { continue };
            let begins = |long: &str, short: &str| long.strip_prefix(short).is_some_and(|rest| rest.starts_with('_'));
            if name == other {
                checker.report(&key, format!("two impactors have the name \"{name}\""));
            } else if name.eq_ignore_ascii_case(other) {
                let message = format!("the names \"{name}\" and \"{other}\" differ by case alone");
                checker.report_with(&key, message, "give names that nobody confuses");
            } else if begins(name, other) || begins(other, name) {
                let message = format!("columns of \"{name}\" and \"{other}\" cannot be told apart");
                checker.report_with(&key, message, "a name must not begin with another one and an underscore");
            } else {
                continue;
            }
            checker.label(&earlier.key("name"), "the other impactor");
        }
    }
}

/// Longest name, characters.
const LONGEST: usize = 32;

fn is_identifier(name: &str) -> bool {
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_word && name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.len() <= LONGEST && !name.ends_with('_')
}

/// A release after the start.
fn released(one: &Written<'_>, loading: &Loading, checker: &mut Checker<'_>) {
    let key = one.key("at");
    let Some(Impact { duration, .. }) = loading.impact() else { return };
    if one.at.0 <= 0.0 || one.guide == Guide::Fixed {
        return;
    }
    if one.at.0 >= *duration {
        checker.report(&key, "the impactor is released after the end of the run");
        checker.label("loading.impact.duration", "the run ends here");
    }
    if one.position.len() < 3 {
        let message = "an impactor that is released later needs a height";
        let hint = "give x, y and z: film moves, so that none is in contact with it by itself";
        checker.report_with(&one.key("position"), message, hint);
    }
}

/// An impactor as written.
pub(in crate::model) struct Written<'s> {
    body: &'s scenario::Impactor,
    /// Path of its table.
    pub(in crate::model) path: String,
}

impl Written<'_> {
    /// Path of its `key`.
    pub(in crate::model) fn key(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }
}

impl std::ops::Deref for Written<'_> {
    type Target = scenario::Impactor;

    fn deref(&self) -> &scenario::Impactor {
        self.body
    }
}

/// All impactors as written: one table, or a list of them.
pub(in crate::model) fn impactors<'s>(scenario: &'s Scenario, checker: &Checker<'_>) -> Vec<Written<'s>> {
    let is_list = checker.is_written("impactor.0");
    let path = |place: usize| if is_list { format!("impactor.{place}") } else { "impactor".to_owned() };
    scenario.impactor.iter().enumerate().map(|(place, body)| Written { body, path: path(place) }).collect()
}
