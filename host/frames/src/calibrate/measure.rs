//! Readings from a board while a machine loads its skin.

use super::{
    Hold, Reading,
    pairing::{NoFrames, Pairing, Strongest},
};
use dermatome_link::{LinkError, ScanFrame, Subscription};
use dermatome_shared::contact::Contact;
use std::time::Duration;

/// Pairs the contacts of a stream with the loads that are applied meanwhile, the first frame at time 0.
///
/// `counts` sees each frame, and says whether it counts; `progress` hears of each reading; silence for `timeout` ends it
/// with an error.
pub fn measure(
    mut stream: Subscription<'_>,
    loads: &[Hold],
    timeout: Duration,
    mut counts: impl FnMut(&ScanFrame) -> bool,
    mut progress: impl FnMut(&Reading),
) -> Result<Vec<Reading>, MeasureError> {
    let mut pairing = Pairing::new(loads);
    let mut start = None;
    while !pairing.is_complete() {
        let silence = MeasureError::Silence { seconds: timeout.as_secs_f64() };
        let frame = stream.next(timeout)?.ok_or(silence)?;
        if !counts(&frame) {
            continue;
        }
        let (Some(at), Some(contacts)) = (frame.at, frame.contacts) else { continue };
        let since_start = at.timestamp_us.checked_sub(*start.get_or_insert(at.timestamp_us));
        let time = since_start.ok_or(MeasureError::Restarted)? as f64 * 1e-6;
        pairing.add(time, contacts.first().map(Strongest::from))?.iter().for_each(&mut progress);
    }
    stream.stop()?;
    Ok(pairing.into_readings())
}

impl From<&Contact> for Strongest {
    fn from(contact: &Contact) -> Self {
        Self {
            strength: contact.strength.into(),
            area_mm2: f64::from(contact.area) * 1e6,
            place: Some(contact.position.map(f64::from)),
        }
    }
}

/// Why there are no readings.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A load was held too briefly.
    #[error(transparent)]
    NoFrames(#[from] NoFrames),
    /// The board's clock went back, and with it its tare is gone.
    #[error("the board started again while the machine loaded the skin; tare and load it again")]
    Restarted,
    /// The board sends nothing any more.
    #[error("the board sent no frame for {seconds} s")]
    Silence {
        /// How long, s.
        seconds: f64,
    },
}
