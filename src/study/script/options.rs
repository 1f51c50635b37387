use std::ops::RangeInclusive;

use rhai::{Dynamic, ImmutableString, Map};

use super::{HostResult, number, refuse, refuse_key};
use base::diagnostic::closest;
use base::removed;
use base::units::Dimension;

/// The options of a host function: a map from a script.
pub struct Options<'a> {
    /// The function, as its messages name it.
    pub of: &'static str,
    /// The options by name.
    pub map: &'a Map,
}

impl Options<'_> {
    /// Refuses names other than the `known` ones, at their place.
    pub fn check(&self, known: &[&str]) -> HostResult<()> {
        let Some(key) = self.map.keys().find(|key| !known.contains(&key.as_str())) else { return Ok(()) };
        let message = format!("{} has no option `{key}`; it takes {}", self.of, known.join(", "));
        let meant = || closest(key, known.iter().copied()).map(|name| format!("did you mean `{name}`?"));
        Err(refuse_key(key, &message, removed::function(&format!("{}.{key}", self.of)).or_else(meant)))
    }

    /// The option `name`.
    ///
    /// # Errors
    /// It is missing.
    pub fn value(&self, name: &str) -> HostResult<&Dynamic> {
        self.map.get(name).ok_or_else(|| refuse(format!("{} needs `{name}`", self.of)))
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

    /// The quantity `name`: a number in the SI unit, or a text with its unit.
    pub fn quantity(&self, name: &str, dimension: Dimension) -> HostResult<f64> {
        let value = self.value(name)?;
        match value.read_lock::<ImmutableString>() {
            Some(text) => dimension.parse(&text).map_err(|error| refuse(format!("{name}: {error}"))),
            None => number(value, name),
        }
    }

    /// The boolean `name`, or else `otherwise`.
    pub fn boolean(&self, name: &str, otherwise: bool) -> HostResult<bool> {
        let boolean = |value: &Dynamic| value.as_bool();
        let value = self.map.get(name).map_or(Ok(otherwise), boolean);
        value.map_err(|found| refuse(format!("{name} is true or false, not {found}")))
    }
}
