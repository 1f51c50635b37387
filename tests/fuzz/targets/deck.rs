//! Meshes in decks of other solvers, and the mesh file that follows from them.
#![no_main]

use libfuzzer_sys::fuzz_target;

use card::System;
use card::read::mesh::Reader;
use droptower_fuzz::with_file;
use membrane::engine::Mesh;
use scene::mesh::{Element, export, import};

fuzz_target!(|input: &[u8]| {
    let Ok(text) = std::str::from_utf8(input) else { return };
    // Two texts: a deck, and what it includes.
    let (deck, included) = text.split_once('\u{1}').unwrap_or((text, ""));
    for part in [None, Some("1"), Some("film")] {
        let mut reader = Reader::new(System::TMmS);
        for (file, text) in [deck, included].into_iter().enumerate() {
            match reader.read(text, file) {
                Ok(includes) => includes.iter().for_each(|include| assert!(include.place.line > 0)),
                Err(mistake) => drop(mistake.fault.to_string()),
            }
        }
        match reader.mesh(part) {
            Ok(found) => {
                assert!(
                    found
                        .quads
                        .iter()
                        .flatten()
                        .chain(found.tris.iter().flatten())
                        .all(|node| (*node as usize) < found.nodes.len())
                );
                let nodes = found.nodes.into_iter().map(Into::into).collect();
                let mesh = Mesh { nodes, quads: found.quads, tris: found.tris, ..Mesh::default() };
                with_file("film.vtu", export::vtu(&mesh).as_bytes(), |path| {
                    drop(import::film(path, 1.0, [false; 2], Element::Quad4).map_err(|error| error.to_string()));
                });
            }
            Err(error) => drop(error.mistake.fault.to_string()),
        }
    }
});
