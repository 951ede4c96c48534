//! Display: frames on the terminal, or contacts as lines for a pipe.

use dermatome_link::{
    Link, ScanFrame,
    contacts::{LinkFinger, LinkFrame},
    pose::Pose,
};
use dermatome_model::multi_contact::FittedContact;
use dermatome_patch::layout::Layout;
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::FrameStamp,
};
use dermatome_view::{
    live::Live,
    terminal::{Screen, flags},
};
use std::io::{self, Write};

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

fn print_json(frame: &LinkFrame) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", serde_json::to_string(frame)?)?;
    out.flush()
}

fn print_lines(at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for contact in contacts {
        writeln!(out, "{}", line(at, contact))?;
    }
    out.flush()
}

/// Sequence, time, x, y, z, area, strength, pressure and force (empty where no calibration tells them), flags.
fn line(at: FrameStamp, contact: &Contact) -> String {
    let [x, y, z] = contact.position.map(|metres| metres * 1e3);
    let (sequence, time, area) = (at.sequence, seconds(at), contact.area * 1e6);
    let pressure = contact.pressure.map_or(String::new(), |pascal| format!("{:.4}", pascal * 1e-3));
    let force = contact.force().map_or(String::new(), |force| format!("{force:.5}"));
    let (strength, flags) = (contact.strength, flags(at.flags));
    format!(
        "{sequence}\t{time:.6}\t{x:.3}\t{y:.3}\t{z:.3}\t{area:.2}\t{strength:.6}\t{pressure}\t{force}\t{flags}"
    )
}

fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    #[test]
    fn a_line_has_ten_fields_of_which_two_need_a_calibration_and_one_a_fault() {
        let at = FrameStamp { sequence: 7, timestamp_us: 1_250_000, flags: FrameFlags::default() };
        let contact = Contact {
            position: [0.01, -0.002, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 4e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        assert_eq!(line(at, &contact), "7\t1.250000\t10.000\t-2.000\t0.000\t4.00\t0.500000\t\t\t");
        let calibrated = Contact { pressure: Some(12.5e3), ..contact };
        let mut flags = FrameFlags::SATURATED;
        flags.insert(FrameFlags::MASKED);
        let at = FrameStamp { flags, ..at };
        assert!(line(at, &calibrated).ends_with("\t0.500000\t12.5000\t\tsaturated, bad electrodes masked"));
        let calibrated = Contact { load_area: Some(4e-6), ..calibrated };
        assert!(line(at, &calibrated).ends_with("\t12.5000\t0.05000\tsaturated, bad electrodes masked"));
    }
}
