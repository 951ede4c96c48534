//! Spots: places with the way the response changes round them.

use crate::{
    image::surface::{Surface, square_distance},
    patch::{
        matrix::GROUP,
        places::{PLACE_NEIGHBOURS, PLACE_ROWS, Places, SHARE_UNIT},
    },
    pipeline::reference::power_of_two,
};
use heapless::Vec;

/// Unknowns of a press: its strength, and strength times offset along two axes.
pub(super) const UNKNOWNS: usize = 3;
/// Spots lie this far from each other, distances to the next places; their shares follow in whole numbers.
const STEP: f32 = 0.5;
/// A press goes to another spot of its place once it is so far from its own along an axis, distances to the next places.
const STAYS: f32 = 0.35;
/// Farthest that a press goes from its place, distances to the next places.
const FARTHEST: f32 = 1.0;
/// Ways to the places round one at the skin's border sum up to more than this, their mean length being 1.
const ONE_SIDED: f32 = 1.2;
/// A solution that has one so far from its place is none, distances to the next places.
const FAR_OUT: f32 = 8.0;

/// A place, or one of eight points round it, and how the response changes there: round it the response is taken to change
/// linearly with where the press is, as the patch has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spot {
    place: usize,
    /// How far from the place along each axis, [`STEP`]s: -1 to 1.
    steps: [i8; 2],
    /// The place's centre, m.
    centre: [f32; 3],
    axes: [[f32; 3]; 2],
    /// Mean distance of the places round the place, m; slopes are for each of it.
    pub(super) spacing: f32,
    /// Whether the places round it lie on one side, as at the skin's border.
    is_at_border: bool,
    /// Whether presses need not stay on the place.
    is_free: bool,
}

/// By row that it is made of: a place's own, and those of the places round it.
type OfRows<T> = Vec<T, PLACE_ROWS>;

impl Spot {
    /// For a press that stays on a place.
    pub(super) fn fixed(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> Self {
        Self { place, centre: at(surface, places, place).0, ..Self::default() }
    }

    /// For a press somewhere round a place.
    pub(super) fn new(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> Self {
        let (centre, normal) = at(surface, places, place);
        let neighbours = places.neighbours(place);
        let axes = axes(normal, minus(at(surface, places, neighbours[0].into()).0, centre));
        let mut spot = Self { place, centre, axes, is_free: true, ..Self::default() };
        let (sum, length) = spot.ways_to(surface, places, &neighbours);
        spot.spacing = (length / PLACE_NEIGHBOURS as f32).max(f32::MIN_POSITIVE);
        let one_sided = ONE_SIDED * spot.spacing;
        spot.is_at_border = sum[0] * sum[0] + sum[1] * sum[1] > one_sided * one_sided;
        // In a corner presses of all strengths look alike; a step towards the middle they do not.
        if spot.is_at_border { spot.stepped(sum.map(|part| part / 2.0)) } else { spot }
    }

    /// Sum of the ways to these places along the axes, and of their lengths, m.
    // Of a slice, and not inlined: the compiler writes loops of a known length out.
    #[inline(never)]
    fn ways_to(&self, surface: &Surface<'_>, places: &Places<'_>, others: &[u8]) -> ([f32; 2], f32) {
        others.iter().fold(([0.0; 2], 0.0), |(sum, length), &other| {
            let [x, y] = self.way_to(at(surface, places, other.into()).0);
            ([sum[0] + x, sum[1] + y], length + libm::sqrtf(x * x + y * y))
        })
    }

    /// One whose presses need not stay on it.
    #[cfg(test)]
    pub(super) fn free() -> Self {
        Self { is_free: true, ..Self::default() }
    }

    /// Its place.
    pub(super) fn place(&self) -> usize {
        self.place
    }

    /// Whether a press stays on the place.
    pub(super) fn is_fixed(&self) -> bool {
        !self.is_free
    }

    /// How far from its place it is, m.
    fn offset(&self) -> [f32; 2] {
        self.steps.map(|steps| STEP * self.spacing * f32::from(steps))
    }

    /// The way from its place to a point, along the axes, m.
    fn way_to(&self, point: [f32; 3]) -> [f32; 2] {
        let way = minus(point, self.centre);
        self.axes.map(|axis| dot(axis, way))
    }

    /// A number that no other spot has.
    pub(super) fn key(&self) -> u16 {
        let [x, y] = self.steps.map(|steps| (steps + 1) as usize);
        (2 * (9 * self.place + 3 * x + y) + usize::from(self.is_fixed())) as u16
    }

    /// The spot of a key, for its response: it does not know where it lies.
    pub(super) fn of_key(key: u16) -> Self {
        let rest = usize::from(key) / 2;
        let steps = [rest / 3 % 3, rest % 3].map(|step| step as i8 - 1);
        Self { place: rest / 9, steps, is_free: key.is_multiple_of(2), ..Self::default() }
    }

    /// How far a press that these unknowns belong to is from its place, m.
    pub(super) fn offset_of(&self, strength: f32, [x, y]: [f32; 2]) -> [f32; 2] {
        let [from_x, from_y] = self.offset();
        let scale = self.spacing / strength;
        [from_x + scale * x, from_y + scale * y]
    }

    /// The unknowns of a press that is so far from its place, m.
    pub(super) fn unknowns_of(&self, strength: f32, [x, y]: [f32; 2]) -> [f32; UNKNOWNS] {
        if self.is_fixed() {
            return [strength, 0.0, 0.0];
        }
        let [from_x, from_y] = self.offset();
        let scale = strength / self.spacing;
        [strength, scale * (x - from_x), scale * (y - from_y)]
    }

    /// The places whose rows it is made of, with what each has of the response here and of its slopes.
    // Not inlined: it is asked for here and there.
    #[inline(never)]
    fn shares(&self, places: &Places<'_>) -> OfRows<(usize, [f32; UNKNOWNS])> {
        let mut all = OfRows::new();
        if self.is_fixed() {
            let _ = all.push((self.place, [1.0, 0.0, 0.0]));
            return all;
        }
        let [x, y] = self.steps.map(i32::from);
        all.extend(places.rows_round(self.place).map(|(row, [along_x, along_y, xx, xy, yy])| {
            // In halves of a share's unit, and in eighths.
            let slope_x = 2 * along_x + xx * x + xy * y;
            let slope_y = 2 * along_y + xy * x + yy * y;
            let more = (2 * along_x + slope_x) * x + (2 * along_y + slope_y) * y;
            let own = if row == self.place { 1.0 } else { 0.0 };
            let here = own + SHARE_UNIT / 8.0 * more as f32;
            (row, [here, SHARE_UNIT / 2.0 * slope_x as f32, SHARE_UNIT / 2.0 * slope_y as f32])
        }));
        all
    }

    /// Something linear in responses, known of each place: of the response at this one, and of its slopes.
    pub(super) fn of_places(
        &self,
        places: &Places<'_>,
        mut value: impl FnMut(usize) -> f32,
    ) -> [f32; UNKNOWNS] {
        let mut found = [0.0; UNKNOWNS];
        for (place, shares) in self.shares(places) {
            let value = value(place);
            found.iter_mut().zip(shares).for_each(|(found, share)| *found += share * value);
        }
        found
    }

    /// Its response and slopes, to be read column by column.
    pub(super) fn columns<'a>(&self, places: &Places<'a>) -> Columns<'a> {
        let of_row = |(place, shares): (usize, [f32; UNKNOWNS])| {
            let exponent = power_of_two(-i32::from(places.row_exponent(place)));
            (places.row(place), shares.map(|share| share * exponent))
        };
        Columns { rows: self.shares(places).into_iter().map(of_row).collect() }
    }

    /// So much of the response and of each slope, to be read column by column.
    pub(super) fn response<'a>(&self, places: &Places<'a>, unknowns: [f32; UNKNOWNS]) -> Response<'a> {
        let of_row = |(row, shares): (&'a [u8], [f32; UNKNOWNS])| {
            (row, shares.iter().zip(unknowns).map(|(share, unknown)| share * unknown).sum())
        };
        Response { rows: self.columns(places).rows.into_iter().map(of_row).collect() }
    }

    /// An offset, no longer than slopes hold for.
    pub(super) fn within_reach(&self, offset: [f32; 2]) -> [f32; 2] {
        let length = libm::sqrtf(offset.iter().map(|part| part * part).sum());
        let most = FARTHEST * self.spacing;
        if length > most { offset.map(|part| part * most / length) } else { offset }
    }

    /// Whether an offset is several times as long.
    pub(super) fn is_far_out(&self, offset: [f32; 2]) -> bool {
        let most = FAR_OUT * self.spacing;
        offset.iter().map(|part| part * part).sum::<f32>() > most * most
    }

    /// The point at an offset.
    pub(super) fn point(&self, offset: [f32; 2]) -> [f32; 3] {
        [0, 1, 2]
            .map(|part| self.centre[part] + self.axes[0][part] * offset[0] + self.axes[1][part] * offset[1])
    }

    /// The point of the skin at or near one.
    pub(super) fn inside(&self, surface: &Surface<'_>, places: &Places<'_>, point: [f32; 3]) -> [f32; 3] {
        match places.get(self.place) {
            Some(place) if self.is_at_border => surface.inside(place.pixel.into(), point),
            _ => point,
        }
    }

    /// The spot that an offset is nearest to, if it is not this one and clearly nearer.
    pub(super) fn nearest(
        &self,
        surface: &Surface<'_>,
        places: &Places<'_>,
        offset: [f32; 2],
    ) -> Option<Self> {
        let offset = self.within_reach(offset);
        let here = self.point(offset);
        let (mut place, mut least) = (self.place, square_distance(here, self.centre));
        for other in places.neighbours(self.place) {
            let away = square_distance(here, at(surface, places, other.into()).0);
            if away < 0.9 * least {
                (place, least) = (other.into(), away);
            }
        }
        if place != self.place {
            let spot = Self::new(surface, places, place);
            return Some(spot.stepped(spot.way_to(here)));
        }
        let stays = STAYS * self.spacing;
        let is_far = offset.iter().zip(self.offset()).any(|(to, from)| (to - from).abs() > stays);
        let spot = self.stepped(offset);
        (is_far && spot.steps != self.steps).then_some(spot)
    }

    /// The spot of its place that an offset is nearest to.
    fn stepped(&self, offset: [f32; 2]) -> Self {
        let steps = offset.map(|part| libm::roundf(part / (STEP * self.spacing)).clamp(-1.0, 1.0) as i8);
        Self { steps, ..*self }
    }
}

/// Response and slopes as sums over rows, without the columns' exponents.
pub(super) struct Columns<'a> {
    rows: OfRows<(&'a [u8], [f32; UNKNOWNS])>,
}

impl Columns<'_> {
    /// Of four columns: response and slopes, `[unknown][column]`.
    #[inline(always)]
    pub(super) fn four(&self, four: usize) -> [[f32; GROUP]; UNKNOWNS] {
        let mut values = [[0.0; GROUP]; UNKNOWNS];
        for (row, shares) in &self.rows {
            let responses = Places::four(row, four);
            for (values, share) in values.iter_mut().zip(shares) {
                values.iter_mut().zip(responses).for_each(|(value, response)| *value += share * response);
            }
        }
        values
    }
}

/// One press' response as a sum over rows, without the columns' exponents.
pub(super) struct Response<'a> {
    rows: OfRows<(&'a [u8], f32)>,
}

impl Response<'_> {
    /// Of four columns.
    #[inline(always)]
    pub(super) fn four(&self, four: usize) -> [f32; GROUP] {
        let mut values = [0.0; GROUP];
        for (row, share) in &self.rows {
            let responses = Places::four(row, four);
            values.iter_mut().zip(responses).for_each(|(value, response)| *value += share * response);
        }
        values
    }
}

/// Gives a sum of rows, known of four columns at a time without their exponents, measurement by measurement.
pub(super) fn each(
    places: &Places<'_>,
    four: impl Fn(usize) -> [f32; GROUP],
    mut give: impl FnMut(usize, f32),
) {
    let mut exponents = places.column_exponents().enumerate();
    for at in 0.. {
        for value in four(at) {
            let Some((m, exponent)) = exponents.next() else { return };
            give(m, value * power_of_two(-i32::from(exponent)));
        }
    }
}

/// Centre, m, and normal of a place.
// Once on the board, not wherever it is asked for.
#[inline(never)]
pub(super) fn at(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> ([f32; 3], [f32; 3]) {
    let pixel = places.get(place).and_then(|place| surface.pixel(place.pixel.into()));
    pixel.map_or(([0.0; 3], [0.0, 0.0, 1.0]), |pixel| (surface.centre(&pixel), surface.normal(&pixel)))
}

/// Two unit vectors at right angles to each other and to a normal, the first of them as a way goes.
fn axes(normal: [f32; 3], way: [f32; 3]) -> [[f32; 3]; 2] {
    let up = dot(normal, way);
    let along = [0, 1, 2].map(|part| way[part] - up * normal[part]);
    let scale = 1.0 / libm::sqrtf(dot(along, along)).max(f32::MIN_POSITIVE);
    let [x, y, z] = along.map(|part| scale * part);
    let [a, b, c] = normal;
    [[x, y, z], [b * z - c * y, c * x - a * z, a * y - b * x]]
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|part| a[part] - b[part])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_at_right_angles_and_the_first_goes_as_the_way_does() {
        let way = [0.01, 0.02, -0.005];
        for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]] {
            let [a, b] = axes(normal, way);
            for (value, expected) in [
                (dot(a, a), 1.0),
                (dot(b, b), 1.0),
                (dot(a, b), 0.0),
                (dot(a, normal), 0.0),
                (dot(b, normal), 0.0),
                (dot(b, way), 0.0),
            ] {
                assert!((value - expected).abs() < 1e-6, "{normal:?}: {a:?} {b:?}");
            }
            assert!(dot(a, way) > 0.0);
        }
        assert!(axes([0.0, 0.0, 1.0], [0.0; 3]).as_flattened().iter().all(|part| part.is_finite()));
    }

    #[test]
    fn a_press_has_the_unknowns_of_its_offset_and_the_other_way_round() {
        let spot = Spot { spacing: 0.01, steps: [1, -1], ..Spot::free() };
        assert_eq!(spot.offset(), [0.005, -0.005]);
        let [strength, x, y] = spot.unknowns_of(2.0, [0.006, -0.002]);
        assert_eq!(strength, 2.0);
        assert!((x - 0.2).abs() < 1e-6 && (y - 0.6).abs() < 1e-6, "{x} {y}");
        let offset = spot.offset_of(2.0, [x, y]);
        assert!((offset[0] - 0.006).abs() < 1e-8 && (offset[1] + 0.002).abs() < 1e-8, "{offset:?}");
    }

    #[test]
    fn spots_of_all_places_have_keys_of_their_own() {
        let mut keys = std::vec::Vec::new();
        for place in 0..256 {
            keys.push(Spot { place, ..Spot::default() }.key());
            for steps in [-1, 0, 1].into_iter().flat_map(|x| [-1, 0, 1].map(|y| [x, y])) {
                keys.push(Spot { place, steps, ..Spot::free() }.key());
            }
        }
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 2560);
    }
}
