//! A simulated board with a simulated skin on it.

use super::{BoardError, BoardOptions, SimulatedBoard};
use crate::{noise::Noise, rig::RigError, script::Script, skin::SimulatedSkin};
use dermatome_model::{
    model::{Model, ModelError},
    quantize,
    skin::{Skin, SkinError},
};
use std::path::{Path, PathBuf};

/// Noise of a simulated board unless the user wants another.
pub const DEFAULT_NOISE: Noise = Noise { snr_db: 60.0, seed: 1 };

/// Why a skin file does not make a simulated board.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The skin file is not usable.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The skin has no model or no patch.
    #[error("skin file `{}`: {error}", path.display())]
    Rig {
        /// The skin file.
        path: PathBuf,
        /// Why.
        error: RigError,
    },
    /// The board does not start.
    #[error(transparent)]
    Board(#[from] BoardError),
}

/// Time for which the finger lifts after each round, s: what waits for a free skin, such as a tare, is done then.
const LIFTED: f64 = 4.0;

/// What a port `sim:PATH` opens: a board that already holds the skin's patch, with a finger going
/// round on the skin while it streams, which lifts after each round.
pub fn board_for_skin(path: &Path) -> Result<SimulatedBoard, SimulationError> {
    let skin = Skin::load(path)?.made()?;
    let (patch, instrument) =
        patch_and_instrument(&skin).map_err(|error| SimulationError::Rig { path: path.to_owned(), error })?;
    Ok(SimulatedBoard::start(
        BoardOptions { electrodes: skin.electrodes.count, patch: Some(patch), ..BoardOptions::default() },
        instrument,
    )?)
}

fn patch_and_instrument(skin: &Skin) -> Result<(Vec<u8>, SimulatedSkin), RigError> {
    let patch = quantize::patch(skin, &Model::build(skin, |_| ())?)?;
    let outline = skin.shape.from_above().map_err(ModelError::from)?;
    Ok((patch, SimulatedSkin::new(skin, Script::round(&outline).with_pause(LIFTED), DEFAULT_NOISE)?))
}
