//! Cards of other solvers, and the material that follows from them.
//!
//! Readers: src/card/read
#![no_main]

use libfuzzer_sys::fuzz_target;

use card::System;
use card::read::{material, read};
use droptower_fuzz::{show, with_file};
use scene::model;
use scene::scenario::Document;

fuzz_target!(|input: &[u8]| {
    let Ok(text) = std::str::from_utf8(input) else { return };
    for system in [System::TMmS, System::LbfInS] {
        match read(text, system, None) {
            Ok(found) => with_file("film.toml", material(&found.film, 12e-6, &[]).as_bytes(), |path| {
                match Document::read_material(path) {
                    Ok(document) => drop(model::check_material(&document).map_err(|mistakes| show(&mistakes))),
                    Err(mistakes) => panic!("no material: {}", show(&mistakes)),
                }
            }),
            Err(mistake) => drop(mistake.message),
        }
    }
});
