//! The page of several recordings.

use super::super::html::{self, escape};
use super::super::table::{self, Cell, folded};
use super::super::{drawn, figure};
use super::test::{DROP_QUANTITIES, DropTest, FigureScatter, names};
use super::{DropPage, answer, origins, plots};
use base::diagnostic::shown_path;
use base::finding::Finding;
use base::number::significant;
use plot::{Plot, thinned};

/// Most drops over each other, and most small plots.
const MOST_OVERLAID: usize = 60;
const MOST_SMALL: usize = 60;

/// What the folders hold besides recordings.
const LEFT_OUT: &str = "what the folders hold besides recordings";

/// Most points of the curves over each other, and of the small plots.
const MOST_POINTS: [usize; 2] = [40_000, 30_000];

/// The page of several recordings.
pub(super) fn page(page: &DropPage<'_>) -> String {
    let DropPage { tests, scatter, .. } = *page;
    let names = names(tests);
    let title = if tests.len() == 1 { "1 drop test".to_owned() } else { format!("{} drop tests", tests.len()) };
    let body = [
        format!(
            "<h1>{}</h1>\n<p class=\"lead\">{}</p>\n",
            escape(&title),
            escape(&answer::of_several(&names, tests, scatter))
        ),
        overlaid(&names, tests),
        html::section("Medians and scatter", &medians(page)),
        html::section("Recordings", &recordings(&names, tests)),
        html::findings(failures(&names, tests), &findings(&names, tests)),
        html::section("Each recording", &each(&names, tests)),
        html::section("Left out", &folded(LEFT_OUT, &html::list(page.left_out))),
        html::section("What was reduced", &origins(&names, tests)),
        html::section("Run it again", &html::verbatim(page.command)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&title, &body.concat())
}

/// The curves of all drops over each other.
fn overlaid(names: &[String], tests: &[DropTest]) -> String {
    let drops: Vec<_> = names
        .iter()
        .zip(tests)
        .filter_map(|(name, test)| Some((name.as_str(), test, test.outcome.as_ref().ok()?)))
        .collect();
    let shown = &drops[..drops.len().min(MOST_OVERLAID)];
    let plots = thinned(plots::overlaid(shown), MOST_POINTS[0]);
    let rest = (drops.len() > shown.len())
        .then(|| format!("<p class=\"note\">The first {} of {} drops.</p>\n", shown.len(), drops.len()));
    [drawn::medium(&plots), rest.unwrap_or_default()].concat()
}

/// Small plots of each recording.
fn each(names: &[String], tests: &[DropTest]) -> String {
    let plots: Vec<Plot> =
        names.iter().zip(tests).filter_map(|(name, test)| plots::each(name, test)).take(MOST_SMALL).collect();
    let rest = (tests.len() > MOST_SMALL)
        .then(|| format!("<p class=\"note\">The first {MOST_SMALL} of {}.</p>\n", tests.len()));
    [drawn::small(&thinned(plots, MOST_POINTS[1])), rest.unwrap_or_default()].concat()
}

/// A number with the digits of a table.
fn number(value: f64) -> Cell {
    Cell::number(value, significant(value, figure::DIGITS).replace('-', "\u{2212}"))
}

/// A table of medians and scatter for the drops of each mass and height.
fn medians(page: &DropPage<'_>) -> String {
    let head = ["quantity", "median", "lower quartile", "upper quartile", "least", "largest", "drops"].map(Cell::text);
    let row = |figure: &FigureScatter| {
        let quantity = figure.quantity()?;
        let values = figure.shown().map(number);
        let words = Cell::text(quantity.heading()).titled(quantity.name);
        let count = Cell::number(figure.count as f64, figure.count.to_string());
        Some(std::iter::once(words).chain(values).chain([count]).collect::<Vec<Cell>>())
    };
    let is_alone = page.scatter.len() == 1;
    let of = |scatter: &super::DropScatter| {
        let rows: Vec<Vec<Cell>> = scatter.figures.iter().filter_map(row).collect();
        let heading = (!is_alone).then(|| format!("<h3>{}</h3>\n", escape(&scatter.conditions())));
        [heading.unwrap_or_default(), table::table(&head, &rows)].concat()
    };
    let tables: String = page.scatter.iter().map(of).collect();
    if tables.is_empty() {
        return tables;
    }
    let note = "Quartiles are linear between the sorted values (type 7 of Hyndman and Fan 1996, as in NumPy and R). Recordings \
                that could not be reduced, and figures that a recording does not give, are not in them: the last column \
                counts the drops that are.";
    format!("{tables}<p class=\"note\">{note}</p>\n")
}

/// A row a recording.
fn recordings(names: &[String], tests: &[DropTest]) -> String {
    let head = ["recording", "mass (kg)", "height (m)"].map(Cell::text).into_iter();
    let quantities = DROP_QUANTITIES.iter().map(|quantity| Cell::text(quantity.heading()).titled(quantity.name));
    let head: Vec<Cell> = head.chain(quantities).chain([Cell::text("findings, or why there is no drop")]).collect();
    let row = |(name, test): (&String, &DropTest)| {
        let value = |value: Option<f64>| value.map_or_else(Cell::default, number);
        let values = DROP_QUANTITIES.iter().map(|quantity| {
            value(test.figures.as_ref().and_then(|figures| Some(quantity.factor * (quantity.of)(figures)?)))
        });
        let conditions = [test.tower.map(|tower| tower.body.mass), test.height()].map(value);
        let name = Cell::text(name).titled(&shown_path(&test.path));
        std::iter::once(name)
            .chain(conditions)
            .chain(values)
            .chain([Cell::text(test.cause().unwrap_or_else(|| test.codes().join(", ")))])
            .collect()
    };
    table::table(&head, &names.iter().zip(tests).map(row).collect::<Vec<Vec<Cell>>>())
}

fn failures(names: &[String], tests: &[DropTest]) -> Vec<String> {
    let cause = |(name, test): (&String, &DropTest)| Some(format!("{name}: {}", test.cause()?));
    names.iter().zip(tests).filter_map(cause).collect()
}

/// The findings of all tests, each with the name of its test.
fn findings(names: &[String], tests: &[DropTest]) -> Vec<Finding> {
    let of_test = |(name, test): (&String, &DropTest)| {
        let named = |finding: &Finding| {
            let mut finding = Finding { message: format!("{name}: {}", finding.message), ..finding.clone() };
            finding.figures.insert(html::TEST.into(), name.as_str().into());
            finding
        };
        test.findings.iter().map(named).collect::<Vec<_>>()
    };
    names.iter().zip(tests).flat_map(of_test).collect()
}
