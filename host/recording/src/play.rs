//! Play: recorded frames through a board's own pipeline, with the patch that they were recorded with or another.

use crate::frames::{Item, RecordedFrame};
use dermatome_shared::{
    contact::{Contact, Contacts},
    frame::Frame,
    patch::PatchView,
    pipeline::{self, Outcome, PipelineState},
    protocol::{FrameStamp, PackedImage},
    stimulation::Step,
    units::AdcCode,
};
use std::collections::HashMap;

/// Why frames cannot go through another patch.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlayError {
    /// A step that was not measured.
    #[error(
        "the patch measures step {step} with current through electrodes {}-{} and voltage between {}-{} (counted from 1), \
         which the recording does not hold, nor with current and voltage exchanged",
        electrodes[0], electrodes[1], electrodes[2], electrodes[3]
    )]
    Step {
        /// Its number, from 0.
        step: usize,
        /// Its electrodes, from 1.
        electrodes: [u8; 4],
    },
    /// No raw codes.
    #[error("frame {0} was recorded without its raw codes")]
    NotRaw(u32),
    /// Another number of codes than the recording's own patch has steps.
    #[error("frame {sequence} holds {found} codes; its patch has {steps} steps")]
    Length {
        /// Which frame.
        sequence: u32,
        /// Codes in it.
        found: usize,
        /// Steps of the patch that it was recorded with.
        steps: usize,
    },
}

/// What a board makes of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Which frame, with all that is wrong with it.
    pub at: FrameStamp,
    /// Contacts, in the skin's frame.
    pub contacts: Contacts,
    /// The image.
    pub image: PackedImage,
}

/// Where the codes of a patch's steps are in recorded frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepMap {
    /// Place of the code, and whether its sign is the other: `[step]`.
    places: Vec<(usize, bool)>,
    /// Codes of a recorded frame.
    recorded: usize,
}

impl StepMap {
    /// For frames with the steps `recorded`, and a patch with `wanted` ones: the same electrodes, either way round, or
    /// drive and sense exchanged, which reads the same by reciprocity.
    pub fn new(recorded: &[Step], wanted: &[Step]) -> Result<Self, PlayError> {
        if recorded == wanted {
            let places = (0..recorded.len()).map(|place| (place, false)).collect();
            return Ok(Self { places, recorded: recorded.len() });
        }
        // Where a step is there itself, none that is turned stands for it.
        let mut places: HashMap<[u8; 4], (usize, bool)> =
            recorded.iter().enumerate().map(|(place, step)| (step.to_bytes(), (place, false))).collect();
        for (place, step) in recorded.iter().enumerate() {
            let [a, b, c, d] = step.to_bytes();
            for (pairs, flipped) in [([b, a, d, c], false), ([b, a, c, d], true), ([a, b, d, c], true)] {
                places.entry(pairs).or_insert((place, flipped));
            }
        }
        let of = |(step, wanted): (usize, &Step)| {
            let [a, b, c, d] = wanted.to_bytes();
            let found = places.get(&[a, b, c, d]).or_else(|| places.get(&[c, d, a, b]));
            let electrodes = [a, b, c, d].map(|electrode| electrode + 1);
            found.copied().ok_or(PlayError::Step { step, electrodes })
        };
        let places = wanted.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        Ok(Self { places, recorded: recorded.len() })
    }

    /// A recorded frame as a board with the wanted steps would have measured it.
    pub fn take(&self, recorded: &RecordedFrame) -> Result<Frame, PlayError> {
        let sequence = recorded.at.sequence;
        let raw = recorded.raw().ok_or(PlayError::NotRaw(sequence))?;
        if raw.codes.len() != self.recorded {
            let (found, steps) = (raw.codes.len(), self.recorded);
            return Err(PlayError::Length { sequence, found, steps });
        }
        let of = |codes: &[AdcCode]| {
            let code = |&(place, flipped): &(usize, bool)| {
                let code = codes.get(place)?;
                Some(if flipped { AdcCode(-code.0) } else { *code })
            };
            self.places.iter().filter_map(code).collect()
        };
        Ok(Frame { codes: of(&raw.codes), quadrature: of(&raw.quadrature), ..raw })
    }
}

/// A board's pipeline that is fed by a recording.
#[derive(Debug)]
pub struct Player<'a> {
    patch: &'a PatchView<'a>,
    map: StepMap,
    state: Box<PipelineState>,
    /// Whether a reference has begun: before it nobody knows what the board knew.
    has_begun: bool,
    /// By how much numbers of contacts are higher than here, as the board had had others before.
    before: u32,
    /// Whether that is to be found anew: a board that makes a reference may have started anew, and its numbers with it.
    counts_anew: bool,
}

impl<'a> Player<'a> {
    /// With a patch, for frames that were recorded with these steps.
    pub fn new(patch: &'a PatchView<'a>, recorded: &[Step]) -> Result<Self, PlayError> {
        let wanted: Vec<Step> = patch.steps().collect();
        let map = StepMap::new(recorded, &wanted)?;
        Ok(Self { patch, map, state: Box::default(), has_begun: false, before: 0, counts_anew: true })
    }

    /// Whether there was a reference.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Takes what a recording holds; gives what a board would have said of a frame: nothing before a reference.
    pub fn take(&mut self, item: &Item) -> Result<Option<Played>, PlayError> {
        match item {
            Item::Reference(reference) => {
                self.tare(reference.frames);
                Ok(None)
            }
            Item::Frame(frame) if self.has_begun => self.frame(frame),
            Item::Frame(_) => Ok(None),
        }
    }

    /// The next frames become the reference.
    pub fn tare(&mut self, frames: u16) {
        self.state.clear();
        self.state.start_tare(frames);
        (self.has_begun, self.counts_anew) = (true, true);
    }

    fn frame(&mut self, recorded: &RecordedFrame) -> Result<Option<Played>, PlayError> {
        let mut frame = self.map.take(recorded)?;
        pipeline::recall(&mut self.state, &recorded.health(), &mut frame);
        if pipeline::process(self.patch, &mut self.state, &frame) != Outcome::Image {
            return Ok(None);
        }
        let flags = frame.flags.union(self.state.flags());
        let mut contacts = self.state.contacts().clone();
        self.renumber(&mut contacts, recorded.contacts.as_deref().unwrap_or_default());
        let image = PackedImage::pack(self.state.image());
        Ok(Some(Played { at: FrameStamp { flags, ..recorded.at }, contacts, image }))
    }

    /// Numbers go on from those that the board had given before, as the first contact of both tells.
    fn renumber(&mut self, contacts: &mut Contacts, recorded: &[Contact]) {
        let number = |contact: &Contact| Some(contact.identity?.number);
        let both = contacts.first().and_then(number).zip(recorded.first().and_then(number));
        if let Some((here, there)) = both.filter(|_| self.counts_anew) {
            (self.before, self.counts_anew) = (there.wrapping_sub(here), false);
        }
        let before = self.before;
        let on = |number: u32| number.wrapping_add(before);
        for identity in contacts.iter_mut().filter_map(|contact| contact.identity.as_mut()) {
            identity.number = on(identity.number);
            identity.merged = identity.merged.map(on);
            identity.split_from = identity.split_from.map(on);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    fn step(electrodes: [u8; 4]) -> Step {
        Step::from_bytes(electrodes)
    }

    fn frame(codes: &[i32]) -> RecordedFrame {
        let codes = codes.iter().map(|code| AdcCode(*code)).collect();
        RecordedFrame {
            at: FrameStamp { sequence: 5, timestamp_us: 9, flags: FrameFlags::default() },
            log_time: 0,
            codes: Some([codes, Vec::new()]),
            health: None,
            image: None,
            contacts: None,
        }
    }

    #[test]
    fn codes_are_found_by_their_electrodes_either_way_round_and_by_reciprocity() {
        let recorded = [step([0, 1, 2, 3]), step([1, 2, 4, 5]), step([2, 3, 0, 1])];
        let wanted = [
            step([1, 2, 4, 5]),
            step([1, 2, 5, 4]),
            step([2, 1, 5, 4]),
            step([4, 5, 1, 2]),
            step([4, 5, 2, 1]),
            step([2, 3, 0, 1]),
        ];
        let map = StepMap::new(&recorded, &wanted).unwrap();
        let taken = map.take(&frame(&[10, 20, 30])).unwrap();
        let codes: Vec<i32> = taken.codes.iter().map(|code| code.0).collect();
        assert_eq!(codes, [20, -20, 20, 20, -20, 30], "its own step comes before its twin");
        assert_eq!((taken.sequence, taken.timestamp_us), (5, 9));
    }

    #[test]
    fn steps_that_are_there_either_way_round_stand_for_themselves() {
        let recorded = [[0, 4, 1, 2], [0, 4, 2, 3], [4, 0, 1, 2], [0, 4, 1, 2]].map(step);
        let taken = |wanted: &[Step]| -> Vec<i32> {
            let frame = StepMap::new(&recorded, wanted).unwrap().take(&frame(&[10, 20, -11, 12])).unwrap();
            frame.codes.iter().map(|code| code.0).collect()
        };
        assert_eq!(taken(&recorded), [10, 20, -11, 12]);
        assert_eq!(taken(&[recorded[2], recorded[1]]), [-11, 20]);
    }

    #[test]
    fn a_step_that_was_not_measured_is_named() {
        let error =
            StepMap::new(&[step([0, 1, 2, 3])], &[step([0, 1, 2, 3]), step([0, 1, 3, 4])]).unwrap_err();
        assert_eq!(error, PlayError::Step { step: 1, electrodes: [1, 2, 4, 5] });
        let map = StepMap::new(&[step([0, 1, 2, 3])], &[step([0, 1, 2, 3])]).unwrap();
        assert_eq!(map.take(&frame(&[1, 2])), Err(PlayError::Length { sequence: 5, found: 2, steps: 1 }));
        let none = RecordedFrame { codes: None, ..frame(&[]) };
        assert_eq!(map.take(&none), Err(PlayError::NotRaw(5)));
    }
}
