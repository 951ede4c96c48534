//! A board that plays a recording: every command that takes a port works on it as on the board that it is of.

use super::{BoardError, BoardOptions, SimulatedBoard};
use crate::instrument::{Instrument, Recalled, ScanTable};
use dermatome_recording::{
    frames::{Frames, Item},
    play::{PlayError, StepMap},
    read::{ReadError, Recording},
};
use dermatome_shared::{
    drive::Drive,
    frame::Frame,
    patch::{PatchError, PatchView},
    protocol::FrameSource,
    stimulation::Step,
};
use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

/// Why a recording is not played.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It is none.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its patch is of another version of this program, or damaged.
    #[error("recording `{}`: its patch: {reason}", path.display())]
    Patch {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: PatchError,
    },
    /// The patch to play it with measures what it does not hold.
    #[error("recording `{}`: {reason}", path.display())]
    Steps {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: PlayError,
    },
    /// Nothing in it makes a reference.
    #[error("recording `{}` holds no reference: it ends before the board had one", .0.display())]
    NoReference(PathBuf),
    /// The board does not start.
    #[error(transparent)]
    Board(#[from] BoardError),
}

/// A board that holds the recording's patch, or `patch`, and plays its frames while somebody streams: each stream goes on
/// where the one before has ended, and behind the end it begins anew.
pub fn board_for_recording(
    path: &Path,
    patch: Option<Vec<u8>>,
    listen: SocketAddr,
) -> Result<SimulatedBoard, ReplayError> {
    let (tape, session_patch, source) = Tape::open(path)?;
    let patch = patch.unwrap_or(session_patch);
    let refuse = |reason| ReplayError::Patch { path: path.to_owned(), reason };
    let view = PatchView::validate(&patch).map_err(refuse)?;
    let wanted: Vec<Step> = view.steps().collect();
    StepMap::new(&tape.recorded, &wanted)
        .map_err(|reason| ReplayError::Steps { path: path.to_owned(), reason })?;
    let (electrodes, drive) = (view.header.electrodes, tape.drive);
    let options = BoardOptions {
        listen,
        electrodes,
        patch: Some(patch),
        name: "replay",
        frame_source: source,
        drive: Some(drive),
        ..BoardOptions::default()
    };
    Ok(SimulatedBoard::start(options, tape)?)
}

/// A recording that is played over and over.
struct Tape {
    path: PathBuf,
    /// None where it has come to its end.
    frames: Option<Frames>,
    /// The first reference, which is still to be told.
    ahead: Option<Item>,
    /// Steps of the patch that it was recorded with.
    recorded: Vec<Step>,
    /// How the skin was driven.
    drive: Drive,
    /// For these steps.
    map: Option<(Vec<Step>, StepMap)>,
}

impl Tape {
    fn open(path: &Path) -> Result<(Self, Vec<u8>, FrameSource), ReplayError> {
        let recording = Recording::open(path)?;
        let session = recording.session();
        let (patch, source) = (session.patch.clone(), session.frame_source);
        let refuse = |reason| ReplayError::Patch { path: path.to_owned(), reason };
        let recorded = PatchView::validate(&patch).map_err(refuse)?.steps().collect();
        let (frames, reference) = from_reference(recording)?;
        let Item::Reference(of) = &reference else { return Err(ReplayError::NoReference(path.to_owned())) };
        let drive = of.drive();
        let (path, frames) = (path.to_owned(), Some(frames));
        let tape = Self { path, frames, ahead: Some(reference), recorded, drive, map: None };
        Ok((tape, patch, source))
    }

    /// What comes next, from the first reference on; none at the end.
    fn next(&mut self) -> Result<Option<Item>, ReplayError> {
        if let Some(item) = self.ahead.take() {
            return Ok(Some(item));
        }
        let Some(frames) = &mut self.frames else {
            let (frames, reference) = from_reference(Recording::open(&self.path)?)?;
            self.frames = Some(frames);
            return Ok(Some(reference));
        };
        let item = frames.next_item()?;
        if item.is_none() {
            self.frames = None;
        }
        Ok(item)
    }

    /// Where the codes of a table's steps are in the recording's.
    fn map(&mut self, table: &ScanTable) -> Result<&StepMap, PlayError> {
        if self.map.as_ref().is_none_or(|(steps, _)| *steps != table.steps) {
            let map = StepMap::new(&self.recorded, &table.steps)?;
            self.map = Some((table.steps.clone(), map));
        }
        self.map.as_ref().map(|(_, map)| map).ok_or(PlayError::NotRaw(0))
    }

    fn recalled(&mut self, table: &ScanTable) -> Result<Recalled, String> {
        loop {
            return Ok(match self.next().map_err(|error| error.to_string())? {
                None => Recalled::End,
                Some(Item::Reference(reference)) => Recalled::Tare(reference.frames),
                Some(Item::Frame(frame)) => {
                    let vitals = frame.health.as_ref().map(|report| report.vitals).unwrap_or_default();
                    match self.map(table).and_then(|map| map.take(&frame)) {
                        Ok(raw) => Recalled::Frame(Box::new((raw, frame.health(), vitals))),
                        // Recorded without its codes: as if it had been lost.
                        Err(PlayError::NotRaw(_)) => continue,
                        Err(error) => return Err(error.to_string()),
                    }
                }
            });
        }
    }
}

/// The frames behind a recording's first reference, and that.
fn from_reference(recording: Recording) -> Result<(Frames, Item), ReplayError> {
    let path = recording.path().to_owned();
    let mut frames = Frames::of(recording);
    while let Some(item) = frames.next_item()? {
        if matches!(item, Item::Reference(_)) {
            return Ok((frames, item));
        }
    }
    Err(ReplayError::NoReference(path))
}

impl Instrument for Tape {
    /// Never asked: all comes from the recording.
    fn scan(&mut self, _: &ScanTable, _: Option<f64>) -> Frame {
        Frame::default()
    }

    fn recall(&mut self, table: &ScanTable) -> Option<Recalled> {
        Some(self.recalled(table).unwrap_or_else(|error| {
            log::error!("the recording ends here: {error}");
            self.frames = None;
            Recalled::End
        }))
    }
}
