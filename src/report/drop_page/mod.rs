//! The page of recorded drops: of one recording what it shows, also where no drop was reduced; of several a table, their
//! scatter, and their curves over each other.

mod answer;
mod plots;
mod several;
mod test;

use serde_json::{Map, Value};

use super::html::{self, escape};
use super::table::folded;
use super::{drawn, key_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::significant;
use plot::thinned;

pub use plots::reading;
pub use test::{DROP_QUANTITIES, DropQuantity, DropScatter, DropTest, FigureScatter, names};

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
        _ => several::page(page),
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
    let whole = plots::whole(test);
    let about = match &test.outcome {
        Ok(drop) => plots::impact(test, drop),
        Err(_) => plots::laser(test).into_iter().collect(),
    };
    let count = about.len();
    let mut plots = thinned(about.into_iter().chain(whole).collect(), MOST_POINTS);
    let whole = plots.split_off(count);
    let rows: Vec<Vec<String>> = match &test.outcome {
        Ok(_) => page.figures.iter().map(|(name, value)| vec![(*name).to_owned(), value.clone()]).collect(),
        Err(_) => found(test),
    };
    let heading = if test.outcome.is_ok() { "Figures" } else { "What was found" };
    let body = [
        format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(&title), escape(&answer::of_one(test))),
        test.outcome.as_ref().err().map(remedy).unwrap_or_default(),
        html::findings(Vec::new(), &test.findings),
        key_figures::of_drop(&figures),
        drawn::figures(&whole),
        match &test.outcome {
            Ok(_) => html::section("Impact", &drawn::medium(&plots)),
            Err(_) => html::section("Laser", &drawn::figures(&plots)),
        },
        html::section(heading, &html::table(&[], &rows)),
        html::section("Comments of the file", &html::list(&comments(test))),
        html::section("What was reduced", &html::table(&[], &origin(test))),
        html::section("Run it again", &html::verbatim(page.command)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&title, &body.concat())
}

/// The change that helps with a recording that is not reduced.
fn remedy(mistake: &Diagnostic) -> String {
    mistake.hint.as_ref().map_or_else(String::new, |hint| format!("<p class=\"note\">{}</p>\n", escape(hint)))
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
fn origins(names: &[String], tests: &[DropTest]) -> String {
    let row = |(name, test): (&String, &DropTest)| {
        vec![name.clone(), shown_path(&test.path), test.fingerprint.clone().unwrap_or_default()]
    };
    let header = ["recording", "path", "SHA-256"].map(String::from);
    let rows: Vec<Vec<String>> = names.iter().zip(tests).map(row).collect();
    folded("files and their checksums", &html::table(&header, &rows))
}
