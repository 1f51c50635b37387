//! Calls of undefined functions, found before the script runs.

use std::collections::{BTreeSet, HashSet};

use rhai::{AST, ASTNode, Engine, Expr, FnCallExpr, Position, Stmt};

use super::Fault;
use super::module::Unit;
use base::diagnostic::closest;
use base::removed;

/// Functions of the interpreter itself, which its list of functions lacks.
const BUILT_IN: [&str; 9] =
    ["print", "debug", "type_of", "Fn", "call", "curry", "is_shared", "is_def_var", "is_def_fn"];

/// Every call in `units` whose name neither the engine nor the text with the call defines, in the order of the texts.
///
/// A method may also be a closure in a map, so a method is accepted where one of the texts has its name as a key, a
/// property or a text.
pub(super) fn undefined(engine: &Engine, units: &[Unit]) -> Vec<Fault> {
    let mut known: BTreeSet<String> = engine
        .collect_fn_metadata(None, |function| Some(function.metadata.name.to_string()), true)
        .into_iter()
        .collect();
    known.extend(BUILT_IN.map(str::to_owned));
    let words: Vec<Words> = units.iter().map(|unit| Words::from_program(&unit.program)).collect();
    let mentioned: HashSet<&str> = words.iter().flat_map(|words| words.mentioned.iter().map(String::as_str)).collect();
    units.iter().zip(&words).flat_map(|(unit, words)| of_unit(unit, words, &mentioned, known.clone())).collect()
}

fn of_unit(unit: &Unit, words: &Words, mentioned: &HashSet<&str>, mut known: BTreeSet<String>) -> Vec<Fault> {
    known.extend(unit.program.iter_functions().map(|function| function.name.to_owned()));
    let undefined = |call: &&Call| {
        let in_a_map = call.is_method && mentioned.contains(call.name.as_str());
        !known.contains(&call.name) && !in_a_map
    };
    let mut calls: Vec<&Call> = words.calls.iter().filter(undefined).collect();
    calls.sort_by_key(|call| (call.position.line(), call.position.position()));
    let fault = |call: &Call| {
        let message = format!("undefined function `{}`", call.name);
        Fault::located(&unit.source, call.position, message).with_hint(hint(call, words, &known))
    };
    calls.into_iter().map(fault).collect()
}

fn hint(call: &Call, words: &Words, known: &BTreeSet<String>) -> Option<String> {
    let name = &call.name;
    if words.variables.contains(name) {
        return Some(format!("call the function in the variable as `{name}.call(…)`"));
    }
    let functions =
        known.iter().map(String::as_str).filter(|name| name.chars().all(|c| c.is_alphanumeric() || c == '_'));
    removed::function(name).or_else(|| closest(name, functions).map(|close| format!("did you mean `{close}`?")))
}

struct Call {
    name: String,
    position: Position,
    is_method: bool,
}

/// The calls of a script, and other names in it.
#[derive(Default)]
pub(super) struct Words {
    calls: Vec<Call>,
    /// Keys of maps, properties and texts.
    pub(super) mentioned: HashSet<String>,
    variables: HashSet<String>,
}

impl Words {
    pub(super) fn from_program(program: &AST) -> Words {
        let mut words = Words::default();
        program.walk(&mut |path: &[ASTNode]| {
            match path.last() {
                Some(ASTNode::Expr(expression)) => words.read_expression(expression),
                Some(ASTNode::Stmt(statement)) => words.read_statement(statement),
                _ => {}
            }
            true
        });
        words
    }

    fn read_expression(&mut self, expression: &Expr) {
        match expression {
            Expr::FnCall(call, position) => self.read_call(call, *position, false),
            Expr::MethodCall(call, position) => self.read_call(call, *position, true),
            Expr::StringConstant(text, _) => drop(self.mentioned.insert(text.to_string())),
            Expr::Property(property, _) => drop(self.mentioned.insert(property.2.to_string())),
            Expr::Map(map, _) => self.mentioned.extend(map.0.iter().map(|(key, _)| key.name.to_string())),
            _ => {}
        }
    }

    fn read_statement(&mut self, statement: &Stmt) {
        match statement {
            Stmt::FnCall(call, position) => self.read_call(call, *position, false),
            Stmt::Var(variable, _, _) => drop(self.variables.insert(variable.0.name.to_string())),
            _ => {}
        }
    }

    fn read_call(&mut self, call: &FnCallExpr, position: Position, is_method: bool) {
        if !call.is_operator_call() && !call.is_qualified() {
            self.calls.push(Call { name: call.name.to_string(), position, is_method });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::{FLOAT, INT, Scope};

    use crate::script::{Fault, Limits, Script, engine};

    fn faults(text: &str) -> Vec<Fault> {
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
            let found = faults(text);
            let found: Vec<String> = found.iter().map(Fault::to_string).collect();
            assert_eq!(found, [expected], "{text:?}");
        }
    }

    #[test]
    fn all_undefined_functions_are_reported_at_once_with_hints() {
        let found = faults("mesure(\"a\", 1);\nlet f = |x| x;\nf(2);\n1.0.time_of_mxa();");
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
            assert_eq!(faults(text), [], "{text}");
        }
    }
}
