//! Stress–strain curves from files: CSV with the columns `strain` and `stress` (Pa), `stress_kPa` or `stress_MPa`, whose points
//! have their lines in messages; whatever else recordings are read from, with the units of its headers.

use std::path::Path;
use std::sync::Arc;

use csv::{ReaderBuilder, StringRecord, Trim};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::tree::{Node, Value};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::units::{Pressure, Strain};
use lab::signal::{MeasuredChannel, ReadOptions, file};

/// Words in the names of strains, in lower case.
const STRAINS: [&str; 5] = ["strain", "dehnung", "stauchung", "scherung", "verformung"];
/// Words in the names of what is over the present length or section, which a curve is not of.
const TRUE: [&str; 4] = ["true", "wahre", "cauchy", "hencky"];
/// Words in the names of stresses.
const STRESSES: [&str; 2] = ["stress", "spannung"];

/// Which columns hold the curve, and the factor of the stress column to Pa.
struct Columns {
    strain: usize,
    stress: usize,
    factor: f64,
}

/// The points of a text file as a list of `[strain, stress]`, each at its line; all mistakes at once.
pub fn read(path: &Path, source: &Arc<Source>) -> Result<Node, Vec<Diagnostic>> {
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).flexible(true).from_reader(source.text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let Some(columns) = columns(&header) else {
        return read_as_recording(path, source).map_err(|mistake| vec![mistake]);
    };
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

/// The points of a file that is read as a recording; they have its first line.
pub fn read_as_recording(path: &Path, source: &Arc<Source>) -> Result<Node, Diagnostic> {
    let at = Span::line(source, 1);
    let table = file::columns(path, &ReadOptions::default()).map_err(|error| {
        let place = error.place().filter(|_| !source.text.is_empty()).map(|(_, line, _)| Span::line(source, line));
        Diagnostic { hint: error.hint().map(str::to_owned), ..Diagnostic::new(error.to_string()) }
            .at(&place.unwrap_or(at.clone()))
    })?;
    let columns = &table.channels;
    let is_named =
        |own: &MeasuredChannel, words: &[&str]| words.iter().any(|word| own.name.to_lowercase().contains(word));
    let is_of =
        |own: &MeasuredChannel, dimension| own.unit.as_ref().is_none_or(|unit| unit.dimension() == Some(dimension));
    let strain = only(columns, "strain", |own| is_named(own, &STRAINS) && is_of(own, Strain::DIMENSION));
    let stress = only(columns, "stress", |own| is_named(own, &STRESSES) && is_of(own, Pressure::DIMENSION));
    let known = || {
        let names: Vec<String> = columns.iter().map(|own| format!("`{}`", own.label)).collect();
        format!(
            "it has {}; a curve has a strain, such as `strain [%]`, and a stress, such as `stress [MPa]`",
            names.join(", ")
        )
    };
    let of_file = |text: String| Diagnostic::new(format!("{}: {text}", shown_path(path))).at(&at);
    // A flow curve is of true stress over plastic strain; every other is of engineering values.
    let is_flow = strain.as_ref().is_ok_and(|own| is_named(own, &["plast"]));
    let is_true = |own: &&&MeasuredChannel| !is_flow && is_named(own, &TRUE);
    if let Some(own) = [&strain, &stress].into_iter().flatten().find(is_true) {
        let hint = "a curve has engineering strain and stress, over the length and the section before the test";
        return Err(of_file(format!("`{}` is no engineering value", own.label)).hint(hint));
    }
    let (strain, stress) =
        strain.and_then(|strain| Ok((strain, stress?))).map_err(|text| of_file(text).hint(known()))?;
    if stress.unit.is_none() {
        let hint = format!("write it into the header: `{} [MPa]`", stress.name);
        return Err(of_file(format!("the stress `{}` has no unit", stress.label)).hint(hint));
    }
    let point = |(strain, stress): (&f64, &f64)| {
        let items = [strain, stress].map(|number| Node::new(Value::Number(*number), at.clone()));
        Node::new(Value::List(items.into()), at.clone())
    };
    // Rows in which nothing was measured are no points.
    let rows = || strain.series.values().iter().zip(stress.series.values());
    if let Some(row) = rows().position(|(strain, stress)| strain.is_finite() != stress.is_finite()) {
        return Err(of_file(format!("row {} has only one of `{}` and `{}`", row + 1, strain.label, stress.label)));
    }
    let rows = rows().filter(|(strain, _)| strain.is_finite());
    let points: Vec<Node> = rows.map(point).collect();
    if points.is_empty() {
        return Err(of_file("the curve has no points".into()));
    }
    Ok(Node::new(Value::List(points), at))
}

/// The only column of a kind.
fn only<'c>(
    columns: &'c [MeasuredChannel],
    what: &str,
    is_own: impl Fn(&MeasuredChannel) -> bool,
) -> Result<&'c MeasuredChannel, String> {
    let mut own = columns.iter().filter(|column| is_own(column));
    match (own.next(), own.next()) {
        (Some(column), None) => Ok(column),
        (Some(one), Some(other)) => Err(format!("`{}` and `{}` may both be the {what}", one.label, other.label)),
        (None, _) => Err(format!("no column is a {what}")),
    }
}

fn columns(header: &StringRecord) -> Option<Columns> {
    // Spreadsheets start their files with a byte order mark.
    let place = |name: &str| header.iter().position(|column| column.trim_start_matches('\u{feff}') == name);
    let stresses = [("stress", 1.0), ("stress_Pa", 1.0), ("stress_kPa", 1e3), ("stress_MPa", 1e6)];
    let stress = stresses.iter().find_map(|(name, factor)| Some((place(name)?, *factor)));
    let (strain, (stress, factor)) = (place("strain")?, stress?);
    Some(Columns { strain, stress, factor })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file of this text has as points, or its mistakes.
    fn points(text: &str) -> Result<Vec<[f64; 2]>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        std::fs::write(&path, text).unwrap();
        let node = read(&path, &Source::file(&path, text.into()));
        node.map(|node| numbers(&node))
            .map_err(|mistakes| mistakes.iter().map(|own| format!("{} {:?}", own.message, own.hint)).collect())
    }

    fn numbers(node: &Node) -> Vec<[f64; 2]> {
        let Value::List(points) = &node.value else { panic!("a curve is a list") };
        let number = |node: &Node| if let Value::Number(number) = node.value { number } else { f64::NAN };
        let point = |node: &Node| {
            if let Value::List(pair) = &node.value { [number(&pair[0]), number(&pair[1])] } else { [f64::NAN; 2] }
        };
        points.iter().map(point).collect()
    }

    #[test]
    fn curves_are_read_as_laboratories_write_them() {
        let expected = [[0.01, 2.5e6], [0.1, 8e6], [3.0, 24e6]];
        for text in [
            "strain,stress\n0.01,2.5e6\n0.1,8e6\n3,24e6\n",
            "strain,stress_MPa\n0.01,2.5\n0.1,8\n3,24\n",
            "strain [%],stress [MPa]\n1,2.5\n10,8\n300,24\n",
            "Strain,Stress_MPa\n0.01,2.5\n0.1,8\n3,24\n",
            "Dehnung;Spannung\n%;MPa\n1,0;2,5\n10;8\n300;24\n",
            "True plastic strain [%],True stress [MPa]\n1,2.5\n10,8\n300,24\n",
            "# a coupon\ntime_s,Eng. strain (%),Force [N],Tensile stress in kPa\n0,1,5,2500\n1,10,6,8000\n2,300,7,24000\n",
        ] {
            let found = points(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            let off =
                found.iter().zip(expected).all(|(a, b)| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs()));
            assert!(off && found.len() == 3, "{text}: {found:?}");
        }
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/it/formats/curves/curve.xlsx"));
        let node = read_as_recording(path, &Source::file(path, String::new())).unwrap();
        assert_eq!(numbers(&node), expected);
        assert!(file::lists_channels(path));
    }

    #[test]
    fn what_a_file_lacks_is_named() {
        for (text, named) in [
            ("stretch,stress [MPa]\n1.1,2\n", "no column is a strain"),
            ("strain [%],force [N]\n1,2\n", "no column is a stress"),
            ("strain [%],true strain,stress [MPa]\n1,1,2\n", "`strain [%]` and `true strain` may both be the strain"),
            ("Strain [%],Stress\n1,2\n", "the stress `Stress` has no unit"),
            ("True strain [%],True stress [MPa]\n1,2\n", "`True strain [%]` is no engineering value"),
            ("Strain [%],Stress [MPa]\n1,2\n2,\n", "row 2 has only one"),
            ("Strain [mm],Stress [MPa]\n1,2\n", "no column is a strain"),
            ("Strain [%],Stress [MPa]\n", ""),
            ("strain,stress\n0.1,x\n", "expected a number"),
        ] {
            let error = points(text).expect_err(text);
            assert!(error.contains(named), "{text}: {error}");
        }
    }
}
