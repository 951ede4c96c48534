//! Any bytes as the files of a calibration: loads, readings, and a recorded stream. What is read keeps its promises,
//! and readings of a recording can be made of any loads.
#![no_main]

use dermatome::calibrate::{Recording, read_loads, read_readings};
use libfuzzer_sys::fuzz_target;
use std::io::Write;

fn file(bytes: &[u8]) -> tempfile::NamedTempFile {
    let mut file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    file.write_all(bytes).unwrap();
    file
}

fuzz_target!(|input: (&[u8], &[u8], Option<f64>)| {
    let (table, stream, start) = input;
    let (table, stream) = (file(table), file(stream));
    if let Ok(readings) = read_readings(table.path()) {
        assert!(readings.iter().all(|reading| reading.strength.is_finite()));
        assert!(readings.iter().all(|reading| reading.pressure_kpa.is_finite() && reading.deviation >= 0.0));
    }
    let loads = read_loads(table.path());
    if let Ok(loads) = &loads {
        assert!(loads.windows(2).all(|two| two[0].time_s < two[1].time_s));
    }
    let (Ok(loads), Ok(recording)) = (loads, Recording::read(stream.path())) else { return };
    if let Ok(readings) = recording.readings(&loads, start.filter(|start| start.is_finite())) {
        assert_eq!(readings.len(), loads.len());
        assert!(readings.iter().all(|reading| reading.strength.is_finite()));
    }
});
