//! Random numbers of a seed: the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::normal;

/// Stream of pseudo-random numbers (ChaCha with 8 rounds; Bernstein 2008).
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform over the open interval (0, 1), of 52 random bits.
    pub fn uniform(&mut self) -> f64 {
        open_unit(self.bits())
    }

    /// Standard normal, as the quantile of a uniform number.
    pub fn normal(&mut self) -> f64 {
        normal::quantile(self.uniform())
    }

    /// Uniform over 0 … `count` − 1, without bias (rejection; Lemire 2019). `count` must not be 0.
    pub fn below(&mut self, count: usize) -> usize {
        let count = count as u64;
        // 2⁶⁴ mod count: as many low products are too many, or small numbers would come up more often.
        let rejected = count.wrapping_neg() % count;
        loop {
            let product = u128::from(self.bits()) * u128::from(count);
            if product as u64 >= rejected {
                return (product >> 64) as usize;
            }
        }
    }

    /// A random order of 0 … `count` − 1 (Fisher & Yates; Durstenfeld 1964).
    pub fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

/// Midpoint of the interval of width 2⁻⁵² that the upper 52 of `bits` name: within (0, 1), neither end included.
pub(crate) fn open_unit(bits: u64) -> f64 {
    const WIDTH: f64 = 1.0 / (1_u64 << 52) as f64;
    ((bits >> 12) as f64 + 0.5) * WIDTH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_numbers_in_every_version() {
        let mut stream = Stream::new(7);
        let drawn = [stream.bits(), stream.bits(), stream.bits()];
        assert_eq!(drawn, FIRST);
    }

    /// Numbers that the generator gave when the first studies were made.
    const FIRST: [u64; 3] = [2_910_824_217_569_608_635, 3_098_856_782_162_503_994, 12_991_601_491_111_613_745];

    #[test]
    fn numbers_lie_within_the_open_interval() {
        assert!(open_unit(0) > 0.0 && open_unit(u64::MAX) < 1.0);
        assert_eq!(open_unit(1 << 63) - 0.5, 0.5 / (1_u64 << 52) as f64);
    }

    #[test]
    fn whole_numbers_are_equally_frequent() {
        let mut stream = Stream::new(1);
        let mut counts = [0_u32; 7];
        (0..70_000).for_each(|_| counts[stream.below(7)] += 1);
        let chi_square: f64 = counts.iter().map(|&count| (f64::from(count) - 1e4).powi(2) / 1e4).sum();
        assert!(chi_square < 22.5, "0.1 % of χ² with 6 degrees of freedom exceed 22.5, found {chi_square:.1}");
    }
}
