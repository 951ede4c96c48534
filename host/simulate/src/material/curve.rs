//! Curves of a material: which contacts have closed at a pressure, and which of those open again.

/// How sharply the contacts run out at the end of the range.
const SHARPNESS: f64 = 60.0;

/// Share of the contacts that a first press has closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Loading {
    /// Share that closes at first touch.
    pub(super) touch: f64,
    /// Pressure over which those close, share of the range.
    pub(super) touch_pressure: f64,
    /// Bend of the rest: 0 closes evenly, above 0 most at low pressure.
    pub(super) bend: f64,
}

/// Which contacts open again: the distribution of kappa, opening over closing pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Release {
    /// Share that opens at the pressure that closed it.
    pub(super) reversible: f64,
    /// Shape of the rest's distribution (Kumaraswamy's: `1 - (1 - kappa^a)^b`).
    pub(super) shape: [f64; 2],
}

/// Pressure as the contacts feel it, 0 to 1: nothing is left to close beyond the range.
pub(super) fn felt(pressure_over_range: f64) -> f64 {
    let x = pressure_over_range.max(0.0);
    if x > 1.5 { 1.0 } else { x / (1.0 + x.powf(SHARPNESS)).powf(1.0 / SHARPNESS) }
}

impl Loading {
    /// Share closed at the pressure that is felt.
    pub(super) fn closed(&self, felt: f64) -> f64 {
        let touch = 1.0 - (-felt / self.touch_pressure).exp();
        let rest =
            if self.bend.abs() < 1e-9 { felt } else { (-self.bend * felt).exp_m1() / (-self.bend).exp_m1() };
        self.touch * touch + (1.0 - self.touch) * rest
    }
}

impl Release {
    /// Share of contacts, closed at one pressure, that are open at `kappa` times it.
    pub(super) fn open(&self, kappa: f64) -> f64 {
        let [a, b] = self.shape;
        self.reversible + (1.0 - self.reversible) * (1.0 - kappa.clamp(0.0, 1.0).powf(a)).powf(b)
    }
}
