//! What the head of an export states of a specimen.

use super::words::Key;

/// A quantity that a head states.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// SI.
    pub value: f64,
    /// As the head writes it: `Breite b0: 10,05 mm`.
    pub written: String,
}

/// What a head states of one specimen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// Its width.
    pub width: Option<Statement>,
    /// Its thickness.
    pub thickness: Option<Statement>,
    /// Length between the jaws.
    pub grips: Option<Statement>,
    /// Gauge length.
    pub gauge: Option<Statement>,
    /// Speed of the jaws apart.
    pub speed: Option<Statement>,
    /// A word for the direction of the film.
    pub direction: Option<String>,
    /// Statements without a unit or with one of another quantity, which are not used.
    pub unused: Vec<String>,
}

impl Stated {
    /// Whether nothing is stated that is used.
    pub fn is_empty(&self) -> bool {
        let Stated { width, thickness, grips, gauge, speed, direction, unused: _ } = self;
        [width, thickness, grips, gauge, speed].iter().all(|statement| statement.is_none()) && direction.is_none()
    }

    /// All of it, as the head writes it.
    pub fn written(&self) -> Vec<String> {
        let Stated { width, thickness, grips, gauge, speed, direction, unused } = self;
        let quantities = [width, thickness, grips, gauge, speed].into_iter().flatten();
        let quantities = quantities.map(|statement| statement.written.clone());
        quantities
            .chain(direction.iter().map(|word| format!("direction: {word}")))
            .chain(unused.iter().cloned())
            .collect()
    }

    /// The place of a quantity; none of what is no quantity.
    pub fn slot(&mut self, key: Key) -> Option<&mut Option<Statement>> {
        Some(match key {
            Key::Width => &mut self.width,
            Key::Thickness => &mut self.thickness,
            Key::Grips => &mut self.grips,
            Key::Gauge => &mut self.gauge,
            Key::Speed => &mut self.speed,
            Key::Direction | Key::Name => return None,
        })
    }
}
