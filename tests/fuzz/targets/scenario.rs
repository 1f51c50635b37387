//! Scenarios, from their text to the checked model and back to a resolved text.
//!
//! Readers: src/scene/scenario src/scene/model
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_file};
use scene::model;
use scene::scenario::Document;

fuzz_target!(|input: &[u8]| {
    with_file("scenario.toml", input, |path| match Document::read(path) {
        Ok(document) => {
            let (_, mistakes) = document.scenario();
            let checked = model::check(&document).map_err(|mistakes| show(&mistakes));
            let varied = model::variation(&document).map_err(|mistakes| show(&mistakes));
            let texts = (show(&mistakes), document.resolved(), document.implausible(), document.named());
            drop((checked.is_ok(), varied.is_ok(), texts, document.name(), Document::sources(path)));
        }
        Err(mistakes) => drop(show(&mistakes)),
    });
});
