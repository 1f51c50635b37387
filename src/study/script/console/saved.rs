//! The inputs of a session, as a script that runs.

use std::ops::Range;

use rhai::{AST, Position, ScriptFuncDef};

use super::transcript::as_statement;
use crate::script::About;
use crate::script::module::Unit;

/// The inputs without mistakes.
#[derive(Clone, Debug, Default)]
pub(super) struct Saved {
    inputs: Vec<Input>,
    /// The descriptions of loaded files.
    about: About,
}

#[derive(Clone, Debug)]
struct Input {
    text: String,
    functions: Vec<Function>,
}

/// A function and its place in the text of its input.
#[derive(Clone, Debug)]
struct Function {
    name: String,
    values: usize,
    place: Range<usize>,
}

impl Saved {
    /// Adds an input, compiled as `program` below so many lines.
    pub fn push(&mut self, text: &str, program: &AST, lines_before: usize) {
        let own = program.iter_fn_def().filter(|function| !Unit::is_closure(&function.name));
        let functions = own.filter_map(|function| Function::find(function, text, lines_before)).collect();
        self.inputs.push(Input { text: as_statement(text), functions });
    }

    /// Adds what a file that was loaded says of itself; of arguments of the same name, the last.
    pub fn describe(&mut self, about: &About) {
        let About { text, arguments } = &mut self.about;
        if !text.contains(&about.text) {
            *text = format!("{text}\n{}", about.text).trim().into();
        }
        arguments.retain(|one| !about.arguments.iter().any(|newer| newer.name == one.name));
        arguments.extend_from_slice(&about.arguments);
    }

    /// All of it: of functions that were entered anew, the last.
    pub fn script(&self) -> String {
        let inputs = self.inputs.iter().enumerate();
        let inputs = inputs.map(|(place, input)| input.without(|function| self.is_replaced(function, place)));
        std::iter::once(header(&self.about)).chain(inputs).collect()
    }

    fn is_replaced(&self, function: &Function, place: usize) -> bool {
        let mut later = self.inputs[place + 1..].iter().flat_map(|input| &input.functions);
        later.any(|other| (&other.name, other.values) == (&function.name, function.values))
    }
}

/// The lines with which a script says this of itself.
fn header(about: &About) -> String {
    let mut lines: Vec<String> = about.text.lines().map(|line| format!("//! {line}")).collect();
    lines.extend(about.arguments.first().map(|_| "//!".into()));
    lines.extend(about.arguments.iter().map(|one| {
        let default = one.default.as_ref().map(|default| format!("={default}")).unwrap_or_default();
        format!("//! --arg {}{default}  {}", one.name, one.text)
    }));
    lines.extend((!lines.is_empty()).then(String::new));
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

impl Input {
    /// The text without some of its functions; nothing where nothing else is in it.
    fn without(&self, left_out: impl Fn(&Function) -> bool) -> String {
        let mut places: Vec<&Range<usize>> =
            self.functions.iter().filter(|function| left_out(function)).map(|function| &function.place).collect();
        places.sort_by_key(|place| place.start);
        let mut text = self.text.clone();
        for place in places.iter().rev() {
            text.replace_range((*place).clone(), "");
        }
        // What a loaded file says of itself stands at the top.
        let said = text.lines().take_while(|line| line.starts_with("//!")).map(|line| line.len() + 1).sum::<usize>();
        text.replace_range(..said.min(text.len()), "");
        if text.chars().all(|letter| letter.is_whitespace() || letter == ';') {
            return String::new();
        }
        text
    }
}

impl Function {
    /// The interpreter tells where the body is; the name stands before it.
    fn find(function: &ScriptFuncDef, text: &str, lines_before: usize) -> Option<Function> {
        let body = offset(text, function.body.start_position(), lines_before)?;
        let end = offset(text, function.body.end_position(), lines_before)?;
        let end = end + text[end..].find('}')? + 1;
        let is_named = |at: &usize| text[at + 2..].trim_start().starts_with(function.name.as_str());
        let begin = text[..body].rmatch_indices("fn").map(|(at, _)| at).find(is_named)?;
        let before = text[..begin].trim_end();
        let begin = before.strip_suffix("private").map_or(begin, str::len);
        let place = described(text, begin)..end;
        Some(Function { name: function.name.to_string(), values: function.params.len(), place })
    }
}

/// Where the lines `/// …` before `begin` begin.
fn described(text: &str, begin: usize) -> usize {
    let mut begin = begin;
    while let Some(above) = text[..begin].trim_end_matches([' ', '\t']).strip_suffix('\n') {
        let line = above.rfind('\n').map_or(0, |end| end + 1);
        if !above[line..].trim_start().starts_with("///") {
            break;
        }
        begin = line;
    }
    begin
}

/// The byte of `text` at a position below so many lines.
fn offset(text: &str, position: Position, lines_before: usize) -> Option<usize> {
    let line = position.line()?.checked_sub(1 + lines_before)?;
    let begin: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let (place, _) = text[begin..].char_indices().nth(position.position()?.checked_sub(1)?)?;
    Some(begin + place)
}
