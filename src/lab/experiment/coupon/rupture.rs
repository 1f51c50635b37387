use super::Curve;
use crate::error::{Error, refusal};

/// Share of the largest force below which a coupon counts as broken, by default.
pub const BREAK_SHARE: f64 = 0.5;

/// How and where a coupon's curve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rupture {
    /// Break elongation: engineering strain of the last sample before the force collapsed.
    pub strain: f64,
    /// Nominal stress there, Pa.
    pub stress: f64,
    /// Tensile strength: the largest nominal stress, Pa.
    pub strength: f64,
    /// Its end.
    pub ending: CurveEnd,
}

/// The end of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveEnd {
    /// The force fell below the share of its largest value.
    Broke,
    /// The recording ended under load.
    RecordEnded,
}

impl Curve {
    /// Where the coupon broke: from the first sample after the largest force that lies below `share` of it, back to
    /// where that fall began; the end of the record where there is none.
    pub fn rupture(&self, share: f64) -> Result<Rupture, Error> {
        if !(share > 0.0 && share < 1.0) {
            return Err(refusal!(
                "the share of the largest force at which a coupon is broken lies between 0 and 1, not at {share}"
            ));
        }
        let stress = self.stress();
        let peak = (0..stress.len()).max_by(|a, b| stress[*a].total_cmp(&stress[*b])).unwrap_or(0);
        if peak == 0 || stress[peak] <= 0.0 {
            return Err(refusal!("the force never rises: its largest value is the first"));
        }
        let collapsed = (peak..stress.len()).find(|i| stress[*i] < share * stress[peak]);
        let (last, ending) = match collapsed {
            Some(index) => (start_of_fall(stress, index), CurveEnd::Broke),
            None => (stress.len() - 1, CurveEnd::RecordEnded),
        };
        Ok(Rupture { strain: self.strain()[last], stress: stress[last], strength: stress[peak], ending })
    }
}

fn start_of_fall(stress: &[f64], from: usize) -> usize {
    (1..=from).rev().find(|i| stress[i - 1] <= stress[*i]).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(stress: &[f64]) -> Curve {
        Curve::new((0..stress.len()).map(|i| 0.1 * i as f64).collect(), stress.to_vec()).unwrap()
    }

    #[test]
    fn the_break_is_where_the_force_begins_to_fall() {
        let rupture = curve(&[0.0, 5.0, 9.0, 10.0, 6.0, 3.0, 0.1]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.strength, rupture.ending), (10.0, 10.0, CurveEnd::Broke));
        assert!((rupture.strain - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_yield_drop_is_no_break() {
        let rupture = curve(&[0.0, 10.0, 7.0, 7.5, 9.0, 0.2]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.strength), (9.0, 10.0));
    }

    #[test]
    fn a_record_may_end_before() {
        let rupture = curve(&[0.0, 5.0, 9.0]).rupture(BREAK_SHARE).unwrap();
        assert_eq!((rupture.stress, rupture.ending), (9.0, CurveEnd::RecordEnded));
    }

    #[test]
    fn a_force_that_never_rises_is_refused() {
        for (stress, share, expected) in [
            (&[3.0, 2.0, 1.0][..], BREAK_SHARE, "the force never rises"),
            (&[-3.0, -2.0, -1.0], BREAK_SHARE, "the force never rises"),
            (&[0.0, 1.0], 1.5, "the share of the largest force at which a coupon is broken"),
        ] {
            let error = curve(stress).rupture(share).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
