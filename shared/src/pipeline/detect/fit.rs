//! Fit: places and strengths of some presses by least squares, weighted by the noise.
//!
//! Round a place the response is taken to change linearly with where the press is: its slopes along two axes are fitted
//! to the responses at the places round it. Strengths and offsets of all presses then follow from one linear system, with
//! their covariances; a press that lies nearer to another place is fitted there again.

use crate::{
    image::surface::Surface,
    limits::MAX_CONTACTS,
    patch::{
        PatchView,
        places::{PLACE_NEIGHBOURS, Places},
    },
    pipeline::reference::{Changes, power_of_two},
};
use heapless::Vec;

/// Unknowns of a press: its strength, and strength times offset along two axes.
const UNKNOWNS: usize = 3;
/// Most presses, with satellites.
pub(super) const MAX_PRESSES: usize = 2 * MAX_CONTACTS;
/// Most unknowns.
const MOST: usize = UNKNOWNS * MAX_CONTACTS;
/// Times that presses go to nearer places.
const ROUNDS: usize = 4;
/// Standard deviation of an offset before anything is measured, distances from place to place.
const FREE: f32 = 0.7;
/// Farthest that a press goes from its place, such distances.
const FARTHEST: f32 = 1.0;

/// Presses closer than this are one, radii of the standard press.
const ONE_REACH: f32 = 2.5;
/// One that is weaker than this share of a stronger one belongs to it within this reach.
const SATELLITE: f32 = 0.45;
const SATELLITE_REACH: f32 = 3.9;

/// One press, or a satellite: what a press that is larger or smaller than the standard one leaves beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Press {
    place: usize,
    /// Offset from the place along its axes, m.
    offset: [f32; 2],
    /// Whether it belongs to another press; it stays on its place then.
    is_satellite: bool,
    /// Its centre, m.
    pub position: [f32; 3],
    /// Standard deviation of its centre along each axis of the skin, m.
    pub position_deviation: f32,
    /// Strength: 1 for the standard press.
    pub strength: f32,
    /// Standard deviation of the strength.
    pub strength_deviation: f32,
    /// By how many standard deviations it is above zero.
    pub significance: f32,
}

impl Press {
    /// A press that is not fitted yet.
    pub(super) fn at(place: usize, strength: f32, is_satellite: bool) -> Self {
        Self { place, strength, is_satellite, ..Self::default() }
    }

    /// The pixel next to it.
    #[must_use]
    pub fn pixel(&self, places: &Places<'_>) -> usize {
        places.get(self.place).map_or(0, |place| place.pixel.into())
    }

    /// How many unknowns it has.
    fn unknowns(&self) -> usize {
        if self.is_satellite { 1 } else { UNKNOWNS }
    }

    /// Whether another press there, of this strength, is one with it.
    fn is_joined_by(&self, position: [f32; 3], strength: f32, radius: f32) -> bool {
        let reach = if strength < SATELLITE * self.strength { SATELLITE_REACH } else { ONE_REACH };
        square(self.position, position) < reach * reach * radius * radius
    }

    /// Takes its satellite in: what is pressed lies in the middle of both.
    fn take_in(&mut self, satellite: &Self) {
        let strength = self.strength + satellite.strength;
        let share = satellite.strength / strength;
        for (here, there) in self.position.iter_mut().zip(satellite.position) {
            *here += share * (there - *here);
        }
        let root = |a: f32, b: f32| libm::sqrtf(a * a + b * b);
        self.significance = root(self.significance, satellite.significance);
        self.strength_deviation = root(self.strength_deviation, satellite.strength_deviation);
        self.strength = strength;
    }
}

/// Some presses, and how well they explain the data.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) presses: Vec<Press, MAX_PRESSES>,
    /// Sum of squares of the data, in units of the noise's variance.
    energy: f32,
    /// What the presses explain of it.
    pub(super) explained: f32,
    /// Measurements that say something.
    measurements: f32,
    /// Radius of the standard press, m.
    radius: f32,
}

impl Fit {
    /// No press.
    pub(super) fn of_nothing(patch: &PatchView<'_>, relative: &[f32], weights: &[f32]) -> Self {
        let (mut energy, mut measurements) = (0.0, 0.0);
        for (y, weight) in known(relative, weights) {
            energy += y * y * weight;
            measurements += 1.0;
        }
        let radius = patch.header.detection.radius;
        Self { presses: Vec::new(), energy, explained: 0.0, measurements, radius }
    }

    /// Variance of what the presses do not explain, at least that of the noise.
    pub(super) fn misfit(&self) -> f32 {
        self.misfit_after(0.0)
    }

    /// The same if so much more were explained.
    pub(super) fn misfit_after(&self, more: f32) -> f32 {
        let free = (self.measurements - self.unknowns() as f32).max(1.0);
        ((self.energy - self.explained - more) / free).max(1.0)
    }

    fn unknowns(&self) -> usize {
        self.presses.iter().map(Press::unknowns).sum()
    }

    /// Whether there is room for another press.
    pub(super) fn has_room(&self) -> bool {
        !self.presses.is_full() && self.unknowns() + UNKNOWNS <= MOST
    }

    /// The presses with all that lies beside them taken in, strongest first.
    pub(super) fn contacts(&self) -> Vec<Press, MAX_CONTACTS> {
        let mut left = self.presses.clone();
        left.sort_unstable_by(|a, b| b.strength.total_cmp(&a.strength));
        let mut contacts: Vec<Press, MAX_CONTACTS> = Vec::new();
        for press in left {
            let away = |contact: &&mut Press| square(contact.position, press.position);
            let near = contacts.iter_mut().min_by(|a, b| away(a).total_cmp(&away(b)));
            match near {
                Some(near)
                    if press.is_satellite
                        || near.is_joined_by(press.position, press.strength, self.radius) =>
                {
                    near.take_in(&press);
                }
                _ => {
                    let _ = contacts.push(press);
                }
            }
        }
        contacts.sort_unstable_by(|a, b| b.strength.total_cmp(&a.strength));
        contacts
    }

    /// Whether presses account for most of what noise does not.
    pub(super) fn is_explained(&self) -> bool {
        self.energy - self.explained - self.measurements < self.explained
    }

    /// Whether a press of this strength at a place could be what the standard press of another does not explain.
    pub(super) fn is_beside(&self, patch: &PatchView<'_>, place: usize, strength: f32) -> bool {
        let (here, _) = at(&patch.surface(), &patch.places(), place);
        let mut presses = self.presses.iter().filter(|press| !press.is_satellite);
        presses.any(|press| press.is_joined_by(here, strength, self.radius))
    }

    /// Whether a press is strong enough beside the others.
    pub(super) fn is_worth(&self, press: &Press) -> bool {
        let strongest = self.presses.iter().fold(0.0, |most: f32, press| most.max(press.strength));
        press.strength > 0.0 && (press.is_satellite || press.strength >= super::LEAST_SHARE * strongest)
    }

    /// Keeps some of the presses; what the others explained is not told apart.
    pub(super) fn retain(&mut self, keeps: impl Fn(&Press, &Self) -> bool) {
        let all = self.clone();
        self.presses.retain(|press| keeps(press, &all));
    }

    /// The data without the presses' responses.
    pub(super) fn left(&self, patch: &PatchView<'_>, relative: &[f32], out: &mut Changes) {
        let places = patch.places();
        let surface = patch.surface();
        let columns = self.columns(&surface, &places);
        let ways: Vec<[f32; UNKNOWNS], MAX_PRESSES> = self
            .presses
            .iter()
            .zip(&columns)
            .map(|(press, columns)| {
                let [x, y] = press.offset.map(|part| part / columns.spacing);
                [1.0, x, y].map(|way| way * press.strength)
            })
            .collect();
        out.clear();
        let mut exponents = places.column_exponents();
        for (pair, values) in relative.chunks(2).enumerate() {
            let mut of_presses = [0.0; 2];
            for (columns, way) in columns.iter().zip(&ways) {
                for (value, [response, x, y]) in of_presses.iter_mut().zip(columns.at(pair)) {
                    *value += response * way[0] + x * way[1] + y * way[2];
                }
            }
            for (&y, of_presses) in values.iter().zip(of_presses) {
                let scale = power_of_two(-i32::from(exponents.next().unwrap_or(0)));
                let y = if y.is_finite() { y } else { 0.0 };
                let _ = out.push(y - scale * of_presses);
            }
        }
    }

    /// The columns of the system, by presses.
    fn columns<'a>(&self, surface: &Surface<'_>, places: &Places<'a>) -> Vec<Columns<'a>, MAX_PRESSES> {
        self.presses.iter().map(|press| Columns::new(surface, places, press)).collect()
    }
}

/// Data and weights that say something.
fn known<'a>(relative: &'a [f32], weights: &'a [f32]) -> impl Iterator<Item = (f32, f32)> + 'a {
    let pairs = relative.iter().copied().zip(weights.iter().copied());
    pairs.filter(|(y, weight)| y.is_finite() && *weight > 0.0)
}

/// Fits presses that begin where they are told to.
#[inline(never)]
pub(super) fn refined(patch: &PatchView<'_>, presses: &[Press], relative: &[f32], weights: &[f32]) -> Fit {
    let mut fit = Fit::of_nothing(patch, relative, weights);
    fit.presses.extend(presses.iter().copied());
    let mut best = fit.clone();
    for _ in 0..ROUNDS {
        fit.solve(patch, relative, weights);
        if fit.presses.len() < best.presses.len() || fit.explained > best.explained {
            best = fit.clone();
        }
        if !(fit.go_to_nearest(patch) | fit.join()) {
            break;
        }
    }
    best.keep_near(patch);
    best
}

impl Fit {
    /// Strengths and offsets of all presses at their places.
    #[inline(never)]
    fn solve(&mut self, patch: &PatchView<'_>, relative: &[f32], weights: &[f32]) {
        let places = patch.places();
        let surface = patch.surface();
        let columns = self.columns(&surface, &places);
        let count = self.unknowns();
        let mut system = System { matrix: [[0.0; MOST]; MOST], right: [0.0; MOST], count };
        let mut exponents = places.column_exponents();
        let mut row = [[0.0; MOST]; 2];
        for (pair, (values, weights)) in relative.chunks(2).zip(weights.chunks(2)).enumerate() {
            let mut first = 0;
            for (press, columns) in self.presses.iter().zip(&columns) {
                let [one, other] = columns.at(pair);
                let unknowns = press.unknowns();
                row[0][first..first + unknowns].copy_from_slice(&one[..unknowns]);
                row[1][first..first + unknowns].copy_from_slice(&other[..unknowns]);
                first += unknowns;
            }
            for ((&y, &weight), row) in values.iter().zip(weights).zip(&row) {
                let exponent = i32::from(exponents.next().unwrap_or(0));
                if y.is_finite() && weight > 0.0 {
                    // The column's exponent, taken out of the row.
                    system.add(row, y * power_of_two(exponent), weight * power_of_two(-2 * exponent));
                }
            }
        }
        let mut first = 0;
        for press in &self.presses {
            // Before anything is measured, an offset is zero but for some of the distance to the next place.
            let free = (FREE * press.strength.abs()).max(1e-6);
            for unknown in first + 1..first + press.unknowns() {
                system.matrix[unknown][unknown] += 1.0 / (free * free);
            }
            first += press.unknowns();
        }
        let right = system.right;
        if !system.factor() {
            self.presses.clear();
            self.explained = 0.0;
            return;
        }
        let found = system.solution(&right);
        self.explained = right[..count].iter().zip(&found).map(|(b, x)| b * x).sum();
        let misfit = self.misfit();
        let mut first = 0;
        for (press, columns) in self.presses.iter_mut().zip(&columns) {
            press.strength = found[first];
            let size = press.strength.abs().max(f32::MIN_POSITIVE);
            let of_strength = system.variance(first);
            press.significance = press.strength / libm::sqrtf(of_strength);
            press.strength_deviation = libm::sqrtf(of_strength * misfit);
            if !press.is_satellite {
                press.offset = [1, 2].map(|axis| found[first + axis] / size * columns.spacing);
                let mean = (system.variance(first + 1) + system.variance(first + 2)) / 2.0 * misfit;
                press.position_deviation = libm::sqrtf(mean) / size * columns.spacing;
            }
            first += press.unknowns();
        }
    }

    /// Presses that lie nearer to another place go there; says whether any did.
    fn go_to_nearest(&mut self, patch: &PatchView<'_>) -> bool {
        let (places, surface) = (patch.places(), patch.surface());
        let mut moved = false;
        for press in self.presses.iter_mut().filter(|press| !press.is_satellite) {
            let columns = Columns::new(&surface, &places, press);
            let here = columns.point(columns.within_reach(press.offset));
            let mut least = square(here, columns.centre);
            for (neighbour, centre) in columns.round(&surface, &places) {
                let away = square(here, centre);
                if away < 0.9 * least {
                    (least, press.place, moved) = (away, neighbour, true);
                }
            }
        }
        moved
    }

    /// Presses that met become one; says whether any did.
    fn join(&mut self) -> bool {
        for one in 0..self.presses.len() {
            for other in one + 1..self.presses.len() {
                if self.presses[one].place == self.presses[other].place {
                    let gone = self.presses.swap_remove(other);
                    self.presses[one].strength += gone.strength;
                    self.presses[one].is_satellite &= gone.is_satellite;
                    return true;
                }
            }
        }
        false
    }

    /// Where the presses lie.
    fn keep_near(&mut self, patch: &PatchView<'_>) {
        let (places, surface) = (patch.places(), patch.surface());
        for press in &mut self.presses {
            let columns = Columns::new(&surface, &places, press);
            press.offset = columns.within_reach(press.offset);
            press.position = columns.point(press.offset);
        }
    }
}

/// The response at a place and its slopes, as sums over the places round it.
struct Columns<'a> {
    centre: [f32; 3],
    axes: [[f32; 3]; 2],
    /// Mean distance of the places round it, m; slopes are for each of it.
    spacing: f32,
    neighbours: [u8; PLACE_NEIGHBOURS],
    /// Responses at the place, and at those round it if their slopes count.
    own_row: &'a [u8],
    rows: [&'a [u8]; PLACE_NEIGHBOURS],
    /// What the response at each place round it adds to the slopes, with its exponent.
    shares: [[f32; 2]; PLACE_NEIGHBOURS],
    /// What its own adds to response and slopes.
    own: [f32; UNKNOWNS],
}

impl<'a> Columns<'a> {
    #[inline(never)]
    fn new(surface: &Surface<'_>, places: &Places<'a>, press: &Press) -> Self {
        let place = press.place;
        let (centre, normal) = at(surface, places, place);
        let axes = tangents(normal);
        let neighbours = places.get(place).map_or([0; PLACE_NEIGHBOURS], |place| place.neighbours);
        let exponent = |place: usize| power_of_two(-i32::from(places.row_exponent(place)));
        let mut columns = Self {
            centre,
            axes,
            spacing: 1.0,
            neighbours,
            own_row: places.row(place),
            rows: [&[]; PLACE_NEIGHBOURS],
            shares: [[0.0; 2]; PLACE_NEIGHBOURS],
            own: [exponent(place), 0.0, 0.0],
        };
        if press.is_satellite {
            return columns;
        }
        let ways = neighbours.map(|other| {
            let (there, _) = at(surface, places, other.into());
            axes.map(|axis| (0..3).map(|part| axis[part] * (there[part] - centre[part])).sum::<f32>())
        });
        let lengths = ways.iter().map(|[x, y]| libm::sqrtf(x * x + y * y));
        columns.spacing = (lengths.sum::<f32>() / PLACE_NEIGHBOURS as f32).max(f32::MIN_POSITIVE);
        let ways = ways.map(|way| way.map(|part| part / columns.spacing));
        // Least squares over the places round it, near ones first.
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let weight = |[x, y]: [f32; 2]| 1.0 / (x * x + y * y + 0.1);
        for way in ways {
            let [x, y] = way;
            xx += weight(way) * x * x;
            xy += weight(way) * x * y;
            yy += weight(way) * y * y;
        }
        let determinant = xx * yy - xy * xy;
        let inverse = if determinant > 1e-3 * xx * yy { 1.0 / determinant } else { 0.0 };
        for (n, (way, &other)) in ways.into_iter().zip(&neighbours).enumerate() {
            let ([x, y], weight) = (way, weight(way) * inverse);
            let slopes = [weight * (yy * x - xy * y), weight * (xx * y - xy * x)];
            columns.own[1] -= slopes[0] * columns.own[0];
            columns.own[2] -= slopes[1] * columns.own[0];
            columns.shares[n] = slopes.map(|slope| slope * exponent(other.into()));
            columns.rows[n] = places.row(other.into());
        }
        columns
    }

    /// Response and slopes of a pair of columns, without the columns' exponents.
    #[inline(always)]
    fn at(&self, pair: usize) -> [[f32; UNKNOWNS]; 2] {
        let own = Places::pair(self.own_row, pair);
        let mut values = own.map(|own| self.own.map(|share| share * own));
        for (row, [x, y]) in self.rows.iter().zip(&self.shares) {
            for (values, response) in values.iter_mut().zip(Places::pair(row, pair)) {
                values[1] += x * response;
                values[2] += y * response;
            }
        }
        values
    }

    /// An offset, no longer than slopes hold for.
    fn within_reach(&self, offset: [f32; 2]) -> [f32; 2] {
        let length = libm::sqrtf(offset.iter().map(|part| part * part).sum());
        let most = FARTHEST * self.spacing;
        if length > most { offset.map(|part| part * most / length) } else { offset }
    }

    fn point(&self, offset: [f32; 2]) -> [f32; 3] {
        [0, 1, 2]
            .map(|part| self.centre[part] + self.axes[0][part] * offset[0] + self.axes[1][part] * offset[1])
    }

    /// The places round it, with their centres.
    fn round(&self, surface: &Surface<'_>, places: &Places<'_>) -> [(usize, [f32; 3]); PLACE_NEIGHBOURS] {
        self.neighbours.map(|other| (usize::from(other), at(surface, places, other.into()).0))
    }
}

/// Centre, m, and normal of a place.
fn at(surface: &Surface<'_>, places: &Places<'_>, place: usize) -> ([f32; 3], [f32; 3]) {
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

fn square(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Normal equations, and their Cholesky factor.
struct System {
    matrix: [[f32; MOST]; MOST],
    right: [f32; MOST],
    count: usize,
}

impl System {
    /// One more equation.
    #[inline(always)]
    fn add(&mut self, row: &[f32; MOST], y: f32, weight: f32) {
        for i in 0..self.count {
            let scaled = row[i] * weight;
            self.right[i] += scaled * y;
            for (place, value) in self.matrix[i][..=i].iter_mut().zip(row) {
                *place += scaled * value;
            }
        }
    }

    /// Replaces the matrix by its factor, lower triangle; says whether there is one.
    fn factor(&mut self) -> bool {
        for i in 0..self.count {
            for j in 0..=i {
                let known: f32 = (0..j).map(|k| self.matrix[i][k] * self.matrix[j][k]).sum();
                let rest = self.matrix[i][j] - known;
                if i == j {
                    if rest.is_nan() || rest <= 1e-6 * self.matrix[i][i] {
                        return false;
                    }
                    self.matrix[i][i] = libm::sqrtf(rest);
                } else {
                    self.matrix[i][j] = rest / self.matrix[j][j];
                }
            }
        }
        true
    }

    /// Solution for a right side, by the factor.
    fn solution(&self, right: &[f32; MOST]) -> [f32; MOST] {
        let mut x = self.forward(right);
        for i in (0..self.count).rev() {
            let known: f32 = (i + 1..self.count).map(|k| self.matrix[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / self.matrix[i][i];
        }
        x
    }

    fn forward(&self, right: &[f32; MOST]) -> [f32; MOST] {
        let mut x = *right;
        for i in 0..self.count {
            let known: f32 = (0..i).map(|k| self.matrix[i][k] * x[k]).sum();
            x[i] = (x[i] - known) / self.matrix[i][i];
        }
        x
    }

    /// Variance of an unknown: an entry of the inverse's diagonal.
    fn variance(&self, unknown: usize) -> f32 {
        let mut unit = [0.0; MOST];
        unit[unknown] = 1.0;
        self.forward(&unit)[..self.count].iter().map(|part| part * part).sum()
    }
}
