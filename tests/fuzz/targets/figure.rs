//! The file about a curve in a picture, and the curve that follows.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_files};
use scene::digitize::{Figure, digitize};
use scene::scenario::Document;

const PICTURE: &[u8] = include_bytes!("../corpus/picture/line.png");

fuzz_target!(|input: &[u8]| {
    with_files(&[("figure.toml", input), ("line.png", PICTURE)], |folder| {
        let figure = Document::read_figure(&folder.join("figure.toml"));
        match figure.and_then(|document| Figure::check(&document)) {
            Ok(figure) => drop(digitize(&figure)),
            Err(mistakes) => drop(show(&mistakes)),
        }
    });
});
