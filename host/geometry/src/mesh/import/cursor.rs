//! The next field of a file, text or binary, from bytes nobody vouches for.
//!
//! One cursor serves all formats, because PLY and MSH hold the same fields in the same order as text
//! and as binary. It never reads past the end, and it knows where the last field began, so that an
//! error can name the place.

use super::error::{Place, Problem};
use nalgebra::Point3;
use std::{fmt::Display, str::FromStr};

/// Coordinates beyond this are refused: their squares and products must stay finite.
pub(super) const MAX_COORDINATE: f64 = 1e30;
/// Most characters of a wrong field that an error repeats.
const MAX_SHOWN: usize = 40;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a number in a binary file; text does not care about its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::F64 => 8,
        }
    }

    pub(super) fn is_real(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The number that these bits stand for, if it is an integer.
    fn integer(self, bits: u64) -> i64 {
        let unused = 64 - 8 * self.bytes();
        match self {
            Self::U8 | Self::U16 | Self::U32 => bits as i64,
            _ => (bits << unused) as i64 >> unused,
        }
    }

    fn real(self, bits: u64) -> f64 {
        match self {
            Self::F32 => f32::from_bits(bits as u32).into(),
            Self::F64 => f64::from_bits(bits),
            _ => self.integer(bits) as f64,
        }
    }
}

/// What is left of a file.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the last field began.
    start: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Cursor<'a> {
    /// The beginning of a text.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, start: 0, encoding: Encoding::Text }
    }

    /// A real number; an integer where the file says so.
    pub(super) fn real(&mut self, kind: Scalar, field: &'static str) -> Result<f64, Problem> {
        match self.encoding {
            Encoding::Text => self.parsed(field, "a number"),
            _ => Ok(kind.real(self.bits(kind, field)?)),
        }
    }

    /// An integer.
    pub(super) fn integer(&mut self, kind: Scalar, field: &'static str) -> Result<i64, Problem> {
        match self.encoding {
            Encoding::Text => self.parsed(field, "a whole number"),
            _ => Ok(kind.integer(self.bits(kind, field)?)),
        }
    }

    /// An integer that is not negative.
    pub(super) fn natural(&mut self, kind: Scalar, field: &'static str) -> Result<usize, Problem> {
        let found = self.integer(kind, field)?;
        found.try_into().map_err(|_| self.wrong(field, &found, "a whole number from 0"))
    }

    /// The number of things that follow, each of them at least `bytes_each` bytes long.
    pub(super) fn count(
        &mut self,
        kind: Scalar,
        bytes_each: usize,
        field: &'static str,
    ) -> Result<usize, Problem> {
        let found = self.natural(kind, field)?;
        self.check_count(found, bytes_each, field)
    }

    /// `found`, if as many things of at least `bytes_each` bytes could follow.
    pub(super) fn check_count(
        &self,
        found: usize,
        bytes_each: usize,
        field: &'static str,
    ) -> Result<usize, Problem> {
        // The last field of a text needs no separator behind it.
        let separator = usize::from(self.encoding == Encoding::Text);
        let most = (self.rest().len() + separator) / bytes_each.max(1);
        if found <= most {
            Ok(found)
        } else {
            Err(Problem::Count { place: self.place(), field, found, most })
        }
    }

    /// A finite coordinate, in the file's unit.
    pub(super) fn coordinate(&mut self, kind: Scalar, field: &'static str) -> Result<f64, Problem> {
        let found = self.real(kind, field)?;
        self.check_coordinate(found, field)
    }

    pub(super) fn check_coordinate(&self, found: f64, field: &'static str) -> Result<f64, Problem> {
        // Not a number fails the comparison.
        let usable = found.abs() <= MAX_COORDINATE;
        let allowed = || format!("a finite number of at most {MAX_COORDINATE:e}");
        if usable { Ok(found) } else { Err(self.wrong(field, &found, allowed())) }
    }

    /// Three coordinates.
    pub(super) fn point(&mut self, kind: Scalar) -> Result<Point3<f64>, Problem> {
        let x = self.coordinate(kind, "x of a vertex")?;
        let y = self.coordinate(kind, "y of a vertex")?;
        Ok(Point3::new(x, y, self.coordinate(kind, "z of a vertex")?))
    }

    /// The next word of a text.
    pub(super) fn word(&mut self, field: &'static str) -> Result<&'a [u8], Problem> {
        self.skip_blank();
        let length = self.rest().iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest().len());
        if length == 0 { Err(self.truncated(field)) } else { self.take(length, field) }
    }

    /// The next word of a text, which must be this one in whatever case.
    pub(super) fn keyword(&mut self, expected: &'static str) -> Result<(), Problem> {
        let found = self.word(expected)?;
        let equal = found.eq_ignore_ascii_case(expected.as_bytes());
        if equal { Ok(()) } else { Err(self.wrong("a keyword", &Shown(found), format!("`{expected}`"))) }
    }

    /// The rest of this line without its end.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == b'\n');
        self.start = self.at;
        self.at += end.map_or(rest.len(), |end| end + 1);
        let line = &rest[..end.unwrap_or(rest.len())];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The rest of this line, with the lines that a backslash at its end adds to it.
    pub(super) fn continued_line(&mut self) -> Option<&'a [u8]> {
        let start = self.at;
        while self.line()?.ends_with(b"\\") && !self.rest().is_empty() {}
        self.start = start;
        Some(&self.bytes[start..self.at])
    }

    /// The next `length` bytes.
    pub(super) fn take(&mut self, length: usize, field: &'static str) -> Result<&'a [u8], Problem> {
        let taken = self.rest().get(..length).ok_or_else(|| self.truncated(field))?;
        self.start = self.at;
        self.at += length;
        Ok(taken)
    }

    pub(super) fn skip_blank(&mut self) {
        let blank = self.rest().iter().position(|byte| !byte.is_ascii_whitespace());
        self.at += blank.unwrap_or(self.rest().len());
    }

    /// What has not been read.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Fewest bytes that a number of this type takes; in a text, a digit and a blank.
    pub(super) fn least_bytes(&self, kind: Scalar) -> usize {
        if self.encoding == Encoding::Text { 2 } else { kind.bytes() }
    }

    /// Where the last field began.
    pub(super) fn place(&self) -> Place {
        self.place_of(self.start)
    }

    /// The last field has a value that is not allowed.
    pub(super) fn wrong(
        &self,
        field: &'static str,
        found: &dyn Display,
        allowed: impl Into<String>,
    ) -> Problem {
        Problem::Value { place: self.place(), field, found: found.to_string(), allowed: allowed.into() }
    }

    fn truncated(&self, field: &'static str) -> Problem {
        Problem::Truncated { place: self.place_of(self.bytes.len()), field }
    }

    fn place_of(&self, offset: usize) -> Place {
        match self.encoding {
            Encoding::Text => {
                Place::Line(1 + self.bytes[..offset].iter().filter(|&&byte| byte == b'\n').count())
            }
            _ => Place::Byte(offset),
        }
    }

    fn parsed<T: FromStr>(&mut self, field: &'static str, allowed: &str) -> Result<T, Problem> {
        let word = self.word(field)?;
        parse(word).ok_or_else(|| self.wrong(field, &Shown(word), allowed))
    }

    /// The bits of a binary number, right-aligned.
    fn bits(&mut self, kind: Scalar, field: &'static str) -> Result<u64, Problem> {
        let taken = self.take(kind.bytes(), field)?;
        let mut word = [0; 8];
        word[..taken.len()].copy_from_slice(taken);
        if self.encoding == Encoding::BigEndian {
            word[..taken.len()].reverse();
        }
        Ok(u64::from_le_bytes(word))
    }
}

/// The number that a word of a text is.
pub(super) fn parse<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Bytes of a text as an error repeats them.
pub(super) struct Shown<'a>(pub(super) &'a [u8]);

impl Display for Shown<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = String::from_utf8_lossy(&self.0[..self.0.len().min(4 * MAX_SHOWN)]);
        let mut shown = text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c });
        let start: String = shown.by_ref().take(MAX_SHOWN).collect();
        write!(f, "{start}{}", if shown.next().is_some() { "..." } else { "" })
    }
}
