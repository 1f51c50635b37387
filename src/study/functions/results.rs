//! Figures, tables, lines of the log and warnings.

use rhai::{Array, Dynamic, Engine, Map};

use crate::script::{Entry, HostResult, OutputCollector, Row, refuse, to_json};
use base::finding::Finding;

/// Offers `answer`, `measure`, `table`, `log`, `print` and `warn` to scripts.
pub(super) fn register(collector: &OutputCollector, engine: &mut Engine) {
    let own = collector.clone();
    engine.register_fn("answer", move |sentence: &str| own.answer(sentence));
    let own = collector.clone();
    engine
        .register_fn("measure", move |name: &str, value: Dynamic| own.measure(name, to_json(&value)?).map_err(refuse));
    let own = collector.clone();
    engine
        .register_fn("table", move |name: &str, rows: Dynamic| own.table(name, rows_of(&rows, None)?).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("table", move |name: &str, columns: Array, rows: Dynamic| {
        own.table(name, rows_of(&rows, Some(&columns))?).map_err(refuse)
    });
    let own = collector.clone();
    engine.register_fn("log", move |line: Dynamic| own.log(&line.to_string()).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("warn", move |code: &str, text: &str| own.warn(code, text).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("warn", move |finding: Map| own.report(finding_of(finding)?).map_err(refuse));
    let own = collector.clone();
    // The interpreter's own `print` cannot return an error: it drops lines past the limit.
    engine.on_print(move |line| drop(own.log(line)));
}

fn finding_of(map: Map) -> HostResult<Finding> {
    let finding = serde_json::from_value(to_json(&map.into())?);
    finding.map_err(|error| refuse(format!("a finding is a map with `code`, `severity` and `message`: {error}")))
}

fn rows_of(rows: &Dynamic, columns: Option<&Array>) -> HostResult<Vec<Row>> {
    if let Some(map) = rows.read_lock::<Map>() {
        return Ok(vec![row_of(&map, columns)?]);
    }
    let Some(rows) = rows.read_lock::<Array>() else {
        return Err(refuse(format!("a table is a map or a list of maps, not {}", rows.type_name())));
    };
    let row = |row: &Dynamic| match row.read_lock::<Map>() {
        Some(map) => row_of(&map, columns),
        None => Err(refuse(format!("a row of a table is a map, not {}", row.type_name()))),
    };
    rows.iter().map(row).collect()
}

fn row_of(map: &Map, columns: Option<&Array>) -> HostResult<Row> {
    let Some(columns) = columns else {
        return map.iter().map(|(key, value)| Ok((key.to_string(), to_json(value)?))).collect();
    };
    let column = |column: &Dynamic| {
        let name = column.to_string();
        let value = map.get(name.as_str()).ok_or_else(|| refuse(format!("a row has no `{name}`")))?;
        Ok((name, to_json(value)?))
    };
    columns.iter().map(column).collect()
}

/// The reference of these functions.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "answer(text)",
        gives: "the answer in one or two sentences, with which terminal and report begin; `answer` of the summary",
        example: r#"answer("The film holds up to 169 g.")"#,
    },
    Entry {
        call: "measure(name, value)",
        gives: "adds a figure to the summary; its name has letters, digits and _",
        example: r#"measure("stopping_distance_m", 0.17)"#,
    },
    Entry {
        call: "table(name, rows)",
        gives: "adds a table to the summary; rows are a map or a list of maps; columns in alphabetical order",
        example: r#"table("coefficients", #{ k1: 2.75, ke: 3.41 })"#,
    },
    Entry {
        call: "table(name, columns, rows)",
        gives: "the same with the columns in the order given",
        example: r#"table("tests", ["test", "k1"], [#{ k1: 2.75, test: 1008 }])"#,
    },
    Entry {
        call: "log(text)",
        gives: "a line for terminal and report; `print` does the same",
        example: r#"log("loading took " + 57 + " ms"); print("done")"#,
    },
    Entry {
        call: "warn(code, text)",
        gives: "a warning for terminal, report, recording and summary (`findings`, `warnings`); the code names its kind: \
                lower-case words joined by hyphens",
        example: r#"let peak = 812.0; if peak > 500 { warn("hard-impact", `the peak of ${peak} m/s² exceeds 500 m/s²`); }"#,
    },
    Entry {
        call: "warn(finding)",
        gives: "the same with a finding of a search, or another map with `code`, `severity` (\"note\" or \"warning\"), \
                `message` and figures",
        example: r#"warn(#{ code: "hard-impact", severity: "note", message: "the peak exceeds 500 m/s²", peak_m_s2: 812.0 })"#,
    },
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::Scope;

    use crate::functions::{engine, register_output};
    use crate::script::{Fault, Limits, OutputCollector, Script, ScriptOutput};
    use base::finding::Finding;

    fn run(text: &str) -> Result<ScriptOutput, Fault> {
        let (mut engine, scope) = (engine(Limits { operations: 30_000, ..Limits::STUDY }), Scope::new());
        let collector = OutputCollector::new(vec!["steps".into()]);
        register_output(&mut engine, &collector);
        let script = Script::compile(&engine, &scope, Path::new("s.rhai"), text);
        script.map_err(|mut faults| faults.remove(0))?.run(&engine, scope)?;
        Ok(collector.output())
    }

    #[test]
    fn an_endless_log_is_stopped() {
        assert!(run("loop { print(\"x\"); log(\"y\"); }").is_err());
        assert!(run("loop { warn(\"x\", \"y\"); }").is_err());
    }

    #[test]
    fn a_warning_is_a_finding_with_the_code_of_the_script() {
        let found = run("log(\"warning: of the log\"); warn(\"hard-impact\", \"the peak exceeds 500 m/s²\")").unwrap();
        assert_eq!(found.findings, [Finding::of_script("hard-impact", "the peak exceeds 500 m/s²")]);
        assert_eq!(found.log, ["warning: of the log"], "a line of the log is no warning, whatever it says");
        let fault = run("let a = 1;\n  warn(\"Hard impact\", \"x\")").unwrap_err();
        assert!(fault.message.starts_with("`Hard impact` is not the code of a warning: use lower-case"), "{fault}");
        assert_eq!((fault.line, fault.column), (2, 3));
    }

    #[test]
    fn a_finding_keeps_severity_and_figures() {
        let map = "#{ code: \"late\", severity: \"note\", message: \"the peak is late\", time_s: 0.5, index: 2 }";
        let found = run(&format!("warn({map}); warn({map} + #{{ message: `a: ${{{map}.message}}` }})")).unwrap();
        let json = serde_json::json!([
            { "code": "late", "severity": "note", "message": "the peak is late", "time_s": 0.5, "index": 2 },
            { "code": "late", "severity": "note", "message": "a: the peak is late", "time_s": 0.5, "index": 2 },
        ]);
        assert_eq!(serde_json::to_value(&found.findings).unwrap(), json);
        for (text, expected) in [
            ("warn(#{ severity: \"note\", message: \"x\" })", "missing field `code`"),
            ("warn(#{ code: \"x\", severity: \"grave\", message: \"x\" })", "unknown variant `grave`"),
            ("warn(#{ code: \"X Y\", severity: \"note\", message: \"x\" })", "`X Y` is not the code"),
        ] {
            assert!(run(text).unwrap_err().message.contains(expected), "{text}");
        }
    }

    #[test]
    fn names_are_checked() {
        assert!(run("measure(\"a b\", 1)").unwrap_err().message.contains("use letters, digits and _"));
        assert!(run("measure(\"../x\", 1)").is_err());
        assert!(run("table(\"ä\", [])").is_err());
        assert!(run("measure(\"steps\", 1)").unwrap_err().message.contains("cannot be replaced"));
    }

    #[test]
    fn figures_keep_their_order_and_kind() {
        let found = run("measure(\"b\", 1); measure(\"a\", 0.5); measure(\"n\", 0.0/0.0); measure(\"t\", \"x\");
             table(\"rows\", [\"test\", \"k1\"], [#{ k1: 2, test: \"1008\" }]); print(1.5);")
        .unwrap();
        let measures = serde_json::to_string(&found.measures).unwrap();
        assert_eq!(measures, r#"{"b":1,"a":0.5,"n":null,"t":"x"}"#);
        assert_eq!(serde_json::to_string(&found.tables[0].1).unwrap(), r#"[{"test":"1008","k1":2}]"#);
        assert_eq!(found.log, ["1.5"]);
    }
}
