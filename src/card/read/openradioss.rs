//! Materials of OpenRadioss, by the layouts of [`crate::openradioss`], which writes them.

use std::f64::consts::PI;

use super::entry::{self, Cell, Entry, Fields, Row};
use super::{Dialect, FoundLaw, Law, Mistake, Ordinate, Place, Reader, instantaneous};
use crate::film::Points;
use crate::openradioss::{
    LAW19, LAW36, LAW42, LAW43, LAW58, OF_FUNCTIONS, OF_MODULI, OF_RATE, OF_RATES, OF_SCALES, OF_TIMES, POINT,
};

pub(super) const DIALECT: Dialect = Dialect {
    entries: entry::blocks,
    materials: &[
        (["LAW19", "FABRI"], LAW19, orthotropic),
        (["LAW36", "PLAS_TAB"], LAW36, by_table),
        (["LAW42", "OGDEN"], LAW42, rubber),
        (["LAW43", "HILL_TAB"], LAW43, by_hill),
        (["LAW58", "FABR_A"], LAW58, fabric),
    ],
    name: |entry| if entry.name() == "MAT" { entry.word(1) } else { "" },
    number: |entry| entry.word(2),
    density: "RHO_I",
    is_passed_over: is_function,
    add_curves,
};

/// rad.
const DEGREES: f64 = PI / 180.0;

fn is_function(entry: &Entry<'_>) -> bool {
    entry.name() == "FUNCT"
}

/// Adds the functions of a card.
fn add_curves(reader: &mut Reader, all: &[Entry<'_>]) -> Result<(), Mistake> {
    for block in all.iter().filter(|entry| is_function(entry)) {
        let place = Place { line: block.line, column: 1 };
        let message = "the number of the function is missing".to_owned();
        let number = block.words.get(1).and_then(|number| number.parse().ok()).ok_or(Mistake { place, message })?;
        let point = |row: &Row<'_>| Ok([row.cell(POINT, "X").number()?, row.cell(POINT, "Y").number()?]);
        reader.curves.insert(number, block.rows.iter().map(point).collect::<Result<_, Mistake>>()?);
    }
    Ok(())
}

fn fabric(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    /// Crimp of straight fibres, and the one that the solver takes for zero.
    const STRAIGHT: f64 = 1e-3;
    const CRIMP: f64 = 0.1;
    for name in ["S1", "S2"] {
        let cell = fields.cell(name)?;
        let crimp = cell.or(CRIMP)?;
        reader.warnings.extend((crimp > STRAIGHT).then(|| cell.ignored(crimp)));
    }
    let stress = reader.system.stress();
    let scaled = |unit: f64, scale: &'static str| -> Result<[f64; 2], Mistake> {
        Ok([unit, fields.cell(scale)?.or(1.0)? * stress])
    };
    let curve = |name: &'static str, units: [f64; 2], kind| reader.curve(fields.cell(name)?, units, kind);
    let md = curve("FCT_ID1", scaled(1.0, "FSCALE1")?, Ordinate::Fibre)?;
    let td = curve("FCT_ID2", scaled(1.0, "FSCALE2")?, Ordinate::Fibre)?;
    let shear = curve("FCT_ID3", scaled(DEGREES, "FSCALE3")?, Ordinate::Shear)?;
    let loading = [md, td, shear];
    // The last line may be left out.
    let absorption =
        match [("FSCALE4", 1.0), ("FSCALE5", 1.0), ("FSCALE6", DEGREES)].map(|(name, unit)| scaled(unit, name)) {
            [Ok(md), Ok(td), Ok(shear)] => {
                let paths = [
                    ("FCT_ID4", md, Ordinate::Fibre),
                    ("FCT_ID5", td, Ordinate::Fibre),
                    ("FCT_ID6", shear, Ordinate::Shear),
                ];
                super::absorption(reader, fields, &loading, paths)
            }
            _ => 0.0,
        };
    let [md, td, shear] = loading;
    Ok((FoundLaw::Fabric { fibres: [vec![(None, md)], vec![(None, td)]], shear, absorption }, vec![]))
}

/// Linear film, which must be the same along both directions.
fn orthotropic(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let [e11, e22, shear] = ["E11", "E22", "G12"].map(|name| fields.positive(name));
    let (e11, e22, shear, poisson) = (e11?, e22?, shear?, fields.number("NU12")?);
    let is_isotropic = (e11 / e22 - 1.0).abs() < 1e-5 && (shear * (2.0 + 2.0 * poisson) / e11 - 1.0).abs() < 1e-5;
    if !is_isotropic {
        let why = "the film is not the same along both directions: no linear law here is";
        return Err(fields.cell("E22")?.mistake(why.into()));
    }
    let poisson = fields.cell("NU12")?.poisson()?;
    let reduction = fields.cell("R_E")?;
    let reduced = reduction.number()?;
    let is_ignored = reduced != 1.0 && reduced != 0.0;
    reader.warnings.extend(is_ignored.then(|| reduction.ignored(reduction.text)));
    Ok((FoundLaw::Elastic { young: e11, poisson }, vec![]))
}

fn rubber(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    reader.incompressible(fields.cell("NU")?)?;
    // Until 2025 the second line of each five was blank.
    let both = |first: usize| Ok([fields.cells(first)?, fields.cells(first + 1)?].concat());
    let (law, shear) = super::ogden(both(2)?, both(4)?)?;
    if shear <= 0.0 {
        return Err(fields.cell("MU_1")?.mistake("a shear modulus above zero is missing".into()));
    }
    let count = fields.cell("M")?.whole()?.unwrap_or(0).clamp(0, 100) as usize;
    let term = |i: usize| {
        let [modulus, time] = [of_fives(fields, 0, count, OF_MODULI, i)?, of_fives(fields, 1, count, OF_TIMES, i)?];
        Ok([modulus.positive()?, time.positive()?])
    };
    let moduli: Vec<[f64; 2]> = (0..count).map(term).collect::<Result<_, Mistake>>()?;
    Ok(instantaneous(law, shear, &moduli))
}

/// Value `i` of the list at `place` of those that stand below a material, of `count` values each in lines of five.
fn of_fives<'a>(
    fields: &Fields<'_, 'a>,
    place: usize,
    count: usize,
    names: &'static str,
    i: usize,
) -> Result<Cell<'a>, Mistake> {
    let row = fields.below(place * count.div_ceil(5) + i / 5)?;
    Ok(row.cells(names).nth(i % 5).expect("five names"))
}

/// LAW36: von Mises.
fn by_table(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let counted = fields.cell("N_FUNCT")?;
    let count = counted.whole()?.unwrap_or(0).clamp(0, 100) as usize;
    if count == 0 {
        return Err(counted.missing());
    }
    let of_row = |i: usize| {
        let cell = |place: usize, names: &'static str| of_fives(fields, place, count, names, i);
        row(reader, cell(0, OF_FUNCTIONS)?, cell(1, OF_SCALES)?.or(1.0)?, cell(2, OF_RATES)?)
    };
    let found = (0..count).map(of_row).collect::<Result<Vec<_>, Mistake>>()?;
    plastic(fields, found, None)
}

/// A flow curve with its rate.
fn row(reader: &Reader, function: Cell<'_>, scale: f64, rate: Cell<'_>) -> Result<(Points, f64), Mistake> {
    Ok((reader.curve(function, [1.0, scale * reader.system.stress()], Ordinate::Flow)?, rate.number()?))
}

/// LAW43: Hill's yield function by Lankford values.
fn by_hill(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let [r0, r45, r90] = ["R00", "R45", "R90"].map(|name| fields.positive(name));
    let r = [r0?, r45?, r90?];
    // Without I_YIELD0 the curve is the mean of all directions, and that of MD the one below.
    let md = match fields.cell("I_YIELD0")?.whole()? {
        Some(_) => 1.0,
        None => {
            let mean = 0.25 * (r[0] + 2.0 * r[1] + r[2]);
            (mean / (1.0 + mean) * (1.0 + 1.0 / r[0])).sqrt().recip()
        }
    };
    let of_row = |line: &Row<'_>| {
        let scale = md * line.cell(OF_RATE, "FSCALE").or(1.0)?;
        row(reader, line.cell(OF_RATE, "FCT_ID"), scale, line.cell(OF_RATE, "EPS_DOT"))
    };
    fields.below(0)?;
    let found = fields.rest().filter(|row| !row.is_blank()).map(of_row).collect::<Result<Vec<_>, Mistake>>()?;
    plastic(fields, found, Some(r))
}

/// Flow curves with their rates, as a table where there are several.
fn plastic(fields: &Fields<'_, '_>, rows: Vec<(Points, f64)>, hill: Option<[f64; 3]>) -> Result<Law, Mistake> {
    let young = fields.positive("E")?;
    let poisson = fields.cell("NU")?.poisson()?;
    let is_one = rows.len() == 1;
    let curves = rows.into_iter().map(|(points, rate)| ((!is_one).then_some(rate), points)).collect();
    Ok((FoundLaw::Plastic { young, poisson, curves, hill }, vec![]))
}
