//! Coupon tests in scripts: from force and displacement to the figures of a material.

use std::path::PathBuf;
use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, INT, Map, NativeCallContext};

use super::curve::{list, numbers, spread_map, strains, yield_map};
use super::recording::hinted;
use crate::script::{Entry, HostResult, Options, Session, refuse};
use base::units::{Length, Mass, Velocity};
use lab::Error;
use lab::experiment::coupon::shear::Shear;
use lab::experiment::coupon::{
    Coupon, CouponReader, CouponTest, Curve, DirectionMeans, Fibres, LoadCell, Machine, Reduction, Rules, Sample,
    ShearMethod, SpeedMeans,
};
use lab::signal::Series;
use membrane::material;

/// A reduction of coupons in a script. Cheap to clone.
#[derive(Clone)]
pub struct Reduced(pub Arc<Reduction>);

/// Offers the types `coupon` and `reduction` and their functions to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine.register_type_with_name::<Coupon>("coupon").register_type_with_name::<Reduced>("reduction");
    engine
        .register_fn("coupon", |strip: Map| coupon(&Options { of: "coupon", map: &strip }))
        .register_fn("curve", |coupon: &mut Coupon, force: Series, displacement: Series| {
            coupon.curve(&force, &displacement).map_err(refuse)
        })
        .register_get("area", |coupon: &mut Coupon| coupon.area())
        .register_get("gauge", |coupon: &mut Coupon| coupon.gauge())
        .register_get("thickness", |coupon: &mut Coupon| coupon.thickness())
        .register_fn("shear", |coupon: &mut Coupon, curve: Curve| sheared(coupon.shear(&curve)))
        .register_fn("shear", |coupon: &mut Coupon, curve: Curve, more: Map| shear(coupon, &curve, &more))
        .register_fn("pulled", pulled)
        .register_fn("reduce_coupons", |samples: Array| reduce(&samples, &Map::new()))
        .register_fn("reduce_coupons", |samples: Array, rules: Map| reduce(&samples, &rules))
        .register_get("directions", |reduced: &mut Reduced| {
            reduced.0.directions.iter().map(|along| along_map(along).into()).collect::<Array>()
        })
        .register_get("recordings", |reduced: &mut Reduced| reduced.0.recordings() as INT)
        .register_get("virtual_recordings", |reduced: &mut Reduced| reduced.0.virtual_recordings() as INT)
        .register_get("modulus", |reduced: &mut Reduced| reduced.0.modulus.map_or(Dynamic::UNIT, Dynamic::from));
}

/// Offers `read_coupons` to scripts that may read files.
pub(super) fn register_reading(engine: &mut Engine) {
    engine
        .register_fn("read_coupons", |context: NativeCallContext, pattern: &str, coupon: Coupon| {
            read_all(&Session::from_context(&context), pattern, coupon, &Map::new())
        })
        .register_fn("read_coupons", |context: NativeCallContext, pattern: &str, coupon: Coupon, rules: Map| {
            read_all(&Session::from_context(&context), pattern, coupon, &rules)
        });
}

/// The coupons whose files match `pattern`, each with its figures.
fn read_all(session: &Session, pattern: &str, coupon: Coupon, given: &Map) -> HostResult<Array> {
    let paths = glob::glob(pattern).map_err(|error| refuse(format!("`{pattern}`: {error}")))?;
    let paths: Vec<PathBuf> = paths.collect::<Result<_, _>>().map_err(refuse)?;
    if paths.is_empty() {
        return Err(refuse(format!("no file matches `{pattern}`")));
    }
    let reading = CouponReader::new(coupon, rules(&Options { of: "read_coupons", map: given })?);
    let read = |path: &PathBuf| {
        let recorded = reading.read_all(path)?;
        session.add_recording(path, recorded.iter().any(|test| test.sample.is_virtual));
        Ok::<Array, Error>(recorded.iter().map(|test| recorded_map(test).into()).collect())
    };
    let read = paths.iter().map(read).collect::<Result<Vec<Array>, Error>>().map(|arrays| arrays.concat());
    read.map_err(hinted)
}

/// The rules of a reduction from its options: `window`, `break_share`, `toe_compensation`.
fn rules(given: &Options<'_>) -> HostResult<Rules> {
    given.check(&["window", "break_share", "toe_compensation"])?;
    let usual = Rules::default();
    Ok(Rules {
        window: given.map.get("window").map_or(Ok(usual.window), strains)?,
        break_share: given.number("break_share", usual.break_share)?,
        toe_compensation: given.boolean("toe_compensation", usual.toe_compensation)?,
    })
}

fn coupon(strip: &Options<'_>) -> HostResult<Coupon> {
    strip.check(&["gauge", "width", "thickness"])?;
    let length = |name: &str| strip.quantity(name, Length::DIMENSION);
    Coupon::new(length("gauge")?, length("width")?, length("thickness")?).map_err(refuse)
}

fn shear(coupon: &Coupon, curve: &Curve, more: &Map) -> HostResult<Map> {
    let more = Options { of: "shear", map: more };
    more.check(&["md", "td", "shear_by"])?;
    let fibre = |name: &str| {
        let curve = more.value(name)?.clone().try_cast::<Curve>();
        let curve = curve.ok_or_else(|| refuse(format!("expected a curve as {name}: that of the fibres")))?;
        let points = curve.samples().filter(|[strain, _]| *strain > 0.0).collect();
        material::Curve::new(points).map_err(|error| refuse(format!("{name}: {error}")))
    };
    let method: Option<ShearMethod> =
        more.map.get("shear_by").map(|method| method.to_string().parse()).transpose().map_err(refuse)?;
    let (md, td) = (fibre("md")?, fibre("td")?);
    sheared(coupon.shear_by(method.unwrap_or_default(), curve, Fibres { md: &md, td: &td }))
}

fn sheared(sheared: Result<Shear, Error>) -> HostResult<Map> {
    let sheared = sheared.map_err(refuse)?;
    let mut map = Map::new();
    map.insert("curve".into(), Dynamic::from(sheared.curve));
    map.insert("cut".into(), (sheared.cut as INT).into());
    Ok(map)
}

fn pulled(coupon: &mut Coupon, curve: Curve, strains: Array, noise: Array, machine: Map) -> HostResult<Map> {
    let machine = Options { of: "pulled", map: &machine };
    let [mass, stiffness, damping] = ["jaw_mass", "load_cell_stiffness", "load_cell_damping"];
    machine.check(&["velocity", "force_decimals", "displacement_decimals", mass, stiffness, damping])?;
    let has_cell = [mass, stiffness, damping].iter().any(|name| machine.map.contains_key(*name));
    let load_cell = || -> HostResult<LoadCell> {
        Ok(LoadCell {
            jaw_mass: machine.quantity(mass, Mass::DIMENSION)?,
            stiffness: machine.needed_number(stiffness)?,
            damping: machine.number(damping, 0.0)?,
        })
    };
    let load_cell = has_cell.then(load_cell).transpose()?;
    let decimals = |name: &str| {
        let decimals = machine.value(name)?.as_int().ok().and_then(|count| u8::try_from(count).ok());
        decimals.filter(|count| *count <= 15).ok_or_else(|| refuse(format!("{name} is a whole number from 0 to 15")))
    };
    let machine = Machine {
        velocity: machine.quantity("velocity", Velocity::DIMENSION)?,
        force_decimals: decimals("force_decimals")?,
        displacement_decimals: decimals("displacement_decimals")?,
        load_cell,
    };
    let (strains, noise) = (numbers(&strains, "a strain")?, numbers(&noise, "noise")?);
    let pull = machine.pull(coupon, &curve, &strains, &noise).map_err(refuse)?;
    Ok(map([
        ("time", list(&pull.time).into()),
        ("displacement", list(&pull.displacement).into()),
        ("force", list(&pull.force).into()),
    ]))
}

fn reduce(samples: &[Dynamic], given: &Map) -> HostResult<Reduced> {
    let rules = rules(&Options { of: "reduce_coupons", map: given })?;
    let samples = samples.iter().map(|item| sample(item, &rules)).collect::<HostResult<Vec<_>>>()?;
    Reduction::from_samples(&samples, &rules).map(|reduction| Reduced(Arc::new(reduction))).map_err(refuse)
}

fn sample(item: &Dynamic, rules: &Rules) -> HostResult<Sample> {
    let Some(map) = item.read_lock::<Map>() else {
        return Err(refuse(format!(
            "a coupon's test is a map of direction, velocity and curve, not {}",
            item.type_name()
        )));
    };
    let test = Options { of: "a coupon's test", map: &map };
    let direction = test.value("direction")?.to_string().parse().map_err(refuse)?;
    let velocity = test.quantity("velocity", Velocity::DIMENSION)?;
    let curve = test.value("curve")?;
    let Some(curve) = curve.clone().try_cast::<Curve>() else {
        return Err(refuse(format!("expected a curve, found {}", curve.type_name())));
    };
    let is_virtual = test.boolean("is_virtual", false)?;
    let sample = Sample::new(direction, velocity, &curve, rules).map_err(refuse)?;
    Ok(Sample { is_virtual, ..sample })
}

fn recorded_map(recorded: &CouponTest) -> Map {
    let sample = &recorded.sample;
    map([
        ("file", recorded.path.display().to_string().into()),
        ("specimen", recorded.specimen.as_ref().map_or(Dynamic::UNIT, |specimen| specimen.name.clone().into())),
        ("direction", sample.direction.to_string().into()),
        ("angle", sample.direction.degrees().into()),
        ("velocity", sample.velocity.into()),
        ("curve", Dynamic::from(sample.curve.clone())),
        ("modulus", sample.modulus.slope.into()),
        ("strength", sample.rupture.strength.into()),
        ("elongation", sample.rupture.strain.into()),
        ("is_virtual", sample.is_virtual.into()),
    ])
}

fn along_map(along: &DirectionMeans) -> Map {
    let (yields, why) = match &along.yields {
        Ok(found) => (yield_map(found).into(), Dynamic::UNIT),
        Err(error) => (Dynamic::UNIT, error.to_string().into()),
    };
    map([
        ("direction", along.direction.to_string().into()),
        ("angle", along.direction.degrees().into()),
        ("modulus", spread_map(&along.modulus).into()),
        ("strength", spread_map(&along.strength).into()),
        ("elongation", spread_map(&along.elongation).into()),
        ("break_stress", spread_map(&along.break_stress).into()),
        ("curve", Dynamic::from(along.curve.clone())),
        ("yield_points", yields),
        ("no_yield_points", why),
        ("virtual_recordings", (along.virtual_recordings as INT).into()),
        ("speeds", along.speeds.iter().map(|speed| speed_map(speed).into()).collect::<Array>().into()),
    ])
}

fn speed_map(speed: &SpeedMeans) -> Map {
    map([
        ("velocity", speed.velocity.into()),
        ("moduli", list(&speed.moduli).into()),
        ("modulus", spread_map(&speed.modulus).into()),
        ("strength", spread_map(&speed.strength).into()),
        ("elongation", spread_map(&speed.elongation).into()),
        ("curve", Dynamic::from(speed.curve.clone())),
    ])
}

fn map<const N: usize>(pairs: [(&str, Dynamic); N]) -> Map {
    pairs.into_iter().map(|(name, value)| (name.into(), value)).collect()
}

/// The reference of the functions of coupon tests.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "coupon(#{ gauge, width, thickness })",
        gives: "a strip of film between two jaws, lengths with units or in m; area (m2), gauge and thickness can be read",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: 12e-6 }); (c.area / 1.2e-7 - 1).abs() < 1e-12 && c.gauge == 0.005"#,
    },
    Entry {
        call: "coupon.curve(force, displacement)",
        gives: "nominal stress over engineering strain of two signals, N and m (equation 1)",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let s = c.curve(signal([0, 1], [0, 1.2]), signal([0, 1], [0, 0.001])); (s.at(0.2) / 1e7 - 1).abs() < 1e-12"#,
    },
    Entry {
        call: "coupon.shear(curve)",
        gives: "a map: the curve of shear stress over shear angle (rad) of a square from a curve at 45 degrees (equations 4 to 8), and how many samples were cut; stress is assumed to be the same all over the coupon, so any square in it gives this curve",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let s = c.shear(curve([0, 0.1, 0.2, 0.5], [0, 1e6, 2e6, 5e6])); s.cut == 1 && s.curve.len() == 3"#,
    },
    Entry {
        call: "coupon.shear(curve, #{ md, td }), coupon.shear(curve, #{ md, td, shear_by: \"free\" | \"held\" | \"rhombus\" })",
        gives: "the same map, of a coupon whose fibres stretch by their curves md and td: with free sides (a strip long for its \
                width, used where nothing is given), with its width held, or as the rhombus above",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let f = curve([0, 1], [0, 4e7]);
                    let s = c.shear(curve([0, 0.1, 0.2], [0, 3e6, 5e6]), #{ md: f, td: f }); s.cut == 0 && s.curve.end() < 0.3"#,
    },
    Entry {
        call: "coupon.pulled(curve, strains, noise, #{ velocity, force_decimals, displacement_decimals })",
        gives: "a map of lists time (s), displacement (m) and force (N): the virtual recording of a machine at these strains of a film that follows the curve, plus noise (N)",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let p = c.pulled(curve([0, 1], [0, 1e7]), [0, 0.5, 2], [0, 0, 0.001], #{ velocity: "0.02 m/s", force_decimals: 4, displacement_decimals: 7 }); p.force == [0.0, 0.6, 0.001] && p.time[1] == 0.125"#,
    },
    Entry {
        call: "coupon.pulled(curve, strains, noise, #{ …, jaw_mass, load_cell_stiffness, load_cell_damping })",
        gives: "the same as a load cell reads it, with the mass of the jaw on it (kg), its stiffness (N/m) and its share of the \
                critical damping (0 where none is given): an oscillator of second order, which lags behind a fast force",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" });
                    let cell = #{ velocity: 0.2, force_decimals: 6, displacement_decimals: 7, jaw_mass: 0.2, load_cell_stiffness: 1e6 };
                    c.pulled(curve([0, 1], [0, 4e7]), [0, 0.01], [0, 0], cell).force[1] < 0.01"#,
    },
    Entry {
        call: "reduce_coupons([#{ direction, velocity, curve, is_virtual }, …]), reduce_coupons(tests, #{ window, break_share, toe_compensation })",
        gives: "a reduction: means per direction and speed, then over the speeds of each direction; is_virtual is false unless given, and the reduction counts it",
        example: r#"let c = curve([0, 0.01, 0.02, 1], [0, 5e5, 1e6, 9e6]); let r = reduce_coupons([#{ direction: "MD", velocity: "0.02 m/s", curve: c }], #{ window: [0, 0.02] }); r.directions[0].elongation.mean == 1.0"#,
    },
    Entry {
        call: "read_coupons(pattern, coupon), read_coupons(pattern, coupon, rules)",
        gives: "a list of maps for reduce_coupons: file, specimen (its name in an export of a machine), direction (MD, TD, D3, D4 or an angle such as 15deg) and its angle (degrees), velocity (from header or name), curve up to the break, modulus, strength, elongation, is_virtual",
        example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let tests = read_coupons("data/virtual/coupons/md-0.2-*.csv", c); tests.len() == 6 && tests[0].is_virtual && reduce_coupons(tests).virtual_recordings == 6"#,
    },
    Entry {
        call: "reduction.directions, reduction.modulus, reduction.recordings, reduction.virtual_recordings",
        gives: "a list of maps (direction, modulus, strength, elongation, break_stress, curve, yield_points or (), no_yield_points or (), virtual_recordings, speeds), the mean modulus of MD and TD, Pa, and how many coupons there are and are virtual",
        example: r#"let c = curve([0, 0.01, 0.02, 1], [0, 5e5, 1e6, 9e6]); let t = |d| #{ direction: d, velocity: 0.02, curve: c }; let r = reduce_coupons([t.call("MD"), t.call("TD")], #{ window: [0, 0.02] }); (r.modulus / 5e7 - 1).abs() < 1e-9 && r.directions[1].speeds[0].moduli.len() == 1 && r.directions[0].yield_points == () && r.recordings == 2 && r.virtual_recordings == 0"#,
    },
];
