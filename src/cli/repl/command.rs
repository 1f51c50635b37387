//! The commands that are typed after a colon.

use std::path::{Path, PathBuf};

use super::super::{Failure, functions, output, print};
use super::{Repl, show};
use base::diagnostic::{Diagnostic, closest, folder_of, shown_path};
use base::file;
use study::script::{About, Arguments, LONGEST_SCRIPT, SourceText};

/// A command of the session.
#[derive(Debug, PartialEq)]
pub(super) enum Command {
    Help,
    Explain(String),
    Variables,
    Load(PathBuf),
    Save(PathBuf),
    Quit,
}

const HELP: &str = "\
An input is a line of a script, or more until its brackets close. Its value is shown unless it ends with `;` and has none.

  :help             this
  :explain NAME     a function of scripts, with an example
  :vars             the variables
  :load FILE        runs a script here, with its modules and the defaults of its arguments
  :save FILE        writes what was typed as a script, FILE.rhai
  :quit             ends, as Ctrl-D does

Tab completes functions, variables, figures after `run.summary.`, and files in texts. Ctrl-C stops what is computed;
again, it ends the session.";

impl Command {
    /// The names of the commands.
    pub const NAMES: [&str; 6] = ["help", "explain", "vars", "load", "save", "quit"];

    /// Reads what follows the colon.
    pub fn read(text: &str) -> Result<Command, Diagnostic> {
        let (name, argument) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let argument = argument.trim();
        let needed = |what: &str| match argument {
            "" => Err(Diagnostic::new(format!(":{name} needs {what}"))),
            given => Ok(given.to_owned()),
        };
        match name {
            "help" | "h" | "?" => Ok(Command::Help),
            "vars" => Ok(Command::Variables),
            "quit" | "q" => Ok(Command::Quit),
            "explain" => needed("the name of a function").map(Command::Explain),
            "load" => needed("a file").map(|file| Command::Load(file.into())),
            "save" => needed("a file").map(|file| Command::Save(file.into())),
            other => {
                let mistake = Diagnostic::new(format!("there is no command `:{other}`"));
                Err(mistake.hint(match closest(other, Command::NAMES) {
                    Some(close) => format!("did you mean `:{close}`?"),
                    None => ":help lists the commands".into(),
                }))
            }
        }
    }
}

impl Repl<'_> {
    /// Does what the command says; whether the session goes on.
    pub(super) fn command(&mut self, command: &Command) -> Result<bool, Failure> {
        match command {
            Command::Help => print(HELP)?,
            Command::Quit => return Ok(false),
            Command::Explain(name) => {
                if !functions::are_called(name) {
                    let mistake = Diagnostic::new(format!("there is no function `{name}`"));
                    return Err(mistake.hint("`droptower explain functions` lists them").into());
                }
                functions::run(Some(name), self.shared)?;
            }
            Command::Variables => self.variables()?,
            Command::Load(path) => self.load(path)?,
            Command::Save(path) => self.save(path)?,
        }
        Ok(true)
    }

    fn variables(&self) -> Result<(), Failure> {
        let variables = self.console.variables();
        let line =
            |(name, value): &(String, rhai::Dynamic)| format!("  {name}  {}\n", show::brief(&self.engine, value));
        let lines: String = variables.iter().map(line).collect();
        print(lines.trim_end())
    }

    fn load(&mut self, path: &Path) -> Result<(), Failure> {
        let text = file::read_text(path, LONGEST_SCRIPT)
            .map_err(|error| Diagnostic::new(format!("cannot read {}: {error}", shown_path(path))))?;
        let about = About::read(path, &text)?;
        let own =
            |(name, _): &(&rhai::Identifier, &rhai::Dynamic)| about.arguments.iter().any(|one| one.name == **name);
        let given = self.given.iter().filter(own).map(|(name, value)| (name.clone(), value.clone())).collect();
        let mistakes = about.check(&given);
        if !mistakes.is_empty() {
            return Err(mistakes.into());
        }
        let mut arguments = self.arguments.clone();
        arguments.extend(about.complete(&given));
        let (file, args) = (SourceText::new(path, &text), Arguments::new(arguments.clone()));
        let value = self.evaluate(|engine, console| console.load(engine, &file, &about, args))?;
        self.arguments = arguments;
        self.show(&value, "")
    }

    /// Writes what was entered as a script, beside the modules that it imports.
    fn save(&self, path: &Path) -> Result<(), Failure> {
        output::check(path, "rhai", None, None)?;
        let is_elsewhere = !self.console.finds_modules_from(folder_of(path));
        if let Some(folder) = self.console.folder().filter(|_| is_elsewhere) {
            let mistake = Diagnostic::new("the script would not find its modules");
            let beside = folder.join(path.file_name().unwrap_or_default());
            return Err(mistake.hint(format!("save it beside them, as {}", shown_path(&beside))).into());
        }
        let text = self.console.script();
        output::write(path, |file| file.write_all(text.as_bytes()))?;
        print(&format!("{}: {} lines", shown_path(path), text.lines().count()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read_and_mistakes_told() {
        assert_eq!(Command::read("load a b.rhai").unwrap(), Command::Load("a b.rhai".into()));
        assert_eq!(Command::read("q").unwrap(), Command::Quit);
        for (text, expected) in [
            ("save", ":save needs a file"),
            ("expalin x", "there is no command `:expalin`"),
            ("", "there is no command `:`"),
        ] {
            assert_eq!(Command::read(text).unwrap_err().message, expected);
        }
    }
}
