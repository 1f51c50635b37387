//! What a head states of specimens: dimensions, speed and direction, once for all of them or for each.

use std::ops::Range;

use super::blocks::Group;
use super::words::{Key, direction, key, plain};
use super::{Specimen, Statement, TextRow};
use crate::error::{Error, Kind, refusal};
use crate::signal::csv::Mark;
use base::diagnostic::listed;
use base::units::{Dimension, Length, Unit, Velocity};

/// The rows above the blocks of specimens.
pub struct Head {
    pub rows: Vec<TextRow>,
    pub specimens: Range<usize>,
    pub groups: Vec<Group>,
}

/// A key with its values, and to which specimens they belong.
struct Item {
    row: usize,
    key: Key,
    word: String,
    /// Number and unit as they are written; of a direction a word.
    values: Vec<(String, Option<String>)>,
    /// The specimens, where the head says which.
    of: Option<Vec<usize>>,
}

/// Gives the specimens what the heads state of them. A head of the whole file holds for all its specimens, unless a later one
/// states the same key of its own.
pub fn state(heads: &[Head], specimens: &mut [Specimen], mark: Mark) -> Result<(), Error> {
    let items: Vec<Vec<Item>> = heads.iter().map(|head| items(head, specimens)).collect();
    for (place, (head, found)) in heads.iter().zip(&items).enumerate() {
        for item in found {
            let is_own = |other: &Item| other.key == item.key;
            let later = items[place + 1..].iter().flatten().any(is_own);
            let end = if place == 0 && !later { specimens.len() } else { head.specimens.end };
            let whose = item.of.clone().unwrap_or_else(|| (head.specimens.start..end).collect());
            give(item, &whose, specimens, mark)?;
        }
    }
    Ok(())
}

fn give(item: &Item, whose: &[usize], specimens: &mut [Specimen], mark: Mark) -> Result<(), Error> {
    let refused = |error: Error, hint: &str| error.with_hint(hint).with_kind(Kind::ExportHead).at(item.row, 1);
    if item.values.len() != 1 && item.values.len() != whose.len() {
        let names = listed(whose.iter().map(|place| &specimens[*place].name));
        let (key, found, count) = (&item.word, item.values.len(), whose.len());
        let error = refusal!("the head states {found} values of `{key}` for {count} specimens: {names}");
        return Err(refused(error, "state one value, or one a specimen"));
    }
    for (order, place) in whose.iter().enumerate() {
        let Some((number, unit)) = item.values.get(order).or(item.values.first()) else { continue };
        let specimen = &mut specimens[*place];
        let written =
            |unit: &str| format!("{}: {number} {unit}", item.word.trim_end_matches([':', ' '])).trim().to_owned();
        if item.key == Key::Direction {
            specimen.stated.direction = Some(direction(number).to_owned());
            continue;
        }
        let Some(dimension) = dimension(item.key) else { continue };
        let Some(unit) = unit else {
            specimen.stated.unused.push(written("(no unit)"));
            continue;
        };
        let parsed = Unit::parse(unit).ok().filter(|unit| unit.measures(dimension));
        let Some((parsed, value)) = parsed.zip(number_of(number, mark)) else {
            specimen.stated.unused.push(written(&format!("{unit} (not {})", dimension.name)));
            continue;
        };
        let statement = Statement { value: parsed.to_si(value), written: written(unit) };
        let name = specimen.name.clone();
        match specimen.stated.quantities.get(&item.key) {
            Some(first) if first.value != statement.value => {
                let (key, first, second) = (&item.word, &first.written, &statement.written);
                let error = refusal!("the head states `{key}` of {name} twice: {first} and {second}");
                return Err(refused(error, "leave one of them"));
            }
            _ => {
                specimen.stated.quantities.insert(item.key, statement);
            }
        }
    }
    Ok(())
}

fn dimension(key: Key) -> Option<Dimension> {
    match key {
        Key::Width | Key::Thickness | Key::Grips | Key::Gauge => Some(Length::DIMENSION),
        Key::Speed => Some(Velocity::DIMENSION),
        Key::Direction | Key::Name => None,
    }
}

/// A number with the decimal mark of the file.
fn number_of(text: &str, mark: Mark) -> Option<f64> {
    let point = if mark == Mark::Point { text.to_owned() } else { text.replacen(',', ".", 1) };
    point.parse().ok().filter(|value: &f64| value.is_finite())
}

fn is_number(text: &str) -> bool {
    text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// Most cells of a row in which keys are looked for.
const MOST_CELLS: usize = 200;

/// What the rows of a head state.
fn items(head: &Head, specimens: &[Specimen]) -> Vec<Item> {
    let mut items = Vec::new();
    let mut skip = 0;
    for (place, (row, cells)) in head.rows.iter().enumerate() {
        if place < skip {
            continue;
        }
        let keys: Vec<(usize, Key)> =
            cells.iter().enumerate().take(MOST_CELLS).filter_map(|(at, cell)| Some((at, key(word(cell))?))).collect();
        let quantities = keys.iter().filter(|(_, key)| *key != Key::Name).count();
        if quantities > 0
            && !cells.iter().any(|cell| is_number(cell) || split(cell).is_some())
            && quantities + 1 >= keys.len()
        {
            let (found, end) = table(&head.rows, place, &keys, specimens, &head.specimens);
            if !found.is_empty() {
                items.extend(found);
                skip = end;
                continue;
            }
        }
        for (order, (at, key)) in keys.iter().enumerate() {
            let end = keys.get(order + 1).map_or(cells.len(), |(next, _)| *next);
            let shares = keys.iter().filter(|(_, other)| other == key).count() > 1;
            let group = head.groups.iter().position(|group| (group.range[0]..group.range[1]).contains(at));
            let of = group.filter(|_| shares).map(|group| vec![head.specimens.start + group]);
            let values = values(&cells[*at..end], *key);
            if !values.is_empty() {
                items.push(Item { row: *row, key: *key, word: label(&cells[*at]), values, of });
            }
        }
    }
    items
}

/// The word of a cell that may hold its value, too: `Width : 10 mm`.
fn word(cell: &str) -> &str {
    cell.split([':', '=', '：']).next().unwrap_or_default()
}

fn label(cell: &str) -> String {
    word(cell).trim().to_owned()
}

/// Key and value of one cell.
fn split(cell: &str) -> Option<(&str, &str)> {
    let (key, value) = cell.split_once([':', '=', '：'])?;
    (!value.trim().is_empty()).then(|| (key, value.trim()))
}

/// A number and the unit behind it.
fn quantity(text: &str) -> Option<(String, Option<String>)> {
    let end = text.find(|letter: char| !(letter.is_ascii_digit() || "+-.,eE".contains(letter))).unwrap_or(text.len());
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    is_number(number).then(|| (number.to_owned(), (!unit.is_empty()).then(|| unit.to_owned())))
}

/// The unit in brackets behind a key: `Breite [mm]`.
fn bracketed(word: &str) -> Option<String> {
    let start = word.find(['[', '('])?;
    let end = word[start..].find([']', ')'])? + start;
    let unit = word[start..].chars().next().map(|open| word[start + open.len_utf8()..end].trim())?;
    Unit::parse(unit).ok().map(|_| unit.to_owned())
}

/// The values behind a key: `Breite;10,05;mm`, `Width [mm];10.0;10.1`, `Width : 10 mm`.
fn values(cells: &[String], key: Key) -> Vec<(String, Option<String>)> {
    let (first, rest) = (cells[0].as_str(), &cells[1..]);
    if key == Key::Direction {
        let own = split(first).map(|(_, value)| value.to_owned());
        return own
            .into_iter()
            .chain(rest.iter().filter(|cell| !cell.is_empty()).cloned())
            .map(|word| (word, None))
            .collect();
    }
    let mut found: Vec<(String, Option<String>)> =
        split(first).and_then(|(_, value)| quantity(value)).into_iter().collect();
    let mut unit = bracketed(first);
    for cell in rest.iter().filter(|cell| !cell.is_empty()) {
        if let Some(value) = quantity(cell) {
            found.push(value);
        } else if let (true, Some(last)) = (is_unit(cell), found.last_mut()) {
            let written = bare(cell).to_owned();
            last.1.get_or_insert_with(|| written.clone());
            unit = Some(written);
        } else if found.is_empty() && Unit::parse(cell).is_ok() {
            // The unit before the value.
            unit = Some(cell.clone());
        } else {
            break;
        }
    }
    for (_, own) in &mut found {
        *own = own.take().or_else(|| unit.clone());
    }
    found
}

/// A table with a row a specimen below a row of keys, with units in the keys or in a row of their own; and the row behind
/// it.
fn table(
    rows: &[TextRow],
    start: usize,
    keys: &[(usize, Key)],
    specimens: &[Specimen],
    own: &Range<usize>,
) -> (Vec<Item>, usize) {
    let (mut items, mut end) = (Vec::new(), start + 1);
    let unit_row = rows.get(end).filter(|(_, cells)| !cells.iter().any(|cell| is_number(cell)));
    let unit_row =
        unit_row.filter(|(_, cells)| keys.iter().any(|(at, _)| cells.get(*at).is_some_and(|cell| is_unit(cell))));
    end += usize::from(unit_row.is_some());
    let first = end;
    while let Some((row, cells)) = rows.get(end) {
        let filled = |at: &usize| cells.get(*at).filter(|cell| is_number(cell) || quantity(cell).is_some());
        let quantities = || keys.iter().filter(|(_, key)| !matches!(key, Key::Name | Key::Direction));
        if quantities().count() == 0 || !quantities().any(|(at, _)| filled(at).is_some()) {
            break;
        }
        // By its name where that is one of them, or else in their order.
        let name = cells.iter().find_map(|cell| specimens.iter().position(|other| plain(&other.name) == plain(cell)));
        let ordered = (end - first < specimens.len().saturating_sub(own.start)).then(|| own.start + (end - first));
        let Some(specimen) = name.or(ordered) else { break };
        for (at, key) in keys.iter().filter(|(_, key)| *key != Key::Name) {
            let Some(cell) = cells.get(*at).filter(|cell| !cell.is_empty()) else { continue };
            let heading = &rows[start].1[*at];
            let below = unit_row.and_then(|(_, cells)| cells.get(*at)).filter(|cell| is_unit(cell));
            let below = below.map(|cell| bare(cell).to_owned());
            let value = match key {
                Key::Direction => Some((cell.clone(), None)),
                _ => quantity(cell)
                    .map(|(number, unit)| (number, unit.or_else(|| below.clone().or_else(|| bracketed(heading))))),
            };
            let Some(value) = value else { continue };
            items.push(Item {
                row: *row,
                key: *key,
                word: label(heading),
                values: vec![value],
                of: Some(vec![specimen]),
            });
        }
        end += 1;
    }
    (items, end)
}

/// A cell without brackets around it.
fn bare(cell: &str) -> &str {
    cell.trim_matches(['[', ']', '(', ')'])
}

fn is_unit(cell: &str) -> bool {
    Unit::parse(bare(cell)).is_ok()
}
