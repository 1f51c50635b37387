//! `droptower script SCRIPT --help`: what a script says of itself.

use std::path::Path;

use super::shipped;
use crate::{Failure, Shared, print, print_figures};
use base::diagnostic::shown_path;
use study::script::{About, Declared, Kind};

/// Shows what the script does and its arguments; without one, what the command does.
pub(super) fn show(script: Option<&Path>, shared: &Shared) -> Result<(), Failure> {
    let Some(path) = script else {
        let mut command = crate::command();
        command.build();
        let help = command.find_subcommand_mut("script").map(|command| command.render_long_help().to_string());
        return print(help.unwrap_or_default().trim_end());
    };
    let about = shipped::about(path)?;
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
