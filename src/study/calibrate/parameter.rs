//! Parameters of a calibration and the unknowns that they are: one value for all tests, or one a test.

use std::sync::Arc;

use rhai::{Array, Dynamic, Map};
use serde_json::{Value, json};

use super::file;
use super::outcome::BREAK_FACTORS;
use crate::scenario_functions::Changes;
use crate::script::{HostResult, Options, number, numbers, refuse, refuse_within, texts, to_json, window};
use base::diagnostic::{Diagnostic, Source};
use lab::experiment::coupon::Curve;
use scene::scenario::parse_tree;
use uncertainty::distribution::{Distribution, Family};
use uncertainty::normal;

/// A parameter: the keys that have its value, and what is known of it before the tests.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Parameter {
    /// Its name in results.
    pub(super) name: String,
    /// Keys of scenarios that follow from its value.
    pub(super) keys: Vec<Key>,
    /// Unit of its values, where they have one.
    pub(super) unit: Option<String>,
    /// Where the search starts.
    pub(super) start: f64,
    /// Its bounds, where its prior has a density.
    pub(super) within: [f64; 2],
    /// Whether the transform of a search, uncertainty, and the prior without a distribution are along its logarithm.
    pub(super) is_logarithmic: bool,
    /// Distribution before the tests; uniform over the bounds, along the logarithm of a logarithmic one, where there is
    /// none.
    pub(super) prior: Option<Distribution>,
    /// Names of the tests that have its keys; all where there are none.
    pub(super) tests: Vec<String>,
    /// The point of a curve that it is, where it is one.
    pub(super) point: Option<CurvePoint>,
    pub(super) role: Role,
    /// Of a break strain, its relative standard deviation between specimens: ends between which it is estimated, or the same
    /// number twice.
    pub(super) scatter: Option<[f64; 2]>,
}

/// A key of scenarios, and what is written there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Key {
    /// Such as `layers.faces`.
    pub(super) name: String,
    /// Its value, in whose texts `{}` stands for that of the parameter, such as `["0 mm", "-{}"]`.
    form: Value,
}

/// What a parameter acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Role {
    /// Keys of scenarios.
    #[default]
    Key,
    /// The break strains of MD, TD or both, on which outcomes depend, and no signal of film that held.
    Break([bool; 2]),
    /// Their scatter between specimens.
    Scatter([bool; 2]),
}

/// A point of the curve of a fabric, whose rise from the point before is a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CurvePoint {
    /// The key of the curve, such as `specimen.material.fabric.md`.
    pub(super) key: String,
    /// Strains of all its points, or shear angles.
    pub(super) strains: Arc<[f64]>,
    /// Which of them this is.
    pub(super) place: usize,
    /// Where the curve ends, at its last slope.
    pub(super) until: f64,
}

/// One unknown: a parameter, of all tests or of one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unknown {
    /// `friction`, or `friction of 1008`.
    pub(super) name: String,
    /// Index of the parameter.
    pub(super) parameter: usize,
    /// Index of the test that it is of; none of a shared one.
    pub(super) test: Option<usize>,
}

/// Reads the parameter of this name, or those that the points of a curve are.
pub(super) fn read(name: &str, given: &Dynamic) -> HostResult<Vec<Parameter>> {
    let is_curve = given.read_lock::<Map>().is_some_and(|map| map.contains_key("curve"));
    let found = if is_curve { read_curve(name, given) } else { Parameter::read(name, given).map(|own| vec![own]) };
    found.map_err(|error| refuse_within(&format!("parameter `{name}`"), error))
}

impl Parameter {
    /// Reads `#{ key, start, within, log, prior, tests, scatter }`.
    fn read(name: &str, given: &Dynamic) -> HostResult<Parameter> {
        let map = given.read_lock::<Map>();
        let map = map.ok_or_else(|| refuse!("expected a map with `key`, `start` and `within`, found {given}"))?;
        let options = Options::new("a parameter of calibrate", &map, &file::parameter_options())?;
        let keys = keys(options.value("key")?)?;
        if keys.is_empty() {
            return Err(refuse("`key` names no key"));
        }
        let (start, unit) = quantity("start", options.value("start")?)?;
        let ends = options.value("within")?.read_lock::<Array>().map(|list| list.clone());
        let ends = ends.filter(|list| list.len() == 2);
        let ends = ends.ok_or_else(|| refuse("`within` must be an array of two values, such as [0.2, 10]"))?;
        let mut within = [0.0; 2];
        for (end, value) in within.iter_mut().zip(&ends) {
            *end = number_in(unit.as_deref(), "within", value)?;
        }
        if within[0] >= within[1] {
            return Err(refuse!("`within` is [{}, {}]: its first end must be the lower one", within[0], within[1]));
        }
        let prior = map.get("prior").map(|given| prior(given, unit.as_deref())).transpose()?;
        let mut of_prior = "";
        if let Some(prior) = &prior {
            // The quantile of an end that is given is rounded.
            let (low, high) = prior.ends();
            let [low, high] = [low.unwrap_or(prior.quantile(0.0)), high.unwrap_or(prior.quantile(1.0))];
            within = [within[0].max(low), within[1].min(high)];
            of_prior = ", where `prior` has a density";
        }
        let [low, high] = within;
        if !(low < high && (low..=high).contains(&start)) {
            return Err(refuse!("`start` {start} does not lie within [{low}, {high}]{of_prior}"));
        }
        let role = role(&keys)?;
        // Break strains scatter along their logarithm.
        let is_logarithmic = options.boolean("log", false)? || role != Role::Key;
        if is_logarithmic && low <= 0.0 {
            return Err(refuse!("`log` needs `within` above zero, which begins at {low}"));
        }
        let tests = options.texts("tests")?;
        let scatter = map.get("scatter").map(scatter).transpose()?;
        if scatter.is_some() && role == Role::Key {
            return Err(refuse!("`scatter` is of break strains: {}", BREAK_FACTORS.join(", ")));
        }
        let name = name.into();
        Ok(Parameter { name, keys, unit, start, within, is_logarithmic, prior, tests, point: None, role, scatter })
    }

    /// The parameter that the scatter of a break strain is where it is estimated: anywhere between its ends, along the
    /// logarithm.
    pub(super) fn of_scatter(&self) -> Option<Parameter> {
        let (Role::Break(along), Some([low, high])) = (self.role, self.scatter) else { return None };
        (low < high).then(|| Parameter {
            name: format!("scatter of {}", self.name),
            start: (low * high).sqrt(),
            within: [low, high],
            is_logarithmic: true,
            tests: self.tests.clone(),
            role: Role::Scatter(along),
            ..Parameter::default()
        })
    }

    /// Whether its value is written to this key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.keys.iter().any(|own| own.name == key)
    }

    /// Whether both write one key, as curves or as values, and not the points of one curve, or are scatters along one direction.
    pub(super) fn shares_a_key(&self, other: &Parameter) -> bool {
        if let (Role::Scatter(one), Role::Scatter(two)) = (self.role, other.role) {
            return (0..2).any(|along| one[along] && two[along]);
        }
        if let (Some(one), Some(two)) = (&self.point, &other.point) {
            return one.key == two.key && !Arc::ptr_eq(&one.strains, &two.strains);
        }
        let of = |parameter: &Parameter| -> Vec<String> {
            let curve = parameter.point.iter().map(|point| point.key.clone());
            parameter.keys.iter().map(|key| key.name.clone()).chain(curve).collect()
        };
        let theirs = of(other);
        of(self).iter().any(|key| theirs.contains(key))
    }

    /// The changes of a scenario with this value.
    pub(super) fn changes(&self, value: f64) -> impl Iterator<Item = (String, Value)> {
        let written = match &self.unit {
            Some(unit) => Value::from(format!("{value} {unit}")),
            None if value.is_finite() => Value::from(value),
            // JSON has no such number, and null would leave the key out: a scenario refuses the text.
            None => Value::from(value.to_string()),
        };
        self.keys.iter().map(move |key| (key.name.clone(), filled(&key.form, &written)))
    }

    /// The coordinate of a value, along which its uncertainty is: the value or its logarithm.
    pub(super) fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.ln() } else { value }
    }

    /// The value at a coordinate.
    pub(super) fn value(&self, coordinate: f64) -> f64 {
        if self.is_logarithmic { coordinate.exp() } else { coordinate }
    }

    /// Derivative of the value by the coordinate, at a value.
    pub(super) fn slope(&self, value: f64) -> f64 {
        if self.is_logarithmic { value } else { 1.0 }
    }

    /// Its bounds as coordinates.
    pub(super) fn ends(&self) -> [f64; 2] {
        self.within.map(|end| self.coordinate(end))
    }

    /// Standard deviation of the coordinate before the tests, of the whole prior.
    pub(super) fn prior_deviation(&self) -> f64 {
        let [low, high] = self.ends();
        let uniform = (high - low) / 12_f64.sqrt();
        let own = self.prior.as_ref().map(|prior| match self.is_logarithmic {
            // Of the logarithm, from the quantiles of one deviation.
            true => 0.5 * (prior.quantile(normal::cumulative(1.0)) / prior.quantile(normal::cumulative(-1.0))).ln(),
            false => prior.deviation(),
        });
        own.filter(|own| own.is_finite() && *own > 0.0).map_or(uniform, |own| own.min(uniform))
    }

    /// The residual of a prior at a value: the standard normal value of the same probability. A uniform one has none, nor has
    /// what truncates one: they are bounds.
    pub(super) fn prior_residual(&self, value: f64) -> Option<f64> {
        let prior = self.prior.as_ref().filter(|prior| !matches!(prior.family(), Family::Uniform { .. }))?;
        Some(prior.normal_score(value))
    }

    /// Whether its prior has a residual.
    pub(super) fn is_scored(&self) -> bool {
        self.prior_residual(self.start).is_some()
    }

    /// Logarithm of the density of the coordinate before the tests, up to a constant; −∞ outside the bounds.
    pub(super) fn log_prior(&self, coordinate: f64) -> f64 {
        let [low, high] = self.ends();
        if !(low..=high).contains(&coordinate) {
            return f64::NEG_INFINITY;
        }
        match &self.prior {
            None => 0.0,
            // dx/du = x of a logarithm.
            Some(prior) if self.is_logarithmic => prior.density(self.value(coordinate)).ln() + coordinate,
            Some(prior) => prior.density(coordinate).ln(),
        }
    }
}

/// What stands for the value of a parameter in what its keys are set to.
const PLACE: &str = "{}";

/// The option `key`: a key, a list of keys that have the value, or a map of keys and what is written there.
fn keys(given: &Dynamic) -> HostResult<Vec<Key>> {
    let Some(map) = given.read_lock::<Map>() else {
        let own = texts(given, "key")?.into_iter();
        return Ok(own.map(|name| Key { name, form: Value::from(PLACE) }).collect());
    };
    let key = |(name, form): (&rhai::Identifier, &Dynamic)| {
        let form = to_json(form).map_err(|error| refuse!("`{name}` of `key`: {error}"))?;
        if !form.to_string().contains(PLACE) {
            return Err(refuse!("`{name}` of `key` has no `{PLACE}`, which stands for the value of the parameter"));
        }
        Ok(Key { name: name.to_string(), form })
    };
    map.iter().map(key).collect()
}

/// A form with a value in its place: a text that is nothing else becomes the value itself.
fn filled(form: &Value, written: &Value) -> Value {
    match form {
        Value::String(text) if text == PLACE => written.clone(),
        Value::String(text) => {
            let shown = written.as_str().map_or_else(|| written.to_string(), str::to_owned);
            text.replace(PLACE, &shown).into()
        }
        Value::Array(list) => list.iter().map(|item| filled(item, written)).collect(),
        Value::Object(map) => map.iter().map(|(name, item)| (name.clone(), filled(item, written))).collect(),
        other => other.clone(),
    }
}

/// What a parameter with these keys acts on.
fn role(keys: &[Key]) -> HostResult<Role> {
    let along = BREAK_FACTORS.map(|key| keys.iter().any(|own| own.name == key && own.form == PLACE));
    match (along.contains(&true), keys.iter().all(|key| BREAK_FACTORS.contains(&key.name.as_str()))) {
        (false, _) => Ok(Role::Key),
        (true, true) => Ok(Role::Break(along)),
        (true, false) => Err(refuse("break strains cannot be tied to other keys")),
    }
}

/// The option `scatter`: a number, or the ends between which it is estimated.
fn scatter(given: &Dynamic) -> HostResult<[f64; 2]> {
    let ends = if given.is_array() { window(given) } else { number(given, "scatter").map(|own| [own; 2]) };
    let ends = ends.ok().filter(|[low, high]| 0.0 < *low && low <= high && *high <= 2.0);
    ends.ok_or_else(|| {
        refuse!("`scatter` is a relative deviation such as 0.1, or [0.02, 0.5] where it is estimated, not {given}")
    })
}

/// A number, or a text of a number and its unit, which messages name `what`.
fn quantity(what: &str, given: &Dynamic) -> HostResult<(f64, Option<String>)> {
    let (found, unit) = match given.clone().into_string() {
        Ok(text) => {
            let parts = text.trim().split_once(' ');
            let (number, unit) = parts.ok_or_else(|| refuse!("`{what}`: `{text}` has no unit after a space"))?;
            let number = number.parse::<f64>().map_err(|_| refuse!("`{what}`: `{text}` begins with no number"))?;
            (number, Some(unit.trim().to_owned()))
        }
        Err(_) => (number(given, what)?, None),
    };
    if found.is_finite() { Ok((found, unit)) } else { Err(refuse!("`{what}`: {found} is not finite")) }
}

/// A number in the unit of `start`.
fn number_in(unit: Option<&str>, what: &str, given: &Dynamic) -> HostResult<f64> {
    let (found, own) = quantity(what, given)?;
    if own.as_deref() == unit {
        return Ok(found);
    }
    let [own, unit] = [own.as_deref(), unit].map(|unit| unit.unwrap_or("none"));
    Err(refuse!("`{what}` has the unit {own} and `start` {unit}: give them one unit"))
}

/// A distribution as `[variation]` writes it, of numbers in the unit of `start` and of texts that have it.
fn prior(given: &Dynamic, unit: Option<&str>) -> HostResult<Distribution> {
    let wrong = |error: &str| refuse!("`prior`: {error}");
    let written =
        toml::Value::try_from(without_unit(to_json(given)?, unit)?).map_err(|error| wrong(&error.to_string()))?;
    let tree = parse_tree(&Source::unfiled("prior", format!("prior = {written}")));
    let in_line = |mistakes: Vec<Diagnostic>| mistakes.iter().map(Diagnostic::in_line).collect::<Vec<_>>().join("; ");
    let tree = tree.map_err(|mistakes| wrong(&in_line(mistakes)))?;
    let node = tree.find("prior").ok_or_else(|| wrong("it is empty"))?;
    scene::model::distribution(node).map_err(|error| wrong(&error))
}

/// A value whose texts are numbers in the unit of `start`.
fn without_unit(value: Value, unit: Option<&str>) -> HostResult<Value> {
    Ok(match value {
        Value::String(text) => number_in(unit, "prior", &text.into())?.into(),
        Value::Array(list) => list.into_iter().map(|item| without_unit(item, unit)).collect::<HostResult<_>>()?,
        Value::Object(map) => {
            let number = |(name, item)| Ok((name, without_unit(item, unit)?));
            Value::Object(map.into_iter().map(number).collect::<HostResult<_>>()?)
        }
        other => other,
    })
}

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
pub(super) const CURVE_OPTIONS: [&str; 5] = ["curve", "start", "strains", "end", "tests"];

/// Reads `#{ curve, start, strains, end, tests }`: a parameter a point.
fn read_curve(name: &str, given: &Dynamic) -> HostResult<Vec<Parameter>> {
    let map = given.read_lock::<Map>().map(|map| map.clone()).unwrap_or_default();
    let options = Options::new("a curve of calibrate", &map, &CURVE_OPTIONS)?;
    let key = options.value("curve")?.clone().into_string();
    let key = key.map_err(|_| refuse("`curve` is the key of a curve of a fabric"))?;
    let start = options.value("start")?.read_lock::<Curve>().map(|curve| curve.clone());
    let start = start.ok_or_else(|| refuse("`start` is a curve, such as that of reduce_coupons"))?;
    let strains: Vec<f64> = match map.get("strains") {
        None => USUAL_SHARES.map(|share| share * start.range()[1]).into(),
        Some(given) => {
            let list = given.read_lock::<Array>();
            numbers(&list.ok_or_else(|| refuse("`strains` must be an array of strains"))?, "a strain")?
        }
    };
    let ascends = strains.windows(2).all(|pair| pair[0] < pair[1]) && strains.first().is_some_and(|first| *first > 0.0);
    let last = strains.last().copied().filter(|last| ascends && *last <= start.range()[1] * (1.0 + 1e-9));
    let last =
        last.ok_or_else(|| refuse!("`strains` ascend from above zero to the end of `start`, {}", start.range()[1]))?;
    let until = options.number("end", last)?;
    if until < last {
        return Err(refuse!("`end` is {until}, below the last strain {last}"));
    }
    let tests = options.texts("tests")?;
    let stress = |strain: f64| start.continued(strain.min(start.range()[1])).unwrap_or(0.0) / PASCALS;
    let most = strains.iter().map(|strain| stress(*strain)).fold(0.0, f64::max);
    if most <= 0.0 {
        return Err(refuse("`start` carries no stress"));
    }
    let strains: Arc<[f64]> = strains.into();
    let point = |place: usize| {
        let before = if place == 0 { 0.0 } else { stress(strains[place - 1]) };
        let rise = (stress(strains[place]) - before).max(LEAST_RISE * most);
        Parameter {
            name: format!("{name} rise {}", place + 1),
            unit: Some(UNIT.into()),
            start: rise,
            within: [0.0, MOST_RISE * most],
            tests: tests.clone(),
            point: Some(CurvePoint { key: key.clone(), strains: strains.clone(), place, until }),
            ..Parameter::default()
        }
    };
    Ok((0..strains.len()).map(point).collect())
}

/// The changes of a scenario with these values.
pub(super) fn changes<'a>(values: impl Iterator<Item = (&'a Parameter, f64)>) -> Changes {
    let mut changes = Changes::new();
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
        changes.insert(point.key.clone(), json!({ "curve": points[1..] }));
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::cause;

    fn read(text: &str) -> HostResult<Parameter> {
        super::read("p", &rhai::Engine::new_raw().eval::<Dynamic>(text).unwrap()).map(|mut found| found.remove(0))
    }

    /// What a parameter writes.
    fn changes(parameter: &Parameter, value: f64) -> Vec<String> {
        parameter.changes(value).map(|(key, value)| format!("{key} = {value}")).collect()
    }

    #[test]
    fn keys_may_say_what_is_written_there() {
        let found = read(
            r#"#{ key: #{ "specimen.shape.rectangle": ["{}", "{}"], "layers.faces": ["0 mm", "-{}"] },
            start: "400 mm", within: ["300 mm", "500 mm"] }"#,
        )
        .unwrap();
        let expected =
            [r#"layers.faces = ["0 mm","-410.5 mm"]"#, r#"specimen.shape.rectangle = ["410.5 mm","410.5 mm"]"#];
        assert_eq!(changes(&found, 410.5), expected);
        let found =
            read(r##"#{ key: #{ "layers.prestrain": #{ md: "{}", td: 0 } }, start: 1, within: [0, 2] }"##).unwrap();
        assert_eq!(changes(&found, 0.5), [r#"layers.prestrain = {"md":0.5,"td":0}"#]);
    }

    #[test]
    fn a_parameter_has_keys_bounds_and_a_unit() {
        let found =
            read(r#"#{ key: "specimen.material.thickness", start: "12 um", within: ["10 um", "15 um"] }"#).unwrap();
        assert_eq!((found.start, found.within, found.unit.as_deref()), (12.0, [10.0, 15.0], Some("um")));
        assert_eq!(changes(&found, 12.5), [r#"specimen.material.thickness = "12.5 um""#]);
        let found = read(r#"#{ key: ["a", "b"], start: 1, within: [0.1, 10], log: true }"#).unwrap();
        assert_eq!(changes(&found, 2.0), ["a = 2.0", "b = 2.0"]);
        assert!((found.value(found.coordinate(3.0)) - 3.0).abs() < 1e-12);
        assert!((found.prior_deviation() - 100_f64.ln() / 12_f64.sqrt()).abs() < 1e-12);
    }

    /// The logarithm of a log-normal quantity is normal: density, residual and deviation along it are those of that.
    #[test]
    fn a_prior_is_along_the_coordinate_of_the_search() {
        let found = read(
            r#"#{ key: "a", start: 1, within: [0.01, 100], log: true, prior: #{ lognormal: #{ mean: 2, deviation: 0.5 } } }"#,
        );
        let found = found.unwrap();
        let spread = (1.0 + 0.0625_f64).ln().sqrt();
        let centre = 2_f64.ln() - 0.5 * spread * spread;
        assert!((found.prior_deviation() - spread).abs() < 1e-9);
        let at = |deviations: f64| found.coordinate((centre + deviations * spread).exp());
        assert!((found.prior_residual(found.value(at(1.5))).unwrap() - 1.5).abs() < 1e-9);
        let difference = found.log_prior(at(0.0)) - found.log_prior(at(1.0));
        assert!((difference - 0.5).abs() < 1e-9, "{difference}");
        assert_eq!(found.log_prior(20.0), f64::NEG_INFINITY);
    }

    /// A uniform prior, and what truncates another, are bounds; far from a normal one its residual still has a slope.
    #[test]
    fn a_prior_is_bounds_where_it_ends_and_a_residual_where_it_falls() {
        let of =
            |prior: &str| read(&format!("#{{ key: \"a\", start: 1.6, within: [0.5, 2], prior: {prior} }}")).unwrap();
        let uniform = of("#{ uniform: [1.5, 1.8] }");
        assert_eq!((uniform.within, uniform.prior_residual(1.5), uniform.is_scored()), ([1.5, 1.8], None, false));
        let normal = of("#{ normal: #{ mean: 1.6, deviation: 0.02 }, truncate: #{ low: 1.2 } }");
        assert_eq!(normal.within, [1.2, 2.0]);
        assert!((normal.prior_residual(1.0).unwrap() + 30.0).abs() < 1e-9, "{normal:?}");
        // A start on an end of which the quantile is rounded inwards.
        let own = read(
            r#"#{ key: "a", start: 0.3, within: [0.1, 3],
            prior: #{ normal: #{ mean: 1, deviation: 0.2 }, truncate: #{ low: 0.3 } } }"#,
        );
        assert_eq!(own.unwrap().within, [0.3, 3.0]);
    }

    /// Truncated, and in the unit of the start.
    #[test]
    fn a_prior_is_written_as_what_varies() {
        let found = read(
            r#"#{ key: "a", start: "12 um", within: ["8 um", "15 um"],
            prior: #{ normal: #{ mean: "12 um", deviation: 1 }, truncate: #{ low: 10, high: "14 um" } } }"#,
        );
        let expected = Distribution::normal(12.0, 1.0).and_then(|whole| whole.truncated(Some(10.0), Some(14.0)));
        assert_eq!(found.unwrap().prior, Some(expected.unwrap()));
    }

    #[test]
    fn mistakes_name_the_parameter() {
        for (text, expected) in [
            (r#"#{ key: "a", start: 5, within: [1, 2] }"#, "parameter `p`: `start` 5 does not lie within [1, 2]"),
            (r#"#{ key: "a", start: 1, within: [0, 2], log: true }"#, "`log` needs `within` above zero"),
            (r#"#{ key: "a", start: "1 mm", within: [0, 2] }"#, "`within` has the unit none and `start` mm"),
            (r##"#{ key: #{ "a": "1 mm" }, start: 1, within: [0, 2] }"##, "`a` of `key` has no `{}`"),
            (r#"#{ key: 3, start: 1, within: [0, 2] }"#, "`key` must be a string or an array of strings, not 3"),
            (r#"#{ key: "a", start: 1, within: 2 }"#, "`within` must be an array of two values"),
            (r#"#{ key: "a", start: "1 mm", within: ["0 mm", "inf mm"] }"#, "inf is not finite"),
            (r#"#{ key: "a", start: 1, within: [0, 2], prior: #{ gauss: 1 } }"#, "`prior`: unknown key `gauss`"),
            (
                r#"#{ key: "a", start: 1, within: [0, 2], prior: #{ uniform: [0, 2], trunkate: #{ low: 1 } } }"#,
                "did you mean `truncate`?",
            ),
            (
                r#"#{ key: "a", start: 1, within: [0, 2], prior: #{ log_normal: #{ mean: 1, deviation: 1 } } }"#,
                "did you mean `lognormal`?",
            ),
            (
                r#"#{ key: "a", start: 1, within: [0, 2], prior: #{ normal: #{ mean: "1 mm", deviation: 1 } } }"#,
                "`prior` has the unit mm and `start` none",
            ),
            (r#"#{ key: "a", start: 1, within: ["x", 2] }"#, "parameter `p`: `within`: `x` has no unit after a space"),
            (
                r#"#{ key: "a", start: 1, within: [0, 2], prior: #{ normal: #{ mean: 1, deviation: "x" } } }"#,
                "parameter `p`: `prior`: `x` has no unit after a space",
            ),
            (
                r#"#{ key: "a", start: 1, within: [0, 2], prior: #{} }"#,
                "`prior`: one of `uniform`, `normal`, `lognormal`, `weibull` is missing",
            ),
            (
                r#"#{ key: "a", start: 1, within: [0.5, 2], prior: #{ uniform: [1.5, 1.8] } }"#,
                "`start` 1 does not lie within [1.5, 1.8], where `prior` has a density",
            ),
            (r#"#{ key: "a", begin: 1 }"#, "has no option `begin`"),
            ("7", "expected a map with `key`"),
            (r#"#{ key: "a", start: 1, within: [0, 2], scatter: 0.1 }"#, "`scatter` is of break strains"),
            (
                r#"#{ key: ["a", "specimen.material.fabric.md.break_factor"], start: 1, within: [0.1, 2] }"#,
                "break strains cannot be tied to other keys",
            ),
            (
                r#"#{ key: "specimen.material.fabric.md.break_factor", start: 1, within: [0.1, 2], scatter: [0.5, 0.1] }"#,
                "`scatter` is a relative deviation such as 0.1",
            ),
        ] {
            let found = cause(&read(text).unwrap_err());
            assert!(found.contains(expected), "{text}: {found}");
        }
    }

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
            read_curve("md", &given(&[("strains", list(&[0.1, 0.2, 0.4])), ("end", Dynamic::from(0.5))])).unwrap();
        let starts: Vec<f64> = parameters.iter().map(|own| own.start).collect();
        assert!(starts.iter().zip([4.0, 2.0, 4.0]).all(|(own, expected)| (own - expected).abs() < 1e-9), "{starts:?}");
        assert_eq!(parameters[2].name, "md rise 3");
        let changes = super::changes(parameters.iter().map(|own| (own, own.start)));
        let written = changes["fabric.md"].to_string();
        // The last slope goes on to `end`.
        for part in ["[0.1,4000000.0]", "[0.2,6000000.0]", "[0.4,10000000.0]", "[0.5,12000000.0]"] {
            assert!(written.contains(part), "{part} in {written}");
        }
        assert_eq!(read_curve("md", &given(&[])).unwrap().len(), USUAL_SHARES.len());
    }

    #[test]
    fn mistakes_name_the_curve() {
        for (more, expected) in [
            (vec![("strains", list(&[0.2, 0.1]))], "parameter `md`: `strains` ascend"),
            (vec![("strains", list(&[0.2, 0.9]))], "to the end of `start`, 0.4"),
            (vec![("end", Dynamic::from(0.2))], "`end` is 0.2, below the last strain 0.4"),
            (vec![("start", Dynamic::from(1.0))], "`start` is a curve"),
            (vec![("within", Dynamic::from(1.0))], "has no option `within`"),
        ] {
            let error = cause(&super::read("md", &given(&more)).unwrap_err());
            assert!(error.contains(expected), "{error}");
        }
    }
}
