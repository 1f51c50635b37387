//! The fit.

use thiserror::Error;

use super::voce::{self, Point};
use super::{CouponError, HardeningForm, PlasticCoupon, PlasticDirection, TrueCurve, Warning};
use crate::experiment::coupon::average::mean_of_means;
use base::number::significant;
use membrane::material::{FlowCurve, Hardening, Hill};

/// Points of each coupon's curve that a fit uses.
const POINTS: usize = 120;

/// Corners of a fitted table after the first.
const CORNERS: usize = 12;

/// How coupons are read into a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticRules {
    /// Form of the hardening.
    pub form: HardeningForm,
    /// Engineering strains between which the modulus is fitted.
    pub window: [f64; 2],
    /// Plastic strain from which on hardening is fitted; a table and Voce's law continue to zero.
    pub offset: f64,
}

/// Yield stress in a direction over that along MD.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Whether coupons of the direction were there; else it is assumed.
    pub measured: bool,
}

/// How the law follows one coupon, from its plastic strain at the offset to its largest stress.
#[derive(Clone, Debug, PartialEq)]
pub struct CouponQuality {
    /// Name of the coupon.
    pub name: String,
    /// Its direction.
    pub direction: PlasticDirection,
    /// Root mean square of the difference of nominal stresses, Pa.
    pub rms: f64,
    /// The largest difference, Pa.
    pub largest: f64,
    /// Largest nominal stress of the coupon, Pa.
    pub strength: f64,
}

/// A plastic law that was fitted to coupons.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticFit {
    /// Young's modulus, mean of the directions, Pa.
    pub young: f64,
    /// Flow stress along MD.
    pub hardening: Hardening,
    /// Yield stress in tension along TD, at 45°, and along the normal.
    pub ratios: [Ratio; 3],
    /// Equivalent plastic strain up to which coupons were measured.
    pub end: f64,
    /// Of each coupon, in the order given.
    pub coupons: Vec<CouponQuality>,
    /// Largest difference between coupons of one direction over their mean stress, by direction where there are several.
    pub scatter: Vec<(PlasticDirection, f64)>,
    /// Assumptions.
    pub warnings: Vec<Warning>,
}

/// Why there is no law.
#[derive(Debug, Error)]
pub enum PlasticFitError {
    /// A coupon cannot be used.
    #[error(transparent)]
    Coupon(#[from] CouponError),
    /// No coupon is along MD.
    #[error("no coupon is along MD, whose flow stress is that of the hardening")]
    NoMachineDirection,
    /// The coupons have no plastic strain in common.
    #[error("the coupons flow over no plastic strain in common, from {} on", significant(*offset, 3))]
    NothingInCommon {
        /// Plastic strain from which on they are read.
        offset: f64,
    },
    /// The moduli of the coupons have no mean.
    #[error("the moduli of the coupons have no mean")]
    NoModulus,
    /// The yield surface is open.
    #[error("the yield surface of the fitted ratios is open")]
    Open,
    /// No parameters fit.
    #[error("the fit of Voce's law does not converge")]
    NotConverged,
}

impl PlasticFit {
    /// The law of `coupons`.
    ///
    /// # Errors
    /// [`PlasticFitError`].
    pub fn from_coupons(coupons: &[PlasticCoupon], rules: &PlasticRules) -> Result<PlasticFit, PlasticFitError> {
        let along: Vec<Vec<usize>> = PlasticDirection::ALL
            .map(|direction| (0..coupons.len()).filter(|k| coupons[*k].direction == direction).collect())
            .to_vec();
        if along[0].is_empty() {
            return Err(PlasticFitError::NoMachineDirection);
        }
        let moduli = coupons.iter().map(|coupon| coupon.modulus(rules.window)).collect::<Result<Vec<_>, _>>()?;
        let groups: Vec<Vec<f64>> =
            along.iter().filter(|g| !g.is_empty()).map(|g| g.iter().map(|k| moduli[*k].0).collect()).collect();
        let young = mean_of_means(&groups).map_err(|_| PlasticFitError::NoModulus)?;
        let curves = coupons.iter().zip(&moduli).map(|(coupon, (_, curve))| {
            let flow = TrueCurve::from_engineering(curve, young, rules.offset, POINTS);
            flow.ok_or_else(|| CouponError::NoFlow { name: coupon.name.clone(), offset: rules.offset })
        });
        let curves = curves.collect::<Result<Vec<_>, _>>()?;
        let others: Vec<usize> = (1..4).filter(|place| !along[*place].is_empty()).collect();
        let (law, found) =
            voce::fit(&points(coupons, &curves, &along, &others), others.len()).ok_or(PlasticFitError::NotConverged)?;
        let ratios = [1, 2, 3].map(|place| match others.iter().position(|other| *other == place) {
            Some(k) => Ratio { value: found[k], measured: true },
            None => Ratio { value: 1.0, measured: false },
        });
        let ratio = |direction: PlasticDirection| ratio(&ratios, direction);
        let end = coupons.iter().zip(&curves).map(|(coupon, curve)| ratio(coupon.direction) * last(curve));
        let end = end.fold(f64::INFINITY, f64::min);
        let hardening = match rules.form {
            HardeningForm::Voce => Hardening::Voce(law),
            HardeningForm::Table => {
                let table = table(coupons, &curves, &ratios, end);
                Hardening::Table(table.ok_or(PlasticFitError::NothingInCommon { offset: rules.offset })?)
            }
        };
        let mut fit = PlasticFit { young, hardening, ratios, end, coupons: vec![], scatter: vec![], warnings: vec![] };
        if !fit.hill().is_closed() {
            return Err(PlasticFitError::Open);
        }
        fit.coupons = coupons.iter().zip(&curves).map(|(coupon, curve)| fit.quality(coupon, curve)).collect();
        fit.scatter = scatter(&along, &curves);
        fit.warnings = fit.warnings();
        Ok(fit)
    }

    /// Hill's function: R₁₁ = 1, R₂₂ and R₃₃ as fitted, and N from the yield stress at 45° (theory.md, equation 269).
    pub fn hill(&self) -> Hill {
        let [td, _, normal] = self.ratios.map(|ratio| ratio.value);
        Hill::from_stress_ratios([1.0, td, normal], self.shear_ratio())
    }

    /// R₁₂.
    pub fn shear_ratio(&self) -> f64 {
        let [td, diagonal, normal] = self.ratios;
        if !diagonal.measured {
            return 1.0;
        }
        let Hill { f, g, .. } = Hill::from_stress_ratios([1.0, td.value, normal.value], 1.0);
        let n = 2.0 / (diagonal.value * diagonal.value) - 0.5 * (f + g);
        (1.5 / n).sqrt()
    }

    /// Nominal stress (Pa) of the law in slow tension along `direction` at an engineering strain: ln(1 + e) = T/Y + E_p
    /// with T = R σ_y(R E_p).
    pub fn stress(&self, direction: PlasticDirection, strain: f64) -> f64 {
        let (ratio, total) = (ratio(&self.ratios, direction), strain.ln_1p());
        // Elastic stress falls with E_p and flow stress does not, so that they cross once; bisection also passes the
        // corners of a table, where Newton's method may cycle.
        let (mut low, mut high) = (0.0, total);
        for _ in 0..100 {
            let plastic = 0.5 * (low + high);
            let flow = ratio * self.hardening.stress(ratio * plastic);
            if self.young * (total - plastic) > flow { low = plastic } else { high = plastic }
        }
        self.young * (total - 0.5 * (low + high)) / (1.0 + strain)
    }

    fn quality(&self, coupon: &PlasticCoupon, curve: &TrueCurve) -> CouponQuality {
        let differences: Vec<f64> =
            curve.engineering.iter().map(|[e, stress]| self.stress(coupon.direction, *e) - stress).collect();
        CouponQuality {
            name: coupon.name.clone(),
            direction: coupon.direction,
            rms: (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt(),
            largest: differences.iter().fold(0.0, |most: f64, d| most.max(d.abs())),
            strength: curve.engineering.iter().fold(0.0, |most: f64, point| most.max(point[1])),
        }
    }

    fn warnings(&self) -> Vec<Warning> {
        use PlasticDirection::{Diagonal, Normal, Td};
        let assumed = self.ratios.iter().zip([("r22", Td), ("r12", Diagonal), ("r33", Normal)]);
        let assumed = assumed.filter(|(ratio, _)| !ratio.measured);
        let assumed = assumed.map(|(_, (key, direction))| Warning::RatioAssumed { key, direction });
        let widest = self.scatter.iter().map(|(_, scatter)| *scatter).fold(0.0, f64::max);
        let scatters = self.coupons.iter().filter_map(|coupon| {
            let difference = coupon.largest / coupon.strength;
            let is_beyond = widest > 0.0 && difference > widest;
            is_beyond.then(|| Warning::Scatters { name: coupon.name.clone(), difference, scatter: widest })
        });
        std::iter::once(Warning::UnloadingNotMeasured).chain(assumed).chain(scatters).collect()
    }
}

fn ratio(ratios: &[Ratio; 3], direction: PlasticDirection) -> f64 {
    match direction {
        PlasticDirection::Md => 1.0,
        PlasticDirection::Td => ratios[0].value,
        PlasticDirection::Diagonal => ratios[1].value,
        PlasticDirection::Normal => ratios[2].value,
    }
}

fn last(curve: &TrueCurve) -> f64 {
    curve.points.last().map_or(0.0, |point| point[0])
}

/// The points of all coupons: those of each direction weigh as much as those of another.
fn points(coupons: &[PlasticCoupon], curves: &[TrueCurve], along: &[Vec<usize>], others: &[usize]) -> Vec<Point> {
    let of_coupon = |(coupon, curve): (&PlasticCoupon, &TrueCurve)| {
        let place = PlasticDirection::ALL.iter().position(|direction| *direction == coupon.direction).unwrap_or(0);
        let ratio = others.iter().position(|other| *other == place);
        // A direction with more coupons, or a coupon with more points, must not decide the common law.
        let weight = 1.0 / (along[place].len() as f64 * curve.points.len() as f64).sqrt();
        let points =
            curve.points.iter().map(move |[strain, stress]| Point { ratio, strain: *strain, stress: *stress, weight });
        points.collect::<Vec<_>>()
    };
    coupons.iter().zip(curves).flat_map(of_coupon).collect()
}

/// The mean flow stress of all directions at the corners, which lie closer at small strain; it does not fall. None where
/// the coupons have no plastic strain in common.
fn table(coupons: &[PlasticCoupon], curves: &[TrueCurve], ratios: &[Ratio; 3], end: f64) -> Option<FlowCurve> {
    let mean = |p: f64| {
        let of_direction = |direction: &PlasticDirection| {
            let own = coupons.iter().zip(curves).filter(|(coupon, _)| coupon.direction == *direction);
            let ratio = ratio(ratios, *direction);
            let stresses: Vec<f64> = own.filter_map(|(_, curve)| Some(curve.stress_at(p / ratio)? / ratio)).collect();
            (!stresses.is_empty()).then(|| stresses.iter().sum::<f64>() / stresses.len() as f64)
        };
        let means: Vec<f64> = PlasticDirection::ALL.iter().filter_map(of_direction).collect();
        (!means.is_empty()).then(|| means.iter().sum::<f64>() / means.len() as f64)
    };
    // From where all coupons flow.
    let starts = coupons.iter().zip(curves).map(|(coupon, curve)| ratio(ratios, coupon.direction) * curve.points[0][0]);
    let start = starts.fold(0.0, f64::max);
    if !(start > 0.0 && end > start) {
        return None;
    }
    let at = |k: usize| start + (end - start) * (k as f64 / CORNERS as f64).powi(2);
    let measured: Vec<[f64; 2]> = (0..=CORNERS).filter_map(|k| Some([at(k), mean(at(k))?])).collect();
    let mut corners = vec![[0.0, first_stress(&measured)?]];
    for [p, stress] in measured {
        let below = corners[corners.len() - 1][1];
        corners.push([p, stress.max(below)]);
    }
    FlowCurve::new(&corners).ok()
}

/// Flow stress without plastic strain: back along the first piece, by at most a tenth of the stress there.
fn first_stress(measured: &[[f64; 2]]) -> Option<f64> {
    let [[p, stress], [q, next], ..] = measured else { return None };
    let slope = if q > p { (next - stress).max(0.0) / (q - p) } else { 0.0 };
    Some((stress - slope * p).max(0.9 * stress))
}

/// Largest difference of true stresses at one plastic strain over their mean, by direction.
fn scatter(along: &[Vec<usize>], curves: &[TrueCurve]) -> Vec<(PlasticDirection, f64)> {
    let of_direction = |(direction, own): (&PlasticDirection, &Vec<usize>)| {
        if own.len() < 2 {
            return None;
        }
        let spread = |p: f64| {
            let stresses: Vec<f64> = own.iter().filter_map(|k| curves[*k].stress_at(p)).collect();
            let (low, high) = stresses.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
            (stresses.len() > 1).then_some(2.0 * (high - low) / (high + low))
        };
        let strains = curves[own[0]].points.iter().map(|point| point[0]);
        Some((*direction, strains.filter_map(spread).fold(0.0, f64::max)))
    };
    PlasticDirection::ALL.iter().zip(along).filter_map(of_direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupon::Curve;
    use membrane::material::Voce;

    const RULES: PlasticRules = PlasticRules { form: HardeningForm::Voce, window: [0.001, 0.003], offset: 0.002 };

    /// Coupons of a known law: its parameters are found again, with coupons along MD alone all others are assumed.
    #[test]
    fn a_law_is_found_again() {
        let law = Voce { initial: 2.8e8, saturation: 3.6e8, rate: 14.0 };
        let ratios = [0.93, 0.97, 0.9].map(|value| Ratio { value, measured: true });
        let (hardening, young) = (Hardening::Voce(law), 7e10);
        let truth =
            PlasticFit { young, hardening, ratios, end: 1.0, coupons: vec![], scatter: vec![], warnings: vec![] };
        let coupon = |direction: PlasticDirection| {
            let strain: Vec<f64> = (0..=800).map(|k| 1e-4 * f64::from(k)).collect();
            let stress = strain.iter().map(|e| truth.stress(direction, *e)).collect();
            PlasticCoupon { name: direction.to_string(), direction, curve: Curve::new(strain, stress).unwrap() }
        };
        let all = PlasticDirection::ALL.map(coupon);
        let fit = PlasticFit::from_coupons(&all, &RULES).unwrap();
        let Hardening::Voce(found) = fit.hardening else { panic!("{:?}", fit.hardening) };
        // The slope of the window is that of nominal stress.
        assert!((fit.young / young - 1.0).abs() < 0.01, "{}", fit.young);
        for (found, expected) in
            [(found.initial, law.initial), (found.saturation, law.saturation), (found.rate, law.rate)]
        {
            assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        }
        for (found, expected) in fit.ratios.iter().zip(ratios) {
            assert!((found.value / expected.value - 1.0).abs() < 1e-3, "{found:?}");
        }
        assert!((fit.hill().stress_ratio(std::f64::consts::FRAC_PI_4) - fit.ratios[1].value).abs() < 1e-12);
        assert!(fit.coupons.iter().all(|coupon| coupon.largest < 2e-3 * coupon.strength), "{:?}", fit.coupons);
        let table = PlasticFit::from_coupons(&all, &PlasticRules { form: HardeningForm::Table, ..RULES }).unwrap();
        for direction in PlasticDirection::ALL {
            let plastic = |e: f64| e.ln_1p() - truth.stress(direction, e) * (1.0 + e) / young;
            // Beyond the shortest recording a table is constant.
            let is_within = |e: f64| plastic(e) >= RULES.offset && ratio(&ratios, direction) * plastic(e) <= table.end;
            let strains: Vec<f64> = (0..=800).map(|k| 1e-4 * f64::from(k)).filter(|e| is_within(*e)).collect();
            assert!(strains.len() > 500, "{direction}: {}", strains.len());
            for e in strains {
                let error = table.stress(direction, e) / truth.stress(direction, e) - 1.0;
                assert!(error.abs() < 4e-3, "{direction} at {e}: {error}");
            }
        }
        let alone = PlasticFit::from_coupons(&all[..1], &RULES).unwrap();
        let assumed = alone.warnings.iter().filter(|warning| matches!(warning, Warning::RatioAssumed { .. }));
        assert_eq!((alone.hill(), assumed.count()), (Hill::default(), 3));
        assert!(matches!(PlasticFit::from_coupons(&all[1..], &RULES), Err(PlasticFitError::NoMachineDirection)));
    }
}
