//! Options of host functions that a script writes as a map where it calls them: misspelt ones are found before the script runs.

use std::collections::HashSet;

use rhai::{ASTNode, Expr, FnCallExpr, Position, Stmt};

use super::calls::Words;
use super::module::Unit;
use super::{CallOptions, Fault};
use base::diagnostic::closest;
use base::removed;

/// Every option in `units` that its function does not have, in the order of the texts. Functions that a text defines itself, or that
/// it has as a key, a property or a text, are not those of the host.
pub(super) fn unknown(known: &[CallOptions], units: &[Unit]) -> Vec<Fault> {
    let mut own: HashSet<String> = HashSet::new();
    for unit in units {
        own.extend(unit.program.iter_functions().map(|function| function.name.to_owned()));
        own.extend(Words::from_program(&unit.program).mentioned);
    }
    units.iter().flat_map(|unit| of_unit(known, unit, &own)).collect()
}

fn of_unit(known: &[CallOptions], unit: &Unit, own: &HashSet<String>) -> Vec<Fault> {
    let mut found = Vec::new();
    unit.program.walk(&mut |path: &[ASTNode]| {
        let call: Option<&FnCallExpr> = match path.last() {
            Some(
                ASTNode::Expr(Expr::FnCall(call, _) | Expr::MethodCall(call, _)) | ASTNode::Stmt(Stmt::FnCall(call, _)),
            ) => Some(call),
            _ => None,
        };
        if let Some(call) = call.filter(|call| !own.contains(call.name.as_str())) {
            for options in known.iter().filter(|options| options.function == call.name.as_str()) {
                let maps = call.args.last().map(|given| maps_of(given, options.inside)).unwrap_or_default();
                for key in maps.into_iter().filter_map(as_map).flatten().map(|(key, _)| key) {
                    if !options.names.iter().any(|names| names.contains(&key.name.as_str())) {
                        found.push((*options, key.name.to_string(), key.pos));
                    }
                }
            }
        }
        true
    });
    found.sort_by_key(|(_, _, position)| (position.line(), position.position()));
    let fault = |(options, key, position): (CallOptions, String, Position)| {
        let message = format!("{} has no option `{key}`", options.of);
        let names = || options.names.iter().copied().flatten().copied();
        let gone = removed::function(&format!("{}.{key}", options.function));
        let hint = gone.or_else(|| closest(&key, names()).map(|close| format!("did you mean `{close}`?")));
        let known = || format!("it takes {}", names().collect::<Vec<_>>().join(", "));
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
fn as_map(expression: &Expr) -> Option<impl Iterator<Item = (&rhai::Ident, &Expr)>> {
    match expression {
        Expr::Map(map, _) => Some(map.0.iter().map(|(key, value)| (key, value))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::{Array, Map, Scope};

    use super::CallOptions;
    use crate::script::{Fault, Limits, Script, Session, engine};

    fn faults(text: &str) -> Vec<String> {
        let mut engine = engine(Limits::POST);
        engine.register_fn("fit", |_: Map| {}).register_fn("draw", |_: Array, _: Map| {});
        let session = Session::of_engine(&engine);
        let of = |of, function, inside, names| CallOptions { of, function, inside, names };
        session.declare_options(of("fit", "fit", None, &[&["tests", "share"], &["parameters"]]));
        session.declare_options(of("a test of fit", "fit", Some("tests"), &[&["weight"]]));
        session.declare_options(of("a parameter of fit", "fit", Some("parameters"), &[&["start"]]));
        session.declare_options(of("draw", "draw", None, &[&["samples"]]));
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
            assert_eq!(faults(text), expected, "{text}");
        }
    }
}
