//! Frames of other instruments as a board with a patch would have recorded them, for its pipeline.
//!
//! A board measures signed codes; files hold volts, counts, magnitudes or complex voltages. So each value v of a step
//! whose untouched value is r becomes, with the sign s with which the patch adds the step up:
//!
//! ```text
//! code = s Re(v conj(r)) / |r|     normalised data, where signs cancel, so that magnitudes and phases do not matter
//! code = v                         plain data, whose signs must be those of the patch's steps
//! ```
//!
//! times what makes the largest code of the untouched skin half of the range. Ratios of codes are all that counts.

use super::{
    diagnose::dead_below,
    order::{Arrangement, FileIndex, OrderError},
    read::Frames,
};
use dermatome_messages::{clock::now_ns, dermatome::Reference, standard::Header};
use dermatome_recording::frames::{Item, RecordedFrame};
use dermatome_shared::{
    device::MAX_TARE_FRAMES,
    drive::Drive,
    frame::FrameFlags,
    patch::{CombinedInto, Difference, PatchView},
    pipeline::noise::LEAST_FRAMES,
    protocol::FrameStamp,
    units::AdcCode,
};
use num_complex::Complex64;
use std::{collections::VecDeque, ops::Range};

/// Largest code of the untouched skin.
const LARGEST: f64 = 8_388_608.0;
/// End of the range, twice that: codes beyond are saturated.
const END: f64 = 2.0 * LARGEST - 1.0;

/// Frames of the untouched skin.
#[derive(Clone, Copy, Debug)]
pub enum Untouched<'a> {
    /// The first so many of the recording.
    First(usize),
    /// Others, averaged; of more than [`MAX_TARE_FRAMES`] the last ones.
    Apart(&'a Frames),
    /// Others, of which each goes before the frame of its number, which is by itself.
    Each(&'a Frames),
}

/// When frames were taken.
#[derive(Clone, Debug, PartialEq)]
pub enum Times {
    /// So many a second, from 0 on.
    Rate(f64),
    /// s: `[frame]`.
    Each(Vec<f64>),
}

/// Why recorded frames cannot go through a patch's pipeline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// Measurements that are not those of the patch.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// Frames of different instruments.
    #[error("frames hold {frames} measurements, those of the untouched skin {untouched}; they must be equal")]
    Lengths {
        /// In a frame.
        frames: usize,
        /// In an untouched frame.
        untouched: usize,
    },
    /// Nothing is left to replay, or to average.
    #[error(
        "the first {wanted} of {frames} frames are to be the untouched skin; allowed: 1 to {most}, and fewer than all",
        most = MAX_TARE_FRAMES
    )]
    First {
        /// To be averaged.
        wanted: usize,
        /// All.
        frames: usize,
    },
    /// Not one for each.
    #[error("there are {found} {what}; allowed: {frames}, one for each frame")]
    Rows {
        /// Of what.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many frames.
        frames: usize,
    },
    /// Noise cannot be measured.
    #[error(
        "the patch finds contacts in the voltages, by their noise, which takes {LEAST_FRAMES} frames of the \
         untouched skin; one for each frame is for patches that find contacts in the image, as learnt ones do"
    )]
    Noise,
    /// Signs that nobody knows.
    #[error(
        "the frames are complex, and the patch takes plain differences, whose signs these do not tell; allowed: real \
         voltages with their signs, or a patch of normalised data (`inverse.normalised` of the skin file)"
    )]
    Signs,
    /// A skin without voltage.
    #[error("all voltages of the untouched skin are zero (frame {0}, counted from 0)")]
    NoVoltage(usize),
    /// A rate that is none.
    #[error("the rate is {0} frames a second; allowed: above 0 to 1000000")]
    Rate(f64),
    /// A time before the one before it.
    #[error("the time of frame {frame} (counted from 0) is {time} s; allowed: from 0 on, ascending")]
    Time {
        /// The frame.
        frame: usize,
        /// Its time, s.
        time: f64,
    },
}

impl Times {
    /// The time of each frame, s, once they are checked.
    fn of(&self, frames: usize) -> Result<Vec<f64>, ReplayError> {
        match self {
            Self::Rate(rate) if *rate > 0.0 && *rate <= 1e6 => {
                Ok((0..frames).map(|frame| frame as f64 / rate).collect())
            }
            Self::Rate(rate) => Err(ReplayError::Rate(*rate)),
            Self::Each(times) if times.len() != frames => {
                Err(ReplayError::Rows { what: "times", found: times.len(), frames })
            }
            Self::Each(times) => {
                let before = |frame: usize| if frame == 0 { 0.0 } else { times[frame - 1] };
                let is_wrong = |&frame: &usize| !(before(frame)..1e12).contains(&times[frame]);
                match (0..frames).find(is_wrong) {
                    Some(frame) => Err(ReplayError::Time { frame, time: times[frame] }),
                    None => Ok(times.clone()),
                }
            }
        }
    }
}

/// Frames of another instrument as a board with a patch would have recorded them: references, and the frames that they are
/// made of and compared with.
///
/// Where untouched frames are not of the recording itself, they come before those that are compared with them, and are
/// counted as well.
#[derive(Debug)]
pub struct Replay<'a> {
    patch: &'a PatchView<'a>,
    frames: &'a Frames,
    untouched: Untouched<'a>,
    map: Vec<FileIndex>,
    /// s: `[frame]`.
    times: Vec<f64>,
    /// Time between frames, s.
    period: f64,
    /// When the first of all frames came, ns since 1970.
    begun: u64,
    /// What turns values into codes, by the latest reference: `[step]`.
    factors: Vec<Complex64>,
    /// What comes before the next frame.
    waiting: VecDeque<Item>,
    next: usize,
}

impl<'a> Replay<'a> {
    /// Checks all that is to be replayed, and begins with what is untouched.
    pub fn new(
        patch: &'a PatchView<'a>,
        frames: &'a Frames,
        untouched: Untouched<'a>,
        arrangement: &Arrangement,
        times: &Times,
    ) -> Result<Self, ReplayError> {
        let steps: Vec<_> = patch.steps().collect();
        let map = arrangement.index_map(&steps, patch.header.electrodes, frames.measurements)?;
        check(patch, frames, untouched)?;
        let times = times.of(frames.frames)?;
        let period = period(&times).unwrap_or_else(|| 1.0 / f64::from(patch.header.drive.frame_rate));
        let (factors, waiting, begun) = (Vec::new(), VecDeque::new(), now_ns());
        let mut replay =
            Self { patch, frames, untouched, map, times, period, begun, factors, waiting, next: 0 };
        match untouched {
            Untouched::First(count) => {
                replay.tare(frames, 0..count)?;
                replay.next = count;
            }
            Untouched::Apart(others) => {
                replay.tare(others, others.frames - averaged(others)..others.frames)?;
            }
            Untouched::Each(_) => {}
        }
        Ok(replay)
    }

    /// When the first of all frames came, ns since 1970.
    #[must_use]
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// How the skin is driven: as the patch says, with as many frames a second as there are.
    #[must_use]
    pub fn drive(&self) -> Drive {
        Drive { frame_rate: (1.0 / self.period) as f32, ..self.patch.header.drive }
    }

    /// Number and time that a frame has in its file.
    #[must_use]
    pub fn in_file(&self, at: FrameStamp) -> FrameStamp {
        let sequence = at.sequence as usize;
        let number = match self.untouched {
            Untouched::First(_) => sequence,
            Untouched::Apart(others) => sequence.saturating_sub(averaged(others)),
            Untouched::Each(_) => sequence / 2,
        };
        let time = self.times.get(number).copied().unwrap_or_default();
        FrameStamp { sequence: number as u32, timestamp_us: microseconds(time), ..at }
    }

    /// Makes some frames, which come just before the next one, the reference.
    fn tare(&mut self, frames: &Frames, which: Range<usize>) -> Result<(), ReplayError> {
        let rows: Vec<&[Complex64]> = frames.iter().skip(which.start).take(which.len()).collect();
        self.factors = factors(self.patch, &self.map, &rows).ok_or(ReplayError::NoVoltage(which.start))?;
        let at = |place: usize| match self.untouched {
            Untouched::First(_) => Place { number: place, others: 0 },
            Untouched::Apart(_) => Place { number: 0, others: place },
            Untouched::Each(_) => Place { number: self.next, others: self.next },
        };
        let frame = |(place, row): (usize, &&[Complex64])| Item::Frame(Box::new(self.frame(at(place), row)));
        let of_tare: Vec<Item> = rows.iter().enumerate().map(frame).collect();
        let header = Header::default();
        let reference = Reference::new(header, at(0).sequence(), rows.len() as u16, &self.drive());
        self.waiting.extend([Item::Reference(reference)].into_iter().chain(of_tare));
        Ok(())
    }

    /// A frame as a board would have measured it.
    fn frame(&self, place: Place, row: &[Complex64]) -> RecordedFrame {
        let mut flags = FrameFlags::default();
        let mut code = |(place, factor): (&FileIndex, &Complex64)| {
            let code = (row[place.index] * factor).re.round();
            flags.insert_if(FrameFlags::SATURATED, code.abs() > END);
            AdcCode(code.clamp(-END, END) as i32)
        };
        let codes = self.map.iter().zip(&self.factors).map(&mut code).collect();
        let time = self.times[place.number] + self.period * place.others as f64;
        let at = FrameStamp { sequence: place.sequence(), timestamp_us: microseconds(time), flags };
        let since = at.timestamp_us.saturating_sub(microseconds(self.times[0]));
        RecordedFrame {
            at,
            log_time: self.begun.saturating_add(since.saturating_mul(1000)),
            codes: Some([codes, Vec::new()]),
            health: None,
            image: None,
            contacts: None,
        }
    }
}

impl Iterator for Replay<'_> {
    type Item = Result<Item, ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(item) = self.waiting.pop_front() {
            return Some(Ok(item));
        }
        let (number, frames) = (self.next, self.frames);
        let row = frames.iter().nth(number)?;
        let others = match self.untouched {
            Untouched::First(_) => 0,
            Untouched::Apart(others) => averaged(others),
            Untouched::Each(others) => {
                if let Err(error) = self.tare(others, number..number + 1) {
                    self.next = self.frames.frames;
                    return Some(Err(error));
                }
                number + 1
            }
        };
        self.next += 1;
        let frame = Item::Frame(Box::new(self.frame(Place { number, others }, row)));
        self.waiting.push_back(frame);
        self.waiting.pop_front().map(Ok)
    }
}

/// Where a frame is: how many frames of the file and of others come before it.
#[derive(Clone, Copy)]
struct Place {
    number: usize,
    others: usize,
}

impl Place {
    fn sequence(self) -> u32 {
        (self.number + self.others) as u32
    }
}

/// Frames of a reference that are averaged.
fn averaged(others: &Frames) -> usize {
    others.frames.min(MAX_TARE_FRAMES.into())
}

/// Mean time between frames, s; none where they take none.
fn period(times: &[f64]) -> Option<f64> {
    let all = times.last()? - times.first()?;
    Some(all / (times.len() - 1) as f64).filter(|period| *period > 0.0)
}

fn microseconds(seconds: f64) -> u64 {
    (seconds * 1e6).round() as u64
}

fn check(patch: &PatchView<'_>, frames: &Frames, untouched: Untouched<'_>) -> Result<(), ReplayError> {
    let others = match untouched {
        Untouched::First(wanted) => {
            let allowed = 1..=usize::from(MAX_TARE_FRAMES);
            if !allowed.contains(&wanted) || wanted >= frames.frames {
                return Err(ReplayError::First { wanted, frames: frames.frames });
            }
            frames
        }
        Untouched::Apart(others) | Untouched::Each(others) => others,
    };
    if others.measurements != frames.measurements {
        let (frames, untouched) = (frames.measurements, others.measurements);
        return Err(ReplayError::Lengths { frames, untouched });
    }
    if let Untouched::Each(others) = untouched {
        if others.frames != frames.frames {
            let what = "frames of the untouched skin";
            return Err(ReplayError::Rows { what, found: others.frames, frames: frames.frames });
        }
        if patch.header.has_places() {
            return Err(ReplayError::Noise);
        }
    }
    let is_complex = frames.complex || others.complex;
    if is_complex && patch.header.difference == Difference::Plain {
        return Err(ReplayError::Signs);
    }
    Ok(())
}

/// What turns a file's values into codes, given untouched frames: `[step]`; zero for dead steps, none if all are.
fn factors(patch: &PatchView<'_>, map: &[FileIndex], rows: &[&[Complex64]]) -> Option<Vec<Complex64>> {
    let measurements = rows.first()?.len();
    let mean = |m: usize| rows.iter().map(|row| row[m] / rows.len() as f64).sum::<Complex64>();
    let reference: Vec<Complex64> = (0..measurements).map(mean).collect();
    let sizes = map.iter().flat_map(|place| rows.iter().map(|row| row[place.index].norm()));
    let largest = sizes.fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let floor = dead_below(&reference, map);
    let factor = |(place, target): (&FileIndex, CombinedInto)| {
        let r = reference[place.index];
        let sign = |is_other: bool| if is_other { -LARGEST / largest } else { LARGEST / largest };
        match patch.header.difference {
            _ if r.norm() <= floor => Complex64::ZERO,
            Difference::Normalised => r.conj() / r.norm() * sign(target.flipped),
            Difference::Plain => sign(place.flipped).into(),
        }
    };
    Some(map.iter().zip(patch.combination()).map(factor).collect())
}

#[cfg(test)]
mod tests;
