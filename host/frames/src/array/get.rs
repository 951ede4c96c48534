//! Frames of older lung instruments with 16 electrodes: `.get`.
//!
//! ```text
//! header   of Draeger only: text that begins with "---Draeger EIT-Software---" and ends in two empty lines
//! frames   256 floats each, little-endian: 208 voltages, 16 currents, 16 voltages of the drives, 16 others
//! ```
//!
//! Voltages of each drive begin behind the driven pair; they are put into the canonical order. Instruments that measure each
//! pair of pairs once leave the other of the two zero, which gets the same. Layout: as EIDORS' `eidors_readdata` reads
//! it.

use super::{Array, ArrayError, MAX_VALUES, Numbers, Values, error::GetError};

const DRAEGER: &[u8] = b"---Draeger EIT-Software---";
const ELECTRODES: usize = 16;
/// Sense pairs of a drive that touch no driven electrode.
const PAIRS: usize = ELECTRODES - 3;
const VOLTAGES: usize = ELECTRODES * PAIRS;
const FLOATS: usize = 256;
const BYTES: usize = FLOATS * size_of::<f32>();

/// Reads all frames.
pub(super) fn parse(bytes: &[u8]) -> Result<Array<'static>, ArrayError> {
    let data = if bytes.starts_with(DRAEGER) { after_header(bytes).ok_or(GetError::Header)? } else { bytes };
    if data.is_empty() || !data.len().is_multiple_of(BYTES) {
        return Err(GetError::Length { found: data.len() }.into());
    }
    if data.len() / BYTES * VOLTAGES > MAX_VALUES {
        return Err(ArrayError::TooLarge);
    }
    let values = data.chunks_exact(BYTES).flat_map(frame).collect();
    Ok(Array { shape: vec![data.len() / BYTES, VOLTAGES], values: Values::Real(Numbers::Stored(values)) })
}

/// What follows the first two empty lines in a row.
fn after_header(bytes: &[u8]) -> Option<&[u8]> {
    let mut empty = 0;
    let mut at = 0;
    while empty < 2 {
        let line = bytes[at..].iter().position(|&byte| byte == b'\n')?;
        empty = if bytes[at..at + line].trim_ascii().is_empty() { empty + 1 } else { 0 };
        at += line + 1;
    }
    Some(&bytes[at..])
}

/// Place of a pair, so many electrodes ahead of the one where current leaves, in the file.
fn place(drive: usize, ahead: usize) -> usize {
    drive * PAIRS + ahead - 2
}

fn frame(bytes: &[u8]) -> Vec<f64> {
    let (floats, _) = bytes.as_chunks::<4>();
    let file: Vec<f64> = floats.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect();
    let value = |drive: usize, ahead: usize| {
        let value = file[place(drive, ahead)];
        // Drive and sense exchanged.
        if value == 0.0 { file[place((drive + ahead) % ELECTRODES, ELECTRODES - ahead)] } else { value }
    };
    (0..ELECTRODES)
        .flat_map(|drive| {
            let ahead = move |sense: usize| (sense + ELECTRODES - drive) % ELECTRODES;
            let measured = (0..ELECTRODES).map(ahead).filter(|&ahead| (2..ELECTRODES - 1).contains(&ahead));
            measured.map(move |ahead| value(drive, ahead)).collect::<Vec<_>>()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Voltage k, m reads 100 k + m, as the file lists it, then what is no voltage.
    fn frame_bytes(once: bool) -> Vec<u8> {
        let mut floats = Vec::new();
        for drive in 0..16_usize {
            for ahead in 2..15 {
                let sense = (drive + ahead) % 16;
                let (low, high) = (drive.min(sense), drive.max(sense));
                let value = if once { 100 * low + high } else { 100 * drive + sense };
                floats.push(if once && drive > sense { 0.0 } else { value as f32 });
            }
        }
        floats.resize(256, -1.0);
        floats.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    fn values(bytes: &[u8]) -> Vec<f64> {
        parse(bytes).unwrap().into_complex().iter().map(|value| value.re).collect()
    }

    #[test]
    fn voltages_come_in_canonical_order_with_and_without_a_header() {
        let data = [frame_bytes(false), frame_bytes(false)].concat();
        let header = b"---Draeger EIT-Software---\r\n---Protocol Data----\r\n\r\nFrames: 2\r\n\r\n\r\n";
        for bytes in [data.clone(), [&header[..], &data].concat()] {
            let values = values(&bytes);
            assert_eq!(values.len(), 2 * 208);
            assert_eq!(values[..3], [2.0, 3.0, 4.0]);
            // Drive 5 (electrodes 5 and 6): pairs 0 to 3, then 7 on.
            assert_eq!(values[208 + 5 * 13..][..6], [500.0, 501.0, 502.0, 503.0, 507.0, 508.0]);
        }
    }

    #[test]
    fn a_pair_measured_once_is_that_with_drive_and_sense_exchanged_as_well() {
        let values = values(&frame_bytes(true));
        // Drive 5, pair 0 is drive 0, pair 5.
        assert_eq!(values[5 * 13], 5.0);
        assert_eq!(values[3], 5.0);
        assert!(values.iter().all(|value| *value > 0.0));
    }

    #[test]
    fn other_lengths_are_refused() {
        let mut bytes = frame_bytes(false);
        bytes.pop();
        let error = parse(&bytes).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("1023 bytes") && error.contains("1024"), "{error}");
        assert!(parse(b"---Draeger EIT-Software---\r\n\r\n").is_err());
        assert!(parse(b"").is_err());
    }
}
