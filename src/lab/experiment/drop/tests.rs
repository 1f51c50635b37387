//! Drops whose figures are known, and recordings that are not of a drop.

use super::*;
use crate::experiment::Warning;
use crate::experiment::absorption::{AbsorptionError, Body, energy_absorption};
use crate::experiment::fall::{Fall, Motion};
use crate::experiment::sensor::{Accelerometer, Laser, Sensors, virtual_drop};
use crate::signal::{Recording, Series, integrate};
use base::finding::Report;

const GRAVITY: f64 = 9.81;
const BODY: Body = Body { mass: 10.72, gravity: GRAVITY };
const TOWER: Tower = Tower { body: BODY, height: Some(1.5) };
const SPEED: f64 = 4.94;

fn seeds() -> u64 {
    thorough::choose(4, 8)
}

/// A film that hardens under load, F/M = 300 d + 9000 d² (SI), and unloads ten times as fast.
fn impact() -> [Series; 2] {
    let (substeps, step) = (100, 1e-6);
    let loaded = |depth: f64| 300.0 * depth + 9000.0 * depth * depth;
    let (mut place, mut velocity, mut deepest) = (0.0_f64, -SPEED, 0.0_f64);
    let (mut time, mut accelerations, mut places) = (vec![], vec![], vec![]);
    for i in 0..=1200 * substeps {
        deepest = deepest.max(-place);
        let force = (loaded(deepest) * (1.0 - 10.0 * (1.0 + place / deepest.max(1e-9)))).max(0.0);
        let acceleration = force - GRAVITY;
        if i % substeps == 0 {
            time.push(f64::from(i) * step);
            accelerations.push(acceleration);
            places.push(place);
        }
        velocity += acceleration * step;
        place += velocity * step;
    }
    [Series::new(time.as_slice(), accelerations), Series::new(time.as_slice(), places)]
}

/// The sensors' recording of that impact, contact time, and D of the true motion.
fn recorded(sensors: &Sensors, seed: u64) -> (Recording, f64, f64) {
    recorded_after(0.0, sensors, seed)
}

/// The recording after a fall in which this share of the guide's friction at contact is proportional to the speed.
fn recorded_after(speed_share: f64, sensors: &Sensors, seed: u64) -> (Recording, f64, f64) {
    let [acceleration, displacement] = impact();
    let fall = Fall { height: 1.5, speed: SPEED, gravity: GRAVITY, release_duration: 0.032, speed_share };
    let drop = virtual_drop(&acceleration, &displacement, &fall, sensors, seed).unwrap();
    let velocity = integrate::once(&acceleration, -SPEED);
    let absorption = energy_absorption(BODY, velocity.values(), displacement.values()).unwrap();
    (drop.recording, drop.contact_time, absorption)
}

fn reading(recording: &Recording) -> Series {
    recording.series("accelerometer_m_s2").unwrap()
}

fn of_samples(samples: impl IntoIterator<Item = [f64; 2]>) -> Series {
    let (time, values): (Vec<f64>, Vec<f64>) = samples.into_iter().map(<(f64, f64)>::from).unzip();
    Series::new(time, values)
}

fn reduced(recording: &Recording, reduction: &Reduction) -> Result<Drop, crate::Error> {
    reduce(&reading(recording), recording.series("laser_m").as_ref(), &TOWER, reduction)
}

#[test]
fn figures_are_found_with_and_without_laser() {
    let deepest = impact()[1].smallest().unwrap()[1];
    for laser in [Sensors::default().laser, None] {
        for seed in 0..seeds() {
            let (recording, contact_time, absorption) = recorded(&Sensors { laser, ..Sensors::default() }, seed);
            let drop = reduced(&recording, &Reduction::default()).unwrap();
            let travel = drop.signals.series("displacement_m").unwrap().smallest().unwrap()[1];
            assert!((drop.contact.time - contact_time).abs() < 2e-4, "seed {seed}: {:?}", drop.contact);
            assert!((drop.contact.velocity / -SPEED - 1.0).abs() < 5e-3, "seed {seed}: {:?}", drop.contact);
            assert!((travel / deepest - 1.0).abs() < 0.01, "seed {seed}: {travel} for {deepest}");
            let found = drop.energy_absorption.unwrap();
            assert!((found - absorption).abs() < 0.01, "seed {seed}: {found} for {absorption}");
        }
    }
}

/// The guide's friction continues after contact, so that no step marks it, as with a soft film.
#[test]
fn without_a_step_at_contact_the_fall_still_gives_the_speed() {
    let rubbing = GRAVITY - SPEED * SPEED / 3.0;
    let [acceleration, _] = impact();
    let acceleration = acceleration.with_values(acceleration.values().iter().map(|a| a + rubbing).collect());
    let displacement = integrate::twice(&acceleration, -SPEED, 0.0);
    let [_, deepest] = displacement.smallest().unwrap();
    let fall = Fall { height: 1.5, speed: SPEED, gravity: GRAVITY, release_duration: 0.032, speed_share: 0.0 };
    let sensors = Sensors { laser: None, ..Sensors::default() };
    let mut held = 0;
    for seed in 0..8 {
        let made = virtual_drop(&acceleration, &displacement, &fall, &sensors, seed).unwrap();
        let drop = reduced(&made.recording, &Reduction::default()).unwrap();
        let travel = drop.signals.series("displacement_m").unwrap().smallest().unwrap()[1];
        assert!((drop.contact.time - made.contact_time).abs() < 6e-4, "seed {seed}: {:?}", drop.contact);
        assert!((drop.contact.velocity / -SPEED - 1.0).abs() < 5e-3, "seed {seed}: {:?}", drop.contact);
        assert!((travel / deepest - 1.0).abs() < 0.03, "seed {seed}: {travel} for {deepest}");
        let [low, high] = drop.intervals.unwrap().displacement;
        held += usize::from(low <= deepest && deepest <= high);
    }
    assert!(held >= 6, "{held} of 8");
}

/// Sensors without noise and with fine steps.
fn quiet() -> Sensors {
    let accelerometer = Accelerometer { noise: 0.0, bits: 32, ..Accelerometer::default() };
    Sensors { accelerometer, laser: Some(Laser { noise: 0.0, bits: 32, ..Laser::default() }), ..Sensors::default() }
}

/// Friction that is constant, and of which a tenth and a quarter are proportional to the speed.
#[test]
fn friction_that_grows_with_the_speed_is_allowed_for() {
    let mut held = 0;
    for seed in 0..3 * seeds() {
        let share = [0.0, 0.1, 0.25][seed as usize % 3];
        let (recording, _, absorption) = recorded_after(share, &Sensors::default(), seed);
        let drop = reduced(&recording, &Reduction::default()).unwrap();
        let intervals = drop.intervals.clone().unwrap();
        let [low, high] = intervals.time_constant.unwrap();
        assert!(high / low < 1.03, "seed {seed}: {low} to {high}");
        held += u64::from(low < 0.15 && 0.15 < high);
        let found = drop.energy_absorption.unwrap();
        assert!((found - absorption).abs() < 0.01, "seed {seed}: {found} for {absorption}");
        let [low, high] = intervals.energy_absorption.unwrap();
        assert!(low <= found && found <= high && high - low < 0.02, "seed {seed}: {low} to {high}");
    }
    assert!(6 * held >= 5 * 3 * seeds(), "{held} of {}", 3 * seeds());
}

#[test]
fn laser_height_and_fall_that_disagree_are_named() {
    let (recording, ..) = recorded(&Sensors::default(), 3);
    let (reading, laser) = (reading(&recording), recording.series("laser_m").unwrap());
    let stretched = laser.with_values(laser.values().iter().map(|place| 1.05 * place).collect());
    let low = Tower { height: Some(1.4), ..TOWER };
    for (laser, tower, expected) in [
        (&laser, TOWER, &[][..]),
        // Either may be wrong.
        (&stretched, TOWER, &["laser-speed-differs", "drop-height-differs"]),
        (&laser, low, &["drop-height-differs"]),
    ] {
        let drop = reduce(&reading, Some(laser), &tower, &Reduction::default()).unwrap();
        let found = drop.warnings.iter().map(|warning| warning.code().name).next();
        assert_eq!(found.is_some(), !expected.is_empty(), "{:?}", drop.warnings);
        assert!(found.is_none_or(|found| expected.contains(&found)), "{:?}", drop.warnings);
    }
}

#[test]
fn the_friction_of_the_guide_is_that_of_the_fall() {
    for share in [0.0, 0.5] {
        let (recording, ..) = recorded_after(share, &quiet(), 2);
        let drop = reduced(&recording, &Reduction::default()).unwrap();
        let friction = drop.guide_friction.unwrap();
        let mean = BODY.mass * (GRAVITY - 0.5 * SPEED * SPEED / 1.5);
        assert!((friction.force_at(SPEED / 1.5) / mean - 1.0).abs() < 0.05, "{share}: {friction:?} for {mean}");
        let [all, film] = [drop.energy_absorption, drop.film_absorption].map(|of| of.unwrap());
        assert!(film < all && all - film < 0.05, "{film} {all}");
    }
}

/// A sensor that holds a constant is found, as are 5 kHz, and the class that they allow.
#[test]
fn a_dc_coupled_sensor_is_found() {
    let accelerometer = Accelerometer { time_constant: 1e6, ..Accelerometer::default() };
    let sensors = Sensors { accelerometer, laser: None, sample_rate: 5e3, ..Sensors::default() };
    for seed in 0..seeds() {
        let (recording, contact_time, _) = recorded(&sensors, seed);
        let drop = reduced(&recording, &Reduction::default()).unwrap();
        assert_eq!((drop.time_constant, drop.class), (Some(f64::INFINITY), Some(180.0)), "seed {seed}");
        let codes: Vec<&str> = drop.warnings.iter().map(|warning| warning.code().name).collect();
        assert!(codes.contains(&"dc-coupled") && codes.contains(&"class-of-rate"), "seed {seed}: {codes:?}");
        assert!((drop.contact.time - contact_time).abs() < 1e-3, "seed {seed}: {:?}", drop.contact);
        assert_eq!(drop.figures().time_constant_s, None);
    }
}

/// What a wrong unit or sign looks like.
#[test]
fn other_units_and_signs_are_named() {
    let accelerometer = Accelerometer { time_constant: 1e6, ..Accelerometer::default() };
    let (recording, ..) = recorded(&Sensors { accelerometer, laser: None, ..Sensors::default() }, 1);
    let reading = reading(&recording);
    let times = |factor: f64| reading.with_values(reading.values().iter().map(|r| factor * r).collect());
    let milliseconds = of_samples(reading.samples().map(|[t, v]| [1e3 * t, v]));
    for (series, expected) in [
        (times(9.81), "as if it were in m/s² and was read in g"),
        (times(1.0 / 9.81), "as if it were in g and was read in m/s²"),
        (times(-1.0), "the sign looks reversed"),
        (milliseconds, "are the times in milliseconds?"),
    ] {
        let refused = reduce(&series, None, &TOWER, &Reduction::default()).unwrap_err().to_string();
        assert!(refused.contains(expected), "{expected}: {refused}");
    }
}

/// Values that a laser holds, or writes, out of its range.
#[test]
fn constant_samples_of_a_laser_count_as_not_measured() {
    let (recording, contact_time, _) = recorded(&Sensors::default(), 5);
    let laser = recording.series("laser_m").unwrap();
    let hold = |last: &mut f64, v: &f64| {
        *last = if v.is_finite() { *v } else { *last };
        Some(*last)
    };
    let held = laser.with_values(laser.values().iter().scan(0.015, hold).collect());
    let zero = laser.with_values(laser.values().iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect());
    for laser in [held, zero] {
        let drop = reduce(&reading(&recording), Some(&laser), &TOWER, &Reduction::default()).unwrap();
        assert!((drop.contact.time - contact_time).abs() < 2e-4, "{:?}", drop.contact);
        let held = |warning: &Warning| matches!(warning, Warning::LaserOutOfRange { .. });
        assert!(drop.warnings.iter().any(held), "{:?}", drop.warnings);
    }
}

#[test]
fn doubtful_figures_have_warnings() {
    let (recording, ..) = recorded(&Sensors::default(), 6);
    let (reading, laser) = (reading(&recording), recording.series("laser_m").unwrap());
    let noted = |reading: &Series, laser: &Series, reduction: Reduction| {
        reduce(reading, Some(laser), &TOWER, &reduction).unwrap().figures().notes.join("; ")
    };
    assert_eq!(noted(&reading, &laser, Reduction::default()), "");
    let changed = |f: &dyn Fn([f64; 2]) -> f64| reading.with_values(reading.samples().map(f).collect());
    let short = Reduction { correction: Correction::Coupling { time_constant: Some(0.03) }, ..Reduction::default() };
    let refused = reduce(&reading, Some(&laser), &TOWER, &short);
    let refused = refused.expect_err("a coupling that the fall excludes").to_string();
    assert!(refused.starts_with("acceleration: the reading leaves the fall at "), "{refused}");
    for (reading, reduction, expected) in [
        (changed(&|[_, v]| v.min(80.0)), Reduction::default(), "which may be the end of its range"),
        (changed(&|[t, v]| v + 3.0 * t), Reduction::default(), "the reading at rest drifts by 3.0"),
    ] {
        let notes = noted(&reading, &laser, reduction);
        assert!(notes.contains(expected), "{expected}: {notes}");
    }
    let mut hit = reduce(&reading, Some(&laser), &TOWER, &Reduction::default()).unwrap();
    let filtered =
        hit.signals.channels.iter_mut().find(|channel| channel.name == "acceleration_filtered_m_s2").unwrap();
    *filtered.values.last_mut().unwrap() = 1e3;
    hit.intervals = None;
    let warnings = super::release::warnings(&hit, &reading, 0.1);
    assert!(matches!(warnings[0], Warning::LatePeak { .. }), "{warnings:?}");
    let wavy = laser.with_values(laser.samples().map(|[t, v]| v + 0.0025 * (3000.0 * t).sin()).collect());
    assert!(noted(&reading, &wavy, Reduction::default()).ends_with("mm apart"));
    let turned = changed(&|[_, v]| -v);
    let refused = reduce(&turned, Some(&laser), &TOWER, &Reduction::default()).unwrap_err().to_string();
    assert!(refused.contains("the sign looks reversed"), "{refused}");
}

#[test]
fn a_time_constant_that_is_known_is_used() {
    let (recording, ..) = recorded(&Sensors::default(), 1);
    let given = Correction::Coupling { time_constant: Some(0.15) };
    let drop =
        reduced(&recording, &Reduction { correction: given, class: Class::None, ..Reduction::default() }).unwrap();
    assert_eq!(drop.time_constant, Some(0.15));
    let raw = drop.signals.channel("acceleration_m_s2");
    assert_eq!(raw, drop.signals.channel("acceleration_filtered_m_s2"));
}

/// The ramp gives contact and travel, but not the shift of the sensor's zero in the impact, which is smaller with a
/// longer time constant.
#[test]
fn the_ramp_gives_travel_but_errs_in_absorption_by_the_time_constant() {
    let deepest = impact()[1].smallest().unwrap()[1];
    let error = |time_constant| {
        let accelerometer = Accelerometer { time_constant, ..Accelerometer::default() };
        let (recording, contact_time, absorption) = recorded(&Sensors { accelerometer, ..Sensors::default() }, 3);
        let ramp = Reduction { correction: Correction::Ramp, ..Reduction::default() };
        let drop = reduced(&recording, &ramp).unwrap();
        assert!((drop.contact.time - contact_time).abs() < 2e-4, "{:?}", drop.contact);
        assert!((drop.contact.velocity / -SPEED - 1.0).abs() < 5e-3, "{:?}", drop.contact);
        let travel = drop.signals.series("displacement_m").unwrap().smallest().unwrap()[1];
        assert!((travel / deepest - 1.0).abs() < 0.02, "{travel} for {deepest}");
        (drop.energy_absorption.unwrap() - absorption).abs()
    };
    let errors = [0.15, 0.3, 0.6].map(error);
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
    assert!(errors[0] > 0.03, "{errors:?}");
}

/// The magnet's force falls to zero over 32 ms as a parabola; AC-coupled, the reading has its minimum at τ ln(1 + T/τ)
/// already, and the ramp is fitted to the reading.
#[test]
fn the_ramp_lasts_as_long_as_the_reading_falls() {
    let quiet = Accelerometer { noise: 0.0, bits: 32, ..Accelerometer::default() };
    for time_constant in [0.15, 0.3, 1.0, 20.0] {
        let accelerometer = Accelerometer { time_constant, ..quiet };
        let (recording, ..) = recorded(&Sensors { accelerometer, ..Sensors::default() }, 3);
        let ramp = Reduction { correction: Correction::Ramp, ..Reduction::default() };
        let found = reduced(&recording, &ramp).unwrap().ramp.unwrap().duration;
        let falls = time_constant * (0.032 / time_constant).ln_1p();
        assert!((found - falls).abs() < 1e-3, "{found} for {falls} with {time_constant}");
    }
}

/// The work of the motion's own acceleration is exact, so that all of the drift is due to the filter.
#[test]
fn the_total_energy_drifts_by_the_work_that_the_filter_removes() {
    let (recording, ..) = recorded(&Sensors::default(), 6);
    let drift = |class| reduced(&recording, &Reduction { class, ..Reduction::default() }).unwrap().total_energy_drift;
    let [none, cfc_1000, cfc_60] = [Class::None, Class::Given(1000.0), Class::Given(60.0)].map(drift);
    assert!(none < 1e-10 && none < cfc_1000 && 10.0 * cfc_1000 < cfc_60, "{none} {cfc_1000} {cfc_60}");
}

#[test]
fn a_nearly_repeated_time_changes_little() {
    let (recording, contact_time, _) = recorded(&Sensors::default(), 2);
    let reading = reading(&recording);
    let mut samples: Vec<[f64; 2]> = reading.samples().collect();
    let [time, value] = samples[1000];
    samples.insert(1001, [time + 1e-13, value]);
    let drop =
        reduce(&of_samples(samples), recording.series("laser_m").as_ref(), &TOWER, &Reduction::default()).unwrap();
    assert!((drop.contact.time - contact_time).abs() < 2e-4);
}

#[test]
fn uneven_samples_are_brought_to_even_ones() {
    let (recording, contact_time, _) = recorded(&Sensors::default(), 2);
    let reading = reading(&recording);
    let kept = reading.samples().enumerate().filter(|(index, _)| index % 7 != 3 || *index < 2000);
    let uneven = of_samples(kept.map(|(_, sample)| sample));
    let laser = recording.series("laser_m").unwrap();
    let drop = reduce(&uneven, Some(&laser), &TOWER, &Reduction::default()).unwrap();
    assert!((drop.contact.time - contact_time).abs() < 2e-4);
}

#[test]
fn a_recording_that_ends_before_the_rebound_has_a_warning_and_no_absorption() {
    let (recording, contact_time, _) = recorded(&Sensors::default(), 4);
    let short = |name: &str| recording.series(name).unwrap().window([0.0, contact_time + 0.04]);
    let drop = reduce(&short("accelerometer_m_s2"), Some(&short("laser_m")), &TOWER, &Reduction::default()).unwrap();
    assert_eq!(drop.energy_absorption, None);
    let reason = AbsorptionError::NoUnloading;
    assert_eq!(drop.warnings, [Warning::NoEnergyAbsorption { reason }]);
}

#[test]
fn what_cannot_be_reduced_is_refused_by_channel() {
    let (recording, contact_time, _) = recorded(&Sensors { laser: None, ..Sensors::default() }, 5);
    let reading = reading(&recording);
    let default = Reduction::default();
    let refusal = |series: &Series, tower: &Tower, reduction: &Reduction| {
        reduce(series, None, tower, reduction).unwrap_err().to_string()
    };
    let unknown = Tower { height: None, ..TOWER };
    let too_high = Tower { height: Some(2.5), ..TOWER };
    let cfc_1000 = Reduction { class: Class::Given(1000.0), ..default };
    let weightless = Tower { body: Body { mass: 0.0, ..BODY }, ..TOWER };
    let sure = Reduction { speed_error: Some(0.0), ..default };
    let early = Reduction { contact_error: Some(-0.02), ..default };
    let gap = reading.with_values(reading.samples().map(|[t, v]| if t == 0.3 { f64::NAN } else { v }).collect());
    let slow = of_samples(reading.samples().step_by(10));
    for (found, expected) in [
        (refusal(&reading, &weightless, &default), "the mass is 0, but must be positive"),
        (refusal(&reading, &TOWER, &sure), "the error of the impact speed is 0, but must be positive"),
        (refusal(&reading, &TOWER, &early), "the error of the time of contact is -0.02, but must be positive"),
        (refusal(&gap, &TOWER, &default), "acceleration: nothing was measured at 0.3 s"),
        (refusal(&reading, &unknown, &default), "neither height, impact speed nor time of contact is known"),
        (refusal(&reading, &too_high, &default), "acceleration: the fall that was recorded has height 1."),
        (
            refusal(&slow, &TOWER, &cfc_1000),
            "acceleration: CFC 1000 needs at least 10000 samples a second, found 1000.0",
        ),
        (refusal(&reading.window([0.0, contact_time]), &TOWER, &default), "acceleration: there is no contact"),
        (refusal(&reading.window([0.0, 0.0]), &TOWER, &default), "acceleration: a series of 1 samples"),
        (refusal(&reading.window([0.3, 1.0]), &TOWER, &default), "acceleration: there is no release"),
    ] {
        assert!(found.starts_with(expected), "{found}");
    }
}

#[test]
fn landmarks_are_those_of_the_true_motion() {
    let [lowest, _] = impact()[1].smallest().unwrap();
    let (recording, contact_time, _) = recorded(&quiet(), 1);
    let drop = reduced(&recording, &Reduction::default()).unwrap();
    let found = Landmarks::of_drop(&drop);
    assert!((found.contact.unwrap() - contact_time).abs() < 2e-4, "{found:?}");
    assert!((found.lowest_point.unwrap() - contact_time - lowest).abs() < 1e-3, "{found:?}");
    // Released 1.5 m above the film: the fall with friction to 4.94 m/s.
    let fall = 2.0 * 1.5 / SPEED;
    assert!((contact_time - found.release.unwrap() - fall).abs() < 0.03, "{found:?}");
    let names: Vec<&str> = found.named().into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["release", "contact", "lowest point", "rebound"]);
    let [velocity, displacement] = drop.motion();
    assert!((velocity.value_at(drop.contact.time).unwrap() - drop.contact.velocity).abs() < 1e-9);
    assert!(displacement.value_at(drop.contact.time).unwrap().abs() < 1e-12);
    let [_, rebound] = drop.rebound().unwrap();
    assert!((velocity.value_at(found.rebound.unwrap()).unwrap() - rebound).abs() < 1e-2, "{rebound}");
    let fallen = displacement.value_at(found.release.unwrap()).unwrap();
    assert!((fallen / 1.5 - 1.0).abs() < 0.02, "it was released 1.5 m above the film: {fallen}");
}

/// Means over 5 ms of the reading fall 2 ms before a release of 1 ms begins, and late in a slow one.
#[test]
fn the_release_is_that_of_the_true_motion() {
    let [acceleration, displacement] = impact();
    for (release_duration, laser) in
        [(0.032, None), (0.032, Sensors::default().laser), (1e-3, None), (1e-3, Sensors::default().laser)]
    {
        let fall = Fall { height: 1.5, speed: SPEED, gravity: GRAVITY, release_duration, speed_share: 0.0 };
        let sensors = Sensors { laser, ..Sensors::default() };
        let drop = virtual_drop(&acceleration, &displacement, &fall, &sensors, 1).unwrap();
        let released = drop.contact_time - Motion::new(&fall, &acceleration, &displacement).unwrap().fall_time();
        let found = reduced(&drop.recording, &Reduction::default()).unwrap().release;
        assert!((found - released).abs() < 2e-4, "released in {release_duration} s at {released}, found {found}");
    }
}

#[test]
fn what_was_found_of_a_drop_that_is_not_reduced_is_kept() {
    let (recording, ..) = recorded(&Sensors { laser: None, ..quiet() }, 1);
    let reading = reading(&recording);
    let tower = Tower { height: Some(0.5), ..TOWER };
    let error = reduce(&reading, None, &tower, &Reduction::default()).unwrap_err();
    let found = Landmarks::of_failed(&reading, GRAVITY, &error);
    assert!(found.contact.is_none() && found.impact.unwrap() > found.release.unwrap(), "{found:?}");
    let whole = reduced(&recording, &Reduction::default()).unwrap();
    let fall = reading.window([0.0, whole.contact.time]);
    let error = reduce(&fall, None, &TOWER, &Reduction::default()).unwrap_err();
    assert_eq!(Landmarks::of_failed(&fall, GRAVITY, &error), Landmarks::default());
}

/// An impactor that meets something soft first and the film, or the end of its guide, 0.15 s later, as measured falls into water show it
/// (DC-coupled, 2 kHz): neither contact is made of both.
#[test]
fn a_fall_that_something_else_stops_is_refused() {
    let step = 5e-4;
    let mut stream = uncertain(1);
    for (spike, drag) in thorough::first(1, [(2.0, 0.5), (0.6, 0.2), (12.0, 1.8)]) {
        let (release, entry) = (0.6, 0.6 + (2.0 * TOWER.height.unwrap() / GRAVITY).sqrt());
        let value = |t: f64| match t {
            t if t < release => GRAVITY,
            t if t < entry => 0.0,
            t if t < entry + 0.003 => spike * GRAVITY,
            t if t < entry + 0.15 => (drag + 2.0 * (t - entry)) * GRAVITY,
            t if t < entry + 0.17 => 30.0 * GRAVITY * (std::f64::consts::PI * (t - entry - 0.15) / 0.02).sin(),
            _ => GRAVITY,
        };
        let time: Vec<f64> = (0..2800).map(|sample| step * f64::from(sample)).collect();
        let values: Vec<f64> = time.iter().map(|t| value(*t) + 0.03 * stream()).collect();
        let error = reduce(&Series::new(time, values), None, &TOWER, &Reduction::default()).expect_err("no film");
        let error = error.to_string();
        let known =
            ["the reading leaves the fall", "no force that grows with the travel", "the fall that was recorded has"];
        assert!(known.iter().any(|known| error.contains(known)), "{error}");
        if let Some((_, rest)) = error.split_once("explains the reading at ") {
            let time: f64 = rest.split(' ').next().and_then(|time| time.parse().ok()).expect("a time");
            assert!((time - entry).abs() < 0.01, "{time} for {entry}");
        }
    }
}

/// Normal numbers.
fn uncertain(seed: u64) -> impl FnMut() -> f64 {
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut random)
}

/// A laser whose zero is off shows another contact than the force does.
#[test]
fn a_laser_that_the_force_contradicts_is_reported_and_intervals_hold_both() {
    for off in [0.005, -0.005] {
        let (recording, contact_time, _) = recorded(&Sensors::default(), 2);
        let laser = recording.series("laser_m").unwrap();
        let laser = laser.with_values(laser.values().iter().map(|place| place + off).collect());
        let drop = reduce(&reading(&recording), Some(&laser), &TOWER, &Reduction::default()).unwrap();
        let differs = drop.warnings.iter().find_map(|warning| match warning {
            Warning::LaserContactDiffers { laser, force, held: true } => Some(laser - force),
            _ => None,
        });
        let differs = differs.unwrap_or_else(|| panic!("{:?}", drop.warnings));
        assert!((differs - off / SPEED).abs() < 4e-4, "{off} m: {differs} s");
        let Intervals { contact_time: [early, late], impact_speed: [slow, fast], .. } = drop.intervals.unwrap();
        // 95 %, so that one of twenty misses the truth, by less than the laser alone does.
        assert!((early - 1e-4..late + 1e-4).contains(&contact_time), "{early} to {late} for {contact_time}");
        assert!((0.998 * slow..1.002 * fast).contains(&SPEED), "{slow} to {fast}");
        // The ramp has no intervals.
        let ramp = Reduction { correction: Correction::Ramp, ..Reduction::default() };
        let drop = reduce(&reading(&recording), Some(&laser), &TOWER, &ramp).unwrap();
        let messages = drop.warnings.iter().map(Warning::to_string).collect::<String>();
        assert!(messages.contains("the contact that the laser shows") && !messages.contains("hold both"), "{messages}");
    }
}

/// What follows the first impact changes none of its figures.
#[test]
fn figures_are_of_the_first_impact() {
    let (recording, ..) = recorded(&Sensors::default(), 3);
    let once = reduced(&recording, &Reduction::default()).unwrap();
    let mut twice = once.clone();
    let [.., before, last] = once.signals.time[..] else { panic!("too short") };
    twice.signals.time.extend(once.signals.time.iter().map(|time| time + last + (last - before)));
    for (channel, own) in twice.signals.channels.iter_mut().zip(&once.signals.channels) {
        // A faster impact that goes as deep.
        let factor = if channel.name == "displacement_m" { 1.0 } else { 1.1 };
        channel.values.extend(own.values.iter().map(|value| factor * value));
    }
    let figures = |drop: &Drop| {
        let Figures { peak_acceleration_m_s2, rebound_velocity_m_s, peak_displacement_m, time_of_rebound_s, .. } =
            drop.figures();
        [peak_acceleration_m_s2, rebound_velocity_m_s, peak_displacement_m, time_of_rebound_s]
    };
    assert_eq!(figures(&twice), figures(&once));
}

#[test]
fn errors_name_the_option_that_helps() {
    let (recording, ..) = recorded(&Sensors { laser: None, ..Sensors::default() }, 1);
    let reading = reading(&recording);
    let hint = |series: &Series| {
        let refused = reduce(series, None, &TOWER, &Reduction::default()).unwrap_err();
        refused.hint().unwrap_or_default().to_owned()
    };
    let milliseconds = of_samples(reading.samples().map(|[t, v]| [1e3 * t, v]));
    assert!(hint(&milliseconds).ends_with("--columns \"time [ms],accel [g]\""));
    let knocked = |[t, v]: [f64; 2]| if (0.045..0.051).contains(&t) { 400.0 } else { v };
    let hint = hint(&of_samples(reading.samples().map(|[t, v]| [t, knocked([t, v])])));
    assert!(hint.contains("is a knock and not the impact"), "{hint}");
    let mask = hint.split_once("--mask ").expect(&hint).1;
    let times: Vec<f64> =
        mask.trim_matches('"').split("..").map(|time| time.replace(" ms", "").parse().unwrap()).collect();
    assert!(times[0] < 45.0 && times[1] > 51.0 && times[1] < 90.0, "{hint}");
}
