//! A curve of a fabric as parameters: the rises of its stress from point to point, which a curve needs not to fall.

use std::sync::Arc;

use rhai::{Array, Dynamic, Map};

use super::parameter::{CurvePoint, Parameter, Role, texts};
use crate::script::{HostResult, Options, number, refuse};
use lab::experiment::coupon::Curve;

/// Stresses of these parameters are in MPa.
const UNIT: &str = "MPa";
const PASCALS: f64 = 1e6;
/// Strains of the points where none are given, over that of the last one: closer where films yield.
const USUAL_SHARES: [f64; 8] = [0.05, 0.12, 0.2, 0.3, 0.42, 0.58, 0.78, 1.0];
/// Largest rise over the largest stress at the start.
const MOST_RISE: f64 = 3.0;
/// Least stress of a start over its largest: a search along a bound is slow.
const LEAST_RISE: f64 = 1e-3;

/// Options of a curve that is a parameter.
pub(super) const OPTIONS: [&str; 5] = ["curve", "start", "strains", "end", "tests"];

/// Whether a parameter of a script is a curve.
pub(super) fn is_curve(given: &Dynamic) -> bool {
    given.read_lock::<Map>().is_some_and(|map| map.contains_key("curve"))
}

/// Reads `#{ curve, start, strains, end, tests }`: a parameter a point.
pub(super) fn read(name: &str, given: &Dynamic) -> HostResult<Vec<Parameter>> {
    let of_parameter = |text: String| refuse(format!("parameter `{name}`: {text}"));
    let map = given.read_lock::<Map>().map(|map| map.clone()).unwrap_or_default();
    let options = Options { of: "a curve of calibrate", map: &map };
    options.check(&OPTIONS)?;
    let key = options.value("curve")?.clone().into_string();
    let key = key.map_err(|_| of_parameter("`curve` is the key of a curve of a fabric".into()))?;
    let start = options.value("start")?.read_lock::<Curve>().map(|curve| curve.clone());
    let start = start.ok_or_else(|| of_parameter("`start` is a curve, such as that of reduce_coupons".into()))?;
    let strains: Vec<f64> = match map.get("strains") {
        None => USUAL_SHARES.map(|share| share * start.range()[1]).into(),
        Some(given) => {
            let list = given.read_lock::<Array>().map(|list| list.clone());
            let list = list.ok_or_else(|| of_parameter("`strains` must be an array of strains".into()))?;
            list.iter().map(|item| number(item, "a strain")).collect::<HostResult<_>>()?
        }
    };
    let ascends = strains.windows(2).all(|pair| pair[0] < pair[1]) && strains.first().is_some_and(|first| *first > 0.0);
    let last = strains.last().copied().filter(|last| ascends && *last <= start.range()[1] * (1.0 + 1e-9));
    let last = last.ok_or_else(|| {
        of_parameter(format!("`strains` ascend from above zero to the end of `start`, {}", start.range()[1]))
    })?;
    let until = options.number("end", last)?;
    if until < last {
        return Err(of_parameter(format!("`end` is {until}, below the last strain {last}")));
    }
    let tests = map.get("tests").map(|given| texts(given, "tests").map_err(of_parameter)).transpose()?;
    let tests = tests.unwrap_or_default();
    let stress = |strain: f64| start.continued(strain.min(start.range()[1])).unwrap_or(0.0) / PASCALS;
    let most = strains.iter().map(|strain| stress(*strain)).fold(0.0, f64::max);
    if most <= 0.0 {
        return Err(of_parameter("`start` carries no stress".into()));
    }
    let strains: Arc<[f64]> = strains.into();
    let point = |place: usize| {
        let before = if place == 0 { 0.0 } else { stress(strains[place - 1]) };
        let rise = (stress(strains[place]) - before).max(LEAST_RISE * most);
        Parameter {
            name: format!("{name} rise {}", place + 1),
            keys: Vec::new(),
            unit: Some(UNIT.into()),
            start: rise,
            within: [0.0, MOST_RISE * most],
            is_logarithmic: false,
            prior: None,
            tests: tests.clone(),
            point: Some(CurvePoint { key: key.clone(), strains: strains.clone(), place, until }),
            role: Role::Key,
            scatter: None,
        }
    };
    Ok((0..strains.len()).map(point).collect())
}

/// The changes of a scenario with these values.
pub(super) fn changes<'a>(values: impl Iterator<Item = (&'a Parameter, f64)>) -> Map {
    let mut changes = Map::new();
    let mut curves: Vec<(&CurvePoint, Vec<f64>)> = Vec::new();
    for (parameter, value) in values {
        changes.extend(parameter.changes(value));
        let Some(point) = &parameter.point else { continue };
        let found = curves.iter().position(|(other, _)| other.key == point.key).unwrap_or_else(|| {
            curves.push((point, vec![0.0; point.strains.len()]));
            curves.len() - 1
        });
        curves[found].1[point.place] = value;
    }
    for (point, rises) in &curves {
        let mut stress = 0.0;
        let mut points = vec![[0.0, 0.0]];
        points.extend(point.strains.iter().zip(rises).map(|(strain, rise)| {
            stress += PASCALS * rise.max(0.0);
            [*strain, stress]
        }));
        let [from, to] = [points[points.len() - 2], points[points.len() - 1]];
        if point.until > to[0] * (1.0 + 1e-9) {
            let slope = (to[1] - from[1]) / (to[0] - from[0]);
            points.push([point.until, to[1] + slope * (point.until - to[0])]);
        }
        // A curve begins at the origin without being told.
        let listed = points[1..].iter().map(|point| Dynamic::from(point.map(Dynamic::from).to_vec()));
        let curve = Map::from([("curve".into(), Dynamic::from(listed.collect::<Array>()))]);
        changes.insert(point.key.as_str().into(), curve.into());
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::cause;

    fn given(more: &[(&str, Dynamic)]) -> Dynamic {
        let start = Curve::new(vec![0.0, 0.1, 0.4], vec![0.0, 4e6, 10e6]).unwrap();
        let mut map = Map::from([("curve".into(), "fabric.md".into()), ("start".into(), Dynamic::from(start))]);
        more.iter().for_each(|(name, value)| drop(map.insert((*name).into(), value.clone())));
        map.into()
    }

    fn list(values: &[f64]) -> Dynamic {
        Dynamic::from(values.iter().map(|value| Dynamic::from(*value)).collect::<Array>())
    }

    #[test]
    fn a_curve_is_its_rises_and_comes_back() {
        let parameters =
            read("md", &given(&[("strains", list(&[0.1, 0.2, 0.4])), ("end", Dynamic::from(0.5))])).unwrap();
        let starts: Vec<f64> = parameters.iter().map(|own| own.start).collect();
        assert!(starts.iter().zip([4.0, 2.0, 4.0]).all(|(own, expected)| (own - expected).abs() < 1e-9), "{starts:?}");
        assert_eq!(parameters[2].name, "md rise 3");
        let changes = changes(parameters.iter().map(|own| (own, own.start)));
        let written = changes["fabric.md"].to_string();
        // The last slope goes on to `end`.
        for part in ["[0.1, 4000000.0]", "[0.2, 6000000.0]", "[0.4, 10000000.0]", "[0.5, 12000000.0]"] {
            assert!(written.contains(part), "{part} in {written}");
        }
        assert_eq!(read("md", &given(&[])).unwrap().len(), USUAL_SHARES.len());
    }

    #[test]
    fn mistakes_name_the_parameter() {
        for (more, expected) in [
            (vec![("strains", list(&[0.2, 0.1]))], "parameter `md`: `strains` ascend"),
            (vec![("strains", list(&[0.2, 0.9]))], "to the end of `start`, 0.4"),
            (vec![("end", Dynamic::from(0.2))], "`end` is 0.2, below the last strain 0.4"),
            (vec![("start", Dynamic::from(1.0))], "`start` is a curve"),
            (vec![("within", Dynamic::from(1.0))], "has no option `within`"),
        ] {
            let error = cause(&read("md", &given(&more)).unwrap_err());
            assert!(error.contains(expected), "{error}");
        }
    }
}
