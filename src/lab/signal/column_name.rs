//! The name and the unit of a column, as its header states them.

use base::units::Unit;

/// Name of the time axis in tables that droptower writes.
pub const TIME: &str = "time_s";

/// The name of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnName {
    /// Without the unit.
    pub name: String,
    /// As it was written.
    pub label: String,
    pub unit: Option<Unit>,
    /// Text in the place of a unit that is none that is known.
    pub unknown_unit: Option<String>,
}

/// Names of the column that holds the time, in lower case; `t` is time only so, since `T` is a temperature.
const TIMES: [&str; 10] =
    ["time", "zeit", "temps", "tiempo", "tempo", "tid", "prüfzeit", "testzeit", "test time", "elapsed time"];

impl ColumnName {
    /// Whether it is named like a time.
    pub fn is_time(&self) -> bool {
        self.name == "t" || TIMES.contains(&self.name.to_lowercase().as_str())
    }

    /// Reads `accel [g]`, `accel (g)`, `accel in g`, `accel / g`, `accel_g` or a name without unit.
    pub fn read(label: &str) -> ColumnName {
        let label = label.trim();
        bracketed(label, ['[', ']'])
            .or_else(|| bracketed(label, ['(', ')']))
            .or_else(|| worded(label))
            .or_else(|| divided(label))
            .or_else(|| Unit::of_name(label).map(|(name, unit)| known(label, name, unit)))
            .unwrap_or_else(|| plain(label))
    }
}

fn plain(label: &str) -> ColumnName {
    ColumnName { name: label.into(), label: label.into(), unit: None, unknown_unit: None }
}

fn known(label: &str, name: &str, unit: Unit) -> ColumnName {
    ColumnName { name: name.trim().into(), unit: Some(unit), ..plain(label) }
}

/// `accel [g]`; round brackets may hold anything else, and a number in them counts.
fn bracketed(label: &str, [open, close]: [char; 2]) -> Option<ColumnName> {
    let (name, symbol) = label.strip_suffix(close)?.rsplit_once(open)?;
    let counts = open == '(' && symbol.chars().all(|letter| letter.is_ascii_digit());
    if name.trim().is_empty() || counts {
        return None;
    }
    Some(match Unit::parse(symbol) {
        Ok(_) if open == '(' && is_word_of_its_own(name, symbol) => return None,
        Ok(unit) => known(label, name, unit),
        Err(_) if open == '(' => return None,
        Err(_) => ColumnName { name: name.trim().into(), unknown_unit: Some(symbol.into()), ..plain(label) },
    })
}

/// `Zeit in ms`, `accel in g`: the same word in English, German, and other languages.
fn worded(label: &str) -> Option<ColumnName> {
    let (name, symbol) = label.rsplit_once(" in ")?;
    Unit::parse(symbol.trim()).ok().filter(|_| !name.trim().is_empty()).map(|unit| known(label, name, unit))
}

/// `a / m/s2`: the unit is the longest that stands behind a stroke.
fn divided(label: &str) -> Option<ColumnName> {
    label.match_indices('/').find_map(|(place, _)| {
        let name = label[..place].trim();
        let symbol = &label[place + 1..];
        let unit = Unit::parse(symbol).ok()?;
        (!name.is_empty() && !is_word_of_its_own(name, symbol)).then(|| known(label, name, unit))
    })
}

/// Whether `symbol` behind a name says something else than its unit: `min` a least value, `h` a height, `l` left, of all but times.
fn is_word_of_its_own(name: &str, symbol: &str) -> bool {
    let is_time = || plain(name.trim()).is_time();
    matches!(symbol.trim(), "l" | "h" | "min") && !is_time()
}

/// The units of a line below the header; none where the line holds something else.
pub fn units_of_line(cells: impl Iterator<Item = impl AsRef<str>>) -> Option<Vec<UnitCell>> {
    let units: Option<Vec<UnitCell>> = cells.map(|cell| unit_cell(cell.as_ref())).collect();
    units.filter(|units| units.iter().any(|unit| matches!(unit, UnitCell::Known(_))))
}

/// A cell of a line of units.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitCell {
    Empty,
    Known(Unit),
    /// In brackets, and none that is known.
    Unknown(String),
}

fn unit_cell(text: &str) -> Option<UnitCell> {
    let inner = |open, close| text.strip_prefix(open)?.strip_suffix(close);
    let bracketed = inner('[', ']').or_else(|| inner('(', ')'));
    match Unit::parse(bracketed.unwrap_or(text)) {
        _ if text.is_empty() => Some(UnitCell::Empty),
        Ok(unit) => Some(UnitCell::Known(unit)),
        Err(_) => bracketed.map(|symbol| UnitCell::Unknown(symbol.into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_their_units() {
        for line in include_str!("column_names.txt").lines() {
            let [label, name, unit] = line.split(" | ").collect::<Vec<_>>()[..] else { panic!("{line}") };
            let found = ColumnName::read(label);
            assert_eq!(found.name, name);
            assert_eq!(found.label, label);
            let expected = (!unit.is_empty()).then(|| Unit::parse(&unit.replace('_', "/")).unwrap());
            assert_eq!(found.unit, expected, "{label}");
        }
        assert_eq!(ColumnName::read("temperature [°C]").unknown_unit.as_deref(), Some("°C"));
    }

    #[test]
    fn a_line_of_units_holds_nothing_else() {
        assert!(units_of_line(["s", "[g]", "", "[°C]"].into_iter()).is_some());
        assert!(units_of_line(["time", "g"].into_iter()).is_none());
        assert!(units_of_line(["", ""].into_iter()).is_none());
        assert!(units_of_line(["t", "d", "a"].into_iter()).is_none());
    }
}
