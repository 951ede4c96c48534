//! The hemisphere (thesis 5.4.4): its skins, and its experiments.

mod count;
mod flat;
mod touches;

pub(super) use count::run as count;
pub(super) use flat::run as flat;

use super::{ExperimentError, sample::THREE_SINGLE};
use crate::scenes::Options;
use dermatome_model::skin::Skin;
use std::path::Path;

/// Diameter of the hemisphere, m.
const DIAMETER: f64 = 0.21;

const SKIN: &str = include_str!("../../../../../models/hemisphere-210mm/skin.toml");
const FORMULA: &str = include_str!("../../../../../models/hemisphere-210mm/formula.toml");
const MESH: &[u8] = include_bytes!("../../../../../models/hemisphere-210mm/hemisphere.stl");

/// The skin from an STL file.
pub(super) fn shipped() -> Result<Skin, ExperimentError> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("hemisphere.stl"), MESH)?;
    Ok(Skin::parse(&folder.path().join("skin.toml"), SKIN)?.made()?)
}

/// The same by its formula, meshed anew.
pub(super) fn by_formula() -> Result<Skin, ExperimentError> {
    Ok(Skin::parse(Path::new("models/hemisphere-210mm/formula.toml"), FORMULA)?.made()?)
}

/// The skin from an STL file, which images are made with, and the same from its formula, which is the truth; both
/// driven as in the thesis.
fn skins() -> Result<[Skin; 2], ExperimentError> {
    let mut skins = [shipped()?, by_formula()?];
    skins.iter_mut().for_each(|skin| THREE_SINGLE.drive(skin));
    Ok(skins)
}

/// Words on how the skin is driven and what is played.
fn played_words(options: &Options) -> [String; 2] {
    let driven = format!(
        "The skin is models/hemisphere-210mm: 210 mm across, 16 electrodes on its rim, the fabric of Sample 3. {} Otherwise than in \
         Table 5.5: the matrix is GREIT's and not that of a Laplace prior with a hyperparameter of 0.15, because it counts more \
         contacts right; it takes plain differences, from which an absolute value would take the sign, so the part in phase is \
         measured; the board finds its own gain. The thesis does not say that frames were averaged here, and these are single \
         ones. The true skin is a hemisphere by its formula, the model's comes from an STL file.",
        THREE_SINGLE.drive_words()
    );
    let played = format!(
        "{} random scenes with one, two and three fingers in turn, of radius {:.1} mm as seen from above. They do not press through \
         Sample 3's material: each changes the conductivity in its middle by {:.0} %, a change that is known exactly. Centres \
         evenly over the surface, a radius from the rim, and at least {:.0} % of the diameter apart; {:.0} dB, a reference of 20 \
         frames, no other artefacts. The thesis shows pictures of one, two and three contacts and no figures.",
        options.scenes,
        options.radius * DIAMETER * 1e3,
        100.0 * options.depth,
        100.0 * options.apart,
        options.snr_db
    );
    [driven, played]
}
