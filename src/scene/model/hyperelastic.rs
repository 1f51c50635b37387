//! `[specimen.material.hyperelastic]`: coefficients of a law that has a stiffness.

use super::ModelDiagnostics;
use crate::scenario::{self, Energy, Moduli};
use base::units::Pressure;
use membrane::material::{
    CompressibleNeoHookean, Gent, Hyperelastic, HyperelasticLaw, Law, Ogden, OgdenTerm, Polynomial,
};

/// Keys of coefficients, with whether they are written.
type Keys = [(&'static str, bool); 9];

/// The law written at `path`; none where it is invalid.
pub(super) fn check(written: &scenario::Hyperelastic, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<Law> {
    let own = keys(written.law);
    let keys: Keys = [
        ("mu", written.mu.is_some()),
        ("alpha", written.alpha.is_some()),
        ("jm", written.jm.is_some()),
        ("c10", written.c10.is_some()),
        ("c01", written.c01.is_some()),
        ("c20", written.c20.is_some()),
        ("c30", written.c30.is_some()),
        ("young", written.young.is_some()),
        ("poisson", written.poisson.is_some()),
    ];
    let law = word(written.law);
    let has = format!("`{law}` has {}", own.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", "));
    for (key, is_written) in keys {
        match (own.contains(&key), is_written) {
            (true, false) => mistakes.missing(&format!("{path}.{key}"), &*has),
            (false, true) => mistakes.out_of_place(&format!("{path}.{key}"), &*has),
            _ => {}
        }
    }
    let wrinkling = written.wrinkling;
    Some(Law::Hyperelastic(match written.law {
        Energy::NeoHookean => {
            let mu = modulus(written.mu.as_ref()?, law, path, mistakes)?;
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling })
        }
        Energy::MooneyRivlin => {
            let [c10, c01] = [written.c10?.0, written.c01?.0];
            if c10 + c01 <= 0.0 {
                let message = "film of these coefficients has no stiffness: `c10` + `c01` is not above zero";
                mistakes.report_with(&format!("{path}.c10"), message, "their sum is half the shear modulus at rest");
                return None;
            }
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::mooney_rivlin(c10, c01), wrinkling })
        }
        Energy::Yeoh => {
            let [c10, c20, c30] = [written.c10?.0, written.c20?.0, written.c30?.0];
            if c10 <= 0.0 {
                let message = "film of these coefficients has no stiffness: `c10` is not above zero";
                mistakes.report_with(&format!("{path}.c10"), message, "it is half the shear modulus at rest");
                return None;
            }
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::yeoh([c10, c20, c30]), wrinkling })
        }
        Energy::Gent => {
            let mu = modulus(written.mu.as_ref()?, law, path, mistakes)?;
            HyperelasticLaw::Gent(Hyperelastic { energy: Gent { mu, jm: written.jm? }, wrinkling })
        }
        Energy::Ogden => {
            let energy = ogden(written.mu.as_ref()?, written.alpha.as_ref()?, path, mistakes)?;
            HyperelasticLaw::Ogden(Hyperelastic { energy, wrinkling })
        }
        Energy::CompressibleNeoHookean => {
            let energy = CompressibleNeoHookean { young: written.young?.0, poisson: written.poisson? };
            HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling })
        }
    }))
}

/// Keys of the coefficients of a law.
fn keys(law: Energy) -> &'static [&'static str] {
    match law {
        Energy::NeoHookean => &["mu"],
        Energy::CompressibleNeoHookean => &["young", "poisson"],
        Energy::MooneyRivlin => &["c10", "c01"],
        Energy::Yeoh => &["c10", "c20", "c30"],
        Energy::Gent => &["mu", "jm"],
        Energy::Ogden => &["mu", "alpha"],
    }
}

fn word(law: Energy) -> &'static str {
    match law {
        Energy::NeoHookean => "neo-hookean",
        Energy::CompressibleNeoHookean => "compressible-neo-hookean",
        Energy::MooneyRivlin => "mooney-rivlin",
        Energy::Yeoh => "yeoh",
        Energy::Gent => "gent",
        Energy::Ogden => "ogden",
    }
}

/// The one shear modulus of `law`, Pa.
fn modulus(written: &Moduli, law: &str, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<f64> {
    let path = format!("{path}.mu");
    match written {
        Moduli::One(Pressure(mu)) if *mu > 0.0 => Some(*mu),
        Moduli::One(_) => {
            let message = "film of this modulus has no stiffness: `mu` is not above zero";
            mistakes.report_with(&path, message, "it is the shear modulus at rest");
            None
        }
        Moduli::Terms(_) => {
            mistakes.report_with(&path, format!("`{law}` has one modulus"), "only `ogden` has a list of moduli");
            None
        }
    }
}

/// Ogden's energy, of which μ_k α_k must add up to a positive modulus.
fn ogden(mu: &Moduli, alpha: &[f64], path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<Ogden> {
    let mu = match mu {
        Moduli::One(mu) => std::slice::from_ref(mu),
        Moduli::Terms(terms) => terms,
    };
    let [mu_path, alpha_path] = ["mu", "alpha"].map(|key| format!("{path}.{key}"));
    if mu.len() != alpha.len() {
        let message = format!("the numbers of exponents and moduli differ: {} and {}", alpha.len(), mu.len());
        mistakes.report_with(&alpha_path, message, "each term of `ogden` has one of both");
        mistakes.label(&mu_path, "the moduli");
        return None;
    }
    if let Some(zero) = alpha.iter().position(|alpha| *alpha == 0.0) {
        mistakes.report_with(&format!("{alpha_path}.{zero}"), "an exponent is zero", "leave the term out");
        return None;
    }
    if mu.len() > Ogden::TERMS {
        mistakes.report(&mu_path, format!("there are {} terms; the law has up to {}", mu.len(), Ogden::TERMS));
        return None;
    }
    let terms: Vec<OgdenTerm> = mu.iter().zip(alpha).map(|(mu, alpha)| OgdenTerm { mu: mu.0, alpha: *alpha }).collect();
    let energy = Ogden::new(&terms);
    if energy.shear_modulus() <= 0.0 {
        let message = "film of these terms has no stiffness: the sum of mu times alpha is not above zero";
        mistakes.report_with(&mu_path, message, "a modulus has the sign of its exponent");
        return None;
    }
    Some(energy)
}
