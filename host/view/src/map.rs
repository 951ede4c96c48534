//! Maps: figures known at places of a skin, each in a colour scale of its own.

use super::{
    colour::sequential,
    picture::{LARGE, Picture, SMALL, Tile, short},
};
use dermatome_geometry::mesh::{Mesh, triangle};
use embedded_graphics::{
    geometry::Point,
    text::{Alignment, Baseline},
};
use nalgebra::Point3;

/// One map of a sheet.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Lines above the map.
    pub caption: [String; 3],
    /// Name and unit, under the map.
    pub name: &'static str,
    /// Which of the sheet's sets of places.
    pub set: usize,
    /// Value at each place of that set; `None` is drawn grey.
    pub values: Vec<Option<f64>>,
    /// Whether colours begin at zero; else at the smallest value.
    pub from_zero: bool,
}

/// Places at which figures are known.
#[derive(Clone, Debug)]
pub struct Places {
    /// Where they are, m.
    pub points: Vec<Point3<f64>>,
    /// How far around each its figure is shown, m.
    pub reach: f64,
}

/// Maps of one skin.
#[derive(Clone, Debug)]
pub struct Sheet<'a> {
    /// Lines at the top; the first is the title.
    pub title: Vec<String>,
    /// The skin, seen from above.
    pub mesh: &'a Mesh,
    /// Centres of the electrodes, m.
    pub electrodes: &'a [[f64; 2]],
    /// Sets of places.
    pub places: Vec<Places>,
    /// Most maps in a row.
    pub columns: u32,
    /// The maps, row by row.
    pub panels: Vec<Panel>,
}

/// Side of a map.
const TILE: u32 = 208;
/// Round a map, for electrode numbers.
const MARGIN: u32 = 22;
const COLUMN: u32 = TILE + 2 * MARGIN;
const LINE: u32 = 15;
const TITLE: u32 = 44;
const CAPTION: u32 = 3 * LINE;
const BAR: u32 = 50;
const BAR_WIDTH: u32 = 160;
/// Between rows.
const GAP: u32 = 16;
const ROW: u32 = CAPTION + TILE + 2 * MARGIN + BAR + GAP;
/// A place without a value.
const NOTHING: [u8; 3] = [190, 190, 190];
/// Out of every place's reach.
const UNKNOWN: [u8; 3] = [238, 238, 238];

/// Draws the maps in rows. Every dot of the skin has the colour of the place that is closest to it.
#[must_use]
pub fn map_sheet(sheet: &Sheet<'_>) -> Picture {
    let rows = (sheet.panels.len() as u32).div_ceil(sheet.columns);
    let head = TITLE + LINE * (sheet.title.len() as u32).saturating_sub(1);
    let mut picture = Picture::new(sheet.columns * COLUMN, head + rows * ROW);
    for (line, text) in (0..).zip(&sheet.title) {
        let font = if line == 0 { LARGE } else { SMALL };
        let y = if line == 0 { 10 } else { (TITLE - LINE + LINE * line - 4) as i32 };
        let at = Point::new((sheet.columns * COLUMN / 2) as i32, y);
        picture.text(at, text, font, Alignment::Center, Baseline::Top);
    }
    let view = View::new(sheet.mesh);
    let nearest: Vec<_> = sheet.places.iter().map(|places| view.nearest(places)).collect();
    for (index, panel) in (0..).zip(&sheet.panels) {
        let x = (index % sheet.columns * COLUMN) as i32;
        let y = (head + index / sheet.columns * ROW) as i32;
        draw_panel(&mut picture, sheet, panel, &view, &nearest[panel.set], (x, y));
    }
    picture
}

fn draw_panel(
    picture: &mut Picture,
    sheet: &Sheet<'_>,
    panel: &Panel,
    view: &View,
    nearest: &[Dot],
    (x, y): (i32, i32),
) {
    let middle = x + (COLUMN / 2) as i32;
    for (line, text) in (0..).zip(&panel.caption) {
        let at = Point::new(middle, y + line * LINE as i32);
        picture.text(at, text, SMALL, Alignment::Center, Baseline::Top);
    }
    let scale = Scale::new(&panel.values, panel.from_zero);
    let colour = |place: usize| match panel.values.get(place).copied().flatten() {
        Some(value) => sequential(scale.share(value)),
        None => NOTHING,
    };
    let colours: Vec<_> = nearest
        .iter()
        .map(|dot| match *dot {
            Dot::Beside => None,
            Dot::Far => Some(UNKNOWN),
            Dot::Near(place) => Some(colour(place)),
        })
        .collect();
    let corner = (x + MARGIN as i32, y + (CAPTION + MARGIN) as i32);
    picture.dots(corner, TILE, &colours);
    let tile = Tile::square(corner, TILE, view.corner, view.side);
    picture.electrode_numbers(&tile, sheet.electrodes);
    let bar_at = (middle - BAR_WIDTH as i32 / 2, corner.1 + (TILE + MARGIN) as i32);
    picture.bar(bar_at, BAR_WIDTH, panel.name, &scale.labels(), sequential);
}

/// Values of the lightest and the darkest colour.
struct Scale {
    low: f64,
    high: f64,
    /// Whether there are values beyond the darkest colour.
    is_cut: bool,
}

impl Scale {
    /// Up to the largest value; or, where few values are far larger than all others, to the limit below
    /// which 95 in 100 lie.
    fn new(values: &[Option<f64>], from_zero: bool) -> Self {
        let mut values: Vec<f64> = values.iter().flatten().copied().collect();
        values.sort_by(f64::total_cmp);
        let largest = values.last().copied().unwrap_or(1.0);
        let usual = values.get(values.len() * 95 / 100).copied().unwrap_or(largest);
        let low = if from_zero { 0.0 } else { values.first().copied().unwrap_or(0.0) };
        let is_cut = largest - low > 1.5 * (usual - low) && usual > low;
        Self { low, high: if is_cut { usual } else { largest }, is_cut }
    }

    fn share(&self, value: f64) -> f64 {
        if self.high > self.low { (value - self.low) / (self.high - self.low) } else { 0.0 }
    }

    fn labels(&self) -> [String; 3] {
        let plain = |value: f64| short(value).trim_start_matches('+').to_owned();
        let high = if self.is_cut { format!(">{}", plain(self.high)) } else { plain(self.high) };
        [plain(self.low), plain(self.low.midpoint(self.high)), high]
    }
}

/// What a dot of a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dot {
    /// No skin.
    Beside,
    /// Skin far from all places.
    Far,
    /// Skin closest to this place.
    Near(usize),
}

/// A skin seen from above.
struct View {
    /// Upper left corner, m.
    corner: [f64; 2],
    /// Side of the square shown, m.
    side: f64,
    /// Point of the skin that each dot shows: `[row][column]`.
    points: Vec<Option<Point3<f64>>>,
}

impl View {
    fn new(mesh: &Mesh) -> Self {
        let along = |axis: usize| mesh.nodes.iter().map(move |node| node[axis]);
        let low = [0, 1].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
        let side = (high[0] - low[0]).max(high[1] - low[1]);
        let corner = [low[0].midpoint(high[0]) - side / 2.0, low[1].midpoint(high[1]) + side / 2.0];
        let mut view = Self { corner, side, points: vec![None; (TILE * TILE) as usize] };
        (0..mesh.elements.len()).for_each(|element| view.add(mesh.corners(element)));
        view
    }

    /// Position of a dot's middle, m.
    fn position(&self, row: usize, column: usize) -> [f64; 2] {
        let metres = |dots: usize| (dots as f64 + 0.5) * self.side / f64::from(TILE);
        [self.corner[0] + metres(column), self.corner[1] - metres(row)]
    }

    /// Shows a triangle in all dots whose middle it covers, unless another lies above it.
    fn add(&mut self, corners: [Point3<f64>; 3]) {
        let dots = |metres: f64| (metres / self.side * f64::from(TILE)).clamp(0.0, f64::from(TILE)) as usize;
        let columns = corners.map(|corner| dots(corner.x - self.corner[0]));
        let rows = corners.map(|corner| dots(self.corner[1] - corner.y));
        let last = TILE as usize - 1;
        let range = |of: [usize; 3]| of[0].min(of[1]).min(of[2])..=of[0].max(of[1]).max(of[2]).min(last);
        for row in range(rows) {
            for column in range(columns) {
                let Some(point) = triangle::point_above(corners, self.position(row, column)) else {
                    continue;
                };
                let shown = &mut self.points[row * TILE as usize + column];
                if shown.is_none_or(|shown| shown.z < point.z) {
                    *shown = Some(point);
                }
            }
        }
    }

    /// The closest of these places for each dot: `[row][column]`.
    fn nearest(&self, places: &Places) -> Vec<Dot> {
        let of_point = |point: &Point3<f64>| {
            let distances = places.points.iter().map(|place| (place - point).norm_squared()).enumerate();
            match distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((place, distance)) if distance <= places.reach.powi(2) => Dot::Near(place),
                _ => Dot::Far,
            }
        };
        self.points.iter().map(|point| point.as_ref().map_or(Dot::Beside, of_point)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares of two triangles, side by side; the right one has a lid at height 1 over its left half.
    fn mesh() -> Mesh {
        let nodes = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.5, 0.0, 1.0],
            [1.5, 1.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
        ];
        let elements = vec![[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [8, 6, 7], [8, 7, 9]];
        Mesh { nodes: nodes.map(Point3::from).to_vec(), elements, electrodes: Vec::new() }
    }

    #[test]
    fn a_view_shows_what_lies_on_top_and_nothing_beside_the_skin() {
        let view = View::new(&mesh());
        assert_eq!((view.side, view.corner), (2.0, [0.0, 1.5]));
        let at = |x: f64, y: f64| {
            let dot = |metres: f64| (metres / 2.0 * f64::from(TILE)) as usize;
            view.points[dot(1.5 - y) * TILE as usize + dot(x)]
        };
        assert_eq!(at(0.5, 0.5).unwrap().z, 0.0);
        assert_eq!(at(1.25, 0.5).unwrap().z, 1.0);
        assert_eq!(at(1.75, 0.5).unwrap().z, 0.0);
        assert_eq!(at(0.5, 1.3), None);
        let shown = view.points.iter().flatten().count() as f64;
        assert_eq!(shown, f64::from(TILE * TILE) / 2.0);
    }

    #[test]
    fn every_dot_takes_the_closest_place_within_reach() {
        let view = View::new(&mesh());
        let dots = |points: Vec<Point3<f64>>, reach: f64| view.nearest(&Places { points, reach });
        let count = |dots: &[Dot], wanted| dots.iter().filter(|&&dot| dot == wanted).count();
        let two = vec![Point3::new(0.5, 0.5, 0.0), Point3::new(1.5, 0.5, 0.0)];
        let wide = dots(two.clone(), 5.0);
        let half = view.points.iter().flatten().count() / 2;
        assert_eq!([Dot::Near(0), Dot::Near(1), Dot::Far].map(|dot| count(&wide, dot)), [half, half, 0]);
        let narrow = dots(two, 0.1);
        let circle = std::f64::consts::PI * 0.01 * f64::from(TILE * TILE) / 4.0;
        assert!((count(&narrow, Dot::Near(0)) as f64 / circle - 1.0).abs() < 0.05);
        assert_eq!(count(&dots(vec![], 1.0), Dot::Far), 2 * half);
    }

    #[test]
    fn a_scale_is_cut_where_few_values_are_far_out() {
        let mut values: Vec<_> = (0..100).map(|i| Some(f64::from(i))).collect();
        let scale = Scale::new(&values, false);
        assert_eq!((scale.low, scale.high, scale.is_cut), (0.0, 99.0, false));
        values.push(Some(1e4));
        values.push(None);
        let scale = Scale::new(&values, true);
        assert_eq!((scale.high, scale.is_cut), (95.0, true));
        assert_eq!(scale.labels(), ["0", "47.5", ">95.0"].map(String::from));
        assert_eq!(Scale::new(&[], true).labels(), ["0", "0.500", "1.00"].map(String::from));
        assert_eq!(Scale::new(&[Some(2.0)], false).share(2.0), 0.0);
    }
}
