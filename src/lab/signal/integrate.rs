//! Integrals over time by the trapezoidal rule.

use super::Series;

/// The running integral, `start` at the first sample.
pub fn once(series: &Series, start: f64) -> Series {
    let (time, values) = (series.time(), series.values());
    let mut sum = start;
    let rest = (1..series.len()).map(|i| {
        sum += 0.5 * (values[i] + values[i - 1]) * (time[i] - time[i - 1]);
        sum
    });
    let first = (!series.is_empty()).then_some(start);
    series.with_values(first.into_iter().chain(rest).collect())
}

/// The running integral of the running integral: travel from acceleration, given the speed and place at the first
/// sample.
pub fn twice(series: &Series, speed: f64, place: f64) -> Series {
    once(&once(series, speed), place)
}

/// The integral over the whole series; zero for fewer than two samples.
pub fn total(series: &Series) -> f64 {
    once(series, 0.0).values().last().copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(count: usize, f: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    #[test]
    fn a_constant_integrates_to_a_line_exactly() {
        let fall = once(&sampled(64, |_| -9.81), -2.0);
        for [t, v] in fall.samples() {
            assert!((v - (-2.0 - 9.81 * t)).abs() < 1e-12);
        }
    }

    #[test]
    fn travel_converges_with_the_square_of_the_step() {
        let error = |count| {
            let travel = twice(&sampled(count, |t| (3.0 * t).sin()), -1.0 / 3.0, 0.0);
            let exact = -(3.0f64).sin() / 9.0;
            (travel.values().last().unwrap() - exact).abs()
        };
        let order = (error(50) / error(100)).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }

    #[test]
    fn nothing_integrates_to_nothing() {
        assert_eq!(total(&Series::new(vec![], vec![])), 0.0);
        assert_eq!(total(&Series::new(vec![1.0], vec![5.0])), 0.0);
    }
}
