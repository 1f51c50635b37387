//! What is found in a script before it runs: calls of undefined functions, unknown options, unknown fields.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use rhai::{AST, ASTFlags, ASTNode, Engine, Expr, FnAccess, FnCallExpr, Ident, Position, Stmt};

use crate::script::module::Unit;
use crate::script::{CallOptions, Fault, Fields, Session};
use base::diagnostic::{closest, did_you_mean};
use base::removed;

/// Functions of the interpreter itself, which its list of functions lacks.
const BUILT_IN: [&str; 9] =
    ["print", "debug", "type_of", "Fn", "call", "curry", "is_shared", "is_def_var", "is_def_fn"];

/// Calls of undefined functions, accesses to unknown fields and unknown options in `units`, each kind in the order of the texts.
pub(crate) fn faults(engine: &Engine, units: &[Unit]) -> Vec<Fault> {
    let session = Session::of_engine(engine);
    let words: Vec<(&Unit, Words)> = units.iter().map(|unit| (unit, Words::from_program(&unit.program))).collect();
    let mut found = undefined_calls(engine, &words);
    found.extend(unknown_fields(&session.fields(), &words));
    found.extend(unknown_options(&session.call_options(), &words));
    found
}

/// Every call whose name neither the engine nor the text with the call defines.
///
/// A method may also be a closure in a map, so a method is accepted where one of the texts has its name as a key, a
/// property or a text.
fn undefined_calls(engine: &Engine, all: &[(&Unit, Words)]) -> Vec<Fault> {
    let mut known: BTreeSet<String> = engine
        .collect_fn_metadata(None, |function| Some(function.metadata.name.to_string()), true)
        .into_iter()
        .collect();
    known.extend(BUILT_IN.map(str::to_owned));
    all.iter().flat_map(|(unit, words)| calls_of_unit(unit, words, all, known.clone())).collect()
}

fn calls_of_unit(unit: &Unit, words: &Words, all: &[(&Unit, Words)], mut known: BTreeSet<String>) -> Vec<Fault> {
    known.extend(unit.program.iter_functions().map(|function| function.name.to_owned()));
    let undefined = |call: &&Call| {
        let in_a_map = || call.is_method && all.iter().any(|(_, words)| words.mentions(&call.name));
        !known.contains(&call.name) && !in_a_map()
    };
    let calls = words.calls.iter().filter(undefined);
    let fault = |call: &Call| {
        let message = format!("undefined function `{}`", call.name);
        Fault::located(&unit.source, call.position, message).with_hint(hint_for(call, words, &known))
    };
    calls.map(fault).collect()
}

fn hint_for(call: &Call, words: &Words, known: &BTreeSet<String>) -> Option<String> {
    let name = &call.name;
    if words.variables.contains(name) {
        return Some(format!("call the function in the variable as `{name}.call(…)`"));
    }
    let functions =
        known.iter().map(String::as_str).filter(|name| name.chars().all(|c| c.is_alphanumeric() || c == '_'));
    removed::function(name).or_else(|| did_you_mean(name, functions))
}

/// Looks at each node of a program, with the nodes about it from the outside in, itself the last.
pub(super) fn each_node(program: &AST, mut look: impl FnMut(&ASTNode, &[ASTNode])) {
    program.walk(&mut |path: &[ASTNode]| {
        if let Some(node) = path.last() {
            look(node, path);
        }
        true
    });
}

/// The call that a node is, its place, and whether it is that of a method.
pub(super) fn as_call<'n>(node: &'n ASTNode<'_>) -> Option<(&'n FnCallExpr, Position, bool)> {
    match node {
        ASTNode::Expr(Expr::MethodCall(call, position)) => Some((call, *position, true)),
        ASTNode::Expr(Expr::FnCall(call, position)) | ASTNode::Stmt(Stmt::FnCall(call, position)) => {
            Some((call, *position, false))
        }
        _ => None,
    }
}

/// What orders places in a text.
pub(super) fn order(position: Position) -> (Option<usize>, Option<usize>) {
    (position.line(), position.position())
}

struct Call {
    name: String,
    position: Position,
    is_method: bool,
}

/// Map, field and place of an access.
type Access = (String, String, Position);

/// The calls of a script, its accesses `.<map>.<field>`, both in the order of the text, and other names in it.
#[derive(Default)]
struct Words {
    calls: Vec<Call>,
    accesses: Vec<Access>,
    /// Keys of maps, and texts.
    written: HashSet<String>,
    properties: HashSet<String>,
    variables: HashSet<String>,
}

impl Words {
    fn from_program(program: &AST) -> Words {
        let mut words = Words::default();
        each_node(program, |node, _| match node {
            ASTNode::Expr(Expr::StringConstant(text, _)) => drop(words.written.insert(text.to_string())),
            ASTNode::Expr(Expr::Property(property, _)) => drop(words.properties.insert(property.2.to_string())),
            ASTNode::Expr(Expr::Map(map, _)) => words.written.extend(map.0.iter().map(|(key, _)| key.name.to_string())),
            ASTNode::Expr(Expr::Dot(pair, ..)) => {
                if let (Some((map, _)), Some((field, position))) = (property(&pair.lhs), first_property(&pair.rhs)) {
                    words.accesses.push((map, field, position));
                }
            }
            ASTNode::Stmt(Stmt::Var(variable, ..)) => drop(words.variables.insert(variable.0.name.to_string())),
            other => {
                let call = as_call(other).filter(|(call, ..)| !call.is_operator_call() && !call.is_qualified());
                let named = |(call, position, is_method): (&FnCallExpr, Position, bool)| Call {
                    name: call.name.to_string(),
                    position,
                    is_method,
                };
                words.calls.extend(call.map(named));
            }
        });
        words.calls.sort_by_key(|call| order(call.position));
        words.accesses.sort_by_key(|(_, _, position)| order(*position));
        words
    }

    /// Whether a name stands in it as a key, a property or a text.
    fn mentions(&self, name: &str) -> bool {
        self.written.contains(name) || self.properties.contains(name)
    }
}

/// Every option that its function does not have. Functions that a text defines itself, or that it has as a key, a property or a
/// text, are not those of the host.
fn unknown_options(known: &[CallOptions], all: &[(&Unit, Words)]) -> Vec<Fault> {
    let is_own = |name: &str| {
        let is_of = |(unit, words): &(&Unit, Words)| {
            unit.program.iter_functions().any(|function| function.name == name) || words.mentions(name)
        };
        all.iter().any(is_of)
    };
    all.iter().flat_map(|(unit, _)| options_of_unit(known, unit, is_own)).collect()
}

fn options_of_unit(known: &[CallOptions], unit: &Unit, is_own: impl Fn(&str) -> bool) -> Vec<Fault> {
    let mut found = Vec::new();
    each_node(&unit.program, |node, _| {
        let Some((call, ..)) = as_call(node).filter(|(call, ..)| !is_own(call.name.as_str())) else { return };
        for options in known.iter().filter(|options| options.function == call.name.as_str()) {
            let maps = call.args.last().map(|given| maps_of(given, options.inside)).unwrap_or_default();
            for key in maps.into_iter().filter_map(as_map).flatten().map(|(key, _)| key) {
                if !(options.names)().contains(&key.name.as_str()) {
                    found.push((*options, key.name.to_string(), key.pos));
                }
            }
        }
    });
    found.sort_by_key(|(_, _, position)| order(*position));
    let fault = |(options, key, position): (CallOptions, String, Position)| {
        let message = format!("{} has no option `{key}`", options.of);
        let names = (options.names)();
        let gone = removed::function(&format!("{}.{key}", options.function));
        let hint = gone.or_else(|| did_you_mean(&key, names.iter().copied()));
        let known = || format!("it takes {}", names.join(", "));
        Fault::located(&unit.source, position, message).with_hint(Some(hint.unwrap_or_else(known)))
    };
    found.into_iter().map(fault).collect()
}

/// The map of options itself, or the maps within one of them.
fn maps_of<'a>(given: &'a Expr, inside: Option<&str>) -> Vec<&'a Expr> {
    let Some(option) = inside else { return vec![given] };
    let value =
        as_map(given).and_then(|mut entries| entries.find(|(key, _)| key.name == option)).map(|(_, value)| value);
    match value {
        Some(Expr::Array(list, _)) => list.iter().collect(),
        Some(map @ Expr::Map(..)) => as_map(map).into_iter().flatten().map(|(_, value)| value).collect(),
        _ => Vec::new(),
    }
}

/// The entries of a map.
fn as_map(expression: &Expr) -> Option<impl Iterator<Item = (&Ident, &Expr)>> {
    match expression {
        Expr::Map(map, _) => Some(map.0.iter().map(|(key, value)| (key, value))),
        _ => None,
    }
}

/// Every access to a field that its map cannot have. A program that has the name of the map, or of the field, as a key or a text may
/// make such a map itself.
fn unknown_fields(known: &[Fields], all: &[(&Unit, Words)]) -> Vec<Fault> {
    let is_own = |name: &String| all.iter().any(|(_, words)| words.written.contains(name));
    let fault = |(unit, (map, field, position)): (&Unit, &Access)| {
        let is_of = |name: &&str| field.strip_suffix(*name).is_some_and(|rest| rest.is_empty() || rest.ends_with('_'));
        let known = known.iter().find(|known| known.map == map && !known.names.iter().any(is_of))?;
        if is_own(map) || is_own(field) {
            return None;
        }
        let fault = Fault::located(&unit.source, *position, format!("a {map} has no `{field}`"));
        Some(fault.with_hint(did_you_mean(field, known.names.iter().copied())))
    };
    let accesses = all.iter().flat_map(|(unit, words)| words.accesses.iter().map(|access| (*unit, access)));
    accesses.filter_map(fault).collect()
}

fn property(expression: &Expr) -> Option<(String, Position)> {
    match expression {
        Expr::Property(property, position) => Some((property.2.to_string(), *position)),
        _ => None,
    }
}

/// The property that an access begins with.
fn first_property(expression: &Expr) -> Option<(String, Position)> {
    match expression {
        Expr::Dot(pair, ..) | Expr::Index(pair, ..) => property(&pair.lhs),
        other => property(other),
    }
}

/// The namespace of the constants of a text within its functions.
const CONSTANTS: &str = "global";

/// Everything in `units` that breaks a rule; the script is the first of them.
pub(crate) fn broken(units: &[Unit]) -> Vec<Fault> {
    let mut faults: Vec<Fault> = units.iter().flat_map(late_imports).collect();
    faults.extend(units.iter().skip(1).flat_map(statements));
    faults.extend(common_functions(units));
    faults.extend(common_aliases(units));
    faults.extend(units.iter().flat_map(|unit| uses(unit, units)));
    faults
}

/// Imports within a block or a function.
fn late_imports(unit: &Unit) -> Vec<Fault> {
    let is_import = |statement: &&Stmt| matches!(statement, Stmt::Import(..));
    let outer: HashSet<Position> = unit.program.statements().iter().filter(is_import).map(Stmt::position).collect();
    let mut faults = Vec::new();
    each_node(&unit.program, |node, _| {
        if let ASTNode::Stmt(Stmt::Import(_, position)) = node
            && !outer.contains(position)
        {
            let fault = Fault::located(&unit.source, *position, "a module is imported within a block".into());
            faults.push(fault.with_hint(Some("write the import at the beginning of the file".into())));
        }
    });
    faults
}

/// Statements of a module besides functions, constants and imports.
fn statements(unit: &Unit) -> Vec<Fault> {
    let other = unit.program.statements().iter().filter(|statement| match statement {
        Stmt::Import(..) | Stmt::Noop(_) => false,
        Stmt::Var(_, flags, _) => !flags.contains(ASTFlags::CONSTANT),
        _ => true,
    });
    let fault = |statement: &Stmt| {
        let fault =
            Fault::located(&unit.source, statement.position(), "a module has functions, constants and imports".into());
        let hint = match statement {
            Stmt::Var(..) => "a constant begins with `const`",
            _ => "write it into a function that the script calls",
        };
        fault.with_hint(Some(hint.into()))
    };
    other.map(fault).collect()
}

/// Functions of two texts with the same name and number of values: the interpreter would call either.
fn common_functions(units: &[Unit]) -> Vec<Fault> {
    let mut first: BTreeMap<(String, usize), &Unit> = BTreeMap::new();
    let mut faults = Vec::new();
    for unit in units {
        for function in unit.program.iter_functions().filter(|function| !Unit::is_closure(function.name)) {
            let key = (function.name.to_owned(), function.params.len());
            match first.get(&key) {
                Some(other) => faults.push(clash(unit, other, function.name)),
                None => drop(first.insert(key, unit)),
            }
        }
    }
    faults
}

fn clash(unit: &Unit, other: &Unit, name: &str) -> Fault {
    // The interpreter does not tell where a function is defined.
    let line = unit.source.text.lines().position(|line| {
        let words: Vec<&str> = line.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
        words.windows(2).any(|pair| pair == ["fn", name])
    });
    let message = format!("{} has a function `{name}`, too", other.source.file.display());
    let fault = Fault::located(&unit.source, Position::NONE, message);
    // Its positions end at line 65 535.
    Fault { line: line.map_or(1, |line| line + 1), ..fault }
        .with_hint(Some("a script and its modules have functions of different names".into()))
}

/// Names that stand for different modules in two texts.
fn common_aliases(units: &[Unit]) -> Vec<Fault> {
    let mut first: BTreeMap<&str, &str> = BTreeMap::new();
    let mut faults = Vec::new();
    for unit in units {
        for import in &unit.imports {
            let module = *first.entry(&import.alias).or_insert(&import.name);
            if module != import.name {
                let message = format!("`{}` is the module \"{module}\" elsewhere in this program", import.alias);
                let hint = Some("import it under another name".into());
                faults.push(Fault::located(&unit.source, import.position, message).with_hint(hint));
            }
        }
    }
    faults
}

/// Calls and constants of modules that these do not have.
fn uses(unit: &Unit, units: &[Unit]) -> Vec<Fault> {
    let mut found: Vec<(Vec<String>, String, Option<usize>, Position)> = Vec::new();
    let names = |path: &[Ident]| path.iter().map(|part| part.name.to_string()).collect();
    each_node(&unit.program, |node, _| match node {
        ASTNode::Expr(Expr::Variable(variable, _, position)) => {
            found.push((names(&variable.2.path), variable.1.to_string(), None, *position));
        }
        other => found.extend(as_call(other).map(|(call, position, _)| {
            (names(&call.namespace.path), call.name.to_string(), Some(call.args.len()), position)
        })),
    });
    found.retain(|(namespace, ..)| !namespace.is_empty());
    found.sort_by_key(|(.., position)| order(*position));
    let fault = |(namespace, name, values, position): (Vec<String>, String, Option<usize>, Position)| {
        let path = namespace.join("::");
        let (message, hint) = match (unit.imported(units, &namespace), values) {
            _ if namespace[0] == CONSTANTS => of_constants(unit)?,
            (None, _) => (format!("there is no module `{path}` here"), None),
            (Some(module), Some(values)) => of_call(module, &path, &name, values)?,
            (Some(module), None) => of_constant(module, &path, &name)?,
        };
        Some(Fault::located(&unit.source, position, message).with_hint(hint))
    };
    found.into_iter().filter_map(fault).collect()
}

type Refusal = (String, Option<String>);

/// A closure that is called by a module would see the constants of the module.
fn of_constants(unit: &Unit) -> Option<Refusal> {
    let message = "a text that imports modules has no constants within functions";
    (!unit.imports.is_empty()).then(|| (message.into(), Some("hand the value to the function as an argument".into())))
}

fn of_call(module: &Unit, path: &str, name: &str, values: usize) -> Option<Refusal> {
    let public = || module.program.iter_functions().filter(|function| function.access == FnAccess::Public);
    let counts: Vec<usize> =
        public().filter(|function| function.name == name).map(|function| function.params.len()).collect();
    if counts.contains(&values) {
        return None;
    }
    if let Some(count) = counts.first() {
        let plural = if *count == 1 { "value" } else { "values" };
        return Some((format!("`{path}::{name}` takes {count} {plural}, not {values}"), None));
    }
    let names = public().map(|function| function.name).filter(|name| !Unit::is_closure(name));
    let hint = closest(name, names).map(|close| format!("did you mean `{path}::{close}`?"));
    Some((format!("the module `{path}` has no function `{name}`"), hint))
}

fn of_constant(module: &Unit, path: &str, name: &str) -> Option<Refusal> {
    let names = constants(&module.program);
    if names.iter().any(|constant| constant == name) {
        return None;
    }
    let hint = closest(name, names.iter().map(String::as_str)).map(|close| format!("did you mean `{path}::{close}`?"));
    Some((format!("the module `{path}` has no constant `{name}`"), hint))
}

/// The names of the constants of a module.
fn constants(program: &AST) -> Vec<String> {
    let name = |statement: &Stmt| match statement {
        Stmt::Var(variable, flags, _) if flags.contains(ASTFlags::CONSTANT) => Some(variable.0.name.to_string()),
        _ => None,
    };
    program.statements().iter().filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::{Array, Dynamic, FLOAT, INT, Map, Scope};

    use crate::script::{Limits, Script, Session, engine, refuse_key};

    use super::*;

    fn faults_of_calls(text: &str) -> Vec<Fault> {
        let mut engine = engine(Limits::POST);
        engine.register_fn("measure", |_: &str, _: INT| {}).register_fn("time_of_max", |_: FLOAT| {});
        Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), text).err().unwrap_or_default()
    }

    #[test]
    fn undefined_functions_are_reported_with_their_positions() {
        for (text, expected) in [
            ("let a = 1;\n  nosuch(a)", "s.rhai:2:3: undefined function `nosuch`"),
            ("nosuch(1);", "s.rhai:1:1: undefined function `nosuch`"),
            ("fn f(x) {\n x.nosuch()\n}\nf(1)", "s.rhai:2:4: undefined function `nosuch`"),
            ("let f = |x| nosuch(x);", "s.rhai:1:13: undefined function `nosuch`"),
            ("let m = #{};\nm.nosuch(1)", "s.rhai:2:3: undefined function `nosuch`"),
            ("if false { for i in 0..3 { [1].map(|x| `${nosuch(x)}`) } }", "s.rhai:1:43: undefined function `nosuch`"),
            ("switch 1 { 2 => nosuch(), _ => 1 }", "s.rhai:1:17: undefined function `nosuch`"),
        ] {
            let found = faults_of_calls(text);
            let found: Vec<String> = found.iter().map(Fault::to_string).collect();
            assert_eq!(found, [expected], "{text:?}");
        }
    }

    #[test]
    fn all_undefined_functions_are_reported_at_once_with_hints() {
        let found = faults_of_calls("mesure(\"a\", 1);\nlet f = |x| x;\nf(2);\n1.0.time_of_mxa();");
        let hints: Vec<_> = found.iter().map(|fault| (fault.line, fault.hint.as_deref().unwrap_or_default())).collect();
        let expected = [
            (1, "did you mean `measure`?"),
            (3, "call the function in the variable as `f.call(…)`"),
            (4, "did you mean `time_of_max`?"),
        ];
        assert_eq!(hints, expected);
    }

    #[test]
    fn functions_that_may_be_defined_are_accepted() {
        let sound = [
            "fn later(x) { x + 1 } later(1)",
            "twice(1); fn twice(x) { x * 2 }",
            "let m = #{ grow: |x| x + 1 }; m.grow(1)",
            "let m = #{}; m.grow = |x| x + 1; m.grow(1)",
            "let m = #{}; m[\"grow\"] = |x| x + 1; m.grow(1)",
            "let k = 2; let f = |x| x * k; f.call(3); call(f, 3)",
            "let f = Fn(\"abs\"); f.call(-1); type_of(f); is_shared(f); debug(f); print(f)",
            "if is_def_fn(\"abs\", 1) { (-1).abs() } is_def_var(\"a\")",
            "fn own() { this + 1 } let a = 1; a.own()",
            "let a = [3, 1]; a.sort(); a.push(2); a.filter(|x| x > 1).map(|x| x.sqrt()).reduce(|s, x| s + x, 0.0); a.len()",
            "for i in range(0, 3) { let t = `${i} of ${i.to_string()}`; t.to_upper(); } max(1, 2); PI().sin(); E().ln()",
            "1 in [1, 2]; -1 + 2 ** 3; !true; 1..3; \"a\" + 'b'; let x = 1; x += 2; x <<= 1; x ?? 2; #{}?.a",
            "\"abc\".sub_string(1); \"a,b\".split(\",\"); parse_int(\"1\"); parse_float(\"1\"); #{ a: 1 }.keys(); #{}.values()",
            "try { throw 1 } catch (e) { e.to_string() }",
        ];
        for text in sound {
            assert_eq!(faults_of_calls(text), [], "{text}");
        }
    }

    fn faults_of_options(text: &str) -> Vec<String> {
        let mut engine = engine(Limits::POST);
        engine.register_fn("fit", |_: Map| {}).register_fn("draw", |_: Array, _: Map| {});
        let session = Session::of_engine(&engine);
        let of = |of, function, inside, names| CallOptions { of, function, inside, names };
        session.declare_options(of("fit", "fit", None, || vec!["tests", "share", "parameters"]));
        session.declare_options(of("a test of fit", "fit", Some("tests"), || vec!["weight"]));
        session.declare_options(of("a parameter of fit", "fit", Some("parameters"), || vec!["start"]));
        session.declare_options(of("draw", "draw", None, || vec!["samples"]));
        let found = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), text).err().unwrap_or_default();
        found.iter().map(Fault::to_string).collect()
    }

    #[test]
    fn misspelt_options_are_found_at_their_place() {
        for (text, expected) in [
            ("fit(#{ tests: [], shar: 1 });", vec!["s.rhai:1:19: fit has no option `shar`"]),
            (
                "let f = fit(#{\n  tests: [#{ weight: 1 }, #{ wieght: 2 }] });",
                vec!["s.rhai:2:30: a test of fit has no option `wieght`"],
            ),
            (
                "fit(#{ parameters: #{ start: #{ start: 1 }, k: #{ stat: 1 } }, other: 2 });",
                vec!["s.rhai:1:51: a parameter of fit has no option `stat`", "s.rhai:1:64: fit has no option `other`"],
            ),
            ("[1].draw(#{ sample: 3 });", vec!["s.rhai:1:13: draw has no option `sample`"]),
            ("draw([], #{ samples: 3 });", vec![]),
            // What is not written there is known when it runs.
            ("let o = #{ sample: 3 }; draw([], o + #{ sampel: 1 });", vec![]),
            ("fn draw(a, b) { }\ndraw([], #{ mine: 3 });", vec![]),
            ("let own = #{ draw: |a, b| 1 };\nown.draw(1, #{ mine: 3 });", vec![]),
        ] {
            assert_eq!(faults_of_options(text), expected, "{text}");
        }
    }

    fn faults_of_fields(text: &str) -> Vec<(usize, usize, String, Option<String>)> {
        let mut engine = engine(Limits::POST);
        Session::of_engine(&engine).declare(Fields { map: "summary", names: &["peak_force_N", "elements"] });
        engine.register_fn("start", || -> Map { [("summary".into(), Dynamic::from(Map::new()))].into() });
        engine.register_fn("with", |changes: Map| match changes.contains_key("b.c") {
            true => Err(refuse_key("b.c", "unknown key `c`", Some("did you mean `d`?".into()))),
            false => Ok(1_i64),
        });
        let of = |fault: Fault| (fault.line, fault.column, fault.message, fault.hint);
        match Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), text) {
            Err(faults) => faults.into_iter().map(of).collect(),
            Ok(script) => script.run(&engine, Scope::new()).err().into_iter().map(of).collect(),
        }
    }

    /// Where the map is reached at once, before the script runs; in a variable, when it is read.
    #[test]
    fn a_misspelt_field_is_reported_with_the_closest_name() {
        let hint = Some("did you mean `peak_force_N`?".to_owned());
        for (text, line, column, message) in [
            ("throw 1;\nstart().summary.peak_forc_N", 2, 17, "a summary has no `peak_forc_N`"),
            ("throw 1; [start()][0].summary.peak_forc_N.max()", 1, 31, "a summary has no `peak_forc_N`"),
            ("let s = start().summary; s.peak_forc_N", 1, 28, "there is no property `peak_forc_N`"),
        ] {
            assert_eq!(faults_of_fields(text), [(line, column, message.to_owned(), hint.clone())], "{text}");
        }
        assert_eq!(faults_of_fields("let m = #{ summary: #{ own: 1 } }; m.summary.own"), []);
    }

    #[test]
    fn a_function_without_brackets_has_a_hint() {
        let [(1, 11, message, hint)] = &faults_of_fields("let a = 1.sqrt;")[..] else {
            panic!("{:?}", faults_of_fields("let a = 1.sqrt;"))
        };
        assert_eq!(message, "`sqrt` is a function and has no brackets here");
        assert_eq!(hint.as_deref(), Some("call it as `.sqrt()`"));
    }

    #[test]
    fn a_refused_key_is_reported_at_its_place() {
        let text = "with(#{ a: 1 });\nwith(#{\n  a: 1,\n  \"b.c\": 2,\n});";
        let hint = Some("did you mean `d`?".to_owned());
        assert_eq!(faults_of_fields(text), [(4, 3, "unknown key `c`".to_owned(), hint.clone())]);
        for (text, line, column) in [
            ("let a = #{ \"b.c\": 1 };\nwith(a);\nlet later = #{ \"b.c\": 2 };", 2, 1),
            ("let a = #{ \"b.c\": 1 };\nwith(a); [#{ \"b.c\": 2 }];", 2, 1),
            ("let f = || with(#{ a: 1 } + #{\n \"b.c\": 1 });\nlet later = #{ \"b.c\": 2 };\nf.call()", 2, 2),
            ("if true {\n  let made = 1 + with(#{ \"b.c\": 1 });\n}", 2, 26),
        ] {
            assert_eq!(faults_of_fields(text), [(line, column, "unknown key `c`".to_owned(), hint.clone())], "{text}");
        }
        let caught = "try { with(#{ \"b.c\": 2 }) } catch (e) { if !e.contains(\"mean\") { throw 1 } }";
        assert_eq!(faults_of_fields(caught), []);
    }

    #[test]
    fn export_is_not_supported() {
        let expected = (2, 1, "`export` is not supported in scripts".to_owned());
        let (line, column, message, hint) = faults_of_fields("let a = 1;\nexport a;").remove(0);
        assert_eq!(((line, column, message), hint.is_some()), (expected, true));
    }

    #[test]
    fn a_comment_or_a_key_does_not_read_an_argument() {
        let read = |text: &str| {
            let engine = engine(Limits::POST);
            let mut scope = Scope::new();
            scope.push_constant("args", Map::new());
            Script::compile(&engine, &scope, Path::new("s.rhai"), text).unwrap().mentions_argument("mu")
        };
        for text in ["args.mu", "\"mu\" in args", "args[\"mu\"]", "args.keys()", "let f = |x| args.mu * x;"] {
            assert!(read(text), "{text}");
        }
        for text in ["// mu", "let m = #{ mu: 1 };", "let mu = 1;", "\"of mu\""] {
            assert!(!read(text), "{text}");
        }
    }
}
