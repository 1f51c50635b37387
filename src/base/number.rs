//! Numbers rounded to significant digits, as values and as text.

/// The double nearest to `value` with so many significant digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// A time with twelve significant digits: 0.0573 where sums of steps give 0.057300000000000004.
pub fn clean_time(time: f64) -> f64 {
    rounded(time, 12)
}

/// The number with at most so many significant digits, none of them a zero at the end, and without an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    rounded(value, digits).to_string()
}

/// The number with so many significant digits, and all those before the point; with an exponent below 10^−digits and
/// from 10^(digits + 3) on.
pub fn figure(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    // Rounding may add a digit: 9.9996 becomes 10.00.
    let (magnitude, count) = (rounded(value, digits).abs().log10().floor() as i32, digits as i32);
    if !(-count..count + 3).contains(&magnitude) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (count - 1 - magnitude).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The number in the shortest form that reads back to it; with an exponent from 10^15 on and below 10^-6, where its
/// digits would be zeros.
pub fn plain(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (1e-6..1e15).contains(&value.abs());
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// The least and the largest of `values`; none of none.
pub fn ends(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().map(|value| [value; 2]).reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])
}

/// A count with its digits in groups of three: `11 240`.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups: Vec<&str> = groups.filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(" ")
}

/// A time in ms, from 1 s on in s.
pub fn duration(seconds: f64) -> String {
    match seconds {
        ..1.0 => format!("{:.1} ms", seconds * 1e3),
        ..10.0 => format!("{seconds:.2} s"),
        _ => format!("{seconds:.1} s"),
    }
}

/// A wall time that has passed: as one to come, but below 10 s with its fractions.
pub fn time_taken(seconds: f64) -> String {
    if seconds < 10.0 { format!("{} s", figure(seconds, 2)) } else { wall_time(seconds) }
}

/// A wall time in s, min, hours and minutes, or days and hours.
pub fn wall_time(seconds: f64) -> String {
    let (minutes, hours) = ((seconds / 60.0).round() as u64, (seconds / 3600.0).round() as u64);
    if seconds < 90.0 {
        format!("{} s", seconds.ceil())
    } else if minutes < 60 {
        format!("{minutes} min")
    } else if hours < 48 {
        format!("{} h {:02} min", minutes / 60, minutes % 60)
    } else {
        format!("{} d {} h", hours / 24, hours % 24)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_far_from_one_have_an_exponent() {
        let found = [1e300, 1e15, 1e14, 0.0, -2.5e-7, 12.5, f64::INFINITY].map(plain);
        assert_eq!(found, ["1e300", "1e15", "100000000000000", "0", "-2.5e-7", "12.5", "inf"]);
    }

    #[test]
    fn values_are_rounded_to_significant_digits() {
        for (value, expected) in [
            (1.0 / 3.0, 0.333_333),
            (-169.854_473_137, -169.854),
            (0.1 + 0.2, 0.3),
            (12_345_678.9, 12_345_700.0),
            (4.96e-6, 4.96e-6),
            (0.0, 0.0),
        ] {
            assert_eq!(rounded(value, 6), expected);
        }
        assert!(rounded(f64::NAN, 6).is_nan() && rounded(f64::INFINITY, 6) == f64::INFINITY);
    }

    #[test]
    fn times_have_no_noise() {
        for (time, expected) in [(0.057_300_000_000_000_004, 0.0573), (-0.0, 0.0), (1.0 / 3.0, 0.333_333_333_333)] {
            assert_eq!(clean_time(time), expected);
        }
    }

    #[test]
    fn text_has_at_most_the_digits_that_matter() {
        for (value, expected) in [
            (3.598_499_687, "3.6"),
            (4.16, "4.16"),
            (0.0002, "0.0002"),
            (60.0, "60"),
            (0.0, "0"),
            (-0.25, "-0.25"),
            (1_234_567.0, "1230000"),
        ] {
            assert_eq!(significant(value, 3), expected);
        }
    }

    #[test]
    fn figures_have_their_digits() {
        for (value, digits, expected) in [
            (153.043_21, 4, "153.0"),
            (0.031_234_5, 4, "0.03123"),
            (0.2, 4, "0.2000"),
            (4.0e-6, 4, "4.000e-6"),
            (-1.37e-9, 4, "-1.370e-9"),
            (2.5e6, 4, "2500000"),
            (2.5e7, 4, "2.500e7"),
            (10.712_3, 3, "10.7"),
            (9.9996, 4, "10.00"),
            (12_345.6, 4, "12346"),
            (2.5e8, 3, "2.50e8"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "NaN"),
        ] {
            assert_eq!(figure(value, digits), expected);
        }
    }

    #[test]
    fn counts_are_grouped() {
        for (count, expected) in [(200, "200"), (11_240, "11 240"), (1_000_000, "1 000 000")] {
            assert_eq!(grouped(count), expected);
        }
    }

    #[test]
    fn times_are_in_milliseconds_or_seconds() {
        assert_eq!(duration(0.0573), "57.3 ms");
        assert_eq!(duration(2000.04), "2000.0 s");
    }

    #[test]
    fn short_times_that_have_passed_have_fractions() {
        for (seconds, expected) in
            [(0.104, "0.10 s"), (1.26, "1.3 s"), (9.94, "9.9 s"), (12.2, "13 s"), (400.0, "7 min")]
        {
            assert_eq!(time_taken(seconds), expected);
        }
    }

    #[test]
    fn wall_times_are_in_two_units_from_an_hour_on() {
        for (seconds, expected) in [
            (8.2, "9 s"),
            (240.0, "4 min"),
            (3600.0, "1 h 00 min"),
            (7790.0, "2 h 10 min"),
            (100_000.0, "27 h 47 min"),
            (180_000.0, "2 d 2 h"),
        ] {
            assert_eq!(wall_time(seconds), expected);
        }
    }
}
