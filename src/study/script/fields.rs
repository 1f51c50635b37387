//! Fields of host maps with known names, such as `run.summary`: misspelt ones are found before the script runs. A field
//! may begin with the name of a part of the run: `head_energy_absorption` ends with an underscore and a known name.

use std::collections::HashSet;

use rhai::{ASTNode, Expr, Position};

use super::module::Unit;
use super::{Fault, Fields};
use base::diagnostic::closest;

/// Every access `.<map>.<field>` in `units` to a field that the map cannot have, in the order of the texts. A program
/// that has the name of the map, or of the field, as a key or a text may make such a map itself.
pub(super) fn unknown(known: &[Fields], units: &[Unit]) -> Vec<Fault> {
    let mut own: HashSet<String> = HashSet::new();
    let found: Vec<Vec<Access>> = units.iter().map(|unit| accesses(unit, &mut own)).collect();
    let fault = |unit: &Unit, (map, field, position): Access| {
        let is_of = |name: &&str| field.strip_suffix(*name).is_some_and(|rest| rest.is_empty() || rest.ends_with('_'));
        let known = known.iter().find(|known| known.map == map && !known.names.iter().any(is_of))?;
        if own.contains(&map) || own.contains(&field) {
            return None;
        }
        let fault = Fault::located(&unit.source, position, format!("a {map} has no `{field}`"));
        let close = closest(&field, known.names.iter().copied());
        Some(fault.with_hint(close.map(|name| format!("did you mean `{name}`?"))))
    };
    let faults = units.iter().zip(found).flat_map(|(unit, found)| found.into_iter().map(move |access| (unit, access)));
    faults.filter_map(|(unit, access)| fault(unit, access)).collect()
}

/// Map, field and place of an access.
type Access = (String, String, Position);

/// The accesses in a text; keys and texts in it are added to `own`.
fn accesses(unit: &Unit, own: &mut HashSet<String>) -> Vec<Access> {
    let mut found: Vec<Access> = Vec::new();
    unit.program.walk(&mut |path: &[ASTNode]| {
        match path.last() {
            Some(ASTNode::Expr(Expr::Map(map, _))) => own.extend(map.0.iter().map(|(key, _)| key.name.to_string())),
            Some(ASTNode::Expr(Expr::StringConstant(text, _))) => drop(own.insert(text.to_string())),
            Some(ASTNode::Expr(Expr::Dot(pair, ..))) => {
                if let (Some((map, _)), Some((field, position))) = (property(&pair.lhs), first_property(&pair.rhs)) {
                    found.push((map, field, position));
                }
            }
            _ => {}
        }
        true
    });
    found.sort_by_key(|(_, _, position)| (position.line(), position.position()));
    found
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::{Dynamic, Map, Scope};

    use super::*;
    use crate::script::{Limits, Script, Session, engine, refuse_key};

    fn faults(text: &str) -> Vec<(usize, usize, String, Option<String>)> {
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
            assert_eq!(faults(text), [(line, column, message.to_owned(), hint.clone())], "{text}");
        }
        assert_eq!(faults("let m = #{ summary: #{ own: 1 } }; m.summary.own"), []);
    }

    #[test]
    fn a_function_without_brackets_has_a_hint() {
        let [(1, 11, message, hint)] = &faults("let a = 1.sqrt;")[..] else {
            panic!("{:?}", faults("let a = 1.sqrt;"))
        };
        assert_eq!(message, "`sqrt` is a function and has no brackets here");
        assert_eq!(hint.as_deref(), Some("call it as `.sqrt()`"));
    }

    #[test]
    fn a_refused_key_is_reported_at_its_place() {
        let text = "with(#{ a: 1 });\nwith(#{\n  a: 1,\n  \"b.c\": 2,\n});";
        let hint = Some("did you mean `d`?".to_owned());
        assert_eq!(faults(text), [(4, 3, "unknown key `c`".to_owned(), hint.clone())]);
        for (text, line, column) in [
            ("let a = #{ \"b.c\": 1 };\nwith(a);\nlet later = #{ \"b.c\": 2 };", 2, 1),
            ("let a = #{ \"b.c\": 1 };\nwith(a); [#{ \"b.c\": 2 }];", 2, 1),
            ("let f = || with(#{ a: 1 } + #{\n \"b.c\": 1 });\nlet later = #{ \"b.c\": 2 };\nf.call()", 2, 2),
            ("if true {\n  let made = 1 + with(#{ \"b.c\": 1 });\n}", 2, 26),
        ] {
            assert_eq!(faults(text), [(line, column, "unknown key `c`".to_owned(), hint.clone())], "{text}");
        }
        assert_eq!(faults("try { with(#{ \"b.c\": 2 }) } catch (e) { if !e.contains(\"mean\") { throw 1 } }"), []);
    }

    #[test]
    fn export_is_not_supported() {
        let expected = (2, 1, "`export` is not supported in scripts".to_owned());
        let (line, column, message, hint) = faults("let a = 1;\nexport a;").remove(0);
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
