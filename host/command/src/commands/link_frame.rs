//! The link's frame: which pose contacts of a patch's skin have on a robot.

use anyhow::{Context, bail};
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
    let file = || format!("skin file `{}`", path.display());
    surface::check_name(skin, of_patch).with_context(file)?;
    surface::check_pixels(skin, &pixels()?).with_context(file)
}
