//! Specimens of a machine's export: which columns are force and displacement, and what its head states.

use std::path::Path;

use super::curve::Curve;
use super::label::{Labelled, is_same_speed, label, measured_speed};
use super::recording::{CouponReader, CouponTest, Dimensions, SpecimenNote, with_option};
use super::{Sample, shear};
use crate::error::{Error, Kind, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::export::{Key, Specimen, Stated, Statement, is_displacement, is_force};
use crate::signal::{Annotations, Series, ambiguous, check_dimension, missing};
use base::number::significant;
use base::units::{Dimension, Force, Length, Time};

impl CouponReader {
    /// Whether the only specimen of an export has the channels as they are asked for, so that it is read as any table.
    pub(super) fn is_plain(&self, specimen: &Specimen) -> bool {
        let has = |name: &String| specimen.columns.iter().any(|column| column.name == *name || column.label == *name);
        has(&self.force) && has(&self.displacement)
    }

    /// Reduces a specimen of the export at `path`.
    pub(super) fn reduce_specimen(&self, path: &Path, specimen: &Specimen) -> Result<CouponTest, Error> {
        let stated = &specimen.stated;
        let mut replaced = Vec::new();
        let coupon = self.dimensions.or(stated, &mut replaced).coupon(&stated.unused)?;
        let force = self.column(specimen, &self.force, "force", is_force, Force::DIMENSION)?;
        let displacement =
            self.column(specimen, &self.displacement, "displacement", is_displacement, Length::DIMENSION)?;
        let time = specimen.columns.iter().zip(&specimen.values).find(|(column, _)| column.is_time());
        let time = time.and_then(|(column, values)| {
            let unit = check_dimension(&column.name, column.unit.as_ref(), Time::DIMENSION).ok()?;
            Some(values.iter().map(|value| unit.to_si(*value)).collect::<Vec<f64>>())
        });
        let speed = time.and_then(|time| measured_speed(&time, displacement.1.values()));
        let label = self.label(path, specimen, speed, &mut replaced)?;
        let Labelled { direction, velocity, measured } = label;
        let columns = [&force, &displacement].map(|(label, _)| label.clone());
        let curve = coupon.curve(&force.1, &displacement.1)?;
        let sample = Sample::new(direction, velocity, &curve, &self.rules)?;
        let sample = Sample { is_virtual: Annotations::new(specimen.comments.clone()).is_virtual(), ..sample };
        let note = SpecimenNote { name: specimen.name.clone(), stated: stated.written(), replaced, columns };
        Ok(CouponTest { path: path.into(), sample, merged: curve.merged(), coupon, measured, specimen: Some(note) })
    }

    /// Direction and speed: given, stated by the head, or those of the name of the specimen or of the file.
    fn label(
        &self,
        path: &Path,
        specimen: &Specimen,
        measured: Option<f64>,
        replaced: &mut Vec<String>,
    ) -> Result<Labelled, Error> {
        let speed = specimen.stated.quantities.get(&Key::Speed);
        let mut header = specimen.comments.clone();
        header.extend(specimen.stated.direction.iter().map(|word| format!("direction: {word}")));
        header.extend(speed.iter().map(|speed| format!("velocity: {} m/s", speed.value)));
        if let (Some(given), Some(speed)) = (self.given.velocity, speed)
            && !is_same_speed(given, speed.value)
        {
            replaced.push(format!("velocity: {} m/s for {}", significant(given, 6), speed.written));
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        match label(&specimen.name, &header, self.given, measured) {
            Err(error) if *error.kind() == Kind::NoLabel => label(&stem, &header, self.given, measured),
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
        let unit = check_dimension(&column.name, unit, dimension).map_err(with_option)?;
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
        let head = |key: Key| stated.quantities.get(&key);
        Dimensions {
            gauge: one("gauge", self.gauge, head(Key::Grips).or(head(Key::Gauge))),
            width: one("width", self.width, head(Key::Width)),
            thickness: one("thickness", self.thickness, head(Key::Thickness)),
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

/// A strip of film between two jaws, unstretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupon {
    gauge: f64,
    width: f64,
    thickness: f64,
}

impl Coupon {
    /// A coupon of the length l₀ between the jaws, its width w and its thickness h, all in m.
    pub fn new(gauge: f64, width: f64, thickness: f64) -> Result<Coupon, Error> {
        for (what, value) in [("gauge length", gauge), ("width", width), ("thickness", thickness)] {
            if !(value.is_finite() && value > 0.0) {
                let value = significant(value, 6);
                return Err(refusal!("the {what} of a coupon is a positive length, not {value} m"));
            }
        }
        Ok(Coupon { gauge, width, thickness })
    }

    /// Length l₀ between the jaws, m.
    pub fn gauge(&self) -> f64 {
        self.gauge
    }

    /// Width w, m.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Thickness h, m.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Cross-section A₀ = h·w, m².
    pub fn area(&self) -> f64 {
        self.thickness * self.width
    }

    /// Nominal stress σ = F/A₀ (Pa) over engineering strain ε = d/l₀ (equation 1).
    ///
    /// `force` (N, tension positive) and `displacement` (m, of the jaws apart) share their time axis. Zero is where
    /// the recording has it: nothing is shifted here (see [`Curve::toe_compensated`]).
    ///
    /// # Errors
    /// Unequal time axes, a sample that was not measured, and what makes no [`Curve`].
    pub fn curve(&self, force: &Series, displacement: &Series) -> Result<Curve, Error> {
        if force.time() != displacement.time() {
            let [force, displacement] = [force, displacement].map(Series::len);
            return Err(refusal!(
                "force and displacement have no common time axis ({force} and {displacement} samples)"
            ));
        }
        for (quantity, series) in [("force", force), ("displacement", displacement)] {
            if let Some([time, _]) = series.samples().find(|[_, value]| !value.is_finite()) {
                return Err(refusal!("the {quantity} was not measured at {} s", significant(time, 9)));
            }
        }
        let strain = displacement.values().iter().map(|d| d / self.gauge).collect();
        let stress = force.values().iter().map(|f| f / self.area()).collect();
        Curve::new(strain, stress)
    }

    /// Shear of the film from a `curve` recorded at 45° (D3), by equations 4 to 8.
    ///
    /// The paper supposes a square that is stretched along its diagonal and does not say how much of the coupon it is.
    /// Stress and strain are **assumed** the same everywhere, so that a square with the diagonal √2 L carries √2 L/w of
    /// the force and has √2 L/l₀ of the displacement: then L cancels, τ = σ/(1 + ε). Here it is the largest that fits
    /// the coupon.
    ///
    /// # Errors
    /// Samples that make no [`Curve`].
    pub fn shear(&self, curve: &Curve) -> Result<shear::Shear, Error> {
        let square = shear::Square::with_diagonal(self.gauge.min(self.width), self.thickness);
        let force = self.area() * square.diagonal() / self.width;
        let forces: Vec<f64> = curve.stress().iter().map(|stress| stress * force).collect();
        let displacements: Vec<f64> = curve.strain().iter().map(|strain| strain * square.diagonal()).collect();
        square.shear(&forces, &displacements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coupon() -> Coupon {
        Coupon::new(5e-3, 10e-3, 12e-6).unwrap()
    }

    #[test]
    fn stress_and_strain_are_those_of_equation_1() {
        let (force, displacement) = (Series::new([0.0, 1.0], [0.0, 1.2]), Series::new([0.0, 1.0], [0.0, 1e-3]));
        let curve = coupon().curve(&force, &displacement).unwrap();
        assert!((curve.strain()[1] - 0.2).abs() < 1e-15);
        assert!((curve.stress()[1] / 10e6 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn shear_does_not_depend_on_the_size_of_the_coupon() {
        let curve = Curve::new(vec![0.0, 0.1, 0.2, 0.4], vec![0.0, 4e6, 6e6, 8e6]).unwrap();
        for [gauge, width] in [[5e-3, 10e-3], [50e-3, 10e-3], [100e-3, 15e-3]] {
            let sheared = Coupon::new(gauge, width, 12e-6).unwrap().shear(&curve).unwrap();
            assert_eq!(sheared.cut, 0);
            for ([strain, stress], [angle, shear]) in curve.samples().zip(sheared.curve.samples()) {
                // ψ = π/2 − γ is the angle at the stretched corners: the diagonal √2 L (1 + ε) is 2 L cos ψ/2.
                let diagonal = 2.0 * (0.5 * (std::f64::consts::FRAC_PI_2 - angle)).cos();
                assert!((diagonal / std::f64::consts::SQRT_2 - (1.0 + strain)).abs() < 1e-12, "{gauge}: {angle}");
                assert!((shear - stress / (1.0 + strain)).abs() < 1e-6, "{gauge}: {shear}");
            }
        }
    }

    #[test]
    fn invalid_coupons_and_recordings_are_refused() {
        let negative = Coupon::new(5e-3, 10e-3, -12e-6).unwrap_err().to_string();
        assert_eq!(negative, "the thickness of a coupon is a positive length, not -0.000012 m");
        let line = |values: [f64; 3]| Series::new([0.0, 1.0, 2.0], values);
        let good = line([0.0, 1.0, 2.0]);
        for (force, displacement, expected) in [
            (&line([0.0, f64::NAN, 2.0]), &good, "the force was not measured at 1 s"),
            (&good, &good.window([0.0, 1.0]), "force and displacement have no common time axis (3 and 2 samples)"),
            (&good, &line([0.0, 0.002, 0.001]), "strain goes back at sample 3: 0.2 after 0.4"),
        ] {
            assert_eq!(coupon().curve(force, displacement).unwrap_err().to_string(), expected);
        }
    }
}
