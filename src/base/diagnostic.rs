//! Mistakes in what a user wrote: where, what, and what to write instead; several at once.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, OnceLock};

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use serde::Serialize;

/// A text of the user: a file, a script, an argument of the command line.
#[derive(Debug)]
pub struct Source {
    /// As a diagnostic shows it: a path relative to the working directory, or e.g. "command line".
    pub name: String,
    /// The text itself.
    pub text: String,
    /// The folder that relative paths in the text start from.
    pub folder: PathBuf,
    /// The line of the file that the text starts with, counted from one.
    pub first_line: usize,
    /// Where each line starts, bytes: a text may have as many mistakes as lines.
    line_starts: OnceLock<Vec<usize>>,
}

impl Source {
    /// The text of the file at `path`.
    pub fn file(path: &Path, text: String) -> Arc<Source> {
        Source::excerpt(path, 1, text)
    }

    /// A part of the file at `path`, too long to be held: the `text` from the line `first_line` on.
    pub fn excerpt(path: &Path, first_line: usize, text: String) -> Arc<Source> {
        Source::new(shown_path(path), text, path.parent().unwrap_or(Path::new("")), first_line)
    }

    /// A text that is not a file; its relative paths start from the working directory.
    pub fn unfiled(name: &str, text: String) -> Arc<Source> {
        Source::new(name.to_owned(), text, Path::new(""), 1)
    }

    fn new(name: String, text: String, folder: &Path, first_line: usize) -> Arc<Source> {
        Arc::new(Source { name, text, folder: folder.to_owned(), first_line, line_starts: OnceLock::new() })
    }

    fn line_starts(&self) -> &[usize] {
        self.line_starts
            .get_or_init(|| std::iter::once(0).chain(self.text.match_indices('\n').map(|(end, _)| end + 1)).collect())
    }

    /// The line of the file that holds the byte `place` of the text, counted from one, and the byte that it starts at.
    fn line_at(&self, place: usize) -> (usize, usize) {
        let starts = self.line_starts();
        let before = starts.partition_point(|start| *start <= place) - 1;
        (self.first_line + before, starts[before])
    }
}

/// A range of a source.
#[derive(Clone)]
pub struct Span {
    /// The text.
    pub source: Arc<Source>,
    /// Bytes of the source's text.
    pub range: Range<usize>,
}

impl Span {
    /// Whether it is the same range of the same text.
    pub fn is(&self, other: &Span) -> bool {
        Arc::ptr_eq(&self.source, &other.source) && self.range == other.range
    }

    /// The bytes `range` of `source`, moved to whole characters within the text.
    pub fn new(source: &Arc<Source>, range: Range<usize>) -> Span {
        let text = &source.text;
        let start = text.floor_char_boundary(range.start);
        let end = text.floor_char_boundary(range.end).max(start);
        Span { source: source.clone(), range: start..end }
    }

    /// The line `number` of the text (counted from one) without its end.
    pub fn line(source: &Arc<Source>, number: usize) -> Span {
        let start = source.line_starts().get(number.saturating_sub(1)).copied().unwrap_or(source.text.len());
        let length = source.text[start..].lines().next().map_or(0, str::len);
        Span::new(source, start..start + length)
    }

    /// The place `line` of the text, `column` (in characters), both counted from one.
    pub fn position(source: &Arc<Source>, line: usize, column: usize) -> Span {
        let whole = Span::line(source, line);
        let offset: usize =
            source.text[whole.range.clone()].chars().take(column.saturating_sub(1)).map(char::len_utf8).sum();
        let start = whole.range.start + offset;
        let next = source.text[start..].chars().next();
        let width = next.filter(|c| *c != '\n').map_or(0, char::len_utf8);
        Span::new(source, start..start + width)
    }

    /// Line of the file and column (in characters) of its start, both counted from one.
    pub fn start(&self) -> (usize, usize) {
        let (line, start) = self.source.line_at(self.range.start);
        (line, self.source.text[start..self.range.start].chars().count() + 1)
    }

    /// Line of the file that it starts on, counted from one.
    pub fn line_number(&self) -> usize {
        self.source.line_at(self.range.start).0
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.start();
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

/// One mistake in the user's input.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Lower case, no full stop.
    pub message: String,
    /// Where it is, if it is at a place in a text.
    pub span: Option<Span>,
    /// The text to write instead, or why it is a mistake.
    pub hint: Option<String>,
    /// Other places that have to do with it, such as the key that this one is in conflict with.
    pub labels: Vec<Label>,
}

/// A place beside that of a mistake, and what is there.
#[derive(Clone, Debug)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// Lower case, no full stop.
    pub text: String,
}

impl Diagnostic {
    /// A mistake that is not at a place in a text.
    pub fn new(message: impl Into<String>) -> Diagnostic {
        Diagnostic { message: message.into(), span: None, hint: None, labels: vec![] }
    }

    /// A copy of the mistake that is shown at `span`.
    pub fn at(self, span: &Span) -> Diagnostic {
        Diagnostic { span: Some(span.clone()), ..self }
    }

    /// The mistake with a hint.
    pub fn hint(self, hint: impl Into<String>) -> Diagnostic {
        Diagnostic { hint: Some(hint.into()), ..self }
    }

    /// Message and hint in one line, without its place.
    pub fn in_line(&self) -> String {
        self.hint.as_ref().map_or_else(|| self.message.clone(), |hint| format!("{} ({hint})", self.message))
    }

    /// The mistake with a hint, where there is one.
    pub fn hint_if(self, hint: Option<String>) -> Diagnostic {
        Diagnostic { hint: hint.or(self.hint), ..self }
    }

    /// The mistake with a further label at `span`.
    pub fn label(mut self, span: &Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span: span.clone(), text: text.into() });
        self
    }

    /// The mistake as a report with the lines that it is on; `styled` adds colours for a terminal.
    pub fn render(&self, styled: bool) -> String {
        let renderer = if styled { Renderer::styled() } else { Renderer::plain() };
        let message = printable(&self.message);
        let hint = self.hint.as_deref().map(printable);
        let title = Level::ERROR.primary_title(message.as_ref());
        let Some(span) = &self.span else {
            let help = hint.iter().map(|hint| Level::HELP.message(hint.as_ref()));
            return renderer.render(&[title.elements(help)]);
        };
        let (beside, others): (Vec<&Label>, Vec<&Label>) =
            self.labels.iter().partition(|label| Arc::ptr_eq(&label.span.source, &span.source));
        let own = Excerpt::new(&span.source, std::iter::once(span).chain(beside.iter().map(|label| &label.span)));
        let others: Vec<(Excerpt<'_>, &Label)> =
            others.into_iter().map(|label| (Excerpt::new(&label.span.source, [&label.span]), label)).collect();
        let mark = AnnotationKind::Primary.span(own.range(span)).label(hint.as_deref());
        let beside = beside.into_iter().map(|label| own.context(label));
        let own = own.snippet().annotation(mark).annotations(beside);
        let others = others.iter().map(|(excerpt, label)| excerpt.snippet().annotation(excerpt.context(label)));
        renderer.render(&[title.element(own).elements(others)])
    }
}

/// The diagnostics of a text that is checked, as many as are found.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// Adds a mistake at `span`.
    pub fn report(&mut self, span: &Span, message: impl Into<String>) {
        self.0.push(Diagnostic::new(message).at(span));
    }

    /// Adds a mistake at `span`, and what to write instead.
    pub fn report_with(&mut self, span: &Span, message: impl Into<String>, hint: impl Into<String>) {
        self.0.push(Diagnostic::new(message).at(span).hint(hint));
    }
}

/// A mistake for a program that reads it.
#[derive(Debug, Serialize)]
pub struct Record<'a> {
    message: &'a str,
    hint: Option<&'a str>,
    #[serde(flatten)]
    place: Option<Place<'a>>,
    labels: Vec<RecordLabel<'a>>,
}

/// Another place of a mistake for a program that reads it.
#[derive(Debug, Serialize)]
struct RecordLabel<'a> {
    message: &'a str,
    #[serde(flatten)]
    place: Place<'a>,
}

/// Where a mistake is: file or argument, line and column, both from one.
#[derive(Debug, Serialize)]
struct Place<'a> {
    source: &'a str,
    line: usize,
    column: usize,
}

impl Span {
    fn place(&self) -> Place<'_> {
        let (line, column) = self.start();
        Place { source: &self.source.name, line, column }
    }
}

impl Label {
    fn record(&self) -> RecordLabel<'_> {
        RecordLabel { message: &self.text, place: self.span.place() }
    }
}

impl Diagnostic {
    /// The mistake for a program that reads it.
    pub fn record(&self) -> Record<'_> {
        Record {
            message: &self.message,
            hint: self.hint.as_deref(),
            place: self.span.as_ref().map(Span::place),
            labels: self.labels.iter().map(Label::record).collect(),
        }
    }
}

/// The lines of a source that some spans are on. Whole files would be searched for their lines at every report.
struct Excerpt<'a> {
    source: &'a Source,
    /// Where it begins in the text of the source, bytes.
    start: usize,
    /// The lines as a terminal may show them.
    text: Cow<'a, str>,
}

impl<'a> Excerpt<'a> {
    fn new<'s>(source: &'a Source, spans: impl IntoIterator<Item = &'s Span>) -> Excerpt<'a> {
        let text = &source.text;
        let whole =
            spans.into_iter().map(|span| span.range.clone()).reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
        let whole = whole.unwrap_or(0..0);
        // Behind the last line there is nothing to show.
        let is_behind = whole.start == text.len() && text.ends_with('\n');
        let first = if is_behind { whole.start - 1 } else { whole.start };
        let start = text[..first].rfind('\n').map_or(0, |at| at + 1);
        let end = text[whole.end..].find('\n').map_or(text.len(), |at| whole.end + at + 1);
        Excerpt { source, start, text: printable(&text[start..end]) }
    }

    /// Bytes of the excerpt that are those of `span`: what replaces a character may be longer.
    fn range(&self, span: &Span) -> Range<usize> {
        let last = self.text.strip_suffix('\n').unwrap_or(&self.text).len();
        let place = |at: usize| printable(&self.source.text[self.start..at]).len().min(last);
        place(span.range.start)..place(span.range.end)
    }

    fn context<'l>(&self, label: &'l Label) -> annotate_snippets::Annotation<'l> {
        AnnotationKind::Context.span(self.range(&label.span)).label(printable(&label.text))
    }

    fn snippet<'s>(&'s self) -> Snippet<'s, annotate_snippets::Annotation<'s>> {
        let (line, _) = self.source.line_at(self.start);
        Snippet::source(self.text.as_ref()).line_start(line).path(printable(&self.source.name))
    }
}

/// Whether a letter steers a terminal or turns the direction of the text about it.
pub fn steers(letter: char) -> bool {
    let turns =
        matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (letter.is_control() && letter != '\n' && letter != '\t')
}

/// The text without characters that steer what shows it: names and notes of files are not trusted.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.contains(steers) { text.replace(steers, "\u{fffd}").into() } else { text.into() }
}

/// JSON in which characters that steer what shows it are escaped; it means the same.
pub fn printable_json(json: &str) -> Cow<'_, str> {
    if !json.contains(steers) {
        return json.into();
    }
    // Beyond those that JSON itself escapes, they occur in strings only, and all are below U+FFFF.
    let escaped = json.chars().map(|letter| match steers(letter) {
        true => format!("\\u{:04x}", u32::from(letter)),
        false => letter.into(),
    });
    escaped.collect::<String>().into()
}

/// Reports that are shown at once: mistakes beyond them are mostly consequences, or the same one again.
const SHOWN: usize = 10;

/// The first mistakes, one report after the other, and how many there are besides.
pub fn render(mistakes: &[Diagnostic], styled: bool) -> String {
    let mut reports: Vec<String> = mistakes.iter().take(SHOWN).map(|mistake| mistake.render(styled)).collect();
    match mistakes.len().saturating_sub(SHOWN) {
        0 => {}
        1 => reports.push("and 1 more mistake".to_owned()),
        more => reports.push(format!("and {more} more mistakes")),
    }
    reports.join("\n\n")
}

/// The name among `known` that `written` was probably meant to be: a few edits from it, or one that shares a word with
/// it. None where two are equally near.
pub fn closest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let (mut best, mut name) = (0.0, None);
    for candidate in known {
        let likeness = likeness(&written.to_lowercase(), &candidate.to_lowercase());
        if likeness > best {
            (best, name) = (likeness, Some(candidate));
        } else if likeness == best && name != Some(candidate) {
            name = None;
        }
    }
    name
}

/// How like `name` the misspelt `written` is, up to 1; zero where it hardly stands for it.
fn likeness(written: &str, name: &str) -> f64 {
    // `impactor2` is a second impactor.
    let is_numbered = |rest: &str| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit());
    if !name.ends_with(|c: char| c.is_ascii_digit()) && written.strip_prefix(name).is_some_and(is_numbered) {
        return 0.0;
    }
    let length = written.chars().count().max(name.chars().count());
    let edits = strsim::osa_distance(written, name);
    if edits <= (length / 4).max(1) && edits < length {
        return 1.0 - edits as f64 / length as f64;
    }
    let words = |text: &str| text.split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect::<Vec<String>>();
    let begins = words(name).iter().any(|word| word.starts_with(written));
    let ends = words(written).iter().any(|word| word == name);
    let starts = name.starts_with(written);
    let is_part = (starts && written.len() > 2) || (begins && written.len() > 3) || (ends && name.len() > 3);
    if is_part { 0.7 } else { 0.0 }
}

/// The question after a word that is not `known`, with the closest one in backticks; none without a close one.
pub fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    closest(written, known).map(|close| format!("did you mean `{close}`?"))
}

/// Names in a sentence: "`a`, `b`".
pub fn listed(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    names.into_iter().map(|name| format!("`{}`", name.as_ref())).collect::<Vec<_>>().join(", ")
}

/// The folder that the file at `path` is in; `.` where the path does not name one.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The name of the file at `path`, without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// `path` without `..` detours, relative to the working directory where it lies below it.
pub fn shown_path(path: &Path) -> String {
    let tidy = tidy_path(path);
    let relative = std::env::current_dir().ok().and_then(|here| tidy.strip_prefix(here).ok().map(Path::to_owned));
    let shown = relative.unwrap_or(tidy).display().to_string();
    if shown.is_empty() { ".".to_owned() } else { shown }
}

/// `path` without `.` and, where a folder stands before it, without `..`.
pub fn tidy_path(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if ends_in_folder(&tidy) => {
                tidy.pop();
            }
            part => tidy.push(part),
        }
    }
    tidy
}

fn ends_in_folder(path: &Path) -> bool {
    matches!(path.components().next_back(), Some(Component::Normal(_)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_like_the_tour() {
        let text = "density = 915\n[x]\nthicknes = \"12 um\"\n".to_owned();
        let source = Source::unfiled("scenarios/materials/lldpe.toml", text);
        let mistake =
            Diagnostic::new("unknown key `thicknes`").at(&Span::new(&source, 18..26)).hint("did you mean `thickness`?");
        let expected = "\
error: unknown key `thicknes`
 --> scenarios/materials/lldpe.toml:3:1
  |
3 | thicknes = \"12 um\"
  | ^^^^^^^^ did you mean `thickness`?";
        assert_eq!(mistake.render(false), expected);
    }

    #[test]
    fn points_at_other_places_too() {
        let source = Source::unfiled("a.toml", "velocity = 1\ngravity = 0\ndrop_height = 2\n".to_owned());
        let other = Source::unfiled("b.toml", "count = 8\n".to_owned());
        let mistake = Diagnostic::new("`velocity` and `drop_height` exclude each other")
            .at(&Span::new(&source, 25..36))
            .hint("keep one")
            .label(&Span::new(&source, 0..8), "`velocity` is given here")
            .label(&Span::new(&other, 0..5), "there `count` is 8");
        let expected = "\
error: `velocity` and `drop_height` exclude each other
 --> a.toml:3:1
  |
1 | velocity = 1
  | -------- `velocity` is given here
2 | gravity = 0
3 | drop_height = 2
  | ^^^^^^^^^^^ keep one
  |
 ::: b.toml:1:1
  |
1 | count = 8
  | ----- there `count` is 8";
        assert_eq!(mistake.render(false), expected);
    }

    #[test]
    fn nothing_steers_the_terminal() {
        assert_eq!(printable("a\tb\nc \u{b0}"), "a\tb\nc \u{b0}");
        assert_eq!(printable("\u{1b}[31mred\r\u{9b}2J"), "\u{fffd}[31mred\u{fffd}\u{fffd}2J");
        assert_eq!(printable("a\u{202e}b\u{2066}c"), "a\u{fffd}b\u{fffd}c");
        let source = Source::unfiled("\u{1b}[2J", "\u{1b}[31m,\u{9b}x\n".to_owned());
        let mistake = Diagnostic::new("no `\u{1b}[1m`").hint("\u{7}");
        for shown in [mistake.clone().at(&Span::position(&source, 1, 7)), mistake] {
            assert!(!shown.render(false).contains(|c: char| c.is_control() && c != '\n'), "{shown:?}");
        }
    }

    #[test]
    fn json_keeps_what_it_means() {
        let text = "a\u{9b}b\u{202e}c\u{1b}\u{2066}\u{e9}";
        let json = printable_json(&serde_json::to_string(text).unwrap()).into_owned();
        assert!(!json.contains(steers) && json.contains('\u{e9}'), "{json}");
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }

    #[test]
    fn marks_stand_below_what_they_mark() {
        let source = Source::unfiled("a", "first\n\u{9b}\u{202e}key = 1\nlast\n".to_owned());
        let start = source.text.find("key").unwrap();
        let shown = Diagnostic::new("no").at(&Span::new(&source, start..start + 3)).render(false);
        assert_eq!(shown, "error: no\n --> a:2:3\n  |\n2 | \u{fffd}\u{fffd}key = 1\n  |   ^^^");
    }

    #[test]
    fn what_is_missing_at_the_end_is_shown_at_the_last_line() {
        let source = Source::unfiled("a", "first\n(1 + 2\n".to_owned());
        let shown = Diagnostic::new("no").at(&Span::new(&source, 13..13)).render(false);
        assert_eq!(shown, "error: no\n --> a:2:7\n  |\n2 | (1 + 2\n  |       ^");
    }

    #[test]
    fn ten_mistakes_are_shown_and_the_others_counted() {
        let mistakes = |count: usize| vec![Diagnostic::new("no"); count];
        assert_eq!(render(&mistakes(10), false).matches("error: no").count(), 10);
        let shown = render(&mistakes(12), false);
        assert_eq!(shown.matches("error: no").count(), 10);
        assert!(shown.ends_with("\n\nand 2 more mistakes"), "{shown}");
    }

    #[test]
    fn names_are_proposed_where_they_are_meant() {
        let known =
            ["velocity", "drop_height", "gravity", "duration", "half-x", "half-y", "impactor", "quad4", "k1", "ke"];
        for (written, expected) in [
            ("direction", None),
            ("impactor2", None),
            ("half", None),
            ("k2", None),
            ("x", None),
            ("colour", None),
            ("quad8", Some("quad4")),
            ("Velocty", Some("velocity")),
            ("height", Some("drop_height")),
            ("vel", Some("velocity")),
            ("impact_velocity", Some("velocity")),
            ("durration", Some("duration")),
            ("duratoin", Some("duration")),
        ] {
            assert_eq!(closest(written, known), expected, "{written}");
        }
    }

    #[test]
    fn positions_are_in_characters() {
        let source = Source::unfiled("x", "a\nβγδ\n".to_owned());
        let span = Span::position(&source, 2, 3);
        assert_eq!(span.start(), (2, 3));
        assert_eq!(&source.text[span.range.clone()], "δ");
    }

    #[test]
    fn paths_lose_their_detours() {
        let tidy = |text: &str| tidy_path(Path::new(text)).display().to_string();
        assert_eq!(tidy("a/b/../c/./d"), "a/c/d");
        assert_eq!(tidy("../a/../../b"), "../../b");
    }
}
