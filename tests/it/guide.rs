//! docs/guide.md works as it stands: every file in it is written, every command run.

use std::fs;
use std::path::Path;

use crate::workbench::{droptower, error, root};

/// A coarser mesh and few pictures: the guide's own take a minute.
const SHORTENED: [&str; 4] = ["--set", "specimen.mesh.size=8mm", "--set", "output.frames=2"];

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

fn run(folder: &Path, command: &str) {
    let mut words: Vec<&str> = command.split_whitespace().collect();
    if ["run", "script"].contains(&words[0]) {
        words.extend(SHORTENED);
    }
    let output = droptower(folder, &words);
    assert!(output.status.success(), "droptower {command}\n{}", error(&output));
}

#[test]
fn every_file_and_command_of_the_guide_works() {
    let guide = fs::read_to_string(root().join("docs/guide.md")).expect("the guide");
    let folder = tempfile::tempdir().expect("a folder");
    let blocks = blocks(&guide);
    let files: Vec<_> = blocks.iter().filter_map(|block| Some((file_name(block)?, &block.text))).collect();
    for (name, text) in &files {
        fs::write(folder.path().join(name), text).expect("a file of the guide");
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    assert!(names.contains(&"dart.toml") && names.contains(&"staircase.rhai"), "{names:?}");

    let commands = blocks.iter().filter(|block| block.language == "console").flat_map(|block| block.text.lines());
    let commands: Vec<&str> = commands.filter_map(|line| line.strip_prefix("$ droptower ")).collect();
    assert!(commands.len() >= 8, "{commands:?}");
    commands.iter().for_each(|command| run(folder.path(), command));

    let summary = fs::read(folder.path().join("runs/staircase/summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_slice(&summary).expect("JSON");
    let mass = summary["failure_mass_kg"].as_f64().expect("a failure mass");
    assert!((0.03..0.12).contains(&mass), "{mass} kg");
    assert_eq!(summary["tables"]["drops"].as_array().map(Vec::len), Some(20));
}
