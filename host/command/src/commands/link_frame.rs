//! The link's frame: which pose contacts of a patch's skin have on a robot.

use anyhow::{Context, bail, ensure};
use dermatome_geometry::mesh::Lattice;
use dermatome_model::{
    model::{mesh, pixels_on},
    skin::{Pose, Skin},
};
use dermatome_patch::tables::SurfaceTables;
use nalgebra::Point3;
use std::path::Path;

/// How far a pixel of the patch may lie from where the skin file has it, m.
const SAME_PLACE: f64 = 1e-4;

/// The skin in `path`, which must be that of a patch with this name and these pixels, and its pose.
pub(super) fn skin_of(
    path: &Path,
    of_patch: &str,
    pixels: impl FnOnce() -> anyhow::Result<SurfaceTables>,
) -> anyhow::Result<(Skin, Pose)> {
    let (skin, pose) = on_link(path)?;
    check(path, &skin, of_patch, pixels)?;
    Ok((skin, pose))
}

/// The skin in `path`, which must say where it lies, and its pose.
pub(super) fn on_link(path: &Path) -> anyhow::Result<(Skin, Pose)> {
    let skin = Skin::load(path)?.made()?;
    let Some(pose) = skin.pose.clone() else {
        bail!(
            "skin file `{}`: `pose` is missing; allowed: a table `[pose]` as `dermatome cut` writes it",
            path.display()
        );
    };
    Ok((skin, pose))
}

/// Whether the skin in `path` is that of a patch with this name and these pixels.
pub(super) fn check(
    path: &Path,
    skin: &Skin,
    of_patch: &str,
    pixels: impl FnOnce() -> anyhow::Result<SurfaceTables>,
) -> anyhow::Result<()> {
    let file = path.display();
    let name = &skin.name;
    ensure!(
        name == of_patch,
        "skin file `{file}`: `name` is {name:?}; allowed: {of_patch:?}, the skin of the patch"
    );
    let in_patch = pixels()?;
    let in_file = surface(skin).with_context(|| format!("skin file `{file}`"))?;
    ensure!(
        in_file.is_some_and(|in_file| is_same(&in_file, &in_patch)),
        "skin file `{file}`: its pixels do not lie where those of the patch do, so neither would contacts: give the skin file \
         that the patch was built from, or build it anew"
    );
    Ok(())
}

/// Where the pixels of a skin lie; nothing where they are more than a board takes.
fn surface(skin: &Skin) -> anyhow::Result<Option<SurfaceTables>> {
    let mesh = mesh(skin, 1.0, Lattice::default())?;
    Ok(pixels_on(skin, &mesh)?.surface_tables())
}

fn is_same(a: &SurfaceTables, b: &SurfaceTables) -> bool {
    let apart = |a: [f64; 3], b: [f64; 3]| (Point3::from(a) - Point3::from(b)).norm();
    let is_near = a.centres().zip(b.centres()).all(|(a, b)| apart(a, b) < SAME_PLACE);
    a.pixels.len() == b.pixels.len() && is_near
}
