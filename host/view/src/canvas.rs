//! Canvas: an image as characters, as large as there is room for, with contacts and electrodes in it.
//!
//! A character cell is about twice as high as wide, so one line of text shows two dots, one above the other: with
//! colours, "▀" has the upper one as its foreground and the lower one as its background. Without colours, one letter
//! stands for the larger of the two: `.` is zero, `:+*#@` go up and `abcde` go down.

use super::colour::{diverging, share};
use dermatome_patch::layout::Layout;
use dermatome_shared::image::PixelGrid;
use std::fmt::Write;

/// Cells of the grid are drawn at most so many dots wide: more is slow to send and shows nothing new.
const LARGEST: f64 = 2.0;
/// Columns beside the image, and rows above and below it, for the numbers of electrodes.
const MARGIN: [usize; 2] = [3, 1];
/// How far beyond its electrode a number stands: columns and dots.
const BESIDE: [f64; 2] = [1.5, 1.0];
/// Colours of numbers on and beside the image.
const BLACK: [u8; 3] = [0, 0, 0];
const WHITE: [u8; 3] = [255, 255, 255];

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

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Where the pixels lie.
    pub layout: &'a Layout,
    /// Relative conductivity change: `[pixel]`.
    pub values: &'a [f64],
    /// Value of full colour.
    pub maximum: f64,
    /// Places of contacts in the grid's frame, m: numbered from 1, the first nine.
    pub contacts: &'a [[f64; 2]],
    /// Places of the electrodes, m; may be empty.
    pub electrodes: &'a [[f64; 2]],
}

/// Characters that a drawing may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// In a line.
    pub columns: usize,
    /// Lines.
    pub rows: usize,
}

/// One character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cell {
    /// Values of the upper and the lower dot; none outside the skin.
    dots: [Option<f64>; 2],
    mark: Option<char>,
}

/// Draws the scene. Each line ends with a newline; without room there is none.
#[must_use]
pub fn draw(scene: &Scene<'_>, room: Room, ink: Ink) -> String {
    let Some(frame) = Frame::within(scene, room) else { return String::new() };
    let mut canvas = frame.canvas(scene);
    for (number, &place) in ('1'..='9').zip(scene.contacts) {
        frame.mark(&mut canvas, place, [0.0; 2], &number.to_string());
    }
    for (number, &place) in (1..).zip(scene.electrodes) {
        frame.mark(&mut canvas, place, BESIDE, &format!("{number}"));
    }
    canvas.iter().map(|line| line_of(line, scene.maximum, ink)).collect()
}

/// What full colour stands for, as one line: so many times the `threshold` of a contact in the image.
#[must_use]
pub fn legend(maximum: f64, threshold: f64, ink: Ink) -> String {
    let [up, down] = match ink {
        Ink::Colours => ["red", "blue"],
        Ink::Shades => ["@", "e"],
    };
    format!("{up} +{maximum:.2}, {down} -{maximum:.2} = {:.0} thresholds\n", maximum / threshold)
}

/// Where the image lies among the characters.
struct Frame {
    grid: PixelGrid,
    /// Dots for a cell of the grid.
    scale: f64,
    margin: [usize; 2],
    columns: usize,
    rows: usize,
}

impl Frame {
    fn within(scene: &Scene<'_>, room: Room) -> Option<Self> {
        let grid = scene.layout.grid;
        let margin = if scene.electrodes.is_empty() { [0, 0] } else { MARGIN };
        let columns = room.columns.checked_sub(2 * margin[0])?;
        let rows = room.rows.checked_sub(2 * margin[1])?;
        let cells = [grid.columns, grid.rows].map(|cells| f64::from(cells.max(1)));
        let scale = (columns as f64 / cells[0]).min(2.0 * rows as f64 / cells[1]).min(LARGEST);
        // Whole characters only; half a one is the last line of an odd number of rows.
        let [columns, dots] = cells.map(|cells| (cells * scale + 1e-9) as usize);
        let rows = dots.div_ceil(2).min(rows);
        (columns > 0 && rows > 0).then_some(Self { grid, scale, margin, columns, rows })
    }

    fn canvas(&self, scene: &Scene<'_>) -> Vec<Vec<Cell>> {
        let [beside, above] = self.margin;
        let mut canvas = vec![vec![Cell::default(); self.columns + 2 * beside]; self.rows + 2 * above];
        for (row, line) in canvas[above..above + self.rows].iter_mut().enumerate() {
            for (column, cell) in line[beside..beside + self.columns].iter_mut().enumerate() {
                cell.dots = [2 * row, 2 * row + 1].map(|dot| self.value(scene, column, dot));
            }
        }
        canvas
    }

    /// Value of a dot: that of the pixel under its middle.
    fn value(&self, scene: &Scene<'_>, column: usize, dot: usize) -> Option<f64> {
        let [x, y] = [column, dot].map(|at| ((at as f64 + 0.5) / self.scale) as usize);
        let (columns, rows) = (usize::from(self.grid.columns), usize::from(self.grid.rows));
        let pixel = (x < columns && y < rows).then(|| scene.layout.pixel(y * columns + x)).flatten()?;
        scene.values.get(pixel).copied()
    }

    /// Writes a mark at a place, moved so many columns and dots away from the middle of the grid.
    fn mark(&self, canvas: &mut [Vec<Cell>], [x, y]: [f64; 2], outwards: [f64; 2], mark: &str) {
        let grid = &self.grid;
        let pitch = f64::from(grid.pitch);
        let at = [(x - f64::from(grid.left)) / pitch, (f64::from(grid.top) - y) / pitch];
        let middle = [grid.columns, grid.rows].map(|cells| f64::from(cells) / 2.0);
        let away = [at[0] - middle[0], at[1] - middle[1]];
        let far = away[0].hypot(away[1]).max(1e-9);
        let [column, dot] = [0, 1].map(|i| at[i] * self.scale + away[i] / far * outwards[i]);
        let width = mark.chars().count();
        let column = (column + self.margin[0] as f64 - width as f64 / 2.0).round().max(0.0) as usize;
        let row = (dot / 2.0 + self.margin[1] as f64).floor().max(0.0) as usize;
        let Some(line) = canvas.get_mut(row) else { return };
        let column = column.min(line.len().saturating_sub(width));
        line[column..].iter_mut().zip(mark.chars()).for_each(|(cell, c)| cell.mark = Some(c));
    }
}

/// Colours of a character.
type Paint = [Option<[u8; 3]>; 2];

fn line_of(line: &[Cell], maximum: f64, ink: Ink) -> String {
    let end = line.iter().rposition(|cell| *cell != Cell::default()).map_or(0, |last| last + 1);
    let mut text = String::new();
    let mut before: Paint = [None; 2];
    for cell in &line[..end] {
        let (character, paint) = match ink {
            Ink::Shades => (cell.mark.unwrap_or_else(|| shade(larger(cell.dots), maximum)), [None; 2]),
            Ink::Colours => coloured(cell, maximum),
        };
        if paint != before {
            push_paint(&mut text, paint);
            before = paint;
        }
        text.push(character);
    }
    if before != [None; 2] {
        push_paint(&mut text, [None; 2]);
    }
    text.push('\n');
    text
}

/// Character of a cell, its colour and that behind it.
fn coloured(cell: &Cell, maximum: f64) -> (char, Paint) {
    let [upper, lower] = cell.dots.map(|value| value.map(|value| diverging(value, maximum)));
    match (cell.mark, upper, lower) {
        (Some(mark), None, None) => (mark, [None, None]),
        (Some(mark), upper, lower) => {
            let behind = upper.or(lower).unwrap_or(WHITE);
            (mark, [Some(if is_dark(behind) { WHITE } else { BLACK }), Some(behind)])
        }
        (None, None, None) => (' ', [None, None]),
        (None, Some(upper), lower) => ('▀', [Some(upper), lower]),
        (None, None, Some(lower)) => ('▄', [Some(lower), None]),
    }
}

fn is_dark(colour: [u8; 3]) -> bool {
    colour.iter().map(|part| u32::from(*part)).sum::<u32>() < 400
}

fn push_paint(text: &mut String, [front, behind]: Paint) {
    // Writing to a string never fails.
    let _ = text.write_str("\x1b[0m");
    if let Some([r, g, b]) = front {
        let _ = write!(text, "\x1b[38;2;{r};{g};{b}m");
    }
    if let Some([r, g, b]) = behind {
        let _ = write!(text, "\x1b[48;2;{r};{g};{b}m");
    }
}

fn larger([upper, lower]: [Option<f64>; 2]) -> Option<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::image::Geometry;

    /// Three rows of two cells; the last row lacks its left cell.
    fn layout() -> Layout {
        let grid = PixelGrid { columns: 2, rows: 3, pitch: 0.01, left: 0.0, top: 0.03 };
        Layout::from(&Geometry { grid, mask: [0b10_1111].into_iter().collect() })
    }

    const VALUES: [f64; 5] = [1.0, 0.0, 0.0, -1.0, 0.5];
    const SMALL: Room = Room { columns: 2, rows: 2 };

    fn scene<'a>(layout: &'a Layout, values: &'a [f64]) -> Scene<'a> {
        Scene { layout, values, maximum: 1.0, contacts: &[], electrodes: &[] }
    }

    #[test]
    fn shades_show_the_larger_dot_of_two_and_blanks_outside_the_skin() {
        let layout = layout();
        assert_eq!(draw(&scene(&layout, &VALUES), SMALL, Ink::Shades), "@e\n *\n");
        assert_eq!(draw(&scene(&layout, &[1.0]), SMALL, Ink::Shades), "@\n\n", "an image that is too short");
    }

    #[test]
    fn half_blocks_carry_the_upper_dot_in_front_and_the_lower_behind() {
        let layout = layout();
        let text = draw(&scene(&layout, &VALUES), SMALL, Ink::Colours);
        let lines: Vec<_> = text.lines().collect();
        assert!(lines[0].starts_with("\x1b[0m\x1b[38;2;178;24;43m\x1b[48;2;255;255;255m▀"), "{text:?}");
        assert!(lines[0].ends_with("\x1b[38;2;255;255;255m\x1b[48;2;33;102;172m▀\x1b[0m"), "{text:?}");
        assert_eq!(lines[1], " \x1b[0m\x1b[38;2;217;140;149m▀\x1b[0m");
        assert_eq!(console::measure_text_width(lines[0]), 2);
    }

    #[test]
    fn an_image_takes_the_room_there_is_up_to_twice_its_grid() {
        let layout = layout();
        let size = |columns, rows| {
            let text = draw(&scene(&layout, &[0.0; 5]), Room { columns, rows }, Ink::Shades);
            (text.lines().map(str::len).max().unwrap_or(0), text.lines().count())
        };
        assert_eq!(size(80, 40), (4, 3));
        assert_eq!(size(3, 40), (3, 2));
        assert_eq!(size(1, 1), (1, 1));
        assert_eq!((size(0, 9), size(9, 0)), ((0, 0), (0, 0)));
    }

    #[test]
    fn contacts_and_electrodes_are_numbered_where_they_are() {
        let grid = PixelGrid { columns: 8, rows: 8, pitch: 0.01, left: -0.04, top: 0.04 };
        let layout = Layout::from(&Geometry { grid, mask: [0xff; 8].into_iter().collect() });
        let scene = Scene {
            contacts: &[[0.015, 0.0], [-0.035, 0.035]],
            electrodes: &[[0.0, 0.04], [0.04, 0.0], [0.0, -0.04], [-0.04, 0.0]],
            ..scene(&layout, &[0.0; 64])
        };
        let text = draw(&scene, Room { columns: 14, rows: 6 }, Ink::Shades);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines,
            ["       1", "   2.......", "   ........", " 4 .....1.. 2", "   ........", "       3"]
        );
    }
}
