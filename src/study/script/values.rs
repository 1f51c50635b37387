//! Values of scripts: their conversion, options of functions, arguments, and the order of lists.

use std::cmp::Ordering;
use std::ops::RangeInclusive;

use rhai::{Array, Dynamic, Engine, EvalAltResult, ImmutableString, Map};
use serde::Serialize;
use serde_json::{Number, Value};

use super::{HostResult, Row, at_key, refuse, refuse_key};
use base::diagnostic::did_you_mean;
use base::finding::Finding;
use base::removed;
use base::units::Dimension;

/// Deepest nesting of lists and maps that is converted.
const DEEPEST: usize = 8;

/// The number in `value`, an integer or a float; `what` names it in the error.
///
/// # Errors
/// It is neither an integer nor a float.
pub fn number(value: &Dynamic, what: &str) -> HostResult<f64> {
    if let Ok(float) = value.as_float() {
        return Ok(float);
    }
    let integer = value.as_int();
    integer.map(|i| i as f64).map_err(|found| refuse!("expected a number for {what}, found {found}"))
}

/// The list as numbers; `what` names one of them in the error.
///
/// # Errors
/// One of them is no number.
pub fn numbers(items: &[Dynamic], what: &str) -> HostResult<Vec<f64>> {
    items.iter().map(|item| number(item, what)).collect()
}

/// The items of a list, or the value itself.
pub fn one_or_several(value: &Dynamic) -> Array {
    value.read_lock::<Array>().map_or_else(|| vec![value.clone()], |list| list.clone())
}

/// A text, or a list of texts, which messages name `what`.
///
/// # Errors
/// It is neither.
pub fn texts(value: &Dynamic, what: &str) -> HostResult<Vec<String>> {
    let wrong = |item: &Dynamic| refuse!("`{what}` must be a string or an array of strings, not {item}");
    one_or_several(value).iter().map(|item| item.clone().into_string().map_err(|_| wrong(item))).collect()
}

/// The value of a word, which messages name `what`, among those that are `known`.
///
/// # Errors
/// It is none of them.
pub fn word<T: Copy>(what: &str, text: &str, known: &[(&'static str, T)]) -> HostResult<T> {
    let found = known.iter().find(|(name, _)| *name == text).map(|(_, value)| *value);
    found.ok_or_else(|| unknown(what, text, known.iter().map(|(name, _)| *name)))
}

/// The error for a word that is not among `known`, with the closest one as a hint.
pub fn unknown<'k>(what: &str, text: &str, known: impl IntoIterator<Item = &'k str> + Clone) -> Box<EvalAltResult> {
    let all = |known: Vec<&str>| format!("there are {}", known.join(", "));
    let hint = did_you_mean(text, known.clone()).unwrap_or_else(|| all(known.into_iter().collect()));
    refuse!("unknown {what} `{text}` ({hint})")
}

/// The numbers as a list.
pub fn list(values: &[f64]) -> Array {
    values.iter().copied().map(Dynamic::from).collect()
}

/// A window of time `[from, to]` in s.
///
/// # Errors
/// It is not a list of two numbers.
pub fn window(value: &Dynamic) -> HostResult<[f64; 2]> {
    let bounds = value.read_lock::<Array>();
    let bounds = bounds.as_deref().map(Vec::as_slice);
    let Some([from, to]) = bounds else {
        return Err(refuse!("expected a window [from, to], found {}", value.type_name()));
    };
    Ok([number(from, "the window's start")?, number(to, "the window's end")?])
}

/// The value as JSON; numbers that are not finite become null.
///
/// # Errors
/// It is a value of the host, such as a signal, or nested too deeply.
pub fn to_json(value: &Dynamic) -> HostResult<Value> {
    nested_to_json(value, DEEPEST)
}

fn nested_to_json(value: &Dynamic, depth: usize) -> HostResult<Value> {
    let Some(depth) = depth.checked_sub(1) else {
        return Err(refuse!("values are nested more than {DEEPEST} deep"));
    };
    if let Some(items) = value.read_lock::<Array>() {
        let items = items.iter().map(|item| nested_to_json(item, depth));
        return items.collect::<Result<Vec<_>, _>>().map(Value::Array);
    }
    if let Some(map) = value.read_lock::<Map>() {
        let pairs = map.iter().map(|(key, item)| Ok((key.to_string(), nested_to_json(item, depth)?)));
        return pairs.collect::<Result<_, _>>().map(Value::Object);
    }
    plain_to_json(value)
}

fn plain_to_json(value: &Dynamic) -> HostResult<Value> {
    if value.is_unit() {
        return Ok(Value::Null);
    }
    if let Ok(flag) = value.as_bool() {
        return Ok(Value::Bool(flag));
    }
    if let Ok(integer) = value.as_int() {
        return Ok(Value::from(integer));
    }
    if let Ok(float) = value.as_float() {
        return Ok(Number::from_f64(float).map_or(Value::Null, Value::Number));
    }
    if value.is_string() || value.is_char() {
        return Ok(Value::String(value.to_string()));
    }
    Err(refuse!("a {} is not a figure: reduce it to a number, such as its max()", value.type_name()))
}

/// `findings`, a list of maps with code, severity, message and figures, and `warnings`, the messages of the warnings
/// among them.
pub fn findings_map(findings: &[Finding]) -> Map {
    let warnings = findings.iter().filter(|found| found.is_warning()).map(|found| found.message.clone().into());
    let all = findings.iter().map(shown);
    Map::from([
        ("warnings".into(), warnings.collect::<Array>().into()),
        ("findings".into(), all.collect::<Array>().into()),
    ])
}

/// The script value of JSON; null becomes `()`.
pub fn from_json(value: &Value) -> Dynamic {
    match value {
        Value::Null => Dynamic::UNIT,
        Value::Bool(flag) => (*flag).into(),
        Value::Number(number) => match number.as_i64() {
            Some(integer) => integer.into(),
            None => number.as_f64().unwrap_or(f64::NAN).into(),
        },
        Value::String(text) => text.clone().into(),
        Value::Array(items) => items.iter().map(from_json).collect::<Array>().into(),
        Value::Object(pairs) => {
            let pairs = pairs.iter().map(|(key, item)| (key.as_str().into(), from_json(item)));
            pairs.collect::<Map>().into()
        }
    }
}

/// The fields of a result as they are written.
pub fn object(result: impl Serialize) -> Row {
    match serde_json::to_value(result) {
        Ok(Value::Object(fields)) => fields,
        _ => Row::new(),
    }
}

/// A result as a value of scripts.
pub fn shown(result: &impl Serialize) -> Dynamic {
    serde_json::to_value(result).map_or(Dynamic::UNIT, |json| from_json(&json))
}

/// A result as a map of scripts, with values of the host beside its figures.
pub fn record<const N: usize>(result: &impl Serialize, host: [(&str, Dynamic); N]) -> Map {
    let mut map = shown(result).try_cast::<Map>().unwrap_or_default();
    map.extend(host.into_iter().map(|(name, value)| (name.into(), value)));
    map
}

/// The options of a host function: a map from a script.
pub struct Options<'a> {
    /// The function, as its messages name it.
    pub of: &'static str,
    /// The options by name.
    pub map: &'a Map,
}

impl<'a> Options<'a> {
    /// The options of the function `of`, which takes the `known` ones.
    ///
    /// # Errors
    /// It takes none of the name of one of them, which is refused at its place.
    pub fn new(of: &'static str, map: &'a Map, known: &[&str]) -> HostResult<Options<'a>> {
        let options = Options { of, map };
        options.check(known).map(|()| options)
    }

    /// Refuses names other than the `known` ones, at their place.
    pub fn check(&self, known: &[&str]) -> HostResult<()> {
        let Some(key) = self.map.keys().find(|key| !known.contains(&key.as_str())) else { return Ok(()) };
        let message = format!("{} has no option `{key}`; it takes {}", self.of, known.join(", "));
        let meant = || did_you_mean(key, known.iter().copied());
        Err(refuse_key(key, &message, removed::function(&format!("{}.{key}", self.of)).or_else(meant)))
    }

    /// The option `name`.
    ///
    /// # Errors
    /// It is missing.
    pub fn value(&self, name: &str) -> HostResult<&Dynamic> {
        self.map.get(name).ok_or_else(|| refuse!("{} needs `{name}`", self.of))
    }

    /// The number `name`.
    ///
    /// # Errors
    /// It is missing or not a number.
    pub fn needed_number(&self, name: &str) -> HostResult<f64> {
        number(self.value(name)?, name)
    }

    /// The number `name`, or else `otherwise`.
    pub fn number(&self, name: &str, otherwise: f64) -> HostResult<f64> {
        self.map.get(name).map_or(Ok(otherwise), |value| number(value, name))
    }

    /// The number `name`, where it is given.
    ///
    /// # Errors
    /// It is not a number.
    pub fn optional_number(&self, name: &str) -> HostResult<Option<f64>> {
        self.map.get(name).map(|value| number(value, name)).transpose()
    }

    /// The whole number `name` within a range, or else `otherwise`.
    ///
    /// # Errors
    /// It is no whole number or lies outside of the range.
    pub fn whole(&self, name: &str, otherwise: usize, range: RangeInclusive<usize>) -> HostResult<usize> {
        let Some(value) = self.map.get(name) else { return Ok(otherwise) };
        let found = value.as_int().ok().and_then(|found| usize::try_from(found).ok());
        found.filter(|found| range.contains(found)).ok_or_else(|| {
            let [low, high] = [range.start(), range.end()];
            refuse_key(name, &format!("`{name}` must be a whole number from {low} to {high}, not {value}"), None)
        })
    }

    /// The texts `name`, one or several; none where it is not given.
    ///
    /// # Errors
    /// It is neither a text nor a list of texts.
    pub fn texts(&self, name: &str) -> HostResult<Vec<String>> {
        self.map.get(name).map_or_else(|| Ok(Vec::new()), |value| texts(value, name))
    }

    /// The value of the word `name` among those that are `known`, where it is given.
    ///
    /// # Errors
    /// It is none of them.
    pub fn word<T: Copy>(&self, name: &str, known: &[(&'static str, T)]) -> HostResult<Option<T>> {
        let given = self.map.get(name).map(Dynamic::to_string);
        given.map(|text| word(name, &text, known).map_err(|error| at_key(name, *error))).transpose()
    }

    /// The quantity `name`: a number in the SI unit, or a text with its unit.
    pub fn quantity(&self, name: &str, dimension: Dimension) -> HostResult<f64> {
        let value = self.value(name)?;
        match value.read_lock::<ImmutableString>() {
            Some(text) => dimension.parse(&text).map_err(|error| refuse!("{name}: {error}")),
            None => number(value, name),
        }
    }

    /// The boolean `name`, or else `otherwise`.
    pub fn boolean(&self, name: &str, otherwise: bool) -> HostResult<bool> {
        let boolean = |value: &Dynamic| value.as_bool();
        let value = self.map.get(name).map_or(Ok(otherwise), boolean);
        value.map_err(|found| refuse!("{name} is true or false, not {found}"))
    }
}

/// The arguments of a script on the command line, which it reads as `args`.
#[derive(Clone, Debug, Default)]
pub struct Arguments(Map);

impl Arguments {
    /// The arguments by name.
    pub fn new(values: Map) -> Arguments {
        Arguments(values)
    }

    /// Offers the type of `args` to scripts: `args.name`, `"name" in args`, `args.keys()`.
    pub fn register(engine: &mut Engine) {
        engine
            .register_type_with_name::<Arguments>("arguments")
            .register_indexer_get(Arguments::get)
            .register_fn("number", Arguments::number)
            .register_fn("numbers", Arguments::numbers)
            .register_fn("text", Arguments::text)
            .register_fn("contains", |args: &mut Arguments, name: &str| args.0.contains_key(name))
            .register_fn("keys", |args: &mut Arguments| {
                args.0.keys().map(|name| name.as_str().into()).collect::<Array>()
            });
    }

    /// The number `name`, or else `otherwise`.
    fn number(&mut self, name: &str, otherwise: Dynamic) -> HostResult<Dynamic> {
        match self.0.get(name) {
            None => Ok(otherwise),
            Some(value) if value.is_int() || value.is_float() => Ok(value.clone()),
            Some(value) => Err(refuse!("--arg {name}: expected a number, found `{value}`{}", comma(value))),
        }
    }

    /// The numbers `name`, as many as `otherwise` has, which these are where the argument is not given.
    fn numbers(&mut self, name: &str, otherwise: Array) -> HostResult<Array> {
        let Some(value) = self.0.get(name) else { return Ok(otherwise) };
        let text = value.to_string();
        let numbers: Option<Array> =
            text.split(',').map(|number| number.trim().parse::<f64>().ok().map(Dynamic::from)).collect();
        let count = otherwise.len();
        numbers.filter(|numbers| numbers.len() == count).ok_or_else(|| {
            let example = otherwise.iter().map(Dynamic::to_string).collect::<Vec<_>>().join(", ");
            refuse!("--arg {name}: expected {count} numbers, such as {example}, found `{text}`")
        })
    }

    /// The text `name`, or else `otherwise`.
    fn text(&mut self, name: &str, otherwise: &str) -> ImmutableString {
        self.0.get(name).map_or_else(|| otherwise.into(), |value| value.to_string().into())
    }

    fn get(&mut self, name: ImmutableString) -> HostResult<Dynamic> {
        let how = if name == "scenario" { "--scenario FILE".into() } else { format!("--arg {name}=…") };
        self.0.get(name.as_str()).cloned().ok_or_else(|| refuse!("the script needs `{name}`: give {how}"))
    }
}

/// A hint where the value is a number with a decimal comma.
fn comma(value: &Dynamic) -> &'static str {
    let text = value.to_string();
    let is_decimal = text.matches(',').count() == 1 && text.replace(',', ".").parse::<f64>().is_ok();
    if is_decimal { " (write a decimal point)" } else { "" }
}

/// Replaces the interpreter's `sort` and `sort_desc` of the list itself.
pub(super) fn register_sort(engine: &mut Engine) {
    engine
        .register_fn("sort", |list: &mut Array| sort(list, |order| order))
        .register_fn("sort_desc", |list: &mut Array| sort(list, Ordering::reverse));
}

fn sort(list: &mut Array, direction: fn(Ordering) -> Ordering) -> HostResult<()> {
    let number = |item: &Dynamic| item.as_float().or_else(|_| item.as_int().map(|whole| whole as f64)).ok();
    let text = |item: &Dynamic| item.clone().into_immutable_string().ok();
    if list.iter().all(|item| number(item).is_some()) && list.iter().filter_map(number).any(f64::is_nan) {
        return Err(refuse("a list with NaN has no order"));
    }
    let is_sorted = sort_by(list, |item| item.as_int().ok(), |a, b| direction(a.cmp(b)))
        || sort_by(list, number, |a, b| direction(a.total_cmp(b)))
        || sort_by(list, text, |a, b| direction(a.cmp(b)))
        || sort_by(list, |item| item.as_char().ok(), |a, b| direction(a.cmp(b)))
        || sort_by(list, |item| item.as_bool().ok(), |a, b| direction(a.cmp(b)));
    let kinds = "numbers, texts or Booleans";
    let wrong = || refuse!("a list is sorted where all of it are {kinds}; give `sort` a function for others");
    is_sorted.then_some(()).ok_or_else(wrong)
}

/// Sorts the list by the keys of its items, where all have one.
fn sort_by<K>(list: &mut Array, key: impl Fn(&Dynamic) -> Option<K>, order: impl Fn(&K, &K) -> Ordering) -> bool {
    let Some(keys) = list.iter().map(key).collect::<Option<Vec<K>>>() else { return false };
    let mut places: Vec<usize> = (0..keys.len()).collect();
    places.sort_by(|a, b| order(&keys[*a], &keys[*b]));
    *list = places.into_iter().map(|place| std::mem::take(&mut list[place])).collect();
    true
}
