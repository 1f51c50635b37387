//! Studies in files: what is read is a script that the interpreter takes, with a place for each of its lines.
//!
//! Readers: src/study/calibrate/file.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_file};
use rhai::Engine;
use study::calibrate::StudyFile;

fuzz_target!(|input: &[u8]| {
    with_file("study.toml", input, |path| match StudyFile::read(path) {
        Ok(study) => {
            let mut engine = Engine::new_raw();
            engine.set_max_expr_depths(0, 0);
            let program = engine.compile(&study.script);
            assert!(program.is_ok(), "{:?} in {}", program.err(), study.script);
            (0..=study.script.lines().count() + 1).for_each(|line| drop(study.place(line, "")));
        }
        Err(mistakes) => drop(show(&mistakes)),
    });
});
