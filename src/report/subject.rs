//! What was run, in one phrase.

use base::number::{duration, significant};
use scene::model::{Guide, Impactor, ImpactorShape, Loading, Model};

/// What hits or pulls what, and how fast: `sphere 10.72 kg at 4.16 m/s on 2 x 8 layers of LLDPE`.
pub fn subject(model: &Model) -> String {
    let layers = layers(model);
    let figure = |value: f64| significant(value, 3);
    match (&model.loading, model.impactor()) {
        (Loading::Impact { .. }, Some(_)) if model.impactors.len() > 1 => {
            let all: Vec<String> =
                model.impactors.iter().map(|one| format!("{} ({})", one.words(), flying(one))).collect();
            format!("{} on {layers}", all.join(", "))
        }
        (Loading::Impact { .. }, Some(impactor)) if impactor.guide == Guide::Fixed => {
            format!("{layers} on a {}", flying(impactor))
        }
        (Loading::Impact { .. }, Some(impactor)) => format!("{} on {layers}", flying(impactor)),
        (Loading::Impact { velocity, .. }, None) => format!("{} m/s on {layers}", figure(*velocity)),
        (Loading::Stretch { angle, velocity, until, .. }, _) => {
            let (velocity, until) = (figure(*velocity), figure(until * 100.0));
            format!("{layers} stretched at {velocity} m/s to {until} %, {:.0}° from MD", degrees(*angle))
        }
        (Loading::Indent { depth, velocity, .. }, impactor) => {
            let body = impactor.map_or("body", body);
            format!("{body} {} mm into {layers} at {} m/s", figure(depth * 1e3), figure(*velocity))
        }
        (Loading::Pressure { pressure, .. }, _) => format!("{} kPa under {layers}", figure(pressure * 1e-3)),
        (Loading::Volume { volume, .. }, _) => format!("{} l of gas under {layers}", figure(volume * 1e3)),
    }
}

/// What an impactor is and how it moves: `sphere 10.72 kg at 4.16 m/s`.
fn flying(impactor: &Impactor) -> String {
    let (body, mass) = (body(impactor), significant(impactor.mass, 4));
    let speed = impactor.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let at = if impactor.release > 0.0 { format!(" from {}", duration(impactor.release)) } else { String::new() };
    match impactor.guide {
        Guide::Fixed => format!("fixed {body}"),
        Guide::Hinge { .. } => format!("{body} {mass} kg on a hinge{at}"),
        _ => format!("{body} {mass} kg at {} m/s{at}", significant(speed, 3)),
    }
}

/// A direction has no sense: within 0 to 180 degrees.
fn degrees(angle: f64) -> f64 {
    // The sum has no negative zero.
    angle.to_degrees().rem_euclid(180.0) + 0.0
}

fn body(impactor: &Impactor) -> &'static str {
    match impactor.shape {
        ImpactorShape::Sphere { .. } => "sphere",
        ImpactorShape::Hemisphere { .. } => "hemisphere",
        ImpactorShape::Capsule { .. } => "capsule",
        ImpactorShape::Cylinder { .. } => "cylinder",
        ImpactorShape::Cone { .. } => "cone",
        ImpactorShape::Box { .. } => "box",
        ImpactorShape::Mesh { .. } | ImpactorShape::Compound(_) => "body",
    }
}

/// `2 x 8 layers` where all faces are alike, else `8 + 9 layers`.
fn layers(model: &Model) -> String {
    let counts: Vec<u32> = model.faces.iter().map(|face| face.layers).collect();
    let layers = match counts.as_slice() {
        [1] => "1 layer".into(),
        [count] => format!("{count} layers"),
        [first, rest @ ..] if rest.iter().all(|count| count == first) => {
            format!("{} x {first} layer{}", counts.len(), if *first == 1 { "" } else { "s" })
        }
        _ => {
            let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
            format!("{} layers", counts.join(" + "))
        }
    };
    format!("{layers} of {}", model.film())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_within_half_a_turn() {
        for (angle, expected) in [("0", 0.0), ("-45", 135.0), ("225", 45.0), ("-0", 0.0)] {
            let degrees = degrees(angle.parse::<f64>().unwrap().to_radians());
            assert!((degrees - expected).abs() < 1e-9 && degrees.is_sign_positive(), "{angle}");
        }
    }
}
