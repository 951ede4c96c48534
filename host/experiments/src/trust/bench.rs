//! Bench: one skin, its true skin and its board, on which any number of trials are made.

use super::TrustError;
use crate::evaluate::surface::{Surface, extent, largest_extent};
use dermatome_geometry::mesh::Mesh;
use dermatome_model::{
    model::Model,
    skin::{FoundIn, Shape, Skin},
};
use dermatome_simulate::{Fault, Press, TrueSkin, instrument::ScanTable, rig::Observer, wiring};
use nalgebra::{Point3, distance};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{ops::Range, sync::Arc};

/// How often a place is looked for before there seems to be no room.
const TRIES: usize = 20_000;
/// A place lies on the upper side of a skin if it is so close to what is seen from above, share of the size.
const SEEN: f64 = 0.02;

/// One skin with what its contacts are found in.
#[derive(Clone, Debug)]
pub struct Bench {
    skin: Skin,
    board: Observer,
    truth: Arc<TrueSkin>,
    table: ScanTable,
    size: f64,
}

/// What a scan meets: phasors at unit current and conductivity, `[slot]`.
pub type Voltages = Vec<Complex64>;

impl Bench {
    /// Builds model, patch and true skin.
    pub fn new(skin: &Skin) -> Result<Self, TrustError> {
        let board = Observer::with_model(skin, Model::build(skin, |_| ())?)?;
        let truth = TrueSkin::new(skin)?;
        Ok(Self {
            table: ScanTable::of_patch(&board.patch()),
            size: largest_extent(truth.mesh()),
            truth: Arc::new(truth),
            skin: skin.clone(),
            board,
        })
    }

    /// The same with contacts found in this.
    pub fn found_in(&self, found_in: FoundIn) -> Result<Self, TrustError> {
        self.with_skin(Skin { contacts_found_in: found_in, ..self.skin.clone() })
    }

    /// The same at another frame rate, 1/s.
    pub(super) fn at_rate(&self, frame_rate: f64) -> Result<Self, TrustError> {
        let mut skin = self.skin.clone();
        skin.drive.frame_rate = frame_rate;
        self.with_skin(skin)
    }

    /// The same with another patch of the same skin.
    pub(super) fn with_patch(&self, patch: Vec<u8>) -> Result<Self, TrustError> {
        let board = Observer::with_patch(self.board.model().clone(), patch)?;
        Ok(Self { board, ..self.clone() })
    }

    fn with_skin(&self, skin: Skin) -> Result<Self, TrustError> {
        let board = Observer::with_model(&skin, self.board.model().clone())?;
        Ok(Self { table: ScanTable::of_patch(&board.patch()), board, skin, ..self.clone() })
    }

    /// The skin.
    #[must_use]
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Its board, without a reference.
    #[must_use]
    pub fn board(&self) -> &Observer {
        &self.board
    }

    /// The true skin.
    #[must_use]
    pub fn truth(&self) -> &TrueSkin {
        &self.truth
    }

    /// Largest extent of the skin along x, y or z, m: what shares of the size are of.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Steps of a scan: the first of its voltages.
    pub(super) fn steps(&self) -> usize {
        self.table.steps.len()
    }

    /// Frames in a second.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.table.frame_rate()
    }

    /// Whether the skin is flat.
    pub(super) fn is_flat(&self) -> bool {
        matches!(&self.skin.shape, shape if shape.flat().is_ok())
    }

    /// Middle of its box as seen from above, m.
    pub(super) fn middle(&self) -> [f64; 2] {
        [0, 1].map(|axis| {
            let (low, high) = extent(self.truth.mesh(), axis);
            (low + high) / 2.0
        })
    }

    /// What a scan meets under fingers of this radius, share of the size, and depth at these places.
    #[must_use]
    pub fn pressed(&self, places: &[Point3<f64>], radius: f64, depth: f64) -> Voltages {
        self.solve(&self.truth.conductivity(&self.fingers(places, radius, depth)))
    }

    /// Fingers of this radius, share of the size, and depth at these places.
    pub(super) fn fingers(&self, places: &[Point3<f64>], radius: f64, depth: f64) -> Vec<Press> {
        let finger = |place: &Point3<f64>| Press::finger([place.x, place.y], radius * self.size, depth);
        places.iter().map(finger).collect()
    }

    /// What a scan of the untouched skin meets.
    #[must_use]
    pub fn untouched(&self) -> Voltages {
        self.pressed(&[], 1.0, 1.0)
    }

    /// What a scan meets on a sheet of this relative conductivity, `[element]` of the true skin.
    #[must_use]
    pub fn solve(&self, conductivity: &[f64]) -> Voltages {
        self.solve_on(&self.truth, conductivity)
    }

    /// The same of another true skin with these electrodes.
    pub(super) fn solve_on(&self, truth: &TrueSkin, conductivity: &[f64]) -> Voltages {
        truth.phasors(conductivity, &self.table.slots(), self.table.drive.frequency.into())
    }

    /// What a scan meets on a sheet of this relative conductivity, `[element]`, where wires have these faults.
    #[must_use]
    pub(super) fn wired(&self, conductivity: &[f64], faults: &[Fault]) -> Voltages {
        wiring::phasors(&self.truth, conductivity, &self.table, self.skin.material.sheet_conductivity, faults)
    }

    /// Mean of what the electrodes' tests read untouched, ohm.
    pub(super) fn test_resistance(&self) -> f64 {
        let tests = self.untouched().split_off(self.steps());
        let sum: f64 = tests.iter().map(|voltage| voltage.norm()).sum();
        sum / tests.len() as f64 / self.skin.material.sheet_conductivity
    }

    /// Random places on it.
    #[must_use]
    pub fn places(&self, seed: u64) -> Places<'_> {
        Places::new(self, seed)
    }
}

/// Random places on a skin, even over its surface as far as it is seen from above.
#[derive(Debug)]
pub struct Places<'a> {
    bench: &'a Bench,
    surface: Surface<'a>,
    /// Area of an element and those before it: `[element]`.
    areas: Vec<f64>,
    random: Pcg64Mcg,
}

impl<'a> Places<'a> {
    fn new(bench: &'a Bench, seed: u64) -> Self {
        let shape: &Shape = &bench.skin.shape;
        let mesh: &Mesh = bench.truth.mesh();
        let surface = Surface::new(shape, mesh);
        let mut sum = 0.0;
        let areas = surface.areas.iter().map(|area| {
            sum += area;
            sum
        });
        Self { areas: areas.collect(), bench, surface, random: Pcg64Mcg::seed_from_u64(seed) }
    }

    /// So many places in this range of the normalised radius (0 in the middle, 1 at the rim; on a disc the share of the
    /// radius), at least `apart`, a share of the size, from each other.
    pub fn draw(
        &mut self,
        count: usize,
        radii: &Range<f64>,
        apart: f64,
    ) -> Result<Vec<Point3<f64>>, TrustError> {
        let mut places: Vec<Point3<f64>> = Vec::new();
        for _ in 0..TRIES {
            if places.len() == count {
                return Ok(places);
            }
            let Some(place) = self.place(radii) else { continue };
            if places.iter().all(|other| distance(other, &place) >= apart * self.bench.size) {
                places.push(place);
            } else if apart > 0.0 && self.random.random_bool(0.02) {
                // Those before may leave no room for this one.
                places.clear();
            }
        }
        Err(TrustError::NoRoom { count, from: radii.start, to: radii.end, apart })
    }

    /// Two places about `apart`, a share of the size, from each other.
    pub fn pair(&mut self, radii: &Range<f64>, apart: f64) -> Result<[Point3<f64>; 2], TrustError> {
        for _ in 0..TRIES {
            let (Some(a), Some(b)) = (self.place(radii), self.place(radii)) else { continue };
            if (distance(&a, &b) / self.bench.size / apart - 1.0).abs() < 0.03 {
                return Ok([a, b]);
            }
        }
        Err(TrustError::NoRoom { count: 2, from: radii.start, to: radii.end, apart })
    }

    /// How far out a place lies: 0 in the middle, 1 at the rim.
    #[must_use]
    pub fn radius(&self, place: &Point3<f64>) -> f64 {
        self.surface.normalised_radius(*place)
    }

    /// A number from a range.
    pub(super) fn number(&mut self, range: Range<f64>) -> f64 {
        self.random.random_range(range)
    }

    fn place(&mut self, radii: &Range<f64>) -> Option<Point3<f64>> {
        let total = self.areas.last().copied()?;
        let at = self.random.random_range(0.0..total);
        let element = self.areas.partition_point(|&area| area <= at).min(self.areas.len() - 1);
        let [a, b, c] = self.surface.mesh.corners(element);
        let [u, v] = [(); 2].map(|()| self.random.random_range(0.0..1.0));
        let [u, v]: [f64; 2] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let inside = a + (b - a) * u + (c - a) * v;
        let place = if self.surface.is_flat() { inside } else { self.bench.truth.lay([inside.x, inside.y]) };
        let is_seen = distance(&inside, &place) < SEEN * self.bench.size;
        (is_seen && radii.contains(&self.radius(&place))).then_some(place)
    }
}
