//! Cards of Abaqus and of CalculiX, whose keywords are the same where it has them: `*MATERIAL` with what follows.
//!
//! Of a line of data at most eight values. Stresses and curves of fabric: nominal, the stress first, as connectors have their force
//! before the motion (Keywords Reference 2017, *UNLOADING DATA); of fabric itself that is from memory.

use super::film::{Draft, Terms, along_md, bulk_modulus, energy, lost_hill, shear_modulus};
use super::layout::in_twenty;
use super::loss::Loss;
use super::target::Target;
use base::diagnostic::Diagnostic;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic, Polynomial, Viscosity};

/// Values of a line of data.
const MOST: usize = 8;

/// The card without its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    let law = &draft.film.material.law;
    let law = match (draft.linear(law), law) {
        (Some(elastic), _) => isotropic(draft, elastic),
        (None, Law::Hyperelastic(law)) => rubber(draft, law)?,
        (None, Law::Plastic(law)) => plastic(draft, law)?,
        (None, _) => fabric(draft)?,
    };
    let density = in_twenty(draft.density());
    let name: String = draft.film.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    // A name begins with a letter.
    Ok(format!("*MATERIAL, NAME=FILM_{}\n*DENSITY\n{density},\n{law}", name.to_ascii_uppercase()))
}

/// A keyword with its data, eight values a line.
fn keyword(name: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let mut text = format!("*{name}\n");
    for row in rows {
        let values: Vec<String> = row.iter().map(|value| in_twenty(*value)).collect();
        for line in values.chunks(MOST) {
            text += &format!("{}\n", line.join(", "));
        }
    }
    text
}

fn isotropic(draft: &mut Draft<'_>, law: &Elastic) -> String {
    // CalculiX is linear in Green's strain, as droptower is: tests/solvers runs it.
    let is_other = draft.request.target == Target::Abaqus;
    draft.losses.extend(is_other.then(|| Loss::strain_measure("*ELASTIC", law, 2.0)));
    draft.lose_beside_the_law();
    elastic(draft, law)
}

fn elastic(draft: &Draft<'_>, law: &Elastic) -> String {
    keyword("ELASTIC", [vec![draft.stress(law.young), law.poisson]])
}

fn fabric(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    if draft.request.target == Target::CalculiX {
        return Err(draft.request.no_law("fabric"));
    }
    let curves = draft.fabric_curves(false)?;
    draft.losses.push(Loss::FromMemory { what: "the stress stands before the strain in *LOADING DATA" });
    draft.lose_beside_the_law();
    draft.losses.extend((curves.absorption > 0.0).then_some(Loss::Absorption { share: curves.absorption }));
    let [md, td] = &curves.fibres;
    let mut text = String::from("*FABRIC\n");
    for (component, curve) in [("1", &md[0].1), ("2", &td[0].1), ("SHEAR", &curves.shear)] {
        // Without a direction data of one side hold for both (Abaqus Keywords Reference, *LOADING DATA); fibres carry no compression.
        let direction = if component == "SHEAR" { "" } else { ", DIRECTION=TENSION" };
        text += &format!("*UNIAXIAL, COMPONENT={component}\n");
        let rows = curve.points.iter().map(|[strain, value]| vec![draft.stress(*value), *strain]);
        text += &keyword(&format!("LOADING DATA, TYPE=ELASTIC{direction}, EXTRAPOLATION=LINEAR"), rows);
    }
    Ok(text)
}

fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Diagnostic> {
    let request = draft.request;
    let viscosity = draft.film.material.viscosity.as_ref();
    // CalculiX has no relaxation: its film is the one of the law as it is written.
    let has_relaxation = request.target == Target::Abaqus;
    draft.losses.extend(viscosity.filter(|_| !has_relaxation).map(|_| Loss::Viscosity));
    let viscosity = viscosity.filter(|_| has_relaxation);
    let instant = viscosity.map_or(1.0, Viscosity::instant);
    let stress = request.system.stress() / instant;
    // A small compressibility for elements that need one; both potentials have D = 2/K.
    let d = 2.0 * stress / bulk_modulus(shear_modulus(law), request.poisson_of(law));
    let moduli = if viscosity.is_some() { ", MODULI=INSTANTANEOUS" } else { "" };
    let potential = match law {
        HyperelasticLaw::Polynomial(film) => {
            let Polynomial { first, second } = film.energy;
            let [c10, c20, c30] = first.map(|c| c / stress);
            match (second == 0.0, c20 == 0.0 && c30 == 0.0) {
                (true, true) => keyword(&format!("HYPERELASTIC, NEO HOOKE{moduli}"), [vec![c10, d]]),
                (true, false) => keyword(&format!("HYPERELASTIC, YEOH{moduli}"), [vec![c10, c20, c30, d, 0.0, 0.0]]),
                (false, true) => {
                    keyword(&format!("HYPERELASTIC, MOONEY-RIVLIN{moduli}"), [vec![c10, second / stress, d]])
                }
                (false, false) => return Err(request.no_law("Yeoh's energy with a term in I2")),
            }
        }
        HyperelasticLaw::Ogden(film) => {
            let terms = film.energy.terms();
            request.at_most(if has_relaxation { 6 } else { 3 }, terms.len(), Terms::Ogden)?;
            // W = Σ 2μ/α² (…) there.
            let row = terms.iter().flat_map(|term| [0.5 * term.mu * term.alpha / stress, term.alpha]);
            let mut row: Vec<f64> = row.collect();
            row.push(d);
            row.resize(3 * terms.len(), 0.0);
            keyword(&format!("HYPERELASTIC, OGDEN, N={}{moduli}", terms.len()), [row])
        }
        other => return Err(request.no_law(energy(other))),
    };
    draft.lose_of_rubber(law);
    draft.lose_rupture_and_heat();
    let relaxation = viscosity.map_or_else(String::new, |viscosity| {
        // Shares of the instantaneous shear modulus; the volume does not relax.
        let rows = viscosity.terms().iter().map(|term| vec![term.share, 0.0, term.time / request.system.time()]);
        keyword("VISCOELASTIC, TIME=PRONY", rows)
    });
    Ok(potential + &relaxation)
}

fn plastic(draft: &mut Draft<'_>, law: &Plastic) -> Result<String, Diagnostic> {
    let has_hill = draft.request.target == Target::Abaqus;
    let hill = lost_hill(law);
    draft.losses.extend(hill.clone().filter(|_| !has_hill));
    draft.lose_beside_the_law();
    // Ratios are over the curve, which is that along MD.
    let flow = draft.flow_curves(law, false)?;
    let rows = flow[0].1.points.iter().map(|[p, sigma]| vec![draft.stress(*sigma), *p]);
    let mut text = elastic(draft, law.elastic()) + &keyword("PLASTIC", rows);
    if has_hill && hill.is_some() {
        let md = along_md(law);
        let hill = law.hill();
        let across = |a: f64, b: f64| 1.0 / (a + b).sqrt() / md;
        let (r22, r33) = (across(hill.f, hill.h), across(hill.f, hill.g));
        let r12 = (1.5 / hill.n).sqrt() / md;
        // Shear out of the plane does not act in a membrane.
        text += &keyword("POTENTIAL", [vec![1.0, r22, r33, r12, 1.0, 1.0]]);
    }
    Ok(text)
}
