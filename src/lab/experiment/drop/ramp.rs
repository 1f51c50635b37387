//! The gravity ramp: the parabolic decrease of the reading during the release, mirrored and added after contact
//! (Polymers 2021, 13, 1537, section 3.2).
//!
//! It replaces gravity in the reading of an accelerometer that reads zero in free fall. It repeats the shape of the
//! release and neglects the shift of the sensor's zero in the impact, −(1/τ)∫p dt.

use thiserror::Error;

use crate::experiment::fit::least_squares;
use crate::signal::Series;

/// The paper adds the ramp over the first 50 ms after contact.
pub const ADDED_OVER: f64 = 0.05;

/// A parabola that leaves zero, r = −depth (2s − s²) with s = (t − start)/duration, and ends at its vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityRamp {
    /// When the reading leaves zero, s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// m/s², positive.
    pub depth: f64,
}

/// Why the falling flank of a reading is no ramp.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RampError {
    /// Fewer samples than a parabola needs.
    #[error("acceleration: the reading between {from:.4} s and {to:.4} s has too few samples for the gravity ramp")]
    TooFew {
        /// Start of the falling flank, s.
        from: f64,
        /// End of the falling flank, s.
        to: f64,
    },
    /// The fitted parabola has no vertex at the end of the release.
    #[error("acceleration: the reading between {from:.4} s and {to:.4} s does not flatten out as a gravity ramp does")]
    NotParabolic {
        /// Start of the falling flank, s.
        from: f64,
        /// End of the falling flank, s.
        to: f64,
    },
}

impl GravityRamp {
    /// Fits the parabola to the flank of a `reading` (offset removed) between `from` and `to`, s.
    pub fn fit(reading: &Series, [from, to]: [f64; 2]) -> Result<GravityRamp, RampError> {
        let flank = reading.window([from, to]);
        // Time in lengths of the flank: columns of one magnitude.
        let length = to - from;
        let rows = flank.samples().map(|[t, r]| ((t - from) / length, r)).map(|(u, r)| ([1.0, u, u * u], r));
        let rows: Vec<_> = rows.collect();
        let ([c, b, a], _) = least_squares(rows.iter().copied()).ok_or(RampError::TooFew { from, to })?;
        let vertex = -b / (2.0 * a);
        let depth = a * vertex * vertex - c;
        // Only a flank that bends upward has its vertex at the bottom, where the magnet lets go.
        if a.is_nan() || a <= 0.0 || depth <= 0.0 || vertex <= 0.0 {
            return Err(RampError::NotParabolic { from, to });
        }
        // The parabola in the form a (u − vertex)² − depth, which is zero a width before its vertex.
        let width = (depth / a).sqrt();
        Ok(GravityRamp { start: from + length * (vertex - width), duration: length * width, depth })
    }

    /// Reading of the release at time `t` (s): zero before it, −depth from its vertex on.
    pub fn reading_at(&self, t: f64) -> f64 {
        let s = ((t - self.start) / self.duration).clamp(0.0, 1.0);
        -self.depth * (2.0 * s - s * s)
    }

    /// Correction at time `t` (s) where contact was at `contact` (s): −depth up to contact, then the release
    /// mirrored, back to zero after its duration or after [`ADDED_OVER`].
    pub fn mirrored(&self, t: f64, contact: f64) -> f64 {
        let since = (t - contact).max(0.0);
        if since > ADDED_OVER { 0.0 } else { self.reading_at(self.start + self.duration - since) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: GravityRamp = GravityRamp { start: 0.1503, duration: 0.032, depth: 8.7 };

    fn reading() -> Series {
        let time: Vec<f64> = (0..4000).map(|i| 1e-4 * f64::from(i)).collect();
        let values: Vec<f64> = time.iter().map(|t| RAMP.reading_at(*t)).collect();
        Series::new(time, values)
    }

    #[test]
    fn a_parabola_is_fitted_exactly() {
        let found = GravityRamp::fit(&reading(), [0.152, 0.178]).unwrap();
        assert!((found.start - RAMP.start).abs() < 1e-9);
        assert!((found.duration - RAMP.duration).abs() < 1e-9);
        assert!((found.depth - RAMP.depth).abs() < 1e-9);
    }

    #[test]
    fn the_mirror_runs_from_minus_the_depth_to_zero() {
        let contact = 0.6;
        assert_eq!(RAMP.mirrored(0.5, contact), -8.7);
        assert_eq!(RAMP.mirrored(contact, contact), -8.7);
        for share in [0.25, 0.5, 0.75] {
            let mirrored = RAMP.mirrored(contact + share * RAMP.duration, contact);
            assert!((mirrored - RAMP.reading_at(RAMP.start + (1.0 - share) * RAMP.duration)).abs() < 1e-9);
        }
        assert!(RAMP.mirrored(contact + RAMP.duration, contact).abs() < 1e-9);
        let slow = GravityRamp { duration: 0.2, ..RAMP };
        assert_eq!(slow.mirrored(contact + 0.0501, contact), 0.0);
    }

    #[test]
    fn a_reading_without_vertex_is_not_a_ramp() {
        let falling = reading().with_values(reading().samples().map(|[t, _]| -100.0 * t * t).collect());
        assert!(matches!(GravityRamp::fit(&falling, [0.1, 0.2]), Err(RampError::NotParabolic { .. })));
        assert!(matches!(GravityRamp::fit(&falling, [0.9, 0.95]), Err(RampError::TooFew { .. })));
    }
}
