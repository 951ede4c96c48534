//! Patch: everything a board needs to sense one skin, in one file.
//!
//! ```text
//! offset  size                bytes
//! 0       4                   magic "DSKP"
//! 4       2                   format version (little-endian, like everything below)
//! 6       2                   length of the header, h
//! 8       4                   length of the whole patch
//! 12      h                   header: PatchHeader in postcard encoding, then zeros (see below)
//! ..      4 * steps           stimulation table: drive plus, drive minus, sense plus, sense minus
//! ..      2 * steps           combination: measurement each step adds to, bit 15 = subtract
//! ..      12 * pixels         where the pixels lie, see [`crate::image::surface`]
//! ..      2 * neighbours      lists of neighbouring pixels
//! ..      4 * operators       play operators of the hysteresis model: threshold and weight, u16 each
//! ..      40 * rules          reflexes, see [`reflexes`]
//! ..      rows * (36 + 4 * m) their rows: area, places, weights of the m measurements, f32
//! ..      measurements        exponents of the matrix' columns that meet data, i8
//! ..      from_data           exponents of its rows that meet data, i8
//! ..      2 * pixels          position of each pixel, u16, see [`matrix`]
//! ..      4 * interpolations  inputs and outputs of each interpolation, u16 each
//! ..      2 * inputs          positions that the interpolations take, u16
//! ..      8 * places          pixel, u16, and six neighbours, u8 each, see [`places`]
//! ..      measurements        exponents of the columns of the responses, i8; none without places
//! ..      places + known      exponents of their rows, i8
//! ..      2 * mantissas       reconstruction matrix, i16, see [`matrix::coefficient_index`]
//! ..      ..                  responses of a press at the places, then of known changes, i16, in the same order
//! ..      4                   CRC-32 (ISO-HDLC) of all bytes before it
//! ```
//!
//! A matrix entry is `mantissa * 2^-(exponent of its row + exponent of its column)`. Up to seven zeros behind the header
//! let the mantissas start at a multiple of eight, where a board reads them fastest; a reader needs none. [`PatchView`]
//! reads a patch in place, from flash or from a file; [`PatchContents::write`] is its inverse.

pub mod checksum;
mod error;
pub mod matrix;
pub mod places;
mod play_operators;
pub mod reflexes;

use crate::{
    contact::{
        calibration::Calibration,
        hysteresis::{PLAY_OPERATOR_BYTES, PlayOperator},
    },
    drive::{Drive, stimulation::Step},
    image::{
        PixelGrid,
        surface::{MAX_NEIGHBOURS, NEIGHBOUR_BYTES, PIXEL_BYTES, Pixel, Surface, SurfaceScale},
    },
    limits::{MAX_ELECTRODES, MAX_GRID_SIDE, MAX_MEASUREMENTS, MAX_PATCH_BYTES, MAX_PIXELS, MAX_STEPS},
    units::RelativeConductivity,
};
use checksum::crc32;
pub use error::PatchError;
use heapless::{String, Vec};
use matrix::{Matrix, MatrixLayout, MatrixTables};
use places::{DetectionLayout, MAX_PLACES, MAX_SMOOTH, Places, PlacesTables};
use postcard_schema::Schema;
use reflexes::{MAX_REFLEXES, RULE_BYTES, ReflexTables, most_reflex_rows, row_bytes};
use serde::{Deserialize, Serialize};

/// First bytes of every patch.
pub const MAGIC: [u8; 4] = *b"DSKP";
/// Version of the layout above.
pub const FORMAT_VERSION: u16 = 11;

const PREFIX_BYTES: usize = 12;
/// The mantissas start at a multiple of this: of what the flash reads at once.
const MATRIX_ALIGNMENT: usize = 8;
const CRC_BYTES: usize = 4;
const FLIPPED: u16 = 0x8000;

/// How difference data is made from a frame and the reference; see [`crate::pipeline::reference`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Difference {
    /// (v - v_ref) / mean |v_ref|
    Plain,
    /// (v - v_ref) / v_ref
    Normalised,
}

/// Fixed facts of a patch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PatchHeader {
    /// Name of the skin it was built for.
    pub skin: String<32>,
    /// Electrodes on the boundary.
    pub electrodes: u8,
    /// Stimulation steps in one frame.
    pub steps: u16,
    /// Measurements after reciprocal steps are combined; columns of the matrix.
    pub measurements: u16,
    /// Pixels; rows of the matrix.
    pub pixels: u16,
    /// Kind of difference data the matrix was computed for.
    pub difference: Difference,
    /// Entries of all lists of neighbours.
    pub neighbours: u16,
    /// What the numbers of the pixels' table stand for.
    pub surface: SurfaceScale,
    /// The grid whose cells the pixels are, on a flat skin with one: for viewers.
    pub grid: Option<PixelGrid>,
    /// How the skin is driven.
    pub drive: Drive,
    /// Smallest peak that counts as a contact.
    pub contact_threshold: RelativeConductivity,
    /// Time in which the reference follows an untouched skin, s; 0 leaves it as it was averaged.
    pub drift_time: f32,
    /// Pressure and load area of a contact; empty if the skin is not calibrated.
    pub calibration: Calibration,
    /// What the model expects of each electrode's test ([`crate::acquire::scan::test_step`]) without contact
    /// impedance, ohm: `[electrode]`; empty if unknown.
    pub test_resistances: Vec<f32, MAX_ELECTRODES>,
    /// Play operators of the hysteresis model ([`crate::contact::hysteresis`]); 0 takes strengths as they are.
    // Its name in reports stays.
    #[serde(rename = "plays")]
    pub play_operators: u8,
    /// Rules by which the board acts by itself; 0 has it only sense.
    pub reflexes: u8,
    /// Rows of all of them.
    pub reflex_rows: u8,
    /// How large the parts of the matrix are.
    pub matrix: MatrixLayout,
    /// How presses are looked for in the data.
    pub detection: DetectionLayout,
}

impl PatchHeader {
    /// Whether contacts are found in the data, at the patch's places, and not in the image.
    #[must_use]
    pub fn has_places(&self) -> bool {
        self.detection.places > 0
    }
}

/// Where one step's code goes: the measurement it adds to, or subtracts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CombinedInto {
    /// Index of the measurement.
    pub measurement: u16,
    /// Whether the code is subtracted.
    pub flipped: bool,
}

impl CombinedInto {
    fn to_bytes(self) -> [u8; 2] {
        (self.measurement | if self.flipped { FLIPPED } else { 0 }).to_le_bytes()
    }

    fn from_bytes(bytes: [u8; 2]) -> Self {
        let word = u16::from_le_bytes(bytes);
        Self { measurement: word & !FLIPPED, flipped: word & FLIPPED != 0 }
    }
}

/// What a patch holds, for writing one.
#[derive(Clone, Copy, Debug)]
pub struct PatchContents<'a> {
    /// Fixed facts; its counts must match the tables.
    pub header: &'a PatchHeader,
    /// Stimulation table: `[step]`.
    pub steps: &'a [Step],
    /// Where each step's code goes: `[step]`.
    pub combination: &'a [CombinedInto],
    /// Where the pixels lie: `[pixel]`.
    pub pixels: &'a [Pixel],
    /// Neighbours of all pixels, list after list.
    pub neighbours: &'a [u16],
    /// The reconstruction matrix.
    pub matrix: MatrixTables<'a>,
    /// Where presses are looked for.
    pub places: PlacesTables<'a>,
    /// Play operators of the hysteresis model.
    pub play_operators: &'a [PlayOperator],
    /// Rules by which the board acts by itself.
    pub reflexes: ReflexTables<'a>,
}

impl PatchContents<'_> {
    /// Writes the patch into `out` and gives its length; `None` if `out` is too short.
    ///
    /// [`PatchView::validate`] says whether the tables fit each other.
    pub fn write(&self, out: &mut [u8]) -> Option<usize> {
        let postcard_bytes = postcard::to_slice(self.header, out.get_mut(PREFIX_BYTES..)?).ok()?.len();
        let header_bytes = self.align_matrix(postcard_bytes);
        let mut end = PREFIX_BYTES + header_bytes;
        out.get_mut(PREFIX_BYTES + postcard_bytes..end)?.fill(0);
        let mut put = |bytes: &[u8]| {
            out.get_mut(end..end + bytes.len())?.copy_from_slice(bytes);
            end += bytes.len();
            Some(())
        };
        self.steps.iter().try_for_each(|step| put(&step.to_bytes()))?;
        self.combination.iter().try_for_each(|target| put(&target.to_bytes()))?;
        self.pixels.iter().try_for_each(|pixel| put(&pixel.to_bytes()))?;
        self.neighbours.iter().try_for_each(|pixel| put(&pixel.to_le_bytes()))?;
        self.play_operators.iter().try_for_each(|operator| put(&operator.to_bytes()))?;
        self.reflexes.put(&mut put)?;
        self.matrix.put(&mut put)?;
        self.places.put(&mut put)?;
        let mut mantissas = self.matrix.mantissas.iter().chain(self.places.mantissas);
        mantissas.try_for_each(|mantissa| put(&mantissa.to_le_bytes()))?;
        let total = end + CRC_BYTES;
        out.get_mut(..4)?.copy_from_slice(&MAGIC);
        out.get_mut(4..6)?.copy_from_slice(&FORMAT_VERSION.to_le_bytes());
        out.get_mut(6..8)?.copy_from_slice(&u16::try_from(header_bytes).ok()?.to_le_bytes());
        out.get_mut(8..12)?.copy_from_slice(&u32::try_from(total).ok()?.to_le_bytes());
        let crc = crc32(&[out.get(..end)?]);
        out.get_mut(end..total)?.copy_from_slice(&crc.to_le_bytes());
        Some(total)
    }

    /// The header's length with the zeros that align the matrix.
    fn align_matrix(&self, header_bytes: usize) -> usize {
        let before = PREFIX_BYTES + table_sizes(self.header)[..TABLES].iter().sum::<usize>();
        (before + header_bytes).next_multiple_of(MATRIX_ALIGNMENT) - before
    }
}

/// The patch that `bytes` start with, by the length it states; nothing of it is checked.
#[must_use]
pub fn at_start(bytes: &[u8]) -> Option<&[u8]> {
    let [m0, m1, m2, m3, _, _, _, _, t0, t1, t2, t3] = *bytes.first_chunk::<PREFIX_BYTES>()?;
    let total = u32::from_le_bytes([t0, t1, t2, t3]) as usize;
    if [m0, m1, m2, m3] == MAGIC { bytes.get(..total) } else { None }
}

/// A patch read in place.
#[derive(Clone, Debug)]
pub struct PatchView<'a> {
    /// Fixed facts.
    pub header: PatchHeader,
    bytes: &'a [u8],
    steps: &'a [u8],
    combination: &'a [u8],
    pixels: &'a [u8],
    neighbours: &'a [u8],
    matrix: Matrix<'a>,
    places: Places<'a>,
    play_operators: &'a [u8],
    reflex_rules: &'a [u8],
    reflex_rows: &'a [u8],
}

impl<'a> PatchView<'a> {
    /// Reads and checks everything: use it on bytes from outside.
    pub fn validate(bytes: &'a [u8]) -> Result<Self, PatchError> {
        let view = Self::open(bytes)?;
        let computed = crc32(&[&bytes[..bytes.len() - CRC_BYTES]]);
        if view.crc() != computed {
            return Err(PatchError::Crc { found: view.crc(), computed });
        }
        view.check_counts()?;
        view.check_tables()?;
        view.matrix.check()?;
        view.places.check(&view.header.detection, view.header.pixels)?;
        view.check_play_operators()?;
        view.check_reflexes()?;
        Ok(view)
    }

    /// Finds the tables without checking their content: quick, for bytes validated before.
    pub fn open(bytes: &'a [u8]) -> Result<Self, PatchError> {
        let (view, total) = Self::open_start(bytes)?;
        let found = bytes.len();
        if total == found { Ok(view) } else { Err(PatchError::Length { expected: total, found }) }
    }

    /// The start of a patch, as far as a host has read it back from a board, up to the matrix, which
    /// may be cut off; with the length of the whole.
    ///
    /// Too few bytes are a [`PatchError::Length`] that says how many would do at least. Nothing is
    /// checked but what finding the tables needs.
    pub fn open_start(bytes: &'a [u8]) -> Result<(Self, usize), PatchError> {
        let (header_bytes, total) = lengths(bytes)?;
        let header = bytes.get(PREFIX_BYTES..PREFIX_BYTES + header_bytes);
        let expected = PREFIX_BYTES + header_bytes;
        let header = header.ok_or(PatchError::Length { expected, found: bytes.len() })?;
        let header = postcard::from_bytes(header).map_err(|_| PatchError::Header)?;
        Ok((Self::find_tables(header, bytes, header_bytes, total)?, total))
    }

    /// As [`Self::open`], with the header that was read from the same bytes before: quicker still.
    pub fn reopen(header: PatchHeader, bytes: &'a [u8]) -> Result<Self, PatchError> {
        let (header_bytes, total) = lengths(bytes)?;
        Self::find_tables(header, bytes, header_bytes, total)
    }

    // Once on the board, for all that asks.
    #[inline(never)]
    fn find_tables(
        header: PatchHeader,
        bytes: &'a [u8],
        header_bytes: usize,
        total: usize,
    ) -> Result<Self, PatchError> {
        let sizes = table_sizes(&header);
        let start = PREFIX_BYTES + header_bytes + sizes[..TABLES].iter().sum::<usize>();
        let expected = start + sizes[TABLES] + sizes[TABLES + 1] + CRC_BYTES;
        if expected != total {
            return Err(PatchError::Length { expected, found: total });
        }
        let found = bytes.len();
        let tables = bytes.get(PREFIX_BYTES + header_bytes..start);
        let tables = tables.ok_or(PatchError::Length { expected: start, found })?;
        let (steps, tables) = tables.split_at(sizes[0]);
        let (combination, tables) = tables.split_at(sizes[1]);
        let (pixels, tables) = tables.split_at(sizes[2]);
        let (neighbours, tables) = tables.split_at(sizes[3]);
        let (play_operators, tables) = tables.split_at(sizes[4]);
        let (reflex_rules, tables) = tables.split_at(sizes[5]);
        let (reflex_rows, tables) = tables.split_at(sizes[6]);
        let (column_exponents, tables) = tables.split_at(sizes[7]);
        let (row_exponents, tables) = tables.split_at(sizes[8]);
        let (positions, tables) = tables.split_at(sizes[9]);
        let (interpolations, tables) = tables.split_at(sizes[10]);
        let (inputs, tables) = tables.split_at(sizes[11]);
        let (places, tables) = tables.split_at(sizes[12]);
        let (response_columns, response_rows) = tables.split_at(sizes[13]);
        let end = start + sizes[TABLES];
        let mantissas = bytes.get(start..end).unwrap_or_default();
        let responses = bytes.get(end..end + sizes[TABLES + 1]).unwrap_or_default();
        let matrix =
            Matrix::new([column_exponents, row_exponents, positions, interpolations, inputs, mantissas]);
        let places = Places::new([places, response_columns, response_rows, responses]);
        Ok(Self {
            header,
            bytes,
            steps,
            combination,
            pixels,
            neighbours,
            play_operators,
            reflex_rules,
            reflex_rows,
            matrix,
            places,
        })
    }

    /// All bytes of the patch.
    #[must_use]
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The checksum the patch carries, which also identifies it.
    #[must_use]
    pub fn crc(&self) -> u32 {
        let last = self.bytes.last_chunk::<CRC_BYTES>();
        last.map_or(0, |crc| u32::from_le_bytes(*crc))
    }

    /// Stimulation table: `[step]`.
    pub fn steps(&self) -> impl Iterator<Item = Step> + use<'a> {
        self.steps.chunks_exact(4).map(|b| Step::from_bytes([b[0], b[1], b[2], b[3]]))
    }

    /// Where each step's code goes: `[step]`.
    pub fn combination(&self) -> impl Iterator<Item = CombinedInto> + use<'a> {
        self.combination.chunks_exact(2).map(|b| CombinedInto::from_bytes([b[0], b[1]]))
    }

    /// Where the pixels lie.
    #[must_use]
    pub fn surface(&self) -> Surface<'a> {
        Surface::new(self.header.surface, self.pixels, self.neighbours)
    }

    /// The reconstruction matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix<'a> {
        self.matrix
    }

    /// Where presses are looked for; none if contacts are found in the image.
    #[must_use]
    pub fn places(&self) -> Places<'a> {
        self.places
    }

    fn check_counts(&self) -> Result<(), PatchError> {
        let header = &self.header;
        let range = |field, value: usize, min, max| {
            if (min..=max).contains(&value) {
                Ok(())
            } else {
                Err(PatchError::Range { field, value, min, max })
            }
        };
        range("length", self.bytes.len(), 0, MAX_PATCH_BYTES)?;
        range("electrodes", header.electrodes.into(), 4, MAX_ELECTRODES)?;
        range("steps", header.steps.into(), 1, MAX_STEPS)?;
        range("measurements", header.measurements.into(), 1, MAX_MEASUREMENTS)?;
        range("pixels", header.pixels.into(), 1, MAX_PIXELS)?;
        range("neighbours", header.neighbours.into(), 0, MAX_NEIGHBOURS)?;
        range("reflexes", header.reflexes.into(), 0, MAX_REFLEXES)?;
        range("reflex_rows", header.reflex_rows.into(), 0, most_reflex_rows(header.measurements.into()))?;
        range("detection.places", header.detection.places.into(), 0, MAX_PLACES)?;
        range("detection.smooth", header.detection.smooth.into(), 0, MAX_SMOOTH)?;
        range("detection.slips", header.detection.slips.into(), 0, MAX_ELECTRODES)?;
        range("matrix.from_data", header.matrix.from_data.into(), 1, header.pixels.into())?;
        let positive = |field, value: f32| {
            if value.is_finite() && value > 0.0 { Ok(()) } else { Err(PatchError::NotPositive { field }) }
        };
        if let Some(grid) = &header.grid {
            range("grid.columns", grid.columns.into(), 1, MAX_GRID_SIDE)?;
            range("grid.rows", grid.rows.into(), 1, MAX_GRID_SIDE)?;
            positive("grid.pitch", grid.pitch)?;
            positive("grid.left", grid.left.abs() + 1.0)?;
            positive("grid.top", grid.top.abs() + 1.0)?;
        }
        positive("contact_threshold", header.contact_threshold.to_f32())?;
        positive("drift_time", header.drift_time + 1.0)?;
        header.drive.check().map_err(|field| PatchError::Drive { field })?;
        if !header.calibration.is_valid() {
            return Err(PatchError::Calibration);
        }
        let tests = header.test_resistances.len();
        let wanted = if tests == 0 { 0 } else { usize::from(header.electrodes) };
        range("test_resistances", tests, wanted, wanted)?;
        header.test_resistances.iter().try_for_each(|&ohms| positive("test_resistances", ohms.abs() + 1.0))
    }

    fn check_tables(&self) -> Result<(), PatchError> {
        if let Some(step) = self.steps().position(|step| !step.is_valid(self.header.electrodes)) {
            return Err(PatchError::Step { step });
        }
        let mut covered = [false; MAX_MEASUREMENTS];
        let measurements = usize::from(self.header.measurements);
        for target in self.combination() {
            let measurement = usize::from(target.measurement);
            if measurement >= measurements {
                return Err(PatchError::Combination { measurement });
            }
            covered[measurement] = true;
        }
        if let Some(measurement) = covered[..measurements].iter().position(|&covered| !covered) {
            return Err(PatchError::Combination { measurement });
        }
        Ok(self.surface().check()?)
    }
}

/// Lengths of the header and of the whole patch, as the patch's first bytes state them.
fn lengths(bytes: &[u8]) -> Result<(usize, usize), PatchError> {
    let too_short = PatchError::Length { expected: PREFIX_BYTES, found: bytes.len() };
    let [m0, m1, m2, m3, v0, v1, h0, h1, t0, t1, t2, t3] = *bytes.first_chunk().ok_or(too_short)?;
    if [m0, m1, m2, m3] != MAGIC {
        return Err(PatchError::Magic);
    }
    let version = u16::from_le_bytes([v0, v1]);
    if version != FORMAT_VERSION {
        return Err(PatchError::Version { found: version });
    }
    Ok((u16::from_le_bytes([h0, h1]).into(), u32::from_le_bytes([t0, t1, t2, t3]) as usize))
}

/// Tables before the matrix.
const TABLES: usize = 15;

/// Bytes of the tables, the mantissas of matrix and responses last.
fn table_sizes(header: &PatchHeader) -> [usize; TABLES + 2] {
    let [steps, pixels, neighbours] = [header.steps, header.pixels, header.neighbours].map(usize::from);
    let play_operators = PLAY_OPERATOR_BYTES * usize::from(header.play_operators);
    let reflex_rules = RULE_BYTES * usize::from(header.reflexes);
    let reflex_rows = row_bytes(header.reflex_rows.into(), header.measurements.into());
    let [column_exponents, row_exponents, positions, interpolations, inputs, mantissas] =
        header.matrix.sizes(header.measurements, header.pixels);
    let [places, response_columns, response_rows, responses] = header.detection.sizes(header.measurements);
    [
        4 * steps,
        2 * steps,
        PIXEL_BYTES * pixels,
        NEIGHBOUR_BYTES * neighbours,
        play_operators,
        reflex_rules,
        reflex_rows,
        column_exponents,
        row_exponents,
        positions,
        interpolations,
        inputs,
        places,
        response_columns,
        response_rows,
        mantissas,
        responses,
    ]
}

#[cfg(test)]
pub(crate) mod tests;
