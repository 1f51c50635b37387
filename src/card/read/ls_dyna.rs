//! Materials of LS-DYNA, by the layouts of [`crate::ls_dyna`], which writes them.

use super::entry::{self, Cell, Entry, Fields, Row};
use super::{Dialect, FoundLaw, Law, Mistake, Ordinate, Reader, instantaneous, no_curve};
use crate::film::{Points, Rated};
use crate::ls_dyna::{CURVE, ELASTIC, FABRIC, HYSTERETIC, OGDEN, PLASTIC, POLYNOMIAL, PRONY, TABLE};

pub(super) const DIALECT: Dialect = Dialect {
    entries: entry::keywords,
    materials: &[
        (["MAT_FABRIC", "MAT_034"], FABRIC, fabric),
        (["MAT_ELASTIC", "MAT_001"], ELASTIC, elastic),
        (["MAT_HYPERELASTIC_RUBBER", "MAT_077_H"], POLYNOMIAL, polynomial),
        (["MAT_OGDEN_RUBBER", "MAT_077_O"], OGDEN, ogden),
        (["MAT_PIECEWISE_LINEAR_PLASTICITY", "MAT_024"], PLASTIC, plastic),
    ],
    name: |entry| entry.name(),
    number: |entry| entry.row(0).map_or("", |row| row.cell(ELASTIC[0], "mid").text),
    density: "RO",
    is_passed_over: |entry| matches!(entry.name(), "KEYWORD" | "TITLE") || is_curve(entry) || is_table(entry),
    add_curves,
};

/// A point of a curve, a row of a table, and one of a table of two dimensions.
const POINT: &str = "A O";
const OF_TABLE: &str = "VALUE CURVE";

fn is_curve(entry: &Entry<'_>) -> bool {
    entry.name() == "DEFINE_CURVE"
}

fn is_table(entry: &Entry<'_>) -> bool {
    matches!(entry.name(), "DEFINE_TABLE" | "DEFINE_TABLE_2D")
}

/// Adds curves and tables as the solver has them: scaled and shifted.
fn add_curves(reader: &mut Reader, all: &[Entry<'_>]) -> Result<(), Mistake> {
    for (place, keyword) in all.iter().enumerate().filter(|(_, entry)| is_curve(entry) || is_table(entry)) {
        let head = |name: &'static str| Ok(keyword.row(0)?.cell(if is_curve(keyword) { CURVE } else { TABLE }, name));
        let number = head(if is_curve(keyword) { "LCID" } else { "TBID" })?;
        let number = number.whole()?.ok_or_else(|| number.missing())?;
        // Left out, scales are 1.
        let (factor, shift) = (head("SFA")?.or(1.0)?, head("OFFA")?.number()?);
        let abscissa = |cell: Cell<'_>| Ok(factor * (cell.number()? + shift));
        let rows = &keyword.rows[1..];
        if is_curve(keyword) {
            let (scale, offset) = (head("SFO")?.or(1.0)?, head("OFFO")?.number()?);
            let point = |row: &Row<'_>| {
                Ok([abscissa(row.cell(POINT, "A"))?, scale * (row.cell(POINT, "O").number()? + offset)])
            };
            reader.curves.insert(number, rows.iter().map(point).collect::<Result<_, Mistake>>()?);
            continue;
        }
        // The curves of a table follow it; those of a two-dimensional one are named.
        let mut next = all[place + 1..].iter().filter(|entry| is_curve(entry));
        let mut row = |row: &Row<'_>| {
            let (value, named) = (row.cell(OF_TABLE, "VALUE"), row.cell(OF_TABLE, "CURVE"));
            let curve = match keyword.name() {
                "DEFINE_TABLE" => {
                    let curve = next.next().ok_or_else(|| value.mistake(no_curve(number)))?;
                    curve.row(0)?.cell(CURVE, "LCID")
                }
                _ => named,
            };
            Ok((abscissa(value)?, curve.whole()?.ok_or_else(|| named.missing())?))
        };
        reader.tables.insert(number, rows.iter().map(&mut row).collect::<Result<_, Mistake>>()?);
    }
    Ok(())
}

fn elastic(_: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let young = fields.positive("E")?;
    Ok((FoundLaw::Elastic { young, poisson: fields.cell("PR")?.poisson()? }, vec![]))
}

fn fabric(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let form = fields.cell("FORM")?;
    let number = form.whole()?.unwrap_or(0);
    if !matches!(number, 14 | -14) {
        return Err(form.mistake(format!(
            "FORM {number} is not read: of the forms with curves, 14 and -14 have engineering stress over engineering strain"
        )));
    }
    let units = [1.0, reader.system.stress()];
    let fibre = |name: &'static str| by_rate(reader, fields.cell(name)?, Ordinate::Fibre);
    let fibres = [fibre("LCA")?, fibre("LCB")?];
    let shear = reader.curve(fields.cell("LCAB")?, units, Ordinate::Shear)?;
    // Of several rates the slowest is the one that unloading curves are of.
    let slowest = |fibre: &[Rated<Points>]| fibre.first().map_or_else(Points::new, |(_, curve)| curve.clone());
    let paths = [("LCUA", Ordinate::Fibre), ("LCUB", Ordinate::Fibre), ("LCUAB", Ordinate::Shear)];
    let loading = [slowest(&fibres[0]), slowest(&fibres[1]), shear.clone()];
    let mut absorption = super::absorption(reader, fields, &loading, paths.map(|(name, kind)| (name, units, kind)));
    if number == -14 {
        let row = fields.below(0)?;
        let share = row.cell(HYSTERETIC, "H");
        absorption = share.number()?;
        if !(0.0..1.0).contains(&absorption) {
            return Err(share.outside(absorption, "0 to less than 1"));
        }
        let besides = fields.of_row(HYSTERETIC, &row).into_iter().filter(|warning| !warning.is_of("H"));
        reader.warnings.extend(besides);
    }
    Ok((FoundLaw::Fabric { fibres, shear, absorption }, vec![]))
}

/// The curve or the table by rate that a field names.
fn by_rate(reader: &Reader, cell: Cell<'_>, kind: Ordinate) -> Result<Vec<Rated<Points>>, Mistake> {
    let units = [1.0, reader.system.stress()];
    let number = cell.whole()?.ok_or_else(|| cell.missing())?;
    let Some(table) = reader.tables.get(&number) else {
        return Ok(vec![(None, reader.curve(cell, units, kind)?)]);
    };
    let row = |(rate, curve): &(f64, i64)| {
        let rate = rate / reader.system.time();
        if rate > 0.0 {
            Ok((Some(rate), reader.numbered(cell, *curve, units, kind)?))
        } else {
            let why = "a table by strain rate has rates above zero".to_owned();
            Err(cell.mistake(format!("curve {number}: {why}")))
        }
    };
    table.iter().map(row).collect()
}

fn ogden(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    unfitted(reader, fields)?;
    let (law, shear) = super::ogden(fields.cells(1)?, fields.cells(2)?)?;
    relaxing(reader, fields, law, shear, "MU1")
}

fn polynomial(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    unfitted(reader, fields)?;
    let c = |name: &'static str| fields.number(name);
    let found = [c("C10")?, c("C01")?, c("C20")?, c("C30")?];
    // Yeoh's energy has no C01.
    let is_yeoh = found[2] != 0.0 || found[3] != 0.0;
    for name in ["C11", "C02"].into_iter().chain(is_yeoh.then_some("C01")) {
        let cell = fields.cell(name)?;
        if cell.number()? != 0.0 {
            return Err(cell.mistake(format!("{name} is of an energy that is not known here")));
        }
    }
    relaxing(reader, fields, FoundLaw::Polynomial(found), 2.0 * (found[0] + found[1]), "C10")
}

/// Incompressible film whose constants are those of the card.
fn unfitted(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<(), Mistake> {
    let fitted = fields.cell("N")?;
    if fitted.number()? != 0.0 {
        return Err(fitted.mistake("N is not 0: constants that the solver fits are not read".into()));
    }
    reader.incompressible(fields.cell("PR")?)
}

/// Rubber with this shear modulus, whose first constant has the name `first`, and with the Prony terms below it.
fn relaxing(
    reader: &mut Reader,
    fields: &Fields<'_, '_>,
    law: FoundLaw,
    shear: f64,
    first: &'static str,
) -> Result<Law, Mistake> {
    if shear <= 0.0 {
        return Err(fields.cell(first)?.mistake("a shear modulus above zero is missing".into()));
    }
    let mut moduli = vec![];
    for row in fields.rest() {
        let [modulus, decay] = ["GI", "BETAI"].map(|name| row.cell(PRONY, name).positive());
        moduli.push([modulus?, 1.0 / decay?]);
        let flag = row.cell(PRONY, "VFLAG");
        reader.warnings.extend((flag.number() != Ok(0.0)).then(|| flag.ignored(flag.text)));
    }
    Ok(instantaneous(law, shear, &moduli))
}

fn plastic(reader: &mut Reader, fields: &Fields<'_, '_>) -> Result<Law, Mistake> {
    let young = fields.positive("E")?;
    let curve = fields.cell("LCSS")?;
    let curves = match curve.whole()? {
        Some(_) => {
            // Its first point is the initial yield stress.
            fields.number("SIGY")?;
            by_rate(reader, curve, Ordinate::Flow)?
        }
        None => vec![(None, tabulated(fields, young)?)],
    };
    let poisson = fields.cell("PR")?.poisson()?;
    Ok((FoundLaw::Plastic { young, poisson, curves, hill: None }, vec![]))
}

/// Hardening by points of the material itself, or by a tangent modulus.
fn tabulated(fields: &Fields<'_, '_>, young: f64) -> Result<Points, Mistake> {
    let initial = fields.positive("SIGY")?;
    if let (Ok(strains), Ok(stresses)) = (fields.cells(2), fields.cells(3)) {
        let point = |(x, y): (&Cell<'_>, &Cell<'_>)| Ok([x.number()?, y.number()?]);
        let points: Points = strains.iter().zip(&stresses).map(point).collect::<Result<_, Mistake>>()?;
        // Strains after the last one are left out.
        let count = 1 + points.windows(2).take_while(|ends| ends[1][0] > ends[0][0]).count();
        if count > 1 {
            let points = points[..count].to_vec();
            let falls = points.windows(2).any(|ends| ends[1][1] < ends[0][1]);
            let why = "the stress falls, where film would localise in one row of elements";
            return if falls { Err(stresses[0].mistake(why.into())) } else { Ok(points) };
        }
    }
    let cell = fields.cell("ETAN")?;
    let tangent = cell.number()?;
    if !(0.0..young).contains(&tangent) {
        return Err(cell.outside(cell.written()?, "0 to less than E"));
    }
    Ok(vec![[0.0, initial], [1.0, initial + young * tangent / (young - tangent)]])
}
