//! Film and bodies in words.

use super::{Guide, Impactor, ImpactorShape, Model};
use base::number::{duration, significant};

impl Impactor {
    /// The impactor and its motion: `sphere 10.72 kg at 4.16 m/s`.
    pub fn in_words(&self) -> String {
        let (body, mass) = (self.body(), significant(self.mass, 4));
        let speed = self.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let at = if self.release > 0.0 { format!(" from {}", duration(self.release)) } else { String::new() };
        match self.guide {
            Guide::Fixed => format!("fixed {body}"),
            Guide::Hinge { .. } => format!("{body} {mass} kg on a hinge{at}"),
            _ => format!("{body} {mass} kg at {} m/s{at}", significant(speed, 3)),
        }
    }

    /// The name of its shape.
    pub fn body(&self) -> &'static str {
        match self.shape {
            ImpactorShape::Sphere { .. } => "sphere",
            ImpactorShape::Hemisphere { .. } => "hemisphere",
            ImpactorShape::Capsule { .. } => "capsule",
            ImpactorShape::Cylinder { .. } => "cylinder",
            ImpactorShape::Cone { .. } => "cone",
            ImpactorShape::Box { .. } => "box",
            ImpactorShape::Mesh { .. } | ImpactorShape::Compound(_) => "body",
        }
    }
}

impl Model {
    /// Its layers: `2 x 8 layers of LLDPE` where all faces are alike, else `8 + 9 layers of LLDPE`.
    pub fn layers_in_words(&self) -> String {
        let counts: Vec<u32> = self.faces.iter().map(|face| face.layers).collect();
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
        format!("{layers} of {}", self.film())
    }
}
