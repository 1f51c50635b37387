//! Conversion of values between scripts and JSON.

use rhai::{Array, Dynamic, Map};
use serde_json::{Number, Value};

use super::{HostResult, refuse};

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
    integer.map(|i| i as f64).map_err(|found| refuse(format!("expected a number for {what}, found {found}")))
}

/// A window of time `[from, to]` in s.
///
/// # Errors
/// It is not a list of two numbers.
pub fn window(value: &Dynamic) -> HostResult<[f64; 2]> {
    let bounds = value.read_lock::<Array>();
    let bounds = bounds.as_deref().map(Vec::as_slice);
    let Some([from, to]) = bounds else {
        return Err(refuse(format!("expected a window [from, to], found {}", value.type_name())));
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
        return Err(refuse(format!("values are nested more than {DEEPEST} deep")));
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
    Err(refuse(format!("a {} is not a figure: reduce it to a number, such as its max()", value.type_name())))
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
