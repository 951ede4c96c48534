//! Live: images and contacts drawn in place on the terminal, as fast as eyes follow.

use super::{
    canvas::{self, Ink, Room, Scene},
    terminal::{self, Screen},
};
use dermatome_patch::layout::Layout;
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::FrameStamp,
};
use std::{
    io,
    time::{Duration, Instant},
};

/// Shortest time between two pictures: terminals are slow, and so are eyes.
const REDRAW_INTERVAL: Duration = Duration::from_millis(40);
/// Full colour, in thresholds of a contact in the image. Noise of the disc's worst pixel is a sixth of one at 60 dB, and one
/// and a half at 40.
const FULL: f64 = 5.0;
/// Contacts whose lines have room beside the image, whatever the terminal.
const FEW: usize = 3;

/// What the terminal shows; nothing where standard output is not one.
#[derive(Debug)]
pub struct Live {
    screen: Screen,
    ink: Ink,
    /// `None` if no images are wanted.
    skin: Option<Shown>,
    values: Vec<f64>,
    drawn: Option<Instant>,
}

/// What a picture of a skin needs beside its images.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Where the pixels lie.
    pub layout: Layout,
    /// Relative conductivity change that is a contact in the image.
    pub threshold: f64,
    /// Places of the electrodes in the skin's frame, m; empty if unknown.
    pub electrodes: Vec<[f64; 2]>,
}

impl Live {
    /// A view that draws images of this skin, or contacts only.
    #[must_use]
    pub fn new(skin: Option<Shown>) -> Self {
        let (screen, ink) = (Screen::default(), Ink::from_environment());
        Self { screen, ink, skin, values: Vec::new(), drawn: None }
    }

    /// Whether images are drawn.
    #[must_use]
    pub fn has_images(&self) -> bool {
        self.skin.is_some()
    }

    /// Keeps an image, `[pixel]`, for the next picture.
    pub fn keep_image(&mut self, values: Vec<f64>) {
        self.values = values;
    }

    /// Draws the last image and the contacts in it, unless the last picture is too recent. `told` is what is said of
    /// them, in the frame of whoever reads it, and `note` a line that stands before, or nothing.
    pub fn draw_if_due(
        &mut self,
        at: FrameStamp,
        contacts: &Contacts,
        told: &[Contact],
        note: &str,
    ) -> io::Result<()> {
        if self.drawn.is_some_and(|drawn| drawn.elapsed() < REDRAW_INTERVAL) {
            return Ok(());
        }
        self.drawn = Some(Instant::now());
        let text = self.text(at, contacts, told, note, self.screen.room());
        self.screen.draw(&text)
    }

    fn text(&self, at: FrameStamp, contacts: &Contacts, told: &[Contact], note: &str, room: Room) -> String {
        let warning = terminal::flags(at.flags);
        let mut words = format!("frame {}  {:.2} s  {warning}\n", at.sequence, at.timestamp_us as f64 * 1e-6);
        if !note.is_empty() {
            words += note;
            words.push('\n');
        }
        words += &terminal::contacts(told);
        let Some(skin) = &self.skin else { return words };
        let maximum = FULL * skin.threshold;
        // Room for some contacts is kept, so that the picture does not jump as they come.
        let rows = room.rows.saturating_sub(2 + usize::from(!note.is_empty()) + told.len().max(FEW));
        let places: Vec<_> = contacts.iter().map(|contact| above(contact.position)).collect();
        let scene = Scene {
            layout: &skin.layout,
            values: &self.values,
            maximum,
            contacts: &places,
            electrodes: &skin.electrodes,
        };
        canvas::draw(&scene, Room { rows, ..room }, self.ink)
            + &canvas::legend(maximum, skin.threshold, self.ink)
            + &words
    }
}

/// A place as it is seen from above.
fn above([x, y, _]: [f32; 3]) -> [f64; 2] {
    [x.into(), y.into()]
}
