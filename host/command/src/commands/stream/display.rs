//! Display: frames on the terminal, or contacts as lines for a pipe.

use crate::commands::contact_lines::{print_json, print_lines};
use dermatome_link::{
    Link, ScanFrame,
    contacts::{LinkFinger, LinkFrame},
    pose::Pose,
};
use dermatome_model::multi_contact::FittedContact;
use dermatome_patch::layout::Layout;
use dermatome_view::{live::Live, terminal::Screen};
use std::io;

/// Where frames go, and in whose frame their contacts lie.
pub(super) enum Display<'a> {
    /// Pictures, drawn in place; contacts on the link, if a skin's pose on one is known.
    Terminal(Box<Live>, Option<&'a Pose>),
    /// One line per contact, in the skin's frame.
    Lines,
    /// One line of JSON per frame, in the frame of the link.
    LinkFrames(&'a Pose),
}

impl<'a> Display<'a> {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted. Contacts
    /// are given in the frame of the link, if a skin's pose on one is known. Fitted fingers are lines always.
    pub(super) fn new(
        link: &mut Link,
        images: bool,
        pose: Option<&'a Pose>,
        is_resolved: bool,
    ) -> anyhow::Result<Self> {
        if !is_resolved && Screen::default().is_visible() {
            let surface = images.then(|| link.surface()).transpose()?;
            return Ok(Self::Terminal(Box::new(Live::new(surface.as_ref().map(Layout::from))), pose));
        }
        Ok(pose.map_or(Self::Lines, Self::LinkFrames))
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(self, Self::Terminal(live, _) if live.has_images())
    }

    /// Says what is wrong with a frame, beside lines that somebody else reads; pictures say it themselves.
    pub(super) fn warn(&self, frame: &ScanFrame, what: &[&str]) {
        let is_picture = matches!(self, Self::Terminal(..));
        if let (Some(at), false, false) = (frame.at, is_picture, what.is_empty()) {
            eprintln!("warning: frame {} has flags not seen before: {}", at.sequence, what.join(", "));
        }
    }

    /// Shows a frame, with the fingers that were found in it.
    pub(super) fn show(&mut self, frame: &ScanFrame, fingers: Option<&[FittedContact]>) -> io::Result<()> {
        if let (Self::Terminal(live, _), Some(image)) = (&mut *self, &frame.image) {
            live.keep_image(image.values().collect());
        }
        let Some((at, contacts)) = frame.at.zip(frame.contacts.as_ref()) else { return Ok(()) };
        match self {
            // Contacts are drawn with their own image.
            Self::Terminal(live, _) if live.has_images() && frame.image.is_none() => Ok(()),
            Self::Terminal(live, Some(pose)) => {
                let on_link = contacts.iter().map(|contact| pose.contact(contact)).collect();
                live.draw_if_due(at, &on_link)
            }
            Self::Terminal(live, None) => live.draw_if_due(at, contacts),
            Self::Lines => print_lines(at, contacts),
            Self::LinkFrames(pose) => {
                let finger =
                    |finger: &FittedContact| LinkFinger::new(finger.position.into(), finger.strength, pose);
                let fingers = fingers.map(|all| all.iter().map(finger).collect());
                print_json(&LinkFrame { fingers, ..LinkFrame::new(pose, at, contacts) })
            }
        }
    }
}
