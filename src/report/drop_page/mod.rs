//! The page of recorded drops: of one recording what it shows, also where no drop was reduced; of several a table, their
//! scatter, and their curves over each other.

mod drop_test;
mod plots;

use serde_json::{Map, Value};

use crate::drawn;
use crate::figure::{self, G};
use crate::html::{self, Cell, escape, folded};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::significant;
use lab::experiment::Warning;
use lab::experiment::drop::Drop;
use plot::{Plot, thinned, thinned_together};

pub use crate::drop_page::drop_test::{DROP_QUANTITIES, DropQuantity, DropScatter, DropTest, FigureScatter, names};
pub use crate::drop_page::plots::reading;

/// Most points of all plots of a page, which keep it below 3 MB.
const MOST_POINTS: usize = 60_000;

/// The content of the page of recorded drops.
#[derive(Clone, Copy)]
pub struct DropPage<'a> {
    /// In the order of the call.
    pub tests: &'a [DropTest],
    /// Whether the recordings are shown as a list, though there may be only one.
    pub is_list: bool,
    /// Of the drops of each mass and height.
    pub scatter: &'a [DropScatter],
    /// Figures of a single drop: words and value.
    pub figures: &'a [(&'static str, String)],
    /// What was in the folders besides recordings.
    pub left_out: &'a [String],
    /// The command that makes the page.
    pub command: &'a str,
}

/// The page of recorded drops.
pub fn drop_page(page: &DropPage<'_>) -> String {
    match page.tests {
        [test] if !page.is_list => one(page, test),
        _ => several_page(page),
    }
}

/// The page of one recording.
fn one(page: &DropPage<'_>, test: &DropTest) -> String {
    let title = format!("Drop test {}", test.name());
    let figures = test.figures.as_ref().map(serde_json::to_value);
    let figures: Map<String, Value> = match figures {
        Some(Ok(Value::Object(figures))) => figures,
        _ => Map::new(),
    };
    let about = match &test.outcome {
        Ok(drop) => plots::impact(test, drop),
        Err(_) => plots::laser(test).into_iter().collect(),
    };
    let [plots, whole] = thinned_together([about, Vec::from_iter(plots::whole(test))], MOST_POINTS);
    let rows: Vec<Vec<String>> = match &test.outcome {
        Ok(_) => page.figures.iter().map(|(name, value)| vec![(*name).to_owned(), value.clone()]).collect(),
        Err(_) => found(test),
    };
    let heading = if test.outcome.is_ok() { "Figures" } else { "What was found" };
    let parts = [
        test.outcome.as_ref().err().map(remedy).unwrap_or_default(),
        html::findings(Vec::new(), &test.findings),
        figure::of_drop(&figures),
        drawn::figures(&whole),
        match &test.outcome {
            Ok(_) => html::section("Impact", &drawn::medium(&plots)),
            Err(_) => html::section("Laser", &drawn::figures(&plots)),
        },
        html::section(heading, &html::table::<&str>(&[], &rows)),
        html::section("Comments of the file", &html::list(&comments(test))),
        html::section("What was reduced", &html::table::<&str>(&[], &origin(test))),
        html::section("Run it again", &html::verbatim(page.command)),
    ];
    html::finished(&title, &of_one(test), &parts)
}

/// The change that helps with a recording that is not reduced.
fn remedy(mistake: &Diagnostic) -> String {
    mistake.hint.as_deref().map(html::note).unwrap_or_default()
}

/// The landmarks of a recording that is not reduced.
fn found(test: &DropTest) -> Vec<Vec<String>> {
    let row = |(name, time): (&str, f64)| vec![name.to_owned(), format!("{time:.4} s on the recording's clock")];
    test.landmarks.named().into_iter().map(row).collect()
}

fn comments(test: &DropTest) -> Vec<String> {
    let annotations = test.channels.as_ref().map(|channels| &channels.annotations);
    annotations.map(|annotations| annotations.free_comments().cloned().collect()).unwrap_or_default()
}

/// The recording and its conditions: words and value.
fn origin(test: &DropTest) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let samples = test.channels.as_ref().map(|channels| channels.acceleration.len().to_string());
    let rows = [
        Some(row("recording", shown_path(&test.path))),
        test.fingerprint.as_ref().map(|digest| row("SHA-256", digest.clone())),
        samples.map(|count| row("samples of the acceleration", count)),
        test.tower.map(|tower| row("mass of the impactor", format!("{} kg", significant(tower.body.mass, 6)))),
        test.height().map(|height| row("height of fall", format!("{} m", significant(height, 6)))),
        test.tower.map(|tower| row("gravity", format!("{} m/s²", significant(tower.body.gravity, 6)))),
        Some(row("reduced by", format!("droptower {}", env!("CARGO_PKG_VERSION")))),
    ];
    rows.into_iter().flatten().collect()
}

/// The files of several recordings with their digests, folded.
fn origins(tests: &[Named]) -> String {
    let row = |(name, test): &Named| {
        vec![(*name).to_owned(), shown_path(&test.path), test.fingerprint.clone().unwrap_or_default()]
    };
    let rows: Vec<Vec<String>> = tests.iter().map(row).collect();
    folded("files and their checksums", &html::table(&["recording", "path", "SHA-256"], &rows))
}

/// A recording of several and its name among them.
type Named<'a> = (&'a str, &'a DropTest);

fn named<'a>(names: &'a [String], tests: &'a [DropTest]) -> Vec<Named<'a>> {
    names.iter().map(String::as_str).zip(tests).collect()
}

/// Most drops over each other, and most small plots.
const MOST_OVERLAID: usize = 60;
const MOST_SMALL: usize = 60;

/// What the folders hold besides recordings.
const LEFT_OUT: &str = "what the folders hold besides recordings";

/// Most points of the curves over each other, and of the small plots.
const MOST_OF_SEVERAL: [usize; 2] = [40_000, 30_000];

/// The sentence of the page of several recordings.
pub fn several_answer(tests: &[DropTest], scatter: &[DropScatter]) -> String {
    of_several(&named(&names(tests), tests), scatter)
}

/// The page of several recordings.
fn several_page(page: &DropPage<'_>) -> String {
    let DropPage { tests, scatter, .. } = *page;
    let names = names(tests);
    let named = named(&names, tests);
    let title = if tests.len() == 1 { "1 drop test".to_owned() } else { format!("{} drop tests", tests.len()) };
    let parts = [
        html::findings(failures(&named), &findings(&named)),
        overlaid(&named),
        html::section("Medians and scatter", &medians(page)),
        html::section("Recordings", &recordings(&named)),
        html::section("Each recording", &each(&named)),
        html::section("Left out", &folded(LEFT_OUT, &html::list(page.left_out))),
        html::section("What was reduced", &origins(&named)),
        html::section("Run it again", &html::verbatim(page.command)),
    ];
    html::finished(&title, &of_several(&named, scatter), &parts)
}

/// The curves of all drops over each other.
fn overlaid(tests: &[Named]) -> String {
    let drops: Vec<_> =
        tests.iter().filter_map(|(name, test)| Some((*name, *test, test.outcome.as_ref().ok()?))).collect();
    let shown = &drops[..drops.len().min(MOST_OVERLAID)];
    let plots = thinned(plots::overlaid(shown), MOST_OF_SEVERAL[0]);
    let rest = (drops.len() > shown.len())
        .then(|| html::note(&format!("The first {} of {} drops.", shown.len(), drops.len())));
    [drawn::medium(&plots), rest.unwrap_or_default()].concat()
}

/// Small plots of each recording.
fn each(tests: &[Named]) -> String {
    let plots: Vec<Plot> = tests.iter().filter_map(|(name, test)| plots::each(name, test)).take(MOST_SMALL).collect();
    let rest = (tests.len() > MOST_SMALL).then(|| html::note(&format!("The first {MOST_SMALL} of {}.", tests.len())));
    [drawn::small(&thinned(plots, MOST_OF_SEVERAL[1])), rest.unwrap_or_default()].concat()
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
    let of = |scatter: &DropScatter| {
        let rows: Vec<Vec<Cell>> = scatter.figures.iter().filter_map(row).collect();
        let heading = (!is_alone).then(|| format!("<h3>{}</h3>\n", escape(&scatter.conditions())));
        [heading.unwrap_or_default(), html::sorted_table(&head, &rows)].concat()
    };
    let tables: String = page.scatter.iter().map(of).collect();
    if tables.is_empty() {
        return tables;
    }
    let note = "Quartiles are linear between the sorted values (type 7 of Hyndman and Fan 1996, as in NumPy and R). Recordings \
                that could not be reduced, and figures that a recording does not give, are not in them: the last column \
                counts the drops that are.";
    [tables, html::note(note)].concat()
}

/// A row a recording.
fn recordings(tests: &[Named]) -> String {
    let head = ["recording", "mass (kg)", "height (m)"].map(Cell::text).into_iter();
    let quantities = DROP_QUANTITIES.iter().map(|quantity| Cell::text(quantity.heading()).titled(quantity.name));
    let head: Vec<Cell> = head.chain(quantities).chain([Cell::text("findings, or why there is no drop")]).collect();
    let row = |(name, test): &Named| {
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
    html::sorted_table(&head, &tests.iter().map(row).collect::<Vec<Vec<Cell>>>())
}

fn failures(tests: &[Named]) -> Vec<String> {
    tests.iter().filter_map(|(name, test)| Some(format!("{name}: {}", test.cause()?))).collect()
}

/// The findings of all tests, each with the name of its test.
fn findings(tests: &[Named]) -> Vec<Finding> {
    let named = |name: &str, finding: &Finding| {
        let mut finding = Finding { message: format!("{name}: {}", finding.message), ..finding.clone() };
        finding.figures.insert(html::TEST.into(), name.into());
        finding
    };
    tests.iter().flat_map(|(name, test)| test.findings.iter().map(move |finding| named(name, finding))).collect()
}

/// Significant digits of a figure in a sentence.
const DIGITS: usize = 3;

/// The answer of one recording.
fn of_one(test: &DropTest) -> String {
    let drop = match (&test.outcome, test.cause()) {
        (Ok(drop), _) => drop,
        (Err(_), cause) => return format!("No drop was reduced: {}.", cause.unwrap_or_default()),
    };
    let subject = if test.is_virtual() { "Virtual, not measured: the impactor" } else { "The impactor" };
    let mass =
        test.tower.map_or_else(String::new, |tower| format!(" of {} kg", significant(tower.body.mass, figure::DIGITS)));
    let figures = test.figures.as_ref();
    let intervals = drop.intervals.as_ref();
    let speed = with_interval(-drop.contact.velocity, intervals.map(|of| of.impact_speed), 1.0, "m/s");
    let peak = match (saturated(drop), figures.and_then(|figures| figures.peak_acceleration_m_s2)) {
        (Some(least), _) => format!(", was slowed by at least {} g", significant(least / G, DIGITS)),
        (None, Some(peak)) => format!(", was slowed by {} g at most", significant(peak / G, DIGITS)),
        (None, None) => String::new(),
    };
    let travel = match (drop.lowest_point(), figures.and_then(|figures| figures.peak_displacement_m)) {
        (Some([_, place]), _) => {
            let travel = intervals.map(|of| of.displacement.map(|place| -place));
            format!(" and stopped after {}", with_interval(-place, travel, 1e3, "mm"))
        }
        (None, Some(place)) => {
            format!(" and still descended after {} mm, when the recording ends", significant(-1e3 * place, DIGITS))
        }
        (None, None) => String::new(),
    };
    let absorbed = drop.energy_absorption.map_or_else(String::new, |absorbed| {
        let interval = intervals.and_then(|of| of.energy_absorption);
        format!("; the film absorbed {} of the energy", with_interval(absorbed, interval, 100.0, "%"))
    });
    format!("{subject}{mass} met the film at {speed}{peak}{travel}{absorbed}.")
}

/// A value with its interval of 95 %, times `factor`: `170 mm (95 %: 169 to 171)`, with the digits that its ends differ in.
fn with_interval(value: f64, interval: Option<[f64; 2]>, factor: f64, unit: &str) -> String {
    let Some([a, b]) = interval.map(|ends| ends.map(|end| factor * end)) else {
        return format!("{} {unit}", significant(factor * value, DIGITS));
    };
    let [low, high] = [a.min(b), a.max(b)];
    let decimals = (0.5 - (high - low).max(1e-9).log10()).ceil().clamp(0.0, 6.0) as usize;
    format!("{:.decimals$} {unit} (95 %: {low:.decimals$} to {high:.decimals$})", factor * value)
}

/// The least peak of an accelerometer at the end of its range, m/s².
fn saturated(drop: &Drop) -> Option<f64> {
    drop.warnings.iter().find_map(|warning| match warning {
        Warning::Saturated { peak, .. } => Some(*peak),
        _ => None,
    })
}

/// The answer of several recordings: medians with their quartiles, and what could not be reduced.
fn of_several(tests: &[Named], scatter: &[DropScatter]) -> String {
    let failed: Vec<&str> = tests.iter().filter(|(_, test)| test.outcome.is_err()).map(|(name, _)| *name).collect();
    let medians = match scatter {
        [] => None,
        [one] => Some(format!(
            "Medians and quartiles of {} drops of {}: {}.",
            one.drops,
            one.conditions(),
            medians_in_words(one)
        )),
        several => {
            let of =
                |one: &DropScatter| format!("{} ({} drops): {}", one.conditions(), one.drops, medians_in_words(one));
            Some(format!("Medians and quartiles, {}.", several.iter().map(of).collect::<Vec<_>>().join("; ")))
        }
    };
    let none = match failed.len() {
        0 => None,
        1 => Some(format!("1 of {} recordings could not be reduced: {}.", tests.len(), failed[0])),
        count => Some(format!("{count} of {} recordings could not be reduced: {}.", tests.len(), shortened(&failed))),
    };
    let virtual_ones = tests.iter().filter(|(_, test)| test.is_virtual()).count();
    let mark = (virtual_ones > 0).then(|| match virtual_ones == tests.len() {
        true => "All recordings are virtual, not measured.".to_owned(),
        false => format!("{virtual_ones} of the recordings are virtual, not measured."),
    });
    [medians, none, mark].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// Most names in a sentence.
const MOST_NAMED: usize = 4;

fn shortened(names: &[&str]) -> String {
    let shown = names.iter().take(MOST_NAMED).copied().collect::<Vec<_>>().join(", ");
    match names.len().checked_sub(MOST_NAMED) {
        None | Some(0) => shown,
        Some(more) => format!("{shown} and {more} more"),
    }
}

/// Quantities that a sentence names.
const NAMED: [&str; 4] = ["impact_velocity_m_s", "peak_acceleration_m_s2", "peak_displacement_m", "energy_absorption"];

fn medians_in_words(scatter: &DropScatter) -> String {
    let of = |figure: &FigureScatter| {
        let quantity = figure.quantity().filter(|quantity| NAMED.contains(&quantity.name))?;
        let [median, low, high, ..] = figure.shown().map(|value| significant(value, DIGITS));
        let quartiles = if figure.count > 1 { format!(" ({low} to {high})") } else { String::new() };
        Some(format!("{} {median} {}{quartiles}", quantity.words, quantity.unit))
    };
    scatter.figures.iter().filter_map(of).collect::<Vec<_>>().join(", ")
}
