//! The table of a curve that a material names.
//!
//! Readers: src/scene/scenario/curve_file.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_files};
use scene::model;
use scene::scenario::Document;

const MATERIAL: &[u8] = b"density = \"920 kg/m3\"\nthickness = \"12 um\"\n[fabric]\nmd = { curve = \"curve.csv\" }\n    td = { curve = \"curve.csv\" }\nshear = { curve = \"curve.csv\" }\n";

fuzz_target!(|input: &[u8]| {
    with_files(&[("film.toml", MATERIAL), ("curve.csv", input)], |folder| {
        match Document::read_material(&folder.join("film.toml")) {
            Ok(document) => drop(model::check_material(&document).map_err(|mistakes| show(&mistakes))),
            Err(mistakes) => drop(show(&mistakes)),
        }
    });
});
