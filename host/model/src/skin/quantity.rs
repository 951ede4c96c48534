//! Quantities in the skin file: a plain number in SI units, or text with a unit ("210 mm").

use serde::Deserialize;

/// A number as a person wrote it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number, or text with a unit such as \"210 mm\"")]
pub enum Quantity {
    /// A number in the SI unit.
    Number(f64),
    /// A number with its unit.
    Text(String),
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => write!(formatter, "{value}"),
            Self::Text(text) => write!(formatter, "\"{text}\""),
        }
    }
}

/// A kind of quantity: the units it may carry, each with its size in the SI unit, which is first.
#[derive(Clone, Copy, Debug)]
pub struct Kind(&'static [(&'static str, f64)]);

/// Metres.
pub const LENGTH: Kind = Kind(&[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6)]);
/// Square metres.
pub const AREA: Kind = Kind(&[("m2", 1.0), ("cm2", 1e-4), ("mm2", 1e-6)]);
/// Hertz.
pub const FREQUENCY: Kind = Kind(&[("Hz", 1.0), ("kHz", 1e3), ("MHz", 1e6)]);
/// Amperes.
pub const CURRENT: Kind = Kind(&[("A", 1.0), ("mA", 1e-3), ("uA", 1e-6)]);
/// Siemens per square: the conductance of a square of sheet, whatever its size.
pub const SHEET_CONDUCTIVITY: Kind = Kind(&[("S", 1.0), ("mS", 1e-3), ("uS", 1e-6)]);
/// Farads per square.
pub const CAPACITANCE: Kind = Kind(&[("F", 1.0), ("uF", 1e-6), ("nF", 1e-9), ("pF", 1e-12)]);
/// Ohm metres: contact impedance of an electrode edge; divided by its length it gives ohms.
pub const CONTACT_IMPEDANCE: Kind = Kind(&[("ohm m", 1.0), ("ohm mm", 1e-3), ("kohm m", 1e3)]);
/// Seconds.
pub const TIME: Kind = Kind(&[("s", 1.0), ("ms", 1e-3), ("min", 60.0)]);
/// Newtons.
pub const FORCE: Kind = Kind(&[("N", 1.0), ("mN", 1e-3), ("kN", 1e3)]);
/// Pascals.
pub const PRESSURE: Kind = Kind(&[("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6)]);
/// Radians.
pub const ANGLE: Kind = Kind(&[("rad", 1.0), ("deg", std::f64::consts::PI / 180.0)]);

impl Kind {
    /// A kind with these units, each with its size in the first.
    #[must_use]
    pub const fn new(units: &'static [(&'static str, f64)]) -> Self {
        Self(units)
    }

    /// Value in the SI unit, or `None` if the text is no number with one of the units.
    #[must_use]
    pub fn read(self, quantity: &Quantity) -> Option<f64> {
        let text = match quantity {
            Quantity::Number(value) => return Some(*value),
            Quantity::Text(text) => text.trim(),
        };
        let end = text.find(|c: char| c.is_whitespace() || c.is_alphabetic() && !matches!(c, 'e' | 'E'))?;
        let unit = text[end..].split_whitespace().collect::<Vec<_>>().join(" ");
        let (_, size) = self.0.iter().find(|(name, _)| *name == unit)?;
        Some(text[..end].parse::<f64>().ok()? * size)
    }

    /// The units in words: "m, cm, mm or um".
    #[must_use]
    pub fn units(self) -> String {
        let names: Vec<_> = self.0.iter().map(|(name, _)| *name).collect();
        let (last, first) = names.split_last().expect("every kind has a unit");
        if first.is_empty() { (*last).to_owned() } else { format!("{} or {last}", first.join(", ")) }
    }

    /// The unit of a plain number.
    #[must_use]
    pub fn si(self) -> &'static str {
        self.0[0].0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(kind: Kind, text: &str) -> Option<f64> {
        kind.read(&Quantity::Text(text.to_owned()))
    }

    #[test]
    fn numbers_are_si_and_text_carries_its_unit() {
        assert_eq!(LENGTH.read(&Quantity::Number(0.21)), Some(0.21));
        assert_eq!(read(LENGTH, "210 mm"), Some(210.0 * 1e-3));
        assert_eq!(read(LENGTH, " 2.1e2mm "), Some(210.0 * 1e-3));
        assert_eq!(read(CONTACT_IMPEDANCE, "0.2 ohm  m"), Some(0.2));
        assert_eq!(read(FREQUENCY, "50 kHz"), Some(50e3));
    }

    #[test]
    fn wrong_units_and_missing_units_are_refused() {
        for text in ["210", "210 inch", "mm", "", "210 kHz", "1e mm", "ten mm"] {
            assert_eq!(read(LENGTH, text), None, "{text}");
        }
    }
}
