//! Latency: how long frames took from the end of their scan.

use std::collections::VecDeque;

/// Frames whose latency is kept: those of the last minute and a half at 100 a second.
const KEPT: usize = 8192;

/// Latencies of the last frames of a skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Latencies {
    /// us
    last: VecDeque<u32>,
}

/// What they were like, ms.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Latency {
    /// Half took less.
    pub median_ms: f64,
    /// 99 of 100 took less.
    pub most_ms: f64,
}

impl Latencies {
    /// A frame took so long, ns; less than nothing by as much as the clocks' offset is in doubt.
    pub(crate) fn count(&mut self, took_ns: i64) {
        if self.last.len() == KEPT {
            self.last.pop_front();
        }
        let us = took_ns.max(0) / 1000;
        self.last.push_back(u32::try_from(us).unwrap_or(u32::MAX));
    }

    /// None before a frame has come.
    pub(crate) fn summary(&self) -> Option<Latency> {
        let mut sorted: Vec<u32> = self.last.iter().copied().collect();
        sorted.sort_unstable();
        let at = |share: f64| {
            let index = (share * (sorted.len().checked_sub(1)? as f64)).round() as usize;
            Some(f64::from(*sorted.get(index)?) * 1e-3)
        };
        Some(Latency { median_ms: at(0.5)?, most_ms: at(0.99)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_took_less_than_the_median_and_99_of_100_less_than_the_most() {
        let mut latencies = Latencies::default();
        assert_eq!(latencies.summary(), None);
        (0..=100).rev().for_each(|ms| latencies.count(ms * 1_000_000));
        assert_eq!(latencies.summary(), Some(Latency { median_ms: 50.0, most_ms: 99.0 }));
        latencies.count(-5);
        latencies.count(i64::MAX);
        assert_eq!(latencies.summary().map(|it| it.median_ms), Some(50.0));
    }

    #[test]
    fn only_the_last_frames_count() {
        let mut latencies = Latencies::default();
        (0..KEPT).for_each(|_| latencies.count(9_000_000));
        (0..KEPT).for_each(|_| latencies.count(1_000_000));
        assert_eq!(latencies.summary(), Some(Latency { median_ms: 1.0, most_ms: 1.0 }));
        assert_eq!(latencies.last.len(), KEPT);
    }
}
