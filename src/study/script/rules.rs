//! Rules that a script and its modules must keep.

use std::collections::{BTreeMap, HashSet};

use rhai::{AST, ASTFlags, ASTNode, Expr, FnAccess, Position, Stmt};

use super::module::Unit;
use crate::script::Fault;
use base::diagnostic::closest;

/// The namespace of the constants of a text within its functions.
const CONSTANTS: &str = "global";

/// Everything in `units` that breaks a rule; the script is the first of them.
pub(super) fn broken(units: &[Unit]) -> Vec<Fault> {
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
    unit.program.walk(&mut |path: &[ASTNode]| {
        if let Some(ASTNode::Stmt(Stmt::Import(_, position))) = path.last()
            && !outer.contains(position)
        {
            let fault = Fault::located(&unit.source, *position, "a module is imported within a block".into());
            faults.push(fault.with_hint(Some("write the import at the beginning of the file".into())));
        }
        true
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
    unit.program.walk(&mut |path: &[ASTNode]| {
        match path.last() {
            Some(ASTNode::Expr(Expr::FnCall(call, position))) | Some(ASTNode::Stmt(Stmt::FnCall(call, position))) => {
                let namespace: Vec<String> = call.namespace.path.iter().map(|part| part.name.to_string()).collect();
                found.push((namespace, call.name.to_string(), Some(call.args.len()), *position));
            }
            Some(ASTNode::Expr(Expr::Variable(variable, _, position))) => {
                let namespace: Vec<String> = variable.2.path.iter().map(|part| part.name.to_string()).collect();
                found.push((namespace, variable.1.to_string(), None, *position));
            }
            _ => {}
        }
        true
    });
    found.retain(|(namespace, ..)| !namespace.is_empty());
    found.sort_by_key(|(.., position)| (position.line(), position.position()));
    let fault = |(namespace, name, values, position): (Vec<String>, String, Option<usize>, Position)| {
        let (message, hint) = match values {
            _ if namespace[0] == CONSTANTS => of_constants(unit)?,
            Some(values) => of_call(unit.imported(units, &namespace), &namespace, &name, values)?,
            None => of_constant(unit.imported(units, &namespace), &namespace, &name)?,
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

fn of_call(module: Option<&Unit>, namespace: &[String], name: &str, values: usize) -> Option<Refusal> {
    let path = namespace.join("::");
    let Some(module) = module else { return Some((format!("there is no module `{path}` here"), None)) };
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

fn of_constant(module: Option<&Unit>, namespace: &[String], name: &str) -> Option<Refusal> {
    let path = namespace.join("::");
    let Some(module) = module else { return Some((format!("there is no module `{path}` here"), None)) };
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
