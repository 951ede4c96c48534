//! A patch cut out of a link of 50,000 triangles and more: `cargo bench -p dermatome --bench cut`.

use dermatome::{
    cut::{Region, Request, cut},
    mesh::import::{Format, Imported, parse},
};
use divan::{Bencher, black_box};
use nalgebra::Point3;
use std::f64::consts::TAU;

fn main() {
    divan::main();
}

/// A tube that narrows, as an STL file holds it, in metres.
fn stl(triangles: usize) -> Vec<u8> {
    let around = (triangles as f64).sqrt() as usize;
    let rows = triangles.div_ceil(2 * around);
    let at = |i: usize, j: usize| {
        let (share, turn) = (i as f64 / rows as f64, TAU * (j % around) as f64 / around as f64);
        let radius = 0.055 - 0.017 * share + 0.001 * (5.0 * turn + 9.0 * share).sin();
        [radius * turn.cos(), radius * turn.sin(), 0.26 * share.powf(1.5)]
    };
    let quads = (0..rows).flat_map(|i| (0..around).map(move |j| (i, j)));
    let corners = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    let mut bytes = vec![0; 80];
    bytes.extend(((2 * rows * around) as u32).to_le_bytes());
    for corners in corners {
        bytes.extend([0; 12]);
        corners.iter().flatten().for_each(|it| bytes.extend((*it as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn read(bytes: &[u8]) -> Imported {
    parse(Format::Stl, bytes, None).expect("the file is sound")
}

#[divan::bench(args = [50_000, 500_000], max_time = 20)]
fn read_and_cut(bencher: Bencher<'_, '_>, triangles: usize) {
    let bytes = stl(triangles);
    let request = Request {
        around: Point3::new(-0.05, 0.0, 0.11),
        region: Region::Disc { radius: 0.04 },
        up: None,
        electrodes: 16,
        width: None,
        edge_length: None,
    };
    bencher.bench_local(|| cut(black_box(&read(&bytes)), &request).expect("a disc fits"));
}
