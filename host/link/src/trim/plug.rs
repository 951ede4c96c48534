//! Plug: sixteen known resistors in a ring, in place of a skin.

use dermatome_shared::{limits::MAX_ELECTRODES, stimulation::Step};

/// Resistors between neighbouring electrodes, the last one back to the first. Two values that take turns give
/// channels large and small voltages: so what is no resistor's, such as the amplifier's common mode, is told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plug {
    ohms: [f64; MAX_ELECTRODES],
}

impl Plug {
    /// Two resistances that take turns, ohm: `first` between electrodes 1 and 2, `second` between 2 and 3.
    #[must_use]
    pub fn new(first: f64, second: f64) -> Self {
        Self { ohms: std::array::from_fn(|place| if place % 2 == 0 { first } else { second }) }
    }

    /// The resistances, ohm: `[electrode]` is between that electrode and the next.
    #[must_use]
    pub fn ohms(&self) -> &[f64; MAX_ELECTRODES] {
        &self.ohms
    }

    /// Transfer resistance of a step, ohm, from the resistances between its electrodes.
    #[must_use]
    pub fn transfer(&self, step: Step) -> f64 {
        let [from, to, plus, minus] = step.to_bytes().map(|electrode| self.place(electrode));
        let (near, far) = (
            self.between(from, minus) + self.between(to, plus),
            self.between(from, plus) + self.between(to, minus),
        );
        (near - far) / 2.0
    }

    /// Resistance along the ring between the electrodes that a step senses, ohm, the shorter way; above zero where it runs
    /// upwards from plus to minus.
    #[must_use]
    pub fn sensed(&self, step: Step) -> f64 {
        let way = self.place(step.sense_minus) - self.place(step.sense_plus);
        let other = way - self.sum() * way.signum();
        if way.abs() <= other.abs() { way } else { other }
    }

    /// Largest transfer resistance that adjacent electrodes give, ohm.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let largest = self.ohms.iter().copied().fold(0.0, f64::max);
        largest * largest / self.sum()
    }

    fn sum(&self) -> f64 {
        self.ohms.iter().sum()
    }

    /// Resistance along the ring from the first electrode, ohm.
    fn place(&self, electrode: u8) -> f64 {
        self.ohms.iter().take(electrode.into()).sum()
    }

    /// Resistance between two places: both ways round side by side.
    fn between(&self, a: f64, b: f64) -> f64 {
        let way = (a - b).abs();
        way * (self.sum() - way) / self.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::stimulation::{Driven, pattern};

    #[test]
    fn neighbours_share_the_current_of_the_ring() {
        let plug = Plug::new(10.0, 100.0);
        assert_eq!(plug.sensed(Step::from_bytes([3, 2, 15, 0])), 100.0);
        assert_eq!(plug.sensed(Step::from_bytes([3, 2, 1, 0])), -10.0);
        assert!((plug.largest() - 10_000.0 / 880.0).abs() < 1e-12);
        for step in pattern(16, 1, 1, Driven::Skipped) {
            let [driven, sensed] = [step.drive_minus, step.sense_plus].map(|at| plug.ohms()[usize::from(at)]);
            let expected = driven * sensed / 880.0;
            assert!((plug.transfer(step) - expected).abs() < 1e-9, "{step:?} {}", plug.transfer(step));
        }
        // Sensed where it is driven: both ways round side by side.
        assert!((plug.transfer(Step::from_bytes([1, 2, 1, 2])) - 100.0 * 780.0 / 880.0).abs() < 1e-9);
        assert!((plug.transfer(Step::from_bytes([15, 0, 0, 15])) + 100.0 * 780.0 / 880.0).abs() < 1e-9);
    }
}
