//! Warnings about what varies: values of a distribution with which the scenario cannot be run.

use std::fmt;

use droptower_uncertainty::distribution::Distribution;
use serde_json::{Map, Value};

use crate::finding::{Code, Report, codes};
use crate::model::{self, Factor, Values, Variation};
use crate::number;
use crate::scenario::Document;

codes! {
    VALUES_REFUSED = "values-refused", Warning,
        "a distribution of `[variation]` has values that the scenario, otherwise as written, does not take: such runs of a sweep fail, \
         and the others no longer have the distribution that was meant",
        "truncate the distribution to values that can be, as in `truncate = { low = 0 }`, or choose one that has no others, such as \
         `lognormal` or `weibull` for what is above zero";
}

/// Least share of the values that is looked for: less is hardly met by a sweep.
const LEAST: f64 = 1e-4;

/// Halvings of the distance to the limit.
const HALVINGS: usize = 30;

/// What is hardly meant in a variation.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A distribution has values that the scenario does not take.
    Refused {
        /// Path of the key.
        key: String,
        /// Probability of these values.
        share: f64,
        /// Which they are.
        beyond: Beyond,
    },
}

/// The values of a distribution that the scenario does not take.
#[derive(Clone, Debug, PartialEq)]
pub enum Beyond {
    /// Those below this one, SI and as it is written.
    Below(f64, String),
    /// Those above this one, SI and as it is written.
    Above(f64, String),
    /// Its median among others.
    Median,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Warning::Refused { key, share, beyond } = self;
        let percent = number::significant(100.0 * share, 2);
        match beyond {
            Beyond::Below(_, limit) => write!(
                f,
                "`{key}` is below {limit} in {percent} % of its distribution, where the scenario cannot be run: \
                 truncate = {{ low = {limit} }} leaves that out"
            ),
            Beyond::Above(_, limit) => write!(
                f,
                "`{key}` is above {limit} in {percent} % of its distribution, where the scenario cannot be run: \
                 truncate = {{ high = {limit} }} leaves that out"
            ),
            Beyond::Median => write!(f, "with the median of `{key}` the scenario cannot be run"),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        &VALUES_REFUSED
    }

    fn figures(&self) -> Map<String, Value> {
        let Warning::Refused { key, share, beyond } = self;
        let limit = match beyond {
            Beyond::Below(limit, _) => Some(("low", *limit)),
            Beyond::Above(limit, _) => Some(("high", *limit)),
            Beyond::Median => None,
        };
        let figures = [("key", key.as_str().into()), ("share", (*share).into())].into_iter();
        let limit = limit.map(|(side, limit)| (side, limit.into()));
        figures.chain(limit).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// What is hardly meant in what varies in the scenario `base`.
pub fn warnings(base: &Document, variation: &Variation) -> Vec<Warning> {
    let distributed = variation.factors.iter().filter_map(|factor| match &factor.values {
        Values::Distribution(distribution) => Some(refused(base, factor, distribution)),
        Values::Levels(_) => None,
    });
    distributed.flatten().collect()
}

/// The values of a factor with which the scenario, otherwise as written, is none.
fn refused(base: &Document, factor: &Factor, distribution: &Distribution) -> Vec<Warning> {
    let is_taken = |value: f64| model::check(&base.with(&[factor.assignment(&factor.number(value))])).is_ok();
    let warning = |share, beyond| Warning::Refused { key: factor.path.clone(), share, beyond };
    let [low, median, high] = [LEAST, 0.5, 1.0 - LEAST].map(|share| distribution.quantile(share));
    if !is_taken(median) {
        return vec![warning(0.5, Beyond::Median)];
    }
    let limit = |end: f64| {
        let (mut taken, mut refused) = (median, end);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (taken + refused);
            *if is_taken(middle) { &mut taken } else { &mut refused } = middle;
        }
        // Of the halvings more digits are left than anybody wrote.
        let limit = if taken.abs() < 1e-6 * (median - end).abs() { 0.0 } else { number::rounded(taken, 6) };
        (limit, factor.written(limit))
    };
    let below = (!is_taken(low)).then(|| {
        let (limit, written) = limit(low);
        warning(distribution.cumulative(limit), Beyond::Below(limit, written))
    });
    let above = (!is_taken(high)).then(|| {
        let (limit, written) = limit(high);
        warning(1.0 - distribution.cumulative(limit), Beyond::Above(limit, written))
    });
    below.into_iter().chain(above).collect()
}
