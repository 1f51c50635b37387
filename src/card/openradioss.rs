//! Cards of OpenRadioss: `/MAT/…` and `/FUNCT` in the block format of 2023.
//!
//! Fields as in its configuration files (OpenRadioss, `hm_cfg_files/config/CFG`): whole numbers in 10 columns, reals in 20. Its
//! engine looks the curves of LAW58 up at engineering strain and takes their stress per undeformed width
//! (`engine/source/materials/mat/mat058/sigeps58c.F`), and shear over the angle in degrees. Its starter refuses curves that do not
//! rise, and unloading that does not meet loading (`starter/source/materials/mat/mat058/law58_upd.F`).

use super::film::{Draft, Refusal, lost_hill, odd, paths, shear_modulus};
use super::layout::{
    Field,
    Field::{Real, Whole},
    Format, Layout, line,
};
use super::loss::Loss;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic};

/// Crimp of the fibres of LAW58: zero would be taken for 0.1.
const CRIMP: f64 = 1e-4;

/// Share of their stiffness that bent fibres of LAW58 have; its default.
const FLEX: f64 = 1e-3;

/// Terms of Ogden's law: before 2025 the second line of each five is blank.
const TERMS: usize = 5;

/// Materials that are written and read, as the configuration files have them; lines of each rate and Prony terms follow.
pub(crate) const LAW19: Layout = &["RHO_I", "E11 E22 NU12", "G12 g23 g31", "R_E a_r ZEROSTRESS FSCALE_POR sensor#"];
pub(crate) const LAW36: Layout = &[
    "RHO_I",
    "E NU EPS_P_MAX EPS_T EPS_M",
    "N_FUNCT# f_smooth# C_HARD f_cut EPS_F - vp#",
    "FCT_IDP# fscale FCT_IDE# einf ce",
];
pub(crate) const LAW42: Layout = &[
    "RHO_I",
    "NU SIGMA_CUT j# FUNIDBULK# fscale_bulk M# IFORM#",
    "MU_1 MU_2 MU_3 MU_4 MU_5",
    "MU_6 MU_7 MU_8 MU_9 MU_10",
    "ALPHA_1 ALPHA_2 ALPHA_3 ALPHA_4 ALPHA_5",
    "ALPHA_6 ALPHA_7 ALPHA_8 ALPHA_9 ALPHA_10",
];
pub(crate) const LAW43: Layout =
    &["RHO_I", "E NU", "FCT_IDE# - einf ce", "R00 R45 R90 C_HARD I_YIELD0#", "EPS_P_MAX EPS_T EPS_M f_cut f_smooth#"];
pub(crate) const LAW58: Layout = &[
    "RHO_I",
    "e1 B1 e2 B2 flex",
    "g0 gt ALPHAT gsh - sensor#",
    "DF DS GFROT - - ZEROSTRESS",
    "n1# n2# S1 S2 flex1 flex2",
    "FCT_ID1# - FSCALE1",
    "FCT_ID2# - FSCALE2",
    "FCT_ID3# - FSCALE3",
    "FCT_ID4# FCT_ID5# FSCALE4 FSCALE5 FCT_ID6# FSCALE6",
];

/// Lines of five values, as LAW36 and LAW42 have them: of functions, and of anything else.
pub(crate) const OF_FUNCTIONS: &str = "FUNCT_ID_1# FUNCT_ID_2# FUNCT_ID_3# FUNCT_ID_4# FUNCT_ID_5#";
pub(crate) const OF_SCALES: &str = "FSCALE_1 FSCALE_2 FSCALE_3 FSCALE_4 FSCALE_5";
pub(crate) const OF_RATES: &str = "EPS_DOT_1 EPS_DOT_2 EPS_DOT_3 EPS_DOT_4 EPS_DOT_5";
pub(crate) const OF_MODULI: &str = "G_1 G_2 G_3 G_4 G_5";
pub(crate) const OF_TIMES: &str = "TAU_1 TAU_2 TAU_3 TAU_4 TAU_5";
/// A rate of LAW43.
pub(crate) const OF_RATE: &str = "FCT_ID# - FSCALE EPS_DOT";
pub(crate) const POINT: &str = "X Y";

/// A block with its comments.
pub(crate) struct Block(pub(crate) String);

impl Block {
    pub(crate) fn begin(keyword: &str, title: &str) -> Block {
        Block(format!("{keyword}\n{title}\n"))
    }

    /// Adds a line below the names of its fields.
    pub(crate) fn line(mut self, names: &str, values: &[Field]) -> Block {
        self.0 += &line(names, Format::Mixed, values);
        self
    }

    /// Adds lines of five values below the names of their fields; none without values.
    fn fives(self, names: &str, values: &[Field]) -> Block {
        values.chunks(5).fold(self, |block, five| block.line(names, five))
    }
}

/// A function.
pub(crate) fn function(number: i64, title: &str, points: impl IntoIterator<Item = [f64; 2]>) -> String {
    let mut text = format!("/FUNCT/{number}\n{title}\n");
    for (place, point) in points.into_iter().enumerate() {
        let point = line(POINT, Format::Mixed, &point.map(Real));
        // With names above the first point only.
        text += if place == 0 { &point } else { point.split_once('\n').map_or("", |(_, values)| values) };
    }
    text
}

/// The card without its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Refusal> {
    let law = &draft.film.material.law;
    let body = match (draft.linear(law), law) {
        (Some(elastic), _) => orthotropic(draft, elastic),
        (None, Law::Hyperelastic(law)) => rubber(draft, law)?,
        (None, Law::Plastic(law)) => plastic(draft, law)?,
        (None, _) => fabric(draft)?,
    };
    Ok(format!("#RADIOSS STARTER\n{body}/END\n"))
}

/// A material with these values in the lines of its layout below the density.
fn material(draft: &Draft<'_>, law: &str, layout: Layout, values: &[&[Field]]) -> Block {
    let density = [Real(draft.density())];
    let rest = std::iter::repeat(&[][..]);
    let lines = std::iter::once(&density[..]).chain(values.iter().copied()).chain(rest);
    let block = Block::begin(&format!("/MAT/{law}/{}", draft.request.id), draft.film.name);
    layout.iter().zip(lines).fold(block, |block, (names, values)| block.line(names, values))
}

/// LAW19: linear, of isotropic film the same along both directions.
fn orthotropic(draft: &mut Draft<'_>, elastic: &Elastic) -> String {
    // It keeps its thickness: one element in OpenRadioss has these stresses within 0.1 % (tests/solvers/openradioss.py).
    draft.losses.push(Loss::strain_measure("LAW19, logarithmic", elastic, 1.0));
    draft.lose_beside_the_law();
    let Elastic { young, poisson } = *elastic;
    let [young, shear] = [young, young / (2.0 + 2.0 * poisson)].map(|stress| Real(draft.stress(stress)));
    // No reduction in compression.
    let values: [&[Field]; 3] = [&[young, young, Real(poisson)], &[shear; 3], &[Real(1.0)]];
    material(draft, "LAW19", LAW19, &values).0
}

/// LAW58. Its seven lines refer to functions by number, so that these are written first and stand behind it.
fn fabric(draft: &mut Draft<'_>) -> Result<String, Refusal> {
    const DEGREES: f64 = std::f64::consts::PI / 180.0;
    let request = draft.request;
    let curves = draft.fabric_curves(false)?;
    draft.lose_beside_the_law();
    let stress = request.system.stress();
    let [md, td] = &curves.fibres;
    let (mut functions, mut number) = (String::new(), 100 * i64::from(request.id));
    let mut add = |title: &str, points: &[[f64; 2]], units: [f64; 2]| {
        number += 1;
        functions += &function(number, title, points.iter().map(|[x, y]| [x / units[0], y / units[1]]));
        number
    };
    let all =
        [(&md[0].1, "MD", [1.0, stress]), (&td[0].1, "TD", [1.0, stress]), (&curves.shear, "shear", [DEGREES, stress])];
    // In shear from the end: its strain is an angle.
    let ends = all.map(|(curve, ..)| curve.points.last().map_or(0.0, |point| point[0]));
    let asked = request.unloading_from.unwrap_or(f64::INFINITY);
    let from = [ends[0].min(asked), ends[1].min(asked), ends[2]];
    // Negative angles would follow the first slope of a curve that begins at zero.
    let whole = |points: Vec<[f64; 2]>, title: &str| if title == "shear" { odd(&points) } else { points };
    let both = [0, 1, 2].map(|place| paths(all[place].0, from[place], curves.absorption));
    let (mut loading, mut unloads) = ([0; 3], [0; 3]);
    for (place, ((_, title, units), (up, _))) in all.iter().zip(&both).enumerate() {
        loading[place] = add(title, &whole(up.clone(), title), *units);
    }
    for (place, ((_, title, units), (_, down))) in all.iter().zip(&both).enumerate() {
        if let Some(down) = down {
            unloads[place] = add(&format!("{title}, unloading"), &whole(down.clone(), title), *units);
        }
    }
    if curves.absorption > 0.0 {
        draft.losses.extend([Loss::UnloadingFrom { md: from[0], td: from[1] }, Loss::ScaledUnloading]);
    }
    draft.losses.push(Loss::ShearOfPresentArea);
    let [e1, e2, shear] = curves.slopes.map(|slope| Real(slope / stress));
    let [fct4, fct5, fct6] = unloads.map(Whole);
    let (none, one) = (Real(0.0), Real(1.0));
    let values: [&[Field]; 8] = [
        &[e1, none, e2, none, Real(FLEX)],
        &[shear, shear, none, shear],
        &[none; 3],
        &[Whole(1), Whole(1), Real(CRIMP), Real(CRIMP), Real(FLEX), Real(FLEX)],
        &[Whole(loading[0]), one],
        &[Whole(loading[1]), one],
        &[Whole(loading[2]), one],
        &[fct4, fct5, one, one, fct6, one],
    ];
    Ok(material(draft, "LAW58", LAW58, &values).0 + &functions)
}

/// LAW42: Ogden's law, with Prony moduli.
fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Refusal> {
    let request = draft.request;
    let terms = request.ogden(law, TERMS)?;
    draft.lose_of_rubber(law);
    draft.lose_rupture_and_heat();
    let viscosity = draft.film.material.viscosity.as_ref();
    let relaxed = viscosity.map_or(1.0, |viscosity| viscosity.instant() * viscosity.long_term());
    let prony = viscosity.map_or(&[][..], |viscosity| viscosity.terms());
    draft.losses.extend(viscosity.map(|_| Loss::ShellRelaxation));
    let mu: Vec<Field> = terms.iter().map(|term| Real(draft.stress(relaxed * term.mu))).collect();
    let alpha: Vec<Field> = terms.iter().map(|term| Real(term.alpha)).collect();
    let poisson = Real(request.poisson_of(law));
    let head = [poisson, Real(0.0), Whole(0), Whole(0), Real(1.0), Whole(prony.len() as i64), Whole(0)];
    let instant = viscosity.map_or(1.0, |viscosity| viscosity.instant()) * shear_modulus(law);
    let moduli: Vec<Field> = prony.iter().map(|term| Real(draft.stress(instant * term.share))).collect();
    let times: Vec<Field> = prony.iter().map(|term| Real(term.time / request.system.time())).collect();
    let block = material(draft, "LAW42", LAW42, &[&head, &mu, &[], &alpha]);
    Ok(block.fives(OF_MODULI, &moduli).fives(OF_TIMES, &times).0)
}

/// LAW43 with Hill's yield function, LAW36 with von Mises'.
fn plastic(draft: &mut Draft<'_>, law: &Plastic) -> Result<String, Refusal> {
    let request = draft.request;
    let is_hill = lost_hill(law).is_some();
    let flow = draft.flow_curves(law, true)?;
    draft.losses.push(Loss::stress_of_volume(law.elastic(), &flow));
    draft.lose_beside_the_law();
    let (stress, time) = (request.system.stress(), request.system.time());
    let Elastic { young, poisson } = law.elastic();
    let elastic = [Real(young / stress), Real(*poisson)];
    let (mut functions, mut numbers, mut rates) = (String::new(), vec![], vec![]);
    for (number, (rate, sampled)) in (100 * i64::from(request.id) + 1..).zip(&flow) {
        let at = rate.map_or_else(String::new, |rate| format!(" at {rate} 1/s"));
        let points = sampled.points.iter().map(|[p, sigma]| [*p, sigma / stress]);
        functions += &function(number, &format!("true stress over plastic strain{at}"), points);
        numbers.push(Whole(number));
        rates.push(Real(rate.unwrap_or_default() * time));
    }
    // No failure: neither by plastic strain nor by tension.
    const NEVER: Field = Real(1e30);
    let (none, one) = (Real(0.0), Real(1.0));
    let block = if is_hill {
        let [r00, r45, r90] = [0.0, 45.0, 90.0_f64].map(|angle| Real(law.hill().strain_ratio(angle.to_radians())));
        // Lankford values, and the curve of MD: a zero would make it the mean of all directions.
        let ratios = [r00, r45, r90, none, Whole(1)];
        let limits = [NEVER, NEVER, NEVER, none, Whole(0)];
        let block = material(draft, "LAW43", LAW43, &[&elastic, &[Whole(0), none, none], &ratios, &limits]);
        numbers.iter().zip(&rates).fold(block, |block, (number, rate)| block.line(OF_RATE, &[*number, one, *rate]))
    } else {
        let [young, poisson] = elastic;
        let values: [&[Field]; 3] = [
            &[young, poisson, NEVER, NEVER, NEVER],
            &[Whole(rates.len() as i64), Whole(0), none, none, NEVER, Whole(1)],
            &[Whole(0), one, Whole(0), none, none],
        ];
        let block = material(draft, "LAW36", LAW36, &values);
        block.fives(OF_FUNCTIONS, &numbers).fives(OF_SCALES, &vec![one; rates.len()]).fives(OF_RATES, &rates)
    };
    Ok(block.0 + &functions)
}
