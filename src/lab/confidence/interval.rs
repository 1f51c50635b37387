//! The interval of a parameter around its estimate.

/// An interval, symmetric about the estimate or, for a relative one, about its logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    x: f64,
    half_width: f64,
    relative: bool,
}

impl Interval {
    /// The interval around `x`. Zero has no logarithm: its interval is absolute.
    pub fn new(x: f64, half_width: f64, relative: bool) -> Interval {
        Interval { x, half_width, relative: relative && x != 0.0 }
    }

    /// The value `share` half-widths above the estimate.
    pub fn value_at(&self, share: f64) -> f64 {
        let Interval { x, half_width, .. } = *self;
        if share == 0.0 || half_width == 0.0 {
            x
        } else if self.relative {
            x * (share * half_width / x).exp()
        } else {
            x + share * half_width
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_intervals_are_symmetric_in_the_logarithm() {
        for x in [0.5, -0.5] {
            let interval = Interval::new(x, 1.0, true);
            let [lower, upper] = [interval.value_at(-1.0), interval.value_at(1.0)];
            assert!(lower < x && upper > x && (lower * upper - x * x).abs() < 1e-12 && lower * x > 0.0);
        }
        assert_eq!(Interval::new(0.0, 1.0, true).value_at(1.0), 1.0);
    }
}
