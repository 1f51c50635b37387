//! Warnings about what varies: values of a distribution with which the scenario cannot be run; probabilities that
//! the runs leave open; specimens that tell no distribution of the strength.

use uncertainty::distribution::Distribution;

use base::findings;
use base::number;
use scene::model::{self, Factor, Values, Variation};
use scene::scenario::Document;

/// Least share of the values that is looked for: less is hardly met by a sweep.
const LEAST: f64 = 1e-4;

/// Halvings of the distance to the limit.
const HALVINGS: usize = 30;

findings! {
    /// Implausible values in a variation.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        Refused {
            key: String, "path of the key" => "key";
            beyond: Beyond, "which values they are" => ..beyond.figures();
        } = "values-refused", Warning;
            meaning "a distribution of `[variation]` has values that the scenario, otherwise as written, does not \
                take: such runs of a sweep fail, and the others no longer have the distribution that was meant";
            remedy "truncate the distribution to values that can be, as in `truncate = { low = 0 }`, or choose one \
                that has no others, such as `lognormal` or `weibull` for what is above zero";
            message "{}", beyond.message(key);
        NoStrengthFit {
            reason: uncertainty::Error, "why there is none";
        } = "no-strength-fit", Note;
            meaning "specimens that failed or held at their levels have no normal distribution of the strength by maximum \
                likelihood, so that neither its deviation nor an interval of its mean is known";
            remedy "test further specimens, with steps between half and once the deviation of the strength, so that some hold at \
                a level above one at which others fail";
            message "no distribution of the strength: {reason}";
        NotReached {
            figure: String, "figure of the runs" => "figure";
            levels: usize, "levels that were simulated" => "levels";
            below: f64, "upper end of the 95 % interval" => "below";
        } = "failure-not-reached", Warning;
            meaning "the last level of a subset simulation has no failing sample: of the probability only a bound is known";
            remedy "none where so rare a failure does not matter; otherwise a limit that the figure can reach, or distributions \
                without ends short of failure";
            message "{figure}: after {levels} levels no sample fails: the probability is below {}", number::figure(*below, 2);
    }
}

/// The values of a distribution that the scenario does not take.
#[derive(Clone, Debug, PartialEq)]
pub enum Beyond {
    /// The values below a limit.
    Below(Limit),
    /// The values above a limit.
    Above(Limit),
    /// Its median among others.
    Median,
}

/// The limit of the values that the scenario takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// SI.
    pub value: f64,
    /// As it is written in a scenario.
    pub written: String,
    /// Probability of the values beyond it.
    pub share: f64,
}

impl Beyond {
    /// Where the values are, the end of the distribution there, and the limit.
    fn side(&self) -> Option<(&'static str, &'static str, &Limit)> {
        match self {
            Beyond::Below(limit) => Some(("below", "low", limit)),
            Beyond::Above(limit) => Some(("above", "high", limit)),
            Beyond::Median => None,
        }
    }

    fn figures(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let figures = self.side().map(|(_, end, limit)| [(end, limit.value), ("share", limit.share)]);
        figures.into_iter().flatten()
    }

    fn message(&self, key: &str) -> String {
        let Some((side, end, Limit { written, share, .. })) = self.side() else {
            return format!("with the median of `{key}` the scenario cannot be run");
        };
        let percent = number::significant(100.0 * share, 2);
        format!(
            "`{key}` is {side} {written} in {percent} % of its distribution, where the scenario cannot be run: \
             truncate = {{ {end} = {written} }} leaves that out"
        )
    }
}

/// Implausible values of the keys that vary in the scenario `base`.
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
    let warning = |beyond| Warning::Refused { key: factor.path.clone(), beyond };
    let [low, median, high] = [LEAST, 0.5, 1.0 - LEAST].map(|share| distribution.quantile(share));
    if !is_taken(median) {
        return vec![warning(Beyond::Median)];
    }
    // Limit and the probability of at most that value.
    let limit = |end: f64| {
        let (mut taken, mut refused) = (median, end);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (taken + refused);
            *if is_taken(middle) { &mut taken } else { &mut refused } = middle;
        }
        // Of the halvings more digits are left than anybody wrote.
        let value = if taken.abs() < 1e-6 * (median - end).abs() { 0.0 } else { number::rounded(taken, 6) };
        Limit { value, written: factor.written(value), share: distribution.cumulative(value) }
    };
    let below = (!is_taken(low)).then(|| warning(Beyond::Below(limit(low))));
    let above = (!is_taken(high)).then(|| {
        let limit = limit(high);
        warning(Beyond::Above(Limit { share: 1.0 - limit.share, ..limit }))
    });
    below.into_iter().chain(above).collect()
}
