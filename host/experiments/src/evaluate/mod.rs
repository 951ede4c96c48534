//! Evaluation: figures of merit mapped over a whole skin.
//!
//! Discs of changed conductivity are put on the *true skin* - a mesh of its own, with electrode errors
//! if asked for - one at a time all over it ([`single`]), and two at decreasing distance ([`pairs`]).
//! Each is a real forward solution with noise, imaged with the model's reconstruction matrix. Contacts are
//! those that a board with the skin's patch finds, in the voltages or in the image, whichever the skin says
//! (`find`, `board`). What images and contacts are worth is put together by rings ([`report`]) and drawn
//! ([`picture`]).

mod board;
pub(crate) mod electrodes;
mod find;
mod length;
pub mod pairs;
mod picture;
pub mod report;
mod scene;
pub mod single;
pub(crate) mod surface;
mod target;

use dermatome_geometry::mesh::Mesh;
use dermatome_model::{
    metrics::detectability::{Sought, strength_of},
    model::{Model, ModelError},
    quantize::PatchBuildError,
    skin::{FoundIn, Skin},
};
use dermatome_simulate::{TrueSkin, rig::IdealRig};
use find::ImageFinder;
pub use find::{Evidence, Found, FoundBy};
pub use length::Length;
use nalgebra::Point3;
use pairs::Pair;
pub use picture::picture;
use scene::{Finder, Scene};
use single::Single;
use surface::Surface;
use target::Discs;

/// What is put on the skin, and how well it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Distance of neighbouring places; `None` makes about [`DEFAULT_PLACES`] of them. A share is one
    /// of the skin's diameter.
    pub spacing: Option<Length>,
    /// Diameter of a target; a share is one of the skin's diameter.
    pub diameter: Length,
    /// Relative conductivity change inside a target.
    pub contrast: f64,
    /// Signal-to-noise ratio, dB, as in [`dermatome_simulate::Noise`]; `None` is without noise.
    pub snr_db: Option<f64>,
    /// Seed of noise and errors.
    pub seed: u64,
    /// Standard deviation of the electrodes' places; a share is one of their spacing.
    pub electrode_error: Length,
    /// Standard deviation of the contact impedances, a share.
    pub impedance_error: f64,
    /// What contacts are found in; `None` is the skin's own.
    pub found_in: Option<FoundIn>,
    /// Smallest relative conductivity change that counts as a contact in the image; `None` is the skin's own.
    pub threshold: Option<f64>,
}

/// Places unless a spacing is given.
pub const DEFAULT_PLACES: f64 = 250.0;
/// Most places that a spacing may lead to.
const MOST_PLACES: f64 = 20_000.0;

/// Hears how an evaluation gets on, and may end it early.
pub trait Watch: Sync {
    /// So many targets, or places for pairs, are about to be tried.
    fn begin(&self, what: &'static str, count: usize);
    /// One of them is done.
    fn step(&self);
    /// Whether to go on.
    fn go_on(&self) -> bool;
}

/// What was found out about a skin.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The true skin's mesh.
    pub mesh: Mesh,
    /// Centre of gravity of the skin, m.
    pub centre: Point3<f64>,
    /// Centres of the true skin's electrodes, m.
    pub electrodes: Vec<Point3<f64>>,
    /// Largest extent of the skin, m: what errors in per cent refer to.
    pub skin_diameter: f64,
    /// Distance of neighbouring places, m.
    pub spacing: f64,
    /// Diameter of a target, m.
    pub target_diameter: f64,
    /// Standard deviation of the electrodes' places, m.
    pub electrode_error: f64,
    /// Smallest relative conductivity change that counted as a contact; none in the voltages.
    pub threshold: Option<f64>,
    /// How contacts were found.
    pub found_by: FoundBy,
    /// Why they were found in the image although the skin says the voltages.
    pub no_board: Option<PatchBuildError>,
    /// Distance of neighbouring places for pairs, m.
    pub pair_spacing: f64,
    /// Step between the distances of pairs, m.
    pub pair_step: f64,
    /// Single targets.
    pub singles: Vec<Single>,
    /// Pairs.
    pub pairs: Vec<Pair>,
    /// Whether all of them were tried.
    pub complete: bool,
}

/// Why a skin cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluateError {
    /// No mesh or forward model of the true skin.
    #[error("the true skin has no model: {0}")]
    Model(#[from] ModelError),
    /// An argument that does not fit the skin.
    #[error("`{option}` is {value}; allowed here: {allowed}")]
    Argument {
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// An option that means nothing on this skin.
    #[error("`{option}` cannot be used: {why}")]
    Unsuited {
        /// The option.
        option: &'static str,
        /// Why.
        why: &'static str,
    },
    /// Contacts in the voltages were asked for, and no board takes the model.
    #[error("`found_in` is voltages, which takes a board: {0}")]
    NoBoard(#[from] PatchBuildError),
    /// Electrode errors that make electrodes touch.
    #[error(
        "electrodes {first} and {second} of the true skin would touch; allowed: a smaller `electrode_error`, \
         or another `seed`"
    )]
    Overlap {
        /// One electrode, from 1.
        first: usize,
        /// The next one.
        second: usize,
    },
}

/// Tries targets all over `skin`, whose model is `model`.
pub fn evaluate(
    skin: &Skin,
    model: &Model,
    options: &Options,
    watch: &dyn Watch,
) -> Result<Evaluation, EvaluateError> {
    evaluate_through(skin, None, model, options, watch)
}

/// The same through `model`, that of `flattened`, which is `skin` [flattened](Skin::flattened): the same true skin and the
/// same frames.
pub fn evaluate_flattened(
    skin: &Skin,
    flattened: &Skin,
    model: &Model,
    options: &Options,
    watch: &dyn Watch,
) -> Result<Evaluation, EvaluateError> {
    evaluate_through(skin, Some(flattened), model, options, watch)
}

fn evaluate_through(
    skin: &Skin,
    flattened: Option<&Skin>,
    model: &Model,
    options: &Options,
    watch: &dyn Watch,
) -> Result<Evaluation, EvaluateError> {
    let electrode_error = electrode_error(skin, options)?;
    let true_skin = electrodes::with_errors(skin, electrode_error, options.impedance_error, options.seed)?;
    let (board, no_board) = board::on(&true_skin, flattened.unwrap_or(skin), model, options)?;
    let alone;
    let truth = match &board {
        Some(board) => board.rig.truth(),
        None => {
            alone = TrueSkin::new(&true_skin)?;
            &alone
        }
    };
    let surface = Surface::new(&true_skin.shape, truth.mesh());
    let target_diameter = target_diameter(&surface, options)?;
    let threshold = options.threshold.unwrap_or(skin.contact_threshold);
    let sought =
        |snr_db| Sought { radius: target_diameter / 2.0, strength: strength_of(options.contrast), snr_db };
    let scene = Scene {
        surface: &surface,
        rig: IdealRig::new(truth, model, options.snr_db, options.seed),
        finder: match &board {
            Some(board) => Finder::Voltages(board),
            None => Finder::Image(ImageFinder::new(&model.pixels, threshold)),
        },
        model,
        flattened: flattened.map(|_| truth),
        discs: Discs { radius: target_diameter / 2.0, contrast: options.contrast },
        spacing: spacing(&surface, options)?,
        detectability: options.snr_db.map(|snr_db| model.detectability(&sought(snr_db))),
    };
    let singles = single::try_all(&scene, watch);
    let pairs = pairs::try_all(&scene, watch);
    Ok(Evaluation {
        mesh: truth.mesh().clone(),
        centre: surface.centre,
        electrodes: true_skin.shape.electrode_centres(),
        skin_diameter: surface.diameter,
        spacing: scene.spacing,
        target_diameter,
        electrode_error,
        threshold: board.is_none().then_some(threshold),
        found_by: scene.finder.found_by(),
        no_board,
        pair_spacing: pairs::SPARSENESS * scene.spacing,
        pair_step: pairs::STEP * surface.diameter,
        singles,
        pairs,
        complete: watch.go_on(),
    })
}

fn electrode_error(skin: &Skin, options: &Options) -> Result<f64, EvaluateError> {
    match (options.electrode_error, electrodes::spacing(skin)) {
        (Length::Share(share), None) if share > 0.0 => Err(EvaluateError::Unsuited {
            option: "electrode_error",
            why: "no electrodes lie along the rim, so there is no spacing to take per cent of",
        }),
        (error, spacing) => Ok(error.of(spacing.unwrap_or(0.0))),
    }
}

fn target_diameter(surface: &Surface<'_>, options: &Options) -> Result<f64, EvaluateError> {
    let diameter = options.diameter.of(surface.diameter);
    let (least, most) = (surface.diameter / 200.0, surface.diameter / 2.0);
    in_range("diameter", diameter, least, most)
}

fn spacing(surface: &Surface<'_>, options: &Options) -> Result<f64, EvaluateError> {
    let area = surface.area();
    let spacing = options.spacing.map(|spacing| spacing.of(surface.diameter));
    let (least, most) = ((area / MOST_PLACES).sqrt(), surface.diameter);
    in_range("spacing", spacing.unwrap_or((area / DEFAULT_PLACES).sqrt()), least, most)
}

fn in_range(option: &'static str, value: f64, least: f64, most: f64) -> Result<f64, EvaluateError> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let allowed = format!("{:.2} mm to {:.2} mm", least * 1e3, most * 1e3);
    Err(EvaluateError::Argument { option, value: format!("{:.2} mm", value * 1e3), allowed })
}

#[cfg(test)]
pub(crate) mod tests;
