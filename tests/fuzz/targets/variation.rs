//! The table of the points of a sweep, which a scenario names.
//!
//! Readers: src/scene/scenario/variation.rs src/scene/model/variation
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_files};
use scene::model;
use scene::scenario::Document;

const SCENARIO: &[u8] = include_bytes!("../corpus/scenario/stretch.toml");
const VARIATION: &[u8] = b"\n[variation]\ntable = \"table.csv\"\n";

fuzz_target!(|input: &[u8]| {
    let scenario = [SCENARIO, VARIATION].concat();
    with_files(&[("scenario.toml", &scenario), ("table.csv", input)], |folder| {
        let document = Document::read(&folder.join("scenario.toml")).expect("a scenario");
        match model::variation(&document) {
            Ok(Some(variation)) => {
                let points = variation.points(None).map_err(|mistake| show(&[mistake]));
                drop(points.map(|points| variation.assignments(&variation.point(&points, 0))));
            }
            Ok(None) => {}
            Err(mistakes) => drop(show(&mistakes)),
        }
    });
});
