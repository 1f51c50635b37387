//! Fits of laws and of relaxation in scripts.

use std::collections::BTreeMap;
use std::path::Path;

use rhai::{Array, Dynamic, Engine, INT, Map, NativeCallContext};
use serde::Serialize;
use serde_json::json;

use crate::script::{HostResult, Options, Session, findings_map, list, numbers, record, refuse, refuse_hinted};
use base::finding::Finding;
use lab::experiment::law_fit::{
    BiaxialPoint, Coefficient, DataSet, FitOptions, LawFit, Measured, Quality, StressReader, TestFit, TestKind, fit_law,
};
use lab::experiment::relaxation::{PronyFit, fit_prony};

/// Offers `fit_law` and `fit_relaxation` to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_fn("fit_law", |tests: Array, law: &str| fitted(&tests, law, &Map::new()))
        .register_fn("fit_law", |tests: Array, law: &str, options: Map| fitted(&tests, law, &options))
        .register_fn("fit_relaxation", relaxation);
}

/// Offers `read_stresses` to scripts that may read files.
pub(super) fn register_reading(engine: &mut Engine) {
    engine
        .register_fn("read_stresses", |context: NativeCallContext, path: &str| {
            read(&Session::from_context(&context), path, None)
        })
        .register_fn("read_stresses", |context: NativeCallContext, path: &str, kind: &str| {
            let kind = kind.parse().map_err(refuse)?;
            read(&Session::from_context(&context), path, Some(kind))
        });
}

fn read(session: &Session, path: &str, kind: Option<TestKind>) -> HostResult<Map> {
    let path = Path::new(path);
    let reader = StressReader { kind, ..StressReader::default() };
    let set = reader.read(path).map_err(|error| refuse_hinted(&error, error.hint()))?;
    session.add_recording(path, set.is_virtual);
    Ok(set_map(&set))
}

/// A test as scripts have it.
fn set_map(set: &DataSet) -> Map {
    let (stretches, stresses) = (set.measured.stretches(), set.measured.stresses());
    let every = |values: &[f64], first: usize| list(&values.iter().skip(first).step_by(2).copied().collect::<Vec<_>>());
    let figures =
        json!({ "name": set.name, "test": set.kind().to_string(), "weight": set.weight, "is_virtual": set.is_virtual });
    match &set.measured {
        Measured::Tension(..) => {
            record(&figures, [("stretch", list(&stretches).into()), ("stress", list(&stresses).into())])
        }
        Measured::Biaxial(_) => {
            let [stretch_1, stretch_2] = [0, 1].map(|first| every(&stretches, first).into());
            let [stress_1, stress_2] = [0, 1].map(|first| every(&stresses, first).into());
            let columns =
                [("stretch_1", stretch_1), ("stretch_2", stretch_2), ("stress_1", stress_1), ("stress_2", stress_2)];
            record(&figures, columns)
        }
    }
}

/// A test of a map.
fn set(item: &Dynamic) -> HostResult<DataSet> {
    let Some(map) = item.read_lock::<Map>() else {
        let message = format!("a test is a map of test, stretch and stress, not {}", item.type_name());
        return Err(refuse(message));
    };
    let test = Options { of: "a test", map: &map };
    let kind: TestKind = test.value("test")?.to_string().parse().map_err(refuse)?;
    let column = |name: &str, what: &str| {
        let values = test.value(name)?.clone().into_array();
        numbers(&values.map_err(|found| refuse!("expected a list as {name}, found {found}"))?, what)
    };
    let common = ["name", "test", "weight", "is_virtual"];
    let (columns, measured) = match kind {
        TestKind::Tension(tension) => {
            let [stretches, stresses] = equal([column("stretch", "a stretch")?, column("stress", "a stress")?])?;
            let points = stretches.into_iter().zip(stresses).map(|(stretch, stress)| [stretch, stress]);
            (&["stretch", "stress"][..], Measured::Tension(tension, points.collect()))
        }
        TestKind::Biaxial => {
            let [l1, l2, p1, p2] = equal([
                column("stretch_1", "a stretch")?,
                column("stretch_2", "a stretch")?,
                column("stress_1", "a stress")?,
                column("stress_2", "a stress")?,
            ])?;
            let point = |i: usize| BiaxialPoint { stretches: [l1[i], l2[i]], stresses: [p1[i], p2[i]] };
            let points = (0..l1.len()).map(point).collect();
            (&["stretch_1", "stretch_2", "stress_1", "stress_2"][..], Measured::Biaxial(points))
        }
    };
    test.check(&[&common[..], columns].concat())?;
    let name = map.get("name").map_or_else(|| kind.to_string(), Dynamic::to_string);
    let set = DataSet::new(name, measured).map_err(refuse)?;
    let set = DataSet { is_virtual: test.boolean("is_virtual", false)?, ..set };
    set.with_weight(test.number("weight", 1.0)?).map_err(refuse)
}

fn equal<const N: usize>(columns: [Vec<f64>; N]) -> HostResult<[Vec<f64>; N]> {
    if columns.iter().any(|column| column.len() != columns[0].len()) {
        return Err(refuse("the lists of a test are of different lengths"));
    }
    Ok(columns)
}

fn fitted(tests: &[Dynamic], law: &str, options: &Map) -> HostResult<Map> {
    let given = Options::new("fit_law", options, &["residual", "stable_to", "predict"])?;
    let sets = tests.iter().map(set).collect::<HostResult<Vec<_>>>()?;
    let predicted = match options.get("predict") {
        Some(list) => {
            let list = list.clone().into_array();
            let list = list.map_err(|found| refuse!("expected a list of tests as predict, found {found}"))?;
            list.iter().map(set).collect::<HostResult<Vec<_>>>()?
        }
        None => vec![],
    };
    let weighting = options.get("residual").map(|word| word.to_string().parse()).transpose().map_err(refuse)?;
    let stable_to = given.optional_number("stable_to")?;
    let options = FitOptions { weighting: weighting.unwrap_or_default(), stable_to };
    let law = law.parse().map_err(refuse)?;
    let fit = fit_law(law, &sets, &predicted, &options).map_err(|error| refuse_hinted(&error, error.hint()))?;
    Ok(fit_map(&fit))
}

fn fit_map(fit: &LawFit) -> Map {
    fn by_name<T: Serialize>(fit: &LawFit, value: impl Fn(&Coefficient) -> T) -> BTreeMap<&str, T> {
        fit.coefficients.iter().map(|one| (one.name.as_str(), value(one))).collect()
    }
    let tests = |tests: &[TestFit]| tests.iter().map(|test| test_map(test).into()).collect::<Array>().into();
    let figures = json!({
        "law": fit.choice.to_string(), "coefficients": by_name(fit, |one| one.value),
        "standard_errors": by_name(fit, |one| one.standard_error), "intervals": by_name(fit, |one| one.interval),
        "unstable_from": fit.unstable_from.map(|(_, stretch)| stretch),
    });
    let mut map = record(&figures, [("tests", tests(&fit.tests)), ("predictions", tests(&fit.predictions))]);
    map.extend(findings_map(&fit.findings()));
    map
}

fn test_map(test: &TestFit) -> Map {
    let Quality { r_squared, rms, relative_rms, largest_error, .. } = test.quality;
    let mut map = set_map(&test.set);
    map.extend([
        ("predicted".into(), list(&test.predicted).into()),
        ("r_squared".into(), r_squared.into()),
        ("rms".into(), rms.into()),
        ("relative_rms".into(), relative_rms.into()),
        ("largest_error".into(), largest_error.into()),
    ]);
    map
}

fn relaxation(times: Array, moduli: Array, terms: INT) -> HostResult<Map> {
    let [times, moduli] = equal([numbers(&times, "a time")?, numbers(&moduli, "a modulus")?])?;
    let points: Vec<[f64; 2]> = times.into_iter().zip(moduli).map(|(time, modulus)| [time, modulus]).collect();
    let terms = usize::try_from(terms).map_err(|_| refuse!("expected a number of terms, found {terms}"))?;
    fit_prony(&points, terms).map(|fit| prony_map(&fit)).map_err(refuse)
}

fn prony_map(fit: &PronyFit) -> Map {
    let PronyFit { prony, r_squared, relative_rms, largest_error, warnings, .. } = fit;
    let figures = json!({
        "instantaneous": prony.instantaneous, "equilibrium": prony.equilibrium(), "terms": prony.terms,
        "r_squared": r_squared, "relative_rms": relative_rms, "largest_error": largest_error,
    });
    let mut map = record(&figures, []);
    map.extend(findings_map(&warnings.iter().map(Finding::new).collect::<Vec<_>>()));
    map
}
