//! A simulated board with a simulated skin on it.

use super::{BoardError, BoardOptions, FrameSource, Scan, ScanTable, SimulatedBoard, SlotSamples};
use crate::{Noise, Script, SimulatedSkin};
use dermatome_model::{
    model::{Model, ModelError},
    quantize::{self, PatchBuildError},
    skin::{Skin, SkinError},
};
use dermatome_shared::{acquire::FrontEnd, scan::Timing};
use std::path::{Path, PathBuf};

/// Noise of a simulated board unless the user wants another.
pub const DEFAULT_NOISE: Noise = Noise { snr_db: 60.0, seed: 1 };

impl FrameSource for SimulatedSkin {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Scan {
        self.measure(table, script_time)
    }

    fn front_end(&self) -> Option<FrontEnd> {
        Some(SimulatedSkin::front_end(self))
    }

    fn samples(
        &mut self,
        table: &ScanTable,
        slot: usize,
        timing: Timing,
        script_time: Option<f64>,
    ) -> Option<SlotSamples> {
        self.show(table, slot, timing, script_time)
    }
}

/// Why a skin file does not make a simulated board.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The skin file is not usable.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The skin has no model.
    #[error("skin file `{}`: {error}", path.display())]
    Model {
        /// The skin file.
        path: PathBuf,
        /// Why.
        error: ModelError,
    },
    /// The skin has no patch.
    #[error("skin file `{}`: {error}", path.display())]
    Patch {
        /// The skin file.
        path: PathBuf,
        /// Why.
        error: PatchBuildError,
    },
    /// The board does not start.
    #[error(transparent)]
    Board(#[from] BoardError),
}

/// What a port `sim:PATH` opens: a board that already holds the skin's patch, with a finger going
/// round on the skin while it streams.
pub fn board_for_skin(path: &Path) -> Result<SimulatedBoard, SimulationError> {
    let skin = Skin::load(path)?.made()?;
    let in_file = |error| SimulationError::Model { path: path.to_owned(), error };
    let model = Model::build(&skin, |_| ()).map_err(in_file)?;
    let patch = quantize::patch(&skin, &model)
        .map_err(|error| SimulationError::Patch { path: path.to_owned(), error })?;
    let outline = skin.shape.from_above().map_err(|error| in_file(error.into()))?;
    let source = SimulatedSkin::new(&skin, Script::round(&outline), DEFAULT_NOISE).map_err(in_file)?;
    Ok(SimulatedBoard::start(
        BoardOptions { electrodes: skin.electrodes.count, patch: Some(patch), ..BoardOptions::default() },
        source,
    )?)
}
