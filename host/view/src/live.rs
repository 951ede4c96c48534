//! Live: images and contacts drawn in place on the terminal, as fast as eyes follow.

use super::terminal::{self, Ink, Screen};
use dermatome_patch::layout::Layout;
use dermatome_shared::{contact::Contacts, protocol::FrameStamp};
use std::{
    io,
    time::{Duration, Instant},
};

/// Shortest time between two pictures: terminals are slow, and so are eyes.
const REDRAW_INTERVAL: Duration = Duration::from_millis(40);
/// The scale follows the largest value at once and sinks by this factor a frame, so that a
/// released skin fades instead of turning into noise in full colour.
const SCALE_DECAY: f64 = 0.98;
/// Smallest full scale: a change of conductivity by 2 %.
const SCALE_FLOOR: f64 = 0.02;

/// What the terminal shows; nothing where standard output is not one.
#[derive(Debug)]
pub struct Live {
    screen: Screen,
    ink: Ink,
    /// `None` if no images are wanted.
    layout: Option<Layout>,
    values: Vec<f64>,
    scale: f64,
    drawn: Option<Instant>,
}

impl Live {
    /// A view that draws images of this layout, or contacts only.
    #[must_use]
    pub fn new(layout: Option<Layout>) -> Self {
        let (screen, ink) = (Screen::default(), Ink::from_environment());
        Self { screen, ink, layout, values: Vec::new(), scale: SCALE_FLOOR, drawn: None }
    }

    /// Whether images are drawn.
    #[must_use]
    pub fn has_images(&self) -> bool {
        self.layout.is_some()
    }

    /// Keeps an image, `[pixel]`, for the next picture.
    pub fn keep_image(&mut self, values: Vec<f64>) {
        self.values = values;
        let largest = self.values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        self.scale = largest.max(self.scale * SCALE_DECAY).max(SCALE_FLOOR);
    }

    /// Draws the last image and these contacts, unless the last picture is too recent.
    pub fn draw_if_due(&mut self, at: FrameStamp, contacts: &Contacts) -> io::Result<()> {
        if self.drawn.is_some_and(|drawn| drawn.elapsed() < REDRAW_INTERVAL) {
            return Ok(());
        }
        self.drawn = Some(Instant::now());
        let mut text = String::new();
        if let Some(layout) = &self.layout {
            text += &terminal::image(layout, &self.values, self.scale, self.ink);
            text += &terminal::legend(self.scale, self.ink);
        }
        let warning = terminal::flags(at.flags);
        text += &format!("frame {}  {:.2} s  {warning}\n", at.sequence, at.timestamp_us as f64 * 1e-6);
        text += &terminal::contacts(contacts);
        self.screen.draw(&text)
    }
}
