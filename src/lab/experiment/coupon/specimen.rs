//! Specimens of a machine's export: which columns are force and displacement, and what its head states.

use std::path::Path;

use super::label::{is_same_speed, label};
use super::recording::{CouponReader, CouponTest, Dimensions, SpecimenNote, with_unit};
use super::{Coupon, Direction, Sample};
use crate::error::{Error, Kind, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::export::{Specimen, Stated, Statement, is_displacement, is_force};
use crate::signal::{Annotations, Series, ambiguous, check_dimension, missing};
use base::number::significant;
use base::units::{Dimension, Force, Length};

impl CouponReader {
    /// Whether the only specimen of an export has the channels as they are asked for, so that it is read as any table.
    pub(super) fn is_plain(&self, specimen: &Specimen) -> bool {
        let has = |name: &String| specimen.columns.iter().any(|column| column.name == *name || column.label == *name);
        has(&self.force) && has(&self.displacement)
    }

    /// Reduces a specimen of the export at `path`.
    pub(super) fn reduce_specimen(
        &self,
        path: &Path,
        specimen: &Specimen,
        comments: &[String],
    ) -> Result<CouponTest, Error> {
        let stated = &specimen.stated;
        let mut replaced = Vec::new();
        let coupon = self.dimensions.or(stated, &mut replaced).coupon(&stated.unused)?;
        let (direction, velocity) = self.label(path, specimen, comments, &mut replaced)?;
        let force = self.column(specimen, &self.force, "force", is_force, Force::DIMENSION)?;
        let displacement =
            self.column(specimen, &self.displacement, "displacement", is_displacement, Length::DIMENSION)?;
        let columns = [&force, &displacement].map(|(label, _)| label.clone());
        let curve = coupon.curve(&force.1, &displacement.1)?;
        let sample = Sample::new(direction, velocity, &curve, &self.rules)?;
        let sample = Sample { is_virtual: Annotations::new(comments.to_vec()).is_virtual(), ..sample };
        let note = SpecimenNote { name: specimen.name.clone(), stated: stated.written(), replaced, columns };
        Ok(CouponTest { path: path.into(), sample, merged: curve.merged(), coupon, specimen: Some(note) })
    }

    /// Direction and speed: given, stated by the head, or those of the name of the specimen or of the file.
    fn label(
        &self,
        path: &Path,
        specimen: &Specimen,
        comments: &[String],
        replaced: &mut Vec<String>,
    ) -> Result<(Direction, f64), Error> {
        let Stated { speed, direction, .. } = &specimen.stated;
        let mut header = comments.to_vec();
        header.extend(direction.iter().map(|word| format!("direction: {word}")));
        header.extend(speed.iter().map(|speed| format!("velocity: {} m/s", speed.value)));
        if let (Some(given), Some(speed)) = (self.given.velocity, speed)
            && !is_same_speed(given, speed.value)
        {
            replaced.push(format!("velocity: {} m/s for {}", significant(given, 6), speed.written));
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        match label(&specimen.name, &header, self.given) {
            Err(error) if *error.kind() == Kind::NoLabel => label(&stem, &header, self.given),
            found => found,
        }
    }

    /// Label and values of the column `wanted`, or, where the `usual` name is wanted and there is none, of the one that is
    /// named as machines name it.
    fn column(
        &self,
        specimen: &Specimen,
        wanted: &str,
        usual: &str,
        is: fn(&str) -> bool,
        dimension: Dimension,
    ) -> Result<(String, Series), Error> {
        let named = |column: &&(usize, &ColumnName)| column.1.name == wanted || column.1.label == wanted;
        let columns: Vec<(usize, &ColumnName)> = specimen.columns.iter().enumerate().collect();
        let mut found: Vec<&(usize, &ColumnName)> = columns.iter().filter(named).collect();
        if found.is_empty() && wanted == usual {
            found = columns.iter().filter(|(_, column)| is(&column.name)).collect();
        }
        let [(place, column)] = found[..] else {
            let labels = |columns: &[&(usize, &ColumnName)]| -> Vec<String> {
                columns.iter().map(|(_, column)| column.label.clone()).collect()
            };
            return Err(match found.is_empty() {
                true => missing(wanted, &labels(&columns.iter().collect::<Vec<_>>())),
                false => ambiguous(wanted, &labels(&found)),
            });
        };
        let given = self.table.units.iter().find(|(name, _)| *name == column.name || *name == column.label);
        let unit = column.unit.as_ref().or(given.map(|(_, unit)| unit));
        let unit = check_dimension(&column.name, unit, dimension).map_err(with_unit)?;
        let values: Vec<f64> = specimen.values[*place].iter().map(|value| unit.to_si(*value)).collect();
        let rows: Vec<f64> = (0..values.len()).map(|row| row as f64).collect();
        Ok((column.label.clone(), Series::new(rows, values)))
    }
}

impl Dimensions {
    /// These, and what the head states where one is not given.
    fn or(&self, stated: &Stated, replaced: &mut Vec<String>) -> Dimensions {
        let mut one = |what: &str, given: Option<f64>, head: Option<&Statement>| {
            if let (Some(given), Some(head)) = (given, head)
                && (given - head.value).abs() > 1e-9 * head.value.abs()
            {
                replaced.push(format!("{what}: {} mm for {}", significant(1e3 * given, 6), head.written));
            }
            given.or(head.map(|head| head.value))
        };
        Dimensions {
            gauge: one("gauge", self.gauge, stated.grips.as_ref().or(stated.gauge.as_ref())),
            width: one("width", self.width, stated.width.as_ref()),
            thickness: one("thickness", self.thickness, stated.thickness.as_ref()),
        }
    }

    /// The coupon of these dimensions; `unused` is what a head states that is none.
    ///
    /// # Errors
    /// One of them is not known, or not positive.
    pub(super) fn coupon(&self, unused: &[String]) -> Result<Coupon, Error> {
        let all = [("gauge", self.gauge), ("width", self.width), ("thickness", self.thickness)];
        let missing: Vec<&'static str> =
            all.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| *name).collect();
        match (self.gauge, self.width, self.thickness) {
            (Some(gauge), Some(width), Some(thickness)) => Coupon::new(gauge, width, thickness),
            _ => {
                let unused: String =
                    unused.iter().map(|statement| format!("; the head states `{statement}`")).collect();
                let missing = missing.join(", ");
                Err(refusal!("the dimensions of the coupon are not known: {missing}{unused}").with_hint(
                    "give --gauge, --width and --thickness, or state them in the head of the file: `Width;10;mm`",
                ))
            }
        }
    }
}
