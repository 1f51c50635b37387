//! Cards of other solvers, read back as films.
//!
//! Three steps: lines and fields of a format with their places (`entry`), the fields of a material in the terms of its solver, a
//! module each, and the film. What is not understood is named; what changes the film and is not understood is refused.

mod entry;
mod ls_dyna;
mod openradioss;
mod text;

use std::collections::BTreeMap;

use entry::{Cell, Entry, Fields};

use super::layout::Layout;
use super::target::System;
use crate::film::{Rated, at, unloading};
use base::findings;

pub use crate::film::Points;
pub use text::material;

/// A film that was read, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its name or number in the card.
    pub name: String,
    /// kg/m³.
    pub density: f64,
    /// Its law.
    pub law: FoundLaw,
    /// Prony series: shares of the instantaneous stress and relaxation times, s.
    pub prony: Vec<[f64; 2]>,
}

/// The law of a film that was read, in the terms of a material file.
#[derive(Clone, Debug, PartialEq)]
pub enum FoundLaw {
    /// Two fibre sets and shear.
    Fabric {
        /// MD and TD: rate (1/s; none where there is one curve) and points of engineering strain and nominal stress (Pa).
        fibres: [Vec<Rated<Points>>; 2],
        /// Shear stress (Pa) over shear angle (rad).
        shear: Points,
        /// Share of the stored energy that is lost on unloading.
        absorption: f64,
    },
    /// Linear.
    Elastic {
        /// Pa.
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// Mooney's, Rivlin's and Yeoh's energies: c₁₀, c₀₁, c₂₀ and c₃₀, Pa.
    Polynomial([f64; 4]),
    /// Ogden's energy: μ (Pa) and α of each term, Σ μ/α (…).
    Ogden(Vec<[f64; 2]>),
    /// Elastoplastic.
    Plastic {
        /// Pa.
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Rate (1/s; none where there is one curve) and points of plastic strain and true stress (Pa).
        curves: Vec<Rated<Points>>,
        /// Hill's yield function by Lankford values at 0, 45 and 90° from MD; none for von Mises'.
        hill: Option<[f64; 3]>,
    },
}

/// A card that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its film.
    pub film: Found,
    /// What it says besides.
    pub warnings: Vec<Warning>,
}

/// A place in a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

findings! {
    /// Something in a card that the film does not have.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        Field {
            line: usize, "line of the card" => "line";
            name: String, "of the field" => "field";
            value: String, "as written" => "value";
        } = "card-field-not-read", Warning;
            meaning "a field of the card has a value that no key of a material stands for";
            remedy "check whether it changes the film; if so, that is not in the material";
            message "line {line}: {name} = {value} is not read";
        Keyword {
            line: usize, "line of the card" => "line";
            name: String, "of the keyword" => "keyword";
        } = "card-keyword-not-read", Note;
            meaning "a keyword of the card is none of a material that is known here";
            remedy "nothing, if it is not about the film";
            message "line {line}: {name} is not read";
        Others {
            read: String, "the material that was read" => "read";
            others: usize, "materials in the card besides" => "others";
        } = "card-other-materials", Warning;
            meaning "the card has several materials, of which one was read";
            remedy "name another one: `--material`";
            message "{others} other materials in the card are not read; {read} is";
    }
}

impl Warning {
    /// Whether it is of the field of this name.
    fn is_of(&self, field: &str) -> bool {
        matches!(self, Warning::Field { name, .. } if name == field)
    }
}

/// Why a card cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// Where.
    pub place: Place,
    /// What.
    pub message: String,
}

/// A format of cards.
struct Dialect {
    /// Its keywords with their lines.
    entries: fn(&str, System) -> Result<Vec<Entry<'_>>, Mistake>,
    /// Names, fields and law of each material that is read.
    materials: &'static [([&'static str; 2], Layout, ReadLaw)],
    /// What names the kind of a material, and its number.
    name: for<'e> fn(&'e Entry<'_>) -> &'e str,
    number: for<'e> fn(&'e Entry<'_>) -> &'e str,
    /// The name of its density.
    density: &'static str,
    /// Whether a keyword says nothing of a film, or is read with one.
    is_passed_over: fn(&Entry<'_>) -> bool,
    /// Adds curves and tables.
    add_curves: fn(&mut Reader, &[Entry<'_>]) -> Result<(), Mistake>,
}

/// A law and its Prony series.
type Law = (FoundLaw, Vec<[f64; 2]>);

type ReadLaw = fn(&mut Reader, &Fields<'_, '_>) -> Result<Law, Mistake>;

/// Reads the film of a card in the units of `system`; of several materials the one whose number or title is `wanted`, else the
/// first.
///
/// # Errors
/// [`Mistake`], the first.
pub fn read(card: &str, system: System, wanted: Option<&str>) -> Result<Reading, Mistake> {
    let nowhere = |message: String| Mistake { place: Place { line: 1, column: 1 }, message };
    let no_card = || nowhere("this is no card: no line begins with a keyword of LS-DYNA or OpenRadioss".into());
    let first = card.lines().find_map(|line| line.chars().next().filter(|first| ['*', '/'].contains(first)));
    let dialect = if first.ok_or_else(no_card)? == '*' { ls_dyna::DIALECT } else { openradioss::DIALECT };
    let all = (dialect.entries)(card, system)?;
    let material =
        |entry: &Entry<'_>| dialect.materials.iter().find(|(names, ..)| names.contains(&(dialect.name)(entry)));
    let known: Vec<_> = all.iter().filter_map(|entry| Some((entry, material(entry)?))).collect();
    let is_wanted = |entry: &Entry<'_>| {
        wanted.is_none_or(|wanted| entry.title == Some(wanted) || (dialect.number)(entry) == wanted)
    };
    let (entry, (_, layout, law)) =
        *known.iter().find(|(entry, _)| is_wanted(entry)).ok_or_else(|| match (wanted, known.is_empty()) {
            (Some(wanted), false) => nowhere(format!("there is no material {wanted}")),
            _ => nowhere("there is no material that is known here".into()),
        })?;
    let units = entry.word(3);
    if !matches!(units, "" | "0") {
        let message = format!(
            "{} is in the units of /UNIT/{units}, which are not read: write it in those of the card",
            entry.shown()
        );
        return Err(Mistake { place: Place { line: entry.line, column: 1 }, message });
    }
    let mut reader = Reader { system, curves: BTreeMap::new(), tables: BTreeMap::new(), warnings: vec![] };
    let others = all.iter().filter(|entry| material(entry).is_none() && !(dialect.is_passed_over)(entry));
    reader.warnings.extend(others.map(|entry| Warning::Keyword { line: entry.line, name: entry.shown() }));
    (dialect.add_curves)(&mut reader, &all)?;
    let fields = Fields::of(entry, layout);
    let density = fields.positive(dialect.density)?;
    let (law, prony) = law(&mut reader, &fields)?;
    reader.warnings.extend(fields.unread());
    let title = entry.title.filter(|title| !title.is_empty());
    let name = title.unwrap_or_else(|| (dialect.number)(entry)).to_owned();
    let film = Found { name, density, law, prony };
    if known.len() > 1 {
        reader.warnings.push(Warning::Others { read: film.name.clone(), others: known.len() - 1 });
    }
    Ok(Reading { film, warnings: reader.warnings })
}

/// Least Poisson's ratio that stands for incompressible film.
const INCOMPRESSIBLE: f64 = 0.49;

/// Reads one material.
struct Reader {
    system: System,
    /// By number, as the solver has them.
    curves: BTreeMap<i64, Points>,
    /// Abscissas and numbers of curves, by number.
    tables: BTreeMap<i64, Vec<(f64, i64)>>,
    warnings: Vec<Warning>,
}

impl Reader {
    /// The curve that a field names, abscissas and ordinates times `units`, without what lies below zero.
    fn curve(&self, cell: Cell<'_>, units: [f64; 2], kind: Ordinate) -> Result<Points, Mistake> {
        let number = cell.whole()?.ok_or_else(|| cell.missing())?;
        self.numbered(cell, number, units, kind)
    }

    /// As [`Reader::curve`], of a curve whose number another curve or table names; mistakes are at the field.
    fn numbered(&self, cell: Cell<'_>, number: i64, units: [f64; 2], kind: Ordinate) -> Result<Points, Mistake> {
        let points = self.curves.get(&number).ok_or_else(|| cell.mistake(no_curve(number)))?;
        let scaled = points.iter().map(|[x, y]| [x * units[0], y * units[1]]).collect();
        of_film(scaled, kind).map_err(|why| cell.mistake(format!("curve {number}: {why}")))
    }

    /// Warns of a Poisson's ratio that is not that of incompressible film.
    fn incompressible(&mut self, poisson: Cell<'_>) -> Result<(), Mistake> {
        let value = poisson.number()?;
        self.warnings.extend((value != 0.0 && value < INCOMPRESSIBLE).then(|| poisson.ignored(poisson.text)));
        Ok(())
    }
}

/// A curve or table that is named is not there.
fn no_curve(number: i64) -> String {
    format!("there is no curve or table {number}")
}

/// Ogden's energy of the terms that are not zero, and its shear modulus.
fn ogden(mu: Vec<Cell<'_>>, alpha: Vec<Cell<'_>>) -> Result<(FoundLaw, f64), Mistake> {
    let term = |(mu, alpha): (Cell<'_>, Cell<'_>)| Ok([mu.number()?, alpha.number()?]);
    let mut terms = mu.into_iter().zip(alpha).map(term).collect::<Result<Vec<[f64; 2]>, _>>()?;
    terms.retain(|[mu, alpha]| mu * alpha != 0.0);
    let shear = 0.5 * terms.iter().map(|[mu, alpha]| mu * alpha).sum::<f64>();
    Ok((FoundLaw::Ogden(terms), shear))
}

/// The law of film strained at once, of which Prony shares are taken here, and its series (s), from that of relaxed film with
/// this shear modulus and the Prony moduli beside it (Pa, s).
fn instantaneous(law: FoundLaw, shear: f64, moduli: &[[f64; 2]]) -> Law {
    let instant = shear + moduli.iter().map(|[modulus, _]| modulus).sum::<f64>();
    let prony = moduli.iter().map(|[modulus, time]| [modulus / instant, *time]).collect();
    let factor = instant / shear;
    let stiffened = match law {
        FoundLaw::Polynomial(c) => FoundLaw::Polynomial(c.map(|c| factor * c)),
        FoundLaw::Ogden(terms) => FoundLaw::Ogden(terms.into_iter().map(|[mu, alpha]| [factor * mu, alpha]).collect()),
        other => other,
    };
    (stiffened, prony)
}

/// What the ordinates of a curve are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ordinate {
    /// Stress of fibres, which begins at zero.
    Fibre,
    /// Stress in shear, which is the same to both sides of zero, or written to one.
    Shear,
    /// Flow stress.
    Flow,
}

/// Relative difference of what cards write with the fewest digits, and of shares that follow from that; unloading curves rise by as
/// much where the film is slack.
const DIGITS: f64 = 1e-5;

/// The points from the abscissa zero on; in words why they are no curve of a film.
fn of_film(points: Points, kind: Ordinate) -> Result<Points, &'static str> {
    if points.windows(2).any(|ends| ends[1][0] <= ends[0][0]) {
        return Err("its abscissas do not increase");
    }
    if kind == Ordinate::Fibre && points.iter().any(|point| point[0] < 0.0 && point[1] != 0.0) {
        return Err("it has stress in compression, which fibres do not carry");
    }
    let is_odd = |points: &Points| {
        let most = points[points.len() - 1][1].abs();
        let differs = |[x, y]: &[f64; 2]| (at(points, -x) + y).abs() > DIGITS * most;
        !points.iter().filter(|[x, y]| *x < 0.0 && *y != 0.0).any(differs)
    };
    if kind == Ordinate::Shear && points.len() > 1 && !is_odd(&points) {
        return Err("its negative side is another than its positive one");
    }
    let above: Points = points.into_iter().filter(|point| point[0] >= 0.0).collect();
    let least = if kind == Ordinate::Flow { 1 } else { 2 };
    if above.len() < least {
        return Err("it has too few points from zero on");
    }
    if above.windows(2).any(|ends| ends[1][1] < ends[0][1]) {
        return Err("its stress falls, where film would localise in one row of elements");
    }
    Ok(above)
}

/// The share of the stored energy that is lost, where the curves of the fields `paths`, in order MD, TD and shear, are the loading
/// ones compressed towards the strain from which film unloads (theory.md, equation 8), all by one share, within the digits of a
/// card; other paths are no absorption, and warned of.
fn absorption(
    reader: &mut Reader,
    fields: &Fields<'_, '_>,
    loading: &[Points; 3],
    paths: [(&'static str, [f64; 2], Ordinate); 3],
) -> f64 {
    let share = |(loading, (name, units, kind)): (&Points, (&'static str, [f64; 2], Ordinate))| {
        let path = reader.curve(fields.cell(name).ok()?, units, kind).ok()?;
        let (&[_, [slack, _], ..], &[from, top]) = (path.as_slice(), path.last()?) else { return None };
        let expected = unloading(loading, from, slack / from);
        let is_near = |(found, expected): (&[f64; 2], &[f64; 2])| {
            (found[0] - expected[0]).abs() <= DIGITS * from && (found[1] - expected[1]).abs() <= DIGITS * top
        };
        let is_compressed = path.len() == expected.len() && path.iter().zip(&expected).all(is_near);
        is_compressed.then_some(slack / from)
    };
    let shares: Vec<f64> = loading.iter().zip(paths).filter_map(share).collect();
    if shares.len() == 3 && shares.iter().all(|share| (share - shares[0]).abs() <= DIGITS) {
        return shares.iter().sum::<f64>() / 3.0;
    }
    let cells = paths.iter().filter_map(|(name, ..)| fields.cell(name).ok());
    let written = cells.filter(|cell| cell.number() != Ok(0.0));
    reader.warnings.extend(written.map(|cell| cell.ignored(cell.text)));
    0.0
}
