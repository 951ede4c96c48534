//! System memory: what the factory wrote into each chip (DS12288, "Temperature sensor calibration values",
//! "Internal voltage reference calibration values"; RM0440, "Device electronic signature").
//!
//! The codes are those of a chip at the typical values of its datasheet.

/// Where the words begin, and the bytes from there on that can be read.
pub const START: u32 = 0x1FFF_7000;
/// Bytes of it.
pub const BYTES: u32 = 0x1000;

/// Volts of the supply at which the factory calibrates.
pub const CALIBRATION_SUPPLY: f64 = 3.0;
/// Volts of the internal reference (DS12288, VREFINT).
pub const VREFINT_VOLTS: f64 = 1.212;
/// Degrees Celsius at which TS_CAL1 and TS_CAL2 are taken.
pub const CALIBRATION_DEGREES: [f64; 2] = [30.0, 130.0];

const UNIQUE_ID: u32 = 0x1FFF_7590;
const TS_CAL1: u32 = 0x1FFF_75A8;
const VREFINT_CAL: u32 = 0x1FFF_75AA;
const TS_CAL2: u32 = 0x1FFF_75CA;
const FLASH_SIZE: u32 = 0x1FFF_75E0;

/// Volts of the temperature sensor (DS12288, "Temperature sensor characteristics": V30 and average slope).
#[must_use]
pub fn sensor_volts(degrees: f64) -> f64 {
    0.76 + 0.0025 * (degrees - CALIBRATION_DEGREES[0])
}

/// All of it; what is not known to be there reads as erased.
#[must_use]
pub fn content() -> Vec<u8> {
    let mut bytes = vec![0xFF; BYTES as usize];
    let mut put = |address: u32, word: &[u8]| {
        let start = (address - START) as usize;
        bytes[start..start + word.len()].copy_from_slice(word);
    };
    // Place on the wafer, wafer, and lot in ASCII.
    put(UNIQUE_ID, b"\x2A\x00\x1F\x00\x07Q12345\x20");
    put(TS_CAL1, &code(sensor_volts(CALIBRATION_DEGREES[0])));
    put(VREFINT_CAL, &code(VREFINT_VOLTS));
    put(TS_CAL2, &code(sensor_volts(CALIBRATION_DEGREES[1])));
    put(FLASH_SIZE, &512_u16.to_le_bytes());
    bytes
}

fn code(volts: f64) -> [u8; 2] {
    ((volts / CALIBRATION_SUPPLY * 4096.0) as u16).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_calibration_words_lie_where_the_datasheet_has_them() {
        let bytes = content();
        let word = |address: u32| {
            let start = (address - START) as usize;
            u16::from_le_bytes([bytes[start], bytes[start + 1]])
        };
        assert_eq!((word(0x1FFF_75A8), word(0x1FFF_75CA), word(0x1FFF_75AA)), (1037, 1378, 1654));
        assert_eq!((word(0x1FFF_75E0), word(0x1FFF_7000)), (512, 0xFFFF));
    }
}
