//! Cards of OpenRadioss: `/MAT/…` and `/FUNCT` in the block format of 2023.
//!
//! Fields as in its configuration files (OpenRadioss, `hm_cfg_files/config/CFG`): whole numbers in 10 columns, reals in 20. Its
//! engine looks the curves of LAW58 up at engineering strain and takes their stress per undeformed width
//! (`engine/source/materials/mat/mat058/sigeps58c.F`), and shear over the angle in degrees. Its starter refuses curves that do not
//! rise, and unloading that does not meet loading (`starter/source/materials/mat/mat058/law58_upd.F`).

use super::film::{
    FabricCurves, Film, Refusal, Request, along_md, flow_curves, lost_hill, odd, ogden_terms, paths, shear_modulus,
};
use super::loss::Loss;
use super::number::in_columns;
use membrane::material::{Elastic, HyperelasticLaw, Law, Plastic};

const NAME: &str = "OpenRadioss";

/// Crimp of the fibres of LAW58: zero would be taken for 0.1.
const CRIMP: f64 = 1e-4;

/// Share of their stiffness that bent fibres of LAW58 have; its default.
const FLEX: f64 = 1e-3;

/// Terms of Ogden's law.
const TERMS: usize = 10;

/// A line of fields.
#[derive(Default)]
pub(crate) struct Line(String);

impl Line {
    pub(crate) fn real(self, value: f64) -> Line {
        // Twenty columns hold every number within the promised digits.
        let text = in_columns(value, 20).unwrap_or_default();
        Line(format!("{}{text:>20}", self.0))
    }

    pub(crate) fn whole(self, value: i64) -> Line {
        Line(format!("{}{value:>10}", self.0))
    }

    pub(crate) fn word(self, word: &str, width: usize) -> Line {
        Line(format!("{}{word:>width$}", self.0))
    }

    pub(crate) fn blank(self, width: usize) -> Line {
        Line(self.0 + &" ".repeat(width))
    }

    pub(crate) fn end(self) -> String {
        self.0.trim_end().to_owned() + "\n"
    }
}

/// Number and strain rate of a function.
type Row = (i64, f64);

/// A block with its comments.
pub(crate) struct Block(pub(crate) String);

impl Block {
    pub(crate) fn begin(keyword: &str, title: &str) -> Block {
        Block(format!("{keyword}\n{title}\n"))
    }

    /// Adds a line below the names of its fields.
    pub(crate) fn line(mut self, names: &str, line: Line) -> Block {
        self.0 += &format!("#{names}\n{}", line.end());
        self
    }
}

/// The card without its head.
pub(super) fn write(film: &Film<'_>, request: &Request, losses: &mut Vec<Loss>) -> Result<String, Refusal> {
    let body = match &film.material.law {
        Law::Fabric(_) | Law::RateFabric(_) => fabric(film, request, losses)?,
        Law::Elastic(elastic) => orthotropic(film, elastic, request, losses),
        Law::TensionField(field) => {
            losses.push(Loss::Wrinkling);
            orthotropic(film, &field.0, request, losses)
        }
        Law::Hyperelastic(law) => rubber(film, law, request, losses)?,
        Law::Plastic(law) => plastic(film, law, request, losses)?,
    };
    Ok(format!("#RADIOSS STARTER\n{body}/END\n"))
}

fn begin(film: &Film<'_>, law: &str, request: &Request) -> Block {
    let block = Block::begin(&format!("/MAT/{law}/{}", request.id), film.name);
    let density = film.material.density / request.system.density();
    block.line("              RHO_I", Line::default().real(density))
}

/// LAW19: linear, of isotropic film the same along both directions.
fn orthotropic(film: &Film<'_>, elastic: &Elastic, request: &Request, losses: &mut Vec<Loss>) -> String {
    losses.push(Loss::strain_measure("LAW19, logarithmic", elastic));
    losses.extend(film.lost_beside_the_law());
    let stress = request.system.stress();
    let (young, shear) = (elastic.young / stress, elastic.young / (2.0 + 2.0 * elastic.poisson) / stress);
    let block = begin(film, "LAW19", request)
        .line(
            "                E11                 E22                NU12",
            Line::default().real(young).real(young).real(elastic.poisson),
        )
        .line(
            "                G12                 G23                 G31",
            Line::default().real(shear).real(shear).real(shear),
        )
        .line(
            "                R_E                   ZEROSTRESS          FSCALE_POR             SENSOR",
            // No reduction in compression.
            Line::default().real(1.0),
        );
    block.0
}

/// LAW58. Its seven lines refer to functions by number, so that these are written first and stand behind it.
fn fabric(film: &Film<'_>, request: &Request, losses: &mut Vec<Loss>) -> Result<String, Refusal> {
    const DEGREES: f64 = std::f64::consts::PI / 180.0;
    let curves = FabricCurves::of(&film.material.law, request, false, losses)?.expect("a fabric");
    losses.extend(film.lost_beside_the_law());
    let stress = request.system.stress();
    let [md, td] = &curves.fibres;
    let (mut functions, mut number) = (String::new(), 100 * i64::from(request.id));
    let mut function = |title: &str, points: &[[f64; 2]], units: [f64; 2]| {
        number += 1;
        functions += &format!("/FUNCT/{number}\n{title}\n#                  X                   Y\n");
        for [x, y] in points {
            functions += &Line::default().real(x / units[0]).real(y / units[1]).end();
        }
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
        loading[place] = function(title, &whole(up.clone(), title), *units);
    }
    for (place, ((_, title, units), (_, down))) in all.iter().zip(&both).enumerate() {
        if let Some(down) = down {
            unloads[place] = function(&format!("{title}, unloading"), &whole(down.clone(), title), *units);
        }
    }
    if curves.absorption > 0.0 {
        losses.extend([Loss::UnloadingFrom { md: from[0], td: from[1] }, Loss::ScaledUnloading]);
    }
    losses.push(Loss::ShearOfPresentArea);
    let [e1, e2, shear] = curves.slopes.map(|slope| slope / stress);
    let [fct1, fct2, fct3] = loading;
    let [fct4, fct5, fct6] = unloads;
    let scale = |function: i64| Line::default().whole(function).blank(10).real(1.0);
    let block = begin(film, "LAW58", request)
        .line(
            "                 E1                  B1                  E2                  B2                FLEX",
            Line::default().real(e1).real(0.0).real(e2).real(0.0).real(FLEX),
        )
        .line(
            "                 G0                  GT              ALPHAT                 GSH              SENSOR",
            Line::default().real(shear).real(shear).real(0.0).real(shear),
        )
        .line(
            "                 DF                  DS               GFROT                          ZEROSTRESS",
            Line::default().real(0.0).real(0.0).real(0.0),
        )
        .line(
            "       N1        N2                  S1                  S2               FLEX1               FLEX2",
            Line::default().whole(1).whole(1).real(CRIMP).real(CRIMP).real(FLEX).real(FLEX),
        )
        .line("  FCT_ID1                       FSCALE1", scale(fct1))
        .line("  FCT_ID2                       FSCALE2", scale(fct2))
        .line("  FCT_ID3                       FSCALE3", scale(fct3))
        .line(
            "  FCT_ID4   FCT_ID5             FSCALE4             FSCALE5   FCT_ID6             FSCALE6",
            Line::default().whole(fct4).whole(fct5).real(1.0).real(1.0).whole(fct6).real(1.0),
        );
    Ok(block.0 + &functions)
}

/// LAW42: Ogden's law, with Prony moduli.
fn rubber(
    film: &Film<'_>,
    law: &HyperelasticLaw,
    request: &Request,
    losses: &mut Vec<Loss>,
) -> Result<String, Refusal> {
    let terms = match (ogden_terms(law), law) {
        (Some(terms), _) => terms,
        (None, HyperelasticLaw::Polynomial(_)) => return Err(no_law("Yeoh's energy")),
        (None, HyperelasticLaw::Gent(_)) => return Err(no_law("Gent's energy")),
        (None, _) => return Err(no_law("compressible neo-Hookean film")),
    };
    if terms.len() > TERMS {
        return Err(Refusal::TooManyTerms { target: NAME, terms: terms.len(), most: TERMS });
    }
    losses.push(Loss::Compressible { poisson: request.poisson_of(law) });
    losses.extend(film.wrinkling().then_some(Loss::Wrinkling));
    losses.extend(film.lost_to_rupture_and_heat());
    let stress = request.system.stress();
    let viscosity = film.material.viscosity.as_ref();
    let relaxed = viscosity.map_or(1.0, |viscosity| viscosity.instant() * viscosity.long_term());
    let prony = viscosity.map_or(&[][..], |viscosity| viscosity.terms());
    losses.extend(viscosity.map(|_| Loss::LinearViscosity));
    let five = |value: &dyn Fn(usize) -> Option<f64>, from: usize| {
        (from..from + 5).map_while(value).fold(Line::default(), Line::real)
    };
    let mu = |i: usize| terms.get(i).map(|term| relaxed * term.mu / stress);
    let alpha = |i: usize| terms.get(i).map(|term| term.alpha);
    let head = Line::default()
        .real(request.poisson_of(law))
        .real(0.0)
        .whole(0)
        .whole(0)
        .real(1.0)
        .whole(prony.len() as i64)
        .whole(0);
    let mut block = begin(film, "LAW42", request)
        .line(
            "                 NU           SIGMA_CUT         J FUNIDBULK         FSCALE_BULK         M     IFORM",
            head,
        )
        .line(
            "               MU_1                MU_2                MU_3                MU_4                MU_5",
            five(&mu, 0),
        )
        .line(
            "               MU_6                MU_7                MU_8                MU_9               MU_10",
            five(&mu, 5),
        )
        .line(
            "            ALPHA_1             ALPHA_2             ALPHA_3             ALPHA_4             ALPHA_5",
            five(&alpha, 0),
        )
        .line(
            "            ALPHA_6             ALPHA_7             ALPHA_8             ALPHA_9            ALPHA_10",
            five(&alpha, 5),
        );
    let instant = viscosity.map_or(1.0, |viscosity| viscosity.instant()) * shear_modulus(law);
    for (title, value) in [
        ("                G_1                 G_2                 G_3                 G_4                 G_5", true),
        ("              TAU_1               TAU_2               TAU_3               TAU_4               TAU_5", false),
    ] {
        for five in prony.chunks(5) {
            let of = |term: &membrane::material::PronyTerm| match value {
                true => instant * term.share / stress,
                false => term.time / request.system.time(),
            };
            block = block.line(title, five.iter().map(of).fold(Line::default(), Line::real));
        }
    }
    Ok(block.0)
}

fn no_law(law: &'static str) -> Refusal {
    Refusal::NoLaw { target: NAME, law }
}

/// LAW43 with Hill's yield function, LAW36 with von Mises'.
fn plastic(film: &Film<'_>, law: &Plastic, request: &Request, losses: &mut Vec<Loss>) -> Result<String, Refusal> {
    let is_hill = lost_hill(law).is_some();
    let flow = flow_curves(law, along_md(law), request, true, losses)?;
    losses.push(Loss::StressOfVolume);
    losses.extend(film.lost_beside_the_law());
    let (stress, time) = (request.system.stress(), request.system.time());
    let Elastic { young, poisson } = law.elastic();
    let elastic = Line::default().real(young / stress).real(*poisson);
    let (mut functions, mut number) = (String::new(), 100 * i64::from(request.id));
    let mut rows = vec![];
    for (rate, sampled) in &flow {
        number += 1;
        functions += &format!("/FUNCT/{number}\ntrue stress over plastic strain");
        functions += &rate.map_or_else(String::new, |rate| format!(" at {rate} 1/s"));
        functions += "\n#                  X                   Y\n";
        for [p, sigma] in &sampled.points {
            functions += &Line::default().real(*p).real(sigma / stress).end();
        }
        rows.push((number, rate.unwrap_or_default() * time));
    }
    // No failure: neither by plastic strain nor by tension.
    const NEVER: f64 = 1e30;
    let block = if is_hill {
        let [r00, r45, r90] = [0.0, 45.0, 90.0_f64].map(|angle| law.hill().strain_ratio(angle.to_radians()));
        let mut block = begin(film, "LAW43", request)
            .line("                  E                  NU", elastic)
            .line(
                "  FCT_IDE                          EINF                  CE",
                Line::default().whole(0).blank(10).real(0.0).real(0.0),
            )
            .line(
                "                R00                 R45                 R90              C_HARD   I_YIELD0",
                // Lankford values, and the curve of MD: a zero would make it the mean of all directions.
                Line::default().real(r00).real(r45).real(r90).real(0.0).whole(1),
            )
            .line(
                "          EPS_P_MAX               EPS_T               EPS_M              F_CUT  F_SMOOTH",
                Line::default().real(NEVER).real(NEVER).real(NEVER).real(0.0).whole(0),
            );
        for (function, rate) in &rows {
            let line = Line::default().whole(*function).blank(10).real(1.0).real(*rate);
            block = block.line("   FCT_ID                        FSCALE             EPS_DOT", line);
        }
        block
    } else {
        let of_five = |block: Block, title: &str, line: &dyn Fn(&[Row]) -> Line| {
            rows.chunks(5).fold(block, |block, five| block.line(title, line(five)))
        };
        let block = begin(film, "LAW36", request)
            .line(
                "                  E                  NU           EPS_P_MAX               EPS_T               EPS_M",
                elastic.real(NEVER).real(NEVER).real(NEVER),
            )
            .line(
                "  N_FUNCT  F_SMOOTH              C_HARD               F_CUT               EPS_F                  VP",
                Line::default().whole(rows.len() as i64).whole(0).real(0.0).real(0.0).real(NEVER).blank(10).whole(1),
            )
            .line(
                "  FCT_IDP              FSCALE   FCT_IDE                EINF                  CE",
                Line::default().whole(0).real(1.0).whole(0).real(0.0).real(0.0),
            );
        let whole = |five: &[Row]| five.iter().fold(Line::default(), |line, (function, _)| line.whole(*function));
        let ones = |five: &[Row]| five.iter().fold(Line::default(), |line, _| line.real(1.0));
        let rates = |five: &[Row]| five.iter().fold(Line::default(), |line, (_, rate)| line.real(*rate));
        let block = of_five(block, "  FUNCT_ID of each rate", &whole);
        let block = of_five(
            block,
            "           FSCALE_1            FSCALE_2            FSCALE_3            FSCALE_4            FSCALE_5",
            &ones,
        );
        of_five(
            block,
            "          EPS_DOT_1           EPS_DOT_2           EPS_DOT_3           EPS_DOT_4           EPS_DOT_5",
            &rates,
        )
    };
    Ok(block.0 + &functions)
}
