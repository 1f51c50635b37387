//! Rigid motions: a rotation, then a translation.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A rigid motion x ↦ R x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// R.
    pub rotation: UnitQuaternion<f64>,
    /// t, m.
    pub translation: Vector3<f64>,
}

impl RigidMotion {
    /// The motion with a translation (m) after a rotation, an axis times an angle (rad).
    pub fn new(translation: [f64; 3], rotation: [f64; 3]) -> RigidMotion {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(rotation));
        RigidMotion { rotation, translation: translation.into() }
    }

    /// No motion.
    pub fn identity() -> RigidMotion {
        RigidMotion { rotation: UnitQuaternion::identity(), translation: Vector3::zeros() }
    }

    /// The image of a point.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(point) + self.translation).into()
    }

    /// The image of a vector.
    pub fn rotate(&self, vector: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(vector)).into()
    }

    /// The motion back.
    pub fn inverse(&self) -> RigidMotion {
        let rotation = self.rotation.inverse();
        RigidMotion { rotation, translation: rotation * -self.translation }
    }

    /// The rotation as an axis times an angle, rad.
    pub fn rotation_vector(&self) -> [f64; 3] {
        self.rotation.scaled_axis().into()
    }

    /// The motion that brings the first points of the `pairs` closest to the second, in least squares: the singular value
    /// decomposition of their covariance (Kabsch 1976; Umeyama 1991, equation 40). None where the points of either side lie
    /// on a line, which leaves a rotation about it open.
    pub fn of_pairs(pairs: &[[[f64; 3]; 2]]) -> Option<RigidMotion> {
        let mean = |side: usize| {
            pairs.iter().map(|pair| Vector3::from(pair[side])).sum::<Vector3<f64>>() / pairs.len().max(1) as f64
        };
        let (from, to) = (mean(0), mean(1));
        let covariance: Matrix3<f64> =
            pairs.iter().map(|[a, b]| (Vector3::from(*b) - to) * (Vector3::from(*a) - from).transpose()).sum();
        let svd = covariance.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        let [first, second] = [svd.singular_values[0], svd.singular_values[1]];
        if !(first.is_finite() && second > 1e-9 * first) {
            return None;
        }
        let sign = if (u.determinant() * v_t.determinant()) < 0.0 { -1.0 } else { 1.0 };
        let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        Some(RigidMotion { rotation, translation: to - rotation * from })
    }
}
