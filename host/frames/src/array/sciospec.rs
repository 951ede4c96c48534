//! Frames of Sciospec's instruments: `.eit`, a text for each frame.
//!
//! ```text
//! 18                                  lines of the header, this one among them
//! 2 ... 1                             of which line 8 says how many frequencies there are (7 of 9 lines, without a version)
//! MeasurementChannels: 1,2, ... 16    in longer headers: electrodes that are measured
//! 1 2                                 electrodes of an injection, from 1
//! 1.26 -0.14 -1.26 0.16 ...           for each frequency: potential of each channel, real and imaginary
//! ```
//!
//! Read as one square: a row of potentials for each injection, in the order of its first electrode.

use super::{Array, ArrayError, Numbers, Values, error::SciospecError};
use num_complex::Complex64;

/// Most lines of a header.
const MAX_HEADER: usize = 100;
const CHANNELS: &str = "MeasurementChannels:";

/// Reads one file.
pub(super) fn parse(bytes: &[u8]) -> Result<Array<'static>, ArrayError> {
    let text = str::from_utf8(bytes).map_err(|_| SciospecError::Text)?;
    let lines: Vec<&str> = text.lines().collect();
    let header: usize = lines
        .first()
        .and_then(|line| line.trim_start_matches('\u{feff}').trim().parse().ok())
        .filter(|header| (9..=MAX_HEADER).contains(header))
        .ok_or(SciospecError::Header)?;
    let at = if header == 9 { 6 } else { 7 };
    let frequencies = lines.get(at).and_then(|line| line.trim().parse::<f64>().ok()).unwrap_or(0.0);
    if frequencies != 1.0 {
        return Err(SciospecError::Frequencies {
            line: at + 1,
            found: shortened(lines.get(at).unwrap_or(&"")),
        }
        .into());
    }
    let head = &lines[..header.min(lines.len())];
    let channels = channels(head)?;
    let body = lines.iter().enumerate().skip(header).filter(|(_, line)| !line.trim().is_empty());
    let body: Vec<(usize, &str)> = body.map(|(index, line)| (index + 1, *line)).collect();
    let mut rows = Vec::new();
    for pair in body.chunks(2) {
        rows.push(row(pair, channels.as_deref())?);
    }
    square(rows)
}

/// Electrodes that the header says are measured, from 1.
fn channels(header: &[&str]) -> Result<Option<Vec<usize>>, SciospecError> {
    let Some((index, line)) = header.iter().enumerate().find(|(_, line)| line.starts_with(CHANNELS)) else {
        return Ok(None);
    };
    let wrong = || SciospecError::Channels { line: index + 1, found: shortened(line) };
    let cells = line[CHANNELS.len()..].split(',');
    let numbers: Option<Vec<usize>> =
        cells.map(|cell| cell.trim().parse().ok().filter(|&it| it > 0)).collect();
    numbers.map(Some).ok_or_else(wrong)
}

/// First electrode of an injection, and the potentials of the channels.
fn row(
    lines: &[(usize, &str)],
    channels: Option<&[usize]>,
) -> Result<(usize, Vec<Complex64>), SciospecError> {
    let (line, injection) = lines[0];
    let wrong = || SciospecError::Injection { line, found: shortened(injection) };
    let electrodes: Option<Vec<usize>> =
        injection.split_whitespace().map(|cell| cell.parse().ok().filter(|&it| it > 0)).collect();
    let first = match electrodes.as_deref() {
        Some(&[first, second]) if first != second => first,
        _ => return Err(wrong()),
    };
    let &(line, values) = lines.get(1).ok_or_else(wrong)?;
    let mut parts = Vec::new();
    for (column, cell) in values.split_whitespace().enumerate() {
        let value: f64 = cell.parse().map_err(|_| SciospecError::Number {
            line,
            column: column + 1,
            found: shortened(cell),
        })?;
        parts.push(value);
    }
    let (pairs, rest) = parts.as_chunks::<2>();
    let all: Vec<Complex64> = pairs.iter().map(|[re, im]| Complex64::new(*re, *im)).collect();
    let count = SciospecError::Values { line, found: parts.len() };
    if all.is_empty() || !rest.is_empty() {
        return Err(count);
    }
    let Some(channels) = channels else { return Ok((first, all)) };
    let chosen: Option<Vec<Complex64>> =
        channels.iter().map(|channel| all.get(channel - 1).copied()).collect();
    chosen.map(|chosen| (first, chosen)).ok_or(count)
}

/// One injection from each electrode, in their order.
fn square(mut rows: Vec<(usize, Vec<Complex64>)>) -> Result<Array<'static>, ArrayError> {
    rows.sort_by_key(|(first, _)| *first);
    let n = rows.len();
    let in_order = rows.iter().enumerate().all(|(index, (first, _))| *first == index + 1);
    if n == 0 || !in_order || rows.iter().any(|(_, row)| row.len() != n) {
        let channels = rows.first().map_or(0, |(_, row)| row.len());
        return Err(SciospecError::Square { injections: n, channels }.into());
    }
    let values = rows.into_iter().flat_map(|(_, row)| row).collect();
    Ok(Array { shape: vec![1, n, n], values: Values::Complex(Numbers::Stored(values)) })
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As an instrument with 32 channels writes it of which 4 are in use.
    fn file(order: [usize; 4]) -> String {
        let mut text = "18\n2\nsetup\n2025.01.01. 12:00:00.000\n1e4\n1e4\n1\n1\n0.005\n20.0\n0.0\n1.0\n1\n1\n1\n1\n\
                        MeasurementChannels: 1,2,3,4\nMeasurementChannelsIndependentFromInjectionPattern: 1,2\n"
            .to_owned();
        for k in order {
            let cells: Vec<String> =
                (1..=6).flat_map(|e| [format!("{}", 10 * k + e), format!("-0.{e}")]).collect();
            text += &format!("{k} {}\n{}\n", k % 4 + 1, cells.join("\t"));
        }
        text
    }

    #[test]
    fn potentials_are_rows_in_the_order_of_the_injecting_electrodes() {
        for order in [[1, 2, 3, 4], [3, 1, 4, 2]] {
            let array = parse(file(order).as_bytes()).unwrap();
            assert_eq!(array.shape, [1, 4, 4]);
            let values = array.into_complex();
            assert_eq!(values[0], Complex64::new(11.0, -0.1));
            assert_eq!(values[4 * 2 + 3], Complex64::new(34.0, -0.4));
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let sound = file([1, 2, 3, 4]);
        for (from, to, words) in [
            ("18\n2", "x\n2", "line 1"),
            ("\n1\n1\n0.005", "\n1\n3\n0.005", "line 8 is \"3\""),
            ("1 2\n", "1 x\n", "line 19 is \"1 x\""),
            ("1 2\n", "1 1\n", "line 19 is \"1 1\""),
            ("11\t", "1y\t", "line 20, column 1 is \"1y\""),
            ("11\t-0.1\t", "11\t", "line 20 has 11 numbers"),
            ("2 3\n", "1 3\n", "4 injections"),
            ("Channels: 1,2", "Channels: 1,,2", "line 17"),
            ("Channels: 1,2", "Channels: 99,2", "line 20"),
        ] {
            let error = parse(sound.replacen(from, to, 1).as_bytes()).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(words), "{to}: {error}");
        }
        assert!(parse(&[0xff, 0xfe, 0]).is_err());
        assert!(parse(b"").is_err());
    }
}
