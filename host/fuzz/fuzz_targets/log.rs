//! Any bytes as a firmware, and as what it logs: lines hold no control characters.
#![no_main]

use dermatome::link::program::{firmware::Firmware, log::Log};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: (Vec<u8>, &[u8])| {
    let (elf, logged) = input;
    let Ok(firmware) = Firmware::new(elf) else { return };
    let Ok(log) = Log::new(&firmware) else { return };
    // A log of another firmware is an error that ends it.
    let _ = log.decoder(false).push(logged, |line| assert!(!line.contains(char::is_control)));
});
