//! Texts that are run one after another, with the variables, constants, functions and imports of those before.

mod saved;
#[cfg(test)]
mod tests;
mod transcript;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rhai::{AST, ASTFlags, ASTNode, Dynamic, Engine, ImmutableString, Position, Scope, Stmt};

use self::saved::Saved;
use self::transcript::{INPUT, MOST_LINES, Transcript, folder_of};
use super::module::{self, Import, SHIPPED, SourceText, Unit};
use super::{About, Arguments, Fault, Script};
use base::diagnostic::shown_path;

/// All inputs so far, and their variables. Lines are counted from the first input on.
#[derive(Clone, Debug)]
pub struct Console {
    scope: Scope<'static>,
    constants: BTreeMap<ImmutableString, Dynamic>,
    functions: AST,
    transcript: Transcript,
    saved: Saved,
    /// Where modules in files are found; none before the first of them.
    folder: Option<PathBuf>,
}

/// An input that can run.
struct Compiled {
    script: Script,
    /// It alone.
    program: AST,
    /// As [`Console::folder`].
    folder: Option<PathBuf>,
}

impl Console {
    /// Nothing was entered; `scope` has constants.
    pub fn new(scope: Scope<'static>) -> Console {
        Console {
            scope,
            constants: BTreeMap::new(),
            functions: AST::empty(),
            transcript: Transcript::default(),
            saved: Saved::default(),
            folder: None,
        }
    }

    /// Runs an input; its last value.
    ///
    /// # Errors
    /// All mistakes that are found before it runs, or the one that ends it. Neither leaves variables, functions or imports;
    /// what an input that ends early assigned to earlier variables stays.
    pub fn run(&mut self, engine: &Engine, input: &str) -> Result<Dynamic, Vec<Fault>> {
        self.enter(engine, input, None)
    }

    /// Runs a script in a file, which says `about` itself, with `args` as its arguments; its last value. Its modules are found
    /// beside it.
    ///
    /// # Errors
    /// As of [`Console::run`], at the lines of the file; also where earlier modules are in another folder.
    pub fn load(
        &mut self,
        engine: &Engine,
        file: &SourceText,
        about: &About,
        args: Arguments,
    ) -> Result<Dynamic, Vec<Fault>> {
        let variables = self.scope.len();
        self.scope.push_constant("args", args);
        let found = self.enter(engine, &file.text, Some(file));
        match &found {
            Ok(_) => self.saved.describe(about),
            Err(_) => drop(self.scope.rewind(variables)),
        }
        found
    }

    fn enter(&mut self, engine: &Engine, input: &str, file: Option<&SourceText>) -> Result<Dynamic, Vec<Fault>> {
        let mut transcript = self.transcript.followed_by(input, file);
        let compiled = self.compile(engine, input, file, &self.transcript.source(input));
        let Compiled { script, program, folder } = compiled
            .map_err(|faults| faults.into_iter().map(|fault| transcript.in_its_file(fault)).collect::<Vec<_>>())?;
        let variables = self.scope.len();
        let found = script.evaluate_after(engine, &mut self.scope, self.constants.clone());
        let lines_before = self.transcript.lines();
        if found.is_ok() {
            transcript.add_imports(script.imports());
            self.saved.push(input, &program, lines_before);
            self.functions = script.functions();
            self.folder = folder;
            let fresh = self.scope.iter().skip(variables).filter(|(_, is_constant, _)| *is_constant);
            self.constants.extend(fresh.map(|(name, _, value)| (name.into(), value)));
        } else {
            self.scope.rewind(variables);
            // An earlier variable may hold one of its functions without a name.
            let closures = program.clone_functions_only_filtered(|_, _, _, name, _| Unit::is_closure(name));
            self.functions = self.functions.merge(&closures);
        }
        self.transcript = transcript;
        found.map_err(|fault| vec![self.transcript.in_its_file(fault)])
    }

    /// The script of an input: its lines follow those before, which have nothing but their imports now.
    fn compile(
        &self,
        engine: &Engine,
        input: &str,
        file: Option<&SourceText>,
        source: &SourceText,
    ) -> Result<Compiled, Vec<Fault>> {
        let before = self.transcript.lines();
        if before + input.lines().count() > MOST_LINES {
            let fault = Fault::located(source, Position::NONE, format!("a session has at most {MOST_LINES} lines"));
            let hint = "run long texts with `droptower script`";
            return Err(vec![Fault { line: before + 1, ..fault }.with_hint(Some(hint.into()))]);
        }
        let text = self.transcript.imports_alone() + input;
        let compiled = engine.compile_with_scope(&self.scope, text);
        let program = compiled.map_err(|error| vec![Fault::parsing(source, &error)])?;
        if let Some(position) = returned_from(&program) {
            let fault = Fault::located(source, position, "`return` ends a script, and a session goes on".into());
            return Err(vec![fault.with_hint(Some("leave `return` out: the last value is shown".into()))]);
        }
        let folder = self.folder_after(file, source, &module::imports_of(&program, source)?)?;
        let place = folder.clone().unwrap_or_else(|| folder_of(file));
        let place = place.join(file.and_then(|file| file.file.file_name()).unwrap_or(INPUT.as_ref()));
        let script = Script::link(engine, place, source.clone(), self.functions.merge(&program))?;
        Ok(Compiled { script, program, folder })
    }

    /// The folder of modules after a text with these imports: that of the first text which imports a file.
    fn folder_after(
        &self,
        file: Option<&SourceText>,
        source: &SourceText,
        imports: &[Import],
    ) -> Result<Option<PathBuf>, Vec<Fault>> {
        let is_own = |import: &&Import| import.position.line().is_some_and(|line| line > self.transcript.lines());
        let mut files = imports.iter().filter(is_own).filter(|import| !import.name.starts_with(SHIPPED));
        let (own, Some(first)) = (folder_of(file), files.next()) else { return Ok(self.folder.clone()) };
        match &self.folder {
            Some(folder) if file.is_some() && !is_same(folder, &own) => {
                let message = format!("the modules of this session are in {}", shown_folder(folder));
                let hint = format!("start another session for those in {}", shown_folder(&own));
                Err(vec![Fault::located(source, first.position, message).with_hint(Some(hint))])
            }
            Some(folder) => Ok(Some(folder.clone())),
            None => Ok(Some(own)),
        }
    }

    /// All inputs without mistakes, as a script: of functions that were entered anew, the last.
    pub fn script(&self) -> String {
        self.saved.script()
    }

    /// The folder in which the modules of that script are; none where it imports none in files.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Whether a script in this folder finds the modules that were imported.
    pub fn finds_modules_from(&self, folder: &Path) -> bool {
        self.folder().is_none_or(|own| is_same(own, folder))
    }

    /// The variables with their values, the last of each name, in the order of the names.
    pub fn variables(&self) -> Vec<(String, Dynamic)> {
        let mut all: Vec<(String, Dynamic)> = Vec::new();
        for (name, _, value) in self.scope.iter() {
            match all.iter_mut().find(|(other, _)| other == name) {
                Some(same) => same.1 = value,
                None => all.push((name.to_owned(), value)),
            }
        }
        all.sort_by(|a, b| a.0.cmp(&b.0));
        all
    }

    /// The value of the variable `name`.
    pub fn variable(&self, name: &str) -> Option<Dynamic> {
        self.scope.get(name).map(Dynamic::flatten_clone)
    }

    /// The functions that were entered.
    pub fn functions(&self) -> Vec<String> {
        let names = self.functions.iter_functions().map(|function| function.name.to_owned());
        names.filter(|name| !Unit::is_closure(name)).collect()
    }
}

fn is_same(one: &Path, other: &Path) -> bool {
    let [one, other] = [one, other].map(|folder| Path::new(".").join(folder).canonicalize().ok());
    one.is_some() && one == other
}

fn shown_folder(folder: &Path) -> String {
    if folder.as_os_str().is_empty() { "the working folder".into() } else { shown_path(folder) }
}

/// Where a program returns, but for its functions.
fn returned_from(program: &AST) -> Option<Position> {
    let mut found = None;
    for statement in program.statements() {
        statement.walk(&mut Vec::new(), &mut |path: &[ASTNode]| {
            if let Some(ASTNode::Stmt(Stmt::Return(_, flags, position))) = path.last()
                && !flags.contains(ASTFlags::BREAK)
            {
                found = found.or(Some(*position));
            }
            true
        });
    }
    found
}
