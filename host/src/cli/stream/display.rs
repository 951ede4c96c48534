//! Display: frames on the terminal, or contacts as lines for a pipe.

use crate::{
    link::Link,
    view::{layout::Layout, live::Live, terminal::Screen},
};
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::{FrameStamp, PackedImage},
};
use std::io::{self, Write};

/// Where frames go.
pub(super) enum Display {
    /// Pictures, drawn in place, and the contacts whose image is still to come.
    Terminal(Box<Live>, Box<Option<(FrameStamp, Contacts)>>),
    /// One line per contact.
    Lines,
}

impl Display {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted.
    pub(super) fn new(link: &mut Link, images: bool) -> anyhow::Result<Self> {
        if !Screen::default().is_visible() {
            return Ok(Self::Lines);
        }
        let surface = images.then(|| link.surface()).transpose()?;
        Ok(Self::Terminal(Box::new(Live::new(surface.as_ref().map(Layout::from))), Box::default()))
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(self, Self::Terminal(live, _) if live.has_images())
    }

    /// Shows the contacts of a frame; keeps them where its image is still to come.
    pub(super) fn take_contacts(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        match self {
            Self::Terminal(live, waiting) if live.has_images() => {
                **waiting = Some((at, contacts.clone()));
                Ok(())
            }
            Self::Terminal(live, _) => live.draw_if_due(at, contacts),
            Self::Lines => print_lines(at, contacts),
        }
    }

    /// Draws an image with the contacts that came before it.
    pub(super) fn take_image(&mut self, image: &PackedImage) -> io::Result<()> {
        let Self::Terminal(live, waiting) = self else { return Ok(()) };
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

/// Sequence, time, x, y, z, area, strength; with a calibration also pressure and force.
fn line(at: FrameStamp, contact: &Contact) -> String {
    let [x, y, z] = contact.position.map(|metres| metres * 1e3);
    let (sequence, time, area) = (at.sequence, seconds(at), contact.area * 1e6);
    let line = format!("{sequence}\t{time:.6}\t{x:.3}\t{y:.3}\t{z:.3}\t{area:.2}\t{:.6}", contact.strength);
    match contact.pressure.zip(contact.force()) {
        Some((pressure, force)) => format!("{line}\t{:.4}\t{force:.5}", pressure * 1e-3),
        None => line,
    }
}

fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 * 1e-6
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
        };
        assert_eq!(line(at, &contact), "7\t1.250000\t10.000\t-2.000\t0.000\t4.00\t0.500000");
        let calibrated = Contact { pressure: Some(12.5e3), ..contact };
        assert!(line(at, &calibrated).ends_with("\t0.500000\t12.5000\t0.05000"));
    }
}
