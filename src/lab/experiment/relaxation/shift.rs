//! Laws of shift factors over temperature: Williams, Landel and Ferry's, and Arrhenius'.

use super::ShiftFactor;
use crate::experiment::descent::descend;

/// Molar gas constant, J/(mol K) (CODATA 2018, exact).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// log₁₀ a_T = −C₁ (T − T_r)/(C₂ + T − T_r) (Williams, Landel, Ferry, J. Am. Chem. Soc. 77, 1955).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wlf {
    /// C₁.
    pub c1: f64,
    /// C₂, K.
    pub c2: f64,
    /// T_r, K.
    pub reference: f64,
}

/// ln a_T = Q/R (1/T − 1/T_r).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrhenius {
    /// Q, the activation energy, J/mol.
    pub energy: f64,
    /// T_r, K.
    pub reference: f64,
}

/// A law of shift factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShiftLaw {
    /// Williams, Landel and Ferry's.
    Wlf(Wlf),
    /// Arrhenius'.
    Arrhenius(Arrhenius),
}

/// A law fitted to shift factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftLawFit {
    /// The law.
    pub law: ShiftLaw,
    /// Root mean square error of log₁₀ a_T, decades of time.
    pub rms: f64,
    /// Largest error of log₁₀ a_T.
    pub largest_error: f64,
    /// Temperature at which it is, K.
    pub at_temperature: f64,
}

/// Both laws fitted to the same factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftFits {
    /// None where no factor lies on either side so that both constants are determined.
    pub wlf: Option<ShiftLawFit>,
    /// None where all factors are at the reference.
    pub arrhenius: Option<ShiftLawFit>,
}

impl ShiftLaw {
    /// log₁₀ a_T at a temperature (K).
    pub fn log_shift(&self, temperature: f64) -> f64 {
        match self {
            ShiftLaw::Wlf(Wlf { c1, c2, reference }) => {
                -c1 * (temperature - reference) / (c2 + temperature - reference)
            }
            ShiftLaw::Arrhenius(Arrhenius { energy, reference }) => {
                energy / (GAS_CONSTANT * std::f64::consts::LN_10) * (1.0 / temperature - 1.0 / reference)
            }
        }
    }
}

impl ShiftFits {
    /// The law with the smaller error.
    pub fn better(&self) -> Option<&ShiftLawFit> {
        let fits = [self.wlf.as_ref(), self.arrhenius.as_ref()];
        fits.into_iter().flatten().min_by(|a, b| a.rms.total_cmp(&b.rms))
    }
}

/// Fits both laws to shift factors with the reference temperature (K).
pub fn fit_shift(factors: &[ShiftFactor], reference: f64) -> ShiftFits {
    ShiftFits {
        wlf: wlf(factors, reference).map(|law| compared(ShiftLaw::Wlf(law), factors)),
        arrhenius: arrhenius(factors, reference).map(|law| compared(ShiftLaw::Arrhenius(law), factors)),
    }
}

fn compared(law: ShiftLaw, factors: &[ShiftFactor]) -> ShiftLawFit {
    let error = |factor: &ShiftFactor| (law.log_shift(factor.temperature) - factor.log_shift).abs();
    let squares: f64 = factors.iter().map(|factor| error(factor).powi(2)).sum();
    let worst = factors.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
    ShiftLawFit {
        law,
        rms: (squares / factors.len() as f64).sqrt(),
        largest_error: worst.map_or(f64::NAN, error),
        at_temperature: worst.map_or(f64::NAN, |factor| factor.temperature),
    }
}

/// From several distances of the pole below the coldest factor, C₁ linear in each.
fn wlf(factors: &[ShiftFactor], reference: f64) -> Option<Wlf> {
    let away = |factor: &ShiftFactor| factor.temperature - reference;
    if factors.iter().filter(|factor| away(factor) != 0.0).count() < 2 {
        return None;
    }
    let coldest = factors.iter().map(|factor| -away(factor)).fold(0.0, f64::max);
    let of = |u: &[f64]| {
        let c2 = coldest + u[0].exp();
        let slope = |factor: &ShiftFactor| -away(factor) / (c2 + away(factor));
        let (along, square) = factors.iter().fold((0.0, 0.0), |(along, square), factor| {
            (along + slope(factor) * factor.log_shift, square + slope(factor).powi(2))
        });
        Wlf { c1: along / square, c2, reference }
    };
    let residuals = |u: &[f64]| -> Vec<f64> {
        let law = ShiftLaw::Wlf(of(u));
        factors.iter().map(|factor| law.log_shift(factor.temperature) - factor.log_shift).collect()
    };
    let found = [0.0, 2.0, 4.0, 6.0].map(|u| descend(vec![u], &residuals));
    let best = found.iter().min_by(|a, b| a.squares.total_cmp(&b.squares))?;
    Some(of(&best.unknowns)).filter(|law| law.c1.is_finite() && law.c2.is_finite() && law.c1 > 0.0)
}

fn arrhenius(factors: &[ShiftFactor], reference: f64) -> Option<Arrhenius> {
    let unit = ShiftLaw::Arrhenius(Arrhenius { energy: 1.0, reference });
    let (along, square) = factors.iter().fold((0.0, 0.0), |(along, square), factor| {
        let slope = unit.log_shift(factor.temperature);
        (along + slope * factor.log_shift, square + slope * slope)
    });
    (square > 0.0 && along > 0.0).then(|| Arrhenius { energy: along / square, reference })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factors(law: &ShiftLaw) -> Vec<ShiftFactor> {
        let temperatures = (0..12).map(|k| 263.15 + 10.0 * f64::from(k));
        temperatures.map(|temperature| ShiftFactor { temperature, log_shift: law.log_shift(temperature) }).collect()
    }

    #[test]
    fn known_laws_are_found_again() {
        let known = Wlf { c1: 17.44, c2: 51.6, reference: 293.15 };
        let found = fit_shift(&factors(&ShiftLaw::Wlf(known)), 293.15);
        let Some(ShiftLawFit { law: ShiftLaw::Wlf(wlf), rms, .. }) = found.wlf else { panic!("{found:?}") };
        assert!((wlf.c1 / 17.44 - 1.0).abs() < 1e-6 && (wlf.c2 / 51.6 - 1.0).abs() < 1e-6 && rms < 1e-6, "{found:?}");
        assert!(found.better().is_some_and(|best| best.law == ShiftLaw::Wlf(wlf)));
        let known = Arrhenius { energy: 1.2e5, reference: 293.15 };
        let found = fit_shift(&factors(&ShiftLaw::Arrhenius(known)), 293.15);
        let Some(ShiftLawFit { law: ShiftLaw::Arrhenius(law), rms, .. }) = found.arrhenius else { panic!("{found:?}") };
        assert!((law.energy / 1.2e5 - 1.0).abs() < 1e-12 && rms < 1e-12, "{found:?}");
    }

    /// ln a = Q/R (1/T − 1/T_r), by hand: 100 kJ/mol from 20 to 30 °C shift by 0.588 decades.
    #[test]
    fn an_activation_energy_shifts_by_so_many_decades() {
        let law = ShiftLaw::Arrhenius(Arrhenius { energy: 1e5, reference: 293.15 });
        assert!((law.log_shift(303.15) + 0.5877).abs() < 1e-3, "{}", law.log_shift(303.15));
        assert_eq!(law.log_shift(293.15), 0.0);
    }
}
