//! Stream tare: a new reference while the board streams, so that whoever records has the frames that it is made of.

use super::outlets::Outlets;
use dermatome_link::{Link, LinkError, ScanFrame};
use dermatome_shared::{drive::Drive, protocol::Request, reference::DEFAULT_TARE_FRAMES};

/// How far a tare is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum StreamTare {
    /// There is none.
    #[default]
    No,
    /// Wanted, and asked for when the board has contacts again: by them its frames before and after are told apart.
    Wanted,
    /// The board was asked.
    Asked,
    /// Frames come that it averages.
    Averaging,
}

impl StreamTare {
    /// Takes in the next frame, and asks the board when it is time; `drive` is the one in effect. Says whether the frame
    /// is one of those that it averages.
    pub(super) fn see(
        &mut self,
        frame: &ScanFrame,
        link: &mut Link,
        outlets: &mut Outlets,
        drive: Drive,
    ) -> Result<bool, LinkError> {
        let has_contacts = frame.contacts.is_some();
        match self {
            Self::Wanted if has_contacts => {
                link.request(&Request::Tare { frames: DEFAULT_TARE_FRAMES })?;
                outlets.tare_begins(DEFAULT_TARE_FRAMES, drive);
                *self = Self::Asked;
            }
            Self::Asked if !has_contacts && frame.measurements.is_some() => *self = Self::Averaging,
            Self::Averaging if has_contacts => *self = Self::No,
            _ => {}
        }
        Ok(*self == Self::Averaging)
    }
}
