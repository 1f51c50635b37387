//! Meshes in the format of Gmsh.
//!
//! Readers: src/scene/mesh/import/msh.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_mesh;

fuzz_target!(|input: &[u8]| read_mesh("mesh.msh", input));
