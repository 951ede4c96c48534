//! Lengths in arguments: absolute, or relative to something of the skin's.

use dermatome_model::skin::quantity::{LENGTH, Quantity};
use std::str::FromStr;

/// A length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In metres.
    Metres(f64),
    /// A share of a length that the skin has.
    Share(f64),
}

impl Length {
    /// In metres, `whole` being what a share is of.
    #[must_use]
    pub fn of(self, whole: f64) -> f64 {
        match self {
            Self::Metres(length) => length,
            Self::Share(share) => share * whole,
        }
    }
}

impl FromStr for Length {
    type Err = String;

    /// `5%`, or a length with its unit, such as `12mm`; not negative.
    fn from_str(text: &str) -> Result<Self, String> {
        let per_cent = text.trim().strip_suffix('%');
        let read = match per_cent {
            Some(number) => number.trim().parse().ok().map(|number: f64| Self::Share(number / 100.0)),
            None => LENGTH.read(&Quantity::Text(text.to_owned())).map(Self::Metres),
        };
        read.filter(|length| (0.0..=1e3).contains(&length.of(1.0))).ok_or_else(|| {
            format!("allowed are per cent, as in 5%, and lengths in {}, as in 12mm", LENGTH.units())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn per_cent_and_units_are_read_and_a_bare_number_is_not() {
        assert_eq!("5%".parse(), Ok(Length::Share(0.05)));
        assert_eq!(" 2.5 % ".parse(), Ok(Length::Share(0.025)));
        assert_eq!("12mm".parse(), Ok(Length::Metres(12.0 * 1e-3)));
        assert_eq!("1.2 cm".parse(), Ok(Length::Metres(1.2 * 1e-2)));
        for text in ["5", "-1mm", "-3%", "NaN%", "inf mm", "5 kHz", "%", ""] {
            assert!(text.parse::<Length>().is_err(), "{text}");
        }
        assert_eq!(Length::Share(0.05).of(2.0), 0.1);
    }
}
