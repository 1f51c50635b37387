//! Properties of objects.

use std::collections::BTreeMap;

use super::Fault;
use super::bytes::Bytes;
use super::kind::{Kind, Timestamp};

/// Properties by name.
pub type Properties = BTreeMap<String, Value>;

/// Value of a property.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    Time(Timestamp),
    /// Of a type that no property is used with here.
    Other,
}

impl Value {
    fn read(bytes: &mut Bytes) -> Result<Value, Fault> {
        const WHAT: &str = "a property";
        let (at, code) = (bytes.at(), bytes.u32(WHAT)?);
        let kind = Kind::from_code(code).ok_or(Fault::UnknownType { at, what: WHAT, code })?;
        let is_big = bytes.is_big();
        Ok(match (kind, kind.width()) {
            (Kind::Text, _) => Value::Text(bytes.text(WHAT)?),
            (_, None) => return Err(Fault::UnknownType { at, what: WHAT, code }),
            (Kind::Timestamp, Some(width)) => {
                Timestamp::from_bytes(bytes.take(width, WHAT)?, is_big).map_or(Value::Other, Value::Time)
            }
            (_, Some(width)) => kind.number(bytes.take(width, WHAT)?, is_big).map_or(Value::Other, Value::Number),
        })
    }
}

/// Reads the properties of an object over those that it had.
pub fn read(bytes: &mut Bytes, properties: &mut Properties) -> Result<(), Fault> {
    for _ in 0..bytes.u32("the number of properties")? {
        let name = bytes.text("the name of a property")?;
        properties.insert(name, Value::read(bytes)?);
    }
    Ok(())
}

/// The number of this name.
pub fn number(properties: &Properties, name: &str) -> Option<f64> {
    match properties.get(name) {
        Some(Value::Number(number)) => Some(*number),
        _ => None,
    }
}

/// The text of this name.
pub fn text<'a>(properties: &'a Properties, name: &str) -> Option<&'a str> {
    match properties.get(name) {
        Some(Value::Text(text)) => Some(text),
        _ => None,
    }
}
