//! The impactor.

use super::specimen::symmetry;
use super::{Guide, Impactor, ImpactorShape, Mistakes, Symmetry};
use crate::engine::GuideFriction;
use crate::scenario::{self, FrictionPoint, Loading, Scenario};

/// Default length of the shaft of a dart, in radii.
const SHAFT: f64 = 4.0;

/// Second label of mistakes about mirror planes.
const SYMMETRY: &str = "specimen.symmetry";
const MIRRORED: &str = "the mirror planes";

/// The impactor, where the loading needs one.
pub fn check(scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> Option<Impactor> {
    let why = match scenario.loading {
        Loading::Impact(_) => "`loading.impact` needs an impactor",
        Loading::Indent(_) => "`loading.indent` needs an impactor",
        Loading::Stretch(_) | Loading::Pressure(_) => return None,
    };
    let Some(written) = &scenario.impactor else {
        mistakes.missing("impactor", why);
        return None;
    };
    mirrored(written, symmetry(&scenario.specimen), mistakes);
    let (shape, mass) = (shape(&written.shape, mistakes), mass(written, &scenario.loading, mistakes));
    Some(Impactor {
        shape: shape?,
        mass: mass?,
        guide: match written.guide {
            scenario::Guide::Z => Guide::Z,
            scenario::Guide::Free => Guide::Free,
        },
        guide_friction: guide_friction(written, &scenario.loading, mistakes),
        friction: written.friction,
        position: written.position.map(|length| length.0),
    })
}

/// Mass of a falling impactor; infinite where its motion is prescribed.
fn mass(written: &scenario::Impactor, loading: &Loading, mistakes: &mut Mistakes<'_>) -> Option<f64> {
    if matches!(loading, Loading::Indent(_)) {
        if written.guide == scenario::Guide::Free {
            mistakes.report_with(
                "impactor.guide",
                "an indentation prescribes the motion of the impactor along z",
                "leave the key out",
            );
        }
        return Some(f64::INFINITY);
    }
    if written.mass.is_none() {
        mistakes.missing("impactor.mass", "`loading.impact` needs the mass of what falls");
    }
    written.mass.map(|mass| mass.0)
}

/// Friction of the guide of a falling impactor.
fn guide_friction(written: &scenario::Impactor, loading: &Loading, mistakes: &mut Mistakes<'_>) -> GuideFriction {
    const KEY: &str = "impactor.guide_friction";
    let Some(friction) = &written.guide_friction else {
        return GuideFriction::default();
    };
    if written.guide == scenario::Guide::Free {
        mistakes.report_with(
            KEY,
            "a free impactor has no guide",
            "leave the key out, or set `impactor.guide` to \"z\"",
        );
    } else if matches!(loading, Loading::Indent(_)) {
        mistakes.report_with(KEY, "an indentation prescribes the motion of the impactor", "leave the key out");
    }
    for (index, [before, after]) in friction.curve.array_windows().enumerate() {
        if after.0.0 <= before.0.0 {
            let message = "the curve is not increasing in speed";
            let hint = format!("{} follows {}", after.0, before.0);
            mistakes.report_with(&format!("{KEY}.curve.{}", index + 1), message, hint);
            mistakes.label(&format!("{KEY}.curve.{index}"), "the point before it");
        }
    }
    let curve = friction.curve.iter().map(|FrictionPoint(speed, force)| [speed.0, force.0]).collect();
    GuideFriction { constant: friction.constant.0, per_speed: friction.per_speed.0, curve }
}

fn shape(written: &scenario::ImpactorShape, mistakes: &mut Mistakes<'_>) -> Option<ImpactorShape> {
    Some(match written {
        scenario::ImpactorShape::Sphere { radius } => ImpactorShape::Sphere { radius: radius.0 },
        scenario::ImpactorShape::Hemisphere { radius, length } => {
            ImpactorShape::Hemisphere { radius: radius.0, length: length.map_or(SHAFT * radius.0, |length| length.0) }
        }
        scenario::ImpactorShape::Cylinder { radius, length } => {
            ImpactorShape::Cylinder { radius: radius.0, length: length.0 }
        }
        scenario::ImpactorShape::Mesh(_) => ImpactorShape::Mesh(mistakes.file("impactor.shape.mesh")?),
    })
}

/// With mirror planes, the impactor lies in them, is guided and symmetric.
fn mirrored(written: &scenario::Impactor, symmetry: Symmetry, mistakes: &mut Mistakes<'_>) {
    if symmetry == Symmetry::None {
        return;
    }
    let hint = "set `specimen.symmetry` to \"none\"";
    let off_centre = symmetry.mirrors().iter().zip(written.position).any(|(mirror, offset)| *mirror && offset.0 != 0.0);
    if off_centre {
        let message = "the axis of the impactor is not in the mirror plane";
        mistakes.report_with("impactor.position", message, hint);
        mistakes.label(SYMMETRY, MIRRORED);
    }
    if written.guide == scenario::Guide::Free {
        let message = "a free impactor can tip out of the mirror plane";
        mistakes.report_with("impactor.guide", message, hint);
        mistakes.label(SYMMETRY, MIRRORED);
    }
    if matches!(written.shape, scenario::ImpactorShape::Mesh(_)) {
        let message = "the symmetry of a meshed impactor is not known";
        mistakes.report_with("impactor.shape.mesh", message, hint);
        mistakes.label(SYMMETRY, MIRRORED);
    }
}
