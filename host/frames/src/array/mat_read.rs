//! Reading matrices of MATLAB's MAT-files, level 5, compressed or not; [`super::mat`] says how they are laid out.
//!
//! The reader is ours: the crate `matfile` (0.5) inflates without a limit.
//!
//! A compressed element holds one other element as a zlib stream. Values of a matrix may be stored in a smaller type
//! than its class. Axes are turned round: what MATLAB stores column after column is read as rows, so that the frames
//! of `vv(measurement, frame)`, as EIDORS keeps them, are rows here.

use super::{
    Array, ArrayError, MAX_BYTES, MAX_VALUES, Numbers, Values,
    error::{Listing, MatError},
    show_shape,
};
use flate2::read::ZlibDecoder;
use num_complex::Complex64;
use std::io::Read;

const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;
const COMPLEX: u32 = 0x0800;
/// Classes of matrices of numbers: double to uint64.
const NUMERIC: std::ops::RangeInclusive<u32> = 6..=15;
/// Most sides of a matrix.
const MAX_SIDES: usize = 8;

/// An element: its type and its data.
type Element<'a> = (u32, &'a [u8]);

/// Reads the matrix `key`, or the only one.
pub(super) fn parse(bytes: &[u8], key: Option<&str>) -> Result<Array<'static>, ArrayError> {
    if bytes.starts_with(b"MATLAB 7.3")
        || bytes.starts_with(b"\x89HDF")
        || bytes.get(512..516) == Some(b"\x89HDF")
    {
        return Err(MatError::Version73.into());
    }
    let big_endian = match bytes.get(124..128) {
        Some([_, 1, b'I', b'M']) => false,
        Some([1, _, b'M', b'I']) => true,
        _ => return Err(MatError::Magic.into()),
    };
    let mut matrices = Vec::new();
    let mut reader = Elements { bytes: &bytes[128..], big_endian };
    let mut inflated_bytes = 0_u64;
    while let Some((kind, data)) = reader.next()? {
        let inflated;
        let (kind, data) = if kind == COMPRESSED {
            let mut all = Vec::new();
            let limit = MAX_BYTES - inflated_bytes;
            ZlibDecoder::new(data).take(limit + 1).read_to_end(&mut all).map_err(|_| MatError::Damaged)?;
            if all.len() as u64 > limit {
                return Err(ArrayError::TooLarge);
            }
            inflated_bytes += all.len() as u64;
            inflated = all;
            Elements { bytes: &inflated, big_endian }.next()?.ok_or(MatError::Damaged)?
        } else {
            (kind, data)
        };
        if kind == MATRIX
            && let Some(matrix) = Matrix::read(data, big_endian, key)?
        {
            matrices.push(matrix);
        }
    }
    choose(matrices, key)
}

/// A matrix of numbers.
struct Matrix {
    name: String,
    shape: Vec<usize>,
    /// None where another one is asked for.
    values: Option<Values<'static>>,
}

fn choose(mut matrices: Vec<Matrix>, key: Option<&str>) -> Result<Array<'static>, ArrayError> {
    let list = |matrices: &[Matrix]| {
        Listing(matrices.iter().map(|it| format!("`{}` {}", it.name, show_shape(&it.shape))).collect())
    };
    let at = match key {
        _ if matrices.is_empty() => return Err(ArrayError::NoArrays),
        Some(key) => matrices
            .iter()
            .position(|it| it.name == key)
            .ok_or_else(|| ArrayError::NoKey { key: key.to_owned(), arrays: list(&matrices) })?,
        None if matrices.len() > 1 => return Err(ArrayError::SeveralArrays { arrays: list(&matrices) }),
        None => 0,
    };
    let Matrix { shape, values, .. } = matrices.swap_remove(at);
    Ok(Array { shape, values: values.ok_or(MatError::Damaged)? })
}

impl Matrix {
    /// `None` for what holds no numbers: text, cells, structures, sparse matrices.
    fn read(data: &[u8], big_endian: bool, key: Option<&str>) -> Result<Option<Self>, ArrayError> {
        let mut parts = Elements { bytes: data, big_endian };
        let mut part = || parts.next()?.ok_or(MatError::Damaged);
        let (_, flags) = part()?;
        let flags = flags.first_chunk().map(|bytes| word(*bytes, big_endian)).ok_or(MatError::Damaged)?;
        if !NUMERIC.contains(&(flags & 0xff)) {
            return Ok(None);
        }
        let sides: Vec<usize> = integers(part()?, big_endian)?;
        let name = String::from_utf8_lossy(part()?.1).into_owned();
        if sides.len() > MAX_SIDES {
            return Err(MatError::Damaged.into());
        }
        let count = sides.iter().try_fold(1_usize, |count, &side| count.checked_mul(side));
        let count = count.filter(|&count| count <= MAX_VALUES).ok_or(ArrayError::TooLarge)?;
        let mut shape: Vec<usize> = sides.iter().rev().copied().collect();
        if let [rows, 1] = shape[..] {
            // A row is a list, as a column is.
            shape = vec![rows];
        } else if let [1, columns] = shape[..] {
            shape = vec![columns];
        }
        if key.is_some_and(|key| key != name) {
            return Ok(Some(Self { name, shape, values: None }));
        }
        let real = numbers(part()?, big_endian)?;
        let values = if flags & COMPLEX == 0 {
            Values::Real(Numbers::Stored(real))
        } else {
            let imaginary = numbers(part()?, big_endian)?;
            if imaginary.len() != real.len() {
                return Err(MatError::Damaged.into());
            }
            let pairs = real.iter().zip(&imaginary);
            Values::Complex(Numbers::Stored(pairs.map(|(re, im)| Complex64::new(*re, *im)).collect()))
        };
        let found = match &values {
            Values::Complex(Numbers::Stored(values)) => values.len(),
            Values::Real(Numbers::Stored(values)) => values.len(),
            _ => 0,
        };
        if found != count {
            return Err(MatError::Damaged.into());
        }
        Ok(Some(Self { name, shape, values: Some(values) }))
    }
}

/// Elements one after the other.
struct Elements<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Elements<'a> {
    fn next(&mut self) -> Result<Option<Element<'a>>, MatError> {
        if self.bytes.is_empty() {
            return Ok(None);
        }
        let at = |from: usize| -> Result<u32, MatError> {
            let bytes = self.bytes.get(from..from + 4).and_then(|bytes| bytes.first_chunk());
            bytes.map(|bytes| word(*bytes, self.big_endian)).ok_or(MatError::Damaged)
        };
        let tag = at(0)?;
        // Small ones have their length beside their type, and up to four bytes of data.
        let (kind, start, length) =
            if tag >> 16 == 0 { (tag, 8, at(4)? as usize) } else { (tag & 0xffff, 4, (tag >> 16) as usize) };
        let end = start + length;
        let data = self.bytes.get(start..end).ok_or(MatError::Damaged)?;
        let next = match kind {
            COMPRESSED => end,
            _ if start == 4 => 8,
            _ => end.next_multiple_of(8),
        };
        self.bytes = self.bytes.get(next..).unwrap_or_default();
        Ok(Some((kind, data)))
    }
}

fn word(bytes: [u8; 4], big_endian: bool) -> u32 {
    if big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

fn integers(element: Element<'_>, big_endian: bool) -> Result<Vec<usize>, MatError> {
    let sides = numbers(element, big_endian)?;
    let side = |side: &f64| {
        (*side >= 0.0 && side.fract() == 0.0 && *side <= MAX_VALUES as f64).then_some(*side as usize)
    };
    sides.iter().map(side).collect::<Option<_>>().ok_or(MatError::Damaged)
}

/// Values of any type that numbers are stored in.
fn numbers((kind, data): Element<'_>, big_endian: bool) -> Result<Vec<f64>, MatError> {
    macro_rules! read {
        ($type:ty) => {
            data.chunks_exact(size_of::<$type>())
                .map(|bytes| {
                    let mut value = [0; size_of::<$type>()];
                    value.copy_from_slice(bytes);
                    if big_endian {
                        <$type>::from_be_bytes(value) as f64
                    } else {
                        <$type>::from_le_bytes(value) as f64
                    }
                })
                .collect()
        };
    }
    Ok(match kind {
        1 => read!(i8),
        2 => read!(u8),
        3 => read!(i16),
        4 => read!(u16),
        5 => read!(i32),
        6 => read!(u32),
        7 => read!(f32),
        9 => read!(f64),
        12 => read!(i64),
        13 => read!(u64),
        _ => return Err(MatError::Damaged),
    })
}
