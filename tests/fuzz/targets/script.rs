//! Scripts under their limits, with the functions that read files and those that leave results.
//!
//! Readers: src/study/script
#![no_main]

use libfuzzer_sys::fuzz_target;

use std::time::Duration;

use droptower_fuzz::with_file;
use rhai::Scope;
use study::functions::{engine, register_output, register_reading};
use study::script::{About, Limits, OutputCollector, Script};

const LIMITS: Limits = Limits { operations: 5_000, bytes: 64 << 20, time: Duration::from_secs(1) };

fuzz_target!(|text: &str| {
    with_file("study.rhai", text.as_bytes(), |path| {
        drop(About::read(path, text));
        let (mut engine, collector) = (engine(LIMITS), OutputCollector::new(vec![]));
        register_reading(&mut engine);
        register_output(&mut engine, &collector);
        match Script::read(&engine, &Scope::new(), path) {
            Ok(script) => drop(script.run(&engine, Scope::new()).map_err(|fault| fault.to_string())),
            Err(error) => drop(error.to_string()),
        }
    });
});
