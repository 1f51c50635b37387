//! Pictures, PNG or JPEG, and the curve in them.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_files};
use scene::digitize::{Figure, digitize};
use scene::scenario::Document;

const FIGURE: &[u8] = include_bytes!("../corpus/figure/line.toml");

fuzz_target!(|input: &[u8]| {
    with_files(&[("figure.toml", FIGURE), ("line.png", input)], |folder| {
        let document = Document::read_figure(&folder.join("figure.toml")).expect("a document");
        match Figure::check(&document) {
            Ok(figure) => drop(digitize(&figure)),
            Err(mistakes) => drop(show(&mistakes)),
        }
    });
});
