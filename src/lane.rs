//! Eight numbers that are worked on together.
//!
//! Kernels are written as loops over lanes without branches, one loop a stage of the arithmetic;
//! the compiler turns each into vector instructions of whatever width it may use. Every lane runs
//! the same IEEE operations in the same order, so a result does not depend on that width.

/// Elements that a kernel works on at once.
pub const LANES: usize = 8;

/// One value for each of [`LANES`] elements.
pub type Lane = [f64; LANES];

/// Three Cartesian components of a vector in each lane.
pub type Lane3 = [Lane; 3];

/// The same value in every lane.
pub const fn splat(value: f64) -> Lane {
    [value; LANES]
}

/// Scalar product in each lane.
#[inline(always)]
pub fn dot(a: &Lane3, b: &Lane3) -> Lane {
    let mut out = splat(0.0);
    for l in 0..LANES {
        out[l] = a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l];
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
