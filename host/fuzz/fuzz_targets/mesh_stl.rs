//! Any bytes as a mesh file, see `mesh.rs`.
#![no_main]

mod mesh;

use dermatome::mesh::import::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| mesh::check(Format::Stl, bytes));
