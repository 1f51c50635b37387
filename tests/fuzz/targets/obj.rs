//! Meshes in OBJ, as film and as the surface of an impactor.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use scene::mesh::Element;
use scene::mesh::import;

fuzz_target!(|input: &[u8]| {
    with_file("mesh.obj", input, |path| {
        let extent = import::extent(path).map_err(|error| error.to_string());
        if extent.is_ok() {
            for (mirrored, element) in [([false, false], Element::Tri3), ([true, true], Element::Quad4)] {
                drop(import::film(path, 1e-3, mirrored, element).map_err(|error| error.to_string()));
            }
            drop(import::surface(path).map_err(|error| error.to_string()));
        }
    });
});
