//! Terminal: images and contacts as characters.
//!
//! A character cell is about twice as high as wide, so one line of text shows two rows of pixels:
//! with colours, "▀" has the upper pixel as its foreground and the lower one as its background.
//! Without colours, one letter stands for the larger of the two: `.` is zero, `:+*#@` go up and
//! `abcde` go down.

use super::colour::{diverging, share};
use console::{Term, truncate_str};
use dermatome_patch::layout::Layout;
use dermatome_shared::{contact::Contact, frame::FrameFlags};
use std::{fmt::Write, io};

/// How pixels become characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Half blocks in 24-bit colours.
    Colours,
    /// ASCII characters.
    Shades,
}

impl Ink {
    /// Colours, unless the environment variable `NO_COLOR` is set and not empty.
    #[must_use]
    pub fn from_environment() -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        if refused { Self::Shades } else { Self::Colours }
    }
}

/// Draws an image: `values` are `[pixel]`, relative conductivity; `maximum` is the value of full
/// colour. Cells outside the mask stay blank. Each line ends with a newline.
#[must_use]
pub fn image(layout: &Layout, values: &[f64], maximum: f64, ink: Ink) -> String {
    let cells = cell_values(layout, values);
    let columns = usize::from(layout.grid.columns).max(1);
    let rows: Vec<&[Option<f64>]> = cells.chunks(columns).collect();
    let mut text = String::new();
    for pair in rows.chunks(2) {
        for column in 0..columns {
            let upper = pair[0].get(column).copied().flatten();
            let lower = pair.get(1).and_then(|row| row.get(column).copied().flatten());
            match ink {
                Ink::Colours => push_half_blocks(&mut text, [upper, lower], maximum),
                Ink::Shades => text.push(shade(larger(upper, lower), maximum)),
            }
        }
        text.push('\n');
    }
    text
}

/// What full colour stands for, as one line.
#[must_use]
pub fn legend(maximum: f64, ink: Ink) -> String {
    match ink {
        Ink::Colours => format!("conductivity change: red +{maximum:.3}, white 0, blue -{maximum:.3}\n"),
        Ink::Shades => format!("conductivity change: @ +{maximum:.3}, . 0, e -{maximum:.3}\n"),
    }
}

/// What was wrong with a frame, in words; empty if nothing was.
#[must_use]
pub fn flags(flags: FrameFlags) -> String {
    flags.words().collect::<Vec<_>>().join(", ")
}

/// A line for each contact, with its height where the skin is curved there, and pressure and force where the skin is calibrated.
#[must_use]
pub fn contacts(contacts: &[Contact]) -> String {
    let mut text = String::new();
    for contact in contacts {
        let [x, y, z] = contact.position.map(|metres| metres * 1e3);
        let (area, strength) = (contact.area * 1e6, contact.strength);
        // Writing to a string never fails.
        let _ = write!(text, "x {x:7.1} mm  y {y:7.1} mm  ");
        if contact.normal != [0.0, 0.0, 1.0] {
            let _ = write!(text, "z {z:7.1} mm  ");
        }
        let _ = write!(text, "area {area:7.1} mm2  strength {strength:7.4}");
        if let Some(pressure) = contact.pressure {
            let _ = write!(text, "  {:7.2} kPa", pressure * 1e-3);
        }
        if let Some(force) = contact.force() {
            let _ = write!(text, "  {force:7.3} N");
        }
        text.push('\n');
    }
    if text.is_empty() { "no contact\n".to_owned() } else { text }
}

/// Value of each cell of the grid, `[row][column]`; `None` outside the mask.
fn cell_values(layout: &Layout, values: &[f64]) -> Vec<Option<f64>> {
    let value = |cell: usize| values.get(layout.pixel(cell)?).copied();
    (0..layout.grid.cells()).map(value).collect()
}

fn push_half_blocks(text: &mut String, pair: [Option<f64>; 2], maximum: f64) {
    let colours = pair.map(|value| value.map(|value| diverging(value, maximum)));
    // Writing to a string never fails.
    let _ = match colours {
        [None, None] => write!(text, " "),
        [Some([r, g, b]), None] => write!(text, "\x1b[38;2;{r};{g};{b}m▀\x1b[0m"),
        [None, Some([r, g, b])] => write!(text, "\x1b[38;2;{r};{g};{b}m▄\x1b[0m"),
        [Some([r, g, b]), Some([s, h, c])] => {
            write!(text, "\x1b[38;2;{r};{g};{b};48;2;{s};{h};{c}m▀\x1b[0m")
        }
    };
}

fn larger(upper: Option<f64>, lower: Option<f64>) -> Option<f64> {
    match (upper, lower) {
        (Some(a), Some(b)) => Some(if b.abs() > a.abs() { b } else { a }),
        (one, other) => one.or(other),
    }
}

fn shade(value: Option<f64>, maximum: f64) -> char {
    let Some(value) = value else { return ' ' };
    let part = share(value, maximum);
    let ramp = if part < 0.0 { b".abcde" } else { b".:+*#@" };
    ramp[(part.abs() * 5.0).round() as usize].into()
}

/// A part of the terminal that is drawn again and again in the same place.
///
/// Draws nothing where standard output is not a terminal.
#[derive(Debug)]
pub struct Screen {
    term: Term,
    lines: usize,
}

impl Default for Screen {
    fn default() -> Self {
        Self { term: Term::buffered_stdout(), lines: 0 }
    }
}

impl Screen {
    /// Whether drawing does anything.
    #[must_use]
    pub fn is_visible(&self) -> bool {
        self.term.is_term()
    }

    /// Replaces what was drawn before by `text`, as much of it as fits the terminal.
    pub fn draw(&mut self, text: &str) -> io::Result<()> {
        if !self.is_visible() {
            return Ok(());
        }
        let (rows, columns) = self.term.size();
        let lines = fitted(text, rows.into(), columns.into());
        self.term.clear_last_lines(self.lines)?;
        for line in &lines {
            self.term.write_line(line)?;
        }
        self.lines = lines.len();
        self.term.flush()
    }
}

/// Lines of `text` cut to a terminal of `rows` and `columns`; the last row is the cursor's.
fn fitted(text: &str, rows: usize, columns: usize) -> Vec<String> {
    let lines = text.lines().take(rows.saturating_sub(1).max(1));
    lines.map(|line| truncate_str(line, columns, "").into_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::image::{Geometry, PixelGrid};

    /// Three rows of two cells; the last row lacks its left cell.
    fn geometry() -> Layout {
        let grid = PixelGrid { columns: 2, rows: 3, pitch: 0.01, left: 0.0, top: 0.03 };
        Layout::from(&Geometry { grid, mask: [0b10_1111].into_iter().collect() })
    }

    const VALUES: [f64; 5] = [1.0, 0.0, 0.0, -1.0, 0.5];

    #[test]
    fn shades_show_the_larger_pixel_of_two_rows_and_blanks_outside_the_mask() {
        assert_eq!(image(&geometry(), &VALUES, 1.0, Ink::Shades), "@e\n *\n");
    }

    #[test]
    fn half_blocks_carry_the_upper_pixel_in_front_and_the_lower_behind() {
        let text = image(&geometry(), &VALUES, 1.0, Ink::Colours);
        let lines: Vec<_> = text.lines().collect();
        assert!(lines[0].starts_with("\x1b[38;2;178;24;43;48;2;255;255;255m▀\x1b[0m"), "{text:?}");
        assert!(lines[0].ends_with("\x1b[38;2;255;255;255;48;2;33;102;172m▀\x1b[0m"), "{text:?}");
        assert_eq!(lines[1], " \x1b[38;2;217;140;149m▀\x1b[0m");
        assert_eq!(console::measure_text_width(lines[0]), 2);
    }

    #[test]
    fn an_image_shorter_than_its_mask_leaves_cells_blank() {
        assert_eq!(image(&geometry(), &[1.0], 1.0, Ink::Shades), "@ \n  \n");
    }

    #[test]
    fn contacts_are_given_in_millimetres() {
        let contact = Contact {
            position: [0.0125, -0.03, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 2.5e-5,
            strength: 0.25,
            peak: 0.5,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        let text = contacts(&[contact]);
        assert_eq!(text, "x    12.5 mm  y   -30.0 mm  area    25.0 mm2  strength  0.2500\n");
        assert_eq!(contacts(&[]), "no contact\n");
        let calibrated = Contact { pressure: Some(20e3), load_area: Some(2e-5), ..contact };
        assert!(contacts(&[calibrated]).ends_with("  strength  0.2500    20.00 kPa    0.400 N\n"));
    }

    #[test]
    fn flags_are_given_in_words() {
        let mut set = FrameFlags::SATURATED;
        set.insert(FrameFlags::MASKED);
        assert_eq!(flags(set), "saturated, bad electrodes masked");
        assert_eq!(flags(FrameFlags::default()), "");
    }

    #[test]
    fn what_does_not_fit_the_terminal_is_cut() {
        let coloured = image(&geometry(), &VALUES, 1.0, Ink::Colours);
        let lines = fitted(&coloured, 2, 1);
        assert_eq!(lines.len(), 1);
        assert_eq!(console::measure_text_width(&lines[0]), 1);
    }
}
