//! Quantize: the f64 reconstruction matrix -> fixed-point patch, with its error report.

mod choice;
mod interpolation;
mod reflexes;
mod responses;
mod shares;

use crate::{
    model::{Model, ModelError},
    skin::{FoundIn, Skin},
};
use dermatome_geometry::{mesh::ElectrodeContact, sheet::ElectrodeModel};
use dermatome_patch::{
    matrix::FixedMatrix,
    places::FixedPlaces,
    reflexes::Reflexes,
    tables::SurfaceTables,
    write::{Contents, Stored},
};
use dermatome_shared::{
    MAX_ELECTRODES, MAX_PATCH_BYTES, MAX_PIXELS, MAX_STEPS,
    calibration::Calibration,
    patch::{
        PatchError, PatchHeader, PatchView,
        matrix::{COLUMN_EXPONENTS, INTERPOLATION_EXPONENT, MatrixLayout},
        places::{DetectionLayout, MAX_PLACES},
    },
    reconstruct::reconstruct,
    reference::DifferenceData,
    surface::MAX_NEIGHBOURS,
    units::RelativeConductivity,
};
use faer::{Col, ColRef, Mat};
use interpolation::{Interpolated, Occurring};
use rand::{Rng, SeedableRng};
pub use reflexes::{ReflexError, ReflexReport, reflex_reports};
use responses::FEWEST_PLACES;
use serde::Serialize;

/// Rounds a matrix `[pixel][measurement]` as its pixels are interpolated, each row with the finest exponent that fits.
fn fixed_point(
    matrix: &Mat<f64>,
    column_exponents: Vec<i8>,
    interpolated: &Interpolated,
) -> Result<FixedMatrix, PatchBuildError> {
    let from_data =
        interpolated.order[..interpolated.from_data].iter().map(|&pixel| matrix.row(pixel).transpose());
    let (row_exponents, mantissas) = rounded_rows(from_data, &column_exponents)?;
    let mut fixed = FixedMatrix::from_data(column_exponents, row_exponents, &mantissas);
    for step in &interpolated.interpolations {
        let inputs: Vec<u16> = step.inputs.iter().map(|&position| position as u16).collect();
        let weights = step.weights.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>());
        let mantissas: Vec<i16> =
            weights.map(|weight| rounded(weight, INTERPOLATION_EXPONENT as i8)).collect();
        fixed.interpolate(&inputs, &mantissas);
    }
    Ok(fixed.in_order(&interpolated.order))
}

/// Exponents and mantissas of rows, `[row]` and `[row][measurement]`, each with the finest exponent that fits.
fn rounded_rows<'a>(
    rows: impl Iterator<Item = ColRef<'a, f64>>,
    column_exponents: &[i8],
) -> Result<(Vec<i8>, Vec<i16>), PatchBuildError> {
    let (mut row_exponents, mut mantissas) = (Vec::new(), Vec::new());
    for row in rows {
        let scaled = |(value, exponent): (&f64, &i8)| value * f64::from(*exponent).exp2();
        let row: Vec<f64> = row.iter().zip(column_exponents).map(scaled).collect();
        let largest = row.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
        let finite = row.iter().all(|value| value.is_finite());
        let exponent = finest_exponent(largest).filter(|_| finite);
        let exponent = exponent.ok_or(PatchBuildError::Matrix { largest })?;
        row_exponents.push(exponent);
        mantissas.extend(row.iter().map(|value| rounded(*value, exponent)));
    }
    Ok((row_exponents, mantissas))
}

/// By how many octaves each measurement's data are larger than others', and its column smaller: `[measurement]`.
///
/// Data have 16 bits, and so has a row. Where some voltages are small, as those far from the current's electrodes, their
/// relative changes would take all bits of the others, as their small weights would have none. Half of what lies between
/// them goes to each.
fn column_exponents(model: &Model) -> Vec<i8> {
    let changes =
        model.jacobian.row_iter().zip(model.divisors()).map(|(row, divisor)| row.norm_l2() / divisor.abs());
    let weights = model.conductivity_from_difference.col_iter().map(|column| column.norm_l2());
    exponents_of(changes.zip(weights).map(|(change, weight)| 0.5 * (change / weight).log2()))
}

/// Exponents that take off so many octaves less than the most that any has: `[measurement]`.
fn exponents_of(octaves: impl Iterator<Item = f64>) -> Vec<i8> {
    let octaves: Vec<f64> = octaves.collect();
    let most = octaves.iter().copied().filter(|octave| octave.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let least = f64::from(*COLUMN_EXPONENTS.start());
    let exponent =
        |octave: &f64| if octave.is_finite() { (octave - most).round().max(least) as i8 } else { 0 };
    octaves.iter().map(exponent).collect()
}

fn rounded(value: f64, exponent: i8) -> i16 {
    (value * f64::from(exponent).exp2()).round() as i16
}

/// Largest exponent whose mantissas stay within 32,767; `None` if no i8 will do.
fn finest_exponent(largest: f64) -> Option<i8> {
    if largest == 0.0 {
        return Some(0);
    }
    let exponent = (32_767.0 / largest).log2().floor();
    (-128.0..=127.0).contains(&exponent).then_some(exponent as i8)
}

/// Random presses on which commands try a patch's fixed point.
pub const TRIALS: usize = 1000;
/// Presses whose images a patch is sure to keep.
const MOST_PRESSES: usize = 1024;

/// Bytes that places leave for a calibration, and for what they add to the header.
const ROOM_OF_CALIBRATION: usize = 256;

/// Why a model does not make a patch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatchBuildError {
    /// More of something than a board takes.
    #[error("`{field}` gives {given}; a board takes 1 to {most}")]
    TooMany {
        /// Field of the skin file.
        field: &'static str,
        /// What it leads to, with its number.
        given: String,
        /// What a board takes.
        most: usize,
    },
    /// Longer than a board's slot.
    #[error(
        "the patch would take {bytes} bytes, a board stores at most {MAX_PATCH_BYTES}: use fewer `image.columns` or `image.pixels`, \
         or `drive.reciprocal` = \"combined\" if it is not"
    )]
    TooLong {
        /// Length it would have.
        bytes: usize,
    },
    /// Too few places fit beside the matrix.
    #[error(
        "beside the matrix there is room for {places} places to look for presses at; allowed: {FEWEST_PLACES} or more: use fewer \
         `image.columns` or `image.pixels`, `drive.reciprocal` = \"combined\" if it is not, or `contact.found_in` = \"image\""
    )]
    FewPlaces {
        /// How many fit.
        places: usize,
    },
    /// The matrix does not fit fixed point.
    #[error(
        "the reconstruction matrix has entries of {largest:.1e}, which 16 bits with an exponent cannot hold: \
         change `inverse.hyperparameter`"
    )]
    Matrix {
        /// Largest entry of the row that does not fit.
        largest: f64,
    },
    /// Images leave the range of fixed point.
    #[error(
        "images of simulated presses reach {peak:.0}, more than the {most:.0} that a board's images hold; raise \
         `inverse.hyperparameter`",
        most = f64::from(i32::MAX) / RelativeConductivity::ONE
    )]
    Overflow {
        /// Largest relative conductivity.
        peak: f64,
    },
    /// The model has no solution where the skin is stretched.
    #[error("stretched a little: {0}")]
    Stretched(#[from] ModelError),
    /// Reflexes that no board can follow.
    #[error(transparent)]
    Reflex(#[from] ReflexError),
    /// The patch does not pass its own checks.
    #[error("the skin does not make a valid patch: {0}")]
    Invalid(PatchError),
}

/// The patch of a skin's model, with the calibration curve of the skin file.
pub fn patch(skin: &Skin, model: &Model) -> Result<Vec<u8>, PatchBuildError> {
    patch_with(skin, model, &Stored::curve(skin.calibration.clone()))
}

/// The same with this calibration.
pub fn patch_with(skin: &Skin, model: &Model, stored: &Stored) -> Result<Vec<u8>, PatchBuildError> {
    let surface = check_limits(skin, model)?;
    let data = Occurring { presses: presses_of(model), noise: model.relative_noise() };
    let matrix = &model.conductivity_from_difference;
    let interpolated = Interpolated::new(matrix, &model.pixels.centres, &data);
    let mut contents = contents(skin, model, surface, &interpolated)?;
    if skin.contacts_found_in == FoundIn::Voltages {
        let without_places = written(&contents, stored)?.len() + reflexes::bytes(skin, model);
        let room = MAX_PATCH_BYTES.saturating_sub(without_places + ROOM_OF_CALIBRATION);
        contents.places = responses::places(skin, model, room)?;
    }
    contents.reflexes = reflexes::reflexes(skin, model, &contents.places)?;
    reflexes::check_forces(skin, stored)?;
    written(&contents, stored)
}

/// About how many pixels leave a patch room for all places that a board looks for presses at, if there is none for them.
#[must_use]
pub fn pixels_for_all_places(patch: &PatchView<'_>) -> Option<usize> {
    let header = &patch.header;
    let bytes = |places: u16| DetectionLayout { places, ..header.detection }.bytes(header.measurements);
    let without_places = patch.bytes().len() - bytes(header.detection.places);
    let room = MAX_PATCH_BYTES - ROOM_OF_CALIBRATION - bytes(MAX_PLACES as u16);
    let pixels = usize::from(header.pixels);
    (header.has_places() && without_places > room).then(|| pixels * room / without_places)
}

/// The patch of a model whose matrix was learnt from data that the model does not know of: nothing is interpolated, and
/// contacts are found in the image.
pub fn learnt_patch(skin: &Skin, model: &Model) -> Result<Vec<u8>, PatchBuildError> {
    let skin = &Skin { contacts_found_in: FoundIn::Image, ..skin.clone() };
    if !skin.reflexes.is_empty() {
        return Err(ReflexError::FoundInImage.into());
    }
    let surface = check_limits(skin, model)?;
    let stored = Stored::curve(skin.calibration.clone());
    written(&contents(skin, model, surface, &Interpolated::none(model.pixels.count()))?, &stored)
}

/// All of a patch but its places.
fn contents(
    skin: &Skin,
    model: &Model,
    surface: SurfaceTables,
    interpolated: &Interpolated,
) -> Result<Contents, PatchBuildError> {
    Ok(Contents {
        header: header(skin, model, &surface),
        steps: model.steps.clone(),
        combination: model.combination.clone(),
        surface,
        matrix: fixed_point(&model.conductivity_from_difference, column_exponents(model), interpolated)?,
        places: FixedPlaces::default(),
        reflexes: Reflexes::default(),
    })
}

fn written(contents: &Contents, stored: &Stored) -> Result<Vec<u8>, PatchBuildError> {
    contents.write(stored).map_err(|error| match error {
        PatchError::Range { field: "length", value: bytes, .. } => PatchBuildError::TooLong { bytes },
        error => PatchBuildError::Invalid(error),
    })
}

/// Difference data of presses on single pixels, at most [`MOST_PRESSES`]: `[measurement][press]`.
fn presses_of(model: &Model) -> Mat<f64> {
    let (divisors, pixels) = (model.divisors(), model.jacobian.ncols());
    let every = pixels.div_ceil(MOST_PRESSES).max(1);
    Mat::from_fn(divisors.len(), pixels.div_ceil(every), |m, press| {
        model.jacobian[(m, press * every)] / divisors[m]
    })
}

/// The pixels' tables, if a board can hold all that the model has.
/// What a skin's electrodes and drive lead to, against what a board takes: known before there is a model.
pub fn check_drive(skin: &Skin) -> Result<(), PatchBuildError> {
    let (electrodes, steps) = (usize::from(skin.electrodes.count), skin.steps().len());
    let limits = [
        ("electrodes.count", "electrodes", electrodes, MAX_ELECTRODES),
        ("drive.pattern", "steps", steps, MAX_STEPS),
    ];
    check_counts(limits)
}

fn check_counts<const N: usize>(
    limits: [(&'static str, &'static str, usize, usize); N],
) -> Result<(), PatchBuildError> {
    match limits.into_iter().find(|&(_, _, count, most)| !(1..=most).contains(&count)) {
        Some((field, what, count, most)) => {
            Err(PatchBuildError::TooMany { field, given: format!("{count} {what}"), most })
        }
        None => Ok(()),
    }
}

fn check_limits(skin: &Skin, model: &Model) -> Result<SurfaceTables, PatchBuildError> {
    let image = model.pixels.field();
    check_drive(skin)?;
    check_counts([
        (image, "pixels", model.pixels.count(), MAX_PIXELS),
        (image, "entries in lists of neighbours", 2 * model.pixels.neighbours.len(), MAX_NEIGHBOURS),
    ])?;
    Ok(model.pixels.surface_tables().expect("the limits hold"))
}

/// The header; its counts, its calibration and how presses are looked for are set where it is written.
fn header(skin: &Skin, model: &Model, tables: &SurfaceTables) -> PatchHeader {
    PatchHeader {
        skin: skin.name.as_str().try_into().expect("a checked skin's name fits"),
        electrodes: skin.electrodes.count,
        steps: 0,
        measurements: 0,
        pixels: 0,
        difference: skin.inverse.difference,
        neighbours: 0,
        surface: tables.scale,
        grid: tables.grid,
        drive: skin.drive.for_board(),
        contact_threshold: RelativeConductivity::from_f64(skin.contact_threshold),
        drift_time: skin.drift_time() as f32,
        calibration: Calibration::default(),
        test_resistances: test_resistances(skin, model).map(|ohms| ohms as f32).collect(),
        play_operators: 0,
        reflexes: 0,
        reflex_rows: 0,
        matrix: MatrixLayout::default(),
        detection: DetectionLayout::default(),
    }
}

/// What the sheet adds to the test of each electrode, ohm: all of the test's voltage at 1 A but the
/// drop over the electrode's own contact impedance, which in the complete model is that impedance
/// over its width, whatever the current's distribution.
fn test_resistances(skin: &Skin, model: &Model) -> impl Iterator<Item = f64> {
    let of_contact = |electrode: usize| match (&skin.electrodes.model, &model.mesh.electrodes[electrode]) {
        (ElectrodeModel::Point, _) | (_, ElectrodeContact::Node(_)) => 0.0,
        (ElectrodeModel::Complete { contact_impedance, .. }, contact) => {
            contact_impedance[electrode] / model.mesh.width(contact)
        }
    };
    let tests = model.test_voltages.iter().enumerate();
    tests.map(move |(electrode, v)| v / skin.material.sheet_conductivity - of_contact(electrode))
}

/// Error of the fixed-point image against f64, relative to the image's peak, in per cent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FixedPointError {
    /// Largest error over all pixels of the images tried.
    pub measured_percent: f64,
}

/// Tries the patch on the images of `trials` random presses: the difference data that one random
/// pixel and some noise would give, from a fixed seed.
///
/// Images that leave the range of [`RelativeConductivity`] are an error.
pub fn fixed_point_error(
    model: &Model,
    patch: &PatchView<'_>,
    trials: usize,
) -> Result<FixedPointError, PatchBuildError> {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let divisors = model.divisors();
    let mut measured_percent = 0.0_f64;
    for _ in 0..trials {
        let pixel = random.random_range(0..model.jacobian.ncols());
        let strength = model.jacobian.col(pixel).iter().fold(0.0, |max: f64, j| max.max(j.abs()));
        let mut press = |m: usize| model.jacobian[(m, pixel)] + random.random_range(-0.01..0.01) * strength;
        let relative: Vec<f32> = (0..divisors.len()).map(|m| (press(m) / divisors[m]) as f32).collect();
        measured_percent = measured_percent.max(error_of_image(model, patch, &relative)?);
    }
    Ok(FixedPointError { measured_percent })
}

fn error_of_image(model: &Model, patch: &PatchView<'_>, relative: &[f32]) -> Result<f64, PatchBuildError> {
    let matrix = &model.conductivity_from_difference;
    let exact = matrix * Col::from_fn(relative.len(), |m| f64::from(relative[m]));
    let mut data = DifferenceData::default();
    data.quantise(relative, patch.matrix().column_exponents());
    let mut image = dermatome_shared::image::Image::new();
    reconstruct(patch, &data, &mut image);
    let peak = exact.norm_max();
    let errors = image.iter().zip(exact.iter()).map(|(fixed, exact)| (fixed.to_f64() - exact).abs());
    if peak * RelativeConductivity::ONE > f64::from(i32::MAX) {
        return Err(PatchBuildError::Overflow { peak });
    }
    Ok(100.0 * errors.fold(0.0, f64::max) / peak)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::patch::matrix::coefficient_index;
    use proptest::prelude::*;
    use std::path::Path;

    proptest! {
        #[test]
        fn every_entry_is_kept_to_half_a_step_of_its_row(
            values in prop::collection::vec(-1e3..1e3_f64, 12),
            scale in prop::array::uniform3(-20..20_i32),
            columns in prop::array::uniform4(COLUMN_EXPONENTS),
        ) {
            let matrix = Mat::from_fn(3, 4, |i, j| values[4 * i + j] * f64::from(scale[i]).exp2());
            let fixed = fixed_point(&matrix, columns.to_vec(), &Interpolated::none(3)).unwrap();
            let tables = fixed.tables();
            for i in 0..3 {
                let step = (-f64::from(tables.row_exponents[i])).exp2();
                let column = |j: usize| f64::from(columns[j]).exp2();
                let largest = (0..4).fold(0.0, |max: f64, j| max.max((matrix[(i, j)] * column(j)).abs()));
                prop_assert!(step <= largest / 16_383.0 || largest == 0.0);
                for j in 0..4 {
                    let back = f64::from(tables.mantissas[coefficient_index(4, i, j)]) * step;
                    prop_assert!((back - matrix[(i, j)] * column(j)).abs() <= 0.5 * step);
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_fixed_point_cannot_hold_is_refused() {
        for value in [f64::NAN, f64::INFINITY, 1e60, 1e-60] {
            let matrix = Mat::from_fn(1, 2, |_, j| if j == 0 { value } else { 0.0 });
            let refused = fixed_point(&matrix, vec![0; 2], &Interpolated::none(1));
            assert!(matches!(refused, Err(PatchBuildError::Matrix { .. })), "{value}");
        }
    }

    #[test]
    fn images_beyond_what_a_board_holds_are_refused_by_their_peak() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/square-50mm/skin.toml");
        let skin = Skin::load(&file).unwrap().made().unwrap();
        let mut model = Model::build(&skin, |_| ()).unwrap();
        let tried = |model: &Model| {
            let bytes = patch(&skin, model).unwrap();
            fixed_point_error(model, &PatchView::validate(&bytes).unwrap(), 8)
        };
        assert!(tried(&model).unwrap().measured_percent <= 0.3);
        model.conductivity_from_difference = faer::Scale(1e6) * &model.conductivity_from_difference;
        let Err(PatchBuildError::Overflow { peak }) = tried(&model) else { panic!("it fits") };
        assert!(peak > 2048.0, "{peak}");
    }

    #[test]
    fn a_row_of_zeros_stays_zero() {
        let fixed = fixed_point(&Mat::zeros(1, 3), vec![0; 3], &Interpolated::none(1)).unwrap();
        assert!(fixed.tables().mantissas.iter().all(|&mantissa| mantissa == 0));
    }
}
