//! Studies in files: whatever is read has tests and parameters, and mistakes are shown.
//!
//! Readers: src/study/calibrate/file.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_file};
use study::calibrate::StudyFile;

fuzz_target!(|input: &[u8]| {
    with_file("study.toml", input, |path| match StudyFile::read(path) {
        Ok(study) => drop(study.place()),
        Err(mistakes) => drop(show(&mistakes)),
    });
});
