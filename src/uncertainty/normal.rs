//! The standard normal distribution, exact in both tails, with the same bits on every machine.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Probability density at `z`.
pub fn density(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Φ: probability of at most `z`. That of more than `z` is `cumulative(-z)`, to the same relative error.
pub fn cumulative(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Φ⁻¹: the value of which `p` is the probability of at most that; −∞ at 0, ∞ at 1, no number outside.
///
/// Wichura 1988, algorithm AS 241, PPND16: relative error about 1e-16. For a probability near 1 use
/// `-quantile(1 - p)` where 1 − p is known.
pub fn quantile(p: f64) -> f64 {
    let from_median = p - 0.5;
    if from_median.abs() <= 0.425 {
        let r = 0.180625 - from_median * from_median;
        return from_median * ratio(&CENTRE, r);
    }
    let tail = if from_median < 0.0 { p } else { 1.0 - p };
    if tail <= 0.0 {
        return if tail == 0.0 { from_median.signum() * f64::INFINITY } else { f64::NAN };
    }
    let r = (-libm::log(tail)).sqrt();
    let distance = if r <= 5.0 { ratio(&NEAR_TAIL, r - 1.6) } else { ratio(&FAR_TAIL, r - 5.0) };
    if from_median < 0.0 { -distance } else { distance }
}

/// Coefficients of numerator and denominator, from the constant term on.
type Ratio = [[f64; 8]; 2];

fn ratio([numerator, denominator]: &Ratio, r: f64) -> f64 {
    let polynomial = |coefficients: &[f64; 8]| coefficients.iter().rev().fold(0.0, |sum, c| sum * r + c);
    polynomial(numerator) / polynomial(denominator)
}

const CENTRE: Ratio = [
    [
        3.387_132_872_796_366_5,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
];

const NEAR_TAIL: Ratio = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

const FAR_TAIL: Ratio = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;

    #[test]
    fn the_quantile_inverts_the_cumulative_function_from_the_far_tail_to_the_median() {
        let mut worst: f64 = 0.0;
        for step in 0..30_000 {
            let p = 10.0_f64.powf(-0.01 * f64::from(step)) * 0.5;
            worst = worst.max((cumulative(quantile(p)) / p - 1.0).abs());
        }
        // A value in the far tail, rounded to its 53 bits, has a probability that is off by |z²| units.
        println!("worst relative error of a probability down to 5e-301: {worst:.1e}");
        assert!(worst < 1e-12, "{worst:e}");
    }

    #[test]
    fn another_implementation_gives_the_same() {
        let normal = Normal::standard();
        for step in 1..1000 {
            let p = f64::from(step) / 1000.0;
            assert!((quantile(p) - normal.inverse_cdf(p)).abs() < 1e-14 * (1.0 + quantile(p).abs()), "{p}");
        }
        assert_eq!(quantile(0.5), 0.0);
        assert_eq!(quantile(0.0), f64::NEG_INFINITY);
        assert_eq!(quantile(1.0), f64::INFINITY);
        assert!(quantile(-0.1).is_nan() && quantile(1.1).is_nan() && quantile(f64::NAN).is_nan());
    }
}
