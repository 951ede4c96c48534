//! Instrument: what measures a skin, slot by slot, and makes frames of it.

use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    frame::Frame,
    health::{Health, Vitals},
    patch::PatchView,
    protocol::SlotSamples,
    scan::{Timing, slots},
    stimulation::Step,
};

/// What measures a skin.
pub trait Instrument: Send {
    /// One scan: a code per step, without number and time, which are the board's. `script_time` is `None` while
    /// nothing is streamed or the board has no reference yet (skin untouched), else the time since streaming
    /// started, s.
    ///
    /// A frame with another number of codes than steps is dropped, as on a real board.
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame;

    /// What it does to a voltage, if it measures electrodes and can show samples.
    fn front_end(&self) -> Option<FrontEnd> {
        None
    }

    /// What comes next of a recording that is played instead of measuring; none of an instrument that measures.
    fn recall(&mut self, _: &ScanTable) -> Option<Recalled> {
        None
    }

    /// The first samples of one slot of the table; none if it has none to show.
    fn samples(&mut self, _: &ScanTable, _slot: u16, _: Timing, _: Option<f64>) -> Option<SlotSamples> {
        None
    }
}

impl<I: Instrument + ?Sized> Instrument for Box<I> {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        (**self).scan(table, script_time)
    }

    fn front_end(&self) -> Option<FrontEnd> {
        (**self).front_end()
    }

    fn recall(&mut self, table: &ScanTable) -> Option<Recalled> {
        (**self).recall(table)
    }

    fn samples(
        &mut self,
        table: &ScanTable,
        slot: u16,
        timing: Timing,
        script_time: Option<f64>,
    ) -> Option<SlotSamples> {
        (**self).samples(table, slot, timing, script_time)
    }
}

/// What comes next of a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Recalled {
    /// So many frames from here on become a new reference.
    Tare(u16),
    /// A frame, with its time and its flags, and what was found in it then.
    Frame(Box<(Frame, Health, Vitals)>),
    /// Nothing more: what is asked for next is its start again.
    End,
}

/// What a scan measures, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanTable {
    /// The patch's steps.
    pub steps: Vec<Step>,
    /// A test of each electrode.
    pub tests: Vec<Step>,
    /// How the skin is driven.
    pub drive: Drive,
}

impl ScanTable {
    /// The scan of a patch under a drive.
    #[must_use]
    pub fn new(patch: &PatchView<'_>, drive: Drive) -> Self {
        let mut steps = slots(patch).to_vec();
        let tests = steps.split_off(usize::from(patch.header.steps).min(steps.len()));
        Self { steps, tests, drive }
    }

    /// The scan of a patch under its own drive.
    #[must_use]
    pub fn of_patch(patch: &PatchView<'_>) -> Self {
        Self::new(patch, patch.header.drive)
    }

    /// All slots: the steps come first, then the tests.
    #[must_use]
    pub fn slots(&self) -> Vec<Step> {
        self.steps.iter().chain(&self.tests).copied().collect()
    }

    /// Frames per second.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.drive.frame_rate.into()
    }
}
