//! Indenter: its known area beside that of the region of interest, which the image's blur makes larger.

use super::Reading;

/// The indenter's area over the mean area of the regions, mm^2 both; none without a region under load.
///
/// Readings count by their pressure, so that the force comes out right at the loads that matter most: weak contacts
/// have regions of noise.
#[must_use]
pub fn load_share(readings: &[Reading], indenter_mm2: f64) -> Option<f64> {
    let areas = || readings.iter().filter_map(|reading| Some((reading.pressure_kpa, reading.area_mm2?)));
    let weight: f64 = areas().map(|(pressure, _)| pressure).sum();
    let mean = areas().map(|(pressure, area)| pressure * area).sum::<f64>() / weight;
    (mean > 0.0 && mean.is_finite()).then(|| indenter_mm2 / mean)
}
