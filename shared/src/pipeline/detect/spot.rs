//! Spots: places with the way the response changes round them.

use crate::{
    image::surface::{Surface, square_distance},
    patch::{
        matrix::GROUP,
        places::{PLACE_NEIGHBOURS, Places},
    },
    pipeline::reference::power_of_two,
};
use heapless::Vec;

/// Unknowns of a press: its strength, and strength times offset along two axes.
pub(super) const UNKNOWNS: usize = 3;
/// Farthest that a press goes from its place, distances to the next places.
const FARTHEST: f32 = 1.0;
/// Ways to the places round one at the skin's border sum up to more than this, their mean length being 1.
const ONE_SIDED: f32 = 1.2;
/// A solution that has one so far from its place is none, distances to the next places.
const FAR_OUT: f32 = 8.0;

/// A place, and the slopes of the response there: round it the response is taken to change linearly with where the press
/// is, as least squares over the places round it have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spot {
    place: usize,
    /// Centre, m.
    centre: [f32; 3],
    axes: [[f32; 3]; 2],
    /// Mean distance of the places round it, m; slopes are for each of it.
    pub(super) spacing: f32,
    /// Whether the places round it lie on one side, as at the skin's border.
    is_at_border: bool,
    /// Whether presses need not stay on the place.
    is_free: bool,
    /// What the response at each place round it adds to the slopes. The place's own takes as much off.
    round: [(u8, [f32; 2]); PLACE_NEIGHBOURS],
}

/// By neighbour.
type Round<T> = Vec<T, PLACE_NEIGHBOURS>;

impl Spot {
    /// For a press that stays on a place.
    pub(super) fn fixed(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> Self {
        Self { place, centre: at(surface, places, place).0, ..Self::default() }
    }

    /// For a press somewhere round a place.
    pub(super) fn new(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> Self {
        let (centre, normal) = at(surface, places, place);
        let axes = tangents(normal);
        let neighbours = places.get(place).map_or([0; PLACE_NEIGHBOURS], |place| place.neighbours);
        let ways = neighbours.map(|other| {
            let (there, _) = at(surface, places, other.into());
            axes.map(|axis| (0..3).map(|part| axis[part] * (there[part] - centre[part])).sum::<f32>())
        });
        let lengths = ways.iter().map(|[x, y]| libm::sqrtf(x * x + y * y));
        let spacing = (lengths.sum::<f32>() / PLACE_NEIGHBOURS as f32).max(f32::MIN_POSITIVE);
        let ways = ways.map(|way| way.map(|part| part / spacing));
        let sum = ways.iter().fold([0.0; 2], |sum, way| [sum[0] + way[0], sum[1] + way[1]]);
        let is_at_border = sum[0] * sum[0] + sum[1] * sum[1] > ONE_SIDED * ONE_SIDED;
        // Near ones count for more.
        let weight = |[x, y]: [f32; 2]| 1.0 / (x * x + y * y + 0.1);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for way in ways {
            let [x, y] = way;
            xx += weight(way) * x * x;
            xy += weight(way) * x * y;
            yy += weight(way) * y * y;
        }
        let determinant = xx * yy - xy * xy;
        let inverse = if determinant > 1e-3 * xx * yy { 1.0 / determinant } else { 0.0 };
        let shares = ways.map(|way| {
            let ([x, y], weight) = (way, weight(way) * inverse);
            [weight * (yy * x - xy * y), weight * (xx * y - xy * x)]
        });
        let round = core::array::from_fn(|n| (neighbours[n], shares[n]));
        Self { place, centre, axes, spacing, is_at_border, is_free: true, round }
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

    fn round(&self) -> &[(u8, [f32; 2])] {
        if self.is_free { &self.round } else { &[] }
    }

    /// One of the places round it.
    pub(super) fn beside(&self, neighbour: usize) -> Option<usize> {
        self.round.get(neighbour).map(|&(place, _)| place.into())
    }

    /// A number that no other spot has.
    pub(super) fn key(&self) -> u16 {
        (2 * self.place + usize::from(self.is_fixed())) as u16
    }

    /// Something linear in responses, known of each place: of the response at this one, and of its slopes.
    pub(super) fn of_places(&self, mut value: impl FnMut(usize) -> f32) -> [f32; UNKNOWNS] {
        let own = value(self.place);
        let mut found = [own, 0.0, 0.0];
        for &(other, [x, y]) in self.round() {
            let more = value(other.into()) - own;
            found[1] += x * more;
            found[2] += y * more;
        }
        found
    }

    /// Its response and slopes, to be read column by column.
    pub(super) fn columns<'a>(&self, places: &Places<'a>) -> Columns<'a> {
        let exponent = |place: usize| power_of_two(-i32::from(places.row_exponent(place)));
        let own_exponent = exponent(self.place);
        let mut own = [own_exponent, 0.0, 0.0];
        let round = self.round().iter().map(|&(other, shares)| {
            own[1] -= shares[0] * own_exponent;
            own[2] -= shares[1] * own_exponent;
            (places.row(other.into()), shares.map(|share| share * exponent(other.into())))
        });
        Columns { round: round.collect(), own_row: places.row(self.place), own }
    }

    /// The response of a press at this offset, m, to be read column by column.
    pub(super) fn response<'a>(&self, places: &Places<'a>, strength: f32, offset: [f32; 2]) -> Response<'a> {
        let Columns { own_row, own, round } = self.columns(places);
        let [x, y] = offset.map(|part| if self.is_fixed() { 0.0 } else { strength * part / self.spacing });
        Response {
            own_row,
            own: strength * own[0] + x * own[1] + y * own[2],
            round: round.into_iter().map(|(row, shares)| (row, x * shares[0] + y * shares[1])).collect(),
        }
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

    /// The place that an offset is nearest to, this one unless another is clearly nearer.
    pub(super) fn nearest(&self, surface: &Surface<'_>, places: &Places<'_>, offset: [f32; 2]) -> usize {
        let here = self.point(self.within_reach(offset));
        let (mut place, mut least) = (self.place, square_distance(here, self.centre));
        for &(other, _) in self.round() {
            let away = square_distance(here, at(surface, places, other.into()).0);
            if away < 0.9 * least {
                (place, least) = (other.into(), away);
            }
        }
        place
    }
}

/// Response and slopes as sums over rows, without the columns' exponents.
pub(super) struct Columns<'a> {
    own_row: &'a [u8],
    own: [f32; UNKNOWNS],
    round: Round<(&'a [u8], [f32; 2])>,
}

impl Columns<'_> {
    /// Of four columns: response and slopes, `[unknown][column]`.
    #[inline(always)]
    pub(super) fn four(&self, four: usize) -> [[f32; GROUP]; UNKNOWNS] {
        let own = Places::four(self.own_row, four);
        let mut values = self.own.map(|share| own.map(|own| share * own));
        for (row, shares) in &self.round {
            let responses = Places::four(row, four);
            for (values, share) in values[1..].iter_mut().zip(shares) {
                values.iter_mut().zip(responses).for_each(|(value, response)| *value += share * response);
            }
        }
        values
    }
}

/// One press' response as a sum over rows, without the columns' exponents.
pub(super) struct Response<'a> {
    own_row: &'a [u8],
    own: f32,
    round: Round<(&'a [u8], f32)>,
}

impl Response<'_> {
    /// Of four columns.
    #[inline(always)]
    pub(super) fn four(&self, four: usize) -> [f32; GROUP] {
        let mut values = Places::four(self.own_row, four).map(|response| self.own * response);
        for (row, share) in &self.round {
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

/// Two unit vectors at right angles to each other and to a unit vector.
fn tangents([x, y, z]: [f32; 3]) -> [[f32; 3]; 2] {
    // Duff et al., Building an orthonormal basis, revisited, JCGT 6(1), 2017.
    let sign = 1.0_f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_are_at_right_angles_on_both_sides_of_the_plane() {
        for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]] {
            let [a, b] = tangents(normal);
            let dot = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
            for (value, expected) in [
                (dot(a, a), 1.0),
                (dot(b, b), 1.0),
                (dot(a, b), 0.0),
                (dot(a, normal), 0.0),
                (dot(b, normal), 0.0),
            ] {
                assert!((value - expected).abs() < 1e-6, "{normal:?}: {a:?} {b:?}");
            }
        }
    }
}
