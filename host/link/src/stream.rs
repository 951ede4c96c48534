//! Tare and stream: what a host asks of a board that holds a patch.

use super::{Link, LinkError};
use dermatome_shared::protocol::{Event, PatchInfo, Reply, Request, Selection};
use std::time::Duration;

/// Makes a new reference from `frames` frames of the untouched skin, and waits until it is there.
pub fn tare(link: &mut Link, frames: u16, timeout: Duration) -> Result<(), LinkError> {
    link.request(&Request::Tare { frames })?;
    let tared = link.wait_for(timeout, |event| matches!(event, Event::Tared { .. }))?;
    tared.map(drop).ok_or_else(|| LinkError::NoTare { port: link.port().to_owned(), frames, timeout })
}

/// How long to wait for a tare: four times what the frames need, plus three seconds.
#[must_use]
pub fn tare_timeout(patch: &PatchInfo, frames: u16) -> Duration {
    let seconds = 3.0 + 4.0 * f64::from(frames) / f64::from(patch.drive.frame_rate);
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX).min(Duration::from_secs(3600))
}

/// Starts, changes or (with an empty selection) ends streaming; gives the sequence number of the
/// first frame of the new selection.
///
/// Events of the old selection that nobody fetched are forgotten.
pub fn stream(link: &mut Link, selection: Selection) -> Result<u32, LinkError> {
    let reply = link.request(&Request::Stream(selection))?;
    let Reply::Streaming { first_sequence } = reply else { return Err(link.wrong_reply("Stream")) };
    link.forget_events();
    Ok(first_sequence)
}
