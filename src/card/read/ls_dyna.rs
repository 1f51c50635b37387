//! Materials of LS-DYNA: fields as in [`crate::ls_dyna`], which writes them.

use std::collections::BTreeMap;

use super::curve::{self, Ordinate, of_film};
use super::fields::{Card, Keyword, keywords};
use super::{Fault, Found, FoundLaw, Mistake, Place, Points, Reading, Warning, instantaneous};
use crate::system::System;

/// Names of materials that are read, those of their numbers among them.
const FABRIC: [&str; 2] = ["MAT_FABRIC", "MAT_034"];
const ELASTIC: [&str; 2] = ["MAT_ELASTIC", "MAT_001"];
const POLYNOMIAL: [&str; 2] = ["MAT_HYPERELASTIC_RUBBER", "MAT_077_H"];
const OGDEN: [&str; 2] = ["MAT_OGDEN_RUBBER", "MAT_077_O"];
const PLASTIC: [&str; 2] = ["MAT_PIECEWISE_LINEAR_PLASTICITY", "MAT_024"];

/// Keywords that say nothing of a film, and those that are read with one.
const OTHERS: [&str; 5] = ["KEYWORD", "TITLE", "DEFINE_CURVE", "DEFINE_TABLE", "DEFINE_TABLE_2D"];

/// Least Poisson's ratio that stands for incompressible film.
const INCOMPRESSIBLE: f64 = 0.49;

/// Reads a card.
pub(super) fn read(text: &str, system: System, wanted: Option<&str>) -> Result<Reading, Mistake> {
    let all = keywords(text)?;
    let known: Vec<&Keyword<'_>> = all.iter().filter(|keyword| is_known(keyword)).collect();
    let nowhere = |fault: Fault| Mistake { place: Place { line: 1, column: 1 }, fault };
    let named = |keyword: &&&Keyword<'_>| {
        wanted.is_none_or(|wanted| {
            keyword.title == Some(wanted) || keyword.card(0).is_ok_and(|card| card.text(0) == wanted)
        })
    };
    let chosen = known.iter().find(named).ok_or_else(|| match (wanted, known.is_empty()) {
        (Some(wanted), false) => nowhere(Fault::NoSuchMaterial(wanted.to_owned())),
        _ => nowhere(Fault::NoMaterial),
    })?;
    let mut reader = Reader { system, curves: curves(&all)?, warnings: vec![] };
    let others = all.iter().filter(|keyword| !is_known(keyword) && !OTHERS.contains(&keyword.name.as_str()));
    let ignored = others.map(|keyword| Warning::Keyword { line: keyword.line, name: format!("*{}", keyword.name) });
    reader.warnings.extend(ignored);
    let film = reader.film(chosen)?;
    if known.len() > 1 {
        reader.warnings.push(Warning::Others { read: film.name.clone(), others: known.len() - 1 });
    }
    Ok(Reading { film, warnings: reader.warnings })
}

fn is_known(keyword: &Keyword<'_>) -> bool {
    [FABRIC, ELASTIC, POLYNOMIAL, OGDEN, PLASTIC].concat().contains(&keyword.name.as_str())
}

/// Curves and tables by their numbers.
#[derive(Default)]
struct Curves {
    /// Abscissas and ordinates as the solver has them: scaled and shifted.
    curves: BTreeMap<i64, Points>,
    /// Abscissa and number of the curve.
    tables: BTreeMap<i64, Vec<(f64, i64)>>,
}

fn curves(all: &[Keyword<'_>]) -> Result<Curves, Mistake> {
    let mut found = Curves::default();
    for (place, keyword) in all.iter().enumerate() {
        if !keyword.name.starts_with("DEFINE_") || !OTHERS.contains(&keyword.name.as_str()) {
            continue;
        }
        let head = keyword.card(0)?;
        let number =
            head.whole(0, "its number")?.ok_or_else(|| head.mistake(0, Fault::Missing { name: "its number" }))?;
        let is_curve = keyword.name == "DEFINE_CURVE";
        // Left out, scales are 1.
        let scale = |value: f64| if value == 0.0 { 1.0 } else { value };
        let [factor, shift] = match is_curve {
            true => [head.number(2, "SFA")?, head.number(4, "OFFA")?],
            false => [head.number(1, "SFA")?, head.number(2, "OFFA")?],
        };
        let abscissa = |value: f64| scale(factor) * (value + shift);
        let rows = &keyword.cards[1..];
        if is_curve {
            let (factor, shift) = (scale(head.number(3, "SFO")?), head.number(5, "OFFO")?);
            let point = |card: &Card<'_>| Ok([abscissa(card.number(0, "A")?), factor * (card.number(1, "O")? + shift)]);
            found.curves.insert(number, rows.iter().map(point).collect::<Result<_, _>>()?);
            continue;
        }
        // The curves of a table follow it; those of a two-dimensional one are named.
        let mut next = all[place + 1..].iter().filter(|keyword| keyword.name == "DEFINE_CURVE");
        let mut following = |card: &Card<'_>| {
            let curve = next.next().ok_or_else(|| card.mistake(0, Fault::NoCurve(number)))?;
            curve.card(0)?.whole(0, "its number")
        };
        let row = |card: &Card<'_>| {
            let curve = match keyword.name == "DEFINE_TABLE" {
                true => following(card)?,
                false => card.whole(1, "the curve")?,
            };
            let curve = curve.ok_or_else(|| card.mistake(1, Fault::Missing { name: "the curve" }))?;
            Ok((abscissa(card.number(0, "VALUE")?), curve))
        };
        found.tables.insert(number, rows.iter().map(row).collect::<Result<_, _>>()?);
    }
    Ok(found)
}

/// Reads one material.
struct Reader {
    system: System,
    curves: Curves,
    warnings: Vec<Warning>,
}

impl Reader {
    fn film(&mut self, keyword: &Keyword<'_>) -> Result<Found, Mistake> {
        let head = keyword.card(0)?;
        let name = keyword.title.filter(|title| !title.is_empty()).unwrap_or(head.text(0)).to_owned();
        let density = head.positive(1, "RO")? * self.system.density();
        let is = |names: [&str; 2]| names.contains(&keyword.name.as_str());
        let (law, prony) = if is(FABRIC) {
            (self.fabric(keyword)?, vec![])
        } else if is(ELASTIC) {
            self.unread(head, &[(4, "DA"), (5, "DB"), (6, "K")]);
            let young = head.positive(2, "E")? * self.system.stress();
            (FoundLaw::Elastic { young, poisson: poisson(head, 3)? }, vec![])
        } else if is(PLASTIC) {
            (self.plastic(keyword)?, vec![])
        } else {
            self.rubber(keyword, is(OGDEN))?
        };
        Ok(Found { name, density, law, prony })
    }

    /// Warns of fields that are not zero.
    fn unread(&mut self, card: &Card<'_>, fields: &[(usize, &str)]) {
        for (place, name) in fields {
            let text = card.text(*place);
            if !text.is_empty() && super::fields::number(text) != Some(0.0) {
                let value = text.to_owned();
                self.warnings.push(Warning::Field { line: card.line(), name: (*name).to_owned(), value });
            }
        }
    }

    fn fabric(&mut self, keyword: &Keyword<'_>) -> Result<FoundLaw, Mistake> {
        let form = keyword.card(2)?;
        let number = form.whole(5, "FORM")?.unwrap_or(0);
        if !matches!(number, 14 | -14) {
            let fault = Fault::Unknown(format!(
                "FORM {number} is not read: of the forms with curves, 14 and -14 have engineering stress over engineering strain"
            ));
            return Err(form.mistake(5, fault));
        }
        self.unread(keyword.card(0)?, &[(5, "PRBA"), (6, "PRAB")]);
        self.unread(keyword.card(1)?, &[(4, "EL"), (5, "PRL"), (6, "LRATIO"), (7, "DAMP")]);
        self.unread(form, &[(1, "FLC"), (2, "FAC"), (3, "ELA"), (4, "LNRC"), (6, "FVOPT"), (7, "TSRFAC")]);
        self.unread(keyword.card(3)?, &[(1, "RGBRTH"), (2, "A0REF")]);
        self.unread(keyword.card(4)?, &[(6, "BETA"), (7, "ISREFG")]);
        let curves = keyword.card(5)?;
        self.unread(curves, &[(6, "RL")]);
        let fibres =
            [self.by_rate(curves, 0, "LCA", Ordinate::Fibre)?, self.by_rate(curves, 1, "LCB", Ordinate::Fibre)?];
        let shear = self.stresses(curves, 2, "LCAB", Ordinate::Shear)?;
        // Of several rates the slowest is the one that unloading curves are of.
        let slowest =
            |fibre: &[(Option<f64>, Points)]| fibre.first().map_or_else(Points::new, |(_, curve)| curve.clone());
        let (md, td) = (slowest(&fibres[0]), slowest(&fibres[1]));
        let path = |place: usize, name: &'static str, kind| self.stresses(curves, place, name, kind).ok();
        let paths = [
            (&md, path(3, "LCUA", Ordinate::Fibre)),
            (&td, path(4, "LCUB", Ordinate::Fibre)),
            (&shear, path(5, "LCUAB", Ordinate::Shear)),
        ];
        let mut absorption = curve::absorption(paths).unwrap_or_else(|| {
            self.unread(curves, &[(3, "LCUA"), (4, "LCUB"), (5, "LCUAB")]);
            0.0
        });
        if number == -14 {
            let card = keyword.card(6)?;
            self.unread(card, &[(0, "LCAA"), (1, "LCBB"), (3, "DT"), (5, "ECOAT"), (6, "SCOAT"), (7, "TCOAT")]);
            absorption = card.number(2, "H")?;
            if !(0.0..1.0).contains(&absorption) {
                let fault = Fault::Outside { name: "H", value: absorption, expected: "0 to less than 1" };
                return Err(card.mistake(2, fault));
            }
        }
        Ok(FoundLaw::Fabric { fibres, shear, absorption })
    }

    /// The curve that a field names, its ordinates stresses, without what lies below zero.
    fn stresses(&self, card: &Card<'_>, place: usize, name: &'static str, kind: Ordinate) -> Result<Points, Mistake> {
        let number = card.whole(place, name)?.ok_or_else(|| card.mistake(place, Fault::Missing { name }))?;
        self.curve(card, place, number, kind)
    }

    fn curve(&self, card: &Card<'_>, place: usize, number: i64, kind: Ordinate) -> Result<Points, Mistake> {
        let points = self.curves.curves.get(&number).ok_or_else(|| card.mistake(place, Fault::NoCurve(number)))?;
        let scaled = points.iter().map(|[x, y]| [*x, y * self.system.stress()]).collect();
        of_film(scaled, kind).map_err(|why| card.mistake(place, Fault::BadCurve { curve: number, why: why.to_owned() }))
    }

    /// The curve or the table by rate that a field names.
    fn by_rate(
        &self,
        card: &Card<'_>,
        place: usize,
        name: &'static str,
        kind: Ordinate,
    ) -> Result<Vec<(Option<f64>, Points)>, Mistake> {
        let number = card.whole(place, name)?.ok_or_else(|| card.mistake(place, Fault::Missing { name }))?;
        let Some(table) = self.curves.tables.get(&number) else {
            return Ok(vec![(None, self.curve(card, place, number, kind)?)]);
        };
        let row = |(rate, curve): &(f64, i64)| {
            let rate = rate / self.system.time();
            if rate > 0.0 {
                Ok((Some(rate), self.curve(card, place, *curve, kind)?))
            } else {
                let why = "a table by strain rate has rates above zero".to_owned();
                Err(card.mistake(place, Fault::BadCurve { curve: number, why }))
            }
        };
        table.iter().map(row).collect()
    }

    fn rubber(&mut self, keyword: &Keyword<'_>, is_ogden: bool) -> Result<(FoundLaw, Vec<[f64; 2]>), Mistake> {
        let head = keyword.card(0)?;
        if head.number(3, "N")? != 0.0 {
            let fault = Fault::Unknown("N is not 0: constants that the solver fits are not read".into());
            return Err(head.mistake(3, fault));
        }
        if head.number(2, "PR")? < INCOMPRESSIBLE {
            self.unread(head, &[(2, "PR")]);
        }
        self.unread(head, &[(5, "G"), (6, "SIGF"), (7, "REF")]);
        let stress = self.system.stress();
        let (law, shear, rest) = if is_ogden {
            let (mu, alpha) = (keyword.card(1)?, keyword.card(2)?);
            let term = |place: usize| Ok([mu.number(place, "MU")? * stress, alpha.number(place, "ALPHA")?]);
            let terms: Vec<[f64; 2]> = (0..8).map(term).collect::<Result<_, Mistake>>()?;
            let terms: Vec<[f64; 2]> = terms.into_iter().filter(|[mu, alpha]| mu * alpha != 0.0).collect();
            let shear = 0.5 * terms.iter().map(|[mu, alpha]| mu * alpha).sum::<f64>();
            (FoundLaw::Ogden(terms), shear, 3)
        } else {
            let card = keyword.card(1)?;
            for (place, name) in [(2, "C11"), (4, "C02")] {
                if card.number(place, name)? != 0.0 {
                    let fault = Fault::Unknown(format!("{name} is of an energy that is not known here"));
                    return Err(card.mistake(place, fault));
                }
            }
            self.unread(card, &[(6, "THERML")]);
            let c = |place: usize, name: &'static str| Ok(card.number(place, name)? * stress);
            let found = [c(0, "C10")?, c(1, "C01")?, c(3, "C20")?, c(5, "C30")?];
            (FoundLaw::Polynomial(found), 2.0 * (found[0] + found[1]), 2)
        };
        if shear <= 0.0 {
            return Err(keyword.card(1)?.mistake(0, Fault::Missing { name: "a shear modulus above zero" }));
        }
        let mut moduli = vec![];
        for card in &keyword.cards[rest.min(keyword.cards.len())..] {
            self.unread(card, &[(2, "VFLAG")]);
            moduli.push([card.positive(0, "GI")? * stress, self.system.time() / card.positive(1, "BETAI")?]);
        }
        Ok(instantaneous(law, shear, &moduli))
    }

    fn plastic(&mut self, keyword: &Keyword<'_>) -> Result<FoundLaw, Mistake> {
        let (head, rate) = (keyword.card(0)?, keyword.card(1)?);
        let stress = self.system.stress();
        self.unread(head, &[(6, "FAIL"), (7, "TDEL")]);
        self.unread(rate, &[(0, "C"), (1, "P"), (3, "LCSR")]);
        let young = head.positive(2, "E")? * stress;
        let curves = if rate.whole(2, "LCSS")?.is_some() {
            self.unread(head, &[(5, "ETAN")]);
            self.by_rate(rate, 2, "LCSS", Ordinate::Flow)?
        } else {
            vec![(None, self.tabulated(keyword, young)?)]
        };
        Ok(FoundLaw::Plastic { young, poisson: poisson(head, 3)?, curves, hill: None })
    }

    /// Hardening by points of the material itself, or by a tangent modulus.
    fn tabulated(&self, keyword: &Keyword<'_>, young: f64) -> Result<Points, Mistake> {
        let (head, stress) = (keyword.card(0)?, self.system.stress());
        let initial = head.positive(4, "SIGY")? * stress;
        if let (Ok(strains), Ok(stresses)) = (keyword.card(2), keyword.card(3)) {
            let point = |place: usize| Ok([strains.number(place, "EPS")?, stresses.number(place, "ES")? * stress]);
            let points: Points = (0..8).map(point).collect::<Result<_, Mistake>>()?;
            // Strains after the last one are left out.
            let count = 1 + points.windows(2).take_while(|ends| ends[1][0] > ends[0][0]).count();
            if count > 1 {
                let points = points[..count].to_vec();
                let falls = points.windows(2).any(|ends| ends[1][1] < ends[0][1]);
                let fault =
                    || Fault::Unknown("the stress falls, where film would localise in one row of elements".into());
                return if falls { Err(stresses.mistake(0, fault())) } else { Ok(points) };
            }
        }
        let tangent = head.number(5, "ETAN")? * stress;
        if !(0.0..young).contains(&tangent) {
            let fault = Fault::Outside { name: "ETAN", value: tangent / stress, expected: "0 to less than E" };
            return Err(head.mistake(5, fault));
        }
        Ok(vec![[0.0, initial], [1.0, initial + young * tangent / (young - tangent)]])
    }
}

fn poisson(card: &Card<'_>, place: usize) -> Result<f64, Mistake> {
    let value = card.number(place, "PR")?;
    let is_possible = (0.0..0.5).contains(&value);
    let fault = Fault::Outside { name: "PR", value, expected: "0 to less than 0.5" };
    if is_possible { Ok(value) } else { Err(card.mistake(place, fault)) }
}
