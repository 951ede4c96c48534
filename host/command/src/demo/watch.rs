//! Watches a board's stream and scores its frames.

use super::{FRAMES, FrameRecord, Scorer};
use dermatome_link::{LinkError, ScanFrame, Subscription};
use std::time::{Duration, Instant};

/// A board that is silent for so long has a fault.
const SILENCE: Duration = Duration::from_secs(5);

/// All that came over the link.
#[derive(Debug, Default)]
pub(crate) struct Watched {
    /// The frames of which everything arrived.
    pub records: Vec<FrameRecord>,
    /// Frames of which something did not arrive.
    pub lost: u64,
    first: Option<Instant>,
    last: Option<Instant>,
}

impl Watched {
    /// Frames per second between the first and the last; `None` for less than two.
    #[must_use]
    pub(crate) fn images_per_second(&self) -> Option<f64> {
        let (first, last) = (self.first?, self.last?);
        (last > first).then(|| (self.records.len() - 1) as f64 / (last - first).as_secs_f64())
    }
}

/// Follows a stream until the demo's last frame has come, or `go_on` says no. `counts` sees each frame, and says whether it is
/// one of the demo's, whose fingers come with the first that counts; `show` sees each of these that is complete.
pub(crate) fn watch(
    mut stream: Subscription<'_>,
    scorer: &Scorer<'_>,
    mut counts: impl FnMut(&ScanFrame) -> bool,
    mut show: impl FnMut(&FrameRecord),
    go_on: impl Fn() -> bool,
) -> Result<Watched, LinkError> {
    let mut first_sequence = None;
    let mut watched = Watched::default();
    let mut next = 0;
    while next < FRAMES {
        let Some(frame) = stream.next_while(SILENCE, &go_on)? else { break };
        let now = Instant::now();
        let Some(at) = frame.at.filter(|_| counts(&frame)) else { continue };
        let first_sequence = *first_sequence.get_or_insert(at.sequence);
        let Some(record) = record(frame, first_sequence, scorer) else { continue };
        watched.first.get_or_insert(now);
        watched.last = Some(now);
        next = record.index + 1;
        show(&record);
        watched.records.push(record);
        if !go_on() {
            break;
        }
    }
    stream.stop()?;
    watched.lost = u64::from(next) - watched.records.len() as u64;
    Ok(watched)
}

/// A frame of which everything has come.
fn record(frame: ScanFrame, first_sequence: u32, scorer: &Scorer<'_>) -> Option<FrameRecord> {
    let (at, contacts, image) = (frame.at?, frame.contacts?, frame.image?);
    Some(scorer.record(at, first_sequence, image.values().collect(), contacts))
}
