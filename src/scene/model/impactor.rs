//! The impactors.

mod several;
pub(super) mod written;

use nalgebra::Vector3;

use super::loading::{Impact, Impactors};
use super::specimen::symmetry;
use super::{Guide, Impactor, ImpactorShape, Loading, ModelDiagnostics, Part, Symmetry};
use crate::scenario::{self, BodyShape, FrictionPoint, Orientation, Scenario};
use base::number::significant;
use membrane::engine::GuideFriction;
use written::Written;

/// Default length of the shaft of a dart, in radii.
const SHAFT: f64 = 4.0;

/// Second label of mistakes about mirror planes.
const SYMMETRY: &str = "specimen.symmetry";
const MIRRORED: &str = "the mirror planes";

/// Component of a velocity across a guide over its length from which it is meant.
const ACROSS: f64 = 1e-9;

/// The impactors, where the `loading` needs any; empty where it needs none.
pub fn check(scenario: &Scenario, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) -> Option<Vec<Impactor>> {
    if loading.impactors() == Impactors::None {
        return Some(vec![]);
    }
    let all = written::impactors(scenario, mistakes);
    if all.is_empty() {
        mistakes.missing("impactor", format!("`loading.{}` needs an impactor", loading.name()));
        return None;
    }
    if let (Impactors::Prescribed, [_, second, ..]) = (loading.impactors(), all.as_slice()) {
        let message = "an indentation has one impactor";
        mistakes.report_with(&second.path, message, "give one `[impactor]`, or a `[loading.impact]`");
        return None;
    }
    several::check(&all, loading, scenario.frame.bars.is_some(), mistakes);
    let checked: Vec<Option<Impactor>> = all.iter().map(|one| check_one(one, scenario, loading, mistakes)).collect();
    checked.into_iter().collect()
}

fn check_one(
    written: &Written<'_>,
    scenario: &Scenario,
    loading: &Loading,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Impactor> {
    mirrored(written, symmetry(&scenario.specimen), mistakes);
    indented(written, loading, mistakes);
    let guide = guide(written, mistakes);
    let orientation = rotation(written.orientation.as_ref(), &written.key("orientation"), mistakes);
    let shape = shape(written, mistakes);
    let mass = mass(written, loading, mistakes);
    let guide = guide?;
    let velocity = velocity(written, loading, guide, mistakes);
    Some(Impactor {
        name: written.name.clone(),
        shape: shape?,
        mass: mass?,
        guide,
        guide_friction: guide_friction(written, loading, mistakes),
        friction: written.friction,
        restitution: written.restitution,
        inertia: inertia(written, mistakes),
        release: written.at.0,
        position: [0, 1].map(|axis| written.position.get(axis).map_or(0.0, |length| length.0)),
        height: written.position.get(2).map(|length| length.0),
        orientation: orientation?,
        velocity,
        spin: spin(written, guide, mistakes),
    })
}

/// Keys without a meaning where the motion of the impactor is prescribed.
fn indented(written: &Written<'_>, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) {
    if loading.impactors() != Impactors::Prescribed {
        return;
    }
    if written.guide != scenario::Guide::Z {
        let message = "an indentation prescribes the motion of the impactor along z";
        mistakes.report_with(&written.key("guide"), message, "leave the key out");
    }
    for key in ["velocity", "spin", "inertia"].map(|key| written.key(key)) {
        if mistakes.is_written(&key) {
            mistakes.out_of_place(&key, "an indentation prescribes the motion of the impactor");
        }
    }
    if written.position.len() > 2 {
        let message = "an indentation begins in contact with the film";
        mistakes.report_with(&written.key("position"), message, "give x and y");
    }
}

/// Mass of an impactor that falls; infinite where its motion is prescribed or it is fixed.
fn mass(written: &Written<'_>, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) -> Option<f64> {
    let key = written.key("mass");
    if loading.impactors() == Impactors::Prescribed {
        return Some(f64::INFINITY);
    }
    if written.guide == scenario::Guide::Fixed {
        if written.mass.is_some() && !mistakes.is_inherited(&key) {
            mistakes.out_of_place(&key, "a fixed impactor does not move");
        }
        return Some(f64::INFINITY);
    }
    if written.mass.is_none() {
        mistakes.missing(&key, "`loading.impact` needs the mass of what falls");
    }
    written.mass.map(|mass| mass.0)
}

fn guide(written: &Written<'_>, mistakes: &mut ModelDiagnostics<'_>) -> Option<Guide> {
    Some(match &written.guide {
        scenario::Guide::Z => Guide::Z,
        scenario::Guide::Free => Guide::Free,
        scenario::Guide::Fixed => Guide::Fixed,
        scenario::Guide::Line(line) => Guide::Line(direction(*line, &written.key("guide.line"), mistakes)?),
        scenario::Guide::Hinge(hinge) => Guide::Hinge {
            axis: direction(hinge.axis, &written.key("guide.hinge.axis"), mistakes)?,
            at: hinge.at.map(|length| length.0),
        },
    })
}

/// The unit vector along `written`.
fn direction(written: [f64; 3], path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<[f64; 3]> {
    let unit = Vector3::from(written).try_normalize(0.0);
    if unit.is_none() {
        mistakes.report_with(path, "a direction of no length", "along z it is [0, 0, 1]");
    }
    unit.map(Into::into)
}

/// A rotation as an axis times an angle, rad.
fn rotation(written: Option<&Orientation>, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<[f64; 3]> {
    let Some(written) = written else { return Some([0.0; 3]) };
    let axis = direction(written.axis, &format!("{path}.axis"), mistakes)?;
    Some(axis.map(|component| component * written.angle.0))
}

/// Velocity of the centre of mass at the start, which the guide must admit, m/s.
fn velocity(written: &Written<'_>, loading: &Loading, guide: Guide, mistakes: &mut ModelDiagnostics<'_>) -> [f64; 3] {
    let key = &written.key("velocity");
    let Some(Impact { velocity: downward, .. }) = loading.impact() else { return [0.0; 3] };
    let velocity = written.velocity.map_or([0.0, 0.0, -downward], |velocity| velocity.map(|component| component.0));
    let along = match guide {
        Guide::Free => return velocity,
        Guide::Z => Vector3::z(),
        Guide::Line(line) => line.into(),
        Guide::Fixed | Guide::Hinge { .. } => {
            if written.velocity.is_some() {
                let why = match guide {
                    Guide::Fixed => "a fixed impactor has none",
                    _ => "an impactor on a hinge has a `spin`",
                };
                mistakes.out_of_place(key, why);
            }
            return [0.0; 3];
        }
    };
    let velocity = Vector3::from(velocity);
    if written.velocity.is_none() && along.z == 0.0 {
        let message = "the speed of `loading.impact` has no direction on a level line";
        let hint = format!("give `{key}`, a vector along the line");
        mistakes.report_with(&written.key("guide.line"), message, hint);
    }
    let speed = match written.velocity {
        Some(_) => velocity.dot(&along),
        // Down the line.
        None => -downward.copysign(along.z),
    };
    if written.velocity.is_some() && (velocity - along * speed).norm() > ACROSS * velocity.norm() {
        let message = "the guide admits no velocity across it";
        let guide = written.key("guide");
        mistakes.report_with(key, message, format!("set `{guide}` to \"free\", or to the line of flight"));
        mistakes.label(&guide, "the guide");
    }
    (along * speed).into()
}

/// Moments of inertia, none of which a body can have above the sum of the other two, kg m².
fn inertia(written: &Written<'_>, mistakes: &mut ModelDiagnostics<'_>) -> Option<[f64; 3]> {
    let key = &written.key("inertia");
    let moments = written.inertia?.map(|moment| moment.0);
    if !matches!(written.guide, scenario::Guide::Free | scenario::Guide::Hinge(_)) {
        mistakes.out_of_place(key, "the guide admits no rotation; \"free\" and a hinge do");
    }
    let [x, y, z] = moments;
    if x > y + z || y > x + z || z > x + y {
        let message = "no body has a moment of inertia above the sum of the other two";
        mistakes.report_with(key, message, "give those about x, y and z through the centre of mass");
    }
    Some(moments)
}

/// Angular velocity at the start, rad/s.
fn spin(written: &Written<'_>, guide: Guide, mistakes: &mut ModelDiagnostics<'_>) -> [f64; 3] {
    let key = &written.key("spin");
    let Some(spin) = written.spin else { return [0.0; 3] };
    let spin = Vector3::from(spin.map(|component| component.0));
    match guide {
        Guide::Free => {}
        Guide::Z | Guide::Line(_) | Guide::Fixed => {
            mistakes.out_of_place(key, "the guide admits no rotation; \"free\" and a hinge do");
        }
        Guide::Hinge { axis, .. } => {
            let axis = Vector3::from(axis);
            if (spin - axis * spin.dot(&axis)).norm() > ACROSS * spin.norm() {
                let message = "the hinge admits no rotation about another axis";
                mistakes.report_with(key, message, "give a spin along the axis of the hinge");
                mistakes.label(&written.key("guide.hinge.axis"), "the axis");
            }
        }
    }
    spin.into()
}

/// Friction of the guide of a falling impactor.
fn guide_friction(written: &Written<'_>, loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) -> GuideFriction {
    let (key, guide) = (&written.key("guide_friction"), &written.key("guide"));
    let Some(friction) = &written.guide_friction else {
        return GuideFriction::default();
    };
    if written.guide == scenario::Guide::Free {
        let hint = format!("leave the key out, or set `{guide}` to \"z\"");
        mistakes.report_with(key, "a free impactor has no guide", hint);
    } else if written.guide != scenario::Guide::Z {
        mistakes.report_with(key, "friction of a guide along z only is supported", "leave the key out");
        mistakes.label(guide, "the guide");
    } else if loading.impactors() == Impactors::Prescribed {
        mistakes.report_with(key, "an indentation prescribes the motion of the impactor", "leave the key out");
    }
    for (index, [before, after]) in friction.curve.array_windows().enumerate() {
        if after.0.0 <= before.0.0 {
            let message = "the curve is not increasing in speed";
            let hint = format!("{} follows {}", after.0, before.0);
            mistakes.report_with(&format!("{key}.curve.{}", index + 1), message, hint);
            mistakes.label(&format!("{key}.curve.{index}"), "the point before it");
        }
    }
    let curve = friction.curve.iter().map(|FrictionPoint(speed, force)| [speed.0, force.0]).collect();
    GuideFriction { constant: friction.constant.0, per_speed: friction.per_speed.0, curve }
}

fn shape(written: &Written<'_>, mistakes: &mut ModelDiagnostics<'_>) -> Option<ImpactorShape> {
    let key = &written.key("shape");
    let parts = match &written.shape {
        scenario::ImpactorShape::One(shape) => return one(shape, key, mistakes),
        scenario::ImpactorShape::Compound(compound) => &compound.compound,
    };
    let parts: Vec<Option<Part>> = parts
        .iter()
        .enumerate()
        .map(|(place, part)| {
            let path = format!("{key}.compound.{place}");
            let orientation = rotation(part.orientation.as_ref(), &format!("{path}.orientation"), mistakes);
            let shape = one(&part.shape, &format!("{path}.shape"), mistakes);
            Some(Part { shape: shape?, at: part.at.map(|length| length.0), orientation: orientation? })
        })
        .collect();
    parts.into_iter().collect::<Option<Vec<Part>>>().map(ImpactorShape::Compound)
}

/// A shape whose table has the key path `path`.
fn one(written: &BodyShape, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<ImpactorShape> {
    Some(match written {
        BodyShape::Sphere(round) => ImpactorShape::Sphere { radius: round.radius() },
        BodyShape::Hemisphere { round, length } => {
            let radius = round.radius();
            ImpactorShape::Hemisphere { radius, length: length.map_or(SHAFT * radius, |length| length.0) }
        }
        BodyShape::Capsule { round, length } => ImpactorShape::Capsule { radius: round.radius(), length: length.0 },
        BodyShape::Cylinder { round, length, edge } => {
            let (radius, length, edge) = (round.radius(), length.0, edge.0);
            rounded(edge, radius.min(0.5 * length), &format!("{path}.cylinder.edge"), mistakes)?;
            ImpactorShape::Cylinder { radius, length, edge }
        }
        BodyShape::Cone { round, length, edge } => {
            let (radius, length, edge) = (round.radius(), length.0, edge.0);
            // The radius of the ball that touches flank and flat end all around.
            let largest = radius * length / (radius + radius.hypot(length));
            rounded(edge, largest, &format!("{path}.cone.edge"), mistakes)?;
            ImpactorShape::Cone { radius, length, edge }
        }
        BodyShape::Box { size, edge } => {
            let (size, edge) = (size.map(|length| length.0), edge.0);
            let smallest = size.into_iter().fold(f64::INFINITY, f64::min);
            rounded(edge, 0.5 * smallest, &format!("{path}.box.edge"), mistakes)?;
            ImpactorShape::Box { size, edge }
        }
        BodyShape::Mesh(file) => {
            let (path, scale) = mistakes.mesh(&format!("{path}.mesh"), file)?;
            ImpactorShape::Mesh { path, scale }
        }
    })
}

/// Refuses a radius of the edges beside which no flat face remains.
fn rounded(edge: f64, largest: f64, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<()> {
    // A size that is refused itself leaves no radius.
    if edge < largest || largest.is_nan() || largest <= 0.0 {
        return Some(());
    }
    let hint = format!("it must be below {} mm", significant(1e3 * largest, 4));
    mistakes.report_with(path, "this radius is too large", hint);
    None
}

/// With mirror planes, the impactor lies in them, is guided and symmetric.
fn mirrored(written: &Written<'_>, symmetry: Symmetry, mistakes: &mut ModelDiagnostics<'_>) {
    if symmetry == Symmetry::None {
        return;
    }
    let hint = "set `specimen.symmetry` to \"none\"";
    let off_centre =
        symmetry.mirrors().iter().zip(&written.position).any(|(mirror, offset)| *mirror && offset.0 != 0.0);
    if off_centre {
        let message = "the axis of the impactor is not in the mirror plane";
        mistakes.report_with(&written.key("position"), message, hint);
        mistakes.label(SYMMETRY, MIRRORED);
    }
    let moves_out = !matches!(written.guide, scenario::Guide::Z | scenario::Guide::Fixed);
    let message = match written.guide {
        scenario::Guide::Free => "a free impactor can tip out of the mirror plane",
        _ => "an impactor on a line or a hinge is not known to stay in the mirror plane",
    };
    let of_shape = match &written.shape {
        scenario::ImpactorShape::One(BodyShape::Mesh(_)) => Some("mesh"),
        scenario::ImpactorShape::Compound(_) => Some("compound"),
        scenario::ImpactorShape::One(_) => None,
    };
    let mut report = |path: &str, message: &str| {
        mistakes.report_with(&written.key(path), message, hint);
        mistakes.label(SYMMETRY, MIRRORED);
    };
    if moves_out {
        report("guide", message);
    }
    if written.orientation.is_some() {
        report("orientation", "an inclined impactor is not symmetric");
    }
    match of_shape {
        Some("mesh") => report("shape.mesh", "the symmetry of a meshed impactor is not known"),
        Some(_) => report("shape.compound", "the symmetry of a compound impactor is not known"),
        None => {}
    }
}
