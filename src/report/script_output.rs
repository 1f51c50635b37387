//! The output of a script as sections of a page, its searches among them.

use serde_json::Value;

use crate::drawn;
use crate::figure::DIGITS;
use crate::html::{self, Cell, folded};
use base::group;
use base::number;
use base::written::Reading;
use plot::{Axis, Curve, Plot, Scale, TIME, thinned};
use scene::scenario::grammar;
use study::script::{ConvergenceHistory, File, Fit, Over, Row, ScriptOutput};

/// Most rows of a table on a page; its file has all of them.
const MOST_ROWS: usize = 200;

/// Most rows of a table that is not folded.
const SHOWN_ROWS: usize = 16;

/// Which tables are folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fold {
    /// All, with the searches and what follows from them.
    All,
    /// Those of many rows.
    Long,
}

/// Plots, tables, searches, correlations and files; empty of a script without output. All plots together have at most
/// `most` points.
pub(crate) fn sections(output: &ScriptOutput, most: usize, fold: Fold) -> String {
    let plots = thinned(output.plots.clone(), most);
    let left = most.saturating_sub(points(&plots));
    let (short, long): (Vec<_>, Vec<_>) = output.tables.iter().partition(|(_, rows)| rows.len() <= SHOWN_ROWS);
    let tables = short.into_iter().chain(long);
    let tables = tables.map(|(name, rows)| (name.replace('_', " "), rows.len(), table(name, rows)));
    let correlations: String =
        output.correlations.iter().map(|found| html::matrix(&found.title, &found.names, &found.rows)).collect();
    let correlations = match fold {
        Fold::All => folded("of the estimates", &correlations),
        Fold::Long => correlations,
    };
    let plots = match fold {
        Fold::All => drawn::medium(&plots),
        Fold::Long => drawn::figures(&plots),
    };
    let plots = html::section("Plots", &plots);
    let sections = [
        searches(output, left, fold),
        html::section("Correlations", &correlations),
        html::section("Files of the script", &html::table_of_numbers(1, &["file", "rows", "bytes"], &files(output))),
    ];
    // Of a study without searches, which answers by its plots and tables, the first short table is open.
    let is_open = |at: usize, count: usize| at == 0 && count <= SHOWN_ROWS && output.searches.is_empty();
    let of_study = |(at, (name, count, table)): (usize, (String, usize, String))| {
        let html = folded(&format!("{name}: {}", counted(count, "row")), &table);
        if is_open(at, count) { html.replacen("<details>", "<details open>", 1) } else { html }
    };
    let tables: String = match fold {
        Fold::All => html::section("Tables", &tables.enumerate().map(of_study).collect::<String>()),
        Fold::Long => tables
            .map(|(name, count, table)| {
                html::section(&name, &if count > SHOWN_ROWS { folded(&counted(count, "row"), &table) } else { table })
            })
            .collect(),
    };
    // A study answers by its plots, a run by the figures of its tables.
    let first = if fold == Fold::All { [plots, tables] } else { [tables, plots] };
    [first.concat(), sections.concat()].concat()
}

/// The columns of a table: every name that a row has, in the order of first appearance.
pub fn columns(rows: &[Row]) -> Vec<String> {
    group::unique(rows.iter().flat_map(Row::keys)).into_iter().cloned().collect()
}

/// A value of a table as text: numbers rounded, empty where there is none.
pub fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::Number(number) if number.is_f64() => number::figure(value.as_f64().unwrap_or(f64::NAN), DIGITS),
        other => other.to_string(),
    }
}

fn table(name: &str, rows: &[Row]) -> String {
    let columns = beside(columns(rows));
    let readings: Vec<(String, Reading)> = columns.iter().map(|name| reading(name, rows)).collect();
    let cells = |row: &Row| {
        let cell = |(name, (_, reading)): (&String, &(String, Reading))| shown(row.get(name), reading);
        columns.iter().zip(&readings).map(cell).collect()
    };
    let shown: Vec<Vec<Cell>> = rows.iter().take(MOST_ROWS).map(cells).collect();
    let header = columns.iter().zip(&readings);
    let header: Vec<Cell> = header.map(|(name, (words, of))| Cell::text(of.heading(words)).titled(name)).collect();
    let rest = match rows.len().saturating_sub(MOST_ROWS) {
        0 => String::new(),
        rest => html::note(&format!("and {rest} more rows in tables/{name}.csv")),
    };
    html::sorted_table(&header, &shown) + rest.as_str()
}

/// `3 rows`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Words and reading of a column, by its name and the largest of its numbers.
fn reading(name: &str, rows: &[Row]) -> (String, Reading) {
    let sizes = rows.iter().filter_map(|row| row.get(name)?.as_f64()).map(f64::abs);
    Reading::of_name(name, sizes.fold(0.0, f64::max))
}

/// A value of a table: a number in the unit of its column, a key by its title.
fn shown(value: Option<&Value>, reading: &Reading) -> Cell {
    match value {
        Some(Value::Number(number)) => Cell::reading(number.as_f64(), reading),
        Some(Value::String(text)) if text.contains('.') => match grammar::title(text) {
            Some(title) => Cell::text(title).titled(text),
            None => Cell::text(text),
        },
        Some(value) => Cell::text(cell(value)),
        None => Cell::default(),
    }
}

/// The columns, each followed by that of the paper, `paper_<name>`, if there is one.
fn beside(columns: Vec<String>) -> Vec<String> {
    let papers = |name: &String| columns.iter().find(|other| other.strip_prefix("paper_") == Some(name)).cloned();
    let is_own =
        |name: &&String| !name.strip_prefix("paper_").is_some_and(|own| columns.iter().any(|other| other == own));
    columns.iter().filter(is_own).flat_map(|name| std::iter::once(name.clone()).chain(papers(name))).collect()
}

fn points(plots: &[Plot]) -> usize {
    plots.iter().flat_map(|plot| &plot.curves).map(|curve| curve.points.len()).sum()
}

/// The plots of each search, as long as its points are within `left`: folded under one heading, or a section each.
fn searches(output: &ScriptOutput, mut left: usize, fold: Fold) -> String {
    let mut shown: Vec<(String, String)> = Vec::new();
    let mut without: Vec<&str> = Vec::new();
    for convergence in &output.searches {
        let plots = search_plots(convergence);
        match left.checked_sub(points(&plots)) {
            Some(rest) => {
                left = rest;
                shown.push((format!("Search: {}", convergence.title), drawn::figures(&plots)));
            }
            None => without.push(&convergence.title),
        }
    }
    let sections = match fold {
        Fold::All => {
            html::section("Searches", &shown.iter().map(|(title, plots)| folded(title, plots)).collect::<String>())
        }
        Fold::Long => shown.iter().map(|(title, plots)| html::section(title, plots)).collect(),
    };
    [sections, html::section("Further searches", &unshown(&without))].concat()
}

fn unshown(without: &[&str]) -> String {
    match without {
        [] => String::new(),
        titles => html::note(&format!("shown in the recording only: {}", titles.join(", "))),
    }
}

/// Name, rows and bytes.
fn files(output: &ScriptOutput) -> Vec<Vec<String>> {
    let row = |file: &File| vec![file.name.clone(), rows(file), file.content.len().to_string()];
    output.files.iter().map(row).collect()
}

/// Rows of a table below its header; nothing of other files.
fn rows(file: &File) -> String {
    let lines = file.content.lines().filter(|line| !line.starts_with('#')).count();
    if file.name.ends_with(".csv") { lines.saturating_sub(1).to_string() } else { String::new() }
}

/// Objective and unknowns over iterations, then every fit; no objective and no unknowns of a search without iterations.
fn search_plots(convergence: &ConvergenceHistory) -> Vec<Plot> {
    let own = [objective(convergence), unknowns(convergence)].into_iter().filter(has_lines);
    own.chain(convergence.fits.iter().map(|fit| best_fit(convergence, fit, "best"))).collect()
}

/// The reference of a fit alone, of a search with this title.
pub(crate) fn target(title: &str, is_virtual: bool, fit: &Fit) -> Plot {
    let x = match fit.target.over {
        Over::Time => TIME,
        Over::Strain => "strain",
        Over::Travel => "travel (mm)",
    };
    let name = if is_virtual { "reference (virtual)" } else { "reference" };
    let reference = Curve::line(name, fit_points(fit, &fit.target.values)).dashed();
    Plot::new(format!("{title}: {}", fit.quantity), [x, fit.label().as_str()], vec![reference])
}

/// Factors from the values of a fit to the units of its axes. Signals over time are in the unit that the script
/// computes them in, stresses over strain in Pa.
fn factors(Fit { unit, target, .. }: &Fit) -> [f64; 2] {
    match target.over {
        Over::Time | Over::Travel => [1e3, 1.0],
        Over::Strain => [1.0, unit.as_ref().map_or(1.0, |unit| 1.0 / unit.to_si(1.0))],
    }
}

/// A simulation of the search, in the units of [`target`].
pub(crate) fn simulated(name: impl Into<String>, fit: &Fit) -> Curve {
    Curve::line(name, fit_points(fit, &fit.values))
}

/// Best values of the objective; one curve a start.
fn objective(ConvergenceHistory { title, objectives, .. }: &ConvergenceHistory) -> Plot {
    let name = |start: usize| if objectives.len() == 1 { "objective".into() } else { format!("start {}", start + 1) };
    let curve = |(start, history): (usize, &Vec<(usize, f64)>)| {
        Curve::line(name(start), history.iter().map(|(iteration, f)| [*iteration as f64, *f]))
    };
    let curves = objectives.iter().enumerate().map(curve).collect();
    let mut plot = Plot::new(format!("{title}: objective"), ["iteration", "objective"], curves);
    if objectives.iter().flatten().all(|(_, f)| *f > 0.0) {
        plot.y = Axis { scale: Scale::Logarithmic, ..plot.y };
    }
    plot
}

fn unknowns(ConvergenceHistory { title, unknowns, history, .. }: &ConvergenceHistory) -> Plot {
    let curve = |(place, name): (usize, &String)| {
        Curve::line(name, history.iter().map(|at| [at.iteration as f64, at.x[place]]))
    };
    let curves = unknowns.iter().enumerate().map(curve).collect();
    Plot::new(format!("{title}: unknowns"), ["iteration", "value"], curves)
}

fn has_lines(plot: &Plot) -> bool {
    plot.curves.iter().any(|curve| curve.points.len() > 1)
}

/// The best simulation, by this name, over its target.
pub(crate) fn best_fit(convergence: &ConvergenceHistory, fit: &Fit, name: &str) -> Plot {
    let mut plot = target(&convergence.title, convergence.is_virtual, fit);
    plot.curves.insert(0, simulated(name, fit));
    plot
}

fn fit_points(fit: &Fit, values: &[f32]) -> Vec<[f64; 2]> {
    let [x, y] = factors(fit);
    fit.target.places.iter().zip(values).map(|(place, value)| [f64::from(*place) * x, f64::from(*value) * y]).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use base::units::Unit;
    use study::script::{Iterate, Target};

    use super::*;

    fn row(value: Value) -> Row {
        value.as_object().cloned().unwrap()
    }

    #[test]
    fn columns_of_the_paper_follow_ours() {
        let columns = ["test", "k1", "ke", "paper_k1", "paper_ke", "paper_only", "papers"].map(String::from).to_vec();
        assert_eq!(beside(columns), ["test", "k1", "paper_k1", "ke", "paper_ke", "paper_only", "papers"]);
    }

    #[test]
    fn long_tables_are_cut_and_name_their_file() {
        let rows: Vec<Row> = (0..250).map(|i| row(json!({ "rupture_time_s": i }))).collect();
        let html = table("times", &rows);
        assert!(html.contains("rupture time (s)") && html.contains("and 50 more rows in tables/times.csv"), "{html}");
        let output = ScriptOutput { tables: vec![("times".into(), rows)], ..ScriptOutput::default() };
        assert!(sections(&output, 0, Fold::All).contains("<h2>Tables</h2>\n<details><summary>times: 250 rows"));
        assert!(sections(&output, 0, Fold::Long).contains("<h2>times</h2>\n<details><summary>250 rows"));
        assert!(html.contains(">199</td>") && !html.contains(">200</td>"));
    }

    #[test]
    fn a_page_shows_searches_up_to_its_limit_of_points() {
        let history: Vec<(usize, f64)> = (0..50_000).map(|iteration| (iteration, 1.0)).collect();
        let search = |title: &str| ConvergenceHistory {
            title: title.into(),
            objectives: vec![history.clone()],
            ..ConvergenceHistory::default()
        };
        let output =
            ScriptOutput { searches: ["first", "<second>", "third"].map(search).into(), ..ScriptOutput::default() };
        let html = sections(&output, 120_000, Fold::All);
        assert!(html.contains("Search: first") && html.contains("&lt;second&gt;: objective"));
        assert!(html.contains("shown in the recording only: third"));
    }

    #[test]
    fn files_have_rows_and_bytes() {
        let file = |name: &str| File { name: name.into(), content: "# virtual\na,b\n1,2\n3,4\n".into() };
        assert_eq!((rows(&file("a.csv")), rows(&file("a.txt"))), ("2".into(), String::new()));
    }

    fn search(objectives: &[f64]) -> ConvergenceHistory {
        let target = Target { over: Over::Time, places: vec![0.0, 0.05], values: vec![0.0, 150.0] };
        let at = |place: usize| Iterate { iteration: place + 1, f: objectives[place], x: vec![objectives[place]] };
        let (quantity, unit) = ("acceleration".into(), Unit::parse("m/s²").ok());
        ConvergenceHistory {
            title: "1008".into(),
            unknowns: vec!["k1".into()],
            objectives: vec![objectives.iter().enumerate().map(|(place, f)| (place + 1, *f)).collect()],
            history: (0..objectives.len()).map(at).collect(),
            fits: vec![Fit { quantity, unit, target, values: vec![0.0, 2.0] }],
            ..ConvergenceHistory::default()
        }
    }

    #[test]
    fn a_search_shows_its_objective_its_unknowns_and_its_curves() {
        let falling: Vec<f64> = (0..60).map(|step| 2.0 * 0.9_f64.powi(step)).collect();
        let plots = search_plots(&search(&falling));
        let [objective, unknowns, curves] = &plots[..] else { panic!("{plots:?}") };
        assert_eq!((objective.y.scale, objective.curves[0].points[0]), (Scale::Logarithmic, [1.0, 2.0]));
        assert_eq!(unknowns.curves[0].name, "k1");
        assert_eq!((curves.title.as_str(), curves.x.label.as_str()), ("1008: acceleration", "time (ms)"));
        assert_eq!(curves.y.label, "acceleration (m/s²)");
        let names: Vec<&str> = curves.curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["best", "reference"]);
        let [time, value] = curves.curves[0].points[1];
        assert!((time - 50.0).abs() < 1e-5 && value == 2.0);
    }

    #[test]
    fn stresses_have_the_unit_that_their_axis_names() {
        let stresses = Target { over: Over::Strain, places: vec![0.0, 0.5], values: vec![0.0, 8e6] };
        for (symbol, expected) in
            [("MPa", ("stress (MPa)", 8.0)), ("kPa", ("stress (kPa)", 8e3)), ("Pa", ("stress (Pa)", 8e6))]
        {
            let (quantity, unit) = ("stress".into(), Unit::parse(symbol).ok());
            let fit = Fit { quantity, unit, target: stresses.clone(), values: vec![] };
            let plot = target("a search", true, &fit);
            assert_eq!((plot.y.label.as_str(), plot.curves[0].points[1][1]), expected);
            assert_eq!(plot.curves[0].name, "reference (virtual)");
        }
    }

    #[test]
    fn a_search_that_stays_where_it_began_has_curves_alone() {
        let found = search_plots(&search(&[0.0]));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].curves.len(), 2);
        assert_eq!(search_plots(&search(&[1.0, -1.0]))[0].y.scale, Scale::Linear);
    }
}
