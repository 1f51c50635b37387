//! Completion of what is typed: functions, variables, keys of maps and figures, files.

use std::collections::BTreeSet;

use rhai::{Dynamic, Engine, Map};
use rustyline::completion::{Completer, FilenameCompleter, Pair};
use rustyline::highlight::Highlighter;
use rustyline::hint::Hinter;
use rustyline::validate::{ValidationContext, ValidationResult, Validator};
use rustyline::{Context, Helper};

use super::super::functions;
use super::input;
use study::post::Run;
use study::script::{Console, Session};

/// Words of the language.
const WORDS: [&str; 13] =
    ["let", "const", "fn", "if", "else", "for", "in", "while", "loop", "return", "true", "false", "import"];

/// The words that can be typed at present.
#[derive(Default)]
pub(super) struct Words {
    /// Functions, variables and words of the language.
    free: BTreeSet<String>,
    /// Words that may follow a dot whose receiver is not known.
    members: BTreeSet<String>,
    /// Words that may follow a known receiver and its dot, such as `run.summary.`.
    known: Vec<(String, BTreeSet<String>)>,
    /// Commands.
    commands: Vec<String>,
}

impl Words {
    /// The words of an engine and of the input so far.
    pub fn from_engine(engine: &Engine, console: &Console, commands: &[&str]) -> Words {
        let calls: Vec<&str> = functions::calls().collect();
        let mut words =
            Words { commands: commands.iter().map(|name| format!(":{name}")).collect(), ..Words::default() };
        words.free.extend(WORDS.map(str::to_owned));
        words.free.extend(console.functions());
        for call in &calls {
            words.read(call);
        }
        for fields in Session::of_engine(engine).fields() {
            words.known.push((fields.map.into(), fields.names.iter().map(|name| name.to_string()).collect()));
        }
        for (name, value) in console.variables() {
            words.add(&name, &value, 3);
            words.free.insert(name);
        }
        words
    }

    /// Reads a call of the reference, such as `signal.at(t)` or `run.time, run.velocity`.
    fn read(&mut self, call: &str) {
        let is_letter = |c: char| c.is_alphanumeric() || c == '_';
        for word in call.split(|c: char| !(is_letter(c) || c == '.' || c == ':')) {
            match word.split_once('.') {
                Some((_, member)) => {
                    self.members.extend(member.split('.').filter(|part| !part.is_empty()).map(str::to_owned))
                }
                None if call.contains(&format!("{word}(")) && !word.is_empty() => {
                    self.free.insert(word.to_owned());
                }
                None => {}
            }
        }
    }

    fn add(&mut self, path: &str, value: &Dynamic, depth: usize) {
        let Some(depth) = depth.checked_sub(1) else { return };
        if let Some(map) = value.read_lock::<Map>() {
            self.known.push((path.to_owned(), map.keys().map(|key| key.to_string()).collect()));
            for (key, value) in map.iter() {
                self.add(&format!("{path}.{key}"), value, depth);
            }
        }
        if let Some(run) = value.read_lock::<Run>() {
            self.known.push((format!("{path}.summary"), run.summary().keys().cloned().collect()));
            let members =
                functions::calls().flat_map(|call| call.split(", ")).filter_map(|call| call.strip_prefix("run."));
            let names = members.filter_map(|member| member.split(|c: char| !(c.is_alphanumeric() || c == '_')).next());
            self.known.push((path.to_owned(), names.filter(|name| !name.is_empty()).map(str::to_owned).collect()));
        }
    }

    /// Candidates for the end of `text`, and where that end begins.
    pub fn candidates(&self, text: &str) -> (usize, Vec<String>) {
        if text.starts_with(':') && !text.contains(' ') {
            return (0, self.commands.iter().filter(|name| name.starts_with(text)).cloned().collect());
        }
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        let begin =
            text.rfind(|c: char| !is_word(c)).map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8));
        let begun = &text[begin..];
        let all = match text[..begin].strip_suffix('.') {
            Some(before) => self.after_dot(before),
            None => &self.free,
        };
        (begin, all.iter().filter(|word| word.starts_with(begun)).cloned().collect())
    }

    fn after_dot(&self, before: &str) -> &BTreeSet<String> {
        let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let receiver = before.rsplit(|c| !is_path(c)).next().unwrap_or_default();
        let known = self.known.iter().rev().find(|(path, _)| *path == receiver);
        // `run.simulate().summary.`: any receiver that ends in the name of a map with known fields.
        let last = receiver.rsplit('.').next().unwrap_or_default();
        let known = known.or_else(|| self.known.iter().find(|(path, _)| *path == last && receiver != last));
        known.map_or(&self.members, |(_, members)| members)
    }
}

/// Completes lines, and asks for more of them while a bracket is open.
pub(super) struct Assistant {
    pub words: Words,
    pub files: FilenameCompleter,
}

impl Completer for Assistant {
    type Candidate = Pair;

    fn complete(&self, line: &str, place: usize, context: &Context<'_>) -> rustyline::Result<(usize, Vec<Pair>)> {
        let text = &line[..place];
        if text.matches('"').count() % 2 == 1 || text.starts_with(":load ") || text.starts_with(":save ") {
            return self.files.complete(line, place, context);
        }
        let (begin, words) = self.words.candidates(text);
        let pair = |word: String| Pair { display: word.clone(), replacement: word };
        Ok((begin, words.into_iter().map(pair).collect()))
    }
}

impl Validator for Assistant {
    fn validate(&self, context: &mut ValidationContext<'_>) -> rustyline::Result<ValidationResult> {
        let open = !context.input().starts_with(':') && input::is_open(context.input());
        Ok(if open { ValidationResult::Incomplete } else { ValidationResult::Valid(None) })
    }
}

impl Hinter for Assistant {
    type Hint = String;
}

impl Highlighter for Assistant {}

impl Helper for Assistant {}

#[cfg(test)]
mod tests {
    use rhai::Scope;

    use super::*;
    use study::script::{Fields, Limits};

    #[test]
    fn functions_variables_keys_and_figures_are_completed() {
        let engine = study::functions::engine(Limits::STUDY);
        Session::of_engine(&engine).declare(Fields { map: "summary", names: &["peak_force_N", "elements"] });
        let mut console = Console::new(Scope::new());
        let _ = console.run(&engine, "let tower = #{ radius: 0.1, films: #{ md: 1 } }; fn twice(x) { 2 * x }").unwrap();
        let words = Words::from_engine(&engine, &console, &["help", "quit"]);
        for (text, expected) in [
            ("twi", "twice"),
            ("let a = tow", "tower"),
            ("tower.ra", "radius"),
            ("tower.films.", "md"),
            ("\"20 °\" + 1°tower.ra", "radius"),
            ("run.summary.peak", "peak_force_N"),
            ("[1].first().summary.el", "elements"),
            ("run.acceleration.time_of_m", "time_of_max"),
            ("1 + minimi", "minimize"),
            (":he", ":help"),
            ("tables::mark", "tables::markdown_row"),
        ] {
            let (begin, found) = words.candidates(text);
            assert!(found.iter().any(|word| word == expected), "{text}: {found:?}");
            assert!(expected.starts_with(&text[begin..]), "{text} {begin}");
        }
        assert!(words.candidates("tower.nosuch").1.is_empty());
    }
}
