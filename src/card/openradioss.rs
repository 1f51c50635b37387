//! Cards of OpenRadioss: `/MAT/…` and `/FUNCT` in the block format of 2023.
//!
//! Fields as in its configuration files (OpenRadioss, `hm_cfg_files/config/CFG`): whole numbers in 10 columns, reals in 20. Its
//! engine looks the curves of LAW58 up at engineering strain and takes their stress per undeformed width
//! (`engine/source/materials/mat/mat058/sigeps58c.F`), and shear over the angle in degrees. Its starter refuses curves that do not
//! rise, and unloading that does not meet loading (`starter/source/materials/mat/mat058/law58_upd.F`).

use super::film::{CurvesBehind, Draft, Points, lost_hill};
use super::layout::{
    Field,
    Field::{Real, Whole},
    Format, Layout, lines, padded,
};
use super::loss::Loss;
use super::target::System;
use base::diagnostic::Diagnostic;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic};

/// Terms of Ogden's law: before 2025 the second line of each five is blank.
const TERMS: usize = 5;

/// Materials that are written and read, as the configuration files have them; lines of each rate and Prony terms follow.
///
/// LAW19 has no reduction in compression. LAW36 and LAW43 do not fail, neither by plastic strain nor by tension, and the curve of
/// LAW43 is that of MD: without `I_YIELD0` it would be the mean of all directions.
pub(crate) const LAW19: Layout = &[
    "RHO_I:density",
    "E11:stress E22:stress NU12",
    "G12:stress g23:stress g31:stress",
    "R_E=1.0 a_r ZEROSTRESS FSCALE_POR sensor#",
];
pub(crate) const LAW36: Layout = &[
    "RHO_I:density",
    "E:stress NU EPS_P_MAX=1.0E30 EPS_T=1.0E30 EPS_M=1.0E30",
    "N_FUNCT# f_smooth#=0 C_HARD=0.0 f_cut=0.0 EPS_F=1.0E30 - vp#=1",
    "FCT_IDP#=0 fscale=1.0 FCT_IDE#=0 einf=0.0 ce=0.0",
];
pub(crate) const LAW42: Layout = &[
    "RHO_I:density",
    "NU SIGMA_CUT=0.0 j#=0 FUNIDBULK#=0 fscale_bulk=1.0 M# IFORM#=0",
    "MU_1:stress MU_2:stress MU_3:stress MU_4:stress MU_5:stress",
    "MU_6:stress= MU_7:stress= MU_8:stress= MU_9:stress= MU_10:stress=",
    "ALPHA_1 ALPHA_2 ALPHA_3 ALPHA_4 ALPHA_5",
    "ALPHA_6 ALPHA_7 ALPHA_8 ALPHA_9 ALPHA_10",
];
pub(crate) const LAW43: Layout = &[
    "RHO_I:density",
    "E:stress NU",
    "FCT_IDE#=0 - einf=0.0 ce=0.0",
    "R00 R45 R90 C_HARD=0.0 I_YIELD0#=1",
    "EPS_P_MAX=1.0E30 EPS_T=1.0E30 EPS_M=1.0E30 f_cut=0.0 f_smooth#=0",
];
/// Its fibres are straight (a crimp of zero would be taken for 0.1), and have a thousandth of their stiffness where they are
/// bent, the solver's default.
pub(crate) const LAW58: Layout = &[
    "RHO_I:density",
    "e1:stress B1=0.0 e2:stress B2=0.0 flex=0.001",
    "g0:stress gt:stress ALPHAT=0.0 gsh:stress - sensor#=",
    "DF=0.0 DS=0.0 GFROT=0.0 - - ZEROSTRESS=",
    "n1#=1 n2#=1 S1=0.0001 S2=0.0001 flex1=0.001 flex2=0.001",
    "FCT_ID1# - FSCALE1=1.0",
    "FCT_ID2# - FSCALE2=1.0",
    "FCT_ID3# - FSCALE3=1.0",
    "FCT_ID4# FCT_ID5# FSCALE4=1.0 FSCALE5=1.0 FCT_ID6# FSCALE6=1.0",
];

/// Lines of five values, as LAW36 and LAW42 have them.
pub(crate) const OF_FUNCTIONS: &str = "FUNCT_ID_1# FUNCT_ID_2# FUNCT_ID_3# FUNCT_ID_4# FUNCT_ID_5#";
pub(crate) const OF_SCALES: &str = "FSCALE_1 FSCALE_2 FSCALE_3 FSCALE_4 FSCALE_5";
pub(crate) const OF_RATES: &str = "EPS_DOT_1:rate EPS_DOT_2:rate EPS_DOT_3:rate EPS_DOT_4:rate EPS_DOT_5:rate";
pub(crate) const OF_MODULI: &str = "G_1:stress G_2:stress G_3:stress G_4:stress G_5:stress";
pub(crate) const OF_TIMES: &str = "TAU_1:time TAU_2:time TAU_3:time TAU_4:time TAU_5:time";
/// A rate of LAW43.
pub(crate) const OF_RATE: &str = "FCT_ID# - FSCALE=1.0 EPS_DOT:rate";
pub(crate) const POINT: &str = "X Y";

/// Lines with their values.
pub(crate) fn of_block(layout: Layout, system: System, values: &[Field]) -> String {
    lines(layout, Format::Mixed, system, values).expect("twenty columns hold any number")
}

/// A block with its title and lines with their values.
pub(crate) fn block(keyword: &str, title: &str, layout: Layout, system: System, values: &[Field]) -> String {
    format!("{keyword}\n{title}\n{}", of_block(layout, system, values))
}

/// A function, whose abscissas and ordinates are divided by `units`.
pub(crate) fn function(number: i64, title: &str, points: &[[f64; 2]], units: [f64; 2]) -> String {
    let mut text = format!("/FUNCT/{number}\n{title}\n");
    for (place, [x, y]) in points.iter().enumerate() {
        let point = of_block(&[POINT], System::KgMS, &[Real(x / units[0]), Real(y / units[1])]);
        // With names above the first point only.
        text += if place == 0 { &point } else { point.split_once('\n').map_or("", |(_, values)| values) };
    }
    text
}

/// The material and its curves.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    let law = &draft.film.material.law;
    match (draft.linear(law), law) {
        (Some(elastic), _) => Ok(orthotropic(draft, elastic)),
        (None, Law::Hyperelastic(law)) => rubber(draft, law),
        (None, Law::Plastic(law)) => plastic(draft, law),
        (None, _) => fabric(draft),
    }
}

/// A material with these values in the fields of its layout behind the density.
fn material(draft: &Draft<'_>, law: &str, layout: Layout, values: &[Field]) -> String {
    let values = [&[Real(draft.film.material.density)][..], values].concat();
    block(&format!("/MAT/{law}/{}", draft.request.id), draft.film.name, layout, draft.request.system, &values)
}

/// Lines of five values; none without values.
fn fives(draft: &Draft<'_>, layout: Layout, values: &[Field]) -> String {
    values.chunks(5).map(|five| of_block(layout, draft.request.system, five)).collect()
}

/// LAW19: linear, of isotropic film the same along both directions.
fn orthotropic(draft: &mut Draft<'_>, elastic: &Elastic) -> String {
    // It keeps its thickness: one element in OpenRadioss has these stresses within 0.1 % (tests/solvers/openradioss.py).
    draft.losses.push(Loss::strain_measure("LAW19, logarithmic", elastic, 1.0));
    draft.lose_beside_the_law();
    let Elastic { young, poisson } = *elastic;
    let [young, shear, poisson] = [young, young / (2.0 + 2.0 * poisson), poisson].map(Real);
    material(draft, "LAW19", LAW19, &[young, young, poisson, shear, shear, shear])
}

/// LAW58. It refers to functions by number, which stand behind it.
fn fabric(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    const DEGREES: f64 = std::f64::consts::PI / 180.0;
    let request = draft.request;
    let curves = draft.fabric_curves(false)?;
    draft.lose_beside_the_law();
    let stress = request.system.stress();
    let mut functions = CurvesBehind::new(request, function);
    let mut add = |curves: &[Points; 3], suffix: &str| {
        let named = curves.iter().zip([("MD", 1.0), ("TD", 1.0), ("shear", DEGREES)]);
        let number = |(points, (name, unit)): (&Points, (&str, f64))| {
            Whole(functions.add(&format!("{name}{suffix}"), points, [unit, stress]))
        };
        named.map(number).collect::<Vec<Field>>()
    };
    let from = curves.unloading_from(request);
    let (loading, unloading) = curves.paths(from, curves.absorption);
    let loading = add(&loading, "");
    let unloading = unloading.map_or_else(|| vec![Whole(0); 3], |unloading| add(&unloading, ", unloading"));
    if curves.absorption > 0.0 {
        draft.losses.extend([Loss::UnloadingFrom { md: from[0], td: from[1] }, Loss::ScaledUnloading]);
    }
    draft.losses.push(Loss::ShearOfPresentArea);
    let [e1, e2, shear] = curves.slopes.map(Real);
    let values = [&[e1, e2, shear, shear, shear][..], &loading[..], &unloading[..]].concat();
    Ok(material(draft, "LAW58", LAW58, &values) + &functions.text)
}

/// LAW42: Ogden's law, with Prony moduli.
fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Diagnostic> {
    let request = draft.request;
    let terms = request.ogden(law, TERMS)?;
    draft.lose_of_rubber(law);
    draft.lose_rupture_and_heat();
    let (relaxed, prony) = draft.relaxation(law);
    draft.losses.extend((!prony.is_empty()).then_some(Loss::ShellRelaxation));
    let mut values = vec![Real(request.poisson_of(law)), Whole(prony.len() as i64)];
    values.extend(padded(TERMS, terms.iter().map(|term| relaxed * term.mu)));
    values.extend(terms.iter().map(|term| Real(term.alpha)));
    let [moduli, times] = [0, 1].map(|place| prony.iter().map(|term| Real(term[place])).collect::<Vec<Field>>());
    let text = material(draft, "LAW42", LAW42, &values);
    Ok(text + &fives(draft, &[OF_MODULI], &moduli) + &fives(draft, &[OF_TIMES], &times))
}

/// LAW43 with Hill's yield function, LAW36 with von Mises'.
fn plastic(draft: &mut Draft<'_>, law: &Plastic) -> Result<String, Diagnostic> {
    let request = draft.request;
    let is_hill = lost_hill(law).is_some();
    let flow = draft.flow_curves(law, true)?;
    draft.losses.push(Loss::stress_of_volume(law.elastic(), &flow));
    draft.lose_beside_the_law();
    let mut functions = CurvesBehind::new(request, function);
    let (mut numbers, mut rates) = (vec![], vec![]);
    for (rate, curve) in &flow {
        let at = rate.map_or_else(String::new, |rate| format!(" at {rate} 1/s"));
        let title = format!("true stress over plastic strain{at}");
        numbers.push(Whole(functions.add(&title, &curve.points, [1.0, request.system.stress()])));
        rates.push(Real(rate.unwrap_or_default()));
    }
    let Elastic { young, poisson } = *law.elastic();
    let [young, poisson] = [young, poisson].map(Real);
    let text = if is_hill {
        let [r00, r45, r90] = [0.0, 45.0, 90.0_f64].map(|angle| Real(law.hill().strain_ratio(angle.to_radians())));
        let rows =
            numbers.iter().zip(&rates).map(|(number, rate)| of_block(&[OF_RATE], request.system, &[*number, *rate]));
        material(draft, "LAW43", LAW43, &[young, poisson, r00, r45, r90]) + &rows.collect::<String>()
    } else {
        let count = Whole(rates.len() as i64);
        material(draft, "LAW36", LAW36, &[young, poisson, count])
            + &fives(draft, &[OF_FUNCTIONS], &numbers)
            + &fives(draft, &[OF_SCALES], &vec![Real(1.0); rates.len()])
            + &fives(draft, &[OF_RATES], &rates)
    };
    Ok(text + &functions.text)
}
