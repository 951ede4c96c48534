//! Calibrations that are preserved: no new patch silently takes the place of one that was calibrated.

use anyhow::{Context, bail, ensure};
use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    write::{Stored, have_same_matrix, with_gains_of},
};
use dermatome_shared::patch::PatchView;
use std::path::Path;

/// Fails if a patch at `path` holds a calibration that the one to take its place does not; `allowed` says what to do.
pub(super) fn refuse_to_lose(path: &Path, of_new: &Stored, allowed: &str) -> anyhow::Result<()> {
    // What is not there, no file or no patch has no calibration to lose; devices may never end.
    if !path.is_file() {
        return Ok(());
    }
    let Ok(bytes) = input::read(path, MAX_PATCH_BYTES) else { return Ok(()) };
    let Ok(patch) = PatchView::validate(&bytes) else { return Ok(()) };
    let old = Stored::of(&patch);
    if old.is_empty() || old == *of_new {
        return Ok(());
    }
    let (file, points, plays) = (path.display(), old.curve.points.len(), old.play_operators.len());
    bail!(
        "`{file}` was calibrated ({points} points, {plays} play operators), which the new patch would not be; allowed: {allowed}"
    );
}

/// A calibrated patch whose calibration a new patch of the same skin gets.
pub(super) struct Preserved {
    bytes: Vec<u8>,
    pub(super) stored: Stored,
}

impl Preserved {
    /// Reads it; its skin must be called `skin`.
    pub(super) fn read(path: &Path, skin: &str) -> anyhow::Result<Self> {
        let file = path.display();
        let bytes =
            input::read(path, MAX_PATCH_BYTES).with_context(|| format!("cannot read patch `{file}`"))?;
        let patch = PatchView::validate(&bytes).with_context(|| format!("`{file}`"))?;
        let of = &patch.header.skin;
        ensure!(
            of == skin,
            "`{file}` is a patch of `{of}`; allowed: one of `{skin}`, as this skin is called"
        );
        let stored = Stored::of(&patch);
        ensure!(
            !stored.is_empty(),
            "`{file}` holds no calibration to keep; allowed: a patch that `dermatome calibrate` wrote"
        );
        Ok(Self { bytes, stored })
    }

    /// The new patch with its field of gain; none if that is not of the same places, or other images have another scale
    /// than those that the calibration was made with.
    pub(super) fn with_field(&self, new: &[u8]) -> anyhow::Result<Option<Vec<u8>>> {
        let (old, view) = (PatchView::open(&self.bytes)?, PatchView::open(new)?);
        if have_same_matrix(&old, &view) { Ok(with_gains_of(new, &old)?) } else { Ok(None) }
    }
}
