//! Terminal: what is drawn again and again in one place, and its words.

use super::canvas::Room;
use console::{Term, truncate_str};
use dermatome_shared::{contact::Contact, frame::FrameFlags};
use std::{fmt::Write, io};

/// What was wrong with a frame, in words; empty if nothing was.
#[must_use]
pub fn flags(flags: FrameFlags) -> String {
    flags.words().collect::<Vec<_>>().join(", ")
}

/// A line for each contact, by its number in the picture, what matters most first: place, height where the skin is
/// curved there, pressure and force where the skin is calibrated.
#[must_use]
pub fn contacts(contacts: &[Contact]) -> String {
    let mut text = String::new();
    for (number, contact) in (1..).zip(contacts) {
        let [x, y, z] = contact.position.map(|metres| metres * 1e3);
        let (area, strength) = (contact.area * 1e6, contact.strength);
        // Writing to a string never fails.
        let _ = write!(text, "{number} x {x:6.1} y {y:6.1} ");
        if contact.normal != [0.0, 0.0, 1.0] {
            let _ = write!(text, "z {z:6.1} ");
        }
        text += "mm";
        if let Some(pressure) = contact.pressure {
            let _ = write!(text, "  {:7.2} kPa", pressure * 1e-3);
        }
        if let Some(force) = contact.force() {
            let _ = write!(text, "  {force:7.3} N");
        }
        let _ = writeln!(text, "  strength {strength:7.4}  area {area:7.1} mm2");
    }
    if text.is_empty() { "no contact\n".to_owned() } else { text }
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

    /// Characters that can be drawn: a row less than the terminal has, for its cursor.
    #[must_use]
    pub fn room(&self) -> Room {
        let (rows, columns) = self.term.size();
        Room { columns: columns.into(), rows: usize::from(rows).saturating_sub(1) }
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
        assert_eq!(text, "1 x   12.5 y  -30.0 mm  strength  0.2500  area    25.0 mm2\n");
        assert_eq!(contacts(&[]), "no contact\n");
        let calibrated = Contact { pressure: Some(20e3), load_area: Some(2e-5), ..contact };
        let text = contacts(&[contact, calibrated]);
        // In 40 columns place and force are still there.
        assert!(text.contains("\n2 x   12.5 y  -30.0 mm    20.00 kPa    0.400 N  strength"), "{text}");
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
        let lines = fitted("\x1b[38;2;1;2;3m▀▀▀\x1b[0m\nmore\n", 2, 1);
        assert_eq!(lines.len(), 1);
        assert_eq!(console::measure_text_width(&lines[0]), 1);
    }
}
