//! Materials of OpenRadioss: fields as in [`crate::openradioss`], which writes them.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::blocks::{Block, Field, Line, blocks, real, whole};
use super::curve::{self, Ordinate, of_film};
use super::{Fault, Found, FoundLaw, Mistake, Place, Points, Reading, Warning, instantaneous};
use crate::system::System;

/// Laws that are read, by number and name.
const LAWS: [(&str, &str); 5] =
    [("LAW19", "FABRI"), ("LAW36", "PLAS_TAB"), ("LAW42", "OGDEN"), ("LAW43", "HILL_TAB"), ("LAW58", "FABR_A")];

/// Least Poisson's ratio that stands for incompressible film.
const INCOMPRESSIBLE: f64 = 0.49;

/// A limit that is never reached, which stands for none.
const NEVER: f64 = 1e20;

/// Reads a card.
pub(super) fn read(text: &str, system: System, wanted: Option<&str>) -> Result<Reading, Mistake> {
    let all = blocks(text)?;
    let known: Vec<&Block<'_>> = all.iter().filter(|block| law(block).is_some()).collect();
    let nowhere = |fault: Fault| Mistake { place: Place { line: 1, column: 1 }, fault };
    let named = |block: &&&Block<'_>| {
        wanted.is_none_or(|wanted| block.title == wanted || block.words.get(2).is_some_and(|number| number == wanted))
    };
    let chosen = known.iter().find(named).ok_or_else(|| match (wanted, known.is_empty()) {
        (Some(wanted), false) => nowhere(Fault::NoSuchMaterial(wanted.to_owned())),
        _ => nowhere(Fault::NoMaterial),
    })?;
    let mut reader = Reader { system, functions: functions(&all)?, warnings: vec![] };
    let others = all.iter().filter(|block| law(block).is_none() && block.words[0] != "FUNCT");
    let ignored =
        others.map(|block| Warning::Keyword { line: block.line, name: format!("/{}", block.words.join("/")) });
    reader.warnings.extend(ignored);
    let film = reader.film(chosen)?;
    if known.len() > 1 {
        reader.warnings.push(Warning::Others { read: film.name.clone(), others: known.len() - 1 });
    }
    Ok(Reading { film, warnings: reader.warnings })
}

/// The number of a block's law, where that is read.
fn law(block: &Block<'_>) -> Option<&'static str> {
    let [kind, name, ..] = &block.words[..] else { return None };
    let found = LAWS.iter().find(|(number, alias)| name == number || name == alias);
    found.filter(|_| kind == "MAT").map(|(number, _)| *number)
}

fn functions(all: &[Block<'_>]) -> Result<BTreeMap<i64, Points>, Mistake> {
    let mut found = BTreeMap::new();
    for block in all.iter().filter(|block| block.words[0] == "FUNCT") {
        let place = Place { line: block.line, column: 1 };
        let fault = Fault::Missing { name: "the number of the function" };
        let number = block.words.get(1).and_then(|number| number.parse().ok()).ok_or(Mistake { place, fault })?;
        let point = |line: &Line<'_>| Ok([line.value(real("X", 0))?, line.value(real("Y", 2))?]);
        found.insert(number, block.lines.iter().map(point).collect::<Result<_, Mistake>>()?);
    }
    Ok(found)
}

/// rad.
const DEGREES: f64 = PI / 180.0;

/// Reads one material.
struct Reader {
    system: System,
    functions: BTreeMap<i64, Points>,
    warnings: Vec<Warning>,
}

impl Reader {
    fn film(&mut self, block: &Block<'_>) -> Result<Found, Mistake> {
        let density = block.line(0)?.positive(real("RHO_I", 0))? * self.system.density();
        let name = match (block.title, block.words.get(2)) {
            ("", Some(number)) => number.clone(),
            (title, _) => title.to_owned(),
        };
        let (law, prony) = match law(block) {
            Some("LAW58") => (self.fabric(block)?, vec![]),
            Some("LAW42") => self.rubber(block)?,
            Some("LAW19") => (self.orthotropic(block)?, vec![]),
            Some("LAW36") => (self.by_table(block)?, vec![]),
            _ => (self.by_hill(block)?, vec![]),
        };
        Ok(Found { name, density, law, prony })
    }

    /// Warns of fields that are not zero and no limit that is never reached.
    fn unread(&mut self, line: Line<'_>, fields: &[Field]) {
        for field in fields {
            let text = line.text(*field);
            let value = super::fields::number(text);
            if !text.is_empty() && value.is_none_or(|value| value != 0.0 && value < NEVER) {
                let (name, value) = (field.name.to_owned(), text.to_owned());
                self.warnings.push(Warning::Field { line: line.number(), name, value });
            }
        }
    }

    /// The function that a field names, as a curve of a film whose abscissas are times `unit`, its ordinates times the scale.
    fn curve(&self, line: Line<'_>, field: Field, scale: Field, unit: f64, kind: Ordinate) -> Result<Points, Mistake> {
        let number = line.function(field)?.ok_or_else(|| line.mistake(field, Fault::Missing { name: field.name }))?;
        let points = self.functions.get(&number).ok_or_else(|| line.mistake(field, Fault::NoCurve(number)))?;
        let factor = match line.value(scale)? {
            0.0 => self.system.stress(),
            factor => factor * self.system.stress(),
        };
        let scaled = points.iter().map(|[x, y]| [x * unit, y * factor]).collect();
        of_film(scaled, kind).map_err(|why| line.mistake(field, Fault::BadCurve { curve: number, why: why.to_owned() }))
    }

    fn fabric(&mut self, block: &Block<'_>) -> Result<FoundLaw, Mistake> {
        self.unread(block.line(1)?, &[real("B1", 2), real("B2", 6)]);
        self.unread(block.line(2)?, &[real("ALPHAT", 4)]);
        self.unread(block.line(3)?, &[real("DF", 0), real("DS", 2), real("GFROT", 4), whole("ZEROSTRESS", 8)]);
        self.crimp(block.line(4)?)?;
        let curve = |place: usize, name: &'static str, unit: f64, kind| {
            self.curve(block.line(place)?, whole(name, 0), real("FSCALE", 2), unit, kind)
        };
        let fibre = |place: usize, name: &'static str| curve(place, name, 1.0, Ordinate::Fibre);
        let (md, td) = (fibre(5, "FCT_ID1")?, fibre(6, "FCT_ID2")?);
        let shear = curve(7, "FCT_ID3", DEGREES, Ordinate::Shear)?;
        let absorption = block.line(8).map_or(0.0, |line| self.absorption(line, [&md, &td, &shear]));
        Ok(FoundLaw::Fabric { fibres: [vec![(None, md)], vec![(None, td)]], shear, absorption })
    }

    /// Warns of fibres that are longer than the film: the solver takes zero for a tenth.
    fn crimp(&mut self, line: Line<'_>) -> Result<(), Mistake> {
        const STRAIGHT: f64 = 1e-3;
        for field in [real("S1", 2), real("S2", 4)] {
            let crimp = Some(line.value(field)?).filter(|crimp| *crimp != 0.0).unwrap_or(0.1);
            if crimp > STRAIGHT {
                let (name, value) = (field.name.to_owned(), crimp.to_string());
                self.warnings.push(Warning::Field { line: line.number(), name, value });
            }
        }
        Ok(())
    }

    /// The absorption that unloading curves stand for; where they are others, they are not read.
    fn absorption(&mut self, line: Line<'_>, [md, td, shear]: [&Points; 3]) -> f64 {
        let path = |function: Field, scale: Field, unit: f64, kind| self.curve(line, function, scale, unit, kind).ok();
        let paths = [
            (md, path(whole("FCT_ID4", 0), real("FSCALE4", 2), 1.0, Ordinate::Fibre)),
            (td, path(whole("FCT_ID5", 1), real("FSCALE5", 4), 1.0, Ordinate::Fibre)),
            (shear, path(whole("FCT_ID6", 6), real("FSCALE6", 7), DEGREES, Ordinate::Shear)),
        ];
        curve::absorption(paths).unwrap_or_else(|| {
            self.unread(line, &[whole("FCT_ID4", 0), whole("FCT_ID5", 1), whole("FCT_ID6", 6)]);
            0.0
        })
    }

    /// Linear film, which must be the same along both directions.
    fn orthotropic(&mut self, block: &Block<'_>) -> Result<FoundLaw, Mistake> {
        let (moduli, shears) = (block.line(1)?, block.line(2)?);
        let [e11, e22] = [moduli.positive(real("E11", 0))?, moduli.positive(real("E22", 2))?];
        let (poisson, shear) = (moduli.value(real("NU12", 4))?, shears.positive(real("G12", 0))?);
        let is_isotropic = (e11 / e22 - 1.0).abs() < 1e-5 && (shear * (2.0 + 2.0 * poisson) / e11 - 1.0).abs() < 1e-5;
        if !is_isotropic {
            let fault = Fault::Unknown("the film is not the same along both directions: no linear law here is".into());
            return Err(moduli.mistake(real("E22", 2), fault));
        }
        if !(0.0..0.5).contains(&poisson) {
            let fault = Fault::Outside { name: "NU12", value: poisson, expected: "0 to less than 0.5" };
            return Err(moduli.mistake(real("NU12", 4), fault));
        }
        let line = block.line(3)?;
        if line.value(real("R_E", 0))? != 1.0 {
            self.unread(line, &[real("R_E", 0)]);
        }
        Ok(FoundLaw::Elastic { young: e11 * self.system.stress(), poisson })
    }

    fn rubber(&mut self, block: &Block<'_>) -> Result<(FoundLaw, Vec<[f64; 2]>), Mistake> {
        let head = block.line(1)?;
        if head.value(real("NU", 0))? < INCOMPRESSIBLE {
            self.unread(head, &[real("NU", 0)]);
        }
        self.unread(head, &[real("SIGMA_CUT", 2), whole("FUNIDBULK", 5), whole("IFORM", 9)]);
        let stress = self.system.stress();
        let five = |place: usize, name: &'static str| -> Result<Vec<f64>, Mistake> {
            let line = block.line(place)?;
            (0..5).map(|i| line.value(real(name, 2 * i))).collect()
        };
        // Until 2025 the second line of each five was blank.
        let mu = [five(2, "MU")?, five(3, "MU")?].concat();
        let alpha = [five(4, "ALPHA")?, five(5, "ALPHA")?].concat();
        let terms: Vec<[f64; 2]> = mu.iter().zip(alpha).map(|(mu, alpha)| [mu * stress, alpha]).collect();
        let terms: Vec<[f64; 2]> = terms.into_iter().filter(|[mu, alpha]| mu * alpha != 0.0).collect();
        let shear = 0.5 * terms.iter().map(|[mu, alpha]| mu * alpha).sum::<f64>();
        if shear <= 0.0 {
            let fault = Fault::Missing { name: "a shear modulus above zero" };
            return Err(block.line(2)?.mistake(real("MU", 0), fault));
        }
        let count = head.function(whole("M", 8))?.unwrap_or(0).clamp(0, 100) as usize;
        let rows = count.div_ceil(5);
        let term = |i: usize| {
            let [moduli, times] = [block.line(6 + i / 5)?, block.line(6 + rows + i / 5)?];
            let place = 2 * (i % 5);
            Ok([
                moduli.positive(real("G_I", place))? * stress,
                times.positive(real("TAU_I", place))? * self.system.time(),
            ])
        };
        let moduli: Vec<[f64; 2]> = (0..count).map(term).collect::<Result<_, Mistake>>()?;
        Ok(instantaneous(FoundLaw::Ogden(terms), shear, &moduli))
    }

    /// Rows of functions with scale and rate, as a table by rate.
    fn table(&self, rows: Vec<(Points, f64)>) -> Vec<(Option<f64>, Points)> {
        match rows.len() {
            1 => rows.into_iter().map(|(points, _)| (None, points)).collect(),
            _ => rows.into_iter().map(|(points, rate)| (Some(rate / self.system.time()), points)).collect(),
        }
    }

    /// LAW36: von Mises.
    fn by_table(&mut self, block: &Block<'_>) -> Result<FoundLaw, Mistake> {
        let (elastic, counts) = (block.line(1)?, block.line(2)?);
        self.unread(elastic, &[real("EPS_P_MAX", 4), real("EPS_T", 6), real("EPS_M", 8)]);
        self.unread(counts, &[real("C_HARD", 2), real("EPS_F", 6)]);
        self.unread(block.line(3)?, &[whole("FCT_IDP", 0), whole("FCT_IDE", 3)]);
        let count = counts.function(whole("N_FUNCT", 0))?.unwrap_or(0).clamp(0, 100) as usize;
        if count == 0 {
            return Err(counts.mistake(whole("N_FUNCT", 0), Fault::Missing { name: "N_FUNCT" }));
        }
        let rows = count.div_ceil(5);
        let row = |i: usize| {
            let (numbers, scales) = (block.line(4 + i / 5)?, block.line(4 + rows + i / 5)?);
            let rates = block.line(4 + 2 * rows + i / 5)?;
            // The scale stands in a line of its own.
            let (place, wide) = (i % 5, 2 * (i % 5));
            let field = whole("FUNCT_ID", place);
            let points = self.curve(numbers, field, real("FSCALE", 9), 1.0, Ordinate::Flow)?;
            let factor = Some(scales.value(real("FSCALE", wide))?).filter(|factor| *factor != 0.0).unwrap_or(1.0);
            let points = points.into_iter().map(|[x, y]| [x, factor * y]).collect();
            Ok((points, rates.value(real("EPS_DOT", wide))?))
        };
        let found = (0..count).map(row).collect::<Result<Vec<_>, Mistake>>()?;
        self.plastic(elastic, self.table(found), None)
    }

    /// LAW43: Hill's yield function by Lankford values.
    fn by_hill(&mut self, block: &Block<'_>) -> Result<FoundLaw, Mistake> {
        let (elastic, ratios) = (block.line(1)?, block.line(3)?);
        self.unread(block.line(2)?, &[whole("FCT_IDE", 0)]);
        self.unread(ratios, &[real("C_HARD", 6)]);
        self.unread(block.line(4)?, &[real("EPS_P_MAX", 0), real("EPS_T", 2), real("EPS_M", 4)]);
        let r = [ratios.positive(real("R00", 0))?, ratios.positive(real("R45", 2))?, ratios.positive(real("R90", 4))?];
        // Without I_YIELD0 the curve is the mean of all directions, and that of MD the one below.
        let md = match ratios.function(whole("I_YIELD0", 8))? {
            Some(_) => 1.0,
            None => {
                let mean = 0.25 * (r[0] + 2.0 * r[1] + r[2]);
                (mean / (1.0 + mean) * (1.0 + 1.0 / r[0])).sqrt().recip()
            }
        };
        let row = |line: &Line<'_>| {
            let points = self.curve(*line, whole("FCT_ID", 0), real("FSCALE", 2), 1.0, Ordinate::Flow)?;
            let points = points.into_iter().map(|[x, y]| [x, md * y]).collect();
            Ok((points, line.value(real("EPS_DOT", 4))?))
        };
        let rows = block.lines[5.min(block.lines.len())..].iter().filter(|line| !line.is_blank());
        let found = rows.map(row).collect::<Result<Vec<_>, Mistake>>()?;
        if found.is_empty() {
            return Err(block.line(5).err().unwrap_or_else(|| ratios.mistake(real("R00", 0), Fault::NoMaterial)));
        }
        self.plastic(elastic, self.table(found), Some(r))
    }

    fn plastic(
        &self,
        elastic: Line<'_>,
        curves: Vec<(Option<f64>, Points)>,
        hill: Option<[f64; 3]>,
    ) -> Result<FoundLaw, Mistake> {
        let young = elastic.positive(real("E", 0))? * self.system.stress();
        let poisson = elastic.value(real("NU", 2))?;
        if !(0.0..0.5).contains(&poisson) {
            let fault = Fault::Outside { name: "NU", value: poisson, expected: "0 to less than 0.5" };
            return Err(elastic.mistake(real("NU", 2), fault));
        }
        Ok(FoundLaw::Plastic { young, poisson, curves, hill })
    }
}
