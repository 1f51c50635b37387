//! The page of a script over scenarios.

use serde_json::{Map, Value};

use super::html::{self, escape};
use super::{cell, figure, findings};
use crate::script::Findings;

/// What the page of a study is made of.
#[derive(Clone, Copy)]
pub struct StudyPage<'a> {
    /// The script's name.
    pub name: &'a str,
    /// Script, scenario, changes and arguments, as `summary.json` has them.
    pub call: &'a Map<String, Value>,
    pub findings: &'a Findings,
    /// The script's text.
    pub script: &'a str,
}

/// `report.html` of a study.
pub fn study_page(study: &StudyPage) -> String {
    let body = [
        format!("<h1>{}</h1>\n", escape(study.name)),
        html::section("What was run", &html::table("rows", &[], &call(study.call))),
        html::section("Figures", &figure::table(study.findings.measures.iter())),
        findings::sections(study.findings),
        html::section("Log", &html::list(&study.findings.log)),
        html::section("Script", &html::verbatim(study.script)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(study.name, &body.concat())
}

fn call(call: &Map<String, Value>) -> Vec<Vec<String>> {
    let written = |value: &Value| match value {
        Value::Array(items) => items.iter().map(cell).collect::<Vec<_>>().join("  "),
        Value::Object(args) => {
            let args = args.iter().map(|(name, value)| format!("{name}={}", cell(value)));
            args.collect::<Vec<_>>().join("  ")
        }
        other => cell(other),
    };
    let rows = call.iter().map(|(name, value)| vec![name.clone(), written(value)]);
    rows.filter(|row| !row[1].is_empty()).collect()
}
