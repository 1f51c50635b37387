//! Tests that are pulled and not run: a coupon as one element from equilibrium to equilibrium, stress over strain.

use rhai::{Dynamic, Map};

use crate::scenario_functions::{ScenarioHandle, across_named};
use crate::script::{self, HostResult, refuse};
use lab::experiment::coupon::Curve;
use lab::signal::Series;
use scene::model::Loading;
use scene::simulate::Across;

/// Steps from no strain to the end of a recording: one within each bin of a comparison, whose straight pieces the bins average.
const STEPS: usize = 120;

/// The option `pull`: what holds the film across.
pub(super) fn across(given: &Dynamic, study: &ScenarioHandle) -> HostResult<Across> {
    // Coupons are pulled along one direction.
    let across = across_named(&given.to_string()).filter(|across| *across != Across::Equal);
    let across = across.ok_or_else(|| refuse!("`pull` is \"strip\", \"free\" or \"held\", not \"{given}\""))?;
    match study.model().loading {
        Loading::Stretch(_) => Ok(across),
        _ => Err(refuse("only a scenario with [loading.stretch] can be pulled")),
    }
}

/// The recording of a pulled test, stress (Pa) over strain: a curve, or `#{ stress: signal }`.
pub(super) fn recorded(given: &Dynamic) -> HostResult<Series> {
    if let Some(curve) = given.read_lock::<Curve>() {
        return Ok(Series::new(curve.strain().to_vec(), curve.stress().to_vec()));
    }
    let map = given.read_lock::<Map>();
    let series =
        map.and_then(|map| map.get("stress").and_then(|value| value.read_lock::<Series>().map(|own| own.clone())));
    let wrong = "a test that is pulled has curves as `recordings`, such as those of read_coupons and reduce_coupons";
    series.ok_or_else(|| refuse(wrong))
}

/// The strains that are compared: the option `window`, or all of the recording.
pub(super) fn window(given: Option<&Dynamic>) -> HostResult<[f64; 2]> {
    let Some(given) = given else { return Ok([f64::NEG_INFINITY, f64::INFINITY]) };
    let ends = script::window(given).ok().filter(|[from, to]| from < to);
    ends.ok_or_else(|| refuse("`window` of a test that is pulled is two strains, such as [0, 0.2]"))
}

/// Stress over strain of the film of a scenario, up to a strain.
pub(super) fn simulated(study: &ScenarioHandle, across: Across, end: f64) -> HostResult<Series> {
    if !(end > 0.0 && end.is_finite()) {
        return Err(refuse!("a pull ends at a strain above zero, not at {end}"));
    }
    let strains: Vec<f64> = (0..=STEPS).map(|step| end * step as f64 / STEPS as f64).collect();
    let stresses = study.pulled(&strains, across)?;
    Ok(Series::new(strains, stresses))
}

/// The signals of a pull as a recording would have them, to the strain at which the scenario ends.
pub(super) fn as_recorded(given: &Dynamic, study: &ScenarioHandle) -> HostResult<Map> {
    let across = across(given, study)?;
    let Loading::Stretch(stretch) = &study.model().loading else { return Err(refuse("nothing is pulled")) };
    let series = simulated(study, across, stretch.until)?;
    Ok(Map::from([("stress".into(), Dynamic::from(series))]))
}

/// Stress over strain as a curve; none where it has a gap.
pub(super) fn curve(series: &Series) -> Option<Curve> {
    Curve::new(series.time().to_vec(), series.values().to_vec()).ok()
}
