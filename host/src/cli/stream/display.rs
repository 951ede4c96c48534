//! Display: frames on the terminal, or contacts as lines for a pipe.

use crate::{
    link::Link,
    view::terminal::{self, Ink, Screen},
};
use dermatome_shared::{
    contact::{Contact, Contacts},
    image::Geometry,
    protocol::{FrameStamp, PackedImage},
};
use std::{
    io::{self, Write},
    time::{Duration, Instant},
};

/// Shortest time between two pictures: terminals are slow, and so are eyes.
const REDRAW_INTERVAL: Duration = Duration::from_millis(40);
/// The scale follows the largest value at once and sinks by this factor a frame, so that a
/// released skin fades instead of turning into noise in full colour.
const SCALE_DECAY: f64 = 0.98;
/// Smallest full scale: a change of conductivity by 2 %.
const SCALE_FLOOR: f64 = 0.02;

/// Where frames go.
pub(super) enum Display {
    /// Pictures, drawn in place.
    Terminal(Box<Picture>),
    /// One line per contact.
    Lines,
}

/// What the terminal shows.
pub(super) struct Picture {
    screen: Screen,
    ink: Ink,
    /// `None` if no images are wanted.
    geometry: Option<Geometry>,
    values: Vec<f64>,
    scale: f64,
    drawn: Option<Instant>,
}

impl Display {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted.
    pub(super) fn new(link: &mut Link, images: bool) -> anyhow::Result<Self> {
        let screen = Screen::default();
        if !screen.is_visible() {
            return Ok(Self::Lines);
        }
        let geometry = images.then(|| link.geometry()).transpose()?;
        Ok(Self::Terminal(Box::new(Picture::new(screen, geometry))))
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(self, Self::Terminal(picture) if picture.geometry.is_some())
    }

    /// Keeps an image for the next picture.
    pub(super) fn keep_image(&mut self, image: &PackedImage) {
        let Self::Terminal(picture) = self else { return };
        picture.values = image.values().collect();
        let largest = picture.values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        picture.scale = largest.max(picture.scale * SCALE_DECAY).max(SCALE_FLOOR);
    }

    /// A frame is complete: shows its contacts, on a terminal with the image kept before.
    pub(super) fn show(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        match self {
            Self::Terminal(picture) => picture.draw_if_due(at, contacts),
            Self::Lines => print_lines(at, contacts),
        }
    }
}

impl Picture {
    fn new(screen: Screen, geometry: Option<Geometry>) -> Self {
        let ink = Ink::from_environment();
        Self { screen, ink, geometry, values: Vec::new(), scale: SCALE_FLOOR, drawn: None }
    }

    fn draw_if_due(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        if self.drawn.is_some_and(|drawn| drawn.elapsed() < REDRAW_INTERVAL) {
            return Ok(());
        }
        self.drawn = Some(Instant::now());
        let mut text = String::new();
        if let Some(geometry) = &self.geometry {
            text += &terminal::image(geometry, &self.values, self.scale, self.ink);
            text += &terminal::legend(self.scale, self.ink);
        }
        text += &format!("frame {}  {:.2} s\n", at.sequence, seconds(at));
        text += &terminal::contacts(contacts);
        self.screen.draw(&text)
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
