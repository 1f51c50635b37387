//! Cards of LS-DYNA: keywords with cards of eight fields.
//!
//! Fields as the keyword classes of pydyna name them (ansys/pydyna, `keyword_classes/auto/mat`). A field has 10 columns, or 20
//! where a number needs them: the keyword then ends with `+`, the long format of one keyword (pydyna, `lib/deck_loader.py`).

use super::film::{CurvesBehind, Draft, Points, Rated, energy, lost_hill, rising};
use super::layout::{
    Field,
    Field::{Blank, Real, Whole},
    Format, Layout, in_twenty, lines, padded,
};
use super::loss::Loss;
use super::target::System;
use base::diagnostic::Diagnostic;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic, Polynomial};

/// Terms of Ogden's law.
const TERMS: usize = 8;

/// Materials that are written and read; their Prony terms are lines of their own.
pub(crate) const ELASTIC: Layout = &["mid RO:density E:stress PR DA DB K"];
pub(crate) const FABRIC: Layout = &[
    "mid RO:density ea:stress eb:stress - PRBA=0.0 PRAB=0.0 -",
    "gab:stress - - cse=1.0 EL= PRL= LRATIO= DAMP=",
    "aopt=2.0 FLC= FAC= ELA= LNRC= FORM FVOPT= TSRFAC=",
    "- RGBRTH= A0REF= a1 a2 a3=0.0 x0= x1=",
    "v1= v2= v3= - - - BETA= ISREFG=",
    "LCA LCB LCAB LCUA LCUB LCUAB RL -",
];
/// Of FORM -14.
pub(crate) const HYSTERETIC: &str = "LCAA= LCBB= H DT - ECOAT SCOAT TCOAT";
pub(crate) const POLYNOMIAL: Layout = &[
    "mid RO:density PR N=0 nv= G= SIGF= REF=",
    "C10:stress C01:stress C11:stress=0.0 C20:stress C02:stress=0.0 C30:stress THERML",
];
pub(crate) const OGDEN: Layout = &[
    "mid RO:density PR N=0 nv= G= SIGF= REF=",
    "MU1:stress MU2:stress MU3:stress MU4:stress MU5:stress MU6:stress MU7:stress MU8:stress",
    "ALPHA1 ALPHA2 ALPHA3 ALPHA4 ALPHA5 ALPHA6 ALPHA7 ALPHA8",
];
pub(crate) const PRONY: &str = "GI:stress BETAI:rate VFLAG";
pub(crate) const PLASTIC: Layout = &[
    "mid RO:density E:stress PR SIGY:stress ETAN:stress= FAIL= TDEL=",
    "C= P= LCSS LCSR= vp",
    "EPS1 EPS2 EPS3 EPS4 EPS5 EPS6 EPS7 EPS8",
    "ES1:stress ES2:stress ES3:stress ES4:stress ES5:stress ES6:stress ES7:stress ES8:stress",
];
/// Curves and tables, below which their points are. A curve is read off at 2000 points: the solver's own 100 would cut the corners.
pub(crate) const CURVE: &str = "LCID sidr= SFA=1.0 SFO=1.0 OFFA=0.0 OFFO=0.0 dattyp= lcint=2000";
pub(crate) const TABLE: &str = "TBID SFA=1.0 OFFA=0.0";

/// Lines of a keyword with their values.
pub(crate) type Filled = (Layout, Vec<Field>);

/// A keyword with its heading, in a line of its own, and lines with their values: in fields of 10 columns, or of 20 where a number
/// needs them.
pub(crate) fn keyword(name: &str, heading: Option<&str>, system: System, all: &[Filled]) -> String {
    let of_width = |width: usize| -> Option<String> {
        all.iter().map(|(layout, values)| lines(layout, Format::Equal(width), system, values)).collect()
    };
    let (plus, cards) = match of_width(10) {
        Some(cards) => ("", cards),
        None => ("+", of_width(20).expect("twenty columns hold any number")),
    };
    let heading = heading.map_or_else(String::new, |heading| format!("{heading}\n"));
    format!("*{name}{plus}\n{heading}{cards}")
}

/// The material and its curves.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    let law = &draft.film.material.law;
    match (draft.linear(law), law) {
        (Some(elastic), _) => Ok(isotropic(draft, elastic)),
        (None, Law::Hyperelastic(law)) => rubber(draft, law),
        (None, Law::Plastic(law)) => plastic(draft, law),
        (None, _) => fabric(draft),
    }
}

/// A material with these values in the fields of its layout behind number and density.
fn material(draft: &Draft<'_>, name: &str, layout: Layout, values: Vec<Field>, below: Vec<Filled>) -> String {
    let begin = [Whole(draft.request.id.into()), Real(draft.film.material.density)];
    let mut all = vec![(layout, [&begin[..], &values].concat())];
    all.extend(below);
    keyword(&format!("{name}_TITLE"), Some(draft.film.name), draft.request.system, &all)
}

fn isotropic(draft: &mut Draft<'_>, elastic: &Elastic) -> String {
    draft.losses.push(Loss::strain_measure("*MAT_ELASTIC, hypoelastic", elastic, 2.0));
    draft.lose_beside_the_law();
    material(draft, "MAT_ELASTIC", ELASTIC, vec![Real(elastic.young), Real(elastic.poisson)], vec![])
}

/// MAT_034. What follows the curves decides FORM and with it the last cards: -14 with hysteresis, 14 with unloading curves or
/// without absorption.
fn fabric(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    let request = draft.request;
    let curves = draft.fabric_curves(true)?;
    let units = [1.0, request.system.stress()];
    // Unloading is that of the slowest curve. Its curves are those from one strain; without them and without hysteresis film unloads
    // on its curve.
    let from = curves.unloading_from(request);
    let has_paths = request.unloading_from.is_some();
    let (loading, unloading) = curves.paths(from, if has_paths { curves.absorption } else { 0.0 });
    let is_hysteretic = !has_paths && curves.absorption > 0.0;
    let mut behind = CurvesBehind::new(request, define_curve);
    let mut numbers = vec![];
    for ((fibre, slowest), name) in curves.fibres.iter().zip(&loading).zip(["MD", "TD"]) {
        let mut all: Vec<Rated<_>> = fibre.iter().map(|(rate, curve)| (*rate, rising(curve.points.clone()))).collect();
        all[0].1.clone_from(slowest);
        numbers.push(stresses(name, &all, &mut behind, request.system));
    }
    numbers.push(behind.add("shear stress over shear angle (rad)", &loading[2], units));
    if let Some(unloading) = &unloading {
        draft.losses.push(Loss::UnloadingFrom { md: from[0], td: from[1] });
        for (points, name) in unloading.iter().zip(["MD", "TD", "shear"]) {
            numbers.push(behind.add(&format!("{name}, unloading"), points, units));
        }
    }
    draft.losses.extend(is_hysteretic.then_some(Loss::Hysteresis { share: curves.absorption }));
    draft.lose_beside_the_law();
    let [along, across, shear] = curves.slopes.map(Real);
    let [x, y] = request.md().map(Real);
    let mut values = vec![along, across, shear, Whole(if is_hysteretic { -14 } else { 14 }), x, y];
    values.extend(numbers.into_iter().map(Whole));
    let below = is_hysteretic.then(|| -> Filled { (&[HYSTERETIC], vec![Real(curves.absorption)]) });
    Ok(material(draft, "MAT_FABRIC", FABRIC, values, below.into_iter().collect()) + &behind.text)
}

/// A curve, whose abscissas and ordinates are divided by `units`.
pub(crate) fn define_curve(number: i64, title: &str, points: &[[f64; 2]], units: [f64; 2]) -> String {
    let head = keyword("DEFINE_CURVE", None, System::KgMS, &[(&[CURVE], vec![Whole(number)])]);
    let point = |[x, y]: &[f64; 2]| format!("{:>20}{:>20}\n", in_twenty(x / units[0]), in_twenty(y / units[1]));
    format!("$ {title}\n{head}{}", points.iter().map(point).collect::<String>())
}

/// Adds the curves of a fibre set or of flow, several as a table by rate; the number of the curve or the table.
fn stresses(title: &str, curves: &[Rated<Points>], behind: &mut CurvesBehind, system: System) -> i64 {
    let units = [1.0, system.stress()];
    if let [(_, only)] = curves {
        return behind.add(title, only, units);
    }
    // The curves of a table follow it, in the order of their rates.
    let table = behind.number();
    let head = keyword("DEFINE_TABLE", None, system, &[(&[TABLE], vec![Whole(table)])]);
    let rate = |(rate, _): &Rated<Points>| format!("{:>20}\n", in_twenty(rate.unwrap_or_default() * system.time()));
    behind.text += &format!("$ {title}, by strain rate\n{head}{}", curves.iter().map(rate).collect::<String>());
    for (rate, points) in curves {
        behind.add(&format!("{title} at {} 1/s", rate.unwrap_or_default()), points, units);
    }
    table
}

fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Diagnostic> {
    let request = draft.request;
    if matches!(law, HyperelasticLaw::CompressibleNeoHookean(_) | HyperelasticLaw::Gent(_)) {
        return Err(request.no_law(energy(law)));
    }
    draft.lose_of_rubber(law);
    draft.lose_rupture_and_heat();
    // Prony moduli are added to the law, which is that of film that has relaxed.
    let (relaxed, moduli) = draft.relaxation(law);
    let mut values = vec![Real(request.poisson_of(law))];
    let (name, layout) = match law {
        HyperelasticLaw::Polynomial(rubber) => {
            let Polynomial { first: [c10, c20, c30], second: c01 } = rubber.energy;
            values.extend([c10, c01, c20, c30].map(|c| Real(relaxed * c)));
            ("MAT_HYPERELASTIC_RUBBER", POLYNOMIAL)
        }
        _ => {
            let terms = request.ogden(law, TERMS)?;
            values.extend(padded(TERMS, terms.iter().map(|term| relaxed * term.mu)));
            values.extend(terms.iter().map(|term| Real(term.alpha)));
            ("MAT_OGDEN_RUBBER", OGDEN)
        }
    };
    draft.losses.extend((!moduli.is_empty()).then_some(Loss::LinearViscosity));
    // For each term its shear relaxation modulus, as pydyna's keyword classes of 077 call it (OpenRadioss' reader of LS-DYNA decks
    // copies it as that), and its decay constant.
    let term = |[modulus, time]: &[f64; 2]| -> Filled { (&[PRONY], vec![Real(*modulus), Real(1.0 / time)]) };
    let prony = moduli.iter().map(term).collect();
    Ok(material(draft, name, layout, values, prony))
}

fn plastic(draft: &mut Draft<'_>, law: &Plastic) -> Result<String, Diagnostic> {
    let request = draft.request;
    let flow = draft.flow_curves(law, true)?;
    draft.losses.extend(lost_hill(law));
    draft.losses.push(Loss::stress_of_volume(law.elastic(), &flow));
    draft.lose_beside_the_law();
    let mut behind = CurvesBehind::new(request, define_curve);
    let flow: Vec<Rated<_>> = flow.into_iter().map(|(rate, curve)| (rate, curve.points)).collect();
    let curve = stresses("true stress over plastic strain", &flow, &mut behind, request.system);
    // Viscoplastic, so that a table is read at the rate of plastic strain.
    let viscoplastic = if flow.len() > 1 { Real(1.0) } else { Blank };
    let Elastic { young, poisson } = *law.elastic();
    let [_, first] = flow[0].1[0];
    let values = vec![Real(young), Real(poisson), Real(first), Whole(curve), viscoplastic];
    Ok(material(draft, "MAT_PIECEWISE_LINEAR_PLASTICITY", PLASTIC, values, vec![]) + &behind.text)
}
