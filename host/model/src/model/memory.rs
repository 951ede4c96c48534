//! How much memory a model takes: told before it is computed, as a matrix of all measurements by all measurements grows
//! with the fourth power of the electrodes' number.

use super::ModelError;
use crate::{jacobian::step_counts, skin::Skin};
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Matrices of measurements by measurements that are held at once. With 8,000 measurements a model takes 3.2 GB, with
/// 4,850 1.2 GB: 6.2 and 6.4 of them.
const SQUARES: u64 = 6;

/// GB that the model of a skin takes at least.
#[must_use]
pub fn needed_gigabytes(skin: &Skin) -> f64 {
    gigabytes(needed(skin))
}

fn measurements(skin: &Skin) -> usize {
    step_counts(&skin.stimulation().combination).len()
}

fn needed(skin: &Skin) -> u64 {
    let measurements = measurements(skin) as u64;
    SQUARES * size_of::<f64>() as u64 * measurements * measurements
}

/// Refuses a model that takes more than this machine has to spare.
pub(super) fn check(skin: &Skin) -> Result<(), ModelError> {
    // What every machine has is not worth asking for.
    if needed(skin) < 1 << 28 { Ok(()) } else { check_within(skin, available()) }
}

fn check_within(skin: &Skin, available: u64) -> Result<(), ModelError> {
    let needed = needed(skin);
    if needed <= available {
        return Ok(());
    }
    Err(ModelError::Memory {
        measurements: measurements(skin),
        needed: gigabytes(needed),
        available: gigabytes(available),
    })
}

/// Bytes that this process may still take, by the machine and by its control group.
fn available() -> u64 {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::everything());
    let system = System::new_with_specifics(memory);
    let free = system.available_memory() + system.free_swap();
    system.cgroup_limits().map_or(free, |group| free.min(group.free_memory + group.free_swap))
}

fn gigabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_model_that_takes_more_than_there_is_is_refused_with_both() {
        let tiny = include_str!("../../../tests/data/tiny.toml");
        let many = tiny.replace("count = 8", "count = 128").replace("width = \"8 mm\"", "width = \"1 mm\"");
        let skin = Skin::parse(Path::new("skin.toml"), &many).unwrap().made().unwrap();
        assert_eq!(check_within(&skin, 4_000_000_000), Ok(()));
        let words = check_within(&skin, 3_000_000_000).unwrap_err().to_string();
        assert!(
            words.contains("8000 measurements, whose model takes 3.1 GB of memory; allowed here: 3.0 GB"),
            "{words}"
        );
        assert!(available() > 1 << 20);
    }
}
