//! The material file of a fit, with comments on what it was fitted to, how well, and what is missing.

use std::fmt::Write;

use crate::experiment::law_fit::hyperelastic::Energy;
use crate::experiment::law_fit::{Coefficient, LawFit, TestFit};
use crate::experiment::relaxation::PronyFit;
use base::finding::Finding;
use base::number::{plain, rounded, significant};

/// Significant digits of coefficients, whose errors compensate each other.
const DIGITS: usize = 9;

/// Significant digits of figures in comments.
const FIGURE: usize = 4;

/// Poisson's ratio of film where the user gives none: that of LDPE, assumed.
pub const ASSUMED_POISSON: f64 = 0.44;

/// Keys that a material file needs beside its law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmKeys {
    /// kg/m³.
    pub density: Option<f64>,
    /// Of one layer, m.
    pub thickness: Option<f64>,
}

impl FilmKeys {
    /// The keys that are not given, in words.
    pub fn missing(&self) -> Option<&'static str> {
        match (self.density, self.thickness) {
            (Some(_), Some(_)) => None,
            (None, Some(_)) => Some("`density`"),
            (Some(_), None) => Some("`thickness`"),
            (None, None) => Some("`density` and `thickness`"),
        }
    }

    fn lines(&self) -> String {
        let density = self.density.map_or_else(
            || "# density = \"…\"     # required, and was not given".to_owned(),
            |density| format!("density   = \"{} kg/m3\"", significant(density, FIGURE)),
        );
        let thickness = self.thickness.map_or_else(
            || "# thickness = \"…\"   # required, and was not given".to_owned(),
            |thickness| format!("thickness = \"{} um\"   # one layer", significant(thickness * 1e6, FIGURE)),
        );
        format!("\n{density}\n{thickness}\n")
    }
}

/// The material file of a fitted law.
pub fn law_text(fit: &LawFit, film: &FilmKeys) -> String {
    let mut text = format!("# Written by droptower: `{}` fitted to tests, {} residuals.\n", fit.choice, fit.weighting);
    let tests = fit.tests.iter().filter(|test| test.set.weight > 0.0);
    text.extend(tests.map(|test| format!("# Fitted to {}.\n", described(test))));
    text.extend(fit.predictions.iter().map(|test| format!("# Predicted: {}.\n", described(test))));
    let _ = writeln!(text, "# Stable up to the stretch {} (Hill's criterion).", significant(stable_to(fit), FIGURE));
    let findings = fit.warnings.iter().map(Finding::new).filter(Finding::is_warning);
    text.extend(findings.map(|finding| format!("# {finding}\n")));
    text.push_str(&film.lines());
    text.push_str(&hyperelastic(fit.choice, &fit.coefficients));
    text
}

/// The largest stretch up to which a law is stable, of those that are checked.
fn stable_to(fit: &LawFit) -> f64 {
    fit.unstable_from.map_or(fit.stable_to.max(10.0), |(_, stretch)| stretch)
}

fn described(test: &TestFit) -> String {
    let stretches = test.set.measured.stretches();
    let [low, high] = [f64::min, f64::max].map(|f| stretches.iter().copied().reduce(f).unwrap_or(f64::NAN));
    let mark = if test.set.is_virtual { ", VIRTUAL" } else { "" };
    format!(
        "{} ({}, stretches {} to {}{mark}): R2 {}, error {} MPa ({} %) rms, {} MPa at most",
        test.set.name.replace(char::is_control, " "),
        test.set.kind(),
        significant(low, FIGURE),
        significant(high, FIGURE),
        significant(test.quality.r_squared, 5),
        significant(test.quality.rms * 1e-6, 3),
        significant(test.quality.relative_rms * 100.0, 3),
        significant(test.quality.largest_error * 1e-6, 3),
    )
}

/// The table of the law.
fn hyperelastic(energy: Energy, coefficients: &[Coefficient]) -> String {
    let mut text = format!("\n[hyperelastic]\nlaw = \"{}\"\n", energy.law());
    if let Energy::Ogden { .. } = energy {
        let of = |is_modulus: bool| {
            let own = coefficients.iter().filter(move |coefficient| coefficient.is_modulus == is_modulus);
            own.map(written).collect::<Vec<_>>().join(", ")
        };
        let _ = writeln!(text, "mu = [{}]\nalpha = [{}]", of(true), of(false));
    } else {
        text.extend(coefficients.iter().map(|one| format!("{} = {}{}\n", one.name, written(one), error(one))));
    }
    text
}

/// A coefficient as a value of TOML.
fn written(coefficient: &Coefficient) -> String {
    if coefficient.is_modulus {
        format!("\"{} MPa\"", plain(rounded(coefficient.value * 1e-6, DIGITS)))
    } else {
        float(rounded(coefficient.value, DIGITS))
    }
}

/// A number with a point, as TOML writes one that need not be whole.
fn float(value: f64) -> String {
    let text = plain(value);
    if text.contains(['.', 'e']) { text } else { format!("{text}.0") }
}

fn error(coefficient: &Coefficient) -> String {
    let (factor, unit) = if coefficient.is_modulus { (1e-6, " MPa") } else { (1.0, "") };
    match coefficient.interval {
        Some([low, high]) if low.is_finite() && high.is_finite() => {
            format!("   # 95 %: {} to {}{unit}", significant(low * factor, FIGURE), significant(high * factor, FIGURE))
        }
        _ => String::new(),
    }
}

/// A relaxation as a material file: elastic film and its terms.
#[derive(Clone, Copy, Debug)]
pub struct RelaxationMaterial<'a> {
    /// The series.
    pub fit: &'a PronyFit,
    /// Where it comes from.
    pub source: &'a str,
    /// Poisson's ratio, where it is given.
    pub poisson: Option<f64>,
    /// The film's keys.
    pub film: FilmKeys,
}

/// The material file of a relaxation.
pub fn relaxation_text(material: &RelaxationMaterial<'_>) -> String {
    let RelaxationMaterial { fit, source, poisson, film } = material;
    let [first, last] =
        [fit.measured.first(), fit.measured.last()].map(|point| point.map_or(f64::NAN, |point| point[0]));
    let mut text = format!(
        "# Written by droptower from the relaxation modulus of {}: {} terms.\n\
         # Fitted to {} moduli from {} to {} s: R2 {}, error {} % rms, {} % at most.\n\
         # The instantaneous modulus is that of the series before the first measured time; {} MPa are left in the end.\n",
        source.replace(char::is_control, " "),
        fit.prony.terms.len(),
        fit.measured.len(),
        plain(rounded(first, FIGURE)),
        plain(rounded(last, FIGURE)),
        significant(fit.r_squared, 5),
        significant(fit.relative_rms * 100.0, 3),
        significant(fit.largest_error * 100.0, 3),
        significant(fit.prony.equilibrium() * 1e-6, FIGURE),
    );
    text.push_str(&film.lines());
    let _ = write!(
        text,
        "\n[elastic]\nyoung = \"{} MPa\"   # instantaneous\npoisson = {}\n",
        plain(rounded(fit.prony.instantaneous * 1e-6, DIGITS)),
        match poisson {
            Some(poisson) => float(*poisson),
            None => format!("{ASSUMED_POISSON}   # assumed, since none was given"),
        }
    );
    for term in &fit.prony.terms {
        let (share, time) = (float(rounded(term.share, DIGITS)), plain(rounded(term.time, DIGITS)));
        let _ = write!(text, "\n[[prony]]\nshare = {share}\ntime = \"{time} s\"\n");
    }
    text
}
