//! Noise of a measurement.

/// Measurement noise: white, Gaussian, the same on every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Signal-to-noise ratio, dB: root mean square of the untouched voltages over all steps,
    /// against the noise's standard deviation, under the drive of the skin file. Infinite is without noise.
    pub snr_db: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Standard deviation of noise over what it is a part of, from a signal-to-noise ratio, dB.
#[must_use]
pub fn share(snr_db: f64) -> f64 {
    10_f64.powf(-snr_db / 20.0)
}

/// Seed of the noise of what has this number, so that it may be measured in any order and on many threads; 0 has the seed
/// itself.
#[must_use]
pub(crate) fn seed_of(seed: u64, number: u64) -> u64 {
    seed.wrapping_add(number.wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// Root of the mean of the squares.
#[must_use]
pub fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}
