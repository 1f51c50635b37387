//! The order in which a process takes the runs of a sweep.

use std::collections::VecDeque;

/// The part of a sweep that a process takes first: of every `of` runs that numbered `number`, from one.
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

    fn has(&self, place: usize) -> bool {
        place % self.of == self.number - 1
    }
}

/// The places of `count` runs in the order in which the process with this share takes them: its own, then those of the
/// others from the last one on, which they take last.
pub(super) fn order(count: usize, share: Share) -> VecDeque<usize> {
    let own = (0..count).filter(|place| share.has(*place));
    let others = (0..count).rev().filter(|place| !share.has(*place));
    own.chain(others).collect()
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

    #[test]
    fn all_runs_are_in_every_order_and_own_ones_first() {
        assert_eq!(order(4, Share::WHOLE), [0, 1, 2, 3]);
        assert_eq!(order(7, Share { number: 2, of: 3 }), [1, 4, 6, 5, 3, 2, 0]);
        for number in 1..=5 {
            let mut all: Vec<usize> = order(23, Share { number, of: 5 }).into();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..23));
        }
    }
}
