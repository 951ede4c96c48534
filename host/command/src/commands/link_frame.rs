//! The link's frame: which pose contacts of a patch's skin have on a robot.

use anyhow::{Context, bail, ensure};
use dermatome_body::surface;
use dermatome_model::skin::{Pose, Skin};
use dermatome_patch::tables::SurfaceTables;
use std::path::Path;

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
    let in_file = surface::of_skin(skin).with_context(|| format!("skin file `{file}`"))?;
    ensure!(
        in_file.is_some_and(|in_file| surface::is_same(&in_file, &in_patch)),
        "skin file `{file}`: its pixels do not lie where those of the patch do, so neither would contacts: give the skin file \
         that the patch was built from, or build it anew"
    );
    Ok(())
}
