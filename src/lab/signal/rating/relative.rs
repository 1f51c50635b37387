//! A difference as a share.

/// |off|₁/|size|₁; infinite where only `size` is zero.
pub(super) fn relative(off: f64, size: f64) -> f64 {
    if off == 0.0 { 0.0 } else { off / size }
}
