//! `droptower explain findings`: what the codes of findings mean and what to do.

use super::{Failure, Shared, checkpoint, print, print_json};
use base::diagnostic::closest;
use base::finding::Code;

/// The word in place of a key that lists all codes.
pub(super) const WORD: &str = "findings";

/// All codes, module by module.
fn all() -> impl Iterator<Item = &'static Code> {
    let of_cards = [::card::CODES, ::card::read::CODES, ::card::deck::CODES];
    study::codes::all().chain(of_cards.into_iter().flatten().chain(checkpoint::CODES).copied())
}

/// The code `name`, which may be written as the terminal prints it: `warning[coarse-contact]`.
pub(super) fn find(name: &str) -> Option<&'static Code> {
    let name = bare(name);
    all().find(|code| code.name == name)
}

/// The code whose name is like `name`, as a hint.
pub(super) fn hint(name: &str) -> Option<String> {
    let meant = misspelt(bare(name)).or_else(|| closest(bare(name), all().map(|code| code.name)));
    meant.map(|name| format!("did you mean the finding `{name}`?"))
}

/// The code that differs from `name` by at most two letters.
pub(super) fn misspelt(name: &str) -> Option<&'static str> {
    all().map(|code| code.name).find(|known| strsim::damerau_levenshtein(known, name) <= 2)
}

/// `coarse-contact` of `warning[coarse-contact]:`, of `[coarse-contact]` and of itself.
fn bare(text: &str) -> &str {
    let enclosed = text.trim_end_matches(':').strip_suffix(']').and_then(|text| text.split_once('['));
    match enclosed {
        Some(("" | "warning" | "note", name)) => name,
        _ => text,
    }
}

/// Prints the meaning of `code`, or of all codes.
pub(super) fn run(code: Option<&'static Code>, shared: &Shared) -> Result<(), Failure> {
    let codes: Vec<&Code> = code.map_or_else(|| all().collect(), |code| vec![code]);
    if shared.json {
        return print_json(&codes);
    }
    print(&codes.into_iter().map(text).collect::<Vec<_>>().join("\n\n"))
}

fn text(code: &Code) -> String {
    format!("{} ({})\n    {}\n    what to do: {}", code.name, code.severity, code.meaning, code.remedy)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use base::finding::is_code;

    #[test]
    fn a_code_is_found_as_the_terminal_prints_it() {
        for written in ["coarse-contact", "[coarse-contact]", "warning[coarse-contact]", "warning[coarse-contact]:"] {
            assert_eq!(find(written).map(|code| code.name), Some("coarse-contact"), "{written}");
        }
        assert_eq!(hint("warning[corse-contact]").as_deref(), Some("did you mean the finding `coarse-contact`?"));
        assert_eq!(find("frame[coarse-contact]"), None);
    }

    #[test]
    fn codes_are_unique_well_formed_and_explained() {
        let mut seen = HashSet::new();
        for code in all() {
            assert!(is_code(code.name), "{}", code.name);
            assert!(seen.insert(code.name), "{} has two meanings", code.name);
            for text in [code.meaning, code.remedy] {
                assert!(text.starts_with(char::is_lowercase) || text.starts_with('`'), "{}: {text}", code.name);
                assert!(!text.ends_with('.') && !text.contains("  "), "{}: {text}", code.name);
            }
        }
        assert!(!seen.is_empty());
    }
}
