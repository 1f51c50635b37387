//! Materials of Abaqus and CalculiX: `*MATERIAL` and the keywords of its behaviour.

use super::curve::{Ordinate, of_film};
use super::fields::number;
use super::{Fault, Found, FoundHill, FoundLaw, Mistake, Place, Points, Reading, Warning};
use crate::system::System;

/// Keywords of a material's behaviour that are read.
const READ: [&str; 9] = [
    "DENSITY",
    "ELASTIC",
    "FABRIC",
    "HYPERELASTIC",
    "LOADING DATA",
    "PLASTIC",
    "POTENTIAL",
    "UNIAXIAL",
    "VISCOELASTIC",
];

/// Keywords of a material's behaviour that are not read.
const UNREAD: [&str; 8] = [
    "UNLOADING DATA",
    "RATE DEPENDENT",
    "DAMPING",
    "EXPANSION",
    "HYSTERESIS",
    "MULLINS EFFECT",
    "DAMAGE INITIATION",
    "DAMAGE EVOLUTION",
];

/// A keyword with its parameters and data.
struct Keyword<'a> {
    name: String,
    parameters: Vec<(String, &'a str)>,
    line: usize,
    data: Vec<Row<'a>>,
}

/// A line of data: values with their columns.
struct Row<'a> {
    line: usize,
    values: Vec<(usize, &'a str)>,
}

/// Reads a card.
pub(super) fn read(text: &str, system: System, wanted: Option<&str>) -> Result<Reading, Mistake> {
    let all = keywords(text)?;
    let begins: Vec<usize> = (0..all.len()).filter(|place| all[*place].name == "MATERIAL").collect();
    let named = |place: &&usize| wanted.is_none_or(|wanted| all[**place].parameter("NAME") == Some(wanted));
    let Some(begin) = begins.iter().find(named).copied() else {
        let fault = wanted.map_or(Fault::NoMaterial, |wanted| Fault::NoSuchMaterial(wanted.to_owned()));
        return Err(Mistake { place: Place { line: 1, column: 1 }, fault });
    };
    let is_behaviour =
        |keyword: &&Keyword<'_>| READ.contains(&keyword.name.as_str()) || UNREAD.contains(&keyword.name.as_str());
    let behaviour: Vec<&Keyword<'_>> = all[begin + 1..].iter().take_while(is_behaviour).collect();
    let ignored = all.iter().filter(|keyword| keyword.name != "MATERIAL" && !READ.contains(&keyword.name.as_str()));
    let mut warnings: Vec<Warning> =
        ignored.map(|keyword| Warning::Keyword { line: keyword.line, name: format!("*{}", keyword.name) }).collect();
    let name = all[begin].parameter("NAME").unwrap_or("film").to_owned();
    let material = Behaviour { keywords: &behaviour, system, line: all[begin].line };
    let (law, prony) = material.law(&mut warnings)?;
    let density = material.needed("DENSITY")?.row(0)?.positive(0, "the density")? * system.density();
    if begins.len() > 1 {
        warnings.push(Warning::Others { read: name.clone(), others: begins.len() - 1 });
    }
    Ok(Reading { film: Found { name, density, law, prony }, warnings })
}

fn keywords(text: &str) -> Result<Vec<Keyword<'_>>, Mistake> {
    let mut found: Vec<Keyword<'_>> = vec![];
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        if line.starts_with("**") || line.trim().is_empty() {
            continue;
        }
        let Some(written) = line.strip_prefix('*') else {
            let Some(keyword) = found.last_mut() else { continue };
            let mut column = 1;
            let mut values: Vec<(usize, &str)> = vec![];
            for value in line.split(',') {
                let start = column + value.chars().take_while(|c| c.is_whitespace()).count();
                column += value.chars().count() + 1;
                values.push((start, value.trim()));
            }
            // A comma at the end is no value.
            while values.last().is_some_and(|(_, value)| value.is_empty()) {
                values.pop();
            }
            keyword.data.push(Row { line: number, values });
            continue;
        };
        let mut parts = written.split(',');
        let name =
            parts.next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        if name == "INCLUDE" {
            let fault = Fault::Include("*INCLUDE".into());
            return Err(Mistake { place: Place { line: number, column: 1 }, fault });
        }
        let parameter = |part: &'_ str| -> (String, usize) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_ascii_uppercase(), value.len())
        };
        let parameters = parts.map(|part| {
            let (key, length) = parameter(part);
            (key, part[part.len() - length..].trim().trim_matches('"'))
        });
        found.push(Keyword { name, parameters: parameters.collect(), line: number, data: vec![] });
    }
    Ok(found)
}

impl<'a> Keyword<'a> {
    /// The value of a parameter, empty where it has none.
    fn parameter(&self, key: &str) -> Option<&'a str> {
        self.parameters.iter().find(|(name, _)| name == key).map(|(_, value)| *value)
    }

    fn has(&self, key: &str) -> bool {
        self.parameter(key).is_some()
    }

    fn row(&self, place: usize) -> Result<&Row<'a>, Mistake> {
        self.data
            .get(place)
            .ok_or_else(|| self.mistake(Fault::TooShort { keyword: format!("*{}", self.name), card: place + 1 }))
    }

    fn mistake(&self, fault: Fault) -> Mistake {
        Mistake { place: Place { line: self.line, column: 1 }, fault }
    }

    /// All values of all lines.
    fn values(&self, name: &'static str) -> Result<Vec<f64>, Mistake> {
        let of_row = |row: &Row<'a>| (0..row.values.len()).map(|place| row.number(place, name)).collect::<Vec<_>>();
        self.data.iter().flat_map(of_row).collect()
    }
}

impl Row<'_> {
    fn mistake(&self, place: usize, fault: Fault) -> Mistake {
        let column = self.values.get(place).map_or(1, |(column, _)| *column);
        Mistake { place: Place { line: self.line, column }, fault }
    }

    /// The number at `place`; zero where there is none.
    fn number(&self, place: usize, name: &'static str) -> Result<f64, Mistake> {
        let text = self.values.get(place).map_or("", |(_, text)| *text);
        if text.is_empty() {
            return Ok(0.0);
        }
        if text.starts_with('<') {
            return Err(self.mistake(place, Fault::Parameter(text.to_owned())));
        }
        number(text).ok_or_else(|| self.mistake(place, Fault::NotANumber { name, text: text.to_owned() }))
    }

    fn positive(&self, place: usize, name: &'static str) -> Result<f64, Mistake> {
        match self.number(place, name)? {
            0.0 => Err(self.mistake(place, Fault::Missing { name })),
            value if value > 0.0 => Ok(value),
            value => Err(self.mistake(place, Fault::Outside { name, value, expected: "more than 0" })),
        }
    }
}

/// The keywords below one material.
struct Behaviour<'k, 'a> {
    keywords: &'k [&'k Keyword<'a>],
    system: System,
    line: usize,
}

impl<'k, 'a> Behaviour<'k, 'a> {
    fn keyword(&self, name: &str) -> Option<&'k Keyword<'a>> {
        self.keywords.iter().find(|keyword| keyword.name == name).copied()
    }

    fn needed(&self, name: &'static str) -> Result<&'k Keyword<'a>, Mistake> {
        let place = Place { line: self.line, column: 1 };
        self.keyword(name).ok_or(Mistake { place, fault: Fault::Missing { name } })
    }

    fn law(&self, warnings: &mut Vec<Warning>) -> Result<(FoundLaw, Vec<[f64; 2]>), Mistake> {
        if self.keyword("FABRIC").is_some() {
            return Ok((self.fabric()?, vec![]));
        }
        if let Some(keyword) = self.keyword("HYPERELASTIC") {
            return self.rubber(keyword, warnings);
        }
        let (young, poisson) = self.elastic()?;
        let Some(plastic) = self.keyword("PLASTIC") else {
            return Ok((FoundLaw::Elastic { young, poisson }, vec![]));
        };
        if let Some(kind) = plastic.parameter("HARDENING").filter(|kind| !kind.eq_ignore_ascii_case("ISOTROPIC")) {
            return Err(plastic.mistake(Fault::Unknown(format!("hardening by {kind} is not read"))));
        }
        let point = |row: &Row<'a>| Ok([row.number(1, "the plastic strain")?, row.positive(0, "the yield stress")?]);
        let points: Points = plastic.data.iter().map(point).collect::<Result<_, Mistake>>()?;
        let scaled = points.iter().map(|[p, stress]| [*p, stress * self.system.stress()]).collect();
        let curve = of_film(scaled, Ordinate::Flow);
        let curve = curve.map_err(|why| plastic.mistake(Fault::Unknown(format!("*PLASTIC: {why}"))))?;
        let hill = self.keyword("POTENTIAL").map(hill).transpose()?;
        Ok((FoundLaw::Plastic { young, poisson, curves: vec![(None, curve)], cowper_symonds: None, hill }, vec![]))
    }

    fn elastic(&self) -> Result<(f64, f64), Mistake> {
        let keyword = self.needed("ELASTIC")?;
        if let Some(kind) = keyword.parameter("TYPE").filter(|kind| !kind.to_ascii_uppercase().starts_with("ISO")) {
            return Err(keyword.mistake(Fault::Unknown(format!("*ELASTIC of the type {kind} is not read"))));
        }
        let row = keyword.row(0)?;
        let (young, poisson) = (row.positive(0, "Young's modulus")?, row.number(1, "Poisson's ratio")?);
        if !(0.0..0.5).contains(&poisson) {
            let fault = Fault::Outside { name: "Poisson's ratio", value: poisson, expected: "0 to less than 0.5" };
            return Err(row.mistake(1, fault));
        }
        Ok((young * self.system.stress(), poisson))
    }

    fn fabric(&self) -> Result<FoundLaw, Mistake> {
        let mut curves: [Option<Points>; 3] = [None, None, None];
        let mut component = None;
        for keyword in self.keywords {
            match (keyword.name.as_str(), component) {
                ("UNIAXIAL", _) => {
                    let given = keyword.parameter("COMPONENT").unwrap_or_default().to_ascii_uppercase();
                    let place = ["1", "2", "SHEAR"].iter().position(|name| *name == given);
                    component = Some(place.ok_or_else(|| keyword.mistake(Fault::Missing { name: "COMPONENT" }))?);
                }
                ("LOADING DATA", Some(place)) if keyword.parameter("DIRECTION") != Some("COMPRESSION") => {
                    let stress = self.system.stress();
                    let point =
                        |row: &Row<'a>| Ok([row.number(1, "the strain")?, row.number(0, "the stress")? * stress]);
                    let points = keyword.data.iter().map(point).collect::<Result<_, Mistake>>()?;
                    let bad = |why| keyword.mistake(Fault::Unknown(format!("*LOADING DATA: {why}")));
                    curves[place] = Some(of_film(points, Ordinate::Fibre).map_err(bad)?);
                }
                _ => {}
            }
        }
        let [Some(md), Some(td), Some(shear)] = curves else {
            let fault = Fault::Missing { name: "*LOADING DATA of one of the components 1, 2 and SHEAR" };
            return Err(Mistake { place: Place { line: self.line, column: 1 }, fault });
        };
        Ok(FoundLaw::Fabric { fibres: [vec![(None, md)], vec![(None, td)]], shear, absorption: 0.0 })
    }

    fn rubber(&self, keyword: &Keyword<'a>, warnings: &mut Vec<Warning>) -> Result<(FoundLaw, Vec<[f64; 2]>), Mistake> {
        let stress = self.system.stress();
        let values = keyword.values("a constant")?;
        let constant = |place: usize| values.get(place).copied().unwrap_or(0.0) * stress;
        let law = if keyword.has("OGDEN") {
            let count: usize = keyword.parameter("N").and_then(|n| n.parse().ok()).unwrap_or(1);
            if !(1..=6).contains(&count) || values.len() < 2 * count {
                return Err(keyword.mistake(Fault::Missing { name: "two constants for each of N terms" }));
            }
            // W = Σ 2μ/α² (…) there.
            let term = |i: usize| [2.0 * constant(2 * i) / values[2 * i + 1], values[2 * i + 1]];
            let terms: Vec<[f64; 2]> = (0..count).map(term).filter(|term| term[0] != 0.0).collect();
            if terms.iter().flatten().any(|value| !value.is_finite()) {
                return Err(keyword.row(0)?.mistake(1, Fault::Missing { name: "alpha" }));
            }
            FoundLaw::Ogden(terms)
        } else if keyword.has("NEO HOOKE") {
            FoundLaw::Polynomial([constant(0), 0.0, 0.0, 0.0])
        } else if keyword.has("MOONEY-RIVLIN") {
            FoundLaw::Polynomial([constant(0), constant(1), 0.0, 0.0])
        } else if keyword.has("YEOH") {
            FoundLaw::Polynomial([constant(0), 0.0, constant(1), constant(2)])
        } else {
            return Err(keyword
                .mistake(Fault::Unknown("this energy is not read: of those here it has none of the names".into())));
        };
        let Some(viscoelastic) = self.keyword("VISCOELASTIC") else { return Ok((law, vec![])) };
        if viscoelastic.parameter("TIME") != Some("PRONY") {
            return Err(viscoelastic.mistake(Fault::Unknown("only *VISCOELASTIC, TIME=PRONY is read".into())));
        }
        let mut prony = vec![];
        for row in &viscoelastic.data {
            prony.push([row.positive(0, "g")?, row.positive(2, "tau")? * self.system.time()]);
            if row.number(1, "k")? != 0.0 {
                let value = row.values[1].1.to_owned();
                warnings.push(Warning::Field { line: row.line, name: "k".into(), value });
            }
        }
        // Constants are those of relaxed film unless they are said to be of film strained at once.
        let instantaneous =
            keyword.parameter("MODULI").is_some_and(|moduli| moduli.eq_ignore_ascii_case("INSTANTANEOUS"));
        let left = 1.0 - prony.iter().map(|[share, _]| share).sum::<f64>();
        if left <= 0.0 {
            return Err(viscoelastic
                .row(0)?
                .mistake(0, Fault::Outside { name: "the sum of g", value: 1.0 - left, expected: "less than 1" }));
        }
        Ok((if instantaneous { law } else { super::stiffened(law, 1.0 / left) }, prony))
    }
}

/// Ratios of yield stress.
fn hill(keyword: &Keyword<'_>) -> Result<FoundHill, Mistake> {
    let row = keyword.row(0)?;
    let [r11, r22, r33, r12] =
        [row.positive(0, "R11")?, row.positive(1, "R22")?, row.positive(2, "R33")?, row.positive(3, "R12")?];
    Ok(FoundHill::StressRatios([r11, r22, r33, r12]))
}
