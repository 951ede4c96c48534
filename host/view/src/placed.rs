//! Placed: where on a robot's link a skin lies, seen along the skin's normal.

use super::picture::{INK, LARGE, Picture, SMALL, Tile};
use dermatome_geometry::mesh::{ElectrodeContact, Mesh};
use embedded_graphics::{
    geometry::Point,
    text::{Alignment, Baseline},
};
use nalgebra::{Point3, Vector3};

/// A skin on its link, both in the skin's frame: x to the right, y up, z to the viewer; m.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// Lines at the top; the first is the title.
    pub title: &'a [String],
    /// Corners of the link's triangles.
    pub link: &'a [[Point3<f64>; 3]],
    /// The skin, with its electrodes.
    pub skin: &'a Mesh,
    /// How far the skin may lie beneath the link's triangles, m.
    pub beneath: f64,
}

/// Side of a view, dots.
const SIDE: u32 = 520;
/// Round a view, for the electrodes' numbers.
const MARGIN: u32 = 24;
const COLUMN: u32 = SIDE + 2 * MARGIN;
const LINE: u32 = 15;
const TITLE: u32 = 34;
/// Room beside what is shown, as a share of its size.
const BESIDE: f64 = 0.06;
/// Light from the viewer's upper left.
const LIGHT: [f64; 3] = [-0.35, 0.45, 0.82];
const LINK: [f64; 3] = [205.0, 205.0, 212.0];
const SKIN: [f64; 3] = [95.0, 175.0, 205.0];
/// Dots of an electrode's edge.
const EDGE: u32 = 4;

/// Draws the whole link, and the skin from near with its electrodes numbered.
#[must_use]
pub fn placed(scene: &Placed<'_>) -> Picture {
    let head = TITLE + LINE * (scene.title.len() as u32).saturating_sub(1);
    let mut picture = Picture::new(2 * COLUMN, head + COLUMN + LINE);
    for (line, text) in (0..).zip(scene.title) {
        let (font, y) =
            if line == 0 { (LARGE, 10) } else { (SMALL, (TITLE - LINE + LINE * line) as i32 - 4) };
        picture.text(Point::new(COLUMN as i32, y), text, font, Alignment::Center, Baseline::Top);
    }
    let whole = Window::around(scene.link.iter().flatten().chain(&scene.skin.nodes));
    let near = Window::around(scene.skin.nodes.iter());
    for (place, (window, words)) in (0..).zip([(whole, "the link"), (near, "the skin")]) {
        let corner = ((place * COLUMN + MARGIN) as i32, (head + MARGIN) as i32);
        window.draw(scene, &mut picture, corner, place == 1);
        let at = Point::new(corner.0 + SIDE as i32 / 2, corner.1 + (SIDE + MARGIN) as i32 - 4);
        let words = format!("{words}, in a square of {:.0} mm", window.side * 1e3);
        picture.text(at, &words, SMALL, Alignment::Center, Baseline::Top);
    }
    picture
}

/// What a view shows: a square, m.
#[derive(Clone, Copy, Debug)]
struct Window {
    left: f64,
    top: f64,
    side: f64,
}

/// Depth and colour of each dot: `[row][column]`.
struct Dots {
    depths: Vec<f64>,
    colours: Vec<Option<[u8; 3]>>,
}

impl Window {
    fn around<'a>(points: impl Iterator<Item = &'a Point3<f64>>) -> Self {
        let unbounded = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (low, high) = points.fold(unbounded, |(low, high), point| {
            let of =
                |bound: [f64; 2], by: fn(f64, f64) -> f64| [by(bound[0], point.x), by(bound[1], point.y)];
            (of(low, f64::min), of(high, f64::max))
        });
        let side = (high[0] - low[0]).max(high[1] - low[1]) * (1.0 + 2.0 * BESIDE);
        Self { left: low[0].midpoint(high[0]) - side / 2.0, top: low[1].midpoint(high[1]) + side / 2.0, side }
    }

    fn draw(&self, scene: &Placed<'_>, picture: &mut Picture, corner: (i32, i32), numbered: bool) {
        let count = (SIDE * SIDE) as usize;
        let mut dots = Dots { depths: vec![f64::NEG_INFINITY; count], colours: vec![None; count] };
        for corners in scene.link {
            self.add(&mut dots, corners, 0.0, LINK);
        }
        // The skin's triangles are others than the link's under them.
        let raised = scene.beneath + 0.01 * scene.skin_size();
        for element in 0..scene.skin.elements.len() {
            self.add(&mut dots, &scene.skin.corners(element), raised, SKIN);
        }
        picture.dots(corner, SIDE, &dots.colours);
        let tile = Tile::square(corner, SIDE, [self.left, self.top], self.side);
        let width = if numbered { EDGE } else { EDGE / 2 };
        for contact in &scene.skin.electrodes {
            for edge in edges(contact) {
                let ends =
                    edge.map(|node| scene.skin.nodes[node]).map(|point| tile.place([point.x, point.y]));
                picture.polyline(&ends, INK, width);
            }
        }
        let centres = scene.skin.electrodes.iter().map(|contact| scene.skin.centre(contact));
        let centres: Vec<[f64; 2]> = centres.map(|centre| [centre.x, centre.y]).collect();
        if numbered {
            picture.electrode_numbers(&tile, &centres);
        } else {
            // Where the numbers begin.
            picture.electrode_numbers(&tile, &centres[..centres.len().min(1)]);
        }
    }

    /// Shows a triangle where nothing lies above it.
    fn add(&self, dots: &mut Dots, corners: &[Point3<f64>; 3], raised: f64, colour: [f64; 3]) {
        let Some(normal) = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).try_normalize(0.0)
        else {
            return;
        };
        let light = 0.45 + 0.55 * normal.dot(&Vector3::from(LIGHT).normalize()).abs();
        let shaded = colour.map(|part| (part * light).round() as u8);
        let scale = f64::from(SIDE) / self.side;
        let [a, b, c] = corners.map(|it| [(it.x - self.left) * scale, (self.top - it.y) * scale, it.z]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0.0 {
            return;
        }
        for row in range(a[1], b[1], c[1]) {
            for column in range(a[0], b[0], c[0]) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let of_b = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
                let of_c = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
                // Neighbours both have their common edge.
                if of_b < -1e-9 || of_c < -1e-9 || of_b + of_c > 1.0 + 1e-9 {
                    continue;
                }
                let depth = a[2] + of_b * (b[2] - a[2]) + of_c * (c[2] - a[2]) + raised;
                let dot = row * SIDE as usize + column;
                if depth > dots.depths[dot] {
                    (dots.depths[dot], dots.colours[dot]) = (depth, Some(shaded));
                }
            }
        }
    }
}

/// Dots whose middle may lie between these, of those that there are.
fn range(a: f64, b: f64, c: f64) -> std::ops::Range<usize> {
    let within = |at: f64| at.clamp(0.0, f64::from(SIDE)) as usize;
    let last = a.max(b).max(c).ceil();
    within(a.min(b).min(c).floor())..within(last)
}

/// Edges of an electrode.
fn edges(contact: &ElectrodeContact) -> Vec<[usize; 2]> {
    match contact {
        ElectrodeContact::Node(_) => Vec::new(),
        ElectrodeContact::Edges(edges) => edges.clone(),
        ElectrodeContact::Faces(faces) => {
            faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect()
        }
    }
}

impl Placed<'_> {
    fn skin_size(&self) -> f64 {
        Window::around(self.skin.nodes.iter()).side
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(size: f64, z: f64) -> [[Point3<f64>; 3]; 2] {
        let at = |x: f64, y: f64| Point3::new(x * size, y * size, z);
        [[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0)], [at(-1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]]
    }

    fn skin() -> Mesh {
        let [[a, b, c], [.., d]] = square(0.5, 0.0);
        let electrodes = vec![ElectrodeContact::Edges(vec![[0, 1]]), ElectrodeContact::Edges(vec![[2, 3]])];
        Mesh { nodes: vec![a, b, c, d], elements: vec![[0, 1, 2], [0, 2, 3]], electrodes }
    }

    /// How many dots of the view of the link show it and the skin.
    fn shown(link: &[[Point3<f64>; 3]]) -> [usize; 2] {
        let skin = skin();
        let scene = Placed { title: &[], link, skin: &skin, beneath: 0.001 };
        let window = Window::around(link.iter().flatten());
        let count = (SIDE * SIDE) as usize;
        let mut dots = Dots { depths: vec![f64::NEG_INFINITY; count], colours: vec![None; count] };
        link.iter().for_each(|corners| window.add(&mut dots, corners, 0.0, LINK));
        let raised = scene.beneath + 0.01 * scene.skin_size();
        (0..2).for_each(|element| window.add(&mut dots, &skin.corners(element), raised, SKIN));
        let is =
            |wanted: fn([u8; 3]) -> bool| dots.colours.iter().flatten().filter(|it| wanted(**it)).count();
        [is(|[red, _, blue]| blue < red + 20), is(|[red, _, blue]| blue >= red + 20)]
    }

    #[test]
    fn a_skin_covers_the_link_beneath_it_and_is_covered_by_what_lies_above() {
        let dots = f64::from(SIDE * SIDE) / (1.0 + 2.0 * BESIDE).powi(2);
        let near = |found: usize, share: f64| (found as f64 / dots - share).abs() < 0.01;
        let [link, skin] = shown(&square(1.0, 0.0));
        assert!(near(link, 0.75) && near(skin, 0.25), "{link} {skin}");
        let lid = square(0.25, 0.2);
        let [link, skin] = shown(&[square(1.0, 0.0), lid].concat());
        assert!(near(link, 0.75 + 0.0625) && near(skin, 0.25 - 0.0625), "{link} {skin}");
    }

    #[test]
    fn a_picture_has_both_views_and_its_title() {
        let (link, skin) = (square(1.0, 0.0), skin());
        let title = ["palm".to_owned(), "on a link".to_owned()];
        let picture = placed(&Placed { title: &title, link: &link, skin: &skin, beneath: 0.0 });
        assert_eq!(picture.size(), (2 * COLUMN, TITLE + LINE + COLUMN + LINE));
        assert!(picture.encode().is_ok());
    }
}
