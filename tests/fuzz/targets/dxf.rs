//! Outlines in DXF.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use scene::mesh::import;

fuzz_target!(|input: &[u8]| {
    with_file("outline.dxf", input, |path| {
        for unit in [None, Some(1e-3)] {
            match import::polygon(path, unit) {
                Ok(polygon) => drop(polygon.check([false, true]).map_err(|fault| fault.to_string())),
                Err(fault) => drop(fault.to_string()),
            }
        }
    });
});
