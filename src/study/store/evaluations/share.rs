//! The order in which one of several processes takes the runs of a study.

/// The part of the runs of a study that a process takes first: of every `of` runs that numbered `number`, from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Which part, from one.
    pub number: usize,
    /// Number of parts.
    pub of: usize,
}

impl Share {
    /// The whole.
    pub const WHOLE: Share = Share { number: 1, of: 1 };

    /// Reads `3/16`.
    pub fn parse(text: &str) -> Option<Share> {
        let (number, of) = text.split_once('/')?;
        let share = Share { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? };
        (1..=share.of).contains(&share.number).then_some(share)
    }

    /// The places of `count` runs in the order in which the process with this share takes them: its own, then those of
    /// the others from the last one on, which they take last. Neighbours are taken far apart, so that those that are
    /// done tell how long the rest takes: the runs of a grid become longer from one end to the other.
    pub fn order(self, count: usize) -> Vec<usize> {
        let all = scattered(count);
        let own = all.iter().filter(|place| self.has(**place));
        let others = all.iter().rev().filter(|place| !self.has(**place));
        own.chain(others).copied().collect()
    }

    fn has(&self, place: usize) -> bool {
        place % self.of == self.number - 1
    }
}

/// The places of `count` runs, each once, in steps of the golden section, which cover them evenly at any time.
fn scattered(count: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let nearest = (GOLDEN * count as f64).round() as usize;
    let step = (nearest.max(1)..).find(|step| gcd(*step, count) == 1).unwrap_or(1);
    (0..count).map(|turn| turn * step % count).collect()
}

fn gcd(one: usize, other: usize) -> usize {
    if other == 0 { one } else { gcd(other, one % other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_read_and_refused() {
        assert_eq!(Share::parse("3/16"), Some(Share { number: 3, of: 16 }));
        for text in ["0/4", "5/4", "3", "a/b", "1/0", "-1/2", ""] {
            assert_eq!(Share::parse(text), None, "{text}");
        }
    }

    /// The mean of any first part of a ramp is near that of the whole.
    #[test]
    fn what_is_done_tells_how_long_the_rest_takes() {
        for count in [50, 64, 200, 1000, 9973] {
            let order = Share::WHOLE.order(count);
            for part in [count / 10, count / 4, count / 2] {
                let mean = order[..part].iter().sum::<usize>() as f64 / part as f64;
                let of_all = (count - 1) as f64 / 2.0;
                assert!((mean / of_all - 1.0).abs() < 0.3, "{count} {part}: {}", mean / of_all);
            }
        }
    }

    #[test]
    fn all_runs_are_in_every_order_and_own_ones_first() {
        assert_eq!(Share::WHOLE.order(8), [0, 5, 2, 7, 4, 1, 6, 3]);
        assert_eq!(Share { number: 2, of: 3 }.order(7), [4, 1, 3, 6, 2, 5, 0]);
        assert_eq!((Share::WHOLE.order(0), Share::WHOLE.order(1)), (vec![], vec![0]));
        for number in 1..=5 {
            let mut all = Share { number, of: 5 }.order(23);
            all.sort_unstable();
            assert!(all.into_iter().eq(0..23));
        }
    }
}
