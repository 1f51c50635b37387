//! Inputs of a session one after another.

use super::*;
use crate::script::{Limits, Session, ShippedModule, engine};

/// The value of `a` after what is saved, which runs as a script and as an input.
fn run_saved(console: &Console) -> String {
    let text = console.script();
    let mut again = Console::new(Scope::new());
    let engine = engine(Limits::STUDY);
    let script = Script::compile(&engine, &Scope::new(), Path::new("saved.rhai"), &text);
    let mut scope = Scope::new();
    let _ = script.expect(&text).evaluate(&engine, &mut scope).expect(&text);
    let _ = again.run(&engine, &text).expect(&text);
    scope.get("a").expect(&text).to_string()
}

#[test]
fn variables_functions_and_closures_stay() {
    let engine = engine(Limits::STUDY);
    let mut console = Console::new(Scope::new());
    for (input, expected) in [
        ("let a = 2;", "()"),
        ("fn twice(x) { 2 * x }", "()"),
        ("let f = |x| twice(x) + 1;", "()"),
        ("a = twice(a); f.call(a) // twice", "9"),
        ("fn twice(x) { 3 * x }", "()"),
        ("f.call(a)", "13"),
        ("let a = \"text\"; a", "text"),
    ] {
        let found =
            console.run(&engine, input).map(|value| if value.is_unit() { "()".into() } else { value.to_string() });
        assert_eq!(found.as_deref(), Ok(expected), "{input}");
    }
    let script = console.script();
    assert!(script.contains("3 * x") && !script.contains("2 * x"), "{script}");
    assert_eq!(run_saved(&console), "text");
    let names: Vec<String> = console.variables().into_iter().map(|(name, _)| name).collect();
    assert_eq!((names, console.functions()), (vec!["a".into(), "f".into()], vec!["twice".to_owned()]));
}

#[test]
fn a_mistake_is_told_at_its_line_and_leaves_what_was_before() {
    let engine = engine(Limits::STUDY);
    let mut console = Console::new(Scope::new());
    let _ = console.run(&engine, "fn bad(x) {\n    x.nosuch\n}\nlet b = 1;").unwrap();
    for (input, expected) in [
        ("nosuch(1)", "<input>:5:1: undefined function `nosuch`"),
        ("let b = ;", "<input>:5:9: "),
        ("let c = 1; b = 5; bad(c)", "<input>:2:7: unknown property 'nosuch'"),
        ("b.sqrt(1)", "<input>:6:3: `sqrt` does not take"),
        ("c", "<input>:7:1: undefined variable: c"),
        ("fn f(x) { x }\nreturn f(1);", "<input>:8:1: `return` ends a script"),
    ] {
        let faults = console.run(&engine, input).unwrap_err();
        assert!(faults[0].to_string().starts_with(expected), "{}", faults[0]);
        assert!(faults[0].text.ends_with(input), "{}", faults[0].text);
    }
    assert_eq!(console.run(&engine, "b").unwrap().as_int(), Ok(5));
}

#[test]
fn what_is_saved_runs() {
    let engine = engine(Limits::STUDY);
    for (inputs, expected) in [
        (&["let a = 1;", "let b = a.nosuch;", "a += 1"][..], "2"),
        (&["fn f(x) { 2 * x } let a = 1;", "fn f(x) { 3 * x }", "a = f(a) // thrice"], "3"),
        (
            &[
                "/// Twice °.\n  /// fn f(x)\n  private fn f(x) { /* } */ 2 * x }\nlet a = 1;",
                "fn f(x) { 5 }",
                "a = f(a)",
            ],
            "5",
        ),
        (
            &["fn e() {} fn g(x) { x }", "fn g(x) { 2 * x } fn h() { 7 }", "fn e() { } fn h() { 8 }", "let a = g(h())"],
            "16",
        ),
        (&["const K = 1;", "const K = 2;", "fn f() { global::K }", "let a = f();"], "2"),
        (&["let a = if true { 4 } else { throw 1 };", "fn f(x) { return x; }", "a = f(a)"], "4"),
    ] {
        let mut console = Console::new(Scope::new());
        for input in inputs {
            let _ = console.run(&engine, input);
        }
        assert_eq!(run_saved(&console), expected, "{}", console.script());
    }
}

#[test]
fn functions_see_the_constants_of_earlier_inputs() {
    let engine = engine(Limits::STUDY);
    let mut console = Console::new(Scope::new());
    for input in ["const A = 3;", "let A = 5;", "fn f() { global::A }", "const B = f();"] {
        let _ = console.run(&engine, input).unwrap();
    }
    assert_eq!(console.run(&engine, "f() + B").unwrap().as_int(), Ok(6));
    let faults = console.run(&engine, "const C = 1; throw 1").unwrap_err();
    assert_eq!(faults[0].message, "1");
    assert!(console.run(&engine, "fn g() { global::C } g()").unwrap_err()[0].message.contains("global::C"));
}

#[test]
fn a_function_without_a_name_stays_where_its_input_ends_early() {
    let engine = engine(Limits::STUDY);
    let mut console = Console::new(Scope::new());
    let _ = console.run(&engine, "let f = |x| x;").unwrap();
    assert!(console.run(&engine, "f = |x| 2 * x;\nthrow 1").is_err());
    assert_eq!(console.run(&engine, "f.call(4)").unwrap().as_int(), Ok(8));
}

#[test]
fn a_session_ends_with_the_last_line_that_has_a_number() {
    let engine = engine(Limits::STUDY);
    let mut console = Console::new(Scope::new());
    let long = format!("let a = 1;{}a", "\n".repeat(MOST_LINES - 1));
    assert_eq!(console.run(&engine, &long).unwrap().as_int(), Ok(1));
    let faults = console.run(&engine, "a").unwrap_err();
    assert_eq!(faults[0].message, "a session has at most 65535 lines");
}

#[test]
fn files_are_run_with_their_modules_and_told_at_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("other")).unwrap();
    for name in ["m.rhai", "other/n.rhai"] {
        std::fs::write(at(name), "fn from_module() { 20 }").unwrap();
    }
    let mut engine = engine(Limits::STUDY);
    Session::of_engine(&engine).read_modules();
    Arguments::register(&mut engine);
    let mut console = Console::new(Scope::new());
    let mut load = |name: &str, text: &str| {
        let file = SourceText::new(at(name), text);
        let about = About::read(&file.file, text).unwrap();
        let args = Arguments::new(about.complete(&rhai::Map::new()));
        console.load(&engine, &file, &about, args).map_err(|faults| faults[0].to_string())
    };
    let text = "//! Study.\n//!\n//! --arg most=3  how many\n\nimport \"m\" as m;\nlet a = m::from_module() + args.most;\n\
        fn bad(x) {\n    x.nosuch\n}\na";
    assert_eq!(load("s.rhai", text).unwrap().as_int(), Ok(23));
    assert!(load("s.rhai", "1 +\n +").unwrap_err().contains("s.rhai:2:3: "));
    let refused = load("other/t.rhai", "import \"n\" as n;").unwrap_err();
    assert!(refused.contains("t.rhai:1:8: the modules of this session are in "), "{refused}");
    for (input, expected) in
        [("bad(1)", "s.rhai:8:7: "), ("import \"n\" as n;", "<input>:12:8: there is no module `n`")]
    {
        let told = console.run(&engine, input).unwrap_err()[0].to_string();
        assert!(told.contains(expected), "{told}");
    }
    assert_eq!(console.run(&engine, "m::from_module() + args.most").unwrap().as_int(), Ok(23));
    assert!(
        console.script().starts_with("//! Study.\n//!\n//! --arg most=3  how many\n\n\nimport"),
        "{}",
        console.script()
    );
    assert_eq!(console.folder(), Some(folder.path()));
    std::fs::remove_file(at("m.rhai")).unwrap();
    let gone = console.run(&engine, "1").unwrap_err().remove(0);
    assert!(gone.to_string().contains("s.rhai:5:8: there is no module `m`"), "{gone}");
}

#[test]
fn imports_stay_at_their_places() {
    let engine = engine(Limits::STUDY);
    Session::of_engine(&engine).ship(&[
        ShippedModule { name: "droptower/one", text: "fn one() { 1 }" },
        ShippedModule { name: "droptower/two", text: "fn two() { 2 }" },
    ]);
    let mut console = Console::new(Scope::new());
    let lines = "let a = 1;\n  import \"droptower/one\" as one;  import \"droptower/two\" as two;";
    for input in [lines, "let b = one::one() + two::two();"] {
        let _ = console.run(&engine, input).unwrap();
    }
    assert_eq!(console.run(&engine, "b").unwrap().as_int(), Ok(3));
    let kept = "\n  import \"droptower/one\" as one;  import \"droptower/two\" as two;\n\n\n";
    assert_eq!(console.transcript.imports_alone(), kept);
}
