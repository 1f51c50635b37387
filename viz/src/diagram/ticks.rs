//! Round values along an axis.

/// Intended number of intervals between ticks.
const SPACES: f64 = 5.0;

/// Least span of an axis: the ticks of a smaller one have equal labels.
const LEAST_SPAN: f64 = 1e-300;

/// An axis with its ends and ticks, all as numbers on the page: logarithms where it is by decades.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    logarithmic: bool,
    low: f64,
    high: f64,
}

impl Scale {
    /// An axis that covers all of `values`.
    pub(crate) fn over(values: impl Iterator<Item = f64>, logarithmic: bool) -> Scale {
        let placed = values.filter_map(|value| laid(value, logarithmic));
        let (low, high) = placed.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = match high - low {
            // Ends so close that steps between them are lost in their last digits are one value.
            span if span > LEAST_SPAN && span > 1e-12 * low.abs().max(high.abs()) => (low, high),
            _ if low.is_finite() => (low - 0.5 * low.abs().max(1.0), low + 0.5 * low.abs().max(1.0)),
            _ => (0.0, 1.0),
        };
        Scale { logarithmic, low, high }
    }

    /// This scale with the ends moved out to the next ticks.
    pub(crate) fn rounded(self) -> Scale {
        let step = step(self.high - self.low);
        // An end that is a tick but for round-off stays where it is.
        let out = |value: f64| (value / step - 1e-9).ceil() * step;
        Scale { low: -out(-self.low), high: out(self.high), ..self }
    }

    /// Share of the axis at a value; `None` where it is not drawn.
    pub(crate) fn share(&self, value: f64) -> Option<f64> {
        laid(value, self.logarithmic).map(|value| (value - self.low) / (self.high - self.low))
    }

    /// Share of the axis and words of every tick.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let span = self.high - self.low;
        // On a logarithmic axis, steps of less than a power of ten have no round exponents.
        let step = if self.logarithmic { step(span).max(1.0) } else { step(span) };
        let [first, last] = [(self.low / step - 1e-9).ceil(), (self.high / step + 1e-9).floor()].map(|k| k as i64);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let words = |value: f64| match self.logarithmic {
            true => format!("1e{value:.0}"),
            false if !(1e-5..1e6).contains(&step) => format!("{value:.*e}", digits(value, step)),
            false => format!("{:.decimals$}", value + 0.0),
        };
        (first..=last).map(|k| k as f64 * step).map(|value| ((value - self.low) / span, words(value))).collect()
    }
}

fn laid(value: f64, logarithmic: bool) -> Option<f64> {
    let value = if logarithmic { value.log10() } else { value };
    value.is_finite().then_some(value)
}

/// Digits behind the point of a number in powers of ten that tell it from one a step away.
fn digits(value: f64, step: f64) -> usize {
    let power = |number: f64| number.log10().floor();
    (power(value.abs().max(step)) - power(step)).max(0.0) as usize
}

/// The round step (1, 2 or 5 times a power of ten) that comes closest to the wanted number of spaces.
fn step(span: f64) -> f64 {
    let raw = span / SPACES;
    let power = 10_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= 0.8 * raw).unwrap_or(10.0);
    factor * power
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let words = |scale: &Scale| scale.ticks().into_iter().map(|(_, words)| words).collect::<Vec<_>>();
        let values = [0.3, 57.0, f64::NAN];
        let scale = Scale::over(values.into_iter(), false);
        assert_eq!(words(&scale), ["10", "20", "30", "40", "50"]);
        assert_eq!(words(&scale.rounded()), ["0", "10", "20", "30", "40", "50", "60"]);
        let scale = Scale::over([1e-3, 20.0, -1.0].into_iter(), true);
        assert_eq!(words(&scale), ["1e-3", "1e-2", "1e-1", "1e0", "1e1"]);
        assert_eq!(scale.share(-1.0), None);
        assert_eq!(words(&Scale::over([-0.12, 0.12].into_iter(), false)), ["-0.10", "-0.05", "0.00", "0.05", "0.10"]);
    }

    #[test]
    fn an_axis_of_one_value_or_none_has_a_width() {
        assert_eq!(Scale::over([2.0].into_iter(), false).share(2.0), Some(0.5));
        assert_eq!(Scale::over([f64::NAN].into_iter(), false).share(0.5), Some(0.5));
        let subnormal = Scale::over([0.0, 5e-324].into_iter(), false);
        assert_eq!((subnormal.share(0.0), subnormal.ticks().len()), (Some(0.5), 5));
    }

    #[test]
    fn neighbours_far_from_nothing_have_words_of_their_own() {
        for ends in [[1.0, 1.00001], [1.23e12, 1.23e12 + 4e6], [-2e-9, 3e-9]] {
            let words: Vec<String> =
                Scale::over(ends.into_iter(), false).ticks().into_iter().map(|(_, words)| words).collect();
            let different: BTreeSet<&String> = words.iter().collect();
            assert!(words.len() > 3 && different.len() == words.len(), "{words:?}");
        }
    }
}
