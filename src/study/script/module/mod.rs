//! Modules that scripts import: `import "film" as film;` finds `film.rhai` beside the script or in its folder `modules`,
//! `import "droptower/film" as film;` one that is shipped.
//!
//! All of a program is read before it runs. The interpreter looks names up in whatever it has loaded: a function of a module
//! that calls back sees the names of the caller and its own. So that every name means one thing, wherever it is called,
//! [`rules`] has what a script and its modules may not do.

mod finder;
mod loader;
mod resolver;
mod rules;

use std::path::PathBuf;
use std::sync::Arc;

use rhai::{AST, Position};

pub(super) use finder::Finder;
pub(super) use loader::load;
pub(super) use resolver::{Programs, Resolver, find};

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

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

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
        let name = |fault: &Fault| fault.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let told = |fault: Fault| format!("{}:{}:{}: {}", name(&fault), fault.line, fault.column, fault.message);
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
        assert!(matches!(finder.find("m"), Err(finder::FindError::Outside { .. })));
        fs::write(inside.path().join("s.rhai"), "").unwrap();
        assert!(matches!(finder.find("s"), Err(finder::FindError::Itself)));
        let post = Finder { reads_files: false, ..finder };
        assert!(matches!(post.find("m"), Err(finder::FindError::NotOffered { .. })));
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
