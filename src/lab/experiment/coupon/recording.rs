use std::path::{Path, PathBuf};

use super::label::{self, Label};
use super::{Coupon, Rules, Sample};
use crate::error::{Error, Kind};
use crate::signal::Measurement;
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use base::units::{Force, Length};

/// Dimensions of coupons, as far as they are given; others are those that the head of a file states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dimensions {
    /// Length between the jaws, m.
    pub gauge: Option<f64>,
    /// m.
    pub width: Option<f64>,
    /// m.
    pub thickness: Option<f64>,
}

impl From<Coupon> for Dimensions {
    fn from(coupon: Coupon) -> Dimensions {
        let [gauge, width, thickness] = [coupon.gauge(), coupon.width(), coupon.thickness()].map(Some);
        Dimensions { gauge, width, thickness }
    }
}

/// How recordings of coupons are read.
#[derive(Clone, Debug)]
pub struct CouponReader {
    /// Dimensions of the coupons.
    pub dimensions: Dimensions,
    /// Window of the modulus, criterion of the break, origin of strain.
    pub rules: Rules,
    /// Direction and speed that replace those of the files.
    pub given: Label,
    /// Name of the channel of force.
    pub force: String,
    /// Name of the channel of displacement.
    pub displacement: String,
    /// How the tables are read; columns other than these are not.
    pub table: ReadOptions,
}

/// A coupon's recording, read and reduced.
#[derive(Clone, Debug, PartialEq)]
pub struct CouponTest {
    /// Its file.
    pub path: PathBuf,
    /// Modulus, break and curve.
    pub sample: Sample,
    /// Samples that were merged because the displacement did not increase.
    pub merged: usize,
    /// Its dimensions.
    pub coupon: Coupon,
    /// Of a machine's export: its name, and what the head states of it.
    pub specimen: Option<SpecimenNote>,
}

/// A specimen as its export names it, and what of its head was used.
#[derive(Clone, Debug, PartialEq)]
pub struct SpecimenNote {
    /// Its name.
    pub name: String,
    /// What the head states of it, as it is written there.
    pub stated: Vec<String>,
    /// What was given in place of what the head states: `width: 10 mm for 10,05 mm`.
    pub replaced: Vec<String>,
    /// The columns of force and displacement.
    pub columns: [String; 2],
}

impl CouponTest {
    /// Its file, with the name of the specimen where that has one.
    pub fn place(&self) -> PathBuf {
        self.specimen.as_ref().map_or_else(|| self.path.clone(), |specimen| place(&self.path, &specimen.name))
    }
}

/// A specimen of a file, as a message names it.
fn place(path: &Path, specimen: &str) -> PathBuf {
    PathBuf::from(format!("{}, {specimen}", path.display()))
}

impl CouponReader {
    /// Of coupons with these dimensions, with the channels `force` and `displacement`, and defaults for the rest.
    pub fn new(dimensions: impl Into<Dimensions>, rules: Rules) -> CouponReader {
        let (force, displacement) = ("force".into(), "displacement".into());
        let (dimensions, given, table) = (dimensions.into(), Label::default(), ReadOptions::default());
        CouponReader { dimensions, rules, given, force, displacement, table }
    }

    /// Reads the recording at `path` and reduces its specimens: those of a machine's export, or the one of any other
    /// recording.
    pub fn read_all(&self, path: &Path) -> Result<Vec<CouponTest>, Error> {
        let export = if self.table.names.is_empty() { file::specimens(path) } else { Ok(None) };
        let export = match export {
            Ok(Some(export)) if export.is_of_machine() || !export.specimens.iter().all(|one| self.is_plain(one)) => {
                export
            }
            Ok(_) => return Ok(vec![self.read(path)?]),
            // Of two readers that refuse a file, the one that read more of it knows why.
            Err(error) => {
                return match self.read(path) {
                    Ok(test) => Ok(vec![test]),
                    Err(plain) if is_behind(&error, &plain) => Err(error),
                    Err(plain) => Err(plain),
                };
            }
        };
        let reduced = export.specimens.iter().map(|specimen| {
            self.reduce_specimen(path, specimen, &export.comments)
                .map_err(|error| error.in_file(&place(path, &specimen.name)))
        });
        reduced.collect()
    }

    /// Reads the recording at `path` and reduces it; see [`label::label`] for how its direction and speed are found.
    pub fn read(&self, path: &Path) -> Result<CouponTest, Error> {
        let channels = ChannelSelection::Named(vec![self.force.clone(), self.displacement.clone()]);
        let options = ReadOptions { channels, ..self.table.clone() };
        // Force over displacement needs no time: the speed is known from elsewhere.
        let measurement = match file::read(path, &options) {
            Err(error) if *error.kind() == Kind::NoTime => file::columns(path, &options)?.over_samples(),
            read => read?,
        };
        self.reduce(path, &measurement).map_err(|error| error.in_file(path))
    }

    fn reduce(&self, path: &Path, measurement: &Measurement) -> Result<CouponTest, Error> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let (direction, velocity) = label::label(&name, measurement.annotations.comments(), self.given)?;
        let force = measurement.channel(&self.force)?.quantity(Force::DIMENSION).map_err(with_unit)?;
        let displacement = measurement.channel(&self.displacement)?;
        let displacement = displacement.quantity(Length::DIMENSION).map_err(with_unit)?;
        let coupon = self.dimensions.coupon(&[])?;
        let curve = coupon.curve(force, displacement)?;
        let sample = Sample::new(direction, velocity, &curve, &self.rules)?;
        let sample = Sample { is_virtual: measurement.annotations.is_virtual(), ..sample };
        Ok(CouponTest { path: path.into(), sample, merged: curve.merged(), coupon, specimen: None })
    }
}

/// The refusal of a channel without a unit, with how to give it.
pub(super) fn with_unit(error: Error) -> Error {
    match error.kind().clone() {
        Kind::NoUnit { name, unit } => error.with_hint(format!(
            "write its unit into the header, e.g. `{name} [{unit}]`, or give it: --unit {name}={unit}"
        )),
        _ => error,
    }
}

/// Whether the fault of an export says more than that of a table: it is one of the head, or is further on in the file.
fn is_behind(export: &Error, table: &Error) -> bool {
    *export.kind() == Kind::ExportHead || *table.kind() == Kind::EqualNames || export.line() > table.line()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupon::Direction;

    fn read(name: &str, text: &str) -> Result<CouponTest, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let coupon = Coupon::new(5e-3, 10e-3, 12e-6).unwrap();
        CouponReader::new(coupon, Rules { window: [0.0, 0.2], ..Rules::default() }).read(&path)
    }

    const ROWS: &str = "0,0,0\n1,0.4,0.5\n2,0.8,1\n3,4,2\n4,4.1,0\n";

    #[test]
    fn a_table_needs_no_time() {
        let with_time = read("td-0.02-1.csv", &format!("time [s],displacement [mm],force [N]\n{ROWS}")).unwrap();
        let rows: String = ROWS.lines().map(|row| format!("{}\n", &row[2..])).collect();
        let without = read("td-0.02-1.csv", &format!("displacement [mm],force [N]\n{rows}")).unwrap();
        assert_eq!(without.sample, with_time.sample);
    }

    #[test]
    fn units_are_those_of_the_header() {
        let text = format!("# virtual\ntime [s],displacement [mm],force [N]\n{ROWS}");
        let recorded = read("td-0.02-1.csv", &text).unwrap();
        assert_eq!((recorded.sample.direction, recorded.sample.velocity), (Direction::Td, 0.02));
        assert!((recorded.sample.rupture.strain - 0.8).abs() < 1e-12 && recorded.sample.is_virtual);
        assert!((recorded.sample.modulus.slope / (1.0 / 1.2e-7 / 0.16) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn columns_beside_force_and_displacement_do_not_matter() {
        let rows: String = ROWS.lines().map(|row| format!("{row},ok\n")).collect();
        let recorded = read("td-0.02-1.csv", &format!("time_s,displacement_mm,force_N,status\n{rows}")).unwrap();
        assert!((recorded.sample.rupture.strain - 0.8).abs() < 1e-12 && !recorded.sample.is_virtual);
    }

    /// Others are in `tests/cmd/reduce-mistakes.trycmd`.
    #[test]
    fn mistakes_name_the_file() {
        for (head, rows, expected) in [
            ("load_N", ROWS, "md-0.02.csv:1:1: no channel `force`"),
            ("force_mm", ROWS, "md-0.02.csv: `force` is in mm"),
            ("force_N", "0,0,0\n1,1,\n", "md-0.02.csv: the force was not measured at 1 s"),
        ] {
            let error = read("md-0.02.csv", &format!("time_s,displacement_m,{head}\n{rows}")).unwrap_err().to_string();
            assert!(error.contains(expected), "{head} gave: {error}");
        }
    }
}
