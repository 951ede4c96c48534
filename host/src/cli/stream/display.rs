//! Display: frames on the terminal, or contacts as lines for a pipe.

use crate::{
    link::Link,
    view::{live::Live, terminal::Screen},
};
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::{FrameStamp, PackedImage},
};
use std::io::{self, Write};

/// Where frames go.
pub(super) enum Display {
    /// Pictures, drawn in place.
    Terminal(Box<Live>),
    /// One line per contact.
    Lines,
}

impl Display {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted.
    pub(super) fn new(link: &mut Link, images: bool) -> anyhow::Result<Self> {
        if !Screen::default().is_visible() {
            return Ok(Self::Lines);
        }
        let geometry = images.then(|| link.geometry()).transpose()?;
        Ok(Self::Terminal(Box::new(Live::new(geometry))))
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(self, Self::Terminal(live) if live.has_images())
    }

    /// Keeps an image for the next picture.
    pub(super) fn keep_image(&mut self, image: &PackedImage) {
        if let Self::Terminal(live) = self {
            live.keep_image(image.values().collect());
        }
    }

    /// A frame is complete: shows its contacts, on a terminal with the image kept before.
    pub(super) fn show(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        match self {
            Self::Terminal(live) => live.draw_if_due(at, contacts),
            Self::Lines => print_lines(at, contacts),
        }
    }
}

fn print_lines(at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for contact in contacts {
        writeln!(out, "{}", line(at, contact))?;
    }
    out.flush()
}

/// Sequence, time, x, y, area, strength.
fn line(at: FrameStamp, contact: &Contact) -> String {
    let [x, y] = contact.position.map(|metres| metres * 1e3);
    let (sequence, time, area) = (at.sequence, seconds(at), contact.area * 1e6);
    format!("{sequence}\t{time:.6}\t{x:.3}\t{y:.3}\t{area:.2}\t{:.6}", contact.strength)
}

fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    #[test]
    fn a_line_has_six_fields_in_seconds_and_millimetres() {
        let at = FrameStamp { sequence: 7, timestamp_us: 1_250_000, flags: FrameFlags::default() };
        let contact = Contact { position: [0.01, -0.002], area: 4e-6, strength: 0.5, peak: 1.0 };
        assert_eq!(line(at, &contact), "7\t1.250000\t10.000\t-2.000\t4.00\t0.500000");
    }
}
