//! `droptower explain functions`: the functions of scripts.

use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use study::reference::chapters;
use study::script::{Chapter, Entry};

/// The word that stands in place of a key.
pub(super) const WORD: &str = "functions";

/// One entry of the reference.
#[derive(Serialize)]
struct Function {
    chapter: &'static str,
    call: &'static str,
    gives: &'static str,
    example: &'static str,
}

/// Prints the reference of scripts: all of it, or the entries of the function `name`.
pub(super) fn run(name: Option<&str>, shared: &Shared) -> Result<(), Failure> {
    let chapters = chapters().map(|chapter| (chapter.title, entries(chapter, name))).filter(|(_, e)| !e.is_empty());
    if !shared.json {
        return print(chapters.map(text).collect::<String>().trim_end());
    }
    let functions = chapters.flat_map(|(chapter, entries)| {
        let function = move |entry: &Entry| {
            let Entry { call, gives, example } = *entry;
            Function { chapter, call, gives, example }
        };
        entries.into_iter().map(function)
    });
    print_json(&functions.collect::<Vec<_>>())
}

/// Whether scripts can call a function of this name.
pub(super) fn are_called(name: &str) -> bool {
    chapters().any(|chapter| !entries(chapter, Some(name)).is_empty())
}

/// The entries of a chapter in which `name` is called; all of them where there is no name.
fn entries(chapter: &'static Chapter, name: Option<&str>) -> Vec<&'static Entry> {
    let calls = |call: &str, name: &str| {
        let opened = format!("{name}(");
        let begins = |at: usize| !call[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        call.match_indices(&opened).any(|(at, _)| begins(at))
    };
    chapter.entries.iter().filter(|entry| name.is_none_or(|name| calls(entry.call, name))).collect()
}

fn text((title, entries): (&str, Vec<&Entry>)) -> String {
    let entry = |entry: &Entry| format!("  {}\n      {}\n      e.g. {}\n", entry.call, entry.gives, entry.example);
    format!("{title}\n{}\n", entries.into_iter().map(entry).collect::<String>())
}
