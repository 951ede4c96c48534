//! Virtual time: femtoseconds since the machine was switched on.
//!
//! Clocks divide a second into periods that are no whole number of any larger unit; rounded to
//! femtoseconds, 170 MHz is right to 1e-8. 64 bits last for five hours.

use std::{
    fmt,
    ops::{Add, AddAssign, Mul, Sub},
    time::Duration,
};

/// A point in virtual time, or a span of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(u64);

impl Time {
    /// Switching on.
    pub const ZERO: Self = Self(0);
    /// Later than any event.
    pub const NEVER: Self = Self(u64::MAX);

    /// One period of a clock of so many hertz.
    #[must_use]
    pub fn period(hertz: u64) -> Self {
        Self((1_000_000_000_000_000 + hertz / 2) / hertz.max(1))
    }

    /// So many microseconds.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self(micros * 1_000_000_000)
    }

    /// So many nanoseconds.
    #[must_use]
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos * 1_000_000)
    }

    /// So many milliseconds.
    #[must_use]
    pub const fn from_millis(millis: u64) -> Self {
        Self::from_micros(millis * 1000)
    }

    /// As seconds.
    #[must_use]
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-15
    }

    /// As whole nanoseconds.
    #[must_use]
    pub fn nanoseconds(self) -> u64 {
        self.0 / 1_000_000
    }

    /// How many whole periods fit.
    #[must_use]
    pub fn periods(self, period: Self) -> u64 {
        self.0 / period.0.max(1)
    }

    /// Span since `earlier`; none if that is later.
    #[must_use]
    pub fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl From<Duration> for Time {
    fn from(duration: Duration) -> Self {
        Self(u64::try_from(duration.as_nanos()).map_or(u64::MAX, |nanos| nanos.saturating_mul(1_000_000)))
    }
}

impl From<Time> for Duration {
    fn from(time: Time) -> Self {
        Self::from_nanos(time.nanoseconds())
    }
}

impl Add for Time {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl AddAssign for Time {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Time {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.since(other)
    }
}

impl Mul<u64> for Time {
    type Output = Self;
    fn mul(self, factor: u64) -> Self {
        Self(self.0.saturating_mul(factor))
    }
}

impl fmt::Display for Time {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:.3} us", self.0 as f64 * 1e-9)
    }
}
