//! Stress–strain curves from CSV: columns `strain` and `stress` (Pa), `stress_kPa` or `stress_MPa`.

use std::sync::Arc;

use csv::{ReaderBuilder, StringRecord, Trim};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::tree::{Node, Value};
use base::diagnostic::{Diagnostic, Source, Span};
use base::units::Pressure;

/// Which columns hold the curve, and the factor of the stress column to Pa.
struct Columns {
    strain: usize,
    stress: usize,
    factor: f64,
}

/// The points of the file as a list of `[strain, stress]`, each at its line; all mistakes at once.
pub fn read(source: &Arc<Source>) -> Result<Node, Vec<Diagnostic>> {
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).flexible(true).from_reader(source.text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let columns = columns(&header, source).map_err(|mistake| vec![mistake])?;
    let (mut points, mut mistakes) = (Vec::new(), Vec::new());
    for record in reader.records() {
        match record {
            Ok(record) => match point(&record, &columns, source) {
                Ok(point) => points.push(point),
                Err(mistake) => mistakes.push(mistake),
            },
            Err(error) => mistakes.push(Diagnostic::new(error.to_string())),
        }
    }
    if points.is_empty() && mistakes.is_empty() {
        mistakes.push(Diagnostic::new("the curve has no points").at(&Span::line(source, 1)));
    }
    if mistakes.is_empty() { Ok(Node::new(Value::List(points), Span::line(source, 1))) } else { Err(mistakes) }
}

fn columns(header: &StringRecord, source: &Arc<Source>) -> Result<Columns, Diagnostic> {
    // Spreadsheets start their files with a byte order mark.
    let place = |name: &str| header.iter().position(|column| column.trim_start_matches('\u{feff}') == name);
    let stresses = [("stress", 1.0), ("stress_Pa", 1.0), ("stress_kPa", 1e3), ("stress_MPa", 1e6)];
    let stress = stresses.iter().find_map(|(name, factor)| Some((place(name)?, *factor)));
    match (place("strain"), stress) {
        (Some(strain), Some((stress, factor))) => Ok(Columns { strain, stress, factor }),
        _ => {
            let line = header.position().map_or(1, line_of);
            Err(Diagnostic::new("a curve needs the columns `strain` and `stress`")
                .at(&Span::line(source, line))
                .hint("the first line names the columns; `stress_MPa` is known too"))
        }
    }
}

fn point(record: &StringRecord, columns: &Columns, source: &Arc<Source>) -> Result<Node, Diagnostic> {
    let line = Span::line(source, record.position().map_or(1, line_of));
    let number = |column: usize| {
        let text = record.get(column).unwrap_or_default();
        let number = text.parse::<f64>().ok().filter(|n| n.is_finite());
        number.ok_or_else(|| Diagnostic::new(format!("expected a number, found \"{text}\"")).at(&line))
    };
    let strain = number(columns.strain)?;
    let stress = number(columns.stress)? * columns.factor;
    let items = [strain, stress].map(|n| Node::new(Value::Number(n), line.clone()));
    Ok(Node::new(Value::List(items.into()), line))
}

fn line_of(position: &csv::Position) -> usize {
    usize::try_from(position.line()).unwrap_or(1)
}

/// One point of a curve: engineering strain (shear angle in rad, equivalent plastic strain) and stress.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Point(
    #[schemars(range(min = 0), extend("x-likely" = [0.0, 15.0]))] pub f64,
    #[schemars(range(min = 0), extend("x-likely" = [1e5, 1e11]))] pub Pressure,
);
