//! Tare: the untouched skin becomes the reference.

use super::Link;
use crate::error::{LinkError, LinkErrorKind};
use dermatome_shared::protocol::{Event, PatchInfo, Request};
use std::time::Duration;

/// Makes a new reference from `frames` frames of the untouched skin, and waits until it is there.
pub fn tare(link: &mut Link, frames: u16, timeout: Duration) -> Result<(), LinkError> {
    link.request(&Request::Tare { frames })?;
    if is_tared(link, timeout)? { Ok(()) } else { Err(link.error(LinkErrorKind::NoTare { frames, timeout })) }
}

/// Whether a board that was asked for a new reference has one, within this time.
pub fn is_tared(link: &mut Link, wait: Duration) -> Result<bool, LinkError> {
    Ok(link.wait_for(wait, |event| matches!(event, Event::Tared { .. }))?.is_some())
}

/// How long to wait for a tare: four times what the frames need, plus three seconds.
#[must_use]
pub fn tare_timeout(patch: &PatchInfo, frames: u16) -> Duration {
    let seconds = 3.0 + 4.0 * f64::from(frames) / f64::from(patch.drive.frame_rate);
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX).min(Duration::from_secs(3600))
}
