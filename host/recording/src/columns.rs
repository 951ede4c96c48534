//! Columns: frames of a recording side by side, a row each, for programs that work on many at once.

use crate::{
    frames::{Item, Parts, RecordedFrame},
    read::Problem,
};
use dermatome_shared::{contact::Contact, patch::PatchView, protocol::FrameStamp, units::AdcCode};

/// Stands where a frame's codes were not recorded: no converter gives it.
pub const NO_CODE: i32 = i32::MIN;

/// Frames side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Codes of a frame, by the recording's patch.
    pub steps: usize,
    /// Pixels of an image, likewise.
    pub pixels: usize,
    /// Which: `[frame]`.
    pub at: Vec<FrameStamp>,
    /// When it came, by the host's clock, ns since 1970: `[frame]`.
    pub log_times: Vec<u64>,
    /// References that had begun by then: `[frame]`; 0 for a frame before the first.
    pub references: Vec<u32>,
    /// Codes in phase, or [`NO_CODE`]: `[frame][step]`.
    pub in_phase: Vec<i32>,
    /// Codes in quadrature, or [`NO_CODE`]: `[frame][step]`.
    pub quadrature: Vec<i32>,
    /// Relative conductivity change, or NaN where the board made no image: `[frame][pixel]`.
    pub images: Vec<f32>,
    /// Contacts of all frames, each with the row of its frame.
    pub contacts: Vec<(usize, Contact)>,
    begun: u32,
    wanted: Parts,
}

impl Columns {
    /// For frames that were recorded with this patch; columns of parts that are not wanted stay empty.
    #[must_use]
    pub fn new(patch: &PatchView<'_>, wanted: Parts) -> Self {
        Self::of(patch.header.steps.into(), patch.header.pixels.into(), wanted)
    }

    fn of(steps: usize, pixels: usize, wanted: Parts) -> Self {
        Self {
            steps,
            pixels,
            at: Vec::new(),
            log_times: Vec::new(),
            references: Vec::new(),
            in_phase: Vec::new(),
            quadrature: Vec::new(),
            images: Vec::new(),
            contacts: Vec::new(),
            begun: 0,
            wanted,
        }
    }

    /// Parts whose columns are filled.
    #[must_use]
    pub fn wanted(&self) -> Parts {
        self.wanted
    }

    /// Takes what comes next of a recording.
    pub fn take(&mut self, item: &Item) -> Result<(), Problem> {
        match item {
            Item::Reference(_) => self.begun += 1,
            Item::Frame(frame) => self.frame(frame)?,
        }
        Ok(())
    }

    fn frame(&mut self, frame: &RecordedFrame) -> Result<(), Problem> {
        let Self { steps, pixels, wanted, .. } = *self;
        let check = |what, found, expected| {
            let sequence = frame.at.sequence;
            if found == expected { Ok(()) } else { Err(Problem::Size { sequence, what, found, expected }) }
        };
        let [in_phase, quadrature] = frame.codes.as_ref().map_or([None; 2], |[a, b]| [Some(a), Some(b)]);
        // A board that does not measure it has none.
        let quadrature = quadrature.filter(|codes| !codes.is_empty());
        in_phase.map_or(Ok(()), |codes| check("codes", codes.len(), steps))?;
        quadrature.map_or(Ok(()), |codes| check("codes in quadrature", codes.len(), steps))?;
        let image = frame.image.as_ref();
        image.map_or(Ok(()), |image| check("pixels", image.mantissas.len(), pixels))?;

        let row = self.at.len();
        self.at.push(frame.at);
        self.log_times.push(frame.log_time);
        self.references.push(self.begun);
        if wanted.codes {
            put_codes(&mut self.in_phase, in_phase, steps);
            put_codes(&mut self.quadrature, quadrature, steps);
        }
        match image.filter(|_| wanted.images) {
            Some(image) => self.images.extend(image.values().map(|value| value as f32)),
            None if wanted.images => self.images.resize(self.images.len() + pixels, f32::NAN),
            None => {}
        }
        let contacts = frame.contacts.iter().flatten().filter(|_| wanted.contacts);
        self.contacts.extend(contacts.map(|contact| (row, *contact)));
        Ok(())
    }
}

fn put_codes(column: &mut Vec<i32>, codes: Option<&Vec<AdcCode>>, steps: usize) {
    match codes {
        Some(codes) => column.extend(codes.iter().map(|code| code.0)),
        None => column.resize(column.len() + steps, NO_CODE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::protocol::PackedImage;

    fn frame(sequence: u32, codes: Option<[&[i32]; 2]>, image: Option<i16>) -> Item {
        let list = |codes: &[i32]| codes.iter().copied().map(AdcCode).collect();
        Item::Frame(Box::new(RecordedFrame {
            at: FrameStamp { sequence, timestamp_us: 20, flags: Default::default() },
            log_time: 7,
            codes: codes.map(|codes| codes.map(list)),
            health: None,
            image: image
                .map(|mantissa| PackedImage { exponent: 3, mantissas: [mantissa].into_iter().collect() }),
            contacts: None,
        }))
    }

    #[test]
    fn each_frame_has_a_row_and_what_it_does_not_hold_says_so() {
        let mut columns = Columns::of(2, 1, Parts::ALL);
        columns.take(&frame(1, Some([&[5, -6], &[]]), None)).unwrap();
        columns.take(&Item::Reference(Default::default())).unwrap();
        columns.take(&frame(2, None, Some(4))).unwrap();
        columns.take(&frame(3, Some([&[7, 8], &[9, 10]]), Some(-4))).unwrap();
        assert_eq!(columns.in_phase, [5, -6, NO_CODE, NO_CODE, 7, 8]);
        assert_eq!(columns.quadrature, [NO_CODE, NO_CODE, NO_CODE, NO_CODE, 9, 10]);
        assert!(columns.images[0].is_nan());
        assert_eq!(columns.images[1..], [0.5, -0.5]);
        assert_eq!(columns.references, [0, 1, 1]);
        assert_eq!(columns.at.iter().map(|at| at.sequence).collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn columns_that_nobody_wants_stay_empty() {
        let mut columns = Columns::of(2, 1, Parts::NONE);
        columns.take(&frame(1, Some([&[5, -6], &[]]), Some(4))).unwrap();
        assert_eq!((columns.at.len(), columns.in_phase.len(), columns.images.len()), (1, 0, 0));
    }

    #[test]
    fn a_frame_that_the_patch_does_not_fit_is_refused_and_named() {
        let mut columns = Columns::of(2, 1, Parts::ALL);
        let problem = columns.take(&frame(9, Some([&[1, 2, 3], &[]]), None)).unwrap_err();
        assert_eq!(problem.to_string(), "frame 9 holds 3 codes; its patch has 2");
        assert!(columns.at.is_empty());
    }
}
