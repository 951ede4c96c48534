//! Any bytes as a file of measured frames. What is read keeps its promises: no frame is empty, and
//! no value is NaN or infinite.
#![no_main]

use dermatome::recorded::read::{Frames, Source, read};
use libfuzzer_sys::fuzz_target;
use std::io::Write;

fn parse(ending: &str, bytes: &[u8], key: Option<&str>) -> Option<Frames> {
    // The name decides how the file is read. Removed at once: a fuzzer may end at any time.
    let mut file = tempfile::Builder::new().suffix(&format!(".{ending}")).tempfile().unwrap();
    file.write_all(bytes).unwrap();
    let path = file.path().to_owned();
    let frames = read(&Source { path, key: key.map(str::to_owned) }).ok()?;
    assert!(frames.frames > 0 && frames.measurements > 0);
    assert_eq!(frames.values.len(), frames.frames * frames.measurements);
    assert!(frames.values.iter().all(|value| value.is_finite()));
    assert!(frames.mean().len() == frames.measurements && frames.iter().len() == frames.frames);
    let values = frames.values.len();
    let turned = frames.clone().transposed();
    if frames.frames == 1 {
        assert_eq!(turned, frames);
    } else {
        assert_eq!((turned.frames, turned.measurements), (frames.measurements, frames.frames));
        assert!(turned.frames == 1 || turned.transposed() == frames);
    }
    let frames = frames.with_square(4, 8);
    assert_eq!(frames.frames * frames.measurements, values);
    Some(frames)
}

/// Puts a right magic number and header length before the first line of `text`.
fn with_prefix(text: &[u8]) -> Vec<u8> {
    let header = text.iter().position(|&byte| byte == b'\n').map_or(text.len(), |end| end + 1);
    let length = (header as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text].concat()
}

fuzz_target!(|input: (u8, &[u8])| {
    let (kind, bytes) = input;
    match kind % 9 {
        0 => drop(parse("npy", bytes, None)),
        1 => drop(parse("npy", &with_prefix(bytes), None)),
        2 => drop(parse("npz", bytes, None)),
        3 => drop(parse("npz", bytes, Some("frames"))),
        4 => drop(parse("mat", bytes, None)),
        5 => drop(parse("mat", bytes, Some("v"))),
        6 => drop(parse("eit", bytes, None)),
        7 => drop(parse("get", bytes, None)),
        _ => drop(parse("csv", bytes, None)),
    }
});
