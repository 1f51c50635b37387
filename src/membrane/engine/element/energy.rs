//! Energies of elements.

/// Energies of elements, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementEnergy {
    /// Returned on unloading.
    pub stored: f64,
    /// Absorbed by the law.
    pub absorbed: f64,
    /// In the stabilisation against hourglass modes.
    pub hourglass: f64,
}

impl ElementEnergy {
    /// Adds those of other elements.
    pub fn add(&mut self, other: &ElementEnergy) {
        self.stored += other.stored;
        self.absorbed += other.absorbed;
        self.hourglass += other.hourglass;
    }

    /// Subtracts those of other elements.
    pub fn subtract(&mut self, other: &ElementEnergy) {
        self.stored -= other.stored;
        self.absorbed -= other.absorbed;
        self.hourglass -= other.hourglass;
    }
}
