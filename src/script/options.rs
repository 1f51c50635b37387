use rhai::{Dynamic, ImmutableString, Map};

use super::{HostResult, number, refuse};
use crate::units::Dimension;

/// What a script gives a function by name.
pub struct Options<'a> {
    /// The function, as its refusals name it.
    pub of: &'static str,
    pub map: &'a Map,
}

impl Options<'_> {
    /// Refuses a name that nobody reads.
    pub fn check(&self, known: &[&str]) -> HostResult<()> {
        let unknown = self.map.keys().find(|key| !known.contains(&key.as_str()));
        let message = |key| format!("{} knows no `{key}`; it takes {}", self.of, known.join(", "));
        unknown.map_or(Ok(()), |key| Err(refuse(message(key))))
    }

    /// The value called `name`.
    pub fn value(&self, name: &str) -> HostResult<&Dynamic> {
        self.map.get(name).ok_or_else(|| refuse(format!("{} needs `{name}`", self.of)))
    }

    /// The number called `name`.
    pub fn needed_number(&self, name: &str) -> HostResult<f64> {
        number(self.value(name)?, name)
    }

    /// The number called `name`, or else another.
    pub fn number(&self, name: &str, otherwise: f64) -> HostResult<f64> {
        self.map.get(name).map_or(Ok(otherwise), |value| number(value, name))
    }

    /// A number in the SI unit, or a text with its unit.
    pub fn quantity(&self, name: &str, dimension: Dimension) -> HostResult<f64> {
        let value = self.value(name)?;
        match value.read_lock::<ImmutableString>() {
            Some(text) => dimension.parse(&text).map_err(|error| refuse(format!("{name}: {error}"))),
            None => number(value, name),
        }
    }

    /// True or false, or else another.
    pub fn truth(&self, name: &str, otherwise: bool) -> HostResult<bool> {
        let truth = |value: &Dynamic| value.as_bool();
        let said = self.map.get(name).map_or(Ok(otherwise), truth);
        said.map_err(|found| refuse(format!("{name} is true or false, not {found}")))
    }
}
