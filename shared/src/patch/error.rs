//! Why bytes are not a usable patch.

use super::FORMAT_VERSION;
use crate::{image::surface::SurfaceError, limits::REFLEX_PINS};

/// Why bytes are not a usable patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatchError {
    /// The first four bytes are wrong.
    #[error("not a patch: it does not start with \"DSKP\"")]
    Magic,
    /// Made for another version of the format.
    #[error("patch format version {found} is unknown (this build reads version {FORMAT_VERSION})")]
    Version {
        /// Version in the file.
        found: u16,
    },
    /// Shorter or longer than it says, or than its tables need.
    #[error("patch is truncated or too long: it holds {found} bytes where {expected} are expected")]
    Length {
        /// Bytes expected.
        expected: usize,
        /// Bytes there.
        found: usize,
    },
    /// The checksum does not match.
    #[error("patch is damaged: CRC-32 is {found:#010x}, its content gives {computed:#010x}")]
    Crc {
        /// Checksum in the file.
        found: u32,
        /// Checksum of the content.
        computed: u32,
    },
    /// The header cannot be decoded.
    #[error("patch header cannot be decoded")]
    Header,
    /// A count is outside what a board can hold.
    #[error("patch field `{field}` is {value}, allowed are {min} to {max}")]
    Range {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: usize,
        /// Least allowed.
        min: usize,
        /// Most allowed.
        max: usize,
    },
    /// A number that must be finite and positive is not.
    #[error("patch field `{field}` must be a finite number above zero")]
    NotPositive {
        /// Name of the field.
        field: &'static str,
    },
    /// The drive is not one that any board could follow.
    #[error("patch field `{field}` is out of range")]
    Drive {
        /// Name of the field, with what is allowed.
        field: &'static str,
    },
    /// The calibration curve does not rise, or is not finite, or its share is none.
    #[error(
        "patch field `calibration` must rise from point to point, and have a `load_share` above zero or none"
    )]
    Calibration,
    /// The threshold of a play operator lies below the strength itself.
    #[error("patch play operator {operator} has a `threshold` below 1, allowed are 1 to 15.99")]
    PlayOperator {
        /// Index of the operator.
        operator: usize,
    },
    /// A reflex is not one that a board can follow, or wants a force of a skin that is not calibrated.
    #[error(
        "patch reflex {rule} is none: allowed are limits above zero, a `release` of 0 to 1, `frames` of 1 or more, pins 1 to \
         {REFLEX_PINS}, and forces where the skin is calibrated"
    )]
    ReflexRule {
        /// Index of the rule.
        rule: usize,
    },
    /// The rows of the reflexes are not those that their rules need.
    #[error("patch holds wrong rows for its reflexes, which need {rows}")]
    ReflexRows {
        /// Rows that the rules need.
        rows: usize,
    },
    /// A stimulation step names a missing electrode, or one electrode twice in a pair.
    #[error("patch step {step} does not name pairs of two different electrodes")]
    Step {
        /// Index of the step.
        step: usize,
    },
    /// A step adds to a measurement that does not exist, or a measurement gets no step.
    #[error("patch combines its steps wrongly at measurement {measurement}")]
    Combination {
        /// Index of the measurement.
        measurement: usize,
    },
    /// A place is no pixel, or has a neighbour that does not exist.
    #[error("patch place {place} names a pixel or neighbour that does not exist")]
    Place {
        /// Index of the place.
        place: usize,
    },
    /// The exponent of a column of the matrix is out of range.
    #[error("patch matrix has an exponent out of range at measurement {measurement}, allowed are -30 to 30")]
    ColumnExponent {
        /// Index of the measurement.
        measurement: usize,
    },
    /// A pixel's position is another's too, or does not exist.
    #[error("patch gives pixel {pixel} a position that another has or none can have")]
    Position {
        /// Index of the pixel.
        pixel: usize,
    },
    /// An interpolation takes pixels that are not known yet, or too many, or makes none; the number of
    /// interpolations if they do not make all pixels, or leave inputs or mantissas over.
    #[error("patch interpolation {interpolation} does not go from known pixels to the next ones")]
    Interpolation {
        /// Index of the interpolation.
        interpolation: usize,
    },
    /// A row of the matrix could overflow 32 bits.
    #[error("patch matrix row {row} has mantissas whose products could overflow")]
    Row {
        /// Position of the row.
        row: usize,
    },
    /// A pixel without area or normal, or with a neighbour that does not exist; the number of pixels if
    /// entries are left over behind the last list.
    #[error("patch holds a wrong normal, area or list of neighbours at pixel {pixel}")]
    Pixel {
        /// Index of the pixel.
        pixel: usize,
    },
}

impl From<SurfaceError> for PatchError {
    fn from(error: SurfaceError) -> Self {
        match error {
            SurfaceError::Scale => Self::NotPositive { field: "surface" },
            SurfaceError::Pixel { pixel } => Self::Pixel { pixel },
        }
    }
}
