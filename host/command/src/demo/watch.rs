//! Watches a board's stream and puts the parts of each frame together.

use super::{FRAMES, FrameRecord, Scorer};
use dermatome_link::{self as link, Link, LinkError};
use dermatome_shared::{
    contact::Contacts,
    protocol::{Event, Reply, Request, Selection},
    units::AdcCode,
};
use std::time::{Duration, Instant};

/// A board that is silent for so long has a fault.
const SILENCE: Duration = Duration::from_secs(5);
/// How often to ask whether to go on while nothing comes.
const POLL: Duration = Duration::from_millis(100);

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

/// Mean codes of the untouched skin as the board has them, summed over the steps of each
/// measurement: `[measurement]`.
pub(crate) fn reference(link: &mut Link) -> Result<Vec<f64>, LinkError> {
    match link.request(&Request::Reference)? {
        Reply::Reference { frames, sums } => {
            Ok(sums.iter().map(|&sum| sum as f64 / f64::from(frames)).collect())
        }
        _ => Err(LinkError::WrongReply { port: link.port().to_owned(), request: "Reference" }),
    }
}

/// Streams until the demo's last frame has come, or `go_on` (which sees each new frame, and `None`
/// while nothing comes) says no.
pub(crate) fn watch(
    link: &mut Link,
    scorer: &Scorer<'_>,
    mut go_on: impl FnMut(Option<&FrameRecord>) -> bool,
) -> Result<Watched, LinkError> {
    let selection = Selection { images: 1, contacts: 1, measurements: 1, ..Selection::default() };
    let first_sequence = link::stream(link, selection)?;
    let mut watched = Watched::default();
    let mut arriving = Arriving::default();
    let mut heard = Instant::now();
    let mut next = 0;
    while next < FRAMES {
        let Some(event) = link.next_event(POLL)? else {
            if heard.elapsed() > SILENCE {
                return Err(LinkError::NoAnswer { port: link.port().to_owned(), timeout: SILENCE });
            }
            if !go_on(None) {
                break;
            }
            continue;
        };
        heard = Instant::now();
        let Some(record) = arriving.take(event, first_sequence, scorer) else { continue };
        watched.first.get_or_insert(heard);
        watched.last = Some(heard);
        next = record.index + 1;
        watched.records.push(record);
        if !go_on(watched.records.last()) {
            break;
        }
    }
    link::stream(link, Selection::default())?;
    watched.lost = u64::from(next) - watched.records.len() as u64;
    Ok(watched)
}

/// Parts of the frame that is arriving, each with its frame's sequence number.
#[derive(Default)]
struct Arriving {
    contacts: Option<(u32, Contacts)>,
    codes: Option<(u32, Vec<AdcCode>)>,
}

impl Arriving {
    /// Takes one event; the image comes last and completes a frame of which everything has arrived.
    fn take(&mut self, event: Event, first_sequence: u32, scorer: &Scorer<'_>) -> Option<FrameRecord> {
        match event {
            Event::Contacts { at, contacts } => self.contacts = Some((at.sequence, contacts)),
            Event::Measurements { at, codes, .. } => self.codes = Some((at.sequence, codes.to_vec())),
            Event::Image { at, image } => {
                let (_, contacts) = self.contacts.take().filter(|(sequence, _)| *sequence == at.sequence)?;
                let (_, codes) = self.codes.take().filter(|(sequence, _)| *sequence == at.sequence)?;
                return Some(scorer.record(at, first_sequence, image.values().collect(), contacts, &codes));
            }
            Event::Tared { .. } | Event::Health { .. } | Event::Scope(_) => {}
        }
        None
    }
}
