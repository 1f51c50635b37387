//! Scripts that are part of the program and run by their names: `droptower script failure-mass`.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::{Failure, Shared, print_figures, table};
use base::diagnostic::{Diagnostic, closest, shown_path};
use base::file;
use study::script::{About, LONGEST_SCRIPT};

macro_rules! shipped {
    ($($name:literal),*) => {
        [$(($name, include_str!(concat!("../../../scripts/", $name, ".rhai")))),*]
    };
}

/// Names and texts. They need a scenario of the user's and no other file.
const SHIPPED: [(&str, &str); 6] =
    shipped!["dart-break-strain", "dart-data-sheet", "failure-mass", "identify", "identify-field", "layers"];

/// A script that a user names.
pub(super) struct Named {
    /// Where it is, or where a shipped one would be.
    pub(super) path: PathBuf,
    /// The text of a shipped script.
    pub(super) text: Option<Cow<'static, str>>,
}

/// The file that is named, with or without its ending, or else the shipped script of this name.
pub(super) fn named(given: &Path) -> Result<Named, Diagnostic> {
    let with_ending = given.with_extension("rhai");
    let files = [given, &with_ending];
    if let Some(path) = files.into_iter().find(|path| path.is_file()) {
        return Ok(Named { path: path.to_owned(), text: None });
    }
    if given.exists() || given.parent() != Some(Path::new("")) {
        return Ok(Named { path: given.to_owned(), text: None });
    }
    let name = given.file_stem().unwrap_or_default().to_string_lossy();
    if let Some((_, text)) = SHIPPED.iter().find(|(own, _)| *own == name) {
        return Ok(Named { path: with_ending, text: Some(Cow::Borrowed(text)) });
    }
    let mistake =
        Diagnostic::new(format!("there is no script {}, neither a file nor a shipped one", shown_path(given)));
    let nearest = closest(&name, SHIPPED.iter().map(|(own, _)| *own)).map(|own| format!("did you mean `{own}`? "));
    Err(mistake.hint(format!("{}`droptower script --list` shows those that are shipped", nearest.unwrap_or_default())))
}

/// What the script that is named says of itself.
pub(super) fn about(given: &Path) -> Result<About, Failure> {
    let Named { path, text } = named(given)?;
    let text = match text {
        Some(text) => text.into_owned(),
        None => file::read_text(&path, LONGEST_SCRIPT)
            .map_err(|error| Diagnostic::new(format!("cannot read {}: {error}", shown_path(&path))))?,
    };
    Ok(About::read(&path, &text)?)
}

/// A figure of a shipped script as it is explained.
#[derive(Serialize)]
struct Explained<'a> {
    figure: &'a str,
    script: &'static str,
    sentence: String,
}

/// Prints which shipped script measures a figure, and what it is; false where none does.
pub(crate) fn explain(figure: &str, shared: &Shared) -> Result<bool, Failure> {
    let line = |(script, text): &(&'static str, &'static str)| {
        let line = text.lines().find_map(|line| line.strip_prefix("//! figure ")?.strip_prefix(figure))?;
        Some(Explained { figure, script, sentence: line.strip_prefix("  ")?.trim().to_owned() })
    };
    let found: Vec<Explained> = SHIPPED.iter().filter_map(line).collect();
    if found.is_empty() {
        return Ok(false);
    }
    let text = |one: &Explained| {
        format!("{}\n    {}\n    figure of `droptower script {}`", one.figure, one.sentence, one.script)
    };
    print_figures(shared, &found, || found.iter().map(text).collect::<Vec<_>>().join("\n\n"))?;
    Ok(true)
}

/// A shipped script as it is listed.
#[derive(Serialize)]
struct Listed {
    name: &'static str,
    about: String,
}

/// Lists the shipped scripts with the first sentence of each.
pub(super) fn list(shared: &Shared) -> Result<(), Failure> {
    let listed = SHIPPED.iter().map(|(name, text)| {
        let about = About::read(Path::new(name), text)?.text;
        let about = about.split("\n\n").next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
        let end = [": ", ". ", "? "].iter().filter_map(|end| about.find(end)).min().unwrap_or(about.len());
        Ok(Listed { name, about: about[..end].trim_end_matches('.').to_owned() })
    });
    let listed = listed.collect::<Result<Vec<Listed>, Vec<Diagnostic>>>()?;
    print_figures(shared, &listed, || {
        let lines: Vec<Vec<String>> = listed.iter().map(|one| vec![one.name.to_owned(), one.about.clone()]).collect();
        format!("{}droptower script NAME --help has the arguments of one", table::aligned(&lines, 2))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_wins_over_a_shipped_script_of_its_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let mine = folder.path().join("failure-mass.rhai");
        std::fs::write(&mine, "1").expect("a file");
        let found = named(&folder.path().join("failure-mass")).expect("a script");
        assert!(found.text.is_none() && found.path == mine);
        assert!(named(Path::new("failure-mass")).expect("a script").text.is_some());
        let mistake = named(Path::new("failure-mas")).err().expect("a mistake");
        assert!(mistake.hint.expect("a hint").starts_with("did you mean `failure-mass`?"));
    }
}
