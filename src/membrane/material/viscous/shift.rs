//! Shift of relaxation times with temperature.

use serde::{Deserialize, Serialize};

/// Molar gas constant (CODATA 2018, exact), J/(mol K).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// log₁₀ a_T = −c₁ (T − T_r)/(c₂ + T − T_r) (Williams, Landel and Ferry, J. Am. Chem. Soc. 77, 1955; theory.md,
/// equation 287).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wlf {
    /// c₁.
    pub c1: f64,
    /// c₂, K.
    pub c2: f64,
    /// T_r, K.
    pub reference: f64,
}

/// ln a_T = E/R (1/T − 1/T_r) (theory.md, equation 287).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arrhenius {
    /// Activation energy E, J/mol.
    pub energy: f64,
    /// T_r, K.
    pub reference: f64,
}

/// A factor on relaxation times.
pub trait ShiftFactor {
    /// a_T at `temperature` (K): relaxation times there over those at the reference temperature; none where the
    /// equation has no value.
    fn factor_at(&self, temperature: f64) -> Option<f64>;
}

impl ShiftFactor for Wlf {
    fn factor_at(&self, temperature: f64) -> Option<f64> {
        let above = temperature - self.reference;
        let factor = 10.0_f64.powf(-self.c1 * above / (self.c2 + above));
        (self.c2 + above > 0.0 && factor.is_normal()).then_some(factor)
    }
}

impl ShiftFactor for Arrhenius {
    fn factor_at(&self, temperature: f64) -> Option<f64> {
        let factor = (self.energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / self.reference)).exp();
        factor.is_normal().then_some(factor)
    }
}
