//! Surface: where the pixels of an image lie in space, and which of them are neighbours.
//!
//! Flat and curved skins are alike: each pixel has a centre, a normal and an area, and a list of the
//! pixels that touch it. A patch holds them as two tables, read in place:
//!
//! ```text
//! pixel       6  centre, i16 x, y, z in steps from the origin
//!             2  end of its list of neighbours, u16; it begins where the list before it ends
//!             3  normal, i8 x, y, z in units of 1/127
//!             1  area, u8 in units of its own
//! neighbours  2  each: number of a pixel, u16
//! ```
//!
//! On a flat skin with a grid a step is half the pitch, all areas are 1, and everything is exact. On a
//! curved one a step is a 32,767th of its farthest coordinate, areas are rounded to a 255th of the
//! largest, normals to 0.4 degrees.

use crate::limits::MAX_PIXELS;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Bytes of a pixel in a patch.
pub const PIXEL_BYTES: usize = 12;
/// Bytes of a neighbour in a patch.
pub const NEIGHBOUR_BYTES: usize = 2;
/// Most entries of all lists of neighbours: eight a pixel.
pub const MAX_NEIGHBOURS: usize = 8 * MAX_PIXELS;
/// What a component of a normal is divided by.
pub const NORMAL_UNIT: f32 = 127.0;

/// Ways from the pixels round an outermost one sum up to more than this share of their number times their root mean square;
/// along a straight border to 0.5, at a corner to 0.8.
const BALANCED: f32 = 0.25;
/// Squares of the lengths that normals of length 127 have when rounded, with room to spare.
const NORMAL_SQUARES: core::ops::RangeInclusive<i32> = 125 * 125..=129 * 129;

/// What the whole numbers of [`Pixel`] stand for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SurfaceScale {
    /// Where centres count from, m, in the skin's frame.
    pub origin: [f32; 3],
    /// One step of a centre, m.
    pub step: f32,
    /// One unit of area, m^2.
    pub area: f32,
}

/// One pixel as a patch holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// Centre, in steps from the origin.
    pub centre: [i16; 3],
    /// Where its list of neighbours ends in the table of all.
    pub neighbours_end: u16,
    /// Unit normal of the surface, times 127.
    pub normal: [i8; 3],
    /// Area, in units of [`SurfaceScale::area`]; not 0.
    pub area: u8,
}

impl Pixel {
    /// As a patch holds it.
    #[must_use]
    pub fn to_bytes(self) -> [u8; PIXEL_BYTES] {
        let [[x0, x1], [y0, y1], [z0, z1]] = self.centre.map(i16::to_le_bytes);
        let [e0, e1] = self.neighbours_end.to_le_bytes();
        let [u, v, w] = self.normal.map(|part| part as u8);
        [x0, x1, y0, y1, z0, z1, e0, e1, u, v, w, self.area]
    }

    /// From a patch.
    #[must_use]
    #[inline(always)]
    pub fn from_bytes(bytes: &[u8; PIXEL_BYTES]) -> Self {
        // By words, which a board loads at once.
        let word = |n: usize| u32::from_le_bytes([bytes[n], bytes[n + 1], bytes[n + 2], bytes[n + 3]]);
        let (x_y, z_end, normal_area) = (word(0), word(4), word(8));
        let [u, v, w, area] = normal_area.to_le_bytes();
        Self {
            centre: [x_y as i16, (x_y >> 16) as i16, z_end as i16],
            neighbours_end: (z_end >> 16) as u16,
            normal: [u, v, w].map(|part| part as i8),
            area,
        }
    }
}

/// The two tables, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// What the tables' whole numbers stand for.
    pub scale: SurfaceScale,
    pixels: &'a [[u8; PIXEL_BYTES]],
    neighbours: &'a [[u8; NEIGHBOUR_BYTES]],
}

/// Why two tables are no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SurfaceError {
    /// A number of the scale is not finite, or a step or unit of area not above zero.
    Scale,
    /// A pixel without area or normal, or with a neighbour that does not exist; the number of pixels if
    /// entries are left over behind the last list.
    Pixel { pixel: usize },
}

impl<'a> Surface<'a> {
    /// Tables as a patch holds them; bytes beyond the last whole entry are left out.
    #[must_use]
    pub fn new(scale: SurfaceScale, pixels: &'a [u8], neighbours: &'a [u8]) -> Self {
        Self { scale, pixels: pixels.as_chunks().0, neighbours: neighbours.as_chunks().0 }
    }

    /// Number of pixels.
    #[must_use]
    pub fn count(&self) -> usize {
        self.pixels.len()
    }

    /// A pixel.
    #[must_use]
    pub fn pixel(&self, pixel: usize) -> Option<Pixel> {
        self.pixels.get(pixel).map(Pixel::from_bytes)
    }

    /// All pixels.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + use<'a> {
        self.pixels.iter().map(Pixel::from_bytes)
    }

    /// Numbers of the pixels that touch one.
    pub fn neighbours(&self, pixel: usize) -> impl Iterator<Item = usize> + use<'a> {
        let end = |pixel: usize| {
            self.pixels.get(pixel).map_or(0, |b| usize::from(u16::from_le_bytes([b[6], b[7]])))
        };
        let start = if pixel == 0 { 0 } else { end(pixel - 1) };
        let list = self.neighbours.get(start..end(pixel)).unwrap_or_default();
        list.iter().map(|bytes| usize::from(u16::from_le_bytes(*bytes)))
    }

    /// A place given in steps from the origin, m.
    #[must_use]
    pub fn place(&self, steps: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = self.scale.origin;
        let [u, v, w] = steps.map(|part| part * self.scale.step);
        [x + u, y + v, z + w]
    }

    /// Centre of a pixel, m.
    #[must_use]
    pub fn centre(&self, pixel: &Pixel) -> [f32; 3] {
        self.place(pixel.centre.map(f32::from))
    }

    /// Unit normal of a pixel.
    #[must_use]
    pub fn normal(&self, pixel: &Pixel) -> [f32; 3] {
        let normal = pixel.normal.map(|part| f32::from(part) / NORMAL_UNIT);
        // 1 / sqrt(s) near s = 1, which rounding has only just left.
        let square: f32 = normal.iter().map(|part| part * part).sum();
        normal.map(|part| part * (1.5 - square / 2.0))
    }

    /// Area of a pixel, m^2.
    #[must_use]
    pub fn area(&self, pixel: &Pixel) -> f32 {
        f32::from(pixel.area) * self.scale.area
    }

    /// A point near a pixel, m; where it is farther out than the centres of the outermost pixels, the nearest that is not.
    #[must_use]
    pub fn inside(&self, mut pixel: usize, point: [f32; 3]) -> [f32; 3] {
        let centre = |pixel| self.pixel(pixel).map(|pixel| self.centre(&pixel));
        let Some(mut here) = centre(pixel) else { return point };
        let mut least = square_distance(here, point);
        loop {
            let mut next = pixel;
            for (other, there) in self.neighbours(pixel).filter_map(|other| Some((other, centre(other)?))) {
                let away = square_distance(there, point);
                if away < least {
                    (next, here, least) = (other, there, away);
                }
            }
            if next == pixel {
                break;
            }
            pixel = next;
        }
        // Pixels round one inside balance.
        let (mut outward, mut squares, mut count) = ([0.0; 3], 0.0, 0.0);
        for other in self.neighbours(pixel).filter_map(centre) {
            outward.iter_mut().zip(minus(here, other)).for_each(|(sum, way)| *sum += way);
            squares += square_distance(here, other);
            count += 1.0;
        }
        let square = square_distance(outward, [0.0; 3]);
        let beyond: f32 = minus(point, here).iter().zip(outward).map(|(way, outward)| way * outward).sum();
        if square <= BALANCED * BALANCED * count * squares || beyond <= 0.0 {
            return point;
        }
        minus(point, outward.map(|part| part * beyond / square))
    }

    /// Whether everything is a number that makes sense and every list lies in its table.
    pub(crate) fn check(&self) -> Result<(), SurfaceError> {
        let SurfaceScale { origin, step, area } = self.scale;
        if !(origin.iter().all(|part| part.is_finite()) && is_positive(step) && is_positive(area)) {
            return Err(SurfaceError::Scale);
        }
        let mut start = 0;
        for (number, pixel) in self.pixels().enumerate() {
            let end = usize::from(pixel.neighbours_end);
            let list = self.neighbours.get(start..end);
            let in_range = |b: &[u8; 2]| usize::from(u16::from_le_bytes(*b)) < self.pixels.len();
            let square = pixel.normal.iter().map(|&part| i32::from(part).pow(2)).sum::<i32>();
            if !NORMAL_SQUARES.contains(&square)
                || pixel.area == 0
                || !list.is_some_and(|list| list.iter().all(in_range))
            {
                return Err(SurfaceError::Pixel { pixel: number });
            }
            start = end;
        }
        if start == self.neighbours.len() { Ok(()) } else { Err(SurfaceError::Pixel { pixel: self.count() }) }
    }
}

/// Square of a distance.
// Not inlined: it is called from many places of the board's code, and few contacts have it wait.
#[inline(never)]
pub(crate) fn square_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn is_positive(value: f32) -> bool {
    value.is_finite() && value > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;

    proptest! {
        #[test]
        fn a_pixel_comes_back_from_its_bytes(
            centre in any::<[i16; 3]>(),
            normal in any::<[i8; 3]>(),
            area in any::<u8>(),
            neighbours_end in any::<u16>(),
        ) {
            let pixel = Pixel { centre, neighbours_end, normal, area };
            prop_assert_eq!(Pixel::from_bytes(&pixel.to_bytes()), pixel);
        }

        #[test]
        fn no_tables_make_a_reader_panic(
            pixels in prop::collection::vec(any::<u8>(), 0..60),
            neighbours in prop::collection::vec(any::<u8>(), 0..20),
        ) {
            let scale = SurfaceScale { origin: [0.0; 3], step: 1.0, area: 1.0 };
            let surface = Surface::new(scale, &pixels, &neighbours);
            let _ = surface.check();
            for number in 0..surface.count() + 1 {
                let _ = surface.neighbours(number).count();
            }
        }
    }

    const COLUMNS: i16 = 8;

    /// A square of pixels of 10 mm, the first at the origin, in a plane or bent up along y.
    fn square(bend: fn(i16) -> i16) -> (vec::Vec<u8>, vec::Vec<u8>) {
        let (mut pixels, mut neighbours) = (vec![], vec![]);
        let all = || (0..COLUMNS).flat_map(|y| (0..COLUMNS).map(move |x| (x, y)));
        for (x, y) in all() {
            for (number, (u, v)) in (0_u16..).zip(all()) {
                if (u, v) != (x, y) && (u - x).abs() <= 1 && (v - y).abs() <= 1 {
                    neighbours.extend(number.to_le_bytes());
                }
            }
            let neighbours_end = (neighbours.len() / NEIGHBOUR_BYTES) as u16;
            let pixel = Pixel { centre: [x, y, bend(y)], neighbours_end, normal: [0, 0, 127], area: 1 };
            pixels.extend(pixel.to_bytes());
        }
        (pixels, neighbours)
    }

    const SCALE: SurfaceScale = SurfaceScale { origin: [0.0; 3], step: 0.01, area: 1e-4 };

    proptest! {
        #[test]
        fn points_of_the_skin_stay_and_others_come_to_its_outermost_pixels(
            from in 0..64_usize, x in -0.012..0.082_f32, y in -0.012..0.082_f32,
        ) {
            let (pixels, neighbours) = square(|_| 0);
            let surface = Surface::new(SCALE, &pixels, &neighbours);
            let [u, v, w] = surface.inside(from, [x, y, 0.0]);
            let clamped = [x, y].map(|part| part.clamp(0.0, 0.07));
            let is_corner = [x, y].iter().all(|part| !(0.005..=0.065).contains(part));
            // Beside the pixel at a corner it is the diagonal that they are held by.
            let most = if is_corner { 0.012 } else { 1e-6 };
            prop_assert!((u - clamped[0]).abs() < most && (v - clamped[1]).abs() < most && w == 0.0, "{u} {v}");
            prop_assert!((u - 0.035).abs() + (v - 0.035).abs() < 0.07 + 1e-6, "{u} {v}");
        }
    }

    #[test]
    fn a_point_beyond_the_border_of_a_bent_skin_comes_to_it_along_the_skin() {
        let (pixels, neighbours) = square(|y| y);
        let surface = Surface::new(SCALE, &pixels, &neighbours);
        for (given, expected) in
            [([0.03, 0.075, 0.075], [0.03, 0.07, 0.07]), ([0.034, 0.05, 0.05], [0.034, 0.05, 0.05])]
        {
            let found = surface.inside(9, given);
            assert!(square_distance(found, expected) < 1e-12, "{given:?}: {found:?}");
        }
    }
}
