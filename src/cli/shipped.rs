//! Scripts that are part of the program and run by their names, and what a script says of itself.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::json;

use crate::explain::Explanation;
use crate::{Failure, Shared, print, print_figures, terminal};
use base::diagnostic::{Diagnostic, closest, shown_path};
use base::file;
use study::script::{About, Declared, Kind, LONGEST_SCRIPT, figure_sentence};

macro_rules! shipped {
    ($($name:literal),*) => {
        [$(($name, include_str!(concat!("../../scripts/", $name, ".rhai")))),*]
    };
}

/// Names and texts. They need a scenario of the user's and no other file.
const SHIPPED: [(&str, &str); 6] =
    shipped!["dart-break-strain", "dart-data-sheet", "failure-mass", "identify", "identify-field", "layers"];

/// Post scripts that `droptower new` writes.
const POST: [(&str, &str); 1] = [("puncture.rhai", include_str!("../../scripts/post/puncture.rhai"))];

/// The names of the shipped scripts.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

/// A script that a user names.
pub(crate) struct Named {
    /// Where it is, or where a shipped one would be.
    pub(crate) path: PathBuf,
    /// The text of a shipped script.
    pub(crate) text: Option<Cow<'static, str>>,
}

/// The file that is named, with or without its ending, or else the shipped script of this name.
pub(crate) fn named(given: &Path) -> Result<Named, Diagnostic> {
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
pub(crate) fn about(given: &Path) -> Result<About, Failure> {
    let Named { path, text } = named(given)?;
    let text = match text {
        Some(text) => text.into_owned(),
        None => file::read_text(&path, LONGEST_SCRIPT)
            .map_err(|error| Diagnostic::new(format!("cannot read {}: {error}", shown_path(&path))))?,
    };
    Ok(About::read(&path, &text)?)
}

/// What a figure is that a shipped script measures, and which one; none where none does.
pub(crate) fn figure(figure: &str) -> Option<Explanation> {
    let of_scripts = SHIPPED.iter().map(|(name, text)| (name, text, format!("`droptower script {name}`")));
    let of_post = |name: &str| format!("the post script {name}, which `droptower new` writes");
    let scripts = of_scripts.chain(POST.iter().map(|(name, text)| (name, text, of_post(name))));
    let entry = |(script, text, whose): (&&str, &&str, String)| {
        let sentence = figure_sentence(text, figure)?;
        let facts = json!({ "figure": figure, "script": script, "sentence": sentence });
        Some((facts, format!("{figure}\n    {sentence}\n    figure of {whose}")))
    };
    let found: Vec<_> = scripts.filter_map(entry).collect();
    (!found.is_empty()).then(|| found.into_iter().collect())
}

/// A shipped script as it is listed.
#[derive(Serialize)]
struct Listed {
    name: &'static str,
    about: String,
}

/// Lists the shipped scripts with the first sentence of each.
pub(crate) fn list(shared: &Shared) -> Result<(), Failure> {
    let listed = SHIPPED.iter().map(|(name, text)| {
        let about = About::read(Path::new(name), text)?.text;
        let about = about.split("\n\n").next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
        let end = [": ", ". ", "? "].iter().filter_map(|end| about.find(end)).min().unwrap_or(about.len());
        Ok(Listed { name, about: about[..end].trim_end_matches('.').to_owned() })
    });
    let listed = listed.collect::<Result<Vec<Listed>, Failure>>()?;
    print_figures(shared, &listed, || {
        let lines: Vec<Vec<String>> = listed.iter().map(|one| vec![one.name.to_owned(), one.about.clone()]).collect();
        format!("{}droptower script NAME --help has the arguments of one", terminal::aligned(&lines, 2))
    })
}

/// Shows what the script does and its arguments; without one, what the command does.
pub(crate) fn show(script: Option<&Path>, shared: &Shared) -> Result<(), Failure> {
    let Some(path) = script else {
        let mut command = crate::command();
        command.build();
        let help = command.find_subcommand_mut("script").map(|command| command.render_long_help().to_string());
        return print(help.unwrap_or_default().trim_end());
    };
    let about = about(path)?;
    print_figures(shared, &about, || shown(path, &about))
}

fn shown(path: &Path, about: &About) -> String {
    let usage = format!("Usage: droptower script {} [--scenario SCENARIO] [--arg NAME=VALUE]…", shown_path(path));
    let mut parts = vec![about.text.clone(), usage];
    if about.text.is_empty() {
        parts[0] = format!("{} says nothing of itself in lines that begin with //!", shown_path(path));
    }
    let heads: Vec<String> = about.arguments.iter().map(head).collect();
    let width = heads.iter().map(|head| head.chars().count()).max().unwrap_or(0);
    let lines = heads.iter().zip(&about.arguments);
    let lines: Vec<String> = lines.map(|(head, one)| format!("  --arg {head:width$}  {}", one.text)).collect();
    if !lines.is_empty() {
        parts.push(format!("Arguments:\n{}", lines.join("\n")));
    }
    parts.push("Options of all scripts: droptower script --help".into());
    parts.join("\n\n")
}

fn head(one: &Declared) -> String {
    match one.default.as_deref() {
        None => format!("{} (must be given)", one.name),
        Some("") => one.name.clone(),
        // As it is declared: of a list of any length.
        Some(default) if one.kind == Kind::Numbers(None) => format!("{}={default}, …", one.name),
        Some(default) => format!("{}={default}", one.name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_of_a_post_script_is_explained() {
        for (name, text) in POST {
            let measured = text.split("measure(\"").skip(1).filter_map(|rest| rest.split('"').next());
            let unexplained: Vec<&str> = measured.filter(|one| figure(one).is_none()).collect();
            assert!(unexplained.is_empty(), "{name}: {unexplained:?}");
        }
    }

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
