//! Write: the one place where a patch becomes bytes.

use crate::{matrix::FixedMatrix, places::FixedPlaces, reflexes::Reflexes, tables::SurfaceTables};
use dermatome_shared::{
    calibration::Calibration,
    hysteresis::PlayOperator,
    patch::{
        CombinedInto, PatchContents, PatchError, PatchHeader, PatchView, checksum::crc32,
        reflexes::ReflexTables,
    },
    stimulation::Step,
    surface::Pixel,
};

/// Header and tables stay below this; the rest of a patch are its mantissas.
const TABLE_BYTES: usize = 64 * 1024;

/// What `calibrate` stores in a patch, so that another patch of the same skin can have it too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stored {
    /// Pressure and load area by strength.
    pub curve: Calibration,
    /// Play operators against hysteresis.
    pub play_operators: Vec<PlayOperator>,
}

impl Stored {
    /// Those of a patch.
    #[must_use]
    pub fn of(patch: &PatchView<'_>) -> Self {
        Self { curve: patch.header.calibration.clone(), play_operators: patch.play_operators().collect() }
    }

    /// A curve alone.
    #[must_use]
    pub fn curve(curve: Calibration) -> Self {
        Self { curve, play_operators: Vec::new() }
    }

    /// Whether there is neither curve nor play operator.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.curve.points.is_empty() && self.play_operators.is_empty()
    }
}

/// All that a patch holds but its calibration.
///
/// The header's counts need not be set: they become those of the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// Fixed facts.
    pub header: PatchHeader,
    /// Stimulation table: `[step]`.
    pub steps: Vec<Step>,
    /// Where each step's code goes: `[step]`.
    pub combination: Vec<CombinedInto>,
    /// Where the pixels lie.
    pub surface: SurfaceTables,
    /// The reconstruction matrix.
    pub matrix: FixedMatrix,
    /// Where presses are looked for.
    pub places: FixedPlaces,
    /// What the board does by itself.
    pub reflexes: Reflexes,
}

impl Contents {
    /// Those of a patch.
    #[must_use]
    pub fn read(patch: &PatchView<'_>) -> Self {
        let (steps, combination) = patch.steps().zip(patch.combination()).unzip();
        Self {
            header: patch.header.clone(),
            steps,
            combination,
            surface: SurfaceTables::read(patch),
            matrix: FixedMatrix::read(&patch.matrix()),
            places: FixedPlaces::read(patch),
            reflexes: Reflexes::read(patch),
        }
    }

    /// The patch with this calibration, checked.
    pub fn write(&self, stored: &Stored) -> Result<Vec<u8>, PatchError> {
        let header = self.header(stored);
        let rows = self.reflexes.rows();
        let contents = PatchContents {
            play_operators: &stored.play_operators,
            reflexes: ReflexTables { rules: &self.reflexes.rules, rows: &rows },
            header: &header,
            steps: &self.steps,
            combination: &self.combination,
            pixels: &self.surface.pixels,
            neighbours: &self.surface.neighbours,
            matrix: self.matrix.tables(),
            places: self.places.tables(),
        };
        let mantissas = contents.matrix.mantissas.len() + contents.places.mantissas.len();
        let mut bytes = vec![0; TABLE_BYTES + 2 * mantissas];
        let length = contents.write(&mut bytes).expect("the buffer holds the tables");
        bytes.truncate(length);
        PatchView::validate(&bytes)?;
        Ok(bytes)
    }

    /// The header with the counts of the tables.
    fn header(&self, stored: &Stored) -> PatchHeader {
        let measurements = self.combination.iter().map(|target| target.measurement + 1).max();
        PatchHeader {
            steps: self.steps.len() as u16,
            measurements: measurements.unwrap_or(0),
            pixels: self.surface.pixels.len() as u16,
            matrix: self.matrix.tables().layout(),
            neighbours: self.surface.neighbours.len() as u16,
            detection: self.places.layout(),
            calibration: stored.curve.clone(),
            play_operators: stored.play_operators.len() as u8,
            reflexes: self.reflexes.rules.len() as u8,
            reflex_rows: self.reflexes.rows.len() as u8,
            ..self.header.clone()
        }
    }
}

/// The patch `bytes` with another calibration; all else stays.
pub fn with_calibration(bytes: &[u8], stored: &Stored) -> Result<Vec<u8>, PatchError> {
    Contents::read(&PatchView::validate(bytes)?).write(stored)
}

/// Checksum of what strengths are in units of: the responses at places, or the matrix where contacts are found in the image.
#[must_use]
pub fn units_crc(patch: &PatchView<'_>) -> u32 {
    let (places, matrix) = (patch.places(), patch.matrix());
    let (exponents, mantissas): (Vec<u8>, _) = if patch.header.has_places() {
        (places.row_exponents().map(i8::cast_unsigned).collect(), places.mantissas())
    } else {
        (matrix.row_exponents().map(i8::cast_unsigned).collect(), matrix.mantissas())
    };
    crc32(&[&exponents, mantissas])
}

/// Centres, m, of what a patch has gains of: of its places, or of its pixels where contacts are found in the image.
#[must_use]
pub fn gain_centres(patch: &PatchView<'_>) -> Vec<[f64; 3]> {
    let surface = patch.surface();
    let centre = |pixel: Pixel| surface.centre(&pixel).map(f64::from);
    if patch.header.has_places() {
        patch.places().iter().filter_map(|place| surface.pixel(place.pixel.into())).map(centre).collect()
    } else {
        surface.pixels().map(centre).collect()
    }
}

/// Whether a patch can have gains: not where pixels of the image that contacts are found in are interpolated from each other.
#[must_use]
pub fn takes_gains(patch: &PatchView<'_>) -> bool {
    patch.header.has_places() || patch.matrix().interpolations().next().is_none()
}

/// The patch `bytes` for a skin that reads these factors more, in the order of [`gain_centres`]: the board takes strengths for as
/// much less. One that does not take gains stays as it is.
///
/// # Panics
/// Panics if there is not a gain above zero for each centre.
pub fn with_gains(bytes: &[u8], gains: &[f64]) -> Result<Vec<u8>, PatchError> {
    let patch = PatchView::validate(bytes)?;
    let mut contents = Contents::read(&patch);
    if patch.header.has_places() {
        contents.places = contents.places.with_gains(gains);
        contents.reflexes = contents.reflexes.with_gains(gains);
    } else if takes_gains(&patch) {
        contents.matrix = contents.matrix.clone().with_gains(gains).unwrap_or(contents.matrix);
    }
    contents.write(&Stored::of(&patch))
}

/// The patch `bytes` with the gains of another; none if that is not of the same places.
pub fn with_gains_of(bytes: &[u8], other: &PatchView<'_>) -> Result<Option<Vec<u8>>, PatchError> {
    let patch = PatchView::validate(bytes)?;
    let (contents, others) = (Contents::read(&patch), FixedPlaces::read(other));
    if !others.differ_by_gains(&contents.places) {
        return Ok(None);
    }
    let places = contents.places.with_responses_of(others);
    Contents { places, ..contents }.write(&Stored::of(&patch)).map(Some)
}

/// Whether two patches turn the same voltages into the same images, so that a curve of one suits the other.
#[must_use]
pub fn have_same_matrix(a: &PatchView<'_>, b: &PatchView<'_>) -> bool {
    let is_same_combination = || a.steps().eq(b.steps()) && a.combination().eq(b.combination());
    a.matrix() == b.matrix() && is_same_combination()
}
