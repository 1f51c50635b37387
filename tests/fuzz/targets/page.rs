//! Pages that are read back: plots, and the film as a scene.
//!
//! Readers: src/report/stored.rs src/report/drawn.rs src/report/film_data.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use report::StoredPage;

fuzz_target!(|input: &[u8]| {
    with_file("report.html", input, |path| match StoredPage::read(path) {
        Ok(page) => drop(page.scene()),
        Err(error) => drop(error.message),
    });
});
