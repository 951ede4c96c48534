//! Simulated: a board whose skin is pressed where the caller says.

use super::Board;
use crate::{
    desk::{Desk, WhenFull},
    skin::{Loaded, SkinOrPath},
};
use dermatome_geometry::outline::Outline;
use dermatome_link::Link;
use dermatome_model::indenter::Press;
use dermatome_simulate::{
    Noise, Script, ScriptError, SimulatedSkin,
    board::{BoardOptions, DEFAULT_NOISE, Pace, SimulatedBoard},
};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::{fmt::Display, path::PathBuf, sync::Arc};

// Python shows defaults only where they are numbers as such.
const _: () = assert!(DEFAULT_NOISE.snr_db == 60.0 && DEFAULT_NOISE.seed == 1);

/// Starts a simulated board with a simulated skin, which holds the skin's patch.
///
/// `presses` are fingers that rest on the skin while the board streams, each (x, y, radius, depth) in m, m, m and relative
/// change of conductivity; `script` names a CSV file of moving ones (docs/cli.md); without either a finger goes round. A
/// tare sees the untouched skin. `paced=False` gives frames as fast as they are solved and taken.
#[pyfunction]
#[pyo3(signature = (skin, presses=None, *, script=None, noise_db=60.0, seed=1, paced=true))]
pub(crate) fn simulate(
    py: Python<'_>,
    skin: SkinOrPath,
    presses: Option<Vec<[f64; 4]>>,
    script: Option<PathBuf>,
    noise_db: f64,
    seed: u64,
    paced: bool,
) -> PyResult<Board> {
    if !(0.0..=200.0).contains(&noise_db) {
        return Err(PyValueError::new_err(format!("noise_db is {noise_db}; allowed: 0 to 200 dB")));
    }
    let fingers = Fingers::new(presses, script)?;
    let skin = skin.load(py)?;
    let port = format!("sim:{}", skin.path().display());
    let (pace, when_full) =
        if paced { (Pace::FrameRate, WhenFull::DropOldest) } else { (Pace::Unpaced, WhenFull::Wait) };
    let electrodes = skin.described().electrodes.count;
    let patch = Some(skin.patch_bytes(py)?);
    let options = BoardOptions { electrodes, patch, pace, ..BoardOptions::default() };
    let (name, noise) = (port.clone(), Noise { snr_db: noise_db, seed });
    let desk = Desk::open(py, when_full, move || start(&skin, &fingers, noise, options, port))?;
    Ok(Board { port: name, desk: Arc::new(desk) })
}

/// Who presses.
enum Fingers {
    Round,
    Resting(Vec<Press>),
    Script(PathBuf),
}

impl Fingers {
    fn new(presses: Option<Vec<[f64; 4]>>, script: Option<PathBuf>) -> PyResult<Self> {
        let finger = |[x, y, radius, depth]: [f64; 4]| Press::finger([x, y], radius, depth);
        match (presses, script) {
            (None, None) => Ok(Self::Round),
            (Some(presses), None) => Ok(Self::Resting(presses.into_iter().map(finger).collect())),
            (None, Some(path)) => Ok(Self::Script(path)),
            (Some(_), Some(_)) => Err(PyValueError::new_err("presses and script exclude each other")),
        }
    }

    fn script(&self, outline: &Outline) -> Result<Script, ScriptError> {
        match self {
            Self::Round => Ok(Script::round(outline)),
            Self::Resting(presses) => Script::still(presses, outline),
            Self::Script(path) => Script::load(path, outline),
        }
    }
}

/// The link to a board that starts; errors in words.
fn start(
    skin: &Loaded,
    fingers: &Fingers,
    noise: Noise,
    options: BoardOptions,
    port: String,
) -> Result<Link, String> {
    let words = |error: &dyn Display| error.to_string();
    let skin = skin.described();
    let outline = skin.shape.from_above().map_err(|error| words(&error))?;
    let script = fingers.script(&outline).map_err(|error| words(&error))?;
    let source = SimulatedSkin::new(skin, script, noise).map_err(|error| words(&error))?;
    let board = SimulatedBoard::start(options, source).map_err(|error| words(&error))?;
    board.connect(port).map_err(|error| words(&error))
}
