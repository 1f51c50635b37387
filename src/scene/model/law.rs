//! Laws of film that are not curves: hyperelastic, plastic, a Prony series at the film's temperature; rupture.

use super::Checker;
use crate::scenario::{self, Energy, HillRatios, Level, Moduli, Point, PronyOf, Shift};
use base::number::significant;
use base::units::{Pressure, Rate};
use lab::experiment::law_fit::hyperelastic::ENERGIES;
use membrane::material::{
    Arrhenius, CompressibleNeoHookean, Criterion, CurveError, Elastic, FlowCurve, FlowCurveError, FlowRate, Gent,
    Hardening, Hill, Hyperelastic, HyperelasticLaw, Law, Ogden, OgdenTerm, Plastic, Polynomial, PronyTerm, RateTable,
    RateTableError, Rupture, ShiftFactor, Viscosity, ViscosityError, Voce, Wlf, Written,
};

/// Keys of coefficients.
const COEFFICIENTS: [&str; 9] = ["mu", "alpha", "jm", "c10", "c01", "c20", "c30", "young", "poisson"];

/// The law written at `path`; none where it is invalid.
pub(super) fn check_hyperelastic(
    written: &scenario::Hyperelastic,
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<Law> {
    // Variants in the order of the table.
    let (_, law, own) = ENERGIES[written.law as usize];
    let has = format!("`{law}` has {}", own.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", "));
    for key in COEFFICIENTS {
        let place = format!("{path}.{key}");
        match (own.contains(&key), checker.is_written(&place)) {
            (true, false) => checker.missing(&place, &*has),
            (false, true) => checker.out_of_place(&place, &*has),
            _ => {}
        }
    }
    let wrinkling = written.wrinkling;
    Some(Law::Hyperelastic(match written.law {
        Energy::NeoHookean => {
            let mu = modulus(written.mu.as_ref()?, law, path, checker)?;
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling })
        }
        Energy::MooneyRivlin => {
            let [c10, c01] = [written.c10?.0, written.c01?.0];
            if c10 + c01 <= 0.0 {
                let message = "film of these coefficients has no stiffness: `c10` + `c01` is not above zero";
                return checker.refuse(&format!("{path}.c10"), message, "their sum is half the shear modulus at rest");
            }
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::mooney_rivlin(c10, c01), wrinkling })
        }
        Energy::Yeoh => {
            let [c10, c20, c30] = [written.c10?.0, written.c20?.0, written.c30?.0];
            if c10 <= 0.0 {
                let message = "film of these coefficients has no stiffness: `c10` is not above zero";
                return checker.refuse(&format!("{path}.c10"), message, "it is half the shear modulus at rest");
            }
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::yeoh([c10, c20, c30]), wrinkling })
        }
        Energy::Gent => {
            let mu = modulus(written.mu.as_ref()?, law, path, checker)?;
            HyperelasticLaw::Gent(Hyperelastic { energy: Gent { mu, jm: written.jm? }, wrinkling })
        }
        Energy::Ogden => {
            let energy = ogden(written.mu.as_ref()?, written.alpha.as_ref()?, path, checker)?;
            HyperelasticLaw::Ogden(Hyperelastic { energy, wrinkling })
        }
        Energy::CompressibleNeoHookean => {
            let energy = CompressibleNeoHookean { young: written.young?.0, poisson: written.poisson? };
            HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling })
        }
    }))
}

/// The one shear modulus of `law`, Pa.
fn modulus(written: &Moduli, law: &str, path: &str, checker: &mut Checker<'_>) -> Option<f64> {
    let path = format!("{path}.mu");
    match written {
        Moduli::One(Pressure(mu)) if *mu > 0.0 => Some(*mu),
        Moduli::One(_) => {
            let message = "film of this modulus has no stiffness: `mu` is not above zero";
            checker.refuse(&path, message, "it is the shear modulus at rest")
        }
        Moduli::Terms(_) => {
            checker.refuse(&path, format!("`{law}` has one modulus"), "only `ogden` has a list of moduli")
        }
    }
}

/// Ogden's energy, of which μ_k α_k must add up to a positive modulus.
fn ogden(mu: &Moduli, alpha: &[f64], path: &str, checker: &mut Checker<'_>) -> Option<Ogden> {
    let mu = match mu {
        Moduli::One(mu) => std::slice::from_ref(mu),
        Moduli::Terms(terms) => terms,
    };
    let [mu_path, alpha_path] = ["mu", "alpha"].map(|key| format!("{path}.{key}"));
    if mu.len() != alpha.len() {
        let message = format!("the numbers of exponents and moduli differ: {} and {}", alpha.len(), mu.len());
        checker.report_with(&alpha_path, message, "each term of `ogden` has one of both");
        checker.label(&mu_path, "the moduli");
        return None;
    }
    if let Some(zero) = alpha.iter().position(|alpha| *alpha == 0.0) {
        return checker.refuse(&format!("{alpha_path}.{zero}"), "an exponent is zero", "leave the term out");
    }
    if mu.len() > Ogden::TERMS {
        checker.report(&mu_path, format!("there are {} terms; the law has up to {}", mu.len(), Ogden::TERMS));
        return None;
    }
    let terms: Vec<OgdenTerm> = mu.iter().zip(alpha).map(|(mu, alpha)| OgdenTerm { mu: mu.0, alpha: *alpha }).collect();
    let energy = Ogden::new(&terms);
    if energy.shear_modulus() <= 0.0 {
        let message = "film of these terms has no stiffness: the sum of mu times alpha is not above zero";
        return checker.refuse(&mu_path, message, "a modulus has the sign of its exponent");
    }
    Some(energy)
}

/// The law written at `path`; none where it is invalid.
pub(super) fn check_plastic(written: &scenario::Plastic, path: &str, checker: &mut Checker<'_>) -> Option<Law> {
    let hill = match &written.hill {
        Some(ratios) => hill(ratios, &format!("{path}.hill"), checker),
        None => Some(Hill::default()),
    };
    let flow = flow(written, path, checker);
    let elastic = Elastic { young: written.young.0, poisson: written.poisson };
    let (hardening, rate) = flow?;
    Some(Law::Plastic(Plastic::new(elastic, hill?, hardening, rate)))
}

/// Hill's function. Which ratios are written was checked before.
fn hill(written: &HillRatios, path: &str, checker: &mut Checker<'_>) -> Option<Hill> {
    let HillRatios { r0, r45, r90, r11, r22, r33, r12 } = *written;
    let hill = match (r0, r11) {
        (Some(r0), _) => Hill::from_strain_ratios([r0, r45?, r90?]),
        (None, Some(r11)) => Hill::from_stress_ratios([r11, r22?, r33?], r12?),
        (None, None) => return None,
    };
    if !hill.is_closed() {
        let message = "the yield surface of these ratios is open: some stresses in the plane never make the film yield";
        return checker.refuse(path, message, "1/r11, 1/r22 and 1/r33 are to be sides of a triangle");
    }
    Some(hill)
}

/// Hardening and dependence on the rate.
fn flow(written: &scenario::Plastic, path: &str, checker: &mut Checker<'_>) -> Option<(Hardening, FlowRate)> {
    let place = format!("{path}.hardening");
    let hardening = &written.hardening;
    if let Some(points) = &hardening.curve {
        return Some((
            Hardening::Table(flow_curve(points, &format!("{place}.curve"), checker)?),
            FlowRate::Independent,
        ));
    }
    if let Some(scenario::Voce { initial, saturation, rate: approach }) = hardening.voce {
        if saturation.0 < initial.0 {
            let message = "the saturation is below the yield stress, so the flow stress would fall";
            checker.report_with(&format!("{place}.voce.saturation"), message, "film that softens has no law");
            checker.label(&format!("{place}.voce.yield"), "the yield stress");
            return None;
        }
        let voce = Voce { initial: initial.0, saturation: saturation.0, rate: approach };
        return Some((Hardening::Voce(voce), FlowRate::Independent));
    }
    flow_by_rate(hardening.rates.as_ref()?, &format!("{place}.rates"), checker)
}

fn flow_by_rate(
    written: &[scenario::FlowCurve],
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<(Hardening, FlowRate)> {
    let mut curves = Vec::with_capacity(written.len());
    for (index, scenario::FlowCurve { rate, curve }) in written.iter().enumerate() {
        curves.push(flow_curve(curve, &format!("{path}.{index}.curve"), checker).map(|curve| (rate.0, curve)));
    }
    match RateTable::new(curves.into_iter().collect::<Option<_>>()?) {
        Ok((slowest, table)) => return Some((Hardening::Table(slowest), FlowRate::Table(table))),
        Err(RateTableError::RateNotIncreasing { index, rate, previous }) => checker.report_with(
            &format!("{path}.{index}.rate"),
            "the rates do not increase",
            format!("{} follows {}; list the slowest first", Rate(rate), Rate(previous)),
        ),
        Err(RateTableError::StressFalls { index, strain }) => {
            let strain = significant(strain, 4);
            let message = format!("the flow stress falls with the rate at the plastic strain {strain}");
            checker.report_with(&format!("{path}.{index}"), message, "a curve lies nowhere below the slower ones");
        }
        // The number of curves was checked before.
        Err(RateTableError::TooShort) => {}
    }
    None
}

/// The flow curve through `points`.
fn flow_curve(points: &[Point], path: &str, checker: &mut Checker<'_>) -> Option<FlowCurve> {
    let pairs: Vec<[f64; 2]> = points.iter().map(|Point(strain, stress)| [*strain, stress.0]).collect();
    let place = |index: usize| format!("{path}.{index}");
    match FlowCurve::new(&pairs) {
        Ok(curve) => return Some(curve),
        Err(FlowCurveError::StartsLate { strain }) => {
            let message = format!("the flow curve starts at the plastic strain {}", significant(strain, 4));
            checker.report_with(&place(0), message, "its first point is the yield stress: [0, \"8 MPa\"]");
        }
        Err(FlowCurveError::NoStress) => {
            checker.report_with(&place(0), "film without yield stress", "its first point is the yield stress");
        }
        Err(FlowCurveError::Curve(CurveError::StrainNotIncreasing { index, strain, previous })) => {
            let hint = format!("{strain} follows {previous}");
            checker.report_with(&place(index), "the flow curve is not increasing in plastic strain", hint);
        }
        Err(FlowCurveError::Curve(CurveError::StressFalls { index, .. })) => {
            checker.report_with(&place(index), "the flow stress falls", "film that softens has no law");
        }
        Err(FlowCurveError::Curve(CurveError::NotFinite { index })) => {
            checker.report(&place(index), "this point of the flow curve is not finite");
        }
        // The number of points was checked before.
        Err(FlowCurveError::Empty | FlowCurveError::Curve(CurveError::TooShort)) => {}
    }
    None
}

/// The series written in the material at `path` on its law; none where there is none or it is invalid.
pub(super) fn check_viscosity(
    written: &scenario::Material,
    law: &Law,
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<Viscosity> {
    if written.prony.is_empty() {
        return None;
    }
    let of = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let place = of("prony");
    if law.viscous().is_none() {
        let message = "`prony` is not supported on this law";
        return checker.refuse(
            &place,
            message,
            "it needs curves that rise from the origin, or an elastic or hyperelastic law",
        );
    }
    let terms = written.prony.iter().map(|term| PronyTerm { share: term.share, time: term.time.0 }).collect();
    let viscosity = match Viscosity::new(terms) {
        Ok(viscosity) => viscosity,
        Err(ViscosityError::NothingLeft { sum }) => {
            let message =
                format!("the shares sum to {}, and film that has relaxed would carry nothing", significant(sum, 4));
            return checker.refuse(
                &place,
                message,
                "a share is that of the instantaneous stiffness; all sum to less than 1",
            );
        }
        // The ranges were checked before.
        Err(ViscosityError::Empty | ViscosityError::InvalidTerm { .. }) => return None,
    };
    let viscosity = viscosity.with_written(match written.prony_of.unwrap_or_default() {
        PronyOf::Instantaneous => Written::Instantaneous,
        PronyOf::LongTerm => Written::LongTerm,
    });
    shifted(viscosity, written, &of, checker)
}

/// The series at the temperature of the film.
fn shifted(
    viscosity: Viscosity,
    written: &scenario::Material,
    of: &dyn Fn(&str) -> String,
    checker: &mut Checker<'_>,
) -> Option<Viscosity> {
    let (temperature, shift) = match (written.temperature, written.shift) {
        (None, None) => return Some(viscosity),
        (Some(temperature), Some(shift)) => (temperature.0, shift),
        (Some(_), None) => {
            checker.out_of_place(&of("temperature"), "it needs `shift`, by which times change with temperature");
            return None;
        }
        (None, Some(_)) => {
            checker.missing(&of("temperature"), "that of the film, to which `shift` moves the relaxation times");
            return None;
        }
    };
    let factor = match shift {
        Shift::Wlf(wlf) => Wlf { c1: wlf.c1, c2: wlf.c2.0, reference: wlf.reference.0 }.factor_at(temperature),
        Shift::Arrhenius(arrhenius) => {
            Arrhenius { energy: arrhenius.energy.0, reference: arrhenius.reference.0 }.factor_at(temperature)
        }
    };
    let is_usable = |factor: &f64| {
        let time = |term: &PronyTerm| (term.time * factor).is_normal();
        viscosity.terms().iter().all(time)
    };
    let Some(factor) = factor.filter(is_usable) else {
        let message = "`shift` gives no relaxation times at this temperature";
        let hint = match shift {
            Shift::Wlf(wlf) => {
                let lowest = significant(wlf.reference.0 - wlf.c2.0, 4);
                format!("`wlf` has a pole at {lowest} K, `arrhenius` has none")
            }
            Shift::Arrhenius(_) => "it is too far from the reference".to_owned(),
        };
        return checker.refuse(&of("temperature"), message, hint);
    };
    Some(viscosity.shifted(factor))
}

/// The rupture of film with `law` written in the material at `path`; none where there is none or it is invalid.
pub(super) fn check_rupture(
    written: &scenario::Material,
    law: &Law,
    path: &str,
    checker: &mut Checker<'_>,
) -> Option<Rupture> {
    let rupture = written.rupture.as_ref()?;
    let place = if path.is_empty() { "rupture".to_owned() } else { format!("{path}.rupture") };
    let is_fabric = matches!(law, Law::Fabric(_) | Law::RateFabric(_));
    let criterion = match rupture.criterion {
        scenario::RuptureCriterion::Strain if is_fabric => Criterion::FibreStrain,
        scenario::RuptureCriterion::Strain => Criterion::Strain,
        scenario::RuptureCriterion::Stress => Criterion::Stress,
        scenario::RuptureCriterion::Energy => Criterion::Energy,
    };
    let (criterion, limit) = match rupture.limit {
        Some(Level::Quantity(_)) if matches!(criterion, Criterion::Strain | Criterion::FibreStrain) => {
            let message = "the limit of a strain is a number without unit";
            let hint =
                "write it like 1.2, for film that is 2.2 times as long; or use the criterion `stress` or `energy`";
            return checker.refuse(&format!("{place}.limit"), message, hint);
        }
        Some(limit) => (criterion, limit.value()),
        None if criterion == Criterion::FibreStrain => (Criterion::Break, 1.0),
        None => {
            let message = "a rupture criterion needs its limit";
            let hint = "give `limit`; a fabric with the criterion `strain` alone has that of its curves";
            return checker.refuse(&place, message, hint);
        }
    };
    let fracture_energy = rupture.energy.map_or(0.0, |energy| energy.0);
    Some(Rupture { criterion, limit, fracture_energy })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_have_the_names_of_their_rows() {
        for (row, law) in [
            Energy::NeoHookean,
            Energy::CompressibleNeoHookean,
            Energy::MooneyRivlin,
            Energy::Yeoh,
            Energy::Gent,
            Energy::Ogden,
        ]
        .into_iter()
        .enumerate()
        {
            assert_eq!((law as usize, serde_json::to_value(law).unwrap()), (row, ENERGIES[row].1.into()));
        }
    }
}
