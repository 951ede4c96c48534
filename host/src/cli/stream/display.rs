//! Display: frames on the terminal, or contacts as lines for a pipe.

use crate::{
    link::Link,
    resolve::Resolved,
    skin::Pose,
    view::{layout::Layout, live::Live, terminal::Screen},
};
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::{FrameStamp, PackedImage},
};
use serde::Serialize;
use std::io::{self, Write};

/// Where frames go, and in whose frame their contacts lie.
pub(super) struct Display<'a> {
    medium: Medium,
    /// The skin's frame, if none.
    pose: Option<&'a Pose>,
    /// What waits for its fingers, if fingers are resolved.
    resolved: Option<Waiting>,
}

/// A frame whose fingers are still to come.
#[derive(Default)]
struct Waiting {
    contacts: Option<(FrameStamp, Contacts)>,
    fingers: Option<Vec<LinkFinger>>,
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
        let resolved = is_resolved.then(Waiting::default);
        if is_resolved || !Screen::default().is_visible() {
            return Ok(Self { medium: Medium::Lines, pose, resolved });
        }
        let surface = images.then(|| link.surface()).transpose()?;
        let live = Box::new(Live::new(surface.as_ref().map(Layout::from)));
        Ok(Self { medium: Medium::Terminal(live, Box::default()), pose, resolved })
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
        if let Some(waiting) = &mut self.resolved {
            // The fingers of the frame before never came.
            let late = std::mem::take(waiting);
            waiting.contacts = Some((at, contacts));
            return late.print(self.pose);
        }
        match (&mut self.medium, self.pose) {
            (Medium::Terminal(live, waiting), _) if live.has_images() => {
                **waiting = Some((at, contacts));
                Ok(())
            }
            (Medium::Terminal(live, _), _) => live.draw_if_due(at, &contacts),
            (Medium::Lines, Some(pose)) => print_json(at, &pose.link, &contacts, None),
            (Medium::Lines, None) => print_lines(at, &contacts),
        }
    }

    /// Whether a frame's fingers are still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.resolved.as_ref().is_some_and(|waiting| waiting.contacts.is_some())
    }

    /// Keeps the fingers of the frame whose contacts came before; `None` if they were not looked for.
    pub(super) fn keep_fingers(&mut self, at: FrameStamp, fingers: Option<&[Resolved]>) {
        let (Some(waiting), Some(pose)) = (&mut self.resolved, self.pose) else { return };
        if waiting.contacts.as_ref().is_some_and(|(of, _)| of.sequence == at.sequence) {
            waiting.fingers =
                fingers.map(|all| all.iter().map(|finger| LinkFinger::new(finger, pose)).collect());
        }
    }

    /// Prints the frame whose fingers have come.
    pub(super) fn print_resolved(&mut self) -> io::Result<()> {
        self.resolved.as_mut().map_or(Ok(()), |waiting| std::mem::take(waiting).print(self.pose))
    }

    /// Draws an image with the contacts that came before it.
    pub(super) fn take_image(&mut self, image: &PackedImage) -> io::Result<()> {
        let Medium::Terminal(live, waiting) = &mut self.medium else { return Ok(()) };
        live.keep_image(image.values().collect());
        waiting.take().map_or(Ok(()), |(at, contacts)| live.draw_if_due(at, &contacts))
    }
}

impl Waiting {
    fn print(self, pose: Option<&Pose>) -> io::Result<()> {
        let Some(((at, contacts), pose)) = self.contacts.zip(pose) else { return Ok(()) };
        print_json(at, &pose.link, &contacts, self.fingers)
    }
}

fn print_lines(at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for contact in contacts {
        writeln!(out, "{}", line(at, contact))?;
    }
    out.flush()
}

/// Sequence, time, x, y, z, area, strength; with a calibration also pressure, and force or an empty field.
fn line(at: FrameStamp, contact: &Contact) -> String {
    let [x, y, z] = contact.position.map(|metres| metres * 1e3);
    let (sequence, time, area) = (at.sequence, seconds(at), contact.area * 1e6);
    let line = format!("{sequence}\t{time:.6}\t{x:.3}\t{y:.3}\t{z:.3}\t{area:.2}\t{:.6}", contact.strength);
    let force = contact.force().map_or(String::new(), |force| format!("{force:.5}"));
    match contact.pressure {
        Some(pressure) => format!("{line}\t{:.4}\t{force}", pressure * 1e-3),
        None => line,
    }
}

/// One frame in the link's frame, as robot software reads it.
#[derive(Serialize)]
struct LinkFrame<'a> {
    sequence: u32,
    time_s: f64,
    link: &'a str,
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
    position_m: [f32; 3],
    normal: [f32; 3],
    area_mm2: f32,
    strength: f32,
    pressure_kpa: Option<f32>,
    force_n: Option<f32>,
}

impl From<&Contact> for LinkContact {
    fn from(contact: &Contact) -> Self {
        Self {
            position_m: contact.position,
            normal: contact.normal,
            area_mm2: contact.area * 1e6,
            strength: contact.strength,
            pressure_kpa: contact.pressure.map(|pressure| pressure * 1e-3),
            force_n: contact.force(),
        }
    }
}

fn print_json(
    at: FrameStamp,
    link: &str,
    contacts: &Contacts,
    fingers: Option<Vec<LinkFinger>>,
) -> io::Result<()> {
    let contacts = contacts.iter().map(LinkContact::from).collect();
    let frame = LinkFrame { sequence: at.sequence, time_s: seconds(at), link, contacts, fingers };
    let mut out = io::stdout().lock();
    writeln!(out, "{}", serde_json::to_string(&frame)?)?;
    out.flush()
}

fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    #[test]
    fn a_line_has_seven_fields_and_two_more_with_a_calibration() {
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
        assert_eq!(line(at, &contact), "7\t1.250000\t10.000\t-2.000\t0.000\t4.00\t0.500000");
        let calibrated = Contact { pressure: Some(12.5e3), ..contact };
        assert!(line(at, &calibrated).ends_with("\t0.500000\t12.5000\t"));
        let calibrated = Contact { load_area: Some(4e-6), ..calibrated };
        assert!(line(at, &calibrated).ends_with("\t0.500000\t12.5000\t0.05000"));
    }
}
