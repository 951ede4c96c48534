//! Display: frames on the terminal, or contacts as lines for a pipe.

use dermatome_link::Link;
use dermatome_model::{multi_contact::Resolved, skin::Pose};
use dermatome_patch::layout::Layout;
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::{FrameStamp, PackedImage},
    track::Tracker,
};
use dermatome_view::{
    live::Live,
    terminal::{Screen, flags},
};
use serde::Serialize;
use std::io::{self, Write};

/// A contact farther than this from where the last one was going is another one, m.
const REACH: f32 = 0.025;
/// A contact that is lost for as long keeps its number, us.
const PATIENCE_US: u64 = 300_000;

/// Where frames go, and in whose frame their contacts lie.
pub(super) struct Display<'a> {
    medium: Medium,
    /// The skin's frame, if none.
    pose: Option<&'a Pose>,
    tracker: Tracker,
    /// What waits for its fingers, if fingers are resolved.
    resolved: Option<Option<LinkFrame>>,
}

enum Medium {
    /// Pictures, drawn in place, and the contacts whose image is still to come.
    Terminal(Box<Live>, Box<Option<(FrameStamp, Contacts)>>),
    /// One line per contact.
    Lines,
}

impl<'a> Display<'a> {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted. Contacts
    /// are given in the frame of the link, if a skin's pose on one is known. Resolved fingers are lines always.
    pub(super) fn new(
        link: &mut Link,
        images: bool,
        pose: Option<&'a Pose>,
        is_resolved: bool,
    ) -> anyhow::Result<Self> {
        let medium = if is_resolved || !Screen::default().is_visible() {
            Medium::Lines
        } else {
            let surface = images.then(|| link.surface()).transpose()?;
            Medium::Terminal(Box::new(Live::new(surface.as_ref().map(Layout::from))), Box::default())
        };
        let tracker = Tracker::new(REACH, PATIENCE_US);
        Ok(Self { medium, pose, tracker, resolved: is_resolved.then_some(None) })
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(&self.medium, Medium::Terminal(live, _) if live.has_images())
    }

    /// Shows the contacts of a frame; keeps them where its image is still to come.
    pub(super) fn take_contacts(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        let contacts = self.pose.map_or_else(
            || contacts.clone(),
            |pose| contacts.iter().map(|contact| pose.contact(contact)).collect(),
        );
        if let (Medium::Lines, Some(pose)) = (&self.medium, self.pose) {
            self.tracker.update(at.timestamp_us, &contacts);
            return self.take_frame(LinkFrame::new(at, &pose.link, &contacts, &self.tracker));
        }
        match &mut self.medium {
            Medium::Terminal(live, waiting) if live.has_images() => {
                **waiting = Some((at, contacts));
                Ok(())
            }
            Medium::Terminal(live, _) => live.draw_if_due(at, &contacts),
            Medium::Lines => print_lines(at, &contacts),
        }
    }

    /// Prints a frame, or keeps it until its fingers come.
    fn take_frame(&mut self, frame: LinkFrame) -> io::Result<()> {
        match &mut self.resolved {
            // The fingers of the frame before never came.
            Some(waiting) => waiting.replace(frame).map_or(Ok(()), |late| late.print()),
            None => frame.print(),
        }
    }

    /// Says what is wrong with a frame, beside lines that somebody else reads; pictures say it themselves.
    pub(super) fn warn(&self, at: FrameStamp, what: &[&str]) {
        if matches!(self.medium, Medium::Lines) {
            eprintln!("warning: frame {} has flags not seen before: {}", at.sequence, what.join(", "));
        }
    }

    /// Whether a frame's fingers are still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.resolved.as_ref().is_some_and(Option::is_some)
    }

    /// Keeps the fingers of the frame whose contacts came before; `None` if they were not looked for.
    pub(super) fn keep_fingers(&mut self, at: FrameStamp, fingers: Option<&[Resolved]>) {
        let (Some(Some(frame)), Some(pose)) = (&mut self.resolved, self.pose) else { return };
        if frame.sequence == at.sequence {
            frame.fingers =
                fingers.map(|all| all.iter().map(|finger| LinkFinger::new(finger, pose)).collect());
        }
    }

    /// Prints the frame whose fingers have come.
    pub(super) fn print_resolved(&mut self) -> io::Result<()> {
        self.resolved.as_mut().and_then(Option::take).map_or(Ok(()), |frame| frame.print())
    }

    /// Draws an image with the contacts that came before it.
    pub(super) fn take_image(&mut self, image: &PackedImage) -> io::Result<()> {
        let Medium::Terminal(live, waiting) = &mut self.medium else { return Ok(()) };
        live.keep_image(image.values().collect());
        waiting.take().map_or(Ok(()), |(at, contacts)| live.draw_if_due(at, &contacts))
    }
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

/// One frame in the link's frame, as robot software reads it.
#[derive(Serialize)]
struct LinkFrame {
    sequence: u32,
    time_s: f64,
    flags: Vec<&'static str>,
    link: String,
    contacts: Vec<LinkContact>,
    /// Only where fingers are resolved.
    #[serde(skip_serializing_if = "Option::is_none")]
    fingers: Option<Vec<LinkFinger>>,
}

#[derive(Serialize)]
struct LinkFinger {
    position_m: [f64; 3],
    strength: f64,
}

impl LinkFinger {
    fn new(finger: &Resolved, pose: &Pose) -> Self {
        let position = pose.link_from_skin * finger.position;
        Self { position_m: position.coords.into(), strength: finger.strength }
    }
}

#[derive(Serialize)]
struct LinkContact {
    /// Its number, the same from frame to frame.
    id: Option<u32>,
    position_m: [f32; 3],
    normal: [f32; 3],
    area_mm2: f32,
    strength: f32,
    pressure_kpa: Option<f32>,
    force_n: Option<f32>,
}

impl LinkFrame {
    /// Contacts in the frame of this link, with the numbers that a tracker has given them.
    fn new(at: FrameStamp, link: &str, contacts: &Contacts, tracker: &Tracker) -> Self {
        let contact = |contact| LinkContact::new(contact, tracker, at.timestamp_us);
        Self {
            sequence: at.sequence,
            time_s: seconds(at),
            flags: at.flags.words().collect(),
            link: link.to_owned(),
            contacts: contacts.iter().map(contact).collect(),
            fingers: None,
        }
    }

    fn print(&self) -> io::Result<()> {
        let mut out = io::stdout().lock();
        writeln!(out, "{}", serde_json::to_string(self)?)?;
        out.flush()
    }
}

impl LinkContact {
    fn new(contact: &Contact, tracker: &Tracker, now_us: u64) -> Self {
        let track = tracker.touching(now_us).find(|track| track.contact == *contact);
        Self {
            id: track.map(|track| track.id),
            position_m: contact.position,
            normal: contact.normal,
            area_mm2: contact.area * 1e6,
            strength: contact.strength,
            pressure_kpa: contact.pressure.map(|pressure| pressure * 1e-3),
            force_n: contact.force(),
        }
    }
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
