//! The description that a script gives of itself in the lines `//! …` it begins with, and the arguments that it
//! declares there:
//!
//! ```text
//! //! Peak acceleration over the number of layers.
//! //!
//! //! --arg most=12    up to how many layers
//! //! --arg element=   kind of element; left out, that of the scenario
//! //! --arg table      the table to read; must be given
//! ```

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use rhai::{Array, Dynamic, Map};
use serde::Serialize;

use base::diagnostic::{Diagnostic, Source, Span, did_you_mean};

/// Begins a line about the script.
const MARK: &str = "//!";

/// Begins the declaration of an argument.
const DECLARES: &str = "--arg ";

/// The description that a script gives of itself.
#[derive(Clone, Debug, Default, Serialize)]
pub struct About {
    /// The purpose of the script.
    pub text: String,
    /// Its arguments in their order; empty where it declares none.
    pub arguments: Vec<Declared>,
}

/// A declared argument.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Declared {
    /// Name, as in `args.<name>`.
    pub name: String,
    /// Value where it is not given; empty where it then has none; `None` where it must be given.
    pub default: Option<String>,
    /// The kind of value that it takes.
    pub kind: Kind,
    /// Its meaning, in words.
    pub text: String,
}

/// The sentence that the script `text` gives of a figure in a line `//! figure NAME  SENTENCE`.
pub fn figure_sentence<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    let line = text.lines().find_map(|line| line.strip_prefix("//! figure ")?.strip_prefix(name)?.strip_prefix("  "));
    line.map(str::trim)
}

/// The kind of value of an argument, as its default shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A number.
    Number,
    /// As many numbers, separated by commas; any number of them where the default ends with `…`.
    Numbers(Option<usize>),
    /// `true` or `false`.
    Flag,
    /// Any text.
    Text,
    /// Anything, where no default shows what it may be.
    Any,
}

impl Kind {
    /// The kind of values like `default`.
    fn from_default(default: &str) -> Kind {
        let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
        if without_ellipsis(default).is_some_and(|before| before.split(',').all(is_number)) {
            return Kind::Numbers(None);
        }
        let numbers: Vec<bool> = default.split(',').map(is_number).collect();
        match (argument_value(default), numbers.len()) {
            _ if default.is_empty() => Kind::Any,
            (value, _) if value.is_int() || value.is_float() => Kind::Number,
            (value, _) if value.is_bool() => Kind::Flag,
            (_, count) if count > 1 && !numbers.contains(&false) => Kind::Numbers(Some(count)),
            _ => Kind::Text,
        }
    }

    fn holds(self, given: &Dynamic) -> bool {
        let text = given.to_string();
        match self {
            Kind::Number => given.is_int() || given.is_float(),
            Kind::Flag => given.is_bool(),
            Kind::Numbers(count) => {
                let numbers: Vec<&str> = text.split(',').collect();
                count.is_none_or(|count| numbers.len() == count)
                    && numbers.iter().all(|number| number.trim().parse::<f64>().is_ok())
            }
            Kind::Text | Kind::Any => true,
        }
    }

    fn expected(self) -> String {
        match self {
            Kind::Number => "a number".into(),
            Kind::Numbers(Some(count)) => format!("{count} numbers separated by commas"),
            Kind::Numbers(None) => "numbers separated by commas".into(),
            Kind::Flag => "true or false".into(),
            Kind::Text => "a string".into(),
            Kind::Any => "a value".into(),
        }
    }
}

/// The value of a text on the command line: a number, a Boolean, or the text.
pub fn argument_value(text: &str) -> Dynamic {
    let integer = text.parse::<i64>().map(Dynamic::from);
    let float = || text.parse::<f64>().map(Dynamic::from);
    let boolean = || text.parse::<bool>().map(Dynamic::from);
    integer.or_else(|_| float()).or_else(|_| boolean()).unwrap_or_else(|_| text.to_owned().into())
}

/// The default of a list of any length, before its `, …`.
fn without_ellipsis(default: &str) -> Option<&str> {
    let before = default.strip_suffix('…').or_else(|| default.strip_suffix("..."))?;
    before.trim_end().strip_suffix(',').map(str::trim_end)
}

/// Numbers between commas as a list.
fn numbers(text: &str) -> Dynamic {
    text.split(',').filter_map(|number| number.trim().parse::<f64>().ok()).map(Dynamic::from).collect::<Array>().into()
}

impl About {
    /// The description in the script `text` from `path`.
    ///
    /// # Errors
    /// Declarations that cannot be read, or that name an argument twice.
    pub fn read(path: &Path, text: &str) -> Result<About, Vec<Diagnostic>> {
        let source = Source::file(path, text.to_owned());
        let mut reader = Reader { source, about: About::default(), mistakes: Vec::new() };
        let mut start = 0;
        for line in text.lines() {
            let Some(said) = line.strip_prefix(MARK) else { break };
            reader.line(said, start + MARK.len()..start + line.len());
            // A line may end with CR LF.
            start = text[start + line.len()..].find('\n').map_or(text.len(), |end| start + line.len() + end + 1);
        }
        reader.about.text = reader.about.text.trim().to_owned();
        if reader.mistakes.is_empty() { Ok(reader.about) } else { Err(reader.mistakes) }
    }

    /// Mistakes in the arguments `given`, where the script declares arguments. `scenario` is no such argument.
    pub fn check(&self, given: &Map) -> Vec<Diagnostic> {
        if self.arguments.is_empty() {
            return Vec::new();
        }
        let own = given.iter().filter(|(name, _)| *name != "scenario");
        let wrong = own.filter_map(|(name, value)| self.wrong(name, value));
        let missing = self.arguments.iter().filter(|one| one.default.is_none() && !given.contains_key(&*one.name));
        let missing = missing.map(|one| {
            Diagnostic::new(format!("--arg {} is missing", one.name)).hint(format!("{}: {}", one.name, one.text))
        });
        wrong.chain(missing).collect()
    }

    /// Whether a comma in the argument `name` stands between numbers or is part of a text.
    pub fn has_commas(&self, name: &str) -> bool {
        let declared = self.arguments.iter().find(|one| one.name == name);
        declared.is_some_and(|one| matches!(one.kind, Kind::Numbers(_) | Kind::Text))
    }

    fn wrong(&self, name: &str, value: &Dynamic) -> Option<Diagnostic> {
        let names = || self.arguments.iter().map(|one| one.name.as_str());
        let Some(declared) = self.arguments.iter().find(|one| one.name == name) else {
            let mistake = Diagnostic::new(format!("the script has no argument `{name}`"));
            let all = || format!("it has {}", names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "));
            return Some(mistake.hint(did_you_mean(name, names()).unwrap_or_else(all)));
        };
        (!declared.kind.holds(value)).then(|| {
            let message = format!("--arg {name}: expected {}, found `{value}`", declared.kind.expected());
            let default = declared.default.as_deref().unwrap_or_default();
            Diagnostic::new(message).hint(format!("write it like --arg \"{name}={default}\""))
        })
    }

    /// The arguments `given`, and the defaults of the others; lists of numbers as lists, texts as texts.
    pub fn complete(&self, given: &Map) -> Map {
        let mut all = given.clone();
        for Declared { name, default, kind, .. } in &self.arguments {
            if let Some(default) = default.as_deref().filter(|default| !default.is_empty()) {
                all.entry(name.as_str().into()).or_insert_with(|| argument_value(default));
            }
            let Some(given) = all.get_mut(name.as_str()) else { continue };
            match kind {
                Kind::Numbers(_) => *given = numbers(&given.to_string()),
                // `7` for a text would be a number.
                Kind::Text => *given = given.to_string().into(),
                Kind::Number | Kind::Flag | Kind::Any => {}
            }
        }
        all
    }
}

struct Reader {
    source: Arc<Source>,
    about: About,
    mistakes: Vec<Diagnostic>,
}

impl Reader {
    fn line(&mut self, said: &str, range: Range<usize>) {
        let said = said.trim_end();
        let Some(declared) = said.trim_start().strip_prefix(DECLARES) else {
            return self.text(said);
        };
        match declaration(declared.trim_start()) {
            Some(declared) if self.about.arguments.iter().any(|other| other.name == declared.name) => {
                self.refuse(range, format!("the argument `{}` is declared twice", declared.name));
            }
            Some(declared) => self.about.arguments.push(declared),
            None => self.refuse(range, "this declares no argument".into()),
        }
    }

    /// Text: of the argument before where it is indented, else of the script.
    fn text(&mut self, said: &str) {
        let words = said.trim();
        match self.about.arguments.last_mut() {
            Some(argument) if said.starts_with("   ") && !words.is_empty() => {
                argument.text = format!("{} {words}", argument.text);
            }
            _ => {
                self.about.text.push_str(said.strip_prefix(' ').unwrap_or(said));
                self.about.text.push('\n');
            }
        }
    }

    fn refuse(&mut self, range: Range<usize>, message: String) {
        let mistake = Diagnostic::new(message).at(&Span::new(&self.source, range));
        self.mistakes
            .push(mistake.hint("write it like `//! --arg starts=5  how many starts`, with two spaces between"));
    }
}

/// Reads `name=default  text` or `name  text`.
fn declaration(said: &str) -> Option<Declared> {
    let (head, text) = match said.find("  ") {
        Some(end) => (&said[..end], said[end..].trim()),
        None => return None,
    };
    let (name, default) = match head.split_once('=') {
        Some((name, default)) => (name, Some(default.trim())),
        None => (head, None),
    };
    let is_name = name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_');
    let kind = default.map_or(Kind::Any, Kind::from_default);
    let default = match kind {
        Kind::Numbers(None) => default.and_then(without_ellipsis),
        _ => default,
    };
    let declared = || Declared { name: name.into(), default: default.map(str::to_owned), kind, text: text.into() };
    (is_name && name != "scenario" && !text.is_empty()).then(declared)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCRIPT: &str = "//! Peak over layers.\n//! In two lines.\r\n//!\n//! --arg most=12  up to how many\n//!         layers\n\
        //! --arg start=1, 2.5  two numbers\n//! --arg name=abc  a name\n//! --arg layers=8, 12, …  of the map\n//! --arg fine=true  whether it is fine\n//! --arg element=  kind\n\
        //! --arg table  what to read\n\nlet a = 1;\n//! not at the beginning\n";

    fn given(values: &[(&str, &str)]) -> Map {
        values.iter().map(|(name, text)| ((*name).into(), argument_value(text))).collect()
    }

    #[test]
    fn text_and_arguments_are_read() {
        let about = About::read(Path::new("s.rhai"), SCRIPT).unwrap();
        assert_eq!(about.text, "Peak over layers.\nIn two lines.");
        let kinds: Vec<Kind> = about.arguments.iter().map(|one| one.kind).collect();
        use Kind::{Any, Flag, Number, Numbers, Text};
        assert_eq!(kinds, [Number, Numbers(Some(2)), Text, Numbers(None), Flag, Any, Any]);
        assert_eq!(about.arguments[0].text, "up to how many layers");
        let all = about.complete(&given(&[("most", "3"), ("name", "12"), ("element", "4")]));
        assert_eq!((all["most"].as_int(), all["fine"].as_bool()), (Ok(3), Ok(true)));
        assert_eq!(all["start"].to_string(), "[1.0, 2.5]");
        assert_eq!(all["layers"].to_string(), "[8.0, 12.0]");
        assert_eq!(about.complete(&given(&[("layers", "20")]))["layers"].to_string(), "[20.0]");
        assert_eq!((all["name"].to_string(), all["name"].is_string()), ("12".into(), true));
        assert!(all["element"].is_int() && !all.contains_key("table"));
        assert!(!about.complete(&Map::new()).contains_key("element"));
        assert!(about.has_commas("start") && about.has_commas("name") && !about.has_commas("most"));
    }

    #[test]
    fn arguments_of_another_name_or_kind_are_refused() {
        let about = About::read(Path::new("s.rhai"), SCRIPT).unwrap();
        let said = |values: &[(&str, &str)]| -> Vec<String> {
            let values = [&[("table", "a")], values].concat();
            about.check(&given(&values)).into_iter().map(|mistake| mistake.message).collect()
        };
        assert!(said(&[("most", "1.5"), ("start", "1,2"), ("fine", "false"), ("scenario", "a.toml")]).is_empty());
        assert_eq!(said(&[("mots", "1")]), ["the script has no argument `mots`"]);
        assert_eq!(said(&[("most", "many")]), ["--arg most: expected a number, found `many`"]);
        assert_eq!(said(&[("start", "1")]), ["--arg start: expected 2 numbers separated by commas, found `1`"]);
        assert!(said(&[("layers", "3")]).is_empty() && said(&[("layers", "3, 4, 5")]).is_empty());
        assert_eq!(said(&[("layers", "3, a")]), ["--arg layers: expected numbers separated by commas, found `3, a`"]);
        assert_eq!(said(&[("fine", "yes")]), ["--arg fine: expected true or false, found `yes`"]);
        assert_eq!(about.check(&Map::new())[0].message, "--arg table is missing");
        assert!(About::default().check(&given(&[("any", "1")])).is_empty(), "a script without declarations takes any");
    }

    #[test]
    fn declarations_that_cannot_be_read_are_told_with_their_place() {
        for line in ["--arg a=1", "--arg A=1  text", "--arg scenario=a  text", "--arg a-b=1  text"] {
            let mistakes = About::read(Path::new("s.rhai"), &format!("//! text\n//! {line}\n")).unwrap_err();
            assert!(mistakes[0].render(false).contains("s.rhai:2:4"), "{}", mistakes[0].render(false));
        }
        let twice = About::read(Path::new("s.rhai"), "//! --arg a=1  one\n//! --arg a=2  two\n").unwrap_err();
        assert_eq!(twice[0].message, "the argument `a` is declared twice");
    }
}
