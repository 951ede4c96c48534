//! Recorded frames through a board's own pipeline: what a board with a patch would have said of them.
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
use dermatome_shared::{
    contact::Contacts,
    device::MAX_TARE_FRAMES,
    frame::{Frame, FrameFlags},
    patch::{CombinedInto, Difference, PatchView},
    pipeline::{Outcome, PipelineState, noise::LEAST_FRAMES, sense},
    protocol::FrameStamp,
    units::AdcCode,
};
use num_complex::Complex64;
use std::ops::Range;

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

/// Recorded frames on their way through the pipeline of a patch: gives stamp and contacts of each that is not of the
/// untouched skin. Numbers and times are those of the recording.
#[derive(Debug)]
pub struct Replay<'a> {
    patch: &'a PatchView<'a>,
    frames: &'a Frames,
    untouched: Untouched<'a>,
    map: Vec<FileIndex>,
    times: Vec<f64>,
    steps: Vec<Complex64>,
    state: Box<PipelineState>,
    next: usize,
}

impl<'a> Replay<'a> {
    /// Checks all that is to be replayed, and averages what is untouched.
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
        let (steps, state) = (Vec::new(), Box::default());
        let mut replay = Self { patch, frames, untouched, map, times, steps, state, next: 0 };
        match untouched {
            Untouched::First(count) => {
                replay.next = count;
                replay.tare(frames, 0..count)?;
            }
            Untouched::Apart(others) => {
                replay.tare(others, others.frames.saturating_sub(MAX_TARE_FRAMES.into())..others.frames)?;
            }
            Untouched::Each(_) => {}
        }
        Ok(replay)
    }

    /// Makes some frames, which come just before the next one, the reference.
    fn tare(&mut self, frames: &Frames, which: Range<usize>) -> Result<(), ReplayError> {
        let rows: Vec<&[Complex64]> = frames.iter().skip(which.start).take(which.len()).collect();
        self.steps = factors(self.patch, &self.map, &rows).ok_or(ReplayError::NoVoltage(which.start))?;
        self.state.clear();
        self.state.start_tare(rows.len() as u16);
        for (row, before) in rows.iter().zip((1..=rows.len()).rev()) {
            let frame = Frame { timestamp_us: self.board_time(self.next, before), ..self.frame(row) };
            sense(self.patch, &mut self.state, &frame);
        }
        Ok(())
    }

    /// Time so many frames before one of the recording, which begins so late that all untouched frames come after 0.
    fn board_time(&self, frame: usize, before: usize) -> u64 {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let period = (last - first) / (self.times.len() - 1).max(1) as f64;
        let before = f64::from(MAX_TARE_FRAMES) - before as f64;
        microseconds(self.times[frame] - first + period * before)
    }

    /// A frame as a board would have measured it.
    fn frame(&self, row: &[Complex64]) -> Frame {
        let mut frame = Frame::default();
        for (place, factor) in self.map.iter().zip(&self.steps) {
            let code = (row[place.index] * factor).re.round();
            frame.flags.insert_if(FrameFlags::SATURATED, code.abs() > END);
            // There are no more steps than a patch has.
            let _ = frame.codes.push(AdcCode(code.clamp(-END, END) as i32));
        }
        frame
    }
}

impl Iterator for Replay<'_> {
    type Item = Result<(FrameStamp, Contacts), ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.next;
        let row = self.frames.iter().nth(number)?;
        if let Untouched::Each(others) = self.untouched
            && let Err(error) = self.tare(others, number..number + 1)
        {
            return Some(Err(error));
        }
        self.next += 1;
        let frame =
            Frame { sequence: number as u32, timestamp_us: self.board_time(number, 0), ..self.frame(row) };
        let outcome = sense(self.patch, &mut self.state, &frame);
        debug_assert_eq!(outcome, Outcome::Image);
        let flags = frame.flags.union(self.state.flags());
        let at =
            FrameStamp { sequence: number as u32, timestamp_us: microseconds(self.times[number]), flags };
        Some(Ok((at, self.state.contacts().clone())))
    }
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
