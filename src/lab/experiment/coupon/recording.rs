use std::path::{Path, PathBuf};

use serde::Serialize;

use super::label::{self, Label, Labelled};
use super::{Coupon, Curve, Rules, Sample};
use crate::error::{Error, Kind, refusal};
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{Measurement, with_unit};
use base::number::significant;
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
    /// Whether its speed is that of time and travel, and what else name or header state, m/s.
    pub measured: Option<Option<f64>>,
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

/// Makes one speed of those that time and travel show and that differ by their errors: that which others state, or else
/// their mean to three digits.
pub fn join_speeds(tests: &mut [CouponTest]) {
    let of = |tests: &[CouponTest], is_measured: bool| -> Vec<f64> {
        let those = tests.iter().filter(|test| test.measured.is_some() == is_measured);
        those.map(|test| test.sample.velocity).collect()
    };
    let (mut measured, stated) = (of(tests, true), of(tests, false));
    measured.sort_by(f64::total_cmp);
    for group in measured.chunk_by(|a, b| label::is_near(*a, *b)) {
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        let rounded = || significant(mean, 3).parse().unwrap_or(mean);
        let joined = stated.iter().copied().find(|speed| label::is_near(*speed, mean)).unwrap_or_else(rounded);
        let ends = [group[0], group[group.len() - 1]];
        let of_group =
            |test: &&mut CouponTest| test.measured.is_some() && (ends[0]..=ends[1]).contains(&test.sample.velocity);
        tests.iter_mut().filter(of_group).for_each(|test| test.sample.velocity = joined);
    }
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
            self.reduce_specimen(path, specimen).map_err(|error| error.in_file(&place(path, &specimen.name)))
        });
        reduced.collect()
    }

    /// Reads the recording at `path` and reduces it; see [`label::label`] for how its direction and speed are found.
    pub fn read(&self, path: &Path) -> Result<CouponTest, Error> {
        let channels = ChannelSelection::Named(vec![self.force.clone(), self.displacement.clone()]);
        let options = ReadOptions { channels, ..self.table.clone() };
        // Force over displacement needs no time: the speed is known from elsewhere.
        let measurement = match file::read(path, &options) {
            Err(error) if *error.kind() == Kind::NoTime => (file::columns(path, &options)?, false),
            read => (read?, true),
        };
        self.reduce(path, &measurement.0, measurement.1).map_err(|error| error.in_file(path))
    }

    fn reduce(&self, path: &Path, measurement: &Measurement, has_time: bool) -> Result<CouponTest, Error> {
        let force = measurement.channel(&self.force)?.quantity(Force::DIMENSION).map_err(with_option)?;
        let displacement = measurement.channel(&self.displacement)?;
        let displacement = displacement.quantity(Length::DIMENSION).map_err(with_option)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let speed = label::measured_speed(displacement.time(), displacement.values()).filter(|_| has_time);
        let label = label::label(&name, measurement.annotations.comments(), self.given, speed)?;
        let Labelled { direction, velocity, measured } = label;
        let coupon = self.dimensions.coupon(&[])?;
        let curve = coupon.curve(force, displacement)?;
        let sample = Sample::new(direction, velocity, &curve, &self.rules)?;
        let sample = Sample { is_virtual: measurement.annotations.is_virtual(), ..sample };
        Ok(CouponTest { path: path.into(), sample, merged: curve.merged(), coupon, measured, specimen: None })
    }
}

/// The refusal of a channel without a unit, with the option that gives it.
pub(super) fn with_option(error: Error) -> Error {
    with_unit(error, |name, unit| format!("it: --unit {name}={unit}"))
}

/// Whether the fault of an export says more than that of a table: it is one of the head, or is further on in the file.
fn is_behind(export: &Error, table: &Error) -> bool {
    *export.kind() == Kind::ExportHead || *table.kind() == Kind::EqualNames || export.line() > table.line()
}

/// The tensile machine of virtual tests: jaws that part at one speed, a load cell with noise, and a recorder that
/// rounds to so many decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Speed of the jaws apart, m/s.
    pub velocity: f64,
    /// Decimals of the recorded force in N.
    pub force_decimals: u8,
    /// Decimals of the recorded displacement in m and time in s.
    pub displacement_decimals: u8,
    /// The load cell with the jaw that hangs on it; none reads the force of the film as it is.
    pub load_cell: Option<LoadCell>,
}

/// A load cell that reads the deflection of its spring, with the mass of the jaw on it: an oscillator of second order
/// (methods.md, equations 184 and 185).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadCell {
    /// Mass m_j of the jaw and of what moves with it, kg.
    pub jaw_mass: f64,
    /// Stiffness k_c of the cell, N/m.
    pub stiffness: f64,
    /// Share ζ of the critical damping, from 0 to below 1.
    pub damping: f64,
}

impl LoadCell {
    /// Natural frequency √(k_c/m_j)/2π, Hz.
    pub fn frequency(&self) -> f64 {
        (self.stiffness / self.jaw_mass).sqrt() / std::f64::consts::TAU
    }

    fn check(&self) -> Result<(), Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let fits = positive(self.jaw_mass) && positive(self.stiffness) && (0.0..1.0).contains(&self.damping);
        if fits {
            return Ok(());
        }
        let LoadCell { jaw_mass, stiffness, damping } = self;
        Err(refusal!(
            "expected a jaw mass and a stiffness above zero and a damping from 0 to below 1, found {jaw_mass} kg, {stiffness} \
             N/m and {damping}"
        ))
    }

    /// Readings of a `force` (N) that is linear between the times `time` (s), from rest under the first:
    /// exact for that force (Nigam and Jennings, Bull. Seismol. Soc. Am. 59, 1969).
    pub fn read(&self, time: &[f64], force: &[f64]) -> Vec<f64> {
        let natural = (self.stiffness / self.jaw_mass).sqrt();
        let (decay, damped) = (self.damping * natural, natural * (1.0 - self.damping * self.damping).sqrt());
        let [mut reading, mut rate] = [force.first().copied().unwrap_or(0.0), 0.0];
        let mut readings: Vec<f64> = force.first().copied().into_iter().collect();
        for (times, forces) in time.windows(2).zip(force.windows(2)) {
            let step = times[1] - times[0];
            if step > 0.0 {
                let slope = (forces[1] - forces[0]) / step;
                // On a ramp the cell follows with the delay 2ζ/ω, about which it oscillates.
                let behind = 2.0 * self.damping / natural * slope;
                let (apart, apart_rate) = (reading - (forces[0] - behind), rate - slope);
                let other = (apart_rate + decay * apart) / damped;
                let ((sine, cosine), left) = ((damped * step).sin_cos(), (-decay * step).exp());
                reading = forces[1] - behind + left * (apart * cosine + other * sine);
                rate = slope
                    + left * ((other * damped - decay * apart) * cosine - (apart * damped + decay * other) * sine);
            }
            readings.push(reading);
        }
        readings
    }
}

/// A recording of the machine: as many times (s) as displacements (m) and forces (N).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TensileRecord {
    /// s.
    pub time: Vec<f64>,
    /// Of the jaws apart, m.
    pub displacement: Vec<f64>,
    /// N, tension positive.
    pub force: Vec<f64>,
}

impl Machine {
    /// Records a `coupon` whose film follows `curve` and is broken beyond its end, at `strains`; `noise` (N) is added
    /// to the force row by row. The force is that of the rounded displacement, so rounding adds no error; the
    /// deflection of the load cell is left out of the strain.
    pub fn pull(&self, coupon: &Coupon, curve: &Curve, strains: &[f64], noise: &[f64]) -> Result<TensileRecord, Error> {
        if !(self.velocity.is_finite() && self.velocity > 0.0) {
            return Err(not_positive(self.velocity));
        }
        if noise.len() != strains.len() {
            return Err(refusal!("{} values of noise for {} rows", noise.len(), strains.len()));
        }
        self.load_cell.iter().try_for_each(LoadCell::check)?;
        let mut pull = TensileRecord::default();
        let mut forces = Vec::with_capacity(strains.len());
        for strain in strains {
            let displacement = rounded(strain * coupon.gauge(), self.displacement_decimals);
            let stress = stress(curve, *strain, displacement / coupon.gauge())?;
            pull.time.push(rounded(displacement / self.velocity, self.displacement_decimals));
            pull.displacement.push(displacement);
            forces.push(stress * coupon.area());
        }
        let read = match &self.load_cell {
            Some(cell) => {
                let time: Vec<f64> =
                    pull.displacement.iter().map(|displacement| displacement / self.velocity).collect();
                cell.read(&time, &forces)
            }
            None => forces,
        };
        let recorded = read.iter().zip(noise).map(|(force, noise)| rounded(force + noise, self.force_decimals));
        pull.force = recorded.collect();
        Ok(pull)
    }
}

/// Stress at the rounded value of `strain`; the last one before the break may be rounded across it.
fn stress(curve: &Curve, strain: f64, rounded: f64) -> Result<f64, Error> {
    let [start, end] = curve.range();
    if strain > end {
        return Ok(0.0);
    }
    let inside = if strain >= start { curve.stress_at(rounded.clamp(start, end)) } else { None };
    inside.ok_or_else(|| refusal!("the film has no stress at the strain {strain}, where its curve has not begun"))
}

/// The refusal of a speed of the jaws (m/s).
pub(super) fn not_positive(velocity: f64) -> Error {
    refusal!("the speed of the jaws is positive, not {velocity} m/s")
}

fn rounded(value: f64, decimals: u8) -> f64 {
    let digits = 10_f64.powi(decimals.into());
    (value * digits).round() / digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupon::Direction;
    use crate::signal::Series;

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

    const MACHINE: Machine = Machine { velocity: 0.02, force_decimals: 6, displacement_decimals: 7, load_cell: None };

    fn parts() -> (Coupon, Curve) {
        (Coupon::new(5e-3, 10e-3, 12e-6).unwrap(), Curve::new(vec![0.0, 0.5, 1.0], vec![0.0, 10e6, 15e6]).unwrap())
    }

    #[test]
    fn a_recording_reduces_to_the_curve_of_its_film() {
        let (coupon, curve) = parts();
        let strains = [0.0, 0.123_456_789, 0.5, 1.0, 1.1];
        let pull = MACHINE.pull(&coupon, &curve, &strains, &[0.0; 5]).unwrap();
        assert_eq!(pull.displacement[1], 0.000_617_3);
        assert_eq!((pull.time[1], pull.force[4]), (0.030_865, 0.0));
        let series = |values: Vec<f64>| Series::new(pull.time.as_slice(), values);
        let found = coupon.curve(&series(pull.force.clone()), &series(pull.displacement.clone())).unwrap();
        for [strain, stress] in found.samples().take(4) {
            // Half of the last decimal of the force, on the cross-section.
            assert!((stress - curve.stress_at(strain.min(1.0)).unwrap()).abs() <= 0.51e-6 / coupon.area());
        }
    }

    #[test]
    fn noise_is_added_to_the_force() {
        let (coupon, curve) = parts();
        let pull = MACHINE.pull(&coupon, &curve, &[0.0, 0.5], &[-0.25, 0.5]).unwrap();
        assert_eq!(pull.force, [-0.25, 1.7]);
    }

    #[test]
    fn a_load_cell_follows_ramps_with_its_own_oscillation() {
        let cell = LoadCell { jaw_mass: 0.2, stiffness: 1e6, damping: 0.05 };
        assert!((cell.frequency() - 355.88).abs() < 0.01);
        let natural: f64 = (1e6_f64 / 0.2).sqrt();
        // A ramp of 1 N/ms and then a constant force, against small steps of the equation of motion.
        let (ramp, end) = (1000.0, 4e-3);
        let force = |time: f64| ramp * time.min(2e-3);
        let time: Vec<f64> = (0..=40).map(|i| end * f64::from(i) / 40.0).collect();
        let read = cell.read(&time, &time.iter().map(|time| force(*time)).collect::<Vec<_>>());
        let (steps, mut reading, mut rate) = (400_000, 0.0, 0.0);
        let dt = end / f64::from(steps);
        for i in 0..steps {
            let now = f64::from(i) * dt;
            if i % (steps / 40) == 0 {
                let found: f64 = read[(i / (steps / 40)) as usize];
                assert!((found - reading).abs() < 1e-3, "{now}: {found} for {reading}");
            }
            rate += dt * (natural * natural * (force(now + 0.5 * dt) - reading) - 2.0 * 0.05 * natural * rate);
            reading += dt * rate;
        }
        let slow: Vec<f64> = (0..=10).map(f64::from).collect();
        assert!(cell.read(&slow, &slow).iter().zip(&slow).all(|(read, force)| (read - force).abs() < 1e-3));
    }

    /// The window of the modulus at the fastest jaws of the study, 0.04 at 0.2 m/s on 5 mm, lasts 1 ms.
    #[test]
    fn a_heavy_jaw_makes_film_without_rates_seem_soft() {
        let coupon = Coupon::new(5e-3, 10e-3, 12e-6).unwrap();
        let film = Curve::new(vec![0.0, 0.04, 0.3], vec![0.0, 2e6, 8e6]).unwrap();
        let strains: Vec<f64> = (0..=60).map(|i| 0.001 * f64::from(i)).collect();
        let modulus = |velocity: f64| {
            let load_cell = Some(LoadCell { jaw_mass: 0.2, stiffness: 1e6, damping: 0.05 });
            let machine = Machine { velocity, load_cell, ..MACHINE };
            let pull = machine.pull(&coupon, &film, &strains, &[0.0; 61]).unwrap();
            let series = |values: &[f64]| Series::new(pull.time.as_slice(), values);
            let curve = coupon.curve(&series(&pull.force), &series(&pull.displacement)).unwrap();
            curve.modulus([0.0, 0.04]).unwrap().slope
        };
        assert!((modulus(0.02) / 50e6 - 1.0).abs() < 0.05, "{}", modulus(0.02));
        assert!(modulus(0.2) < 45e6 || modulus(0.2) > 55e6, "{}", modulus(0.2));
        let machine = |load_cell| Machine { load_cell: Some(load_cell), ..MACHINE };
        let wrong = LoadCell { jaw_mass: 0.0, stiffness: 1e6, damping: 0.05 };
        let refused = machine(wrong).pull(&coupon, &film, &[0.0], &[0.0]);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.ends_with("found 0 kg, 1000000 N/m and 0.05"), "{refused}");
    }

    #[test]
    fn impossible_recordings_are_refused() {
        let (coupon, curve) = parts();
        let late = curve.within([0.5, 1.0]).unwrap();
        let pull = |machine: Machine, curve, noise: &[f64]| {
            machine.pull(&coupon, curve, &[0.2], noise).unwrap_err().to_string()
        };
        let still = Machine { velocity: 0.0, ..MACHINE };
        assert_eq!(pull(still, &curve, &[0.0]), "the speed of the jaws is positive, not 0 m/s");
        assert_eq!(pull(MACHINE, &curve, &[]), "0 values of noise for 1 rows");
        assert!(pull(MACHINE, &late, &[0.0]).starts_with("the film has no stress at the strain 0.2"));
    }
}
