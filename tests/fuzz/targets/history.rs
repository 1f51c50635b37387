//! The trials of a search on disk.
//!
//! Readers: src/study/identify/pool
#![no_main]

use libfuzzer_sys::fuzz_target;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use droptower_fuzz::with_folder;
use study::identify::{History, Identity};

fuzz_target!(|input: &[u8]| {
    with_folder(|folder| {
        let open = |place: &Path| History::open(place, &Identity::default(), 1, BTreeMap::new());
        let path = open(folder).expect("a new history").path().to_path_buf();
        let head = fs::read(&path).expect("the first line");
        fs::write(&path, [&head, input].concat()).expect("a history");
        drop(open(folder).map(|history| history.trials().len()).map_err(|error| error.to_string()));
    });
});
