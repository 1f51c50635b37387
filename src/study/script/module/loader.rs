//! Reads and compiles a script with everything that it imports.

use rhai::{AST, Engine, Expr, Ident, Position, Stmt};

use super::{Finder, Import, SourceText, Unit, rules};
use crate::script::Fault;

/// Most modules of one script, and most bytes of their texts.
const MOST_MODULES: usize = 64;
const MOST_BYTES: usize = 8 << 20;

/// The script `program`, and after it each module that it imports, once, in the order of the imports.
///
/// # Errors
/// The first mistake of the language in each text, or what [`rules`] has against them.
pub(in crate::script) fn load(
    engine: &Engine,
    finder: &Finder,
    source: SourceText,
    program: AST,
) -> Result<Vec<Unit>, Vec<Fault>> {
    let script = unit(String::new(), source, program)?;
    let mut loader = Loader { engine, finder, units: vec![script], faults: Vec::new() };
    loader.follow(0, &mut Vec::new());
    let Loader { units, mut faults, .. } = loader;
    if faults.is_empty() {
        faults = rules::broken(&units);
    }
    if faults.is_empty() { Ok(units) } else { Err(faults) }
}

struct Loader<'a> {
    engine: &'a Engine,
    finder: &'a Finder,
    units: Vec<Unit>,
    faults: Vec<Fault>,
}

impl Loader<'_> {
    /// Loads what the unit at `place` imports; `chain` has the names of those that lead to it.
    fn follow(&mut self, place: usize, chain: &mut Vec<String>) {
        for import in self.units[place].imports.clone() {
            let source = self.units[place].source.clone();
            let mut refuse = |message: String, hint| {
                self.faults.push(Fault::located(&source, import.position, message).with_hint(hint))
            };
            if let Some(begin) = chain.iter().position(|name| *name == import.name) {
                let cycle = chain[begin..].iter().chain([&import.name]);
                let cycle = cycle.map(String::as_str).collect::<Vec<_>>().join(" → ");
                refuse(format!("cyclic imports: {cycle}"), None);
                continue;
            }
            if self.units.iter().skip(1).any(|unit| unit.name == import.name) {
                continue;
            }
            let bytes: usize = self.units.iter().map(|unit| unit.source.text.len()).sum();
            if self.units.len() > MOST_MODULES || bytes > MOST_BYTES {
                refuse(format!("a script imports at most {MOST_MODULES} modules of {} MB", MOST_BYTES >> 20), None);
                return;
            }
            let found = match self.finder.find(&import.name) {
                Ok(found) => found,
                Err(error) => {
                    refuse(error.to_string(), error.hint());
                    continue;
                }
            };
            let compiled = self.engine.compile(&*found.text).map_err(|error| vec![Fault::parsing(&found, &error)]);
            match compiled.and_then(|program| unit(import.name.clone(), found, program)) {
                Err(faults) => self.faults.extend(faults),
                Ok(unit) => {
                    self.units.push(unit);
                    chain.push(import.name.clone());
                    self.follow(self.units.len() - 1, chain);
                    chain.pop();
                }
            }
        }
    }
}

fn unit(name: String, source: SourceText, mut program: AST) -> Result<Unit, Vec<Fault>> {
    program.set_source(source.id());
    let imports = imports_of(&program, &source)?;
    Ok(Unit { name, source, program, imports })
}

/// The imports of a program.
fn imports_of(program: &AST, source: &SourceText) -> Result<Vec<Import>, Vec<Fault>> {
    let mut imports = Vec::new();
    let mut faults = Vec::new();
    for statement in program.statements() {
        let Stmt::Import(import, at) = statement else { continue };
        match read(&import.0, &import.1) {
            Some((name, alias, position)) => imports.push(Import { alias, name, position }),
            None => faults.push(
                Fault::located(source, *at, "an import has a text and a name".into())
                    .with_hint(Some("write it like `import \"film\" as film;`".into())),
            ),
        }
    }
    if faults.is_empty() { Ok(imports) } else { Err(faults) }
}

fn read(path: &Expr, alias: &Ident) -> Option<(String, String, Position)> {
    match path {
        Expr::StringConstant(name, position) if !alias.name.is_empty() => {
            Some((name.to_string(), alias.name.to_string(), *position))
        }
        _ => None,
    }
}
