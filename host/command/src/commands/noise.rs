//! Options for the noise of a simulated board.

use dermatome_simulate::{Noise, board::DEFAULT_NOISE};

/// Noise of the simulated measurements.
#[derive(clap::Args)]
pub(super) struct NoiseOptions {
    /// Signal-to-noise ratio of the measurements, dB: 0 to 200.
    #[arg(long, default_value_t = DEFAULT_NOISE.snr_db, value_name = "DB", value_parser = snr, allow_hyphen_values = true)]
    noise_db: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = DEFAULT_NOISE.seed, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
}

impl NoiseOptions {
    pub(super) fn noise(&self) -> Noise {
        Noise { snr_db: self.noise_db, seed: self.seed }
    }
}

/// A signal-to-noise ratio, dB.
pub(super) fn snr(text: &str) -> Result<f64, String> {
    let db = text.parse().ok().filter(|db| (0.0..=200.0).contains(db));
    db.ok_or_else(|| "allowed are 0 to 200 dB".to_owned())
}

/// A seed of what is random.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("allowed are whole numbers from 0 to {}", u64::MAX))
}
