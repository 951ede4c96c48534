//! Clock: times of a board's clock as the host's.
//!
//! What comes fastest took the link the least time, so host time - board time of the fastest frames is the offset between
//! the clocks, but for the link's least delay. Crystals differ, so the offset grows: it is the line under all frames of the
//! last minute that lies nearest to them, an edge of their lower convex hull (Zhang, Liu and Xia, "Clock synchronization
//! algorithms for network measurements", 2002). Before some seconds have passed it is that of the fastest of the last one.

use std::{
    collections::VecDeque,
    time::{SystemTime, UNIX_EPOCH},
};

/// Most by which the clocks of board and host run apart: two crystals of 100 ppm.
const MOST_SKEW: f64 = 200e-6;
/// Of the frames of so much time the fastest counts, ns of the board's clock,
const BIN_NS: i64 = 500_000_000;
/// and so many of them make the line,
const BINS: usize = 120;
/// or the last ones, as long as there are fewer than so many.
const LEAST_BINS: usize = 12;
const LAST_BINS: usize = 2;
/// A frame that is earlier than any by so much, ns, or frames that are all later for so many bins: the host's clock was set.
const SET_NS: f64 = 100e6;
const SET_BINS: usize = 4;
/// After a silence of so long, ns, one frame that is late by as much is enough: the board's clock stood still, or began anew.
const SILENCE_NS: i64 = 1_000_000_000;
/// Frames whose lateness is kept.
const KEPT: usize = 256;

/// Offset between a board's clock and the host's, as it is known so far.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    /// The first frame: board's and host's time, ns. All else counts from there.
    origin: Option<(u64, u64)>,
    /// Board's and host's time of the last frame, ns.
    last: (i64, i64),
    /// The fastest frame of each bin, the last one still open.
    bins: VecDeque<Fastest>,
    line: Line,
    /// By how much frames came later than the line, ns.
    lateness: VecDeque<f64>,
}

/// The fastest frame of some time.
#[derive(Clone, Copy, Debug)]
struct Fastest {
    bin: i64,
    /// Board's time and host's less board's, ns from the origin.
    at: f64,
    offset: f64,
}

/// Offset by the board's time, ns.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    at: f64,
    offset: f64,
    skew: f64,
}

/// How much later than the fastest ones frames come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter {
    /// Of the last frames, ns.
    pub median_ns: u64,
    /// Of the last frames, ns.
    pub largest_ns: u64,
    /// By how much the board's clock is slow, of a second each second.
    pub skew: f64,
}

impl Line {
    fn offset_at(&self, time: f64) -> f64 {
        self.offset + self.skew * (time - self.at)
    }
}

impl Clock {
    /// The host's time, ns since 1970, of a frame that has come now with this time of the board's clock, us.
    pub fn host_time(&mut self, device_time_us: u64, now_ns: u64) -> u64 {
        let device_ns = device_time_us.saturating_mul(1000);
        let (device_0, host_0) = *self.origin.get_or_insert((device_ns, now_ns));
        let time = device_ns.wrapping_sub(device_0) as i64;
        let late = now_ns.wrapping_sub(host_0) as i64;
        let seen = (late - time) as f64;
        let (last, heard) = std::mem::replace(&mut self.last, (time, late));
        let was_silent = late.saturating_sub(heard) > SILENCE_NS && !self.bins.is_empty();
        // A clock that goes back is that of a board that has started anew.
        if time < last || was_silent && seen - self.line.offset_at(time as f64) > SET_NS {
            *self = Self::default();
            return self.host_time(device_time_us, now_ns);
        }
        if self.bins.is_empty() {
            self.line = Line { at: time as f64, offset: seen, skew: 0.0 };
        }
        self.count(time, seen);
        let offset = self.line.offset_at(time as f64);
        if self.lateness.len() == KEPT {
            self.lateness.pop_front();
        }
        self.lateness.push_back(seen - offset);
        host_0.saturating_add_signed(time + offset as i64)
    }

    /// How much later than the fastest ones the last frames came; none before there are some.
    #[must_use]
    pub fn jitter(&self) -> Option<Jitter> {
        let mut lateness: Vec<f64> = self.lateness.iter().copied().collect();
        lateness.sort_by(f64::total_cmp);
        let nearest = |value: &f64| value.max(0.0) as u64;
        let median_ns = nearest(lateness.get(lateness.len() / 2)?);
        Some(Jitter { median_ns, largest_ns: nearest(lateness.last()?), skew: self.line.skew })
    }

    fn count(&mut self, time: i64, offset: f64) {
        let (bin, at) = (time / BIN_NS, time as f64);
        if offset < self.line.offset_at(at) - SET_NS {
            self.bins.clear();
        }
        match self.bins.back_mut().filter(|last| last.bin == bin) {
            Some(last) if offset < last.offset => (last.at, last.offset) = (at, offset),
            Some(_) => {}
            None => {
                self.forget_what_was_before_the_host_was_set();
                if self.bins.len() == BINS {
                    self.bins.pop_front();
                }
                self.bins.push_back(Fastest { bin, at, offset });
                self.line = self.fitted();
            }
        }
        if offset < self.line.offset_at(at) {
            self.line = Line { at, offset, ..self.line };
        }
    }

    fn forget_what_was_before_the_host_was_set(&mut self) {
        let line = self.line;
        let is_late = |fastest: &Fastest| fastest.offset - line.offset_at(fastest.at) > SET_NS;
        let last = self.bins.len().saturating_sub(SET_BINS);
        if last > 0 && self.bins.iter().skip(last).all(is_late) {
            self.bins.drain(..last);
        }
    }

    /// The line under all bins that lies nearest to them; under the last few, level, while there are too few.
    fn fitted(&self) -> Line {
        // The open bin holds one frame so far, which need not be fast.
        let closed = self.bins.len().saturating_sub(1);
        if closed < LEAST_BINS {
            let last = self.bins.iter().skip(closed.saturating_sub(LAST_BINS));
            let fastest = last.min_by(|a, b| a.offset.total_cmp(&b.offset));
            return fastest.map_or(self.line, |it| Line { at: it.at, offset: it.offset, skew: 0.0 });
        }
        let mut hull: Vec<Fastest> = Vec::new();
        for &point in self.bins.iter().take(closed) {
            while let [.., a, b] = hull[..] {
                let is_above =
                    (b.offset - a.offset) * (point.at - a.at) >= (point.offset - a.offset) * (b.at - a.at);
                if !is_above {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        let middle = self.bins.iter().take(closed).map(|point| point.at).sum::<f64>() / closed as f64;
        let edge = hull.windows(2).find(|edge| edge[1].at >= middle);
        let Some([a, b]) = edge else { return self.line };
        let skew = ((b.offset - a.offset) / (b.at - a.at)).clamp(-MOST_SKEW, MOST_SKEW);
        let offset_at = |point: &Fastest| point.offset - skew * point.at;
        let lowest = hull.iter().map(offset_at).fold(f64::INFINITY, f64::min);
        Line { at: 0.0, offset: lowest, skew }
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

    const START: u64 = 1_700_000_000_000_000_000;

    /// Numbers that are the same each time, 0 to 1.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Largest error after 2 s, ms, of a board with this skew whose frames come late by `late` of a number from 0 to 1, ms.
    fn worst(skew: f64, frame_rate: f64, seed: u64, late: impl Fn(f64) -> f64) -> f64 {
        let (mut clock, mut numbers) = (Clock::default(), Numbers(seed));
        let frames = (300.0 * frame_rate) as u64;
        let errors = (0..frames).map(|frame| {
            let true_s = frame as f64 / frame_rate;
            let device_us = 5_000_000 + (true_s * (1.0 - skew) * 1e6) as u64;
            let true_ns = START + (true_s * 1e9) as u64;
            let found = clock.host_time(device_us, true_ns + (late(numbers.next()) * 1e6) as u64);
            if true_s < 2.0 { 0.0 } else { (found as i64 - true_ns as i64) as f64 * 1e-6 }
        });
        errors.fold(0.0, |worst: f64, error| worst.max(error.abs()))
    }

    #[test]
    fn a_clock_50_ppm_off_with_1_ms_of_jitter_is_mapped_to_a_fifth_of_a_millisecond() {
        let mut worst_of_all: f64 = 0.0;
        for frame_rate in [50.0, 100.0, 400.0] {
            for skew in [-50e-6, 0.0, 50e-6] {
                for seed in 0..20 {
                    let even = worst(skew, frame_rate, seed, |number| number);
                    // Mean 1 ms, now and then 10.
                    let bursts = worst(skew, frame_rate, seed, |number| -(1.0 - number).ln());
                    worst_of_all = worst_of_all.max(even).max(bursts);
                }
            }
        }
        println!("at most {worst_of_all:.3} ms");
        assert!(worst_of_all <= 0.2, "{worst_of_all} ms");
    }

    #[test]
    fn late_frames_do_not_move_it_and_their_lateness_is_told() {
        let mut clock = Clock::default();
        for frame in 0..1000_u64 {
            let device_us = 5_000 + frame * 2_500;
            let late_ns = 300_000 + (frame * 7919 % 13) * 1_000_000;
            let mapped = clock.host_time(device_us, START + device_us * 1000 + late_ns);
            let error = mapped as i64 - (START + device_us * 1000) as i64;
            assert!(frame < 13 || (0..=1_000_000).contains(&error), "{frame}: {error}");
        }
        let jitter = clock.jitter().unwrap();
        assert!((5_000_000..=7_000_000).contains(&jitter.median_ns), "{jitter:?}");
        assert!((11_000_000..=13_000_000).contains(&jitter.largest_ns), "{jitter:?}");
    }

    #[test]
    fn a_board_that_starts_anew_has_a_new_offset() {
        let mut clock = Clock::default();
        clock.host_time(9_000_000, 10_000_000_000);
        assert_eq!(clock.host_time(1_000, 20_000_000_000), 20_000_000_000);
    }

    #[test]
    fn a_board_whose_clock_stood_still_while_it_was_silent_has_a_new_offset_with_its_first_frame() {
        let mut clock = Clock::default();
        for stopped in [0, 6_000_000_000, 6_150_000_000] {
            for frame in 0..100_u64 {
                let device_us = stopped / 1_000 + frame * 10_000;
                let true_ns = START + 2 * stopped + frame * 10_000_000;
                assert_eq!(clock.host_time(device_us, true_ns), true_ns, "{stopped}, {frame}");
            }
        }
        // After a second of silence, late by less: the link was slow.
        let (device_us, now) = (8_200_000, START + 2 * 6_150_000_000 + 2_050_000_000 + 50_000_000);
        assert_eq!(now - clock.host_time(device_us, now), 50_000_000);
    }

    #[test]
    fn a_host_whose_clock_is_set_is_followed() {
        let mut clock = Clock::default();
        for (second_0, set) in [(0, 0_i64), (100, 3_600_000_000_000), (200, -5_000_000_000)] {
            let mut error = i64::MAX;
            for frame in 0..1000_u64 {
                let device_us = second_0 * 1_000_000 + frame * 10_000;
                let true_ns = (START + device_us * 1000).saturating_add_signed(set);
                error = clock.host_time(device_us, true_ns) as i64 - true_ns as i64;
            }
            assert!(error.abs() < 100_000, "{set}: {error}");
        }
    }

    #[test]
    fn an_hour_of_skew_is_followed() {
        let mut clock = Clock::default();
        let mut error = 0;
        for second in 0..3600_u64 {
            let device_us = second * 1_000_000;
            let true_ns = second * 1_000_100_000 + 1_000_000_000;
            error = true_ns as i64 - clock.host_time(device_us, true_ns) as i64;
        }
        assert!(error.abs() < 1_000, "{error}");
        assert!((clock.jitter().unwrap().skew - 100e-6).abs() < 1e-7);
    }
}
