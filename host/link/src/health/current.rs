//! Current: as large as the skin file says, where voltages and electrodes' tests have room for it; else smaller.
//!
//! A skin file cannot know how well a sheet conducts that its maker changed, nor what its contacts are like. Where the
//! tests of the electrodes are clipped, a contact that becomes worse is not told from a press.

use super::watch;
use crate::{error::LinkError, link::Link};
use dermatome_shared::{drive::Drive, protocol::Request};
use std::time::Duration;

/// How often a current is halved: a sheet may conduct a thousand times worse than a skin file says.
const HALVINGS: usize = 10;
/// Frames that show whether one is too large.
const FRAMES: usize = 5;

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedCurrent {
    /// Amplitude before, A.
    pub before: f32,
    /// Amplitude in effect, A.
    pub amplitude: f32,
    /// Whether voltages clip however small the current: then it is what it was.
    pub clips: bool,
}

impl FittedCurrent {
    /// Whether the current is smaller than it was.
    #[must_use]
    pub fn is_lowered(&self) -> bool {
        self.amplitude < self.before
    }
}

/// Halves a board's current, as it is in `drive`, until neither voltages that count nor the tests of more than a few
/// sound electrodes clip. What it tries lasts until the next patch or restart; a reference is lost where it lowers the
/// current. `None` if `go_on` says no; silence for `timeout` is an error; either way the current is what it was.
pub fn fit_current(
    link: &mut Link,
    drive: Drive,
    timeout: Duration,
    go_on: impl Fn() -> bool,
) -> Result<Option<FittedCurrent>, LinkError> {
    let fitted = halve(link, drive, timeout, &go_on);
    if !matches!(fitted, Ok(Some(FittedCurrent { clips: false, .. }))) {
        link.request(&Request::Drive(Some(drive)))?;
    }
    fitted
}

fn halve(
    link: &mut Link,
    drive: Drive,
    timeout: Duration,
    go_on: &impl Fn() -> bool,
) -> Result<Option<FittedCurrent>, LinkError> {
    let before = drive.amplitude;
    for halvings in 0..=HALVINGS {
        let amplitude = before * 0.5_f32.powi(halvings as i32);
        if halvings > 0 {
            link.request(&Request::Drive(Some(Drive { amplitude, ..drive })))?;
        }
        let watch = watch(link, FRAMES, timeout, go_on)?;
        if !go_on() {
            return Ok(None);
        }
        if !watch.has_too_much_current() {
            return Ok(Some(FittedCurrent { before, amplitude, clips: false }));
        }
    }
    Ok(Some(FittedCurrent { before, amplitude: before, clips: true }))
}
