//! The break strains of single layers, which scatter about that of the material.

use serde::{Deserialize, Serialize};

/// Break strains of the layers over that of the material, equal for MD and TD (theory.md, equation 17b).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerBreaks {
    /// Ascending, positive, one a layer.
    factors: Vec<f64>,
}

impl Default for LayerBreaks {
    /// All layers break at the break strain of the material.
    fn default() -> LayerBreaks {
        LayerBreaks { factors: vec![1.0] }
    }
}

impl LayerBreaks {
    /// Break strains of the layers over that of the material, in any order; none where there is no layer or a factor is
    /// not positive and finite.
    pub fn new(mut factors: Vec<f64>) -> Option<LayerBreaks> {
        let is_valid = !factors.is_empty() && factors.iter().all(|factor| *factor > 0.0 && factor.is_finite());
        factors.sort_by(f64::total_cmp);
        is_valid.then_some(LayerBreaks { factors })
    }

    /// Break strain of the first layer to break, over that of the curve.
    #[inline(always)]
    pub(super) fn first(&self) -> f64 {
        self.factors[0]
    }

    /// Break strain of the last layer, over that of the curve.
    pub(super) fn last(&self) -> f64 {
        self.factors[self.factors.len() - 1]
    }

    /// Share of the layers that are not broken at `ratio` times the break strain of the first.
    pub(super) fn share_left(&self, ratio: f64) -> f64 {
        let broken = self.factors.partition_point(|factor| *factor < ratio * self.first());
        (self.factors.len() - broken) as f64 / self.factors.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_break_one_after_another() {
        let breaks = LayerBreaks::new(vec![1.1, 0.9, 1.0, 1.2]).unwrap();
        let left = [0.8, 0.9, 0.95, 1.05, 1.15, 1.25].map(|strain: f64| breaks.share_left(strain / 0.9));
        assert_eq!(left, [1.0, 1.0, 0.75, 0.5, 0.25, 0.0]);
        assert_eq!([0.5, 1.0, 1.5].map(|ratio| LayerBreaks::default().share_left(ratio)), [1.0, 1.0, 0.0]);
        for wrong in [vec![], vec![1.0, 0.0], vec![f64::NAN]] {
            assert_eq!(LayerBreaks::new(wrong), None);
        }
    }
}
