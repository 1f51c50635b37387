//! What a run must give: the expectations, and the recorded figures and signals of an earlier run.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, split, with_files};
use lab::signal::csv;
use scene::expectation::{Expectations, Given, Recorded};
use scene::scenario::Document;

const FILES: [&str; 3] = ["expect.toml", "expected.csv", "signals.csv"];

fuzz_target!(|input: &[u8]| {
    with_files(&split(&FILES, input), |folder| {
        let [expectations, expected, signals] = FILES.map(|name| folder.join(name));
        let expectations = match Document::read_expectations(&expectations) {
            Ok(document) => Expectations::check(&document).map_err(|mistakes| show(&mistakes)),
            Err(mistakes) => Err(show(&mistakes)),
        };
        let (recorded, signals) = (csv::read(&expected), csv::read(&signals));
        if let (Ok(expectations), Ok(signals)) = (expectations, signals) {
            let figures = [("peak".to_owned(), 1.0.into())].into_iter().collect();
            let recorded = Recorded { signals: recorded.ok(), ..Recorded::default() };
            let given = Given { signals: &signals, figures: &figures };
            drop((expectations.differences(&recorded, &given), expectations.recorded(&given)));
        }
    });
});
