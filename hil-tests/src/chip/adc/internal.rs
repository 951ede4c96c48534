//! Internal channels: what converters measure inside the chip (RM0440, "ADC connectivity").

use crate::chip::time::Time;

/// Something inside the chip that a converter can measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Internal {
    /// The temperature sensor.
    Temperature,
    /// A third of the battery's voltage.
    Battery,
    /// The internal reference, VREFINT.
    Vrefint,
    /// The output of the operational amplifier of that number.
    Opamp(usize),
}

/// Converter, channel, and what is there.
const CHANNELS: [(usize, usize, Internal); 16] = [
    (1, 13, Internal::Opamp(1)),
    (1, 16, Internal::Temperature),
    (1, 17, Internal::Battery),
    (1, 18, Internal::Vrefint),
    (2, 16, Internal::Opamp(2)),
    (2, 18, Internal::Opamp(3)),
    (3, 13, Internal::Opamp(3)),
    (3, 17, Internal::Battery),
    (3, 18, Internal::Vrefint),
    (4, 17, Internal::Opamp(6)),
    (4, 18, Internal::Vrefint),
    (5, 3, Internal::Opamp(5)),
    (5, 4, Internal::Temperature),
    (5, 5, Internal::Opamp(4)),
    (5, 17, Internal::Battery),
    (5, 18, Internal::Vrefint),
];

impl Internal {
    /// What is inside the chip at a channel of a converter.
    #[must_use]
    pub fn at(adc: usize, channel: usize) -> Option<Self> {
        let found = CHANNELS.iter().find(|&&(known, place, _)| (known, place) == (adc, channel));
        found.map(|&(.., internal)| internal)
    }

    /// How long it has to be sampled (DS12288: ts_temp, ts_vbat, ts_vrefint, and TS_OPAMP_VOUT for a VDDA of 2 V
    /// and more).
    #[must_use]
    pub fn least_sampling(self) -> Time {
        match self {
            Self::Temperature => Time::from_micros(5),
            Self::Battery => Time::from_micros(12),
            Self::Vrefint => Time::from_micros(4),
            Self::Opamp(_) => Time::from_nanos(200),
        }
    }

    /// Field of the common CCR that switches it on; an amplifier has its own.
    #[must_use]
    pub fn switch(self) -> Option<&'static str> {
        match self {
            Self::Temperature => Some("VSENSEEN"),
            Self::Battery => Some("VBATEN"),
            Self::Vrefint => Some("VREFEN"),
            Self::Opamp(_) => None,
        }
    }
}
