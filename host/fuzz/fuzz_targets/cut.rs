//! Any bytes as the mesh of a robot's link, and a skin cut out of it: all its nodes are numbers.
#![no_main]

use dermatome::{
    cut::{Region, Request, cut},
    mesh::import::{Format, parse},
};
use libfuzzer_sys::fuzz_target;
use nalgebra::Point3;

/// Larger meshes only slow the search down.
const MOST_TRIANGLES: usize = 1000;

fuzz_target!(|input: (u8, f64, &[u8])| {
    let (kind, radius, bytes) = input;
    let formats = [Format::Stl, Format::Obj, Format::Ply, Format::Msh];
    let Ok(link) = parse(formats[usize::from(kind % 4)], bytes, None) else { return };
    if link.triangles.len() > MOST_TRIANGLES {
        return;
    }
    let request = Request {
        around: Point3::origin(),
        region: Region::Disc { radius },
        up: None,
        electrodes: 8,
        width: None,
        edge_length: None,
    };
    if let Ok(cutout) = cut(&link, &request) {
        assert!(cutout.mesh.nodes.iter().all(|node| node.iter().all(|x| x.is_finite())));
    }
});
