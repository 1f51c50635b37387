//! Hardening and Hill's ratios of film that yields, from coupons in several directions (theory.md, equations 268 to 270).

mod coupon;
mod fit;
mod voce;
mod warning;

pub use coupon::{CouponError, PlasticCoupon, PlasticDirection, PlasticDirectionError, TrueCurve};
pub use fit::{CouponQuality, PlasticFit, PlasticFitError, PlasticRules, Ratio};
pub use warning::{CODES, Warning};

use std::fmt;

/// The form of the hardening that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HardeningForm {
    /// Voce's law.
    Voce,
    /// A table that follows the mean of the coupons.
    Table,
}

impl HardeningForm {
    /// The words of all forms.
    pub const WORDS: &'static str = "plastic:voce or plastic:table";

    /// The form of a word.
    pub fn named(word: &str) -> Option<HardeningForm> {
        match word {
            "plastic:voce" => Some(HardeningForm::Voce),
            "plastic:table" => Some(HardeningForm::Table),
            _ => None,
        }
    }
}

impl fmt::Display for HardeningForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            HardeningForm::Voce => "plastic:voce",
            HardeningForm::Table => "plastic:table",
        })
    }
}
