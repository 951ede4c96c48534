//! NumPy's array format: header and elements of one `.npy` file, read from bytes nobody vouches for, and written.
//!
//! ```text
//! 0   magic "\x93NUMPY", version major, minor
//! 8   length of the header: u16 in version 1, u32 in versions 2 and 3, little-endian
//! ..  header: {'descr': '<c16', 'fortran_order': False, 'shape': (255, 208), }
//! ..  elements
//! ```
//!
//! Nothing is allocated before the bytes are known to be there, whatever length and shape the header claims.
//! Format: numpy.lib.format, NEP 1.

use super::{Array, MAX_VALUES, Numbers, Values, show_shape};
use num_complex::Complex64;
use std::io::{self, Write};

/// Longest header that is read, bytes; NumPy itself refuses longer ones.
pub(super) const MAX_HEADER_BYTES: usize = 10_000;
/// Bytes that surely hold any allowed header with its prefix.
pub(super) const HEADER_WINDOW: usize = MAX_HEADER_BYTES + 12;

/// Bytes that the elements are aligned to, as NumPy does.
const ALIGNMENT: usize = 64;

const ALLOWED_TYPES: &str = "float64, float32, complex128, complex64, bool and integers";

/// Why bytes are not an array of numbers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NpyError {
    /// The first bytes are wrong.
    #[error("not a NumPy array: it does not start with \\x93NUMPY")]
    Magic,
    /// Made for another version of the format.
    #[error("NumPy format version {major}.{minor} is unknown, allowed are 1.0, 2.0 and 3.0")]
    Version {
        /// Major number.
        major: u8,
        /// Minor number.
        minor: u8,
    },
    /// The header says it is too long.
    #[error("its header claims {found} bytes, at most {MAX_HEADER_BYTES} are allowed")]
    HeaderLength {
        /// Bytes claimed.
        found: usize,
    },
    /// A header field is missing or unreadable.
    #[error("header field `{field}` is missing or unreadable")]
    Header {
        /// Name of the field.
        field: &'static str,
    },
    /// Elements of a type that is no measurement.
    #[error("its elements have the type `{found}`, allowed are {ALLOWED_TYPES}")]
    ElementType {
        /// NumPy's name of the type.
        found: String,
    },
    /// More elements than are read at once.
    #[error("it holds {found} values, at most {MAX_VALUES} are read at once")]
    TooMany {
        /// Values there.
        found: usize,
    },
    /// Fewer or more bytes than the shape needs.
    #[error("truncated or damaged: shape {shape} needs {expected} bytes of data, the file holds {found}")]
    Length {
        /// Shape in the header.
        shape: String,
        /// Bytes the shape needs.
        expected: String,
        /// Bytes there.
        found: usize,
    },
}

/// Reads a whole `.npy` file.
pub(super) fn parse(bytes: &[u8]) -> Result<Array<'static>, NpyError> {
    let (header, data) = Header::parse(bytes)?;
    let element = header.element()?;
    let shape = header.checked_shape(element.bytes(), data.len())?;
    let elements = data.chunks_exact(element.bytes());
    let fortran = header.fortran.then_some(&shape[..]);
    let values = if element.kind == Kind::Complex {
        Values::Complex(stored(elements.map(|bytes| element.decode_complex(bytes)), fortran))
    } else {
        Values::Real(stored(elements.map(|bytes| element.decode_real(bytes)), fortran))
    };
    Ok(Array { shape, values })
}

/// Values in C order, from Fortran's where that shape is given.
fn stored<T: Copy>(values: impl Iterator<Item = T>, fortran: Option<&[usize]>) -> Numbers<'static, T> {
    let values: Vec<T> = values.collect();
    Numbers::Stored(match fortran {
        Some(shape) => c_order(&values, shape),
        None => values,
    })
}

/// Shape and element type of an array whose first bytes these are, for a listing.
pub(super) fn describe(bytes: &[u8]) -> Result<String, NpyError> {
    let (header, _) = Header::parse(bytes)?;
    Ok(format!("{} {}", show_shape(&header.shape), header.element_type))
}

/// Writes an array in C order: float64, complex128 or int64, little-endian.
pub fn write(out: &mut dyn Write, array: &Array<'_>) -> io::Result<()> {
    out.write_all(&header(array))?;
    let [rows, columns] = array.sides();
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    for (row, column) in places {
        match &array.values {
            Values::Integer(numbers) => out.write_all(&numbers.at(row, column, columns).to_le_bytes())?,
            Values::Real(numbers) => out.write_all(&numbers.at(row, column, columns).to_le_bytes())?,
            Values::Complex(numbers) => {
                let value = numbers.at(row, column, columns);
                out.write_all(&value.re.to_le_bytes())?;
                out.write_all(&value.im.to_le_bytes())?;
            }
        }
    }
    Ok(())
}

/// Magic, version, length, and a Python dictionary that spaces fill up to the alignment.
fn header(array: &Array<'_>) -> Vec<u8> {
    let shape: String = array.shape.iter().map(|side| format!("{side}, ")).collect();
    let fields = format!(
        "{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
        type_name(array),
        shape.trim_end()
    );
    let before = 10;
    let length = (before + fields.len() + 1).next_multiple_of(ALIGNMENT) - before;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{fields:width$}\n", width = length - 1).bytes());
    bytes
}

/// NumPy's name of the type that an array is written as.
#[must_use]
pub fn type_name(array: &Array<'_>) -> &'static str {
    match array.values {
        Values::Integer(_) => "<i8",
        Values::Real(_) => "<f8",
        Values::Complex(_) => "<c16",
    }
}

struct Header {
    element_type: String,
    fortran: bool,
    shape: Vec<u64>,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), NpyError> {
        let (text, data) = split_header(bytes)?;
        let text = String::from_utf8_lossy(text);
        let header = Self {
            element_type: quoted(&text, "descr")?,
            fortran: boolean(&text, "fortran_order")?,
            shape: integers(&text, "shape")?,
        };
        Ok((header, data))
    }

    fn element(&self) -> Result<Element, NpyError> {
        Element::parse(&self.element_type)
            .ok_or_else(|| NpyError::ElementType { found: self.element_type.clone() })
    }

    /// The shape, once it is known to fit the data.
    fn checked_shape(&self, element_bytes: usize, found: usize) -> Result<Vec<usize>, NpyError> {
        let bytes =
            self.shape.iter().try_fold(element_bytes as u64, |product, &side| product.checked_mul(side));
        if bytes == Some(found as u64) {
            let values = found / element_bytes;
            if values > MAX_VALUES {
                return Err(NpyError::TooMany { found: values });
            }
            return Ok(self.shape.iter().map(|&side| side as usize).collect());
        }
        let expected = bytes.map_or("more than 2^64".into(), |bytes| bytes.to_string());
        Err(NpyError::Length { shape: show_shape(&self.shape), expected, found })
    }
}

fn split_header(bytes: &[u8]) -> Result<(&[u8], &[u8]), NpyError> {
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or(NpyError::Magic)?;
    let (length, rest) = match *rest {
        [1, 0, a, b, ref rest @ ..] => (usize::from(u16::from_le_bytes([a, b])), rest),
        [2 | 3, 0, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]) as usize, rest),
        [major, minor, ..] if !matches!((major, minor), (1..=3, 0)) => {
            return Err(NpyError::Version { major, minor });
        }
        _ => return Err(NpyError::Header { field: "length" }),
    };
    if length > MAX_HEADER_BYTES {
        return Err(NpyError::HeaderLength { found: length });
    }
    rest.split_at_checked(length).ok_or(NpyError::Header { field: "length" })
}

/// The text after `'field':`.
fn after<'a>(header: &'a str, field: &'static str) -> Result<&'a str, NpyError> {
    let missing = NpyError::Header { field };
    let key = header.find(&format!("'{field}'")).or_else(|| header.find(&format!("\"{field}\"")));
    let rest = &header[key.ok_or(missing.clone())? + field.len() + 2..];
    rest.trim_start().strip_prefix(':').map(str::trim_start).ok_or(missing)
}

fn quoted(header: &str, field: &'static str) -> Result<String, NpyError> {
    let text = after(header, field)?;
    let Some(quote) = text.chars().next().filter(|&first| first == '\'' || first == '"') else {
        // A list: named fields.
        return Err(NpyError::ElementType { found: "structured".into() });
    };
    let end = text[1..].find(quote).ok_or(NpyError::Header { field })?;
    Ok(text[1..=end].to_owned())
}

fn boolean(header: &str, field: &'static str) -> Result<bool, NpyError> {
    let text = after(header, field)?;
    let yes = text.starts_with("True");
    if yes || text.starts_with("False") { Ok(yes) } else { Err(NpyError::Header { field }) }
}

fn integers(header: &str, field: &'static str) -> Result<Vec<u64>, NpyError> {
    let unreadable = NpyError::Header { field };
    let inner = after(header, field)?.strip_prefix('(').and_then(|rest| Some(rest.split_once(')')?.0));
    let sides = inner.ok_or(unreadable.clone())?.split(',').map(str::trim).filter(|side| !side.is_empty());
    // Python 2 wrote long integers with an L.
    sides.map(|side| side.trim_end_matches('L').parse().map_err(|_| unreadable.clone())).collect()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Complex,
    Signed,
    Unsigned,
}

/// Element type: kind, bytes of one real number, byte order.
#[derive(Clone, Copy, Debug)]
struct Element {
    kind: Kind,
    real_bytes: usize,
    big_endian: bool,
}

impl Element {
    fn parse(descr: &str) -> Option<Self> {
        let name = descr.trim_start_matches(['<', '>', '|', '=']);
        let (kind, real_bytes) = match name {
            "f4" => (Kind::Float, 4),
            "f8" => (Kind::Float, 8),
            "c8" => (Kind::Complex, 4),
            "c16" => (Kind::Complex, 8),
            "i1" => (Kind::Signed, 1),
            "i2" => (Kind::Signed, 2),
            "i4" => (Kind::Signed, 4),
            "i8" => (Kind::Signed, 8),
            "u1" | "b1" => (Kind::Unsigned, 1),
            "u2" => (Kind::Unsigned, 2),
            "u4" => (Kind::Unsigned, 4),
            "u8" => (Kind::Unsigned, 8),
            _ => return None,
        };
        Some(Self { kind, real_bytes, big_endian: descr.starts_with('>') })
    }

    fn bytes(self) -> usize {
        self.real_bytes * if self.kind == Kind::Complex { 2 } else { 1 }
    }

    fn decode_complex(self, bytes: &[u8]) -> Complex64 {
        let (real, imaginary) = bytes.split_at(self.real_bytes);
        Complex64::new(self.decode_real(real), self.decode_real(imaginary))
    }

    /// One real number.
    fn decode_real(self, bytes: &[u8]) -> f64 {
        let append = |word: u64, &byte: &u8| word << 8 | u64::from(byte);
        let word =
            if self.big_endian { bytes.iter().fold(0, append) } else { bytes.iter().rev().fold(0, append) };
        let unused = 64 - 8 * self.real_bytes;
        match self.kind {
            Kind::Float | Kind::Complex if self.real_bytes == 4 => f32::from_bits(word as u32).into(),
            Kind::Float | Kind::Complex => f64::from_bits(word),
            Kind::Signed => ((word << unused) as i64 >> unused) as f64,
            Kind::Unsigned => word as f64,
        }
    }
}

/// Rearranges an array stored first index fastest to last index fastest.
fn c_order<T: Copy>(stored: &[T], shape: &[usize]) -> Vec<T> {
    let source = |mut c_index: usize| {
        let (mut index, mut above) = (0, stored.len());
        for &side in shape.iter().rev() {
            above /= side;
            index += c_index % side * above;
            c_index /= side;
        }
        index
    };
    (0..stored.len()).map(|c_index| stored[source(c_index)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(array: &Array<'_>) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&mut bytes, array).unwrap();
        bytes
    }

    #[test]
    fn what_is_written_is_what_others_read() {
        let real = written(&Array::table(2, 3, |row, column| row as f64 + 0.5 * column as f64));
        let file = npyz::NpyFile::new(&real[..]).unwrap();
        assert_eq!((file.shape(), file.order()), (&[2, 3][..], npyz::Order::C));
        assert_eq!(file.into_vec::<f64>().unwrap(), [0.0, 0.5, 1.0, 1.0, 1.5, 2.0]);
        let list = written(&Array::list(3, |at| at as i64 - 1));
        assert_eq!(npyz::NpyFile::new(&list[..]).unwrap().into_vec::<i64>().unwrap(), [-1, 0, 1]);
        let complex = written(&Array::list(1, |_| Complex64::new(1.0, -2.0)));
        let read = npyz::NpyFile::new(&complex[..]).unwrap().into_vec::<Complex64>().unwrap();
        assert_eq!(read, [Complex64::new(1.0, -2.0)]);
    }

    #[test]
    fn elements_are_aligned_whatever_the_header_needs() {
        for digits in 0..40_u32 {
            let array = Array { shape: vec![0, 10_usize.pow(digits % 18)], ..Array::table(0, 0, |_, _| 0.0) };
            assert_eq!(header(&array).len() % ALIGNMENT, 0, "{digits}");
        }
    }
}
