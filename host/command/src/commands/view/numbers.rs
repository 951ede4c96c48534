//! Numbers: what the page plots of a stream.

use dermatome_link::ScanFrame;
use dermatome_recording::frames::Item;
use dermatome_shared::frame::FrameFlags;
use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// Time over which frames a second are counted.
const WINDOW: Duration = Duration::from_secs(2);

/// Counts of the frames that have come.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    pub(super) frames: u64,
    /// Those of streams that are over.
    lost_before: u64,
    lost: u64,
    recent: VecDeque<Instant>,
    flags: FrameFlags,
}

impl Numbers {
    /// A frame has come; so many are missing in its stream.
    pub(super) fn count(&mut self, frame: &ScanFrame, missing: u64) {
        let now = Instant::now();
        self.frames += 1;
        self.lost = missing;
        self.recent.push_back(now);
        while self.recent.front().is_some_and(|first| now - *first > WINDOW) {
            self.recent.pop_front();
        }
        self.flags.insert(frame.at.map(|at| at.flags).unwrap_or_default());
    }

    /// The next stream begins.
    pub(super) fn begin(&mut self) {
        self.lost_before += std::mem::take(&mut self.lost);
        self.recent.clear();
    }

    pub(super) fn lost(&self) -> u64 {
        self.lost_before + self.lost
    }

    /// Frames a second; 0 where less than two have come lately.
    pub(super) fn per_second(&self) -> f32 {
        let (Some(first), Some(last)) = (self.recent.front(), self.recent.back()) else { return 0.0 };
        let seconds = (*last - *first).as_secs_f32();
        let is_stale = last.elapsed() > WINDOW;
        if seconds == 0.0 || is_stale { 0.0 } else { (self.recent.len() - 1) as f32 / seconds }
    }

    /// What was wrong with frames since it was asked last, in words.
    pub(super) fn warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.flags).words().map(str::to_owned).collect()
    }
}

/// Signal over noise of the frames of a tare, dB: mean of the voltages to what they scatter; none for less than two frames.
pub(super) fn signal_to_noise(tare: &[Item]) -> Option<f32> {
    let codes = |item: &Item| match item {
        Item::Frame(frame) => frame.codes.as_ref().map(|[codes, _]| codes.clone()),
        Item::Reference(_) => None,
    };
    let frames: Vec<_> = tare.iter().filter_map(codes).collect();
    let steps = frames.first()?.len();
    let count = frames.len() as f64;
    let (mut signal, mut noise) = (0.0, 0.0);
    for step in 0..steps {
        let values = || frames.iter().filter_map(|codes| codes.get(step)).map(|code| f64::from(code.0));
        let mean = values().sum::<f64>() / count;
        signal += mean * mean;
        noise += values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    }
    (frames.len() > 1 && noise > 0.0).then(|| (10.0 * (signal / noise).log10()) as f32)
}
