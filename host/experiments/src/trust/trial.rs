//! Trial: a tared board on a bench, frame after frame.

use super::{
    TrustError,
    bench::{Bench, Voltages},
};
use dermatome_shared::{
    contact::Contact, frame::Frame, pipeline::PipelineState, reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::{
    Noise, Rig,
    rig::{Observer, RigError},
};
use nalgebra::{Point3, distance};
use num_complex::Complex64;
use std::ops::Range;

/// A board on a rig with noise.
#[derive(Debug)]
pub struct Trial<'a> {
    bench: &'a Bench,
    board: Observer,
    rig: Rig,
    /// The board's clock, s.
    time: f64,
    /// Number of the latest frame.
    sequence: u32,
    untouched: Voltages,
}

/// What became of fingers that pressed for some frames and were lifted.
#[derive(Clone, Debug)]
pub struct Pressed {
    /// Contacts of each frame with the fingers.
    pub frames: Vec<Vec<Contact>>,
    /// Contacts of the last frame after they were lifted.
    pub left: usize,
}

/// Frames in which fingers press, and for which they are lifted.
pub const PRESSED_FRAMES: usize = 6;
const LIFTED_FRAMES: usize = 3;
/// A filter may take so many frames until a contact is there.
pub(super) const SETTLING_FRAMES: usize = 2;

impl<'a> Trial<'a> {
    /// A board that was tared untouched, at this noise.
    pub fn new(bench: &'a Bench, snr_db: f64, seed: u64) -> Result<Self, TrustError> {
        Self::on(bench, bench.untouched(), snr_db, seed)
    }

    /// The same on another true skin, whose untouched scans meet this.
    pub(super) fn on(
        bench: &'a Bench,
        untouched: Voltages,
        snr_db: f64,
        seed: u64,
    ) -> Result<Self, TrustError> {
        let board = bench.board().clone();
        let rig = Rig::new(bench.skin(), &board.patch(), Noise { snr_db, seed }).map_err(RigError::from)?;
        let mut trial = Self { bench, board, rig, time: 0.0, sequence: 0, untouched };
        trial.tare_untouched();
        Ok(trial)
    }

    /// The same board at other noise, tared anew.
    pub fn change_noise(&mut self, snr_db: f64, seed: u64) {
        self.rig.change_noise(Noise { snr_db, seed });
        self.tare_untouched();
    }

    /// Tares untouched.
    pub fn tare_untouched(&mut self) {
        self.tare(&self.untouched.clone());
    }

    /// Tares on what a scan meets.
    pub fn tare(&mut self, voltages: &[Complex64]) {
        let frames: Vec<_> = (0..DEFAULT_TARE_FRAMES).map(|_| self.scan(voltages, self.period())).collect();
        self.board.tare(&frames);
    }

    /// Time between two frames, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        1.0 / self.bench.frame_rate()
    }

    /// The board's clock, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of the latest frame.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// What the board makes of a frame a period later.
    pub fn see(&mut self, voltages: &[Complex64]) -> &PipelineState {
        self.see_after(voltages, self.period())
    }

    /// What the board makes of a frame so many seconds later: at fewer frames a second a slow scene takes less time.
    pub fn see_after(&mut self, voltages: &[Complex64], seconds: f64) -> &PipelineState {
        let frame = self.scan(voltages, seconds);
        self.board.observe(&frame)
    }

    /// What the board makes of the next frame of the untouched skin.
    pub fn see_untouched(&mut self) -> &PipelineState {
        let frame = self.scan(&self.untouched.clone(), self.period());
        self.board.observe(&frame)
    }

    /// Shows fingers for some frames, and lifts them.
    pub fn press(&mut self, pressed: &[Complex64]) -> Pressed {
        let frames = (0..PRESSED_FRAMES).map(|_| self.see(pressed).contacts().to_vec()).collect();
        let mut left = 0;
        for _ in 0..LIFTED_FRAMES {
            left = self.see_untouched().contacts().len();
        }
        Pressed { frames, left }
    }

    fn scan(&mut self, voltages: &[Complex64], seconds: f64) -> Frame {
        let frame = self.rig.scan(voltages);
        self.time += seconds;
        self.sequence = frame.sequence;
        Frame { timestamp_us: (self.time * 1e6).round() as u64, ..frame }
    }
}

impl Pressed {
    /// Whether there are exactly so many contacts once a filter had its time, and never more before.
    #[must_use]
    pub fn are_exactly(&self, count: usize) -> bool {
        let (first, settled) = self.frames.split_at(SETTLING_FRAMES);
        settled.iter().all(|contacts| contacts.len() == count)
            && first.iter().all(|contacts| contacts.len() <= count)
    }

    /// Contacts of the last frame with the fingers.
    #[must_use]
    pub fn last(&self) -> &[Contact] {
        self.frames.last().map_or(&[], Vec::as_slice)
    }
}

/// Where a contact is, m.
#[must_use]
pub fn place_of(contact: &Contact) -> Point3<f64> {
    Point3::from(contact.position.map(f64::from))
}

/// Whether a contact lies this close, m.
pub(super) fn is_at(contact: &Contact, place: &Point3<f64>, within: f64) -> bool {
    distance(&place_of(contact), place) < within
}

/// Whether the only contact lies this close, m.
pub(super) fn is_one_at(contacts: &[Contact], place: &Point3<f64>, within: f64) -> bool {
    matches!(contacts, [contact] if is_at(contact, place, within))
}

/// What a scan meets as time goes by, straight between moments; as the first and the last before and after them.
#[derive(Clone, Debug)]
pub(super) struct Film(pub(super) Vec<(f64, Voltages)>);

impl Film {
    /// Of moments (s) in ascending order.
    pub(super) fn new(times: impl IntoIterator<Item = f64>, at: impl Fn(f64) -> Voltages) -> Self {
        Self(times.into_iter().map(|time| (time, at(time))).collect())
    }

    /// So many moments, evenly from the start to the end of a time, s.
    pub(super) fn even(time: Range<f64>, count: usize, at: impl Fn(f64) -> Voltages) -> Self {
        let step = (time.end - time.start) / (count.max(2) - 1) as f64;
        Self::new((0..count.max(2)).map(|i| time.start + i as f64 * step), at)
    }

    /// At a time, s.
    pub(super) fn at(&self, time: f64) -> Voltages {
        let next = self.0.partition_point(|(moment, _)| *moment <= time);
        match (next.checked_sub(1).and_then(|before| self.0.get(before)), self.0.get(next)) {
            (Some((from, a)), Some((to, b))) => {
                let share = (time - from) / (to - from);
                a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect()
            }
            (Some((_, only)), None) | (None, Some((_, only))) => only.clone(),
            (None, None) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_is_straight_between_its_moments_and_stands_still_outside() {
        let film = Film::even(1.0..3.0, 3, |time| vec![Complex64::from(time * time)]);
        for (time, value) in
            [(0.0, 1.0), (1.0, 1.0), (1.5, 2.5), (2.0, 4.0), (2.5, 6.5), (3.0, 9.0), (7.0, 9.0)]
        {
            assert!((film.at(time)[0].re - value).abs() < 1e-12, "{time}: {}", film.at(time)[0]);
        }
    }

    #[test]
    fn contacts_may_come_late_but_not_twice() {
        let contact = Contact {
            position: [0.01, 0.0, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 1e-4,
            strength: 1.0,
            peak: 1.0,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        let pressed = |counts: [usize; 6]| Pressed {
            frames: counts.map(|count| vec![contact; count]).to_vec(),
            left: 0,
        };
        assert!(pressed([0, 0, 1, 1, 1, 1]).are_exactly(1) && pressed([1; 6]).are_exactly(1));
        assert!(!pressed([0, 2, 1, 1, 1, 1]).are_exactly(1) && !pressed([1, 1, 1, 0, 1, 1]).are_exactly(1));
        assert!(is_one_at(pressed([1; 6]).last(), &Point3::new(0.0, 0.0, 0.0), 0.011));
        assert!(!is_one_at(pressed([2; 6]).last(), &Point3::new(0.0, 0.0, 0.0), 0.011));
    }
}
