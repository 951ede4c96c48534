//! Sheets: several images side by side in one picture.

use super::picture::{LARGE, Picture, SMALL};
use dermatome_patch::layout::Layout;
use embedded_graphics::{
    geometry::Point,
    text::{Alignment, Baseline},
};

/// One image of a sheet.
#[derive(Clone, Debug, Default)]
pub struct Panel<'a> {
    /// Lines above the image; what does not fit its width is cut.
    pub caption: Vec<String>,
    /// Relative conductivity change: `[pixel]`.
    pub values: &'a [f64],
    /// Value of full colour, if not the sheet's.
    pub maximum: Option<f64>,
    /// Centres of found contacts, m.
    pub found: Vec<[f64; 2]>,
    /// Where fingers truly were, m, with their radius, m (0: only a cross).
    pub truth: Vec<([f64; 2], f64)>,
}

/// What the colours of a sheet stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Line above the colour bar.
    pub name: &'static str,
    /// What a relative conductivity change of 1 is.
    pub unit: f64,
}

impl Scale {
    /// Relative conductivity change.
    pub const RELATIVE: Self = Self { name: "relative conductivity change", unit: 1.0 };

    /// Change of sheet conductivity in mS per square, of a sheet of this conductivity, S per square.
    #[must_use]
    pub fn millisiemens(sheet_conductivity: f64) -> Self {
        Self { name: "conductivity change, mS per square", unit: 1e3 * sheet_conductivity }
    }
}

/// Images of one skin.
#[derive(Clone, Debug)]
pub struct Sheet<'a> {
    /// Line at the top; what does not fit is cut.
    pub title: &'a str,
    /// Where the pixels lie.
    pub layout: &'a Layout,
    /// Electrodes in the grid's frame, m; may be empty.
    pub electrodes: &'a [[f64; 2]],
    /// What the colours stand for.
    pub scale: Scale,
    /// Most images in a row.
    pub columns: usize,
    /// The images, row by row.
    pub panels: Vec<Panel<'a>>,
}

/// Side of an image.
const TILE: u32 = 208;
/// Round an image, for electrode numbers.
const MARGIN: u32 = 22;
const COLUMN: u32 = TILE + 2 * MARGIN;
const LINE: u32 = 15;
const TITLE: u32 = 34;
const BAR: u32 = 58;
/// Between rows.
const GAP: u32 = 10;
/// Most images on a sheet.
pub const MOST_PANELS: usize = 50;

/// Lays out the panels in rows, all in one colour scale, which a bar at the bottom explains. More than
/// [`MOST_PANELS`] are left out.
#[must_use]
pub fn reconstruction_sheet(sheet: &Sheet<'_>) -> Picture {
    let panels = &sheet.panels[..sheet.panels.len().min(MOST_PANELS)];
    let columns = panels.len().min(sheet.columns).max(2);
    let caption_lines = panels.iter().map(|panel| panel.caption.len()).max().unwrap_or(0) as u32;
    let row_height = caption_lines * LINE + TILE + 2 * MARGIN + GAP;
    let rows = panels.len().div_ceil(columns) as u32;
    let width = columns as u32 * COLUMN;
    let mut picture = Picture::new(width, TITLE + rows * row_height + BAR);
    let title_at = Point::new(width as i32 / 2, 10);
    picture.text(title_at, &cut(sheet.title, width / 9), LARGE, Alignment::Center, Baseline::Top);
    let maximum = largest(panels);
    for (index, panel) in panels.iter().enumerate() {
        let x = (index % columns) as u32 * COLUMN;
        let y = TITLE + (index / columns) as u32 * row_height;
        draw_panel(&mut picture, sheet, panel, (x, y), caption_lines, maximum);
    }
    let bar_at = (width as i32 / 2 - 120, (TITLE + rows * row_height) as i32 + 2);
    picture.colour_bar(bar_at, 240, maximum * sheet.scale.unit, sheet.scale.name);
    picture
}

fn draw_panel(
    picture: &mut Picture,
    sheet: &Sheet<'_>,
    panel: &Panel<'_>,
    (x, y): (u32, u32),
    caption_lines: u32,
    maximum: f64,
) {
    for (line, text) in (0..).zip(&panel.caption) {
        let at = Point::new((x + COLUMN / 2) as i32, (y + line * LINE) as i32);
        picture.text(at, &cut(text, COLUMN / 7), SMALL, Alignment::Center, Baseline::Top);
    }
    let corner = ((x + MARGIN) as i32, (y + caption_lines * LINE + MARGIN) as i32);
    let tile = picture.image_tile(corner, TILE, sheet.layout, panel.values, panel.maximum.unwrap_or(maximum));
    picture.electrode_numbers(&tile, sheet.electrodes);
    for &position in &panel.found {
        picture.found(&tile, position);
    }
    for &(position, radius) in &panel.truth {
        if radius > 0.0 {
            picture.true_outline(&tile, position, radius);
        }
        picture.truth(&tile, position);
    }
}

/// Largest magnitude of all panels without a scale of their own.
fn largest(panels: &[Panel<'_>]) -> f64 {
    let shared = panels.iter().filter(|panel| panel.maximum.is_none());
    shared.flat_map(|panel| panel.values).fold(0.0, |largest, value| value.abs().max(largest))
}

/// At most `most` characters of a text.
fn cut(text: &str, most: u32) -> String {
    let most = most as usize;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(3)).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::image::{Geometry, PixelGrid, pixel_cells};

    fn disc(side: u8) -> Geometry {
        let pitch = 0.1 / f32::from(side);
        let grid = PixelGrid { columns: side, rows: side, pitch, left: -0.05, top: 0.05 };
        let mut mask = vec![0_u8; grid.mask_bytes()];
        for cell in 0..grid.cells() {
            let [x, y] = centre(&grid, cell);
            if x.hypot(y) < 0.05 {
                mask[cell / 8] |= 1 << (cell % 8);
            }
        }
        Geometry { grid, mask: mask.into_iter().collect() }
    }

    fn centre(grid: &PixelGrid, cell: usize) -> [f64; 2] {
        let side = usize::from(grid.columns);
        grid.position((cell % side) as f32 + 0.5, (cell / side) as f32 + 0.5).map(f64::from)
    }

    fn rim() -> Vec<[f64; 2]> {
        let angle = |k: u8| std::f64::consts::PI * (0.5 - f64::from(k) / 8.0);
        (0..16).map(|k| [0.05 * angle(k).cos(), 0.05 * angle(k).sin()]).collect()
    }

    /// A blob at x, y in m.
    fn blob(geometry: &Geometry, x: f64, y: f64, peak: f64) -> Vec<f64> {
        let distance = |cell| {
            let [cx, cy] = centre(&geometry.grid, cell);
            (cx - x).hypot(cy - y) / 0.012
        };
        pixel_cells(&geometry.mask).map(|cell| peak * (-distance(cell).powi(2)).exp()).collect()
    }

    fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
        let png = picture.encode().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgb).unwrap();
        let start = 3 * (y * info.width + x) as usize;
        [rgb[start], rgb[start + 1], rgb[start + 2]]
    }

    #[test]
    fn conductivity_up_is_red_at_its_place_and_down_blue() {
        let geometry = disc(32);
        let values = blob(&geometry, 0.02, 0.02, 1.0);
        let mut picture = Picture::new(300, 300);
        let tile = picture.image_tile((50, 50), 200, &Layout::from(&geometry), &values, 1.0);
        let place = tile.place([0.02, 0.02]);
        assert_eq!((place.x, place.y), (190, 110), "y is upwards");
        let [red, _, blue] = pixel(&picture, 190, 110);
        assert!(red > blue + 50);
        let down: Vec<_> = values.iter().map(|value| -value).collect();
        picture.image_tile((50, 50), 200, &Layout::from(&geometry), &down, 1.0);
        let [red, _, blue] = pixel(&picture, 190, 110);
        assert!(blue > red + 50);
        assert_eq!(pixel(&picture, 52, 52), [255; 3], "outside the disc");
    }

    /// Also writes the sheet where `DERMATOME_SHEET` says, to look at it.
    #[test]
    fn a_sheet_has_room_for_all_its_panels() {
        let geometry = disc(32);
        let layout = Layout::from(&geometry);
        let electrodes = rim();
        let images: Vec<_> = (0..7_u8)
            .map(|k| {
                blob(
                    &geometry,
                    0.03 * f64::from(k).cos(),
                    0.03 * f64::from(k).sin(),
                    [1.0, -0.6][usize::from(k % 2)],
                )
            })
            .collect();
        let panel = |k: usize| Panel {
            caption: vec![format!("frame {k}"), "peak +1.00 at (12.3, -4.5) mm".into()],
            values: &images[k],
            found: vec![[0.03 * (k as f64).cos(), 0.03 * (k as f64).sin()]],
            truth: vec![(
                [0.027 * (k as f64).cos(), 0.032 * (k as f64).sin()],
                if k > 2 { 0.006 } else { 0.0 },
            )],
            maximum: None,
        };
        let panels: Vec<_> = (0..images.len()).map(panel).collect();
        let (title, scale) = ("demo.npz:v", Scale::RELATIVE);
        let sheet = Sheet { title, layout: &layout, electrodes: &electrodes, scale, columns: 5, panels };
        let picture = reconstruction_sheet(&sheet);
        assert_eq!(picture.size(), (5 * COLUMN, TITLE + 2 * (2 * LINE + TILE + 2 * MARGIN + GAP) + BAR));
    }

    #[test]
    fn empty_and_crowded_sheets_are_drawn_too() {
        let layout = Layout::from(&disc(8));
        let title = "long ".repeat(100);
        let scale = Scale::RELATIVE;
        let sheet =
            |panels| Sheet { title: &title, layout: &layout, electrodes: &[], scale, columns: 5, panels };
        assert_eq!(reconstruction_sheet(&sheet(vec![])).size().0, 2 * COLUMN);
        let crowded = reconstruction_sheet(&sheet(vec![Panel::default(); 500]));
        assert!(crowded.size().1 < 16_384);
    }

    #[test]
    fn a_sheet_of_two_millisiemens_shows_half_the_relative_change_with_the_same_numbers() {
        let geometry = disc(16);
        let layout = Layout::from(&geometry);
        let drawn = |peak: f64, scale: Scale| {
            let values = blob(&geometry, 0.01, 0.0, peak);
            let panels = vec![Panel { values: &values, ..Panel::default() }];
            let sheet = Sheet { title: "", layout: &layout, electrodes: &[], scale, columns: 5, panels };
            reconstruction_sheet(&sheet).encode().unwrap()
        };
        let [one, two] = [1e-3, 2e-3].map(Scale::millisiemens);
        assert_eq!(drawn(0.4, one), drawn(0.2, two));
        assert_ne!(drawn(0.4, one), drawn(0.4, two), "the bar's numbers");
        assert_ne!(drawn(0.4, one), drawn(0.4, Scale::RELATIVE), "the bar's name");
    }
}
