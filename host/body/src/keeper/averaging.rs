//! Averaging: a tare, also while a board streams raw codes, so that the frames of which its reference is made come as well.

use dermatome_link::{Link, LinkError, LinkErrorKind, ScanFrame, tare_timeout};
use dermatome_shared::{
    protocol::{PatchInfo, Request},
    reference::DEFAULT_TARE_FRAMES,
};
use std::time::{Duration, Instant};

/// A tare; in a stream its frames come without contacts.
pub(super) struct Averaging {
    begun: Instant,
    timeout: Duration,
    frames: u16,
}

/// What a frame is to a tare.
pub(super) enum Taken {
    /// The first that is averaged.
    First,
    /// Another one, or one from before.
    More,
    /// The first with the new reference.
    Last,
    /// One that comes when all should have been averaged for as long.
    TooLate(LinkErrorKind),
}

impl Averaging {
    /// Has a board make a reference.
    pub(super) fn begin(link: &mut Link, patch: &PatchInfo) -> Result<Self, LinkError> {
        link.request(&Request::Tare { frames: DEFAULT_TARE_FRAMES })?;
        let timeout = tare_timeout(patch, DEFAULT_TARE_FRAMES);
        Ok(Self { begun: Instant::now(), timeout, frames: 0 })
    }

    /// Why it fails, if it has taken too long.
    pub(super) fn too_late(&self) -> Option<LinkErrorKind> {
        let (frames, timeout) = (DEFAULT_TARE_FRAMES, self.timeout);
        (self.begun.elapsed() > timeout).then_some(LinkErrorKind::NoTare { frames, timeout })
    }

    /// A frame has come.
    pub(super) fn take(&mut self, frame: &ScanFrame) -> Taken {
        // Some may be lost, and so may the contacts of one before.
        let is_made = frame.contacts.is_some() && self.frames >= DEFAULT_TARE_FRAMES / 2;
        self.frames += u16::from(frame.contacts.is_none());
        match self.too_late() {
            _ if is_made => Taken::Last,
            Some(why) => Taken::TooLate(why),
            None if self.frames == 1 && frame.contacts.is_none() => Taken::First,
            None => Taken::More,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(has_contacts: bool) -> ScanFrame {
        ScanFrame { contacts: has_contacts.then(Default::default), ..ScanFrame::default() }
    }

    #[test]
    fn it_is_over_with_the_first_contacts_after_its_frames_and_not_where_a_frame_has_lost_its_own() {
        let mut tare = Averaging { begun: Instant::now(), timeout: Duration::from_secs(60), frames: 0 };
        assert!(matches!(tare.take(&frame(true)), Taken::More), "from before");
        assert!(matches!(tare.take(&frame(false)), Taken::First), "lost its contacts");
        assert!(matches!(tare.take(&frame(true)), Taken::More));
        for _ in 0..DEFAULT_TARE_FRAMES {
            assert!(matches!(tare.take(&frame(false)), Taken::More));
        }
        assert!(matches!(tare.take(&frame(true)), Taken::Last));
    }

    #[test]
    fn one_that_takes_too_long_is_an_error() {
        let mut tare = Averaging { begun: Instant::now(), timeout: Duration::ZERO, frames: 0 };
        let Taken::TooLate(LinkErrorKind::NoTare { frames, .. }) = tare.take(&frame(false)) else {
            panic!("it goes on")
        };
        assert_eq!(frames, DEFAULT_TARE_FRAMES);
    }
}
