//! Learn: a matrix calibrated from presses at known places.
//!
//! Presses teach how the measurements respond to one anywhere on the skin, with the model for what they say nothing of
//! ([`responses`]); a matrix makes round spots of these responses where the skin was pressed ([`matrix`]). It is a matrix
//! like any other, which a board runs with the same arithmetic and contact finder.
//!
//! What becomes of one press; each step is one call, and takes what those before gave:
//!
//! | step | takes | gives |
//! |---|---|---|
//! | [`Recording::read`](presses::Recording::read) | a row of the file | coordinates, force, frame |
//! | [`presses::place::lay`] | coordinates | a place on the skin, or a refusal |
//! | [`Recording::on`](presses::Recording::on) | frame and reference | difference data, beside that place |
//! | [`Presses::place_numbers`] | places | which presses are at one place |
//! | [`split()`] | these numbers | test, or the rest |
//! | cross-validation, over [`Folds`] of the rest | settings to try | how much misfit to allow for, how large a spot |
//! | [`Training::new`] | data and places of the rest | responses by a Gaussian process, what they miss |
//! | [`Training::matrix`] | the settings | the matrix, a spot of each place |
//! | [`quantize::learnt_patch`] | the matrix | the patch |
//! | [`judge`] | data of a test press, the patch | its contact on the skin, and how far that is from the place |
//!
//! The test part chooses nothing.
//!
//! **Curved skins.** A place is a point of the mesh, and all distances are those through space. The process needs a
//! covariance: Matern functions of distances through space are positive definite whatever the places, those of distances
//! along a surface are not (on half a sphere the smallest eigenvalue of 100 places' is -0.02 with exact arcs; Gneiting
//! 2013), and tell presses no better. A contact is where a board lays it, and errors are distances in space.

pub mod judge;
pub mod matrix;
pub mod presses;
pub mod responses;
pub mod split;

use crate::recorded::statistics::pearson;
use dermatome_model::{
    inverse::targets::half_side,
    model::{Model, TooManyPixels},
    quantize::{self, PatchBuildError},
    skin::Skin,
};
use dermatome_shared::patch::{PatchError, PatchView};
use faer::Mat;
use judge::{Errors, Judged, Outcome, ToldApart, Turn, judge_board, judge_matrix};
use matrix::{LearntMatrix, Settings, Training};

use presses::{Presses, place::Off};
use rayon::prelude::*;
use responses::Process;
use serde::Serialize;
use split::{Folds, Split, split};
use std::{collections::BTreeSet, ops::RangeInclusive};

/// Parts of the cross-validation.
pub const FOLDS: usize = 5;
/// Fewest presses to learn from.
pub const FEWEST: usize = 10;
/// Presses closer than this share of the skin's larger side are at one place.
const SAME_PLACE: f64 = 2e-3;
/// Largest share of the presses kept for the test.
pub const MOST_TEST: f64 = 0.5;
/// How many times the misfit is allowed for, see [`Settings::misfit`].
const MISFITS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Radii of the wanted spots, as shares of half the skin's larger side.
const RADII: [f64; 5] = [0.2, 0.25, 0.3, 0.35, 0.4];
/// What a second contact of one press costs in cross-validation, as a share of the skin's larger side.
const SECOND: f64 = 0.05;
/// What a pair of presses that is not told apart costs, as such a share.
const PAIR: f64 = 0.015;
/// How far apart the presses of a pair are, as such shares.
const APART: RangeInclusive<f64> = 0.25..=0.6;
/// Most pairs of each part of the cross-validation.
const MOST_PAIRS: usize = 60;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Share of the presses that is kept for the test, 0 to [`MOST_TEST`].
    pub test_share: f64,
    /// Seed of the split.
    pub seed: u64,
    /// What a spot's height follows.
    pub strength: Strength,
}

/// What the strength of a press in the image follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Strength {
    /// The size of the measurements' response, as in the model's images: places come out best.
    #[default]
    #[serde(rename = "answer")]
    Response,
    /// The force: equal forces look alike all over the skin, and places come out less well.
    Force,
}

/// A learnt matrix and how good it is.
#[derive(Clone, Debug)]
pub struct Learnt {
    /// The model with the learnt matrix.
    pub model: Model,
    /// Its patch.
    pub patch: Vec<u8>,
    /// What is known of it.
    pub report: LearnReport,
}

/// How a matrix was learnt, and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LearnReport {
    /// Presses in the file.
    pub presses: usize,
    /// Presses learnt from, by cross-validation and at the end.
    pub training_presses: usize,
    /// Presses kept for the test.
    pub test_presses: usize,
    /// As asked for.
    pub seed: u64,
    /// As asked for.
    pub strength: Strength,
    /// What cross-validation chose.
    pub settings: Settings,
    /// Whether presses lower the conductivity in the model's images.
    pub conductivity_falls: bool,
    /// How far off the skin presses were recorded; none on a flat skin in the plane z = 0.
    pub off_skin: Option<Off>,
    /// How the model's places have to be turned to fit the training presses best; none of a skin that faces all ways alike.
    pub turn: Option<Turn>,
    /// The model's matrix on the training presses, f64.
    pub model_training: Errors,
    /// The learnt matrix on the presses it has learnt from, f64.
    pub training: Errors,
    /// Matrices learnt from four fifths of the training presses, each on the other fifth, f64.
    pub validation: Errors,
    /// Pairs of presses on the fifth that the matrix has not learnt from, as the sum of what each changes, f64.
    pub validation_pairs: ToldApart,
    /// The model's matrix on the test presses, in a board's fixed point.
    pub model_test: Option<Errors>,
    /// The learnt matrix on the test presses, in a board's fixed point.
    pub test: Option<Errors>,
    /// Farthest that fixed point moves a contact of the test presses (without a test, of all), mm.
    pub fixed_point_mm: f64,
    /// Threshold in the patch: the skin file's, or less where that would hide weak presses.
    pub contact_threshold: f64,
    /// Noise in the images of equal noise in every voltage, learnt over the model's, for presses that
    /// look equally strong.
    pub noise_amplification: f64,
    /// The process that tells presses best.
    pub process: Process,
    /// Share of the training presses' squares that presses at other places tell.
    pub foretold: f64,
    /// Correlation of contact strength with force over the test presses (without a test, the training
    /// presses); none without forces.
    pub force_correlation: Option<f64>,
}

/// Why nothing could be learnt.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LearnError {
    /// Too few presses.
    #[error(
        "{found} presses are left to learn from; allowed: {FEWEST} or more (the file holds {presses}, {test} of \
         them are kept for the test)"
    )]
    TooFew {
        /// Presses to learn from.
        found: usize,
        /// All presses.
        presses: usize,
        /// Presses of the test.
        test: usize,
    },
    /// Too few places.
    #[error(
        "the presses to learn from are at {found} different places; allowed: {FEWEST} or more, all over the skin (the \
         file's are at {places})"
    )]
    TooFewPlaces {
        /// Places to learn from.
        found: usize,
        /// Places in the file.
        places: usize,
    },
    /// A share that is none.
    #[error("the share of presses kept for the test is {0}; allowed: 0 to {MOST_TEST}")]
    TestShare(f64),
    /// No forces to follow.
    #[error("the strength is to follow the force, and the file holds no forces; allowed here: `answer`")]
    NoForces,
    /// A press that changes nothing.
    #[error("press {0} (counted from 0) does not differ from its reference in any measurement")]
    NoChange(usize),
    /// A training set in which nothing happens.
    #[error("fewer than half of the presses change any one measurement: nothing can be learnt from them")]
    Silent,
    /// Data on which the arithmetic fails.
    #[error("the presses' measurements are too large or too much alike to be solved for")]
    Singular,
    /// An image in which nothing can be looked for.
    #[error(transparent)]
    Pixels(#[from] TooManyPixels),
    /// A matrix that no board takes.
    #[error(transparent)]
    Patch(#[from] PatchBuildError),
    /// A patch that no board takes.
    #[error("the learnt matrix does not make a valid patch: {0}")]
    Invalid(#[from] PatchError),
}

/// Learns a matrix for `skin`, whose model is `model`, from presses.
pub fn learn(skin: &Skin, model: &Model, presses: &Presses, request: &Request) -> Result<Learnt, LearnError> {
    check(presses, request)?;
    let places = presses.place_numbers(SAME_PLACE * 2.0 * half_side(&model.mesh));
    let parts = parts(&places, request)?;
    // Whether a board takes the patch at all does not depend on the numbers in it.
    quantize::patch(skin, model)?;
    let chosen =
        choose(model, presses, &Folds::new(&parts.training, &places, FOLDS), &places, request.strength)?;
    let training = Training::new(model, presses, &parts.training, &places, request.strength)?;
    let made = training.matrix(chosen.settings.misfit, &training.wanted(chosen.settings.radius))?;
    let learnt = with_matrix(model, made.matrix.clone());
    let plain = with_matrix(model, made.prior.clone());
    let learns_from = judge_matrix(&learnt, presses, &parts.training)?;
    let placed = judge_matrix(&plain, presses, &parts.training)?;
    let heard = hearing(skin, &learns_from);
    let patch = quantize::learnt_patch(&heard, &learnt)?;
    let has_test = !parts.test.is_empty();
    let judged = if has_test { &parts.test } else { &parts.training };
    let on_board = judge_board(&learnt, &PatchView::validate(&patch)?, presses, judged)?;
    let of_model = board_outcome(&hearing(skin, &placed), &plain, presses, judged)?;
    let report = LearnReport {
        presses: presses.count(),
        training_presses: parts.training.len(),
        test_presses: parts.test.len(),
        seed: request.seed,
        strength: request.strength,
        settings: chosen.settings,
        conductivity_falls: made.falls,
        off_skin: presses.off,
        turn: placed.turn(),
        model_training: placed.errors(),
        training: learns_from.errors(),
        validation: chosen.errors,
        validation_pairs: chosen.pairs,
        model_test: has_test.then(|| of_model.errors()),
        test: has_test.then(|| on_board.errors()),
        fixed_point_mm: judge_matrix(&learnt, presses, judged)?.farthest_from(&on_board),
        contact_threshold: heard.contact_threshold,
        noise_amplification: noise_amplification(&training, &made),
        process: training.process(),
        foretold: 1.0 - training.missing_share(),
        force_correlation: presses.forces.as_ref().map(|forces| correlation(forces, &on_board)),
    };
    Ok(Learnt { model: learnt, patch, report })
}

fn check(presses: &Presses, request: &Request) -> Result<(), LearnError> {
    if !(0.0..=MOST_TEST).contains(&request.test_share) {
        return Err(LearnError::TestShare(request.test_share));
    }
    if request.strength == Strength::Force && presses.forces.is_none() {
        return Err(LearnError::NoForces);
    }
    Ok(())
}

/// Training and test presses, if enough are left to learn from; `places` as in [`split`].
fn parts(places: &[usize], request: &Request) -> Result<Split, LearnError> {
    let parts = split(places, request.test_share, request.seed);
    let (found, test) = (parts.training.len(), parts.test.len());
    let taught = distinct(parts.training.iter().map(|&press| places[press]));
    let pressed = distinct(places.iter().copied());
    if found < FEWEST && pressed >= FEWEST.min(places.len()) {
        return Err(LearnError::TooFew { found, presses: places.len(), test });
    }
    if taught < FEWEST {
        return Err(LearnError::TooFewPlaces { found: taught, places: pressed });
    }
    Ok(parts)
}

fn distinct(places: impl Iterator<Item = usize>) -> usize {
    places.collect::<BTreeSet<_>>().len()
}

/// The model with another matrix.
fn with_matrix(model: &Model, matrix: Mat<f64>) -> Model {
    Model { conductivity_from_difference: matrix, ..model.clone() }
}

/// The skin with a contact threshold that lets nearly all presses through, if its own does not: half the
/// peak that all but the weakest fiftieth of `outcome` reach.
fn hearing(skin: &Skin, outcome: &Outcome) -> Skin {
    let mut peaks: Vec<f64> =
        outcome.presses.iter().map(|press| press.found.map_or(0.0, |f| f.peak)).collect();
    peaks.sort_by(f64::total_cmp);
    let weak = peaks.get(peaks.len() / 50).copied().unwrap_or(0.0) / 2.0;
    let threshold = if weak > 0.0 { skin.contact_threshold.min(weak) } else { skin.contact_threshold };
    Skin { contact_threshold: threshold, ..skin.clone() }
}

fn board_outcome(
    skin: &Skin,
    model: &Model,
    presses: &Presses,
    which: &[usize],
) -> Result<Outcome, LearnError> {
    let patch = quantize::patch(skin, model)?;
    judge_board(model, &PatchView::validate(&patch)?, presses, which)
}

/// Correlation of strength with force over the presses that were found.
fn correlation(forces: &[f64], outcome: &Outcome) -> f64 {
    let found = outcome.presses.iter().filter_map(|press| {
        let contact = press.found?;
        Some((forces[press.press], contact.strength))
    });
    pearson(&found.collect::<Vec<_>>())
}

/// Root of the sum of squares, each column times the size of one unit of voltage noise in it.
fn noise_amplification(training: &Training<'_>, made: &LearntMatrix) -> f64 {
    let size = |matrix: &Mat<f64>| {
        let of_column = |m: usize| matrix.col(m).squared_norm_l2() * training.noise[m].powi(2);
        (0..matrix.ncols()).map(of_column).sum::<f64>().sqrt()
    };
    size(&made.matrix) / size(&made.prior)
}

/// Settings, and how well they did in cross-validation.
struct Chosen {
    settings: Settings,
    errors: Errors,
    pairs: ToldApart,
}

/// Those with the smallest mean error, where a second contact of a press is an error as well, and two presses at once that
/// are not told apart.
fn choose(
    model: &Model,
    presses: &Presses,
    folds: &Folds,
    places: &[usize],
    strength: Strength,
) -> Result<Chosen, LearnError> {
    let surface = &model.surface()?;
    let side = 2.0 * half_side(&model.mesh);
    let apart = side * APART.start()..=side * APART.end();
    let tables = folds.iter().collect::<Vec<_>>().into_par_iter().map(|(training, validation)| {
        let training = Training::new(model, presses, training, places, strength)?;
        let pairs = judge::pairs(presses, validation, apart.clone(), MOST_PAIRS);
        let mut outcomes = Vec::with_capacity(RADII.len() * MISFITS.len());
        for radius in RADII {
            let wanted = training.wanted(radius);
            for misfit in MISFITS {
                let made = training.matrix(misfit, &wanted)?;
                let judged = Judged { matrix: &made.matrix, surface };
                outcomes.push((judged.judge(presses, validation), judged.told_apart(presses, &pairs)));
            }
        }
        Ok(outcomes)
    });
    let tables: Vec<Vec<(Outcome, ToldApart)>> = tables.collect::<Result<_, LearnError>>()?;
    let together = |place: usize| {
        let pairs = tables.iter().map(|table| table[place].1);
        let errors = Outcome::together(tables.iter().map(|table| &table[place].0)).errors();
        (errors, pairs.fold(ToldApart::default(), ToldApart::and))
    };
    let cost = |(errors, pairs): &(Errors, ToldApart)| {
        let seconds = errors.seconds as f64 / errors.presses.max(1) as f64;
        errors.mean_mm + side * 1e3 * (SECOND * seconds + PAIR * pairs.missed())
    };
    let tried: Vec<_> = (0..RADII.len() * MISFITS.len()).map(together).collect();
    let best = (0..tried.len()).min_by(|&a, &b| cost(&tried[a]).total_cmp(&cost(&tried[b])));
    let best = best.expect("there are settings");
    let settings = Settings { misfit: MISFITS[best % MISFITS.len()], radius: RADII[best / MISFITS.len()] };
    let (errors, pairs) = tried[best];
    Ok(Chosen { settings, errors, pairs })
}
