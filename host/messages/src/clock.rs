//! Clock: times of a board's clock as the host's.
//!
//! What comes fastest took the link the least time, so host time - board time of the fastest frame is the offset between
//! the clocks, but for the link's least delay. Crystals differ: the offset may also grow, by as much as two may be apart.

use std::time::{SystemTime, UNIX_EPOCH};

/// Most by which the clocks of board and host run apart, ns each ms: 200 ppm, two crystals of 100 ppm.
const APART_NS_EACH_MS: u64 = 200;

/// Offset between a board's clock and the host's, as it is known so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Host's time less the board's, ns, and the board's time then.
    offset: Option<(i128, u64)>,
}

impl Clock {
    /// The host's time, ns since 1970, of a frame that has come now with this time of the board's clock, us.
    pub fn host_time(&mut self, device_time_us: u64, now_ns: u64) -> u64 {
        let device_ns = i128::from(device_time_us) * 1000;
        let seen = i128::from(now_ns) - device_ns;
        let offset = match self.offset {
            // A clock that goes back is that of a board that has started anew.
            Some((offset, before_us)) if device_time_us >= before_us => {
                let most = offset + i128::from((device_time_us - before_us) / 1000 * APART_NS_EACH_MS);
                seen.min(most)
            }
            _ => seen,
        };
        self.offset = Some((offset, device_time_us));
        u64::try_from(device_ns + offset).unwrap_or(now_ns)
    }
}

/// Now, ns since 1970.
#[must_use]
pub fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_frame_tells_the_offset_and_slower_ones_do_not_move_it() {
        let mut clock = Clock::default();
        let start = 1_700_000_000_000_000_000_u64;
        for frame in 0..1000_u64 {
            let device_us = 5_000 + frame * 2_500;
            let late_ns = 300_000 + (frame * 7919 % 13) * 1_000_000;
            let mapped = clock.host_time(device_us, start + device_us * 1000 + late_ns);
            let error = mapped as i64 - (start + device_us * 1000) as i64;
            assert!(frame < 13 || (0..=1_000_000).contains(&error), "{frame}: {error}");
        }
    }

    #[test]
    fn a_board_that_starts_anew_has_a_new_offset() {
        let mut clock = Clock::default();
        clock.host_time(9_000_000, 10_000_000_000);
        assert_eq!(clock.host_time(1_000, 20_000_000_000), 20_000_000_000);
    }

    #[test]
    fn a_board_whose_clock_is_slow_is_followed() {
        let mut clock = Clock::default();
        let mut error = 0;
        for second in 0..3600_u64 {
            let device_us = second * 1_000_000;
            let true_ns = second * 1_000_100_000 + 1_000_000_000;
            error = true_ns as i64 - clock.host_time(device_us, true_ns) as i64;
        }
        assert!(error.abs() < 1_000, "{error}");
    }
}
