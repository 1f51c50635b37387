//! Designs: which points of the unit cube a study evaluates.

use std::sync::LazyLock;

use crate::random::{Stream, open_unit};
use crate::{Error, ensure};

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Full factorial: every combination of the levels, the last factor fastest.
    Grid,
    /// Latin hypercube (McKay, Beckman, Conover 1979): of n equal strata of every factor each holds one point, at a
    /// random place; the strata of different factors are paired at random. With another number of samples all points
    /// are others.
    LatinHypercube,
    /// Sobol' sequence (Sobol' 1967; direction numbers of Joe, Kuo 2008) with nested uniform scrambling (Owen 1995).
    ///
    /// Scrambling makes the estimates unbiased and, by the seed, repeatable; nested scrambling has, for smooth
    /// functions, a smaller variance than a digital shift, n⁻³ instead of n⁻² (Owen 1997). The first n points are the
    /// same however many follow; powers of two balance best.
    Sobol,
    /// Independent points. The first n are the same however many follow.
    Random,
}

/// Values that a factor takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Levels {
    /// Any.
    Continuous,
    /// This many, in a list.
    Count(usize),
}

impl Levels {
    /// Which level, from 0, the point `u` of the unit interval stands for, each by an equal part of the interval; none
    /// of a continuous factor.
    pub fn level(self, u: f64) -> Option<usize> {
        match self {
            Self::Continuous => None,
            Self::Count(count) => Some(((u * count as f64) as usize).min(count.saturating_sub(1))),
        }
    }
}

/// Most points of a design.
pub const MOST_POINTS: usize = 1 << 24;

/// Points in the open unit cube, one coordinate a factor: a design by this method, decided by `seed`.
///
/// A grid has the middle of every level's part of the unit interval, and neither `samples` nor `seed` matter. The other
/// methods place points anywhere: [`Levels::level`] tells which level of a factor they stand for.
///
/// # Errors
/// See [`Error`].
pub fn points(method: Method, factors: &[Levels], samples: usize, seed: u64) -> Result<Vec<Vec<f64>>, Error> {
    ensure(!factors.is_empty(), || "a design needs at least one factor")?;
    for (factor, levels) in factors.iter().enumerate() {
        ensure(*levels != Levels::Count(0), || format!("factor {factor} has no level"))?;
    }
    if method == Method::Grid {
        return grid(factors);
    }
    ensure(samples > 0, || "a design needs at least one sample")?;
    check_count(samples)?;
    match method {
        Method::Sobol => sobol_points(factors.len(), samples, seed),
        Method::LatinHypercube => Ok(latin_points(factors.len(), samples, seed)),
        Method::Random | Method::Grid => Ok(random(factors.len(), samples, seed)),
    }
}

fn check_count(points: usize) -> Result<(), Error> {
    ensure(points <= MOST_POINTS, || format!("the design has more than {MOST_POINTS} points"))
}

fn grid(factors: &[Levels]) -> Result<Vec<Vec<f64>>, Error> {
    let mut points = vec![Vec::new()];
    for (factor, levels) in factors.iter().enumerate() {
        let Levels::Count(count) = *levels else {
            let message = format!("factor {factor} is continuous; a grid needs a number of levels of every factor");
            return Err(Error::new(message));
        };
        check_count(points.len().saturating_mul(count))?;
        let middles: Vec<f64> = (0..count).map(|level| (level as f64 + 0.5) / count as f64).collect();
        let extended = |point: &Vec<f64>, &middle: &f64| [point.as_slice(), &[middle]].concat();
        points = points.iter().flat_map(|point| middles.iter().map(|middle| extended(point, middle))).collect();
    }
    Ok(points)
}

fn random(factors: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(seed);
    (0..samples).map(|_| (0..factors).map(|_| stream.uniform()).collect()).collect()
}

fn latin_points(factors: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(seed);
    let mut points = vec![Vec::with_capacity(factors); samples];
    for _ in 0..factors {
        // Each factor by an order of its own: each of its strata has one point, whatever the others do.
        let strata = stream.permutation(samples);
        for (point, stratum) in points.iter_mut().zip(strata) {
            point.push(within(stratum, samples, stream.uniform()));
        }
    }
    points
}

/// Point at the part `u` of a stratum, which rounding must not move into the next one.
fn within(stratum: usize, samples: usize, u: f64) -> f64 {
    let end = ((stratum + 1) as f64 / samples as f64).next_down();
    ((stratum as f64 + u) / samples as f64).min(end)
}

/// Most factors, the dimensions of the embedded table.
pub const MOST_FACTORS: usize = 256;

/// Binary digits of the sequence: more points than 2³² are never asked for.
const DIGITS: usize = 32;

/// Primitive polynomials and initial direction numbers: dimension, degree s, polynomial a, and m₁ … m_s (Joe, Kuo 2008,
/// new-joe-kuo-6, which minimizes the defects of two-dimensional projections).
const TABLE: &str = include_str!("design/new-joe-kuo-6.256.txt");

/// Direction numbers of every dimension, v₁ … v₃₂, the first digit in the highest bit.
static DIRECTIONS: LazyLock<Vec<[u32; DIGITS]>> = LazyLock::new(|| {
    let van_der_corput = std::array::from_fn(|digit| 1 << (DIGITS - 1 - digit));
    std::iter::once(van_der_corput).chain(TABLE.lines().skip(1).map(directions)).collect()
});

/// Direction numbers of one row of the table by the recurrence v_k = a₁ v_{k−1} ⊕ … ⊕ v_{k−s} ⊕ v_{k−s}/2^s (Bratley,
/// Fox 1988).
fn directions(row: &str) -> [u32; DIGITS] {
    let numbers: Vec<u32> = row.split_whitespace().map(|word| word.parse().expect("the table has numbers")).collect();
    let (polynomial, initial) = (numbers[2], &numbers[3..]);
    let degree = initial.len();
    let mut v = [0; DIGITS];
    for k in 0..DIGITS {
        if k < degree {
            v[k] = initial[k] << (DIGITS - 1 - k);
            continue;
        }
        v[k] = v[k - degree] ^ (v[k - degree] >> degree);
        for j in 1..degree {
            if (polynomial >> (degree - 1 - j)) & 1 == 1 {
                v[k] ^= v[k - j];
            }
        }
    }
    v
}

/// The first `samples` points.
fn sobol_points(factors: usize, samples: usize, seed: u64) -> Result<Vec<Vec<f64>>, Error> {
    ensure(factors <= MOST_FACTORS, || {
        format!("{factors} factors are more than the {MOST_FACTORS} of the Sobol' sequence")
    })?;
    // A key a factor, hashed: seeds and factors next to each other must not have related flips.
    let keys: Vec<u64> = (0..factors).map(|factor| mixed(mixed(seed) ^ factor as u64)).collect();
    // From index 0 on: scrambling moves its point off the corner, and the first 2^m points are a net only with it.
    let point = |index| {
        let coordinate = |(v, &key): (&[u32; DIGITS], &u64)| open_unit(scrambled(unscrambled(v, index), key));
        DIRECTIONS.iter().zip(&keys).map(coordinate).collect()
    };
    Ok((0..samples as u32).map(point).collect())
}

/// Digits of the point `index` of the sequence, the first in the highest bit.
fn unscrambled(directions: &[u32; DIGITS], index: u32) -> u32 {
    // In natural order instead of Gray's: any point by its index alone, so that a sweep may be shared and extended.
    directions.iter().enumerate().filter(|(digit, _)| (index >> digit) & 1 == 1).fold(0, |sum, (_, v)| sum ^ v)
}

/// Nested uniform scrambling (Owen 1995): a digit is flipped or not by a random bit that all digits before it choose.
///
/// The random bits are a hash of those digits and of `key`, so that a point depends on its index alone; all digits
/// beyond the 32 of the sequence are random.
fn scrambled(digits: u32, key: u64) -> u64 {
    let mut flipped = 0;
    for place in 0..DIGITS {
        // The digits before, with a one ahead that marks their number.
        // By the digits before any flip, as in Owen's scheme: flips of one place do not depend on those of others.
        let before = (1_u64 << place) | (u64::from(digits) >> (DIGITS - place));
        flipped |= ((mixed(key ^ mixed(before)) >> 63) as u32) << (DIGITS - 1 - place);
    }
    // Without digits beyond the 32, points would lie on a grid whose lower ends include 0.
    let beyond = mixed(key ^ mixed((1 << DIGITS) | u64::from(digits)));
    (u64::from(digits ^ flipped) << DIGITS) | (beyond >> DIGITS)
}

/// A bijective hash of 64 bits (SplitMix64; Steele, Lea, Flood 2014).
fn mixed(bits: u64) -> u64 {
    let mut z = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::E;

    /// The first points of the unscrambled sequence in natural order, as Joe and Kuo's own program prints them in the
    /// order of Gray's code, for the first three dimensions.
    #[test]
    fn the_sequence_starts_as_published() {
        let point = |index: u32| -> Vec<f64> {
            DIRECTIONS[..3].iter().map(|v| f64::from(unscrambled(v, index)) / 2.0_f64.powi(32)).collect()
        };
        let gray = |index: u32| index ^ (index >> 1);
        assert_eq!(point(gray(1)), [0.5, 0.5, 0.5]);
        assert_eq!(point(gray(2)), [0.75, 0.25, 0.25]);
        assert_eq!(point(gray(3)), [0.25, 0.75, 0.75]);
        assert_eq!(point(gray(4)), [0.375, 0.375, 0.625]);
        assert_eq!(point(gray(5)), [0.875, 0.875, 0.125]);
        assert_eq!(point(gray(6)), [0.625, 0.125, 0.875]);
    }

    /// Coordinates, in units of 2⁻³², of the points 1000 and 100 000 of SciPy 1.17.1, `qmc.Sobol(256, scramble=False,
    /// bits=32)`, in the dimensions 4, 11, 37, 101, 128, 201 and 256.
    #[test]
    fn another_implementation_gives_the_same_in_high_dimensions() {
        const DIMENSIONS: [usize; 7] = [3, 10, 36, 100, 127, 200, 255];
        const POINTS: [(u32, [u32; 7]); 2] = [
            (1000, [2906652672, 364904448, 3644850176, 3300917248, 2336227328, 3233808384, 1069547520]),
            (100_000, [2666364928, 1193771008, 344555520, 2059567104, 362512384, 3858464768, 3997335552]),
        ];
        for (index, expected) in POINTS {
            let gray = index ^ (index >> 1);
            assert_eq!(DIMENSIONS.map(|dimension| unscrambled(&DIRECTIONS[dimension], gray)), expected);
        }
        // All 256 coordinates of the second point, as one number.
        let all = DIRECTIONS.iter().map(|v| unscrambled(v, 100_000 ^ 50_000));
        let sum = all.fold(0_u64, |sum, x| sum.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(u64::from(x)));
        assert_eq!(sum, 2_956_943_609_472_417_792);
    }

    #[test]
    fn every_dimension_is_stratified_before_and_after_the_scrambling() {
        assert_eq!(DIRECTIONS.len(), MOST_FACTORS);
        for (dimension, v) in DIRECTIONS.iter().enumerate() {
            let stratum = |index| (scrambled(unscrambled(v, index), dimension as u64) >> 54) as usize;
            let mut counts = vec![0; 1024];
            (0..1024).for_each(|index| counts[stratum(index)] += 1);
            assert!(counts.iter().all(|&count| count == 1), "dimension {dimension}");
        }
    }

    /// A (0, m, 2)-net in base 2: of any shape of 256 equal boxes each holds one point.
    #[test]
    fn the_first_two_dimensions_fill_every_elementary_box() {
        let points = sobol_points(2, 256, 11).unwrap();
        for log_columns in 0..=8 {
            let (columns, rows) = (1 << log_columns, 1 << (8 - log_columns));
            let mut counts = vec![0; 256];
            for point in &points {
                let (column, row) = ((point[0] * columns as f64) as usize, (point[1] * rows as f64) as usize);
                counts[column * rows + row] += 1;
            }
            assert!(counts.iter().all(|&count| count == 1), "{columns} × {rows}");
        }
    }

    /// Root mean square error of the mean of a smooth function over seeds: it falls as n^−1.5, Monte Carlo's as n^−0.5.
    #[test]
    fn nested_scrambling_reaches_its_order() {
        let error = |samples: usize| {
            let squares = (0..64).map(|seed| {
                let points = sobol_points(4, samples, seed).unwrap();
                let product = |point: &Vec<f64>| point.iter().map(|x| 1.0 + (x.exp() + 1.0 - E) / 2.0).product::<f64>();
                let mean = points.iter().map(product).sum::<f64>() / samples as f64;
                (mean - 1.0) * (mean - 1.0)
            });
            (squares.sum::<f64>() / 64.0).sqrt()
        };
        let (coarse, fine) = (error(256), error(4096));
        let order = (coarse / fine).log2() / 4.0;
        println!("error {coarse:.2e} with 256 points, {fine:.2e} with 4096: order {order:.2}");
        assert!(order > 1.2, "{order}");
    }

    const ALL: [Method; 3] = [Method::LatinHypercube, Method::Sobol, Method::Random];
    const FREE: [Levels; 5] = [Levels::Continuous; 5];

    #[test]
    fn a_grid_has_every_combination_with_the_last_factor_fastest() {
        let grid = points(Method::Grid, &[Levels::Count(2), Levels::Count(3)], 0, 0).unwrap();
        let levels: Vec<Vec<usize>> = grid
            .iter()
            .map(|point| {
                let counts = [Levels::Count(2), Levels::Count(3)];
                point.iter().zip(counts).map(|(&u, levels)| levels.level(u).unwrap()).collect()
            })
            .collect();
        assert_eq!(levels, [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
        assert_eq!(grid[1], [0.25, 0.5]);
    }

    #[test]
    fn a_level_is_found_from_its_middle_whatever_their_number() {
        for count in 1..2000 {
            let levels = Levels::Count(count);
            let all = points(Method::Grid, &[levels], 0, 0).unwrap();
            assert!(all.iter().enumerate().all(|(level, point)| levels.level(point[0]) == Some(level)), "{count}");
        }
        assert_eq!(Levels::Continuous.level(0.5), None);
    }

    #[test]
    fn a_larger_study_keeps_the_points_of_the_smaller() {
        for method in [Method::Sobol, Method::Random] {
            let (small, large) = (points(method, &FREE, 37, 5).unwrap(), points(method, &FREE, 200, 5).unwrap());
            assert_eq!(small, large[..37], "{method:?}");
        }
    }

    #[test]
    fn the_seed_decides_the_points() {
        for method in ALL {
            assert_eq!(points(method, &FREE, 16, 3), points(method, &FREE, 16, 3));
            assert_ne!(points(method, &FREE, 16, 3), points(method, &FREE, 16, 4), "{method:?}");
        }
    }

    /// Bits that a study of today must still have in a year.
    #[test]
    fn a_seed_gives_the_same_points_in_every_version() {
        let bits = |method| points(method, &FREE, 3, 42).unwrap()[2][4].to_bits();
        assert_eq!(ALL.map(bits), FIRST);
    }

    const FIRST: [u64; 3] = [4_578_542_716_193_335_488, 4_598_575_190_982_179_910, 4_604_739_652_729_742_563];

    #[test]
    fn every_stratum_of_a_latin_hypercube_holds_one_point() {
        for samples in [1, 2, 10, 49, 1000] {
            let points = points(Method::LatinHypercube, &FREE, samples, 9).unwrap();
            for factor in 0..FREE.len() {
                let mut strata: Vec<usize> =
                    points.iter().map(|point| (point[factor] * samples as f64) as usize).collect();
                strata.sort_unstable();
                assert!(strata.into_iter().eq(0..samples), "{samples} samples, factor {factor}");
            }
        }
    }

    #[test]
    fn no_coordinate_is_zero_or_one() {
        for method in ALL {
            let points = points(method, &FREE, 20_000, 1).unwrap();
            assert!(points.iter().flatten().all(|&u| u > 0.0 && u < 1.0), "{method:?}");
        }
    }

    #[test]
    fn impossible_designs_are_refused() {
        use Levels::{Continuous, Count};
        for (method, factors, samples, expected) in [
            (Method::Sobol, &[][..], 4, "a design needs at least one factor"),
            (Method::Random, &FREE, 0, "a design needs at least one sample"),
            (Method::Random, &[Count(0)], 4, "factor 0 has no level"),
            (Method::Grid, &[Count(1000); 9], 4, &format!("the design has more than {MOST_POINTS} points")),
            (Method::Sobol, &[Continuous; 257], 4, "257 factors are more than the 256 of the Sobol' sequence"),
            (
                Method::Grid,
                &[Count(2), Continuous],
                4,
                "factor 1 is continuous; a grid needs a number of levels of every factor",
            ),
        ] {
            assert_eq!(points(method, factors, samples, 0), Err(Error::new(expected)));
        }
    }
}
