//! A recorded drop test, reduced or not, and the quantities by which tests are compared.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::figure::{DIGITS, G};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::group;
use base::number::significant;
use lab::experiment::drop::{Drop, DropChannels, Figures, Landmarks, Tower};

/// A recording of a drop, and what became of its reduction.
#[derive(Clone, Debug)]
pub struct DropTest {
    /// The recording.
    pub path: PathBuf,
    /// SHA-256 of the recording; none where that could not be read.
    pub fingerprint: Option<String>,
    /// Mass and height; none where they are not known.
    pub tower: Option<Tower>,
    /// The readings; none where the recording could not be read.
    pub channels: Option<DropChannels>,
    /// Times of events, as far as they were found.
    pub landmarks: Landmarks,
    /// The drop, or why there is none.
    pub outcome: Result<Drop, Diagnostic>,
    /// Figures of the drop.
    pub figures: Option<Figures>,
    /// What reading and reduction report.
    pub findings: Vec<Finding>,
}

impl DropTest {
    /// A recording that could not be read.
    pub fn unread(path: &Path, mistake: Diagnostic) -> DropTest {
        DropTest {
            path: path.to_owned(),
            fingerprint: None,
            tower: None,
            channels: None,
            landmarks: Landmarks::default(),
            outcome: Err(mistake),
            figures: None,
            findings: vec![],
        }
    }

    /// Name of the file, without its folder.
    pub fn name(&self) -> String {
        self.path.file_name().map_or_else(|| shown_path(&self.path), |name| name.to_string_lossy().into_owned())
    }

    /// Height of fall, m; none where speed or time of contact is known in its place.
    pub fn height(&self) -> Option<f64> {
        self.tower?.height
    }

    /// Why there is no drop, without the name of the recording.
    pub fn cause(&self) -> Option<String> {
        let mistake = self.outcome.as_ref().err()?;
        let prefix = format!("{}: ", shown_path(&self.path));
        Some(mistake.message.strip_prefix(&prefix).unwrap_or(&mistake.message).to_owned())
    }

    /// Codes of the findings, each once.
    pub fn codes(&self) -> Vec<&str> {
        group::unique(self.findings.iter().map(|finding| finding.code.as_str()))
    }

    /// Whether the recording says that nothing was measured.
    pub(super) fn is_virtual(&self) -> bool {
        self.channels.as_ref().is_some_and(|channels| channels.annotations.is_virtual())
    }
}

/// Names of tests by which they differ: those of the files, and the paths of files of the same name.
pub fn names(tests: &[DropTest]) -> Vec<String> {
    let short: Vec<String> = tests.iter().map(DropTest::name).collect();
    let is_alone = |name: &String| short.iter().filter(|other| *other == name).count() == 1;
    let name = |(test, name): (&DropTest, &String)| if is_alone(name) { name.clone() } else { shown_path(&test.path) };
    tests.iter().zip(&short).map(name).collect()
}

/// A quantity by which drops are compared.
#[derive(Clone, Copy)]
pub struct DropQuantity {
    /// Its name among the figures of a drop.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// As it is shown.
    pub unit: &'static str,
    /// From SI to that unit.
    pub factor: f64,
    /// Its value in SI; none where the recording does not give it.
    pub of: fn(&Figures) -> Option<f64>,
}

const fn quantity(
    name: &'static str,
    words: &'static str,
    (unit, factor): (&'static str, f64),
    of: fn(&Figures) -> Option<f64>,
) -> DropQuantity {
    DropQuantity { name, words, unit, factor, of }
}

/// The quantities by which drops are compared.
pub const DROP_QUANTITIES: [DropQuantity; 6] = [
    quantity("impact_velocity_m_s", "impact speed", ("m/s", 1.0), |drop| Some(drop.impact_velocity_m_s)),
    quantity("peak_acceleration_m_s2", "peak deceleration", ("g", 1.0 / G), |drop| drop.peak_acceleration_m_s2),
    quantity("peak_displacement_m", "travel", ("mm", -1e3), |drop| drop.peak_displacement_m),
    quantity("energy_absorption", "loading energy absorbed", ("%", 100.0), |drop| drop.energy_absorption),
    quantity("final_absorbed_energy_J", "absorbed by the film", ("J", 1.0), |drop| drop.final_absorbed_energy),
    quantity("rebound_velocity_m_s", "largest upward speed", ("m/s", 1.0), |drop| drop.rebound_velocity_m_s),
];

impl DropQuantity {
    /// Words and unit.
    pub fn heading(&self) -> String {
        format!("{} ({})", self.words, self.unit)
    }
}

/// How the figures of the drops of one mass and height scatter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DropScatter {
    /// kg.
    pub mass_kg: f64,
    /// m; none where the impact speed is known in its place.
    pub height_m: Option<f64>,
    /// Number of drops.
    pub drops: usize,
    /// Of each quantity that a drop has.
    pub figures: Vec<FigureScatter>,
}

/// How a quantity scatters, SI.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureScatter {
    /// Its name among the figures of a drop.
    pub figure: &'static str,
    /// Number of drops that have it.
    pub count: usize,
    /// Half of the drops are below it.
    pub median: f64,
    /// A quarter and three quarters of the drops are below them: quantiles, linear between the sorted values (type 7 of
    /// Hyndman and Fan 1996).
    pub quartiles: [f64; 2],
    /// The least and the largest value.
    pub range: [f64; 2],
}

impl FigureScatter {
    /// The quantity.
    pub fn quantity(&self) -> Option<&'static DropQuantity> {
        DROP_QUANTITIES.iter().find(|quantity| quantity.name == self.figure)
    }

    /// Median, lower and upper quartile, least and largest value in the unit that is shown.
    pub fn shown(&self) -> [f64; 5] {
        let factor = self.quantity().map_or(1.0, |quantity| quantity.factor);
        let [[low, high], [least, largest]] = [self.quartiles, self.range].map(|ends| {
            let ends = ends.map(|end| factor * end);
            // A negative factor turns the order.
            if factor < 0.0 { [ends[1], ends[0]] } else { ends }
        });
        [factor * self.median, low, high, least, largest]
    }
}

impl DropScatter {
    /// Mass and height in words.
    pub fn conditions(&self) -> String {
        let mass = significant(self.mass_kg, DIGITS);
        match self.height_m {
            Some(height) => format!("{mass} kg from {} m", significant(height, DIGITS)),
            None => format!("{mass} kg"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_as_long_as_they_differ() {
        let tests =
            ["a/1.csv", "b/1.csv", "b/2.csv"].map(|path| DropTest::unread(Path::new(path), Diagnostic::new("no")));
        assert_eq!(names(&tests), ["a/1.csv", "b/1.csv", "2.csv"]);
    }

    #[test]
    fn a_cause_leaves_out_the_name_of_its_recording() {
        let test = DropTest::unread(Path::new("a/1.csv"), Diagnostic::new("a/1.csv: there is no contact"));
        assert_eq!(test.cause().as_deref(), Some("there is no contact"));
    }

    #[test]
    fn quartiles_of_a_travel_are_shown_in_the_order_of_its_sizes() {
        let scatter = |figure| FigureScatter {
            figure,
            count: 3,
            median: -0.16,
            quartiles: [-0.17, -0.15],
            range: [-0.18, -0.14],
        };
        let shown = scatter("peak_displacement_m").shown();
        for (found, expected) in shown.iter().zip([160.0, 150.0, 170.0, 140.0, 180.0]) {
            assert!((found - expected).abs() < 1e-9, "{shown:?}");
        }
        assert_eq!(scatter("impact_velocity_m_s").shown(), [-0.16, -0.17, -0.15, -0.18, -0.14]);
    }
}
