//! Random numbers of tests.

use nalgebra::Vector3;

/// Numbers between minus one and one, by a linear congruential generator.
pub(in crate::engine::film_contact) struct Numbers(u64);

impl Numbers {
    pub(in crate::engine::film_contact) fn new(seed: u64) -> Numbers {
        Numbers(seed)
    }

    pub(in crate::engine::film_contact) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    pub(in crate::engine::film_contact) fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }
}
