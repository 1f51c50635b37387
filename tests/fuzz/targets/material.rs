//! Materials: their laws and curves as they are checked.
//!
//! Readers: src/scene/scenario/material.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_file};
use scene::model;
use scene::scenario::Document;

fuzz_target!(|input: &[u8]| {
    with_file("film.toml", input, |path| match Document::read_material(path) {
        Ok(document) => {
            let checked = model::check_material(&document).map_err(|mistakes| show(&mistakes));
            drop((checked.is_ok(), document.implausible(), document.resolved()));
        }
        Err(mistakes) => drop(show(&mistakes)),
    });
});
