//! `droptower explain functions`: what scripts can call.

use std::process::ExitCode;

use serde::Serialize;

use super::{Shared, print, print_json};
use crate::identify;
use crate::post;
use crate::script::{self, Chapter};

/// The word in place of a key.
pub const WORD: &str = "functions";

/// One line of the reference.
#[derive(Serialize)]
struct Function {
    chapter: &'static str,
    call: &'static str,
    gives: &'static str,
    example: &'static str,
}

/// Prints the reference of scripts.
pub fn run(shared: &Shared) -> ExitCode {
    let chapters = post::REFERENCE.iter().chain(identify::REFERENCE).chain(script::REFERENCE);
    if !shared.json {
        return print(chapters.map(text).collect::<String>().trim_end());
    }
    let functions = chapters.flat_map(|chapter| {
        let function = |entry: &script::Entry| {
            let script::Entry { call, gives, example } = *entry;
            Function { chapter: chapter.title, call, gives, example }
        };
        chapter.entries.iter().map(function)
    });
    print_json(&functions.collect::<Vec<_>>())
}

fn text(chapter: &Chapter) -> String {
    let entry =
        |entry: &script::Entry| format!("  {}\n      {}\n      e.g. {}\n", entry.call, entry.gives, entry.example);
    format!("{}\n{}\n", chapter.title, chapter.entries.iter().map(entry).collect::<String>())
}
