//! The picture of `cut`: where on its link the skin lies.

use anyhow::Context;
use dermatome_geometry::{cut::Cutout, mesh::import::Imported};
use dermatome_view::placed::{Placed, placed};

/// The link, in m, and the skin that was cut out of it, as PNG.
pub(super) fn png(name: &str, frame: &str, link: &Imported, skin: &Cutout) -> anyhow::Result<Vec<u8>> {
    let skin_from_link = skin.link_from_skin.inverse();
    let nodes: Vec<_> = link.nodes.iter().map(|node| skin_from_link * node).collect();
    let corners: Vec<_> = link.triangles.iter().map(|triangle| triangle.map(|node| nodes[node])).collect();
    let [x, y, z] = skin.link_from_skin.translation.vector.map(|metres| metres * 1e3).into();
    let title = [
        format!("{name} on {frame}"),
        format!("seen along the skin's normal; its origin at ({x:.1}, {y:.1}, {z:.1}) mm of {frame}"),
    ];
    let scene = Placed { title: &title, link: &corners, skin: &skin.mesh, beneath: skin.deviation };
    placed(&scene).encode().context("cannot encode the picture")
}
