//! Cards of LS-DYNA: keywords with cards of eight fields.
//!
//! Fields as the keyword classes of pydyna name them (ansys/pydyna, `keyword_classes/auto/mat`). A field has 10 columns, or 20
//! where a number needs them: the keyword then ends with `+`, the long format of one keyword (pydyna, `lib/deck_loader.py`).

use super::film::{Draft, Refusal, Request, Sampled, energy, lost_hill, odd, paths, rising, shear_modulus};
use super::layout::in_columns;
use super::layout::{
    Field,
    Field::{Blank, Real, Whole},
    Format, Layout, line, written,
};
use super::loss::Loss;
use super::target::System;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic, Polynomial, PronyTerm, Viscosity};

/// Terms of Ogden's law.
const TERMS: usize = 8;

/// Materials that are written and read; their Prony terms are lines of their own.
pub(crate) const ELASTIC: Layout = &["mid RO E PR DA DB K"];
pub(crate) const FABRIC: Layout = &[
    "mid RO ea eb - PRBA PRAB -",
    "gab - - cse EL PRL LRATIO DAMP",
    "aopt FLC FAC ELA LNRC FORM FVOPT TSRFAC",
    "- RGBRTH A0REF a1 a2 a3 x0 x1",
    "v1 v2 v3 - - - BETA ISREFG",
    "LCA LCB LCAB LCUA LCUB LCUAB RL -",
];
/// Of FORM -14.
pub(crate) const HYSTERETIC: &str = "LCAA LCBB H DT - ECOAT SCOAT TCOAT";
pub(crate) const POLYNOMIAL: Layout = &["mid RO PR N nv G SIGF REF", "C10 C01 C11 C20 C02 C30 THERML"];
pub(crate) const OGDEN: Layout = &[
    "mid RO PR N nv G SIGF REF",
    "MU1 MU2 MU3 MU4 MU5 MU6 MU7 MU8",
    "ALPHA1 ALPHA2 ALPHA3 ALPHA4 ALPHA5 ALPHA6 ALPHA7 ALPHA8",
];
pub(crate) const PRONY: &str = "GI BETAI VFLAG";
pub(crate) const PLASTIC: Layout = &[
    "mid RO E PR SIGY ETAN FAIL TDEL",
    "C P LCSS LCSR vp",
    "EPS1 EPS2 EPS3 EPS4 EPS5 EPS6 EPS7 EPS8",
    "ES1 ES2 ES3 ES4 ES5 ES6 ES7 ES8",
];
/// Curves and tables, below which their points are.
pub(crate) const CURVE: &str = "LCID sidr SFA SFO OFFA OFFO dattyp lcint";
pub(crate) const TABLE: &str = "TBID SFA OFFA";

/// A keyword and its cards.
pub(crate) struct Keyword<'a> {
    pub(crate) name: &'a str,
    /// In a line of its own.
    pub(crate) title: Option<&'a str>,
    /// Names of the fields of each card, and their values.
    pub(crate) cards: Vec<(&'static str, Vec<Field>)>,
}

impl<'a> Keyword<'a> {
    /// A keyword with these values in the lines of its layout.
    pub(crate) fn of(name: &'a str, title: Option<&'a str>, layout: Layout, values: Vec<Vec<Field>>) -> Keyword<'a> {
        let rest = std::iter::repeat_with(Vec::new);
        Keyword { name, title, cards: layout.iter().copied().zip(values.into_iter().chain(rest)).collect() }
    }

    pub(crate) fn text(&self) -> String {
        let fields = || self.cards.iter().flat_map(|(_, fields)| fields);
        let is_short = |field: &Field| !matches!(field, Real(value) if in_columns(*value, 10).is_none());
        let (width, plus) = if fields().all(is_short) { (10, "") } else { (20, "+") };
        let head = match self.title {
            Some(title) => format!("*{}_TITLE{plus}\n{title}\n", self.name),
            None => format!("*{}{plus}\n", self.name),
        };
        let lines = self.cards.iter().map(|(names, fields)| line(names, Format::Equal(width), fields));
        head + &lines.collect::<String>()
    }
}

/// The card without its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Refusal> {
    let law = &draft.film.material.law;
    let body = match (draft.linear(law), law) {
        (Some(elastic), _) => isotropic(draft, elastic),
        (None, Law::Hyperelastic(law)) => rubber(draft, law)?,
        (None, Law::Plastic(law)) => plastic(draft, law)?,
        (None, _) => fabric(draft)?,
    };
    Ok(format!("*KEYWORD\n{body}*END\n"))
}

/// Number and density, with which all materials begin.
fn number_and_density(draft: &Draft<'_>) -> [Field; 2] {
    [Whole(draft.request.id.into()), Real(draft.density())]
}

fn isotropic(draft: &mut Draft<'_>, elastic: &Elastic) -> String {
    draft.losses.push(Loss::strain_measure("*MAT_ELASTIC, hypoelastic", elastic, 2.0));
    let [id, density] = number_and_density(draft);
    let values = vec![id, density, Real(draft.stress(elastic.young)), Real(elastic.poisson)];
    Keyword::of("MAT_ELASTIC", Some(draft.film.name), ELASTIC, vec![values]).text()
}

/// MAT_034. What follows the curves decides FORM and with it the last cards: -14 with hysteresis, 14 with unloading curves or
/// without absorption.
fn fabric(draft: &mut Draft<'_>) -> Result<String, Refusal> {
    let (film, request) = (draft.film, draft.request);
    let curves = draft.fabric_curves(true)?;
    let stress = request.system.stress();
    let mut numbers = Numbers::of(request);
    let mut text = String::new();
    let mut below = vec![];
    // Unloading is that of the slowest curve, from a strain at which that has a point.
    let from = curves.ends.map(|end| end.min(request.unloading_from.unwrap_or(f64::INFINITY)));
    let absorption = if request.unloading_from.is_some() { curves.absorption } else { 0.0 };
    let mut down = vec![];
    for ((fibre, name), from) in curves.fibres.iter().zip(["MD", "TD"]).zip(from) {
        let mut fibre = fibre.clone();
        fibre.iter_mut().for_each(|(_, curve)| curve.points = rising(std::mem::take(&mut curve.points)));
        if let Some((_, slowest)) = fibre.first_mut() {
            let (up, unloading) = paths(slowest, from, absorption);
            slowest.points = up;
            down.extend(unloading);
        }
        below.push(stresses(name, &fibre, &mut numbers, &mut text, request));
    }
    let end = curves.shear.points.last().map_or(0.0, |point| point[0]);
    let (shear, unloading) = paths(&curves.shear, end, absorption);
    down.extend(unloading.map(|points| odd(&points)));
    let title = "shear stress over shear angle (rad)";
    below.push(Whole(curve(&mut numbers, &mut text, title, &odd(&shear), [1.0, stress])));
    // Unloading curves are those from one strain; without them and without hysteresis film unloads on its curve.
    let mut form = 14;
    let mut hysteresis = 0.0;
    match request.unloading_from {
        _ if curves.absorption == 0.0 => {}
        Some(_) => {
            draft.losses.push(Loss::UnloadingFrom { md: from[0], td: from[1] });
            for (points, name) in down.iter().zip(["MD", "TD", "shear"]) {
                let title = format!("{name}, unloading");
                below.push(Whole(curve(&mut numbers, &mut text, &title, points, [1.0, stress])));
            }
        }
        None => {
            (form, hysteresis) = (-14, curves.absorption);
            draft.losses.push(Loss::Hysteresis { share: curves.absorption });
        }
    }
    draft.lose_beside_the_law();
    let [along, across, shear] = curves.slopes.map(|slope| Real(draft.stress(slope)));
    let md = request.md().map(Real);
    let [id, density] = number_and_density(draft);
    let values = vec![
        vec![id, density, along, across, Real(0.0), Real(0.0)],
        vec![shear, Real(1.0)],
        vec![Real(2.0), Blank, Blank, Blank, Blank, Whole(form)],
        vec![Blank, Blank, md[0], md[1], Real(0.0)],
        vec![],
        below,
    ];
    let mut keyword = Keyword::of("MAT_FABRIC", Some(film.name), FABRIC, values);
    keyword.cards.extend((form == -14).then(|| (HYSTERETIC, vec![Blank, Blank, Real(hysteresis)])));
    Ok(keyword.text() + &text)
}

/// Numbers of curves, one after the other from a hundred times that of the material on.
struct Numbers(i64);

impl Numbers {
    fn of(request: &Request) -> Numbers {
        Numbers(100 * i64::from(request.id))
    }

    fn next(&mut self) -> i64 {
        self.0 += 1;
        self.0
    }
}

/// Adds a curve, whose abscissas and ordinates are divided by `units`; its number.
fn curve(numbers: &mut Numbers, text: &mut String, title: &str, points: &[[f64; 2]], units: [f64; 2]) -> i64 {
    let number = numbers.next();
    *text += &define_curve(number, title, points, units);
    number
}

/// A curve, whose abscissas and ordinates are divided by `units`.
pub(crate) fn define_curve(number: i64, title: &str, points: &[[f64; 2]], units: [f64; 2]) -> String {
    /// Points of the curve that the solver reads off it: its own 100 would cut the corners.
    const READ: i64 = 2000;
    let fields = vec![Whole(number), Blank, Real(1.0), Real(1.0), Real(0.0), Real(0.0), Blank, Whole(READ)];
    let mut text = format!("$ {title}\n{}", Keyword::of("DEFINE_CURVE", None, &[CURVE], vec![fields]).text());
    for [x, y] in points {
        let [x, y] = [x / units[0], y / units[1]].map(|value| written(Real(value), 20));
        text += &format!("{x:>20}{y:>20}\n");
    }
    text
}

/// Adds the curves of a fibre set or of flow, several as a table by rate; the number of the curve or the table.
fn stresses(
    title: &str,
    curves: &[(Option<f64>, Sampled)],
    numbers: &mut Numbers,
    text: &mut String,
    request: &Request,
) -> Field {
    let units = [1.0, request.system.stress()];
    if let [(_, only)] = curves {
        return Whole(curve(numbers, text, title, &only.points, units));
    }
    // The curves of a table follow it, in the order of their rates.
    let table = numbers.next();
    let mut rates = String::new();
    for (rate, _) in curves {
        let rate = written(Real(rate.unwrap_or_default() * request.system.time()), 20);
        rates += &format!("{rate:>20}\n");
    }
    let keyword = Keyword::of("DEFINE_TABLE", None, &[TABLE], vec![vec![Whole(table), Real(1.0), Real(0.0)]]);
    *text += &format!("$ {title}, by strain rate\n{}{rates}", keyword.text());
    for (rate, sampled) in curves {
        let title = format!("{title} at {} 1/s", rate.unwrap_or_default());
        curve(numbers, text, &title, &sampled.points, units);
    }
    Whole(table)
}

fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Refusal> {
    let (film, request) = (draft.film, draft.request);
    if matches!(law, HyperelasticLaw::CompressibleNeoHookean(_) | HyperelasticLaw::Gent(_)) {
        return Err(request.no_law(energy(law)));
    }
    draft.lose_of_rubber(law);
    draft.lose_rupture_and_heat();
    // Prony moduli are added to the law, which is that of film that has relaxed.
    let relaxed = film.material.viscosity.as_ref().map_or(1.0, |viscosity| viscosity.instant() * viscosity.long_term());
    let [id, density] = number_and_density(draft);
    let head = vec![id, density, Real(request.poisson_of(law)), Whole(0)];
    let mut keyword = match law {
        HyperelasticLaw::Polynomial(rubber) => {
            let Polynomial { first: [c10, c20, c30], second } = rubber.energy;
            let [c10, c20, c30, c01] = [c10, c20, c30, second].map(|c| Real(draft.stress(relaxed * c)));
            let coefficients = vec![c10, c01, Real(0.0), c20, Real(0.0), c30];
            Keyword::of("MAT_HYPERELASTIC_RUBBER", Some(film.name), POLYNOMIAL, vec![head, coefficients])
        }
        _ => {
            let terms = request.ogden(law, TERMS)?;
            let mu = terms.iter().map(|term| Real(draft.stress(relaxed * term.mu))).collect();
            let alpha = terms.iter().map(|term| Real(term.alpha)).collect();
            Keyword::of("MAT_OGDEN_RUBBER", Some(film.name), OGDEN, vec![head, mu, alpha])
        }
    };
    if let Some(viscosity) = &film.material.viscosity {
        draft.losses.push(Loss::LinearViscosity);
        keyword.cards.extend(prony(viscosity, shear_modulus(law), request.system));
    }
    Ok(keyword.text())
}

/// A card for each term: its shear relaxation modulus, as pydyna's keyword classes of 077 call it (OpenRadioss' reader of LS-DYNA decks
/// copies it as that), and its decay constant.
fn prony(viscosity: &Viscosity, shear: f64, system: System) -> impl Iterator<Item = (&'static str, Vec<Field>)> {
    let instant = viscosity.instant() * shear;
    let terms = viscosity.terms().iter();
    let term = move |term: &PronyTerm| [instant * term.share / system.stress(), 1.0 / term.time * system.time()];
    terms.map(move |of| (PRONY, term(of).map(Real).to_vec()))
}

fn plastic(draft: &mut Draft<'_>, law: &Plastic) -> Result<String, Refusal> {
    let request = draft.request;
    let flow = draft.flow_curves(law, true)?;
    draft.losses.extend(lost_hill(law));
    draft.losses.push(Loss::stress_of_volume(law.elastic(), &flow));
    draft.lose_beside_the_law();
    let (mut numbers, mut text) = (Numbers::of(request), String::new());
    let title = "true stress over plastic strain";
    let lcss = stresses(title, &flow, &mut numbers, &mut text, request);
    // Viscoplastic, so that a table is read at the rate of plastic strain.
    let vp = if flow.len() > 1 { Real(1.0) } else { Blank };
    let Elastic { young, poisson } = law.elastic();
    let yields = flow[0].1.points[0][1];
    let [id, density] = number_and_density(draft);
    let values = vec![
        vec![id, density, Real(draft.stress(*young)), Real(*poisson), Real(draft.stress(yields))],
        vec![Blank, Blank, lcss, Blank, vp],
    ];
    Ok(Keyword::of("MAT_PIECEWISE_LINEAR_PLASTICITY", Some(draft.film.name), PLASTIC, values).text() + &text)
}
