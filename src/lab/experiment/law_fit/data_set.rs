//! Measured nominal stresses over stretches: kinds of tests, and files.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use crate::error::{Error, refusal};
use crate::signal::annotations::stated;
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{MeasuredChannel, Measurement, with_unit};
use base::units::{Dimension, Pressure, Strain};
use membrane::material::Tension;

/// The measured stresses of one test.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSet {
    /// Name in figures and legends: that of its file.
    pub name: String,
    /// Stretches and stresses.
    pub measured: Measured,
    /// Its weight in a fit: the factor of its squared residuals.
    pub weight: f64,
    /// Whether its file marks it as virtual.
    pub is_virtual: bool,
}

/// Stretches and nominal stresses (Pa).
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// Stretch and stress along the tension.
    Tension(Tension, Vec<[f64; 2]>),
    /// Both principal stretches and both stresses.
    Biaxial(Vec<BiaxialPoint>),
}

/// Principal stretches in the plane and nominal stresses (Pa) along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiaxialPoint {
    /// λ₁ and λ₂.
    pub stretches: [f64; 2],
    /// P₁ and P₂, Pa.
    pub stresses: [f64; 2],
}

/// Largest stretch that is taken for one: the softest rubbers break at some 10.
const LARGEST_STRETCH: f64 = 100.0;

impl DataSet {
    /// The test `name` with the weight 1.
    ///
    /// # Errors
    /// Fewer than two points, numbers that are not finite, a stretch that is not positive, nothing but rest, or stresses
    /// that are all equal.
    pub fn new(name: impl Into<String>, measured: Measured) -> Result<DataSet, Error> {
        measured.check()?;
        Ok(DataSet { name: name.into(), measured, weight: 1.0, is_virtual: false })
    }

    /// The test with another weight.
    ///
    /// # Errors
    /// A weight below zero or not finite.
    pub fn with_weight(self, weight: f64) -> Result<DataSet, Error> {
        if weight.is_finite() && weight >= 0.0 {
            Ok(DataSet { weight, ..self })
        } else {
            Err(refusal!("expected a weight that is zero or above, found {weight}"))
        }
    }

    /// The kind of its test.
    pub fn kind(&self) -> TestKind {
        match self.measured {
            Measured::Tension(tension, _) => TestKind::Tension(tension),
            Measured::Biaxial(_) => TestKind::Biaxial,
        }
    }
}

impl Measured {
    /// All stresses, Pa: one a point, of biaxial tension P₁ and P₂ of each.
    pub fn stresses(&self) -> Vec<f64> {
        match self {
            Measured::Tension(_, points) => points.iter().map(|point| point[1]).collect(),
            Measured::Biaxial(points) => points.iter().flat_map(|point| point.stresses).collect(),
        }
    }

    /// The stretch that belongs to each of the [stresses](Measured::stresses).
    pub fn stretches(&self) -> Vec<f64> {
        match self {
            Measured::Tension(_, points) => points.iter().map(|point| point[0]).collect(),
            Measured::Biaxial(points) => points.iter().flat_map(|point| point.stretches).collect(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        match self {
            Measured::Tension(_, points) => points.len(),
            Measured::Biaxial(points) => points.len(),
        }
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn check(&self) -> Result<(), Error> {
        if self.len() < 2 {
            return Err(refusal!("{} measured points: a test has two at least", self.len()));
        }
        let (stretches, stresses) = (self.stretches(), self.stresses());
        let a_point = stresses.len() / self.len();
        for (place, (stretch, stress)) in stretches.iter().zip(&stresses).enumerate() {
            let row = place / a_point + 1;
            if !(stretch.is_finite() && stress.is_finite()) {
                return Err(refusal!("row {row} has no number for stretch or stress"));
            }
            if *stretch <= 0.0 {
                return Err(refusal!("the stretch {stretch} of row {row} is not above zero"));
            }
            if *stretch > LARGEST_STRETCH {
                return Err(refusal!(
                    "the stretch {stretch} of row {row} is larger than {LARGEST_STRETCH}, that of any film"
                ));
            }
        }
        if stretches.iter().all(|stretch| *stretch == 1.0) {
            return Err(refusal!("no stretch differs from 1"));
        }
        if stresses.iter().any(|stress| *stress != stresses[0]) {
            return Ok(());
        }
        // They have no scatter that a law could explain (R²).
        Err(match stresses[0] {
            0.0 => refusal!("no stress differs from 0"),
            stress => refusal!("all stresses are {stress} Pa: a test shows how stress changes with stretch"),
        })
    }
}

/// Smallest and largest stretch of all `sets`.
pub fn range(sets: &[DataSet]) -> [f64; 2] {
    let all = sets.iter().flat_map(|set| set.measured.stretches());
    all.fold([f64::INFINITY, 0.0], |[low, high], stretch| [low.min(stretch), high.max(stretch)])
}

/// The kind of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestKind {
    /// One stretch and the stress along it.
    Tension(Tension),
    /// Two stretches and both stresses.
    Biaxial,
}

/// Words of a kind: that of a header, that of a name, and others that are read.
const WORDS: [(TestKind, &[&str]); 4] = [
    (TestKind::Tension(Tension::Uniaxial), &["uniaxial", "ut", "uniaxial tension"]),
    (TestKind::Tension(Tension::Equibiaxial), &["equibiaxial", "et", "equibiaxial tension"]),
    (TestKind::Tension(Tension::Plane), &["plane", "ps", "plane tension", "pure shear", "planar", "planar tension"]),
    (TestKind::Biaxial, &["biaxial", "bt", "biaxial tension"]),
];

impl TestKind {
    /// The kind of a file: what is `given`, or else the line `test: uniaxial` of its header or the last word of its
    /// name (`treloar-ut`), which must agree.
    pub fn of_file(name: &str, header: &[String], given: Option<TestKind>) -> Result<TestKind, Error> {
        if let Some(given) = given {
            return Ok(given);
        }
        let header: Option<TestKind> = stated(header, "test").map(str::parse).transpose()?;
        let last = name.rsplit(['-', '_', ' ']).next().unwrap_or_default();
        match (named(last), header) {
            (Some(name), Some(header)) if name != header => {
                let error = refusal!("its name states {name}, its header {header}");
                Err(error.with_hint("correct one of them, or give --test"))
            }
            (name, header) => header.or(name).ok_or_else(|| {
                refusal!("the kind of test is not known")
                    .with_hint("write `# test: uniaxial` into its header, name it like treloar-ut.csv, or give --test")
            }),
        }
    }
}

fn named(word: &str) -> Option<TestKind> {
    let word = word.trim().to_lowercase();
    WORDS.into_iter().find(|(_, words)| words.contains(&word.as_str())).map(|(kind, _)| kind)
}

impl FromStr for TestKind {
    type Err = Error;

    fn from_str(word: &str) -> Result<TestKind, Error> {
        named(word).ok_or_else(|| {
            refusal!("`{}` is no kind of test: expected uniaxial, equibiaxial, plane or biaxial", word.trim())
                .with_hint("plane tension is also called pure shear; short: ut, et, ps, biaxial")
        })
    }
}

impl fmt::Display for TestKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TestKind::Tension(tension) => tension.fmt(f),
            TestKind::Biaxial => f.write_str("biaxial tension"),
        }
    }
}

/// How files of measured stresses are read.
#[derive(Clone, Debug, Default)]
pub struct StressReader {
    /// Kind of the test, in place of what the file states.
    pub kind: Option<TestKind>,
    /// How the tables are read.
    pub table: ReadOptions,
}

impl StressReader {
    /// Reads the test at `path`; see [`TestKind::of_file`] for how its kind is found.
    pub fn read(&self, path: &Path) -> Result<DataSet, Error> {
        let options = ReadOptions { channels: ChannelSelection::All, ..self.table.clone() };
        let table = file::columns(path, &options)?;
        self.data_set(path, &table).map_err(|error| error.in_file(path))
    }

    fn data_set(&self, path: &Path, table: &Measurement) -> Result<DataSet, Error> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let kind = TestKind::of_file(&name, table.annotations.comments(), self.kind)?;
        let measured = match kind {
            TestKind::Tension(tension) => {
                let stretches = stretches(table, "stretch", "strain")?;
                let stresses = stresses(table, "stress")?;
                Measured::Tension(tension, stretches.into_iter().zip(stresses).map(|(s, p)| [s, p]).collect())
            }
            TestKind::Biaxial => {
                let [l1, l2] = [stretches(table, "stretch_1", "strain_1")?, stretches(table, "stretch_2", "strain_2")?];
                let [p1, p2] = [stresses(table, "stress_1")?, stresses(table, "stress_2")?];
                let point = |i: usize| BiaxialPoint { stretches: [l1[i], l2[i]], stresses: [p1[i], p2[i]] };
                Measured::Biaxial((0..l1.len()).map(point).collect())
            }
        };
        Ok(DataSet { is_virtual: table.annotations.is_virtual(), ..DataSet::new(name, measured)? })
    }
}

/// Stretches of the column `stretch`, which may have no unit, or of engineering strains.
fn stretches(table: &Measurement, stretch: &str, strain: &str) -> Result<Vec<f64>, Error> {
    let ratios = |channel: &MeasuredChannel| match channel.unit {
        None => Ok(channel.series.values().to_vec()),
        Some(_) => values(channel, Strain::DIMENSION),
    };
    match table.channel(stretch) {
        Ok(channel) => ratios(channel),
        Err(missing) => {
            let strains = ratios(table.channel(strain).map_err(|_| with_columns(missing))?)?;
            Ok(strains.into_iter().map(|strain| 1.0 + strain).collect())
        }
    }
}

fn stresses(table: &Measurement, name: &str) -> Result<Vec<f64>, Error> {
    values(table.channel(name).map_err(with_columns)?, Pressure::DIMENSION)
}

fn values(channel: &MeasuredChannel, dimension: Dimension) -> Result<Vec<f64>, Error> {
    let series = channel.quantity(dimension);
    let series = series.map_err(|error| with_unit(error, |name, _| format!("--unit {name}=MPa")))?;
    Ok(series.values().to_vec())
}

/// The refusal of a missing column, with those that a test has.
fn with_columns(error: Error) -> Error {
    error.with_hint(
        "a test has the columns `stretch` (or `strain`) and `stress`, a biaxial one `stretch_1`, `stretch_2`, `stress_1` and \
         `stress_2`; --columns names them",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_and_name_state_the_kind() {
        for (name, header, expected) in [
            ("treloar-ut", &[][..], "uniaxial tension"),
            ("ET", &[], "equibiaxial tension"),
            ("sheet 3", &["test: pure shear"], "plane tension"),
            ("a_ps", &["# Test: PS"], "plane tension"),
            ("kawabata-biaxial", &["measured 1981"], "biaxial tension"),
        ] {
            let header: Vec<String> = header.iter().map(|line| (*line).to_owned()).collect();
            assert_eq!(TestKind::of_file(name, &header, None).map(|kind| kind.to_string()), Ok(expected.to_owned()));
        }
    }

    #[test]
    fn unknown_and_contradictory_kinds_are_refused() {
        for (name, header, expected) in [
            ("output", "", "the kind of test is not known"),
            ("x-ut", "test: et", "its name states uniaxial tension, its header equibiaxial tension"),
            ("x", "test: torsion", "`torsion` is no kind of test: expected uniaxial, equibiaxial, plane or biaxial"),
        ] {
            let error = TestKind::of_file(name, &[header.to_owned()], None).expect_err(name);
            assert_eq!(error.to_string(), expected);
            assert_eq!(TestKind::of_file(name, &[header.to_owned()], Some(TestKind::Biaxial)), Ok(TestKind::Biaxial));
        }
    }
}
