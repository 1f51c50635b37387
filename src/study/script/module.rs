//! Modules that scripts import: `import "film" as film;` finds `film.rhai` beside the script or in its folder `modules`,
//! `import "droptower/film" as film;` one that is shipped.
//!
//! All of a program is read before it runs. The interpreter looks names up in whatever it has loaded: a function of a module
//! that calls back sees the names of the caller and its own. So that every name means one thing, wherever it is called,
//! [`checks`] has what a script and its modules may not do.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

use crate::Error;
use crate::script::{Fault, checks};
use base::diagnostic::{closest, shown_path};
use base::file;
use rhai::{
    AST, ASTFlags, Engine, EvalAltResult, Expr, FnNamespace, GlobalRuntimeState, Module, ModuleResolver, Position,
    Scope, Shared, Stmt,
};

/// Longest script or module that is read, bytes.
pub const LONGEST_SCRIPT: u64 = 1 << 20;

/// Begins the names of modules that are part of droptower.
pub const SHIPPED: &str = "droptower/";

/// A module that is part of droptower.
#[derive(Clone, Copy, Debug)]
pub struct ShippedModule {
    /// Its name, which begins with [`SHIPPED`].
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// A text of a program with the name of its file.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// The file; for a shipped module its name in angle brackets.
    pub file: PathBuf,
    /// The text of the file.
    pub text: Arc<str>,
}

impl SourceText {
    /// The `text` of `file`.
    pub fn new(file: impl Into<PathBuf>, text: &str) -> SourceText {
        SourceText { file: file.into(), text: text.into() }
    }

    /// How the interpreter names it.
    pub(super) fn id(&self) -> String {
        self.file.to_string_lossy().into_owned()
    }
}

/// A script, or a module that it imports.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// As imports name it; empty for the script.
    pub name: String,
    pub source: SourceText,
    pub program: AST,
    /// In the order of the text.
    pub imports: Vec<Import>,
}

/// `import "name" as alias;`
#[derive(Clone, Debug)]
pub(super) struct Import {
    pub alias: String,
    pub name: String,
    pub position: Position,
}

impl Unit {
    /// The unit that is called `path` here, such as `film` or, where that imports `base`, `film::base`.
    pub fn imported<'u>(&self, units: &'u [Unit], path: &[String]) -> Option<&'u Unit> {
        let (first, rest) = path.split_first()?;
        let import = self.imports.iter().find(|import| import.alias == *first)?;
        let unit = units.iter().skip(1).find(|unit| unit.name == import.name)?;
        if rest.is_empty() { Some(unit) } else { unit.imported(units, rest) }
    }

    /// Whether the interpreter made up this name for a function without one.
    pub fn is_closure(function: &str) -> bool {
        function.starts_with("anon$")
    }
}

/// Most modules of one script, and most bytes of their texts.
const MOST_MODULES: usize = 64;
const MOST_BYTES: usize = 8 << 20;

/// The script `program`, and after it each module that it imports, once, in the order of the imports.
///
/// # Errors
/// The first mistake of the language in each text, or what [`rules`] has against them.
pub(super) fn load(
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
        faults = checks::broken(&units);
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
                    refuse(error.to_string(), error.hint().map(str::to_owned));
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
        let alias = import.1.name.to_string();
        match &import.0 {
            Expr::StringConstant(name, position) if !alias.is_empty() => {
                imports.push(Import { alias, name: name.to_string(), position: *position });
            }
            _ => faults.push(
                Fault::located(source, *at, "an import has a text and a name".into())
                    .with_hint(Some("write it like `import \"film\" as film;`".into())),
            ),
        }
    }
    if faults.is_empty() { Ok(imports) } else { Err(faults) }
}

type Resolved = Result<Shared<Module>, Box<EvalAltResult>>;

/// The program that an engine runs. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Programs(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    units: Vec<Unit>,
    /// Modules by their names, once their constants have values.
    evaluated: BTreeMap<String, Shared<Module>>,
}

impl Programs {
    /// Runs these from now on.
    pub fn install(&self, units: &[Unit]) {
        *self.state() = State { units: units.to_vec(), evaluated: BTreeMap::new() };
    }

    fn state(&self) -> MutexGuard<'_, State> {
        base::lock(&self.0)
    }
}

/// The text whose interpreter's name is `id`, or in which a function without a name is written, whatever the interpreter takes for its
/// text: where a module calls it, that of the module.
pub(super) fn find<'u>(units: &'u [Unit], id: Option<&str>, function: Option<&str>) -> Option<&'u Unit> {
    let closure = function.filter(|name| Unit::is_closure(name));
    let writes = |unit: &&Unit| closure.is_some_and(|name| unit.program.iter_functions().any(|own| own.name == name));
    units.iter().find(writes).or_else(|| units.iter().find(|unit| id.is_some_and(|id| unit.source.id() == id)))
}

/// The resolver of an engine whose session has these programs.
pub(super) struct Resolver(pub Programs);

impl ModuleResolver for Resolver {
    fn resolve(&self, engine: &Engine, _: Option<&str>, name: &str, position: Position) -> Resolved {
        let mut global = engine.new_global_runtime_state();
        self.resolve_raw(engine, &mut global, &mut Scope::new(), name, position)
    }

    fn resolve_raw(
        &self,
        engine: &Engine,
        global: &mut GlobalRuntimeState,
        _: &mut Scope,
        name: &str,
        position: Position,
    ) -> Resolved {
        let unit = {
            let state = self.0.state();
            if let Some(module) = state.evaluated.get(name) {
                return Ok(Shared::clone(module));
            }
            state.units.iter().skip(1).find(|unit| unit.name == name).cloned()
        };
        let unit = unit.ok_or_else(|| EvalAltResult::ErrorModuleNotFound(name.into(), position))?;
        let module = evaluate(engine, global, &exported(&unit.program, &unit.source))
            .map_err(|error| EvalAltResult::ErrorInModule(unit.source.id(), error, position))?;
        let module = Shared::new(module);
        self.0.state().evaluated.insert(name.into(), Shared::clone(&module));
        Ok(module)
    }
}

/// The program with all its constants exported.
fn exported(program: &AST, source: &SourceText) -> AST {
    let export = |statement: &Stmt| match statement {
        Stmt::Var(variable, flags, position) => Stmt::Var(variable.clone(), *flags | ASTFlags::EXPORTED, *position),
        other => other.clone(),
    };
    let mut program = AST::new(program.statements().iter().map(export), program.shared_lib().clone());
    program.set_source(source.id());
    program
}

fn evaluate(engine: &Engine, global: &mut GlobalRuntimeState, program: &AST) -> Result<Module, Box<EvalAltResult>> {
    let mut module = Module::eval_ast_as_new_raw(engine, &mut Scope::new(), global, program)?;
    // A function without a name that is returned to the script is found there by this.
    for closure in program.iter_fn_def().filter(|function| Unit::is_closure(&function.name)) {
        let hash = Module::new().set_script_fn(closure.clone());
        // Deprecated in favour of an interface for functions of the host.
        #[allow(deprecated)]
        module.update_fn_namespace(hash, FnNamespace::Global);
    }
    module.build_index();
    Ok(module)
}

/// Longest name of a module, bytes.
const LONGEST_NAME: usize = 200;

/// Extension of the file of a module.
const EXTENSION: &str = "rhai";

/// Folder beside a script in which its modules may be.
const FOLDER: &str = "modules";

fn missing(name: &str, hint: String) -> Error {
    Error::new(format!("there is no module `{name}`")).with_hint(hint)
}

fn unreadable(path: &Path, cause: &dyn Display) -> Error {
    Error::new(format!("cannot read {}: {cause}", shown_path(path)))
}

/// Finds the modules of one script.
pub(super) struct Finder {
    /// The file of the script.
    pub script: PathBuf,
    pub shipped: Vec<ShippedModule>,
    /// Whether modules in files may be imported.
    pub reads_files: bool,
}

impl Finder {
    /// The text of the module `name`.
    pub fn find(&self, name: &str) -> Result<SourceText, Error> {
        if name.starts_with(SHIPPED) {
            return self.find_shipped(name);
        }
        if !is_name(name) {
            let name: String = name.chars().take(LONGEST_NAME).collect();
            let hint = "names of letters, digits, `-` and `_`, in folders below that of the script: \"tower/film\"";
            return Err(Error::new(format!("`{name}` cannot name a module")).with_hint(hint));
        }
        if !self.reads_files {
            let offered = "a post script imports only what droptower ships";
            return Err(Error::new(format!("{offered}: its run is repeated from its folder, which has no `{name}`"))
                .with_hint("write the functions into the script"));
        }
        let folder = self.script.parent().unwrap_or(Path::new(""));
        let file = format!("{name}.{EXTENSION}");
        let places = [folder.join(&file), folder.join(FOLDER).join(&file)];
        let Some(path) = places.iter().find(|path| fs::symlink_metadata(path).is_ok()) else {
            let [beside, below] = places.each_ref().map(|path| shown_path(path));
            return Err(missing(name, format!("neither {beside} nor {below} exists")));
        };
        self.check_place(name, path, folder)?;
        let text = file::read_text(path, LONGEST_SCRIPT).map_err(|error| unreadable(path, &error))?;
        Ok(SourceText::new(path, &text))
    }

    fn find_shipped(&self, name: &str) -> Result<SourceText, Error> {
        let names = || self.shipped.iter().map(|module| module.name);
        let Some(module) = self.shipped.iter().find(|module| module.name == name) else {
            let hint = match closest(name, names()) {
                Some(name) => format!("did you mean \"{name}\"?"),
                None => format!("droptower has {}", names().collect::<Vec<_>>().join(", ")),
            };
            return Err(missing(name, hint));
        };
        Ok(SourceText::new(format!("<{name}.{EXTENSION}>"), module.text))
    }

    /// Refuses links that lead out of the folder of the script.
    fn check_place(&self, name: &str, path: &Path, folder: &Path) -> Result<(), Error> {
        let real = |path: &Path| {
            let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
            path.canonicalize().map_err(|error| unreadable(path, &error))
        };
        let target = real(path)?;
        if !target.starts_with(real(folder)?) {
            let target = shown_path(&target);
            return Err(Error::new(format!("the module `{name}` leads out of the folder of the script, to {target}")));
        }
        if self.script.canonicalize().is_ok_and(|script| script == target) {
            return Err(Error::new("the script would import itself"));
        }
        Ok(())
    }
}

fn is_name(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    name.len() <= LONGEST_NAME && name.split('/').all(|part| !part.is_empty() && part.chars().all(letter))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use base::diagnostic::file_name;
    use rhai::Scope;

    use super::*;
    use crate::script::{Fault, Limits, Script, Session, engine};

    const FILM: &str = "import \"base\" as base;\nconst OPEN = base::TEN - 3;\nfn scaled(x) { base::twice(helper(x)) }\n\
private fn helper(x) { x + 100 }\nfn each(list, f) { list.map(|x| helper(f.call(x))) }\nfn maker(k) { |x| helper(x) * k }\n\
fn bad(x) {\n    x.nosuch\n}\nfn call_with(f) { f.call(1) }\n";
    const BASE: &str = "const TEN = 10;\nfn twice(x) { 2 * x }\nfn ten_times(x) { x * global::TEN }\n";

    /// The last value of `text` beside the modules `files`, or its faults.
    fn run(files: &[(&str, &str)], text: &str) -> Result<String, Vec<Fault>> {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let mut engine = engine(Limits::STUDY);
        Session::of_engine(&engine).read_modules();
        Session::of_engine(&engine).ship(&[ShippedModule { name: "droptower/one", text: "fn one() { 1 }" }]);
        engine.register_fn("count", |_: i64| 1_i64);
        let script = Script::compile(&engine, &Scope::new(), &folder.path().join("s.rhai"), text)?;
        script.evaluate(&engine, &mut Scope::new()).map(|value| value.to_string()).map_err(|fault| vec![fault])
    }

    /// The faults, each with the name of its file.
    fn told(files: &[(&str, &str)], text: &str) -> Vec<String> {
        let told =
            |fault: Fault| format!("{}:{}:{}: {}", file_name(&fault.file), fault.line, fault.column, fault.message);
        run(files, text).expect_err(text).into_iter().map(told).collect()
    }

    #[test]
    fn functions_constants_and_closures_of_modules_are_found() {
        let files = [("film.rhai", FILM), ("modules/base.rhai", BASE), ("tower/steel.rhai", "const E = 210;")];
        for (text, expected) in [
            ("film::scaled(1)", "202"),
            ("film::OPEN", "7"),
            ("film::base::ten_times(4)", "40"),
            ("film::each([1, 2], |x| 3 * x)", "[103, 106]"),
            ("fn own(x) { 3 * x } film::each([1, 2], |x| own(x))", "[103, 106]"),
            ("let f = film::maker(2); f.call(1) + [1].map(f)[0]", "404"),
            ("fn own(x) { film::scaled(x) } [1, 2].map(|x| own(x))", "[202, 204]"),
            ("import \"tower/steel\" as steel; steel::E", "210"),
            ("import \"droptower/one\" as one; one::one()", "1"),
        ] {
            assert_eq!(run(&files, &format!("import \"film\" as film; {text}")).as_deref(), Ok(expected), "{text}");
        }
    }

    #[test]
    fn mistakes_in_modules_are_told_at_their_places() {
        let files = [
            ("film.rhai", FILM),
            ("base.rhai", BASE),
            ("broken.rhai", "fn f( {"),
            ("calls.rhai", "\nfn f() { nosuch(1) }"),
        ];
        for (text, expected) in [
            ("import \"broken\" as broken;", "broken.rhai:1:"),
            ("import \"calls\" as calls;", "calls.rhai:2:10: undefined function `nosuch`"),
            ("import \"film\" as film;\nfilm::bad(1)", "film.rhai:8:7: unknown property 'nosuch'"),
            ("import \"film\" as film;\nfilm::call_with(|x| x.other)", "s.rhai:2:23: unknown property 'other'"),
            ("import \"film\" as film;\n[1].map(|x| film::bad(x))", "film.rhai:8:7: unknown property 'nosuch'"),
            ("import \"film\" as film;\nfilm::scald(1)", "s.rhai:2:7: the module `film` has no function `scald`"),
            ("import \"film\" as film;\nfilm::helper(1)", "s.rhai:2:7: the module `film` has no function `helper`"),
            ("import \"film\" as film;\nfilm::scaled(1, 2)", "s.rhai:2:7: `film::scaled` takes 1 value, not 2"),
            ("import \"film\" as film;\nfilm::OPNE", "s.rhai:2:7: the module `film` has no constant `OPNE`"),
        ] {
            let told = told(&files, text);
            assert!(told.len() == 1 && told[0].starts_with(expected), "{text}\n{told:?}");
        }
    }

    #[test]
    fn what_would_make_a_name_ambiguous_is_refused() {
        for (module, text, expected) in [
            ("let a = 1;", "import \"m\" as m;", "m.rhai:1:1: a module has functions, constants and imports"),
            ("count(1);", "import \"m\" as m;", "m.rhai:1:1: a module has functions, constants and imports"),
            ("fn f(x) { x }", "import \"m\" as m;\nfn f(x) { 1 }", "m.rhai:1:1: "),
            (
                "import \"droptower/one\" as m;",
                "import \"m\" as m;",
                "m.rhai:1:8: `m` is the module \"m\" elsewhere in this program",
            ),
            ("", "if true { import \"m\" as m; }", "s.rhai:1:11: a module is imported within a block"),
            (
                "",
                "import \"m\" as m;\nconst A = 1; fn f() { global::A }",
                "s.rhai:2:31: a text that imports modules has no constants within functions",
            ),
            ("", "let name = \"m\"; import name as m;", "s.rhai:1:17: an import has a text and a name"),
        ] {
            let told = told(&[("m.rhai", module)], text);
            assert!(told.len() == 1 && told[0].starts_with(expected), "{text}\n{told:?}");
        }
    }

    #[test]
    fn circles_and_places_out_of_the_folder_are_refused() {
        let cycle = [("a.rhai", "import \"b\" as b;"), ("b.rhai", "import \"a\" as a;")];
        let told = |text: &str| told(&cycle, text).remove(0);
        assert_eq!(told("import \"a\" as a;"), "b.rhai:1:8: cyclic imports: a → b → a");
        assert_eq!(told("import \"s\" as s;"), "s.rhai:1:8: there is no module `s`");
        for name in ["../a", "/etc/a", "a/../b", "./a", "a.rhai", "C:\\\\a", ""] {
            let told = told(&format!("import \"{name}\" as a;"));
            assert!(told.contains("cannot name a module"), "{told}");
        }
        assert!(told("import \"droptower/nosuch\" as a;").contains("there is no module"));
    }

    #[test]
    fn functions_that_clash_behind_the_last_position_are_told() {
        let module = format!("{}fn zz(x) {{ 2 }}", "\n".repeat(usize::from(u16::MAX)));
        let told = told(&[("m.rhai", &module)], "import \"m\" as m;\nfn zz(x) { 1 }");
        assert!(told.len() == 1 && told[0].starts_with("m.rhai:65536:1: "), "{told:?}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_does_not_lead_out_of_the_folder() {
        let [inside, outside] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        fs::write(outside.path().join("m.rhai"), "fn f() { 1 }").unwrap();
        std::os::unix::fs::symlink(outside.path().join("m.rhai"), inside.path().join("m.rhai")).unwrap();
        let finder = Finder { script: inside.path().join("s.rhai"), shipped: vec![], reads_files: true };
        let told = |finder: &Finder, name: &str| finder.find(name).unwrap_err().to_string();
        assert!(told(&finder, "m").contains("leads out of the folder"));
        fs::write(inside.path().join("s.rhai"), "").unwrap();
        assert!(told(&finder, "s").contains("import itself"));
        let post = Finder { reads_files: false, ..finder };
        assert!(told(&post, "m").contains("imports only what droptower ships"));
    }

    #[test]
    fn the_text_of_a_module_identifies_its_script() {
        let folder = tempfile::tempdir().unwrap();
        let engine = engine(Limits::STUDY);
        Session::of_engine(&engine).read_modules();
        let identity = |module: &str| {
            fs::write(folder.path().join("m.rhai"), module).unwrap();
            let script =
                Script::compile(&engine, &Scope::new(), &folder.path().join("s.rhai"), "import \"m\" as m;").unwrap();
            (script.whole_text(), script.mentions_argument("mu"))
        };
        let [one, same, other] = ["fn f(a) { a.mu }", "fn f(a) { a.mu }", "fn f(a) { 2 }"].map(identity);
        assert!(one == same && one.0 != other.0 && one.1 && !other.1);
        assert_eq!(Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), "1").unwrap().whole_text(), "1");
    }
}
