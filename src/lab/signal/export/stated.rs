//! What the head of an export states of a specimen.

use super::words::Key;
use crate::signal::column_name::ColumnName;

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

/// The specimens of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Export {
    /// In the order of the file.
    pub specimens: Vec<Specimen>,
    /// Comments of the file: lines that start with `#`.
    pub comments: Vec<String>,
}

/// One specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// As the file names it, or else its sheet or its number.
    pub name: String,
    /// Where its header is: the sheet, and the row counted from one.
    pub place: (Option<String>, usize),
    /// Names and units of its columns.
    pub columns: Vec<ColumnName>,
    /// As many as columns, each as long as the others; as the file writes them, `NaN` for an empty cell.
    pub values: Vec<Vec<f64>>,
    /// What the head states of it.
    pub stated: Stated,
}

impl Export {
    /// Whether the file is more than one table without a head, which any reader of tables reads.
    pub fn is_of_machine(&self) -> bool {
        self.specimens.len() > 1 || self.specimens.iter().any(|specimen| !specimen.stated.is_empty())
    }
}

impl Specimen {
    /// Leaves out rows behind the last that has a value: those of longer specimens beside it.
    pub fn trim(&mut self) {
        let filled = |values: &Vec<f64>| values.iter().rposition(|value| !value.is_nan()).map_or(0, |last| last + 1);
        let rows = self.values.iter().map(filled).max().unwrap_or(0);
        self.values.iter_mut().for_each(|values| values.truncate(rows));
    }
}
