//! Numbers that are worked on together.
//!
//! Kernels are written as loops over lanes without branches, one loop a stage of the arithmetic;
//! the compiler turns each into vector instructions of whatever width it may use. Every lane runs
//! the same IEEE operations in the same order, so a result depends neither on that width nor on the number of lanes.

/// Elements that a block of the engine holds.
pub const LANES: usize = 8;

/// One value for each of `L` elements.
pub type Lane<const L: usize = LANES> = [f64; L];

/// Three Cartesian components of a vector in each lane.
pub type Lane3<const L: usize = LANES> = [Lane<L>; 3];

/// Vector instructions that a kernel is run with. The operations and their order are the same in all of them, and so are the
/// bits of what comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// What every processor of the platform has.
    Baseline,
    /// 256 bits.
    Avx2,
    /// 512 bits.
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
        let best = Width::best();
        [Width::Baseline, Width::Avx2, Width::Avx512].into_iter().filter(move |width| *width as u8 <= best as u8)
    }
}

/// Defines a function that runs `$lanewise`, an `#[inline(always)]` function of the same arguments, compiled for the vector
/// instructions that its first argument names.
macro_rules! at_width {
    (
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident[$($generics:tt)*]($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? = $lanewise:path
    ) => {
        $(#[$attribute])*
        $visible fn $name<$($generics)*>(width: $crate::lane::Width, $($argument: $kind),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512<$($generics)*>($($argument: $kind),*) $(-> $result)? {
                    $lanewise($($argument),*)
                }
                #[target_feature(enable = "avx2")]
                fn avx2<$($generics)*>($($argument: $kind),*) $(-> $result)? {
                    $lanewise($($argument),*)
                }
                // A width is only as wide as the processor is, so what is called here exists.
                let width = if width as u8 <= $crate::lane::Width::best() as u8 { width } else { $crate::lane::Width::best() };
                match width {
                    // SAFETY: the processor was just seen to have these instructions.
                    $crate::lane::Width::Avx512 => return unsafe { avx512($($argument),*) },
                    // SAFETY: as above.
                    $crate::lane::Width::Avx2 => return unsafe { avx2($($argument),*) },
                    $crate::lane::Width::Baseline => {}
                }
            }
            let _ = width;
            $lanewise($($argument),*)
        }
    };
}
pub(crate) use at_width;

/// The same value in every lane.
#[inline(always)]
pub const fn splat<const L: usize>(value: f64) -> Lane<L> {
    [value; L]
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
