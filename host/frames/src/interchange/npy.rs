//! Writing NumPy's array format, version 1.0; [`crate::recorded`] reads it.

use super::array::{Array, Values};
use std::io::{self, Write};

/// Bytes that the elements are aligned to, as NumPy does.
const ALIGNMENT: usize = 64;

/// Writes an array in C order: float64, complex128 or int64, little-endian.
pub fn write(out: &mut dyn Write, array: &Array<'_>) -> io::Result<()> {
    out.write_all(&header(array))?;
    let [rows, columns] = array.sides();
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    for (row, column) in places {
        match &array.values {
            Values::Integer(at) => out.write_all(&at(row, column).to_le_bytes())?,
            Values::Real(at) => out.write_all(&at(row, column).to_le_bytes())?,
            Values::Complex(at) => {
                let value = at(row, column);
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
        array.values.type_name(),
        shape.trim_end()
    );
    let before = 10;
    let length = (before + fields.len() + 1).next_multiple_of(ALIGNMENT) - before;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{fields:width$}\n", width = length - 1).bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    fn written(array: &Array<'_>) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&mut bytes, array).unwrap();
        bytes
    }

    #[test]
    fn what_is_written_is_what_others_read() {
        let real = written(&Array::table("a", 2, 3, |row, column| row as f64 + 0.5 * column as f64));
        let file = npyz::NpyFile::new(&real[..]).unwrap();
        assert_eq!((file.shape(), file.order()), (&[2, 3][..], npyz::Order::C));
        assert_eq!(file.into_vec::<f64>().unwrap(), [0.0, 0.5, 1.0, 1.0, 1.5, 2.0]);
        let list = written(&Array::list("b", 3, |at| at as i64 - 1));
        assert_eq!(npyz::NpyFile::new(&list[..]).unwrap().into_vec::<i64>().unwrap(), [-1, 0, 1]);
        let complex = written(&Array::list("c", 1, |_| Complex64::new(1.0, -2.0)));
        let read = npyz::NpyFile::new(&complex[..]).unwrap().into_vec::<Complex64>().unwrap();
        assert_eq!(read, [Complex64::new(1.0, -2.0)]);
    }

    #[test]
    fn elements_are_aligned_whatever_the_header_needs() {
        for digits in 0..40_u32 {
            let array =
                Array { shape: vec![0, 10_usize.pow(digits % 18)], ..Array::table("a", 0, 0, |_, _| 0.0) };
            assert_eq!(header(&array).len() % ALIGNMENT, 0, "{digits}");
        }
    }
}
