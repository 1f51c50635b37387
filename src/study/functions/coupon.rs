//! Curves and coupon tests in scripts.

use std::path::PathBuf;
use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, EvalAltResult, INT, Map, NativeCallContext};

use crate::script::{Compared, HostResult, Options, Session, number, refuse, refuse_hinted, window};
use base::units::{Length, Mass, Velocity};
use lab::Error;
use lab::experiment::coupon::average::{SampleStatistics, mean_curve, mean_law, mean_of_means, relative_difference};
use lab::experiment::coupon::shear::Shear;
use lab::experiment::coupon::{
    BREAK_SHARE, Coupon, CouponReader, CouponTest, Curve, CurveEnd, DirectionMeans, Fibres, LoadCell, Machine,
    Reduction, Rules, Sample, ShearMethod, SpeedMeans, WINDOW, YieldPoints, relative_residuals, yield_points,
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
    read.map_err(|error| refuse_hinted(&error, error.hint()))
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

/// Offers the type `curve`, its functions and means to scripts.
pub(super) fn register_curves(engine: &mut Engine) {
    engine.register_type_with_name::<Curve>("curve");
    engine
        .register_fn("curve", build)
        .register_fn("len", |curve: &mut Curve| curve.strain().len() as INT)
        .register_fn("to_string", describe)
        .register_fn("strains", |curve: &mut Curve| list(curve.strain()))
        .register_fn("stresses", |curve: &mut Curve| list(curve.stress()))
        .register_fn("start", |curve: &mut Curve| curve.range()[0])
        .register_fn("end", |curve: &mut Curve| curve.range()[1])
        .register_fn("at", value_at)
        .register_fn("slice", slice)
        .register_fn("resultants", |curve: &mut Curve, thickness: Dynamic| {
            Ok::<_, Box<EvalAltResult>>(list(&curve.resultant(number(&thickness, "the thickness")?)))
        })
        .register_fn("modulus", |curve: &mut Curve| slope(curve, WINDOW))
        .register_fn("modulus", |curve: &mut Curve, window: Dynamic| slope(curve, strains(&window)?))
        .register_fn("toe_compensated", toe_compensated)
        .register_fn("rupture", |curve: &mut Curve| rupture(curve, BREAK_SHARE))
        .register_fn("rupture", |curve: &mut Curve, share: Dynamic| rupture(curve, number(&share, "the share")?))
        .register_fn("yield_points", |curve: &mut Curve| yields(curve, WINDOW))
        .register_fn("yield_points", |curve: &mut Curve, window: Dynamic| yields(curve, strains(&window)?))
        .register_fn("mean_curve", |curves: Array| mean(&curves, mean_curve))
        .register_fn("mean_law", |curves: Array| mean(&curves, mean_law))
        .register_fn("mean_of_means", |groups: Array| mean_of_groups(&groups))
        .register_fn("relative_residuals", |context: NativeCallContext, curve: Curve, reference: Curve| {
            let residuals = relative_residuals(&curve, &reference).map_err(refuse)?;
            Session::from_context(&context).add_comparison(|| Compared::curves(&curve, &reference));
            Ok::<_, Box<EvalAltResult>>(list(&residuals))
        })
        .register_fn("relative_difference", |measured: Dynamic, reference: Dynamic| {
            let reference = number(&reference, "the reference")?;
            Ok::<_, Box<EvalAltResult>>(relative_difference(number(&measured, "a figure")?, reference))
        })
        .register_fn("spread", |figures: Array| {
            let spread = SampleStatistics::from_figures(&numbers(&figures, "a figure")?).map_err(refuse)?;
            Ok::<_, Box<EvalAltResult>>(spread_map(&spread))
        });
}

/// A window of strain `[from, to]`.
pub(super) fn strains(value: &Dynamic) -> HostResult<[f64; 2]> {
    window(value)
}

/// Mean, deviation and count as a map of a script.
pub(super) fn spread_map(spread: &SampleStatistics) -> Map {
    let mut map = Map::new();
    map.insert("mean".into(), spread.mean.into());
    map.insert("deviation".into(), spread.deviation.into());
    map.insert("count".into(), (spread.count as INT).into());
    map
}

/// Yield points as a map of a script.
pub(super) fn yield_map(found: &YieldPoints) -> Map {
    let mut map = Map::new();
    map.insert("first".into(), list(&found.first).into());
    map.insert("second".into(), list(&found.second).into());
    map.insert("slopes".into(), list(&found.slopes).into());
    map.insert("residual".into(), found.residual.into());
    map
}

/// The numbers as a list.
pub(super) fn list(values: &[f64]) -> Array {
    values.iter().copied().map(Dynamic::from).collect()
}

/// The list as numbers; `what` names one of them in the error.
pub(super) fn numbers(items: &[Dynamic], what: &str) -> HostResult<Vec<f64>> {
    items.iter().map(|item| number(item, what)).collect()
}

fn build(strains: Array, stresses: Array) -> HostResult<Curve> {
    Curve::new(numbers(&strains, "a strain")?, numbers(&stresses, "a stress")?).map_err(refuse)
}

fn describe(curve: &mut Curve) -> String {
    let [start, end] = curve.range();
    format!("curve of {} samples from strain {start} to {end}", curve.strain().len())
}

fn value_at(curve: &mut Curve, strain: Dynamic) -> HostResult<f64> {
    let strain = number(&strain, "a strain")?;
    curve.stress_at(strain).ok_or_else(|| refuse(format!("the curve has no stress at the strain {strain}")))
}

fn slice(curve: &mut Curve, from: Dynamic, to: Dynamic) -> HostResult<Curve> {
    let range = [number(&from, "the start")?, number(&to, "the end")?];
    curve.within(range).ok_or_else(|| refuse(format!("fewer than two samples between {} and {}", range[0], range[1])))
}

fn slope(curve: &Curve, window: [f64; 2]) -> HostResult<f64> {
    Ok(curve.modulus(window).map_err(refuse)?.slope)
}

fn toe_compensated(curve: &mut Curve, window: Dynamic) -> HostResult<Curve> {
    let line = curve.modulus(strains(&window)?).map_err(refuse)?;
    Ok(curve.toe_compensated(line.slope, line.intercept))
}

fn rupture(curve: &Curve, share: f64) -> HostResult<Map> {
    let rupture = curve.rupture(share).map_err(refuse)?;
    let mut map = Map::new();
    map.insert("strain".into(), rupture.strain.into());
    map.insert("stress".into(), rupture.stress.into());
    map.insert("strength".into(), rupture.strength.into());
    map.insert("broke".into(), (rupture.ending == CurveEnd::Broke).into());
    Ok(map)
}

fn yields(curve: &Curve, window: [f64; 2]) -> HostResult<Map> {
    yield_points(curve, window).map(|found| yield_map(&found)).map_err(refuse)
}

fn mean(curves: &Array, of: fn(&[Curve]) -> Result<Curve, Error>) -> HostResult<Curve> {
    let curve = |item: &Dynamic| {
        let found = item.clone().try_cast::<Curve>();
        found.ok_or_else(|| refuse(format!("expected a curve, found {}", item.type_name())))
    };
    of(&curves.iter().map(curve).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}

fn mean_of_groups(groups: &[Dynamic]) -> HostResult<f64> {
    let group = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(figures) => numbers(&figures, "a figure"),
        None => Err(refuse(format!("expected a list of figures, found {}", item.type_name()))),
    };
    mean_of_means(&groups.iter().map(group).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}
