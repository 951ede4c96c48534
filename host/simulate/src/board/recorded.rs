//! A board that plays a recording: every command that takes a port works on it as on the board that it is of.

use super::{BoardError, BoardOptions, SimulatedBoard};
use crate::instrument::{Instrument, Recalled, ScanTable};
use dermatome_messages::dermatome::Reference;
use dermatome_recording::{
    frames::{Frames, Item},
    play::{PlayError, StepMap},
    read::{ReadError, Recording},
    session::Session,
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
    sync::Arc,
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
    /// The patch that frames are to be played with is none.
    #[error("the patch: {0}")]
    GivenPatch(PatchError),
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
    let recording = Recording::open(path)?;
    let Session { patch: own, frame_source, .. } = recording.session().clone();
    let (_, reference) = from_reference(recording)?;
    let refuse = |reason| ReplayError::Patch { path: path.to_owned(), reason };
    let recorded: Vec<Step> = PatchView::validate(&own).map_err(refuse)?.steps().collect();
    let patch = patch.unwrap_or(own);
    let view = PatchView::validate(&patch).map_err(refuse)?;
    let wanted: Vec<Step> = view.steps().collect();
    StepMap::new(&recorded, &wanted)
        .map_err(|reason| ReplayError::Steps { path: path.to_owned(), reason })?;
    let file = path.to_owned();
    let tape = Tape::new(recorded, move || {
        let (mut frames, reference) = from_reference(Recording::open(&file)?)?;
        let reference = Item::Reference(reference);
        let rest = std::iter::from_fn(move || frames.next_item().map_err(ReplayError::from).transpose());
        Ok(Box::new(std::iter::once(Ok(reference)).chain(rest)))
    });
    let electrodes = view.header.electrodes;
    start(tape, Played { patch, electrodes, frame_source, drive: reference.drive() }, listen)
}

/// The same of frames that come from no board, as one with `patch` would have recorded them, driven like this.
pub fn board_for_items(
    items: Vec<Item>,
    patch: Vec<u8>,
    drive: Drive,
    listen: SocketAddr,
) -> Result<SimulatedBoard, ReplayError> {
    let view = PatchView::validate(&patch).map_err(ReplayError::GivenPatch)?;
    let (electrodes, steps) = (view.header.electrodes, view.steps().collect());
    let items: Arc<[Item]> = items.into();
    let tape = Tape::new(steps, move || {
        let items = items.clone();
        Ok(Box::new((0..items.len()).map(move |place| Ok(items[place].clone()))))
    });
    start(tape, Played { patch, electrodes, frame_source: FrameSource::Skin, drive }, listen)
}

/// What a board plays with.
struct Played {
    patch: Vec<u8>,
    electrodes: u8,
    frame_source: FrameSource,
    drive: Drive,
}

fn start(tape: Tape, played: Played, listen: SocketAddr) -> Result<SimulatedBoard, ReplayError> {
    let Played { patch, electrodes, frame_source, drive } = played;
    let options = BoardOptions {
        listen,
        electrodes,
        patch: Some(patch),
        name: "replay",
        frame_source,
        drive: Some(drive),
        ..BoardOptions::default()
    };
    Ok(SimulatedBoard::start(options, tape)?)
}

/// What is played, from its first reference on.
type Items = Box<dyn Iterator<Item = Result<Item, ReplayError>> + Send>;

/// A recording that is played over and over.
struct Tape {
    rewind: Box<dyn Fn() -> Result<Items, ReplayError> + Send>,
    /// None where it is at its start.
    items: Option<Items>,
    /// Steps of the patch that it was recorded with.
    recorded: Vec<Step>,
    /// For these steps.
    map: Option<(Vec<Step>, StepMap)>,
}

impl Tape {
    fn new(recorded: Vec<Step>, rewind: impl Fn() -> Result<Items, ReplayError> + Send + 'static) -> Self {
        Self { rewind: Box::new(rewind), items: None, recorded, map: None }
    }

    /// What comes next, from the first reference on; none at the end.
    fn next(&mut self) -> Result<Option<Item>, ReplayError> {
        let items = match &mut self.items {
            Some(items) => items,
            none => none.insert((self.rewind)()?),
        };
        let item = items.next().transpose()?;
        if item.is_none() {
            self.items = None;
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
fn from_reference(recording: Recording) -> Result<(Frames, Reference), ReplayError> {
    let path = recording.path().to_owned();
    let mut frames = Frames::of(recording);
    while let Some(item) = frames.next_item()? {
        if let Item::Reference(reference) = item {
            return Ok((frames, reference));
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
            self.items = None;
            Recalled::End
        }))
    }
}
