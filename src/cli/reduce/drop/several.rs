//! Several recordings: a table with a row each, their scatter, one page.

use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::failure::ExitStatus;
use crate::reduce::drop::reduce::{Reading, Reducer};
use crate::reduce::drop::{DropArgs, Recordings, write_page};
use crate::shell::command_line;
use crate::{Failure, Shared, output, print_figures, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::group;
use base::number::{rounded, significant};
use base::table::{Column, Values, to_csv};
use lab::experiment::drop::Figures;
use report::drop_page::{DROP_QUANTITIES, DropQuantity, names, several_answer};
use report::{DropPage, DropScatter, DropTest, FigureScatter};
use uncertainty::statistics::quantiles;

/// Significant digits of a cell.
const DIGITS: usize = 4;

/// Quantities that are printed of each recording: a line has its findings, too.
const PRINTED: usize = 4;

/// What a cell without a value shows.
const NOTHING: &str = "-";

/// What `--json` prints.
#[derive(Serialize)]
struct Printed<'a> {
    recordings: Vec<Row<'a>>,
    scatter: &'a [DropScatter],
    reduced: usize,
    failed: usize,
    left_out: &'a [String],
    written: Vec<String>,
}

/// A recording, reduced or not.
#[derive(Serialize)]
struct Row<'a> {
    recording: String,
    sha256: Option<&'a str>,
    mass_kg: Option<f64>,
    height_m: Option<f64>,
    #[serde(flatten)]
    figures: Option<&'a Figures>,
    findings: &'a [Finding],
    /// Why there is no drop.
    error: Option<String>,
    hint: Option<&'a str>,
}

impl<'a> Row<'a> {
    fn of(test: &'a DropTest) -> Row<'a> {
        let mistake = test.outcome.as_ref().err();
        Row {
            recording: shown_path(&test.path),
            sha256: test.fingerprint.as_deref(),
            mass_kg: test.tower.map(|tower| tower.body.mass),
            height_m: test.height(),
            figures: test.figures.as_ref(),
            findings: &test.findings,
            error: test.cause(),
            hint: mistake.and_then(|mistake| mistake.hint.as_deref()),
        }
    }
}

/// Reduces all recordings, and writes and prints what they give.
pub(super) fn run(
    args: &DropArgs,
    reducer: &Reducer<'_>,
    recordings: Recordings,
    shared: &Shared,
) -> Result<(), Failure> {
    let Recordings { paths, mut left_out, .. } = recordings;
    let light = |reading: Reading| Reading { test: reading.test.lightened(), ..reading };
    let read: Vec<_> = paths.par_iter().map(|(path, in_folder)| (light(reducer.reduced(path)), *in_folder)).collect();
    // Whoever names a file means it; a folder may hold other texts.
    let (others, read): (Vec<_>, Vec<_>) =
        read.into_iter().partition(|(reading, in_folder)| *in_folder && !reading.holds_numbers);
    left_out.extend(others.iter().map(|(reading, _)| shown_path(&reading.test.path)));
    let tests: Vec<DropTest> = read.into_iter().map(|(reading, _)| reading.test).collect();
    if tests.is_empty() {
        let mistake = Diagnostic::new("the folders hold no recordings");
        return Err(mistake.hint(format!("without a row of numbers: {}", left_out.join(", "))).into());
    }
    let scatter = scatter(&tests);
    if let Some(out) = &args.out {
        output::write(out, |file| file.write_all(&to_csv(&columns(&tests))?))?;
    }
    let command = command_line();
    let page = DropPage {
        tests: &tests,
        is_list: true,
        scatter: &scatter,
        figures: &[],
        left_out: &left_out,
        command: &command,
    };
    write_page(args, &page)?;
    let failed = tests.iter().filter(|test| test.outcome.is_err()).count();
    let written = [&args.out, &args.page].into_iter().flatten().map(|path| shown_path(path)).collect();
    let printed = Printed {
        recordings: tests.iter().map(Row::of).collect(),
        scatter: &scatter,
        reduced: tests.len() - failed,
        failed,
        left_out: &left_out,
        written,
    };
    print_figures(shared, &printed, || text(&tests, &printed))?;
    match failure(&tests) {
        Some(failure) => Err(failure),
        None => Ok(()),
    }
}

/// The recordings that could not be reduced: results are incomplete, or there are none.
fn failure(tests: &[DropTest]) -> Option<Failure> {
    let diagnostics: Vec<_> = tests.iter().filter_map(|test| test.outcome.as_ref().err()).cloned().collect();
    let status = match diagnostics.len() == tests.len() {
        true => ExitStatus::BadInput,
        false => ExitStatus::OutputFailed,
    };
    (!diagnostics.is_empty()).then(|| Failure { status, ..Failure::from(diagnostics) })
}

fn text(tests: &[DropTest], printed: &Printed<'_>) -> String {
    let left_out = match printed.left_out {
        [] => String::new(),
        names => format!("  left out: {}\n", names.join(", ")),
    };
    let written: String = printed.written.iter().map(|file| format!("  {file}\n")).collect();
    let scatter: String = printed.scatter.iter().map(medians).collect();
    let answer = terminal::sentences(&several_answer(tests, printed.scatter));
    [answer, rows(tests), scatter, reported(tests), left_out, written].concat()
}

/// A row a recording: figures, then the codes of its findings or why there is no drop.
fn rows(tests: &[DropTest]) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| NOTHING.into(), |value| significant(value, DIGITS));
    let head = ["recording", "height (m)"].map(String::from).into_iter();
    let head = head.chain(DROP_QUANTITIES[..PRINTED].iter().map(|quantity| quantity.heading()));
    let names = names(tests);
    let row = |(name, test): (&String, &DropTest)| {
        let values = DROP_QUANTITIES[..PRINTED].iter().map(|quantity| {
            number(test.figures.as_ref().and_then(|figures| Some(quantity.factor * (quantity.of)(figures)?)))
        });
        [name.clone(), number(test.height())].into_iter().chain(values).collect::<Vec<String>>()
    };
    let lines = terminal::table(1, head, names.iter().zip(tests).map(row));
    let beside = |test: &DropTest| test.cause().unwrap_or_else(|| test.codes().join(", "));
    let beside = std::iter::once("findings, or why there is no drop".to_owned()).chain(tests.iter().map(beside));
    lines.lines().zip(beside).map(|(line, beside)| format!("{}\n", format!("{line}  {beside}").trim_end())).collect()
}

/// Medians and scatter of drops of one mass and height.
fn medians(scatter: &DropScatter) -> String {
    let head = ["median", "lower quartile", "upper quartile", "least", "largest", "drops"];
    let title = format!("{}, {} drops", scatter.conditions(), scatter.drops);
    let row = |figure: &report::FigureScatter| {
        let words = figure.quantity()?.heading();
        let values = figure.shown().map(|value| significant(value, DIGITS));
        Some(std::iter::once(words).chain(values).chain([figure.count.to_string()]).collect::<Vec<String>>())
    };
    let head = std::iter::once(title.as_str()).chain(head);
    format!("\n{}", terminal::table(1, head, scatter.figures.iter().filter_map(row)))
}

/// The findings, one line a code: the first that was reported, and how many recordings have it.
fn reported(tests: &[DropTest]) -> String {
    let with_codes = tests.iter().flat_map(|test| test.codes().into_iter().map(move |code| (code, test)));
    let shown = |(code, with): (&str, Vec<&DropTest>)| {
        let first = with[0].findings.iter().find(|finding| finding.code == code)?;
        let message = format!("{} of {}: {}", with.len(), tests.len(), first.message);
        Some(Finding { message, ..first.clone() })
    };
    let all: Vec<Finding> = group::by_key(with_codes).into_iter().filter_map(shown).collect();
    if all.is_empty() { String::new() } else { format!("\n{}", terminal::findings("  ", &all)) }
}

/// The table that is written: SI, with every figure that is a number.
fn columns(tests: &[DropTest]) -> Vec<Column> {
    let texts = |name: &str, of: &dyn Fn(&DropTest) -> Option<String>| {
        let values = Values::Texts(tests.iter().map(of).collect());
        Column { name: name.into(), values }
    };
    let numbers = |name: &str, of: &dyn Fn(&DropTest) -> Option<f64>| {
        Column::of_numbers(name, tests.iter().map(|test| of(test).unwrap_or(f64::NAN)))
    };
    let figures = |test: &DropTest| match test.figures.as_ref().map(serde_json::to_value) {
        Some(Ok(Value::Object(figures))) => figures,
        _ => Map::new(),
    };
    let figures: Vec<Map<String, Value>> = tests.iter().map(figures).collect();
    let numbers_of_all = figures.iter().flatten().filter(|(_, value)| value.is_number());
    let keys = group::unique(numbers_of_all.map(|(key, _)| key));
    let of_key = |key: &String| {
        let values = figures.iter().map(|figures| figures.get(key).and_then(Value::as_f64).unwrap_or(f64::NAN));
        Column::of_numbers(key.as_str(), values)
    };
    let head = [
        texts("recording", &|test| Some(shown_path(&test.path))),
        numbers("mass_kg", &|test| Some(test.tower?.body.mass)),
        numbers("height_m", &DropTest::height),
    ];
    let tail = [
        texts("findings", &|test| Some(test.codes().join(" "))),
        texts("error", &DropTest::cause),
        texts("sha256", &|test| test.fingerprint.clone()),
    ];
    head.into_iter().chain(keys.into_iter().map(of_key)).chain(tail).collect()
}

/// Significant digits by which masses and heights are the same.
const SAME: usize = 6;

/// The scatter of the drops of each mass and height, in the order in which these occur.
pub(super) fn scatter(tests: &[DropTest]) -> Vec<DropScatter> {
    let with_conditions = tests.iter().filter_map(|test| {
        let conditions = [Some(test.tower?.body.mass), test.height()];
        Some((conditions.map(|value| value.map(|value| rounded(value, SAME))), test.figures.as_ref()?))
    });
    let scatter = |([mass, height], figures): ([Option<f64>; 2], Vec<&Figures>)| DropScatter {
        mass_kg: mass.unwrap_or(f64::NAN),
        height_m: height,
        drops: figures.len(),
        figures: DROP_QUANTITIES.iter().filter_map(|quantity| of_quantity(quantity, &figures)).collect(),
    };
    group::by_key(with_conditions).into_iter().map(scatter).collect()
}

fn of_quantity(quantity: &DropQuantity, figures: &[&Figures]) -> Option<FigureScatter> {
    let values: Vec<f64> =
        figures.iter().filter_map(|figures| (quantity.of)(figures)).filter(|value| value.is_finite()).collect();
    let found = quantiles(&values, &[0.0, 0.25, 0.5, 0.75, 1.0])?;
    let [least, low, median, high, largest] = found[..] else { return None };
    let count = values.len();
    Some(FigureScatter { figure: quantity.name, count, median, quartiles: [low, high], range: [least, largest] })
}
