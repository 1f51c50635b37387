//! How far a channel may stray, as a case's README states it.

/// One row of the table `| channel | tolerance | reason |`.
#[derive(Debug, PartialEq)]
pub struct Tolerance {
    pub channel: String,
    bound: Bound,
}

#[derive(Debug, PartialEq)]
enum Bound {
    /// In the channel's own unit.
    Absolute(f64),
    /// Share of the largest recorded value in magnitude.
    Relative(f64),
}

/// The rows of the table in `readme`. A tolerance is `0.5 %` of the channel's largest value in
/// magnitude or a plain number in the channel's unit; every row needs a reason.
pub fn table(readme: &str) -> Result<Vec<Tolerance>, String> {
    let cells = |line: &str| -> Vec<String> {
        let inner = line.trim().trim_matches('|');
        inner.split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let mut rows = readme.lines().filter(|line| line.trim_start().starts_with('|')).map(cells);
    if !rows.any(|row| row == ["channel", "tolerance", "reason"]) {
        return Err("README.md has no table `| channel | tolerance | reason |`".to_owned());
    }
    rows.skip(1).map(|row| parse(&row)).collect()
}

fn parse(row: &[String]) -> Result<Tolerance, String> {
    let wrong = || format!("README.md: `{}` is not a channel, a tolerance and a reason", row.join(" | "));
    let [channel, bound, reason] = row else {
        return Err(wrong());
    };
    let number = bound.trim_end_matches('%').trim().parse::<f64>();
    let number = number.ok().filter(|n| n.is_finite() && *n >= 0.0 && !reason.is_empty());
    let number = number.ok_or_else(wrong)?;
    let bound = match bound.ends_with('%') {
        true => Bound::Relative(number / 100.0),
        false => Bound::Absolute(number),
    };
    let channel = channel.trim_matches('`').to_owned();
    Ok(Tolerance { channel, bound })
}

impl Tolerance {
    /// Where `new` strays most from `old`, if that is too far. Gaps must stand at the same samples.
    pub fn stray(&self, time: &[f64], old: &[f64], new: &[f64]) -> Option<String> {
        let largest = old.iter().filter(|v| v.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()));
        let bound = match self.bound {
            Bound::Absolute(bound) => bound,
            Bound::Relative(share) => share * largest,
        };
        let distance = |(old, new): (&f64, &f64)| match old.is_nan() && new.is_nan() {
            true => 0.0,
            false => (old - new).abs(),
        };
        let far = |distance: f64| distance.is_nan() || distance > bound;
        let distances = old.iter().zip(new).map(distance).enumerate();
        let (worst, by) = distances.filter(|(_, d)| far(*d)).max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!(
            "{} strays by {by:.3e} at {:.6} s ({:.6e}, was {:.6e}); {bound:.3e} is allowed",
            self.channel, time[worst], new[worst], old[worst]
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const README: &str = "# A case\n\n| channel | tolerance | reason |\n|---|---|---|\n\
        | `force_N` | 0.5 % | order of sums |\n| strain | 1e-3 | as read off |\n";

    #[test]
    fn tolerances_are_read_from_the_table() {
        let table = table(README).unwrap();
        assert_eq!(table[0].bound, Bound::Relative(0.005));
        assert_eq!((table[1].channel.as_str(), &table[1].bound), ("strain", &Bound::Absolute(1e-3)));
    }

    #[test]
    fn tables_without_reasons_or_numbers_are_refused() {
        for (from, to) in [("order of sums", ""), ("0.5 %", "little"), ("1e-3", "-1"), ("reason", "why")] {
            assert!(table(&README.replace(from, to)).is_err(), "{from}");
        }
    }

    #[test]
    fn the_worst_sample_beyond_the_bound_is_named() {
        let [force, strain] = <[Tolerance; 2]>::try_from(table(README).unwrap()).unwrap();
        let time = [0.0, 0.1, 0.2];
        assert_eq!(force.stray(&time, &[0.0, 100.0, f64::NAN], &[0.4, 100.4, f64::NAN]), None);
        let stray = force.stray(&time, &[0.0, 100.0, 1.0], &[0.4, 101.0, 1.6]).unwrap();
        assert!(stray.contains("at 0.100000 s"), "{stray}");
        assert!(strain.stray(&time, &[0.0, 1.0, 2.0], &[0.0, 1.0, f64::NAN]).is_some());
    }
}
