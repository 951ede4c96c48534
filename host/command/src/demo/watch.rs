//! Watches a board's stream and scores its frames.

use super::{FRAMES, FrameRecord, Scorer};
use crate::commands::outlets::Outlets;
use dermatome_link::{Link, LinkError, ScanFrame};
use dermatome_shared::protocol::Selection;
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

/// Streams until the demo's last frame has come, or `go_on` says no; `show` sees each complete frame. The board has no
/// reference where its frames also go to `outlets`: it makes one in the stream, before the fingers come.
pub(crate) fn watch(
    link: &mut Link,
    scorer: &Scorer<'_>,
    mut outlets: Option<&mut Outlets>,
    mut show: impl FnMut(&FrameRecord),
    go_on: impl Fn() -> bool,
) -> Result<Watched, LinkError> {
    let raw = u16::from(outlets.is_some());
    let selection =
        Selection { images: 1, contacts: 1, measurements: raw, health: raw, ..Selection::default() };
    let mut stream = link.subscribe(selection)?;
    let mut first_sequence = outlets.is_none().then(|| stream.first_sequence());
    if let Some(outlets) = &mut outlets {
        outlets.tare(stream.link())?;
    }
    let mut watched = Watched::default();
    let mut next = 0;
    while next < FRAMES {
        let Some(frame) = stream.next_while(SILENCE, &go_on)? else { break };
        let now = Instant::now();
        if let Some(outlets) = &mut outlets {
            outlets.frame(&frame, None);
            if outlets.is_taring() {
                continue;
            }
        }
        let Some(at) = frame.at else { continue };
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
