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
        Self {
            steps: patch.header.steps.into(),
            pixels: patch.header.pixels.into(),
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
