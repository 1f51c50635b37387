//! The repository's own tests of whole runs: `droptower test tests/golden`.

use crate::workbench::{droptower, error, printed_text, root};

/// `DROPTOWER_BLESS=1` records the runs anew; where a case fails, `target/golden/report.html` shows new over recorded.
#[test]
fn golden_cases_agree_with_their_recordings() {
    let is_blessed = std::env::var_os("DROPTOWER_BLESS").is_some_and(|value| value == "1");
    let bless: &[&str] = if is_blessed { &["--bless"] } else { &[] };
    let arguments = [&["test", "tests/golden", "--out", "target/golden", "--force"], bless].concat();
    let output = droptower(&root(), &arguments);
    assert!(output.status.success(), "{}\n{}", printed_text(&output), error(&output));
}
