//! What a run must give: the expectations, and the recorded figures and signals of an earlier run.
//!
//! Readers: src/scene/expectation src/scene/scenario/output.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, split, with_files};
use lab::signal::csv;
use scene::expectation::{Expectations, Given, Recorded};
use scene::scenario::Document;

const FILES: [&str; 4] = ["expect.toml", "expected.csv", "signals.csv", "expected.json"];

fuzz_target!(|input: &[u8]| {
    with_files(&split(&FILES, input), |folder| {
        let [expectations, expected, signals, figures] = FILES.map(|name| folder.join(name));
        let expectations = match Document::read_expectations(&expectations) {
            Ok(document) => Expectations::check(&document).map_err(|mistakes| show(&mistakes)),
            Err(mistakes) => Err(show(&mistakes)),
        };
        let recorded = Recorded::read(&expected, &figures).map_err(|mistake| show(&[mistake]));
        if let (Ok(expectations), Ok(recorded), Ok(signals)) = (expectations, recorded, csv::read(&signals)) {
            let figures = [("peak".to_owned(), 1.0.into())].into_iter().collect();
            let given = Given { signals: &signals, figures: &figures };
            drop((expectations.differences(&recorded, &given), expectations.recorded(&given)));
        }
    });
});
