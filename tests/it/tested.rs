//! The page of `droptower test`; what it prints is in `tests/cmd/test-records.trycmd`.

use std::fs;

use crate::workbench::{droptower, printed, printed_text};

#[test]
fn a_page_draws_the_corridor_that_a_signal_leaves() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    printed(&droptower(folder.path(), &["new", "drop", "drop.toml"]));
    fs::create_dir(folder.path().join("case")).expect("a folder");
    let changes = "specimen.mesh.size = \"80 mm\"\nloading.impact.duration = \"10 ms\"\n";
    put("case/scenario.toml", &format!("extends = \"../drop.toml\"\n{changes}"));
    put("case/expect.toml", "signals.displacement_m.corridor = \"corridor.csv\"");
    put("case/corridor.csv", "time_s,lower,upper\n0,-0.001,0.001\n0.01,-0.001,0.001\n");
    let text = printed_text(&droptower(folder.path(), &["test", "case"]));
    assert!(text.contains("expected -0.001 to 0.001"), "{text}");
    let page = fs::read_to_string(folder.path().join("runs/test/report.html")).expect("a page");
    assert!(["new", "lower", "upper"].iter().all(|curve| page.contains(&format!("\"name\":\"{curve}\""))));
}
