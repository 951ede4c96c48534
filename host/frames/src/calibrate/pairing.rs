//! Pairing: frames under a loading machine -> one reading for each load.

use super::{Hold, Reading};

/// The part of each hold that counts: behind the skin's settling, and before a machine that is a little early.
const COUNTED: [f64; 2] = [0.5, 0.9];

/// The strongest contact of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strongest {
    /// Mean relative conductivity change over its region of interest.
    pub strength: f64,
    /// Area of the region, mm^2.
    pub area_mm2: f64,
    /// Where it is, m, if that is known.
    pub place: Option<[f64; 3]>,
}

/// Frames in their order, paired with the loads by time: the strongest contact is averaged over the later half of
/// each hold. The last load is held as long as the one before it. A frame without contact has strength 0.
#[derive(Debug)]
pub struct Pairing<'a> {
    loads: &'a [Hold],
    readings: Vec<Reading>,
    hold: Averager,
}

/// A load in whose later half no frame came.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no frame came in the later half of the load at `time_s` = {time_s}; allowed: holds of several frames"
)]
pub struct NoFrames {
    /// When the load was applied, s.
    pub time_s: f64,
}

impl<'a> Pairing<'a> {
    /// Before the first frame.
    #[must_use]
    pub fn new(loads: &'a [Hold]) -> Self {
        Self { loads, readings: Vec::new(), hold: Averager::default() }
    }

    /// Whether all loads have passed.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.readings.len() == self.loads.len()
    }

    /// Takes the next frame, `time` s after the loads' time 0, and gives the readings that it completes.
    pub fn add(&mut self, time: f64, contact: Option<Strongest>) -> Result<&[Reading], NoFrames> {
        let before = self.readings.len();
        while !self.is_complete() && time >= end_of(self.loads, self.readings.len()) {
            let reading = self.hold.finish(self.loads[self.readings.len()])?;
            self.readings.push(reading);
        }
        if let Some(load) = self.loads.get(self.readings.len()) {
            let share = (time - load.time_s) / (end_of(self.loads, self.readings.len()) - load.time_s);
            if (COUNTED[0]..COUNTED[1]).contains(&share) {
                self.hold.0.push(contact);
            }
        }
        Ok(&self.readings[before..])
    }

    /// One reading for each load that has passed.
    #[must_use]
    pub fn into_readings(self) -> Vec<Reading> {
        self.readings
    }
}

/// When a hold ends, s.
pub(super) fn end_of(loads: &[Hold], index: usize) -> f64 {
    match loads.get(index + 1) {
        Some(next) => next.time_s,
        None => 2.0 * loads[index].time_s - index.checked_sub(1).map_or(0.0, |before| loads[before].time_s),
    }
}

/// Contacts of one hold's frames.
#[derive(Debug, Default)]
struct Averager(Vec<Option<Strongest>>);

impl Averager {
    fn finish(&mut self, load: Hold) -> Result<Reading, NoFrames> {
        let contacts = std::mem::take(&mut self.0);
        let strengths = contacts.iter().map(|contact| contact.map_or(0.0, |contact| contact.strength));
        let strength = mean(strengths.clone()).ok_or(NoFrames { time_s: load.time_s })?;
        let variance = mean(strengths.map(|value| (value - strength).powi(2))).unwrap_or_default();
        Ok(Reading {
            pressure_kpa: load.pressure_kpa,
            strength,
            deviation: (variance / contacts.len() as f64).sqrt(),
            area_mm2: mean(contacts.iter().flatten().map(|contact| contact.area_mm2)),
            place: mean_place(&contacts),
        })
    }
}

fn mean_place(contacts: &[Option<Strongest>]) -> Option<[f64; 3]> {
    let places = || contacts.iter().flatten().filter_map(|contact| contact.place);
    let [x, y, z] = [0, 1, 2].map(|axis| mean(places().map(|place| place[axis])));
    Some([x?, y?, z?])
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let count = values.clone().count();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}
