//! Arithmetic in lanes: the same operation on several elements side by side.
//!
//! A kernel reads as its equation: [`Lane`] has the operators of a number, and a comparison gives a [`Mask`] that selects
//! between two values instead of a branch. Each operation is a loop over an array, which the compiler turns into vector
//! instructions of whatever width it may use. Functions of kernels are `#[inline(always)]`; closures over lanes and an array's
//! own `map` may be compiled apart, without these instructions. Every lane runs the same IEEE operations in the same order, so
//! a result depends neither on that width nor on the number of lanes.

use std::ops::{
    Add, AddAssign, BitAnd, BitOr, Deref, DerefMut, Div, DivAssign, Mul, MulAssign, Neg, Not, Sub, SubAssign,
};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Elements that a block of the engine holds.
pub const LANES: usize = 8;

/// One value for each of `L` elements. It starts at a cache line: one that crossed two would take several times as long to
/// store.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lane<const L: usize = LANES>([f64; L]);

/// Whether something holds in each of `L` lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mask<const L: usize = LANES>([bool; L]);

impl<const L: usize> Default for Lane<L> {
    fn default() -> Lane<L> {
        splat(0.0)
    }
}

impl<const L: usize> Deref for Lane<L> {
    type Target = [f64; L];

    #[inline(always)]
    fn deref(&self) -> &[f64; L] {
        &self.0
    }
}

impl<const L: usize> DerefMut for Lane<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64; L] {
        &mut self.0
    }
}

impl<const L: usize> From<f64> for Lane<L> {
    #[inline(always)]
    fn from(value: f64) -> Lane<L> {
        splat(value)
    }
}

/// A value for each lane, by a plain loop over them: a closure may be compiled apart, without the vector instructions.
macro_rules! each {
    ($like:expr; $l:ident => $value:expr) => {{
        let mut out = $like;
        for $l in 0..L {
            out.0[$l] = $value;
        }
        out
    }};
}

/// An operator of numbers for lanes with lanes, lanes with a number, and a number with lanes.
macro_rules! operators {
    ($($trait:ident $function:ident, $assign:ident $in_place:ident: $operator:tt;)*) => {$(
        impl<const L: usize> $trait for Lane<L> {
            type Output = Lane<L>;

            #[inline(always)]
            fn $function(self, other: Lane<L>) -> Lane<L> {
                each!(self; l => self.0[l] $operator other.0[l])
            }
        }

        impl<const L: usize> $trait<f64> for Lane<L> {
            type Output = Lane<L>;

            #[inline(always)]
            fn $function(self, other: f64) -> Lane<L> {
                each!(self; l => self.0[l] $operator other)
            }
        }

        impl<const L: usize> $trait<Lane<L>> for f64 {
            type Output = Lane<L>;

            #[inline(always)]
            fn $function(self, other: Lane<L>) -> Lane<L> {
                each!(other; l => self $operator other.0[l])
            }
        }

        impl<const L: usize, Other> $assign<Other> for Lane<L>
        where
            Lane<L>: $trait<Other, Output = Lane<L>>,
        {
            #[inline(always)]
            fn $in_place(&mut self, other: Other) {
                *self = *self $operator other;
            }
        }
    )*};
}
operators! {
    Add add, AddAssign add_assign: +;
    Sub sub, SubAssign sub_assign: -;
    Mul mul, MulAssign mul_assign: *;
    Div div, DivAssign div_assign: /;
}

impl<const L: usize> Neg for Lane<L> {
    type Output = Lane<L>;

    #[inline(always)]
    fn neg(self) -> Lane<L> {
        each!(self; l => -self[l])
    }
}

impl<const L: usize> Lane<L> {
    /// Square root in each lane.
    #[inline(always)]
    pub fn sqrt(self) -> Lane<L> {
        each!(self; l => self[l].sqrt())
    }

    /// Size in each lane.
    #[inline(always)]
    pub fn abs(self) -> Lane<L> {
        each!(self; l => self[l].abs())
    }

    /// Its size with the sign of `sign`, in each lane.
    #[inline(always)]
    pub fn copysign(self, sign: Lane<L>) -> Lane<L> {
        each!(self; l => self[l].copysign(sign[l]))
    }

    /// Natural logarithm in each lane, of normal numbers above zero; of others, NaN too, any number: [`ln`].
    #[inline(always)]
    pub fn ln(self) -> Lane<L> {
        each!(self; l => ln(self[l]))
    }

    /// Exponential function in each lane: [`exp`].
    #[inline(always)]
    pub fn exp(self) -> Lane<L> {
        each!(self; l => exp(self[l]))
    }

    /// The larger in each lane; `other` where either is NaN.
    #[inline(always)]
    pub fn max(self, other: impl Into<Lane<L>>) -> Lane<L> {
        let other = other.into();
        each!(self; l => larger(self[l], other[l]))
    }

    /// The smaller in each lane; `other` where either is NaN.
    #[inline(always)]
    pub fn min(self, other: impl Into<Lane<L>>) -> Lane<L> {
        let other = other.into();
        each!(self; l => smaller(self[l], other[l]))
    }

    /// Where it is below the other. No comparison holds where either is NaN, so its `!` does.
    #[inline(always)]
    pub fn below(self, other: impl Into<Lane<L>>) -> Mask<L> {
        let other = other.into();
        each!(Mask([false; L]); l => self[l] < other[l])
    }

    /// Where it is above the other.
    #[inline(always)]
    pub fn above(self, other: impl Into<Lane<L>>) -> Mask<L> {
        let other = other.into();
        each!(Mask([false; L]); l => self[l] > other[l])
    }

    /// Where it is below the other or equals it.
    #[inline(always)]
    pub fn at_most(self, other: impl Into<Lane<L>>) -> Mask<L> {
        let other = other.into();
        each!(Mask([false; L]); l => self[l] <= other[l])
    }

    /// Where it is above the other or equals it.
    #[inline(always)]
    pub fn at_least(self, other: impl Into<Lane<L>>) -> Mask<L> {
        let other = other.into();
        each!(Mask([false; L]); l => self[l] >= other[l])
    }

    /// Where it equals the other.
    #[inline(always)]
    pub fn equals(self, other: impl Into<Lane<L>>) -> Mask<L> {
        let other = other.into();
        each!(Mask([false; L]); l => self[l] == other[l])
    }

    /// Where it is NaN.
    #[inline(always)]
    pub fn is_nan(self) -> Mask<L> {
        each!(Mask([false; L]); l => self[l].is_nan())
    }
}

impl<const L: usize> Default for Mask<L> {
    /// It holds in no lane.
    fn default() -> Mask<L> {
        Mask([false; L])
    }
}

impl<const L: usize> Mask<L> {
    /// It holds in the first lanes, so many.
    #[inline(always)]
    pub fn first(count: usize) -> Mask<L> {
        each!(Mask([false; L]); l => l < count)
    }

    /// Whether it holds in a lane.
    #[inline(always)]
    pub fn holds(&self, lane: usize) -> bool {
        self.0[lane]
    }

    /// The lanes in which it holds.
    #[inline(always)]
    pub fn lanes(self) -> impl Iterator<Item = usize> {
        (0..L).filter(move |lane| self.0[*lane])
    }

    /// `yes` where it holds, else `no`: without a branch, both are computed.
    #[inline(always)]
    pub fn select(self, yes: impl Into<Lane<L>>, no: impl Into<Lane<L>>) -> Lane<L> {
        let (yes, no) = (yes.into(), no.into());
        each!(yes; l => if self.0[l] { yes[l] } else { no[l] })
    }

    /// Whether it holds in any lane.
    #[inline(always)]
    pub fn any(self) -> bool {
        let mut any = false;
        for l in 0..L {
            any |= self.0[l];
        }
        any
    }

    /// Whether it holds in every lane.
    #[inline(always)]
    pub fn all(self) -> bool {
        !(!self).any()
    }
}

impl<const L: usize> BitAnd for Mask<L> {
    type Output = Mask<L>;

    #[inline(always)]
    fn bitand(self, other: Mask<L>) -> Mask<L> {
        each!(Mask([false; L]); l => self.0[l] & other.0[l])
    }
}

impl<const L: usize> BitOr for Mask<L> {
    type Output = Mask<L>;

    #[inline(always)]
    fn bitor(self, other: Mask<L>) -> Mask<L> {
        each!(Mask([false; L]); l => self.0[l] | other.0[l])
    }
}

impl<const L: usize> Not for Mask<L> {
    type Output = Mask<L>;

    #[inline(always)]
    fn not(self) -> Mask<L> {
        each!(Mask([false; L]); l => !self.0[l])
    }
}

/// Three Cartesian components of a vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lane3<const L: usize = LANES>(pub [Lane<L>; 3]);

impl<const L: usize> Deref for Lane3<L> {
    type Target = [Lane<L>; 3];

    #[inline(always)]
    fn deref(&self) -> &[Lane<L>; 3] {
        &self.0
    }
}

impl<const L: usize> DerefMut for Lane3<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [Lane<L>; 3] {
        &mut self.0
    }
}

impl<const L: usize> Default for Lane3<L> {
    #[inline(always)]
    fn default() -> Lane3<L> {
        Lane3::ZERO
    }
}

impl<const L: usize> Lane3<L> {
    /// Zero in each lane.
    pub const ZERO: Lane3<L> = Lane3([splat(0.0); 3]);

    /// One vector in every lane.
    #[inline(always)]
    pub fn splat(vector: impl Into<[f64; 3]>) -> Lane3<L> {
        let [x, y, z] = vector.into();
        Lane3([splat(x), splat(y), splat(z)])
    }

    /// The vector in a lane.
    #[inline(always)]
    pub fn vector(&self, lane: usize) -> Vector3<f64> {
        Vector3::new(self[0][lane], self[1][lane], self[2][lane])
    }

    /// Replaces the vector in a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, vector: &Vector3<f64>) {
        for axis in 0..3 {
            self[axis][lane] = vector[axis];
        }
    }
}

/// An operator of vectors, component by component, with vectors; and of what all components share, with a vector.
macro_rules! operators_of_vectors {
    ($($trait:ident $function:ident, $assign:ident $in_place:ident: $operator:tt),*; scaled by $($factor:ty),*) => {
        $(
            impl<const L: usize> $trait for Lane3<L> {
                type Output = Lane3<L>;

                #[inline(always)]
                fn $function(mut self, other: Lane3<L>) -> Lane3<L> {
                    self $operator other;
                    self
                }
            }

            impl<const L: usize> $assign for Lane3<L> {
                #[inline(always)]
                fn $in_place(&mut self, other: Lane3<L>) {
                    for axis in 0..3 {
                        self.0[axis] $operator other.0[axis];
                    }
                }
            }
        )*
        $(
            impl<const L: usize> Mul<Lane3<L>> for $factor {
                type Output = Lane3<L>;

                #[inline(always)]
                fn mul(self, mut vector: Lane3<L>) -> Lane3<L> {
                    for axis in 0..3 {
                        vector.0[axis] = self * vector.0[axis];
                    }
                    vector
                }
            }
        )*
    };
}
operators_of_vectors! {
    Add add, AddAssign add_assign: +=,
    Sub sub, SubAssign sub_assign: -=;
    scaled by f64, Lane<L>
}

impl<const L: usize> Neg for Lane3<L> {
    type Output = Lane3<L>;

    #[inline(always)]
    fn neg(mut self) -> Lane3<L> {
        for axis in 0..3 {
            self.0[axis] = -self.0[axis];
        }
        self
    }
}

/// Vector instructions that a kernel is run with. The operations and their order are the same in all of them, and so
/// are the bits of the results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Width {
    /// Instructions that every processor of the platform has.
    #[default]
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
    Lane([value; L])
}

/// One value in a single lane, for what asks a law for one point.
#[inline(always)]
pub const fn one(value: f64) -> Lane<1> {
    splat(value)
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
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product in each lane.
#[inline(always)]
pub fn cross<const L: usize>(a: &Lane3<L>, b: &Lane3<L>) -> Lane3<L> {
    Lane3([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
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

/// n of x = 2ⁿ m with √½ ≤ m < √2, by integer instructions, in all lanes alike: subtracting √½ before the shift rounds to
/// the nearest power.
#[inline(always)]
pub(crate) fn exponent(x: f64) -> i64 {
    const ROOT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    (x.to_bits().wrapping_sub(ROOT_HALF) as i64) >> 52
}

/// Natural logarithm of a normal number above zero, within 3e-16 of itself or of one. Unlike that of the platform's
/// library it has the same bits on every machine, and a loop over lanes turns it into vector instructions.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    // x = 2ⁿ m, and ln m = 2 artanh t = 2t (1 + t²/3 + t⁴/5 + …) with |t| < 0.172: what is left out is below 1e-18.
    let exponent = exponent(x);
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
