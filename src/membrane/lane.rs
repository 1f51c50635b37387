//! Arithmetic in lanes: the same operation on several elements side by side.
//!
//! Kernels are written as loops over lanes without branches, one loop a stage of the arithmetic;
//! the compiler turns each into vector instructions of whatever width it may use. Every lane runs
//! the same IEEE operations in the same order, so a result depends neither on that width nor on the number of lanes.

use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

/// Elements that a block of the engine holds.
pub const LANES: usize = 8;

/// One value for each of `L` elements.
pub type Lane<const L: usize = LANES> = [f64; L];

/// A lane that starts at a cache line: one that crossed two would take several times as long to store.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Stored<const L: usize>(pub Lane<L>);

impl<const L: usize> Deref for Stored<L> {
    type Target = Lane<L>;

    #[inline(always)]
    fn deref(&self) -> &Lane<L> {
        &self.0
    }
}

impl<const L: usize> DerefMut for Stored<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Lane<L> {
        &mut self.0
    }
}

/// Three Cartesian components of a vector in each lane.
pub type Lane3<const L: usize = LANES> = [Lane<L>; 3];

/// Vector instructions that a kernel is run with. The operations and their order are the same in all of them, and so
/// are the bits of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Width {
    /// Instructions that every processor of the platform has.
    #[serde(rename = "baseline")]
    Baseline,
    /// 256 bits.
    #[serde(rename = "AVX2")]
    Avx2,
    /// 512 bits.
    #[serde(rename = "AVX-512")]
    Avx512,
}

impl Width {
    /// The widest instructions that this processor has.
    pub fn best() -> Width {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
                return Width::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Width::Avx2;
            }
        }
        Width::Baseline
    }

    /// All that this processor has, narrowest first.
    pub fn available() -> impl Iterator<Item = Width> {
        [Width::Baseline, Width::Avx2, Width::Avx512].into_iter().filter(|width| width.supported() == *width)
    }

    /// These instructions, or the widest that this processor has where they are wider.
    #[inline]
    pub fn supported(self) -> Width {
        let best = Width::best();
        if self as u8 <= best as u8 { self } else { best }
    }
}

/// Defines a function whose first argument names the vector instructions for which its body is compiled: with
/// `up to AVX2` wider ones run that code too, since what is seldom called gains little by another copy of it.
///
/// The functions are `#[inline]` so that each is compiled in the unit of its caller, that of the law
/// (`engine::element::Grouped`), and an edit of a law compiles the kernels of that law alone. Tests call them from many
/// units, which share one copy.
#[macro_export]
macro_rules! at_width {
    (
        up to AVX2
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident[$($generics:tt)*]($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block
    ) => {
        $(#[$attribute])*
        #[cfg_attr(not(test), inline)]
        $visible fn $name<$($generics)*>(width: $crate::lane::Width, $($argument: $kind),*) $(-> $result)? {
            #[inline(always)]
            fn lanewise<$($generics)*>($($argument: $kind),*) $(-> $result)? $body
            $crate::lane::at_width! { Avx2 "avx2" width lanewise [$($generics)*] ($($argument: $kind),*) ($($result)?) }
            lanewise($($argument),*)
        }
    };
    (
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident[$($generics:tt)*]($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block
    ) => {
        $(#[$attribute])*
        #[cfg_attr(not(test), inline)]
        $visible fn $name<$($generics)*>(width: $crate::lane::Width, $($argument: $kind),*) $(-> $result)? {
            #[inline(always)]
            fn lanewise<$($generics)*>($($argument: $kind),*) $(-> $result)? $body
            $crate::lane::at_width! {
                Avx512 "avx512f,avx512dq" width lanewise [$($generics)*] ($($argument: $kind),*) ($($result)?)
            }
            $crate::lane::at_width! { Avx2 "avx2" width lanewise [$($generics)*] ($($argument: $kind),*) ($($result)?) }
            lanewise($($argument),*)
        }
    };
    (
        $at_least:ident $features:literal $width:ident $lanewise:ident
        [$($generics:tt)*] ($($argument:ident: $kind:ty),*) ($($result:ty)?)
    ) => {
        #[cfg(target_arch = "x86_64")]
        {
            #[cfg_attr(not(test), inline)]
            #[target_feature(enable = $features)]
            fn vectorised<$($generics)*>($($argument: $kind),*) $(-> $result)? {
                $lanewise($($argument),*)
            }
            if $width.supported() as u8 >= $crate::lane::Width::$at_least as u8 {
                // SAFETY: the processor was just seen to have these instructions or wider ones, which include them.
                return unsafe { vectorised($($argument),*) };
            }
        }
        let _ = $width;
    };
}
pub use at_width;

/// One value in every lane.
#[inline(always)]
pub const fn splat<const L: usize>(value: f64) -> Lane<L> {
    [value; L]
}

/// A value for each lane. An array's own `map` and `from_fn` are not for kernels: generic functions of another crate, they
/// are compiled in units of their own, and each lane would be a call.
#[inline(always)]
pub fn lanes<const L: usize>(value: impl Fn(usize) -> f64) -> Lane<L> {
    let mut out = splat(0.0);
    for l in 0..L {
        out[l] = value(l);
    }
    out
}

/// Scalar product in each lane.
#[inline(always)]
pub fn dot<const L: usize>(a: &Lane3<L>, b: &Lane3<L>) -> Lane<L> {
    let mut out = splat(0.0);
    for l in 0..L {
        out[l] = a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l];
    }
    out
}

/// Vector product in each lane.
#[inline(always)]
pub fn cross<const L: usize>(a: &Lane3<L>, b: &Lane3<L>) -> Lane3<L> {
    let mut out = [splat(0.0); 3];
    for (axis, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
        for l in 0..L {
            out[axis][l] = a[i][l] * b[j][l] - a[j][l] * b[i][l];
        }
    }
    out
}

/// The larger of two numbers, as one instruction: `b` where either is NaN.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, as one instruction: `b` where either is NaN.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Natural logarithm of a normal number above zero, within 3e-16 of itself or of one. Unlike that of the platform's
/// library it has the same bits on every machine, and a loop over lanes turns it into vector instructions.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    // x = 2ⁿ m with √½ ≤ m < √2, and ln m = 2 artanh t = 2t (1 + t²/3 + t⁴/5 + …) with |t| < 0.172: what is left out is
    // below 1e-18.
    const ROOT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    let exponent = (x.to_bits().wrapping_sub(ROOT_HALF) as i64) >> 52;
    let m = f64::from_bits(x.to_bits().wrapping_sub((exponent as u64) << 52));
    let t = (m - 1.0) / (m + 1.0);
    let square = t * t;
    let mut series = 1.0 / 21.0;
    for odd in [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        series = 1.0 / odd + square * series;
    }
    f64::from(exponent as i32) * std::f64::consts::LN_2 + 2.0 * t * series
}

/// Exponential function within 4e-16 of itself; below −708 and above 709 that of these bounds, NaN of NaN. Like [`ln`]
/// it has the same bits on every machine and turns into vector instructions.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    // x = n ln 2 + r with |r| ≤ ½ ln 2, and eˣ = 2ⁿ eʳ: of the series of eʳ what is left out is below 1e-17. Added to
    // 1.5·2⁵², a number is rounded to an integer, which the last bits of the sum hold.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    // In this order of arguments a NaN passes both.
    let x = smaller(709.0, larger(-708.0, x));
    let rounded = x * std::f64::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    // ln 2 in two parts, of which the first has zeros at its end: n times it is exact, and so is the difference.
    let r = (x - n * LN_2[0]) - n * LN_2[1];
    let mut series = 1.0 / 6_227_020_800.0;
    for factorial in
        [479_001_600.0, 39_916_800.0, 3_628_800.0, 362_880.0, 40_320.0, 5_040.0, 720.0, 120.0, 24.0, 6.0, 2.0]
    {
        series = 1.0 / factorial + r * series;
    }
    let scale = f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52);
    scale * (1.0 + (r + r * r * series))
}

#[cfg(test)]
mod tests {
    use super::{exp, ln};

    #[test]
    fn the_exponential_is_that_of_the_library() {
        for step in -70_790..70_890 {
            let x = 0.01 * f64::from(step) + 1e-5 * f64::from(step).sin();
            let expected = x.exp();
            assert!((exp(x) - expected).abs() <= 4e-16 * expected, "exp {x}: {} for {expected}", exp(x));
        }
        assert_eq!([exp(0.0), exp(f64::NEG_INFINITY), exp(f64::INFINITY)], [1.0, exp(-708.0), exp(709.0)]);
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn the_logarithm_is_that_of_the_library() {
        for step in -2000..2000 {
            let x = 1.07_f64.powi(step) * (1.0 + 1e-9 * f64::from(step));
            let expected = x.ln();
            assert!((ln(x) - expected).abs() <= 3e-16 * expected.abs().max(1.0), "ln {x}: {} for {expected}", ln(x));
        }
        assert_eq!(ln(1.0), 0.0);
    }
}
