//! Findings that must or must not come.

use serde_json::{Map, Value};

use super::check::ALL;
use super::{Difference, Expectations};

/// Findings that did not come although they must, and those that came although they must not.
pub(super) fn differences(expectations: &Expectations, summary: &Map<String, Value>) -> Vec<Difference> {
    let Expectations { must, must_not, .. } = expectations;
    let found: Vec<[&str; 3]> =
        summary.get("findings").and_then(Value::as_array).into_iter().flatten().map(parts).collect();
    let lacking = must.iter().filter(|code| !found.iter().any(|[own, ..]| own == code));
    let lacking = lacking.map(|code| Difference::NoFinding { finding: code.clone() });
    let is_unwanted = |[code, severity, _]: &&[&str; 3]| {
        let named = |list: &[String]| list.iter().any(|own| own == code);
        let is_any = must_not.iter().any(|own| own == ALL) && *severity == "warning" && !named(must);
        named(must_not) || is_any
    };
    let unwanted = found.iter().filter(is_unwanted);
    let unwanted = unwanted.map(|[code, _, message]| Difference::UnexpectedFinding {
        finding: (*code).into(),
        message: (*message).into(),
    });
    lacking.chain(unwanted).collect()
}

/// Code, severity and message of a finding of a summary.
fn parts(finding: &Value) -> [&str; 3] {
    ["code", "severity", "message"].map(|name| finding[name].as_str().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn findings_come_or_do_not() {
        let finding = |code: &str, severity: &str| json!({ "code": code, "severity": severity, "message": "m" });
        let summary = json!({ "findings": [finding("a", "warning"), finding("b", "note"), finding("c", "warning")] });
        let Value::Object(summary) = summary else { panic!("an object") };
        let expect = |must: &[&str], must_not: &[&str]| {
            let list = |codes: &[&str]| codes.iter().map(|code| (*code).to_owned()).collect();
            let expectations = Expectations { must: list(must), must_not: list(must_not), ..Expectations::default() };
            let found = differences(&expectations, &summary);
            let code = |difference: Difference| match difference {
                Difference::NoFinding { finding } => format!("-{finding}"),
                Difference::UnexpectedFinding { finding, .. } => format!("+{finding}"),
                other => panic!("{other:?}"),
            };
            found.into_iter().map(code).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(expect(&["a", "d"], &["e"]), "-d");
        assert_eq!(expect(&["a"], &["b"]), "+b");
        assert_eq!(expect(&["a"], &["*"]), "+c");
        assert_eq!(expect(&[], &["*"]), "+a +c");
    }
}
