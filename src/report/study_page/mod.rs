//! The page of a script over scenarios.

mod answer;
mod estimates;

use serde_json::{Map, Value};

use crate::html::{self, folded};
use crate::script_output::{self, Fold, counted};
use crate::{cell, figure};
use base::shell::quoted;
use study::script::ScriptOutput;

/// The content of the page of a study.
#[derive(Clone, Copy)]
pub struct StudyPage<'a> {
    /// The script's name.
    pub name: &'a str,
    /// Script, scenario, changes and arguments, as `summary.json` has them.
    pub call: &'a Map<String, Value>,
    /// The output of the script.
    pub output: &'a ScriptOutput,
    /// The script's text.
    pub script: &'a str,
    /// The modules that it imports: name and text.
    pub modules: &'a [(&'a str, &'a str)],
}

/// Most points of all plots of a page, which keep it below 3 MB.
const MOST_POINTS: usize = 120_000;

/// The answer of a study in a few sentences; none of a script that neither gives one nor searches.
pub fn study_answer(output: &ScriptOutput) -> Option<String> {
    answer::found(output, &estimates::estimates(output))
}

/// `report.html` of a study.
pub fn study_page(study: &StudyPage) -> String {
    let StudyPage { output, script, .. } = *study;
    let estimates = estimates::estimates(output);
    let lead = answer::found(output, &estimates).unwrap_or_else(|| answer::described(script));
    let measures = &output.measures;
    let parts = [
        html::findings(Vec::new(), &output.findings),
        answer::cards(measures, script),
        html::section("Measured and identified", &answer::curves(output)),
        html::section("Parameters", &answer::parameters(&estimates)),
        script_output::sections(output, MOST_POINTS, Fold::All),
        html::section("Figures", &folded(&counted(measures.len(), "figure"), &figure::table(measures.iter()))),
        html::section("Log", &folded(&counted(output.log.len(), "line"), &html::list(&output.log))),
        html::section("What was run", &run(study.call)),
        html::section("Script", &texts(study)),
        html::section("Run it again", &again(study.call)),
    ];
    html::finished(study.name, &lead, &parts)
}

/// The script and its modules.
fn texts(study: &StudyPage) -> String {
    let text = |name: &str, text: &str| {
        folded(&format!("{name}: {}", counted(text.lines().count(), "line")), &html::verbatim(text))
    };
    let modules = study.modules.iter().map(|(name, content)| text(&format!("Module {name}"), content));
    std::iter::once(text(study.name, study.script)).chain(modules).collect()
}

/// Script, scenario, changes and arguments, one line each.
fn run(call: &Map<String, Value>) -> String {
    let written = |value: &Value| match value {
        Value::Array(items) => items.iter().map(cell).collect::<Vec<_>>().join("  "),
        Value::Object(args) => args.iter().map(argument).collect::<Vec<_>>().join("  "),
        other => cell(other),
    };
    let rows = call.iter().map(|(name, value)| vec![name.clone(), written(value)]);
    html::table::<&str>(&[], &rows.filter(|row| !row[1].is_empty()).collect::<Vec<_>>())
}

fn argument((name, value): (&String, &Value)) -> String {
    format!("{name}={}", value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}

/// The command that repeats the study.
fn again(call: &Map<String, Value>) -> String {
    let text = |name: &str| call.get(name).and_then(Value::as_str);
    let changes = |name: &str| {
        let list = call.get(name).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
        list.map(|change| format!("--{name} {}", quoted(change))).collect::<Vec<String>>()
    };
    let arguments = call.get("args").and_then(Value::as_object).into_iter().flatten().map(argument);
    // A calibration in a file is no script.
    let is_study = text("script").is_some_and(|path| path.ends_with(".toml"));
    let command = if is_study { "calibrate" } else { "script" };
    let script = text("script").map(quoted);
    let scenario = text("scenario").map(|scenario| format!("--scenario {}", quoted(scenario)));
    let arguments = arguments.map(|argument| format!("--arg {}", quoted(&argument)));
    let words: Vec<String> =
        script.into_iter().chain(scenario).chain(changes("unset")).chain(changes("set")).chain(arguments).collect();
    format!(
        "<p>Where it was run, with droptower {}:</p>\n{}",
        env!("CARGO_PKG_VERSION"),
        html::verbatim(&format!("droptower {command} {}", words.join(" ")))
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::html::escape;
    use base::finding::Finding;
    use study::script::Warning;

    #[test]
    fn the_command_of_a_study_quotes_its_arguments() {
        let call = json!({
            "script": "scripts/identify.rhai", "scenario": "drop/1008.toml", "set": ["specimen.mesh.size=20 mm"], "unset": ["reference"],
            "args": { "start": "it's", "starts": 5 },
        });
        let html = again(call.as_object().unwrap());
        let command = "droptower script scripts/identify.rhai --scenario drop/1008.toml --unset reference \
                   --set 'specimen.mesh.size=20 mm' --arg 'start=it'\\''s' --arg starts=5";
        let text = html.replace("<span class=\"option\">", "").replace("</span>", "");
        assert!(text.contains(&escape(command)), "{html}");
    }

    #[test]
    fn a_page_warns_of_virtual_recordings() {
        let page = |recordings| {
            let findings = Warning::virtual_recordings(recordings).iter().map(Finding::new).collect();
            let output = ScriptOutput { findings, ..ScriptOutput::default() };
            study_page(&StudyPage { name: "identify", call: &Map::new(), output: &output, script: "", modules: &[] })
        };
        let warning = "VIRTUAL recordings, nothing was measured: drops/1008.csv";
        assert!(page(vec!["drops/1008.csv".into()]).contains(warning));
        assert!(!page(vec![]).contains("VIRTUAL"));
    }

    #[test]
    fn texts_of_a_script_are_escaped() {
        let output = ScriptOutput { log: vec!["<i>".into()], ..ScriptOutput::default() };
        let study = StudyPage {
            name: "<b>",
            call: &Map::new(),
            output: &output,
            script: "1 < 2",
            modules: &[("a<b", "fn f() { 3 < 4 }")],
        };
        let page = study_page(&study);
        assert!(["&lt;b&gt;", "&lt;i&gt;", "1 &lt; 2"].iter().all(|part| page.contains(part)) && !page.contains("<i>"));
    }
}
