//! Curves and coupon tests in scripts.

use std::path::PathBuf;
use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, EvalAltResult, INT, Map, NativeCallContext};
use serde_json::json;

use crate::script::{
    self, Compared, HostResult, Options, Session, list, number, numbers, record, refuse, refuse_hinted, shown,
};
use base::finding::Finding;
use base::units::{Length, Mass, Velocity};
use lab::Error;
use lab::experiment::coupon::average::{SampleStatistics, mean_curve, mean_law, mean_of_means, relative_difference};
use lab::experiment::coupon::shear::Shear;
use lab::experiment::coupon::{
    BREAK_SHARE, Coupon, CouponReader, CouponTest, Curve, CurveEnd, DirectionMeans, Fibres, LoadCell, Machine,
    Reduction, Rules, Rupture, Sample, ShearMethod, SpeedMeans, WINDOW, doubts, relative_residuals, yield_points,
};
use lab::signal::Series;
use membrane::material;

/// A reduction of coupons in a script. Cheap to clone.
#[derive(Clone)]
pub struct Reduced(pub Arc<Reduction>);

/// Offers the types `coupon`, `reduction` and `curve`, their functions and means to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_type_with_name::<Coupon>("coupon")
        .register_type_with_name::<Reduced>("reduction")
        .register_type_with_name::<Curve>("curve");
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
        .register_fn("modulus", |curve: &mut Curve, window: Dynamic| slope(curve, script::window(&window)?))
        .register_fn("toe_compensated", toe_compensated)
        .register_fn("rupture", |curve: &mut Curve| rupture(curve, BREAK_SHARE))
        .register_fn("rupture", |curve: &mut Curve, share: Dynamic| rupture(curve, number(&share, "the share")?))
        .register_fn("yield_points", |curve: &mut Curve| yields(curve, WINDOW))
        .register_fn("yield_points", |curve: &mut Curve, window: Dynamic| yields(curve, script::window(&window)?))
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
            Ok::<_, Box<EvalAltResult>>(shown(&spread))
        });
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
            reduced.0.directions.iter().map(|along| direction_map(along).into()).collect::<Array>()
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
    let paths = glob::glob(pattern).map_err(|error| refuse!("`{pattern}`: {error}"))?;
    let paths: Vec<PathBuf> = paths.collect::<Result<_, _>>().map_err(refuse)?;
    if paths.is_empty() {
        return Err(refuse!("no file matches `{pattern}`"));
    }
    let reading = CouponReader::new(coupon, rules(&Options { of: "read_coupons", map: given })?);
    let read = |path: &PathBuf| {
        let recorded = reading.read_all(path)?;
        session.add_recording(path, recorded.iter().any(|test| test.sample.is_virtual));
        Ok(recorded)
    };
    let read = paths.iter().map(read).collect::<Result<Vec<_>, Error>>();
    let tests = read.map_err(|error| refuse_hinted(&error, error.hint()))?.concat();
    session.report(doubts(&tests).iter().map(Finding::new));
    Ok(tests.iter().map(|test| recorded_map(test).into()).collect())
}

/// The rules of a reduction from its options: `window`, `break_share`, `toe_compensation`.
fn rules(given: &Options<'_>) -> HostResult<Rules> {
    given.check(&["window", "break_share", "toe_compensation"])?;
    let usual = Rules::default();
    Ok(Rules {
        window: given.map.get("window").map_or(Ok(usual.window), script::window)?,
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
    let more = Options::new("shear", more, &["md", "td", "shear_by"])?;
    let fibre = |name: &str| {
        let curve = more.value(name)?.clone().try_cast::<Curve>();
        let curve = curve.ok_or_else(|| refuse!("expected a curve as {name}: that of the fibres"))?;
        let points = curve.samples().filter(|[strain, _]| *strain > 0.0).collect();
        material::Curve::new(points).map_err(|error| refuse!("{name}: {error}"))
    };
    let method: Option<ShearMethod> =
        more.map.get("shear_by").map(|method| method.to_string().parse()).transpose().map_err(refuse)?;
    let (md, td) = (fibre("md")?, fibre("td")?);
    sheared(coupon.shear_by(method.unwrap_or_default(), curve, Fibres { md: &md, td: &td }))
}

fn sheared(sheared: Result<Shear, Error>) -> HostResult<Map> {
    let Shear { curve, cut, .. } = sheared.map_err(refuse)?;
    Ok(record(&json!({ "cut": cut }), [("curve", Dynamic::from(curve))]))
}

fn pulled(coupon: &mut Coupon, curve: Curve, strains: Array, noise: Array, machine: Map) -> HostResult<Dynamic> {
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
        decimals.filter(|count| *count <= 15).ok_or_else(|| refuse!("{name} is a whole number from 0 to 15"))
    };
    let machine = Machine {
        velocity: machine.quantity("velocity", Velocity::DIMENSION)?,
        force_decimals: decimals("force_decimals")?,
        displacement_decimals: decimals("displacement_decimals")?,
        load_cell,
    };
    let (strains, noise) = (numbers(&strains, "a strain")?, numbers(&noise, "noise")?);
    machine.pull(coupon, &curve, &strains, &noise).map(|pull| shown(&pull)).map_err(refuse)
}

fn reduce(samples: &[Dynamic], given: &Map) -> HostResult<Reduced> {
    let rules = rules(&Options { of: "reduce_coupons", map: given })?;
    let samples = samples.iter().map(|item| sample(item, &rules)).collect::<HostResult<Vec<_>>>()?;
    Reduction::from_samples(&samples, &rules).map(|reduction| Reduced(Arc::new(reduction))).map_err(refuse)
}

fn sample(item: &Dynamic, rules: &Rules) -> HostResult<Sample> {
    let Some(map) = item.read_lock::<Map>() else {
        return Err(refuse!("a coupon's test is a map of direction, velocity and curve, not {}", item.type_name()));
    };
    let test = Options { of: "a coupon's test", map: &map };
    let direction = test.value("direction")?.to_string().parse().map_err(refuse)?;
    let velocity = test.quantity("velocity", Velocity::DIMENSION)?;
    let curve = test.value("curve")?;
    let Some(curve) = curve.clone().try_cast::<Curve>() else {
        return Err(refuse!("expected a curve, found {}", curve.type_name()));
    };
    let is_virtual = test.boolean("is_virtual", false)?;
    let sample = Sample::new(direction, velocity, &curve, rules).map_err(refuse)?;
    Ok(Sample { is_virtual, ..sample })
}

fn recorded_map(recorded: &CouponTest) -> Map {
    let CouponTest { path, sample, specimen, .. } = recorded;
    let figures = json!({
        "file": path.display().to_string(), "specimen": specimen.as_ref().map(|specimen| &specimen.name),
        "direction": sample.direction.to_string(), "angle": sample.direction.degrees(), "velocity": sample.velocity,
        "modulus": sample.modulus.slope, "strength": sample.rupture.strength, "elongation": sample.rupture.strain,
        "is_virtual": sample.is_virtual,
    });
    record(&figures, [("curve", Dynamic::from(sample.curve.clone()))])
}

fn direction_map(along: &DirectionMeans) -> Map {
    let with_curve = |speed: &SpeedMeans| record(speed, [("curve", Dynamic::from(speed.curve.clone()))]).into();
    let others = [
        ("direction", along.direction.to_string().into()),
        ("angle", along.direction.degrees().into()),
        ("curve", Dynamic::from(along.curve.clone())),
        ("yield_points", shown(&along.yields.as_ref().ok())),
        ("no_yield_points", shown(&along.yields.as_ref().err().map(Error::to_string))),
        ("speeds", along.speeds.iter().map(with_curve).collect::<Array>().into()),
    ];
    record(along, others)
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
    curve.stress_at(strain).ok_or_else(|| refuse!("the curve has no stress at the strain {strain}"))
}

fn slice(curve: &mut Curve, from: Dynamic, to: Dynamic) -> HostResult<Curve> {
    let range = [number(&from, "the start")?, number(&to, "the end")?];
    curve.within(range).ok_or_else(|| refuse!("fewer than two samples between {} and {}", range[0], range[1]))
}

fn slope(curve: &Curve, window: [f64; 2]) -> HostResult<f64> {
    Ok(curve.modulus(window).map_err(refuse)?.slope)
}

fn toe_compensated(curve: &mut Curve, window: Dynamic) -> HostResult<Curve> {
    let line = curve.steepest(script::window(&window)?).map_err(refuse)?;
    Ok(curve.toe_compensated(line.slope, line.intercept))
}

fn rupture(curve: &Curve, share: f64) -> HostResult<Dynamic> {
    let Rupture { strain, stress, strength, ending } = curve.rupture(share).map_err(refuse)?;
    let broke = ending == CurveEnd::Broke;
    Ok(shown(&json!({ "strain": strain, "stress": stress, "strength": strength, "broke": broke })))
}

fn yields(curve: &Curve, window: [f64; 2]) -> HostResult<Dynamic> {
    yield_points(curve, window).map(|found| shown(&found)).map_err(refuse)
}

fn mean(curves: &Array, of: fn(&[Curve]) -> Result<Curve, Error>) -> HostResult<Curve> {
    let curve = |item: &Dynamic| {
        let found = item.clone().try_cast::<Curve>();
        found.ok_or_else(|| refuse!("expected a curve, found {}", item.type_name()))
    };
    of(&curves.iter().map(curve).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}

fn mean_of_groups(groups: &[Dynamic]) -> HostResult<f64> {
    let group = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(figures) => numbers(&figures, "a figure"),
        None => Err(refuse!("expected a list of figures, found {}", item.type_name())),
    };
    mean_of_means(&groups.iter().map(group).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}

#[cfg(test)]
mod tests {
    use crate::functions::tests::engine;
    use crate::script::{OutputCollector, Session};

    #[test]
    fn doubts_about_the_recordings_of_every_call_are_findings() {
        let folder = tempfile::tempdir().unwrap();
        let (engine, collector) = (engine(), OutputCollector::new(vec![]));
        Session::of_engine(&engine).report_to(&collector);
        let rows: String = (0..40).map(|row| format!("{},{}\n", 0.1 * f64::from(row), row.min(20))).collect();
        let mut script = "let c = coupon(#{ gauge: \"50 mm\", width: \"10 mm\", thickness: \"50 um\" });".to_owned();
        for name in ["md-0.02-1.csv", "td-0.02-1.csv"] {
            let path = folder.path().join(name);
            std::fs::write(&path, format!("displacement [mm],force [N]\n{rows}")).unwrap();
            script += &format!("read_coupons({path:?}, c); read_coupons({path:?}, c);");
        }
        engine.run(&script).unwrap();
        let found = collector.output().findings;
        let codes: Vec<&str> = found.iter().map(|finding| finding.code.as_str()).collect();
        assert_eq!(codes, ["saturated-load-cell"; 2]);
    }
}
