//! docs/guide.md is correct: every file in it is written, every command run.

use std::fs;
use std::path::Path;

use crate::workbench::{droptower, error, figure, root, summary};

/// A coarser mesh for scripts, whose numbers are not compared with those in the guide.
const COARSE: [&str; 2] = ["--set", "specimen.mesh.size=10mm"];

/// Sizes in a script of the guide, and coarser ones that take their place.
const SIZES: [&str; 2] = ["[0.004, 0.003, 0.002, 0.0015]", "[0.01, 0.009, 0.008, 0.007]"];

/// Few snapshots: the guide prints none.
const FEW_SNAPSHOTS: [&str; 2] = ["--set", "output.frames=2"];

/// A block of the guide: its language and its lines.
struct Block {
    language: String,
    text: String,
}

fn blocks(guide: &str) -> Vec<Block> {
    let fenced = guide.split("\n```").enumerate().filter(|(part, _)| part % 2 == 1);
    let block = |(_, text): (usize, &str)| {
        let (language, text) = text.split_once('\n').expect("a block has lines");
        Block { language: language.to_owned(), text: format!("{text}\n") }
    };
    fenced.map(block).collect()
}

/// The name of the file that a block is, from its first line: `# dart.toml: …` or `// mesh.rhai: …`.
fn file_name(block: &Block) -> Option<&str> {
    let first = block.text.lines().next()?.trim_start_matches(['#', '/', ' ']);
    let name = first.split([':', ' ']).next()?;
    name.ends_with(&format!(".{}", block.language)).then_some(name)
}

/// Runs the commands of a block; a run whose results are in the guide prints them.
fn run(folder: &Path, block: &Block) {
    let (commands, results): (Vec<&str>, Vec<&str>) = block.text.lines().partition(|line| line.starts_with('$'));
    for command in commands {
        let command = command.strip_prefix("$ droptower ").expect("a command of droptower");
        let words: Vec<&str> = command.split_whitespace().collect();
        let has_results = words[0] == "run" && !results.is_empty();
        let changes = match words[0] {
            "run" => FEW_SNAPSHOTS.to_vec(),
            "script" if words[1] == "failure-mass" => [&COARSE[..], &FEW_SNAPSHOTS, &["--arg", "range=0"]].concat(),
            "script" => [COARSE, FEW_SNAPSHOTS].concat(),
            _ => vec![],
        };
        let output = droptower(folder, &[words.clone(), changes].concat());
        assert!(output.status.success(), "droptower {command}\n{}", error(&output));
        let printed = String::from_utf8_lossy(&output.stdout);
        let expected = if has_results { &results[..] } else { &[] };
        for line in expected {
            assert!(printed.lines().any(|found| found == *line), "{line}\nis not in\n{printed}");
        }
    }
}

#[test]
fn every_command_of_the_guide_succeeds() {
    let guide = fs::read_to_string(root().join("docs/guide.md")).expect("the guide");
    let folder = tempfile::tempdir().expect("a folder");
    let blocks = blocks(&guide);
    let files: Vec<_> = blocks.iter().filter_map(|block| Some((file_name(block)?, &block.text))).collect();
    let [own, coarse] = SIZES;
    assert_eq!(files.iter().filter(|(_, text)| text.contains(own)).count(), 1);
    for (name, text) in &files {
        fs::write(folder.path().join(name), text.replace(own, coarse)).expect("a file of the guide");
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    assert!(names.contains(&"dart.toml") && names.contains(&"mesh.rhai"), "{names:?}");

    let sessions: Vec<&Block> = blocks.iter().filter(|block| block.language == "console").collect();
    assert!(sessions.len() >= 5);
    sessions.iter().for_each(|session| run(folder.path(), session));

    let summary = summary(&folder.path().join("runs/failure-mass"));
    let mass = figure(&summary, "failure_mass_kg");
    assert!((0.03..0.12).contains(&mass), "{mass} kg");
    assert!(summary["tables"]["drops"].as_array().is_some_and(|drops| drops.len() >= 20));
}
