//! Drop tests in scripts: virtual recordings, and the reduction of recordings.

use rhai::{Array, Dynamic, Engine, Map};

use crate::script::{self, HostResult, Options, refuse, window};
use lab::experiment::absorption::Body;
use lab::experiment::drop::{self, Bridged, Class, Correction, Drop, Reduction, Tower};
use lab::experiment::fall::Fall;
use lab::experiment::sensor::{self, Accelerometer, Laser, Sensors};
use lab::signal::column::{self, Column};
use lab::signal::{Recording, Series};

/// Default gravity, m/s²: equation 9 of the paper.
const GRAVITY: f64 = 9.81;

/// Channels of a reduced drop.
const CHANNELS: [Column; 8] = [
    column::DISPLACEMENT,
    column::VELOCITY,
    column::ACCELERATION_FILTERED,
    column::ACCELERATION,
    column::KINETIC_ENERGY,
    column::POTENTIAL_ENERGY,
    column::ABSORBED_ENERGY,
    column::TOTAL_ENERGY,
];

/// Options of `reduce_drop`.
const OF_REDUCTION: &str = "mass height gravity class correction time_constant bridge mask speed speed_error \
    contact_time contact_error height_error guide_friction";
/// Options of `virtual_drop`.
const OF_VIRTUAL: &str = "height velocity seed laser gravity letting_go friction_speed_share time_constant \
    noise offset rest sample_rate";

fn names(options: &'static str) -> Vec<&'static str> {
    options.split_whitespace().collect()
}

/// Offers `reduce_drop` and `virtual_drop` to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_fn("reduce_drop", |acceleration: Series, laser: Series, about: Map| {
            reduce(&acceleration, Some(&laser), &Options { of: "reduce_drop", map: &about })
        })
        .register_fn("reduce_drop", |acceleration: Series, _: (), about: Map| {
            reduce(&acceleration, None, &Options { of: "reduce_drop", map: &about })
        })
        .register_fn("virtual_drop", |acceleration: Series, displacement: Series, about: Map| {
            record(&acceleration, &displacement, &Options { of: "virtual_drop", map: &about })
        });
}

fn reduce(acceleration: &Series, laser: Option<&Series>, about: &Options<'_>) -> HostResult<Map> {
    about.check(&names(OF_REDUCTION))?;
    let body = Body { mass: about.needed_number("mass")?, gravity: about.number("gravity", GRAVITY)? };
    let tower = Tower { body, height: about.optional_number("height")? };
    let Bridged { series: acceleration, warning: bridged } = bridged(acceleration, about)?;
    let class = match about.map.get("class") {
        None => Class::OfRate,
        Some(none) if none.is_unit() => Class::None,
        Some(_) => Class::Given(about.needed_number("class")?),
    };
    let reduction = Reduction {
        correction: correction(about)?,
        class,
        speed: about.optional_number("speed")?,
        speed_error: about.optional_number("speed_error")?,
        contact_time: about.optional_number("contact_time")?,
        contact_error: about.optional_number("contact_error")?,
        height_error: about.optional_number("height_error")?,
        guide_friction: about.map.get("guide_friction").map(window).transpose()?,
    };
    let mut drop = drop::reduce(&acceleration, laser, &tower, &reduction).map_err(refuse)?;
    drop.warnings.extend(bridged);
    Ok(reduced(&drop))
}

/// The acceleration without the gaps that `bridge` and `mask` name.
fn bridged(acceleration: &Series, about: &Options<'_>) -> HostResult<Bridged> {
    let longest = about.optional_number("bridge")?;
    let masks = about.map.get("mask").map_or_else(|| Ok(Vec::new()), masks)?;
    if longest.is_none() && masks.is_empty() {
        return Ok(Bridged { series: acceleration.clone(), warning: None });
    }
    Ok(drop::bridged(acceleration, longest.unwrap_or(0.0), &masks))
}

/// One pair of times (s), or a list of them.
fn masks(value: &Dynamic) -> HostResult<Vec<[f64; 2]>> {
    let several = value.read_lock::<Array>();
    let is_list = several.as_deref().is_some_and(|masks| masks.iter().all(Dynamic::is_array));
    let masks: Vec<[f64; 2]> = match several.as_deref().filter(|_| is_list) {
        Some(masks) => masks.iter().map(window).collect::<HostResult<_>>()?,
        None => vec![window(value)?],
    };
    let reversed = masks.iter().find(|[from, to]| from.is_nan() || to.is_nan() || from >= to);
    let refusal = |[from, to]: &[f64; 2]| refuse!("a mask ends after it begins, not from {from} s to {to} s");
    reversed.map_or(Ok(()), |mask| Err(refusal(mask)))?;
    Ok(masks)
}

fn correction(about: &Options<'_>) -> HostResult<Correction> {
    let name = about.map.get("correction").map(Dynamic::to_string);
    match name.as_deref() {
        None | Some("coupling") => Ok(Correction::Coupling { time_constant: about.optional_number("time_constant")? }),
        Some("ramp") => Ok(Correction::Ramp),
        Some(other) => Err(refuse!("expected \"coupling\" or \"ramp\" for the correction, found {other}")),
    }
}

/// Figures and signals by name.
fn reduced(drop: &Drop) -> Map {
    let mut map = script::record(&drop.figures(), []);
    map.extend(CHANNELS.map(|Column { short, name, .. }| (short.into(), signal(&drop.signals, name))));
    map
}

fn record(acceleration: &Series, displacement: &Series, about: &Options<'_>) -> HostResult<Map> {
    about.check(&names(OF_VIRTUAL))?;
    let fall = Fall {
        height: about.needed_number("height")?,
        speed: about.needed_number("velocity")?,
        gravity: about.number("gravity", GRAVITY)?,
        release_duration: about.number("letting_go", 0.032)?,
        speed_share: about.number("friction_speed_share", 0.0)?,
    };
    let seed = about.map.get("seed").and_then(|seed| seed.as_int().ok());
    let seed = seed.ok_or_else(|| refuse("virtual_drop needs `seed`, a whole number"))?;
    let virtual_drop = sensor::virtual_drop(acceleration, displacement, &fall, &sensors(about)?, seed.cast_unsigned());
    let virtual_drop = virtual_drop.map_err(refuse)?;
    let recording = &virtual_drop.recording;
    Ok(Map::from([
        ("time".into(), Dynamic::from(Series::new(recording.time.as_slice(), recording.time.as_slice()))),
        ("accelerometer".into(), signal(recording, sensor::ACCELEROMETER)),
        ("laser".into(), signal(recording, sensor::LASER)),
        ("contact_time".into(), virtual_drop.contact_time.into()),
    ]))
}

fn sensors(about: &Options<'_>) -> HostResult<Sensors> {
    let assumed = Sensors::default();
    let accelerometer = Accelerometer {
        time_constant: about.number("time_constant", assumed.accelerometer.time_constant)?,
        noise: about.number("noise", assumed.accelerometer.noise)?,
        offset: about.number("offset", assumed.accelerometer.offset)?,
        ..assumed.accelerometer
    };
    let sees = match about.map.get("laser") {
        None => true,
        Some(flag) => flag.as_bool().map_err(|found| refuse!("expected true or false for laser, found {found}"))?,
    };
    let rest = match about.map.get("rest") {
        None => assumed.rest,
        Some(range) => window(range)?,
    };
    let sample_rate = about.number("sample_rate", assumed.sample_rate)?;
    Ok(Sensors { accelerometer, laser: sees.then(Laser::default), sample_rate, rest })
}

/// The channel as a signal, `()` where there is none.
fn signal(recording: &Recording, column: &str) -> Dynamic {
    recording.series(column).map_or(Dynamic::UNIT, Dynamic::from)
}
