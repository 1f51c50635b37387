//! The HTML of a page: its frame, the escaping of text in it, tables and lists.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use base::diagnostic::steers;
use base::finding::Finding;
use base::group;
use base::units::Unit;
use base::written::Reading;
use plot::viridis::VIRIDIS;
use study::codes;
use study::post;

pub(super) use base::markup::escape;

/// The figure of a finding that names its test.
pub(crate) const TEST: &str = "test";

/// What a page carries: its styles, its scripts in their order, and a policy by which nothing is loaded from anywhere and no
/// other script runs.
struct Kit {
    styles: String,
    scripts: Vec<String>,
    policy: String,
}

static STILL: LazyLock<Kit> =
    LazyLock::new(|| Kit::with("", &[include_str!("page/raster.js"), include_str!("page/film.js")]));

/// Of a page that renews itself, which has no film.
static LIVING: LazyLock<Kit> =
    LazyLock::new(|| Kit::with(include_str!("page/progress.css"), &[include_str!("page/progress.js")]));

impl Kit {
    /// What all pages carry, and these.
    fn with(styles: &str, scripts: &[&str]) -> Kit {
        let library = include_str!("page/uplot/uPlot.iife.min.js").to_owned();
        let page = format!("const VIRIDIS = {};\n{}", json!(VIRIDIS), include_str!("page/page.js"));
        let parts = [include_str!("page/tables.js"), include_str!("page/plots.js")];
        let own = parts.iter().chain(scripts).map(|script| (*script).to_owned());
        let scripts: Vec<String> = [library, page].into_iter().chain(own).collect();
        // By hashes instead of `unsafe-inline`: a script that slipped through an escape would not run.
        let hash = |script: &String| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script)));
        let hashes = scripts.iter().map(hash).collect::<Vec<_>>().join(" ");
        Kit {
            styles: [include_str!("page/uplot/uPlot.min.css"), include_str!("page/page.css"), styles].concat(),
            scripts,
            policy: format!(
                "default-src 'none'; style-src 'unsafe-inline'; script-src {hashes}; base-uri 'none'; form-action 'none'"
            ),
        }
    }
}

/// The text that [`escape`] made `html` of.
pub(crate) fn unescape(html: &str) -> String {
    // The ampersand comes last: else `&amp;lt;`, the text `&lt;`, would become a bracket.
    let text = html.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&#39;", "'");
    text.replace("&amp;", "&")
}

/// A whole page: `title` is text, `body` is HTML. It loads nothing and runs only its own scripts.
pub fn page(title: &str, body: &str) -> String {
    whole(title, body, &STILL)
}

/// A whole page with a heading, what it answers (text; empty of a page without an answer), its parts (HTML) and its foot.
pub(crate) fn finished(title: &str, answer: &str, parts: &[String]) -> String {
    page(title, &framed(title, &kept_together(answer), parts))
}

/// Parts (HTML) of a page below its heading and its answer, above its foot.
pub(crate) fn framed(title: &str, answer: &str, parts: &[String]) -> String {
    let answer = if answer.is_empty() { String::new() } else { format!("<p class=\"lead\">{}</p>\n", escape(answer)) };
    let version = env!("CARGO_PKG_VERSION");
    format!("<h1>{}</h1>\n{answer}{}<footer>droptower {version}</footer>\n", escape(title), parts.concat())
}

/// A text in which no line ends between a number and its unit.
pub(crate) fn kept_together(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    for word in text.split_inclusive(' ') {
        let symbol = word.trim_end_matches([' ', ',', '.', ';', ':', ')']);
        let follows_number = kept.ends_with(' ') && kept.trim_end().ends_with(|last: char| last.is_ascii_digit());
        if follows_number && !symbol.is_empty() && Unit::parse(symbol).is_ok() {
            kept.pop();
            kept.push('\u{a0}');
        }
        kept += word;
    }
    kept
}

/// A paragraph (text) in small letters.
pub(crate) fn note(text: &str) -> String {
    format!("<p class=\"note\">{}</p>\n", escape(text))
}

/// Blocks (HTML) beside each other, above a note (text); empty without blocks.
pub(crate) fn blocks(blocks: &str, below: &str) -> String {
    if blocks.is_empty() { String::new() } else { format!("<div class=\"blocks\">\n{blocks}</div>\n{}", note(below)) }
}

/// A figure in large letters.
#[derive(Default)]
pub(crate) struct Card<'a> {
    /// Attributes of its element, each after a space (HTML).
    pub attributes: String,
    /// What it is (HTML), and what is shown on hover (text).
    pub words: String,
    pub title: &'a str,
    /// HTML.
    pub value: &'a str,
    pub unit: &'a str,
    /// What the value belongs to (text).
    pub beside: &'a str,
}

impl Card<'_> {
    pub(crate) fn html(&self) -> String {
        let Card { attributes, words, value, .. } = self;
        let title = if self.title.is_empty() { String::new() } else { format!(" title=\"{}\"", escape(self.title)) };
        let span = |before: &str, class: &str, text: &str| match text {
            "" => String::new(),
            text => format!("{before}<span class=\"{class}\">{}</span>", escape(text)),
        };
        let (unit, beside) = (span(" ", "unit", self.unit), span("", "beside", self.beside));
        format!(
            "<li{attributes}><span class=\"words\"{title}>{words}</span><span class=\"value\">{value}</span>{unit}{beside}</li>\n"
        )
    }
}

/// Cards (HTML) in rows; empty without cards.
pub(crate) fn cards(cards: &str) -> String {
    if cards.is_empty() { String::new() } else { format!("<ul class=\"cards\">\n{cards}</ul>\n") }
}

/// A whole page that renews itself while what it shows goes on.
pub(crate) fn living_page(title: &str, body: &str) -> String {
    whole(title, body, &LIVING)
}

/// A page that leads at once to the one at `address`, which is relative and needs no escape.
pub(crate) fn leading_page(title: &str, address: &str) -> String {
    let (heading, address) = (escape(title), escape(address));
    let refresh = format!("<meta http-equiv=\"refresh\" content=\"0; url={address}\">\n");
    let body =
        format!("<main><h1>{heading}</h1>\n<p><a href=\"{address}\">The study has ended: its report</a></p></main>\n");
    document(title, "default-src 'none'; base-uri 'none'; form-action 'none'", [&refresh, ""], &body)
}

fn whole(title: &str, body: &str, Kit { styles, scripts, policy }: &Kit) -> String {
    let scripts: String = scripts.iter().map(|script| format!("<script>{script}</script>\n")).collect();
    let body = format!(
        "<main>\n\
         <noscript><p class=\"warnings\">Plots and film are drawn by scripts, which are disabled here; all figures are in \
         the tables.</p></noscript>\n\
         {body}</main>\n{scripts}"
    );
    document(title, policy, ["", &format!("<style>\n{styles}</style>\n")], &body)
}

/// A document of HTML with a policy of what it may load, and what its head has above and below its title.
fn document(title: &str, policy: &str, [above, below]: [&str; 2], body: &str) -> String {
    let title = escape(title);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n{above}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n{below}</head>\n<body>\n{body}</body>\n</html>\n"
    )
}

/// Warnings in their frame below `facts`, which are not findings; what a film's data leave open, and notes, are folded.
pub(crate) fn findings<'f>(facts: Vec<String>, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let (open, own): (Vec<&Finding>, Vec<&Finding>) =
        findings.into_iter().partition(|finding| post::left_open(&finding.code).is_some());
    let (warned, noted): (Vec<&Finding>, Vec<&Finding>) = own.into_iter().partition(|finding| finding.is_warning());
    let facts = facts.iter().map(|fact| worded(fact));
    let warnings = match items(facts.chain(grouped(&warned))) {
        empty if empty.is_empty() => empty,
        list => format!("<div class=\"warnings\">\n<h2>Warnings</h2>\n{list}</div>\n"),
    };
    let folded = |title: &str, words: Vec<&str>, findings: &[&Finding]| match items(grouped(findings).into_iter()) {
        empty if empty.is_empty() => empty,
        list => {
            let summary = format!("{title}: {}", escape(&group::unique(words).join(", ")));
            format!("<details class=\"open\">\n<summary>{summary}</summary>\n{list}</details>\n")
        }
    };
    let words = open.iter().filter_map(|finding| post::left_open(&finding.code)).collect();
    let open = folded("What this film's data leave open", words, &open);
    let notes = folded("Notes", noted.iter().map(|finding| finding.code.as_str()).collect(), &noted);
    [warnings, open, notes].concat()
}

/// A line (HTML) for each code: of several findings its meaning and their number, with the findings folded below.
fn grouped(findings: &[&Finding]) -> Vec<String> {
    let groups = group::by_key(findings.iter().map(|finding| (finding.code.as_str(), *finding)));
    groups.into_iter().map(|(code, group)| line_of_group(code, &group)).collect()
}

fn line_of_group(code: &str, group: &[&Finding]) -> String {
    let [first, _, ..] = group else { return group.iter().copied().map(with_code).collect() };
    let meaning = codes::find(code).map_or(first.message.as_str(), |code| code.meaning);
    let own = items(group.iter().map(|finding| worded(&finding.message)));
    format!(
        "<details><summary>{}: {} <code>{}</code></summary>\n{own}</details>",
        concerned(group),
        worded(meaning),
        escape(code)
    )
}

/// How many tests a group of findings concerns, or how often it occurs where they do not say which.
fn concerned(group: &[&Finding]) -> String {
    let tests: Option<BTreeSet<String>> =
        group.iter().map(|finding| finding.figures.get(TEST).map(Value::to_string)).collect();
    match tests.map(|tests| tests.len()) {
        Some(1) => "1 test".into(),
        Some(count) => format!("{count} tests"),
        None => format!("{} times", group.len()),
    }
}

/// The HTML of a finding with its code, which `droptower explain` takes.
fn with_code(finding: &Finding) -> String {
    format!("{} <code>{}</code>", worded(&finding.message), escape(&finding.code))
}

/// A text with its words between backticks set as code.
pub(crate) fn worded(text: &str) -> String {
    let parts: Vec<String> = escape(text).split('`').map(str::to_owned).collect();
    if parts.len().is_multiple_of(2) {
        return parts.join("`");
    }
    let code =
        |(place, part): (usize, &String)| if place % 2 == 1 { format!("<code>{part}</code>") } else { part.clone() };
    parts.iter().enumerate().map(code).collect()
}

/// Data for the page's scripts; no text in it can end the block.
pub(crate) fn data(value: &impl Serialize) -> String {
    // By way of a value, in which numbers of both precisions are written alike.
    let value = serde_json::to_value(value).expect("data are numbers, texts and lists");
    // In JSON, `<` occurs in strings only, where this escape means the same.
    let text = value.to_string().replace('<', "\\u003c").replace(steers, "\u{fffd}");
    format!("<script type=\"application/json\">{text}</script>\n")
}

/// The first block of data of a page or a part of it, as [`data`] writes it.
pub(crate) fn block(html: &str) -> Option<&str> {
    let (_, rest) = html.split_once("<script type=\"application/json\">")?;
    Some(rest.split_once("</script>")?.0)
}

/// A section with a heading (text) around `content` (HTML); empty without content.
pub(crate) fn section(heading: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!("<section>\n<h2>{}</h2>\n{content}</section>\n", escape(heading))
}

/// A table of text, with a header unless that is empty.
pub(crate) fn table<H: AsRef<str>>(header: &[H], rows: &[Vec<String>]) -> String {
    table_of_numbers(usize::MAX, header, rows)
}

/// A table whose first columns, `texts` of them, are text; the others are numbers, which are aligned to the right.
pub(crate) fn table_of_numbers<H: AsRef<str>>(texts: usize, header: &[H], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let cells = |cells: &[String]| cells.iter().map(Cell::text).collect::<Vec<Cell>>();
    let head: Vec<Cell> = header.iter().map(Cell::text).collect();
    let head = if head.is_empty() { String::new() } else { line(&head, HEAD, |at| at >= texts) };
    let rows: String = rows.iter().map(|row| line(&cells(row), "td", |at| at >= texts)).collect();
    scrolled("rows", &[head, rows].concat())
}

/// A square table of shares between -1 and 1, coloured by sign and size, such as correlations; `names` are text.
/// Values that are not finite leave their cell empty.
pub(crate) fn matrix(caption: &str, names: &[String], rows: &[Vec<f64>]) -> String {
    let header: String = names.iter().map(|name| Cell::text(name).element(HEAD, false)).collect();
    let cell = |value: &f64| match value.is_finite() {
        // The colour is a mix with the page's own, so that it suits light and dark.
        true => {
            let sign = if *value < 0.0 { "negative" } else { "positive" };
            let strength = (value.abs().min(1.0) * 100.0).round();
            format!("<td class=\"{sign}\" style=\"--strength:{strength}%\">{value:.2}</td>")
        }
        false => "<td></td>".into(),
    };
    let row = |(name, row): (&String, &Vec<f64>)| {
        let cells: String = row.iter().map(cell).collect();
        format!("<tr>{}{cells}</tr>\n", Cell::text(name).element(HEAD_OF_ROW, false))
    };
    let rows: String = names.iter().zip(rows).map(row).collect();
    let caption = escape(caption);
    scrolled("matrix", &format!("<caption>{caption}</caption>\n<tr><td></td>{header}</tr>\n{rows}"))
}

/// The rows of a table (HTML) of a class of the style, which scrolls where the page is too narrow for it.
pub(crate) fn scrolled(class: &str, rows: &str) -> String {
    format!("<div class=\"scroll\"><table class=\"{class}\">\n{rows}</table></div>\n")
}

/// A list; all items are text.
pub(crate) fn list(lines: &[String]) -> String {
    items(lines.iter().map(|line| escape(line)))
}

/// A list of HTML; empty without items.
fn items(items: impl Iterator<Item = String>) -> String {
    let items: String = items.map(|item| format!("<li>{item}</li>\n")).collect();
    if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") }
}

/// Preformatted text.
pub(crate) fn verbatim(text: &str) -> String {
    // Options do not wrap between their hyphens.
    let option = |word: &str| match word.strip_prefix("--").is_some_and(|name| name.starts_with(char::is_alphabetic)) {
        true => format!("<span class=\"option\">{word}</span>"),
        false => word.to_owned(),
    };
    let words: Vec<String> = escape(text).split(' ').map(option).collect();
    format!("<pre>{}</pre>\n", words.join(" "))
}

/// Most columns of a table that stays upright; a wider one with fewer rows than columns is turned.
const MOST_COLUMNS: usize = 12;

/// A cell, or the head of a column.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cell {
    /// HTML.
    content: String,
    /// By which rows are sorted.
    number: Option<f64>,
    /// Shown on hover.
    title: Option<String>,
}

impl Cell {
    /// A text.
    pub(crate) fn text(text: impl AsRef<str>) -> Cell {
        Cell { content: escape(text.as_ref()), ..Cell::default() }
    }

    /// HTML.
    pub(crate) fn html(content: String) -> Cell {
        Cell { content, ..Cell::default() }
    }

    /// A number as it is written.
    pub(crate) fn number(value: f64, written: impl AsRef<str>) -> Cell {
        Cell { number: Some(value), ..Cell::text(written) }
    }

    /// A value in the unit of its column.
    pub(crate) fn reading(value: Option<f64>, reading: &Reading) -> Cell {
        value.map_or_else(Cell::default, |value| Cell::number(value, reading.digits(value)))
    }

    /// The cell with what is shown on hover, where that is another text.
    pub(crate) fn titled(self, title: &str) -> Cell {
        let title = (escape(title) != self.content).then(|| title.to_owned());
        Cell { title, ..self }
    }

    /// Its element, whose `tag` may have attributes.
    fn element(&self, tag: &str, is_number: bool) -> String {
        let class = if is_number { " class=\"number\"" } else { "" };
        let title = self.title.as_ref().map(|title| format!(" title=\"{}\"", escape(title)));
        // Digits that decide the order: those of the table are too few.
        let number = self.number.filter(|number| number.is_finite()).map(|number| format!(" data-sort=\"{number:e}\""));
        let attributes: String = [title, number].into_iter().flatten().collect();
        let name = tag.split(' ').next().unwrap_or_default();
        format!("<{tag}{class}{attributes}>{}</{name}>", self.content)
    }
}

/// Elements of cells that name a column and a row.
const HEAD: &str = "th scope=\"col\"";
const HEAD_OF_ROW: &str = "th scope=\"row\"";

/// A row of a table.
fn line(cells: &[Cell], tag: &str, is_number: impl Fn(usize) -> bool) -> String {
    let cells: String = cells.iter().enumerate().map(|(at, cell)| cell.element(tag, is_number(at))).collect();
    format!("<tr>{cells}</tr>\n")
}

/// A table whose columns sort its rows; a wide one of few rows is turned, so that its heads stand at the left.
pub(crate) fn sorted_table(head: &[Cell], rows: &[Vec<Cell>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    if head.len() > MOST_COLUMNS && rows.len() < head.len() {
        return turned(head, rows);
    }
    let is_number = |at: usize| {
        let mut cells = rows.iter().filter_map(|row| row.get(at)).filter(|cell| !cell.content.is_empty()).peekable();
        cells.peek().is_some() && cells.all(|cell| cell.number.is_some())
    };
    let numbers: Vec<bool> = (0..head.len()).map(is_number).collect();
    let is_number = |at: usize| numbers.get(at) == Some(&true);
    let body: String = rows.iter().map(|row| line(row, "td", is_number)).collect();
    let head = line(head, HEAD, is_number);
    scrolled("sorted", &format!("<thead>{head}</thead>\n<tbody>\n{body}</tbody>\n"))
}

/// The table with a row a column.
fn turned(head: &[Cell], rows: &[Vec<Cell>]) -> String {
    let line = |(at, head): (usize, &Cell)| {
        let cell = |row: &Vec<Cell>| {
            let cell = row.get(at).cloned().unwrap_or_default();
            cell.element("td", cell.number.is_some())
        };
        let cells: String = rows.iter().map(cell).collect();
        format!("<tr>{}{cells}</tr>\n", head.element(HEAD_OF_ROW, false))
    };
    scrolled("turned", &head.iter().enumerate().map(line).collect::<String>())
}

/// `content` (HTML), folded below a line (text) that opens it; empty without content.
pub(crate) fn folded(line: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!("<details><summary>{}</summary>\n{content}</details>\n", escape(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Severity;

    #[test]
    fn units_stay_with_their_numbers() {
        let kept = kept_together("14.3 g at 57 ms, 20 to 60 % of it (4.1 m/s²); 8 keys of 2 runs. 3");
        assert_eq!(kept, "14.3\u{a0}g at 57\u{a0}ms, 20 to 60\u{a0}% of it (4.1\u{a0}m/s²); 8 keys of 2 runs. 3");
    }

    #[test]
    fn pages_allow_their_own_scripts_and_nothing_else() {
        let html = page("a < b", "<p>body</p>\n");
        assert!(html.contains("<title>a &lt; b</title>") && html.contains("default-src 'none'"));
        assert!(html.contains("<script>const VIRIDIS = [[68,1,84],[71,45,123],"), "the colours stand before the parts");
        let living = living_page("a < b", "");
        for (html, kit) in [(html, &STILL), (living, &LIVING)] {
            assert_eq!(html.matches("'sha256-").count(), kit.scripts.len());
            assert!(kit.scripts.iter().all(|script| !script.contains("</script") && html.contains(script.as_str())));
        }
    }

    #[test]
    fn words_between_backticks_are_code_and_options_do_not_wrap() {
        assert_eq!(worded("set `biaxial` < 1"), "set <code>biaxial</code> &lt; 1");
        assert_eq!(worded("one ` alone"), "one ` alone");
        let line = verbatim("droptower run --set a=1 -- b");
        assert_eq!(line, "<pre>droptower run <span class=\"option\">--set</span> a=1 -- b</pre>\n");
    }

    #[test]
    fn a_finding_is_shown_with_its_code() {
        let finding = Finding::of_script("hard-impact", "the peak is > 500 m/s²");
        let html = findings(vec!["the run <failed>".into()], [&finding]);
        let lines = "<li>the run &lt;failed&gt;</li>\n<li>the peak is &gt; 500 m/s² <code>hard-impact</code></li>";
        assert_eq!(html, format!("<div class=\"warnings\">\n<h2>Warnings</h2>\n<ul>\n{lines}\n</ul>\n</div>\n"));
        assert_eq!(findings(vec![], []), "");
    }

    #[test]
    fn what_a_films_data_leave_open_and_notes_are_folded() {
        let open = ["uncoupled-biaxial", "strain-rate-outside"].map(|code| Finding::of_script(code, "65 %"));
        let note = |code| Finding { severity: Severity::Note, ..Finding::of_script(code, "a fact") };
        // Of two tests.
        let notes = ["settled", "own-note", "settled", "own-note"].map(note);
        let html = findings(vec![], open.iter().chain(&notes));
        assert!(!html.contains("<h2>Warnings</h2>"), "{html}");
        let summary = "<summary>What this film's data leave open: coupling of MD and TD, strain rates</summary>";
        assert!(html.contains(summary) && html.contains("65 % <code>uncoupled-biaxial</code>"), "{html}");
        assert!(html.contains("<summary>Notes: settled, own-note</summary>"), "{html}");
    }

    #[test]
    fn findings_of_one_code_share_a_line_with_the_number_of_their_tests() {
        let finding = |test: &str| {
            let mut finding = Finding::of_script("correlated", &format!("{test}: <k1> and ke"));
            finding.figures.insert(TEST.into(), test.into());
            finding
        };
        let all = [finding("1008"), finding("1009"), finding("1009")];
        let html = findings(vec![], &all);
        let meaning = codes::find("correlated").unwrap().meaning;
        let line = format!("<summary>2 tests: {} <code>correlated</code></summary>", worded(meaning));
        assert!(html.contains(&line) && html.contains("<li>1008: &lt;k1&gt; and ke</li>"), "{html}");
        let own = [(); 2].map(|()| Finding::of_script("own-code", "the <same>"));
        assert!(findings(vec![], &own).contains("<summary>2 times: the &lt;same&gt; <code>own-code</code></summary>"));
    }

    #[test]
    fn no_text_ends_a_block_of_data() {
        let block = data(&serde_json::json!("</script><!-- & -->"));
        assert_eq!(block, "<script type=\"application/json\">\"\\u003c/script>\\u003c!-- & -->\"</script>\n");
    }

    #[test]
    fn numbers_are_aligned_to_the_right_and_text_is_escaped() {
        let rows = [vec!["<a>".to_owned(), "-1.5e-3".into()], vec!["1008".into(), String::new()]];
        let html = table_of_numbers(1, &["name", "value"], &rows);
        assert!(html.contains("<th scope=\"col\">name</th><th scope=\"col\" class=\"number\">value</th>"), "{html}");
        assert!(html.contains("<td>&lt;a&gt;</td><td class=\"number\">-1.5e-3</td>"), "{html}");
        assert!(html.contains("<td>1008</td>"), "a name of digits is a name: {html}");
    }

    #[test]
    fn a_matrix_shows_sign_and_size() {
        let names = ["k1".to_owned(), "<ke>".to_owned()];
        let html = matrix("correlations", &names, &[vec![1.0, -0.25], vec![-0.25, f64::NAN]]);
        assert!(html.contains("<td class=\"negative\" style=\"--strength:25%\">-0.25</td>"), "{html}");
        assert!(html.contains("<th scope=\"col\">&lt;ke&gt;</th>") && html.contains("<td></td></tr>"), "{html}");
    }

    #[test]
    fn rows_are_sorted_by_numbers_and_keys_are_shown_on_hover() {
        let head = [Cell::text("run"), Cell::text("thickness (µm)").titled("specimen.<thickness>")];
        let rows = [vec![Cell::text("<1>"), Cell::number(12e-6, "12")], vec![Cell::text("2"), Cell::default()]];
        let html = sorted_table(&head, &rows);
        let column = "<th scope=\"col\" class=\"number\" title=\"specimen.&lt;thickness&gt;\">thickness (µm)</th>";
        assert!(html.contains(column) && html.contains("<td class=\"number\" data-sort=\"1.2e-5\">12</td>"), "{html}");
        assert!(html.contains("<td>&lt;1&gt;</td>") && html.contains("<td class=\"number\"></td>"), "{html}");
        assert_eq!(sorted_table(&head, &[]), "");
    }

    #[test]
    fn a_wide_table_of_few_rows_is_turned() {
        let head: Vec<Cell> = (0..13).map(|at| Cell::text(format!("c{at}"))).collect();
        let row: Vec<Cell> = (0..13).map(|at| Cell::number(f64::from(at), at.to_string())).collect();
        let (html, last) = (sorted_table(&head, &[row]), "<td class=\"number\" data-sort=\"1.2e1\">12</td></tr>");
        assert!(html.contains(&format!("<tr><th scope=\"row\">c12</th>{last}")), "{html}");
    }
}
