//! Run folders that are read back and compared.
//!
//! Readers: src/study/store/stored_run.rs src/study/post
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{split, with_files};
use study::post::RunComparison;
use study::store::StoredRun;

const FILES: [&str; 4] = ["signals.csv", "summary.json", "scenario.toml", "failure.txt"];

fuzz_target!(|input: &[u8]| {
    with_files(&split(&FILES, input), |folder| match StoredRun::read(folder) {
        Ok(run) => {
            let other = StoredRun { place: "other".into(), ..run.clone() };
            let comparison = RunComparison::from_runs(&[run, other], &[]);
            drop((comparison.title(), comparison.summary()));
        }
        Err(error) => drop(error.to_string()),
    });
});
