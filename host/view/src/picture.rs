//! Pictures: images of the skin as PNG files.

use super::colour::diverging;
use dermatome_patch::layout::Layout;
use dermatome_shared::image::PixelGrid;
use embedded_graphics::{
    Pixel,
    geometry::{OriginDimensions, Point, Size},
    mono_font::{MonoFont, MonoTextStyle, ascii},
    pixelcolor::{Rgb888, RgbColor},
    prelude::{Dimensions, DrawTarget, Drawable, Primitive},
    primitives::{Circle, Line, Polyline, PrimitiveStyle, PrimitiveStyleBuilder, Rectangle, StrokeAlignment},
    text::{Alignment, Baseline, Text, TextStyleBuilder},
};
use std::convert::Infallible;

/// Colour of labels.
pub const INK: Rgb888 = Rgb888::new(40, 40, 40);
/// Colour of found contacts.
pub const FOUND: Rgb888 = Rgb888::new(0, 110, 60);
/// Cells outside the skin.
const OUTSIDE: Rgb888 = Rgb888::WHITE;
const RIM: Rgb888 = Rgb888::new(150, 150, 150);

/// Font of captions and numbers.
pub const SMALL: &MonoFont<'static> = &ascii::FONT_7X13;
/// Font of titles.
pub const LARGE: &MonoFont<'static> = &ascii::FONT_9X18_BOLD;

/// A canvas, white at first.
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    height: u32,
    /// Red, green, blue: `[row][column][3]`.
    rgb: Vec<u8>,
}

/// Where a tile shows the skin: turns positions in m into places in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    corner: Point,
    /// Picture pixels for a metre.
    scale: f64,
    grid: PixelGrid,
}

impl Picture {
    /// A white picture of this size in pixels; at most 16,384 each way.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width.clamp(1, 16_384), height.clamp(1, 16_384));
        Self { width, height, rgb: vec![255; 3 * width as usize * height as usize] }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Draws an image `[pixel]` into a square of `size` with its upper left corner at x, y. Full
    /// colour is reached at `maximum`.
    pub fn image_tile(
        &mut self,
        (x, y): (i32, i32),
        size: u32,
        layout: &Layout,
        values: &[f64],
        maximum: f64,
    ) -> Tile {
        let tile = Tile::new(Point::new(x, y), size, layout.grid);
        for cell in 0..layout.grid.cells() {
            let value = layout.pixel(cell).map(|pixel| values.get(pixel).copied().unwrap_or(f64::NAN));
            let colour = value.map_or(OUTSIDE, |value| rgb(diverging(value, maximum)));
            self.put(&tile.cell(cell).into_styled(PrimitiveStyle::with_fill(colour)));
        }
        self.outline(&tile, layout);
        tile
    }

    /// A grey line between pixels and the cells that are none.
    fn outline(&mut self, tile: &Tile, layout: &Layout) {
        let is_pixel = |cell: usize| layout.pixel(cell).is_some();
        let (columns, rows) = (usize::from(tile.grid.columns), usize::from(tile.grid.rows));
        let style = PrimitiveStyle::with_stroke(RIM, 1);
        for cell in (0..tile.grid.cells()).filter(|&cell| is_pixel(cell)) {
            let (column, row) = (cell % columns, cell / columns);
            let area = tile.cell(cell);
            let (near, far) = (area.top_left, area.top_left + area.size);
            let edges = [
                (row == 0 || !is_pixel(cell - columns), near, Point::new(far.x, near.y)),
                (row + 1 == rows || !is_pixel(cell + columns), Point::new(near.x, far.y), far),
                (column == 0 || !is_pixel(cell - 1), near, Point::new(near.x, far.y)),
                (column + 1 == columns || !is_pixel(cell + 1), Point::new(far.x, near.y), far),
            ];
            for (_, from, to) in edges.into_iter().filter(|(outside, ..)| *outside) {
                self.put(&Line::new(from, to).into_styled(style));
            }
        }
    }

    /// A circle round a found contact.
    pub fn found(&mut self, tile: &Tile, position: [f64; 2]) {
        let white = PrimitiveStyle::with_stroke(Rgb888::WHITE, 4);
        let green = PrimitiveStyle::with_stroke(FOUND, 2);
        for style in [white, green] {
            self.put(&Circle::with_center(tile.place(position), 15).into_styled(style));
        }
    }

    /// A cross where a finger truly was.
    pub fn truth(&mut self, tile: &Tile, position: [f64; 2]) {
        let centre = tile.place(position);
        for (colour, width, arm) in [(Rgb888::WHITE, 4, 6), (Rgb888::BLACK, 2, 5)] {
            let style = PrimitiveStyle::with_stroke(colour, width);
            for arm in [Point::new(arm, arm), Point::new(arm, -arm)] {
                self.put(&Line::new(centre - arm, centre + arm).into_styled(style));
            }
        }
    }

    /// The true outline of a round finger, radius in m.
    pub fn true_outline(&mut self, tile: &Tile, position: [f64; 2], radius: f64) {
        let diameter = (2.0 * radius * tile.scale).round().clamp(1.0, 1e4) as u32;
        let style = PrimitiveStyle::with_stroke(Rgb888::BLACK, 1);
        self.put(&Circle::with_center(tile.place(position), diameter).into_styled(style));
    }

    /// Electrode numbers, from 1, outside the rim: positions in m.
    pub fn electrode_numbers(&mut self, tile: &Tile, electrodes: &[[f64; 2]]) {
        let centre = tile.centre();
        for (number, electrode) in electrodes.iter().enumerate() {
            let place = tile.place(*electrode);
            let (x, y) = (f64::from(place.x - centre.x), f64::from(place.y - centre.y));
            let outwards = LABEL_DISTANCE / x.hypot(y).max(1.0);
            let label = place + Point::new((x * outwards).round() as i32, (y * outwards).round() as i32);
            self.put(&Circle::with_center(place, 5).into_styled(PrimitiveStyle::with_fill(INK)));
            self.text(
                label,
                &(number + 1).to_string(),
                &ascii::FONT_6X10,
                Alignment::Center,
                Baseline::Middle,
            );
        }
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[Point], colour: Rgb888, width: u32) {
        self.put(&Polyline::new(points).into_styled(PrimitiveStyle::with_stroke(colour, width)));
    }

    /// A filled rectangle between two corners, both included.
    pub fn rectangle(&mut self, one: Point, other: Point, colour: Rgb888) {
        self.put(&Rectangle::with_corners(one, other).into_styled(PrimitiveStyle::with_fill(colour)));
    }

    /// A label; `at` is where its alignment and baseline say.
    pub fn text(
        &mut self,
        at: Point,
        text: &str,
        font: &MonoFont<'_>,
        alignment: Alignment,
        baseline: Baseline,
    ) {
        let style = TextStyleBuilder::new().alignment(alignment).baseline(baseline).build();
        self.put(&Text::with_text_style(text, at, MonoTextStyle::new(font, INK), style));
    }

    /// Fills the dots of a square of `size` that have a colour: `colours` is `[row][column]`.
    pub fn dots(&mut self, (x, y): (i32, i32), size: u32, colours: &[Option<[u8; 3]>]) {
        for (index, colour) in (0..).zip(colours) {
            if let Some(colour) = colour {
                let at = Point::new(x + index % size as i32, y + index / size as i32);
                self.put(&Pixel(at, rgb(*colour)));
            }
        }
    }

    /// A horizontal bar of colours from `-maximum` to `maximum`, with its range below and `name` above.
    pub fn colour_bar(&mut self, at: (i32, i32), width: u32, maximum: f64, name: &str) {
        let labels = [-maximum, 0.0, maximum].map(short);
        self.bar(at, width, name, &labels, |share| diverging(2.0 * share - 1.0, 1.0));
    }

    /// A horizontal bar of the colours of 0 to 1, with `name` above and labels at its ends and middle.
    pub fn bar(
        &mut self,
        (x, y): (i32, i32),
        width: u32,
        name: &str,
        labels: &[String; 3],
        colour: impl Fn(f64) -> [u8; 3],
    ) {
        const HEIGHT: u32 = 12;
        let middle = x + width as i32 / 2;
        self.text(Point::new(middle, y), name, SMALL, Alignment::Center, Baseline::Top);
        let top = y + 16;
        for column in 0..width as i32 {
            let share = f64::from(column) / f64::from(width.max(2) - 1);
            let line = Rectangle::new(Point::new(x + column, top), Size::new(1, HEIGHT));
            self.put(&line.into_styled(PrimitiveStyle::with_fill(rgb(colour(share)))));
        }
        let frame = PrimitiveStyleBuilder::new().stroke_color(RIM).stroke_width(1);
        let frame = frame.stroke_alignment(StrokeAlignment::Outside).build();
        self.put(&Rectangle::new(Point::new(x, top), Size::new(width, HEIGHT)).into_styled(frame));
        for (share, label) in (0..).zip(labels) {
            let at = Point::new(x + share * width as i32 / 2, top + HEIGHT as i32 + 4);
            self.text(at, label, SMALL, Alignment::Center, Baseline::Top);
        }
    }

    /// The picture as a PNG file.
    pub fn encode(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        Ok(bytes)
    }

    /// Draws what cannot fail on this canvas.
    fn put(&mut self, item: &impl Drawable<Color = Rgb888>) {
        let _ = item.draw(self);
    }
}

/// From the electrode to the middle of its number, pixels.
const LABEL_DISTANCE: f64 = 12.0;

/// Three digits, with an exponent only where a plain number is unreadable.
pub(super) fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if !(1e-3..1e4).contains(&size) => format!("{value:+.1e}"),
        size => format!("{value:+.*}", (2 - size.log10().floor() as i32).max(0) as usize),
    }
}

fn rgb([red, green, blue]: [u8; 3]) -> Rgb888 {
    Rgb888::new(red, green, blue)
}

impl Tile {
    /// A square of `size` that shows the square of `side`, m, whose upper left corner is at left, top, m.
    #[must_use]
    pub fn square((x, y): (i32, i32), size: u32, [left, top]: [f64; 2], side: f64) -> Self {
        let grid = PixelGrid { columns: 1, rows: 1, pitch: side as f32, left: left as f32, top: top as f32 };
        Self::new(Point::new(x, y), size, grid)
    }

    fn new(corner: Point, size: u32, grid: PixelGrid) -> Self {
        let side = f64::from(grid.columns.max(grid.rows).max(1)) * f64::from(grid.pitch);
        Self { corner, scale: f64::from(size) / side, grid }
    }

    /// Place of a position in m.
    #[must_use]
    pub fn place(&self, [x, y]: [f64; 2]) -> Point {
        let pixels = |metres: f64| (metres * self.scale).round() as i32;
        let (right, down) = (x - f64::from(self.grid.left), f64::from(self.grid.top) - y);
        self.corner + Point::new(pixels(right), pixels(down))
    }

    fn centre(&self) -> Point {
        let (columns, rows) = (f32::from(self.grid.columns), f32::from(self.grid.rows));
        self.place(self.grid.position(columns / 2.0, rows / 2.0).map(f64::from))
    }

    fn cell(&self, cell: usize) -> Rectangle {
        let columns = usize::from(self.grid.columns);
        let (column, row) = (cell % columns, cell / columns);
        let edge = |index: usize| (index as f64 * f64::from(self.grid.pitch) * self.scale).round() as i32;
        let near = Point::new(edge(column), edge(row));
        let far = Point::new(edge(column + 1), edge(row + 1));
        let size = Size::new((far.x - near.x) as u32, (far.y - near.y) as u32);
        Rectangle::new(self.corner + near, size)
    }
}

impl OriginDimensions for Picture {
    fn size(&self) -> Size {
        Size::new(self.width, self.height)
    }
}

impl DrawTarget for Picture {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let area = self.bounding_box();
        for Pixel(place, colour) in pixels.into_iter().filter(|Pixel(place, _)| area.contains(*place)) {
            let start = 3 * (place.y as usize * self.width as usize + place.x as usize);
            self.rgb[start..start + 3].copy_from_slice(&[colour.r(), colour.g(), colour.b()]);
        }
        Ok(())
    }
}
