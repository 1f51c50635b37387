//! Shipped scripts are without mistakes; what a script says of itself is in `tests/cmd/script-help.trycmd`.

use crate::workbench::{droptower, printed, root};

#[test]
fn every_shipped_script_is_without_mistakes() {
    for script in glob::glob(root().join("scripts/*.rhai").to_str().expect("UTF-8")).expect("a pattern").flatten() {
        let script = script.to_str().expect("UTF-8").to_owned();
        printed(&droptower(&root(), &["script", "--check", &script]));
    }
}
