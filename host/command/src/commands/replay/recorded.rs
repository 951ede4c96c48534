//! Recordings of our own boards, through the pipeline of their patch or of another one.

use super::{Args, Counted, Tally, pose, show};
use crate::commands::{interrupt, patch_id, playing::Playing};
use anyhow::Context;
use dermatome_link::{pose::Pose, words::escaped_lines};
use dermatome_model::skin::Description;
use dermatome_recording::{
    frames::{Frames, Item, RecordedFrame},
    play::Played,
    read::{Ending, Recording},
    session::Session,
};
use dermatome_shared::{contact::Contacts, patch::PatchView};
use serde::Serialize;
use std::path::Path;

/// What `replay` tells of a recording; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    recording: String,
    recorded_at: &'a str,
    recorded_board: &'a str,
    recorded_firmware: &'a str,
    recorded_with: String,
    patch_crc: String,
    skin: &'a str,
    link: Option<&'a str>,
    /// Whether it ends as it was meant to.
    is_whole: bool,
    /// Frames before the first reference, of which nobody knows what the board knew.
    frames_before_reference: u64,
    same: Option<Same>,
    #[serde(flatten)]
    tally: Tally,
}

/// How far the replay is what the board sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
struct Same {
    images_compared: u64,
    images_differ: u64,
    contacts_compared: u64,
    contacts_differ: u64,
    /// Sequence of the first frame that differs.
    first_to_differ: Option<u32>,
    /// Frames that are missing in the recording, after which nothing need be the same.
    frames_missing: u64,
}

pub(super) fn run(args: &Args, path: &Path, patch: Option<&(Vec<u8>, String)>) -> anyhow::Result<()> {
    let recording = Recording::open(path)?;
    let session = recording.session().clone();
    let file = || format!("recording `{}`", path.display());
    let own = PatchView::validate(&session.patch).with_context(|| format!("{}: its patch", file()))?;
    let other = patch.map(|(bytes, name)| PatchView::validate(bytes).with_context(|| name.clone()));
    let other = other.transpose()?;
    let used = other.as_ref().unwrap_or(&own);
    let recorded_pose = pose_of(&session)?;
    let pose = pose(args, used)?;
    let steps: Vec<_> = own.steps().collect();
    let mut playing = Playing::new(used, &steps).with_context(file)?;
    if let Some(file) = args.record.file() {
        let pose_of_places = pose.as_ref().or(recorded_pose.as_ref());
        playing.record(file, &of_replay(args, &session, used)?, pose_of_places, recording.begun())?;
    }
    let mut same = (own.crc() == used.crc()).then(Same::default);
    let (mut counted, mut before, mut last) = (Counted::default(), 0, None);
    let mut frames = Frames::of(recording);
    while let Some(item) = frames.next_item()? {
        let played = playing.take(&item).with_context(file)?;
        let Item::Frame(recorded) = item else { continue };
        before += u64::from(!playing.has_begun());
        if let Some(same) = &mut same {
            same.follow(&mut last, recorded.at.sequence);
        }
        let Some(played) = played else {
            if interrupt::requested() {
                break;
            }
            continue;
        };
        if let Some(same) = &mut same {
            same.compare(&recorded, &played, recorded_pose.as_ref());
        }
        if !counted.show(played.at, &played.contacts, |at, contacts| show(pose.as_ref(), at, contacts))? {
            break;
        }
    }
    let ending = frames.recording().ending().clone();
    let tally = counted.end();
    tell(&session, before, &ending, same.as_ref());
    playing.finish()?;
    args.json.write(&Report {
        recording: path.display().to_string(),
        recorded_at: &session.port,
        recorded_board: &session.board,
        recorded_firmware: &session.firmware,
        recorded_with: patch_id(own.crc()),
        patch_crc: patch_id(used.crc()),
        skin: &used.header.skin,
        link: pose.as_ref().map(|pose| pose.link.as_str()),
        is_whole: ending == Ending::Whole,
        frames_before_reference: before,
        same,
        tally,
    })
}

/// The pose by which contacts were recorded.
fn pose_of(session: &Session) -> anyhow::Result<Option<Pose>> {
    let Some(text) = &session.skin_file else { return Ok(None) };
    Ok(Description::parse(Path::new("skin.toml"), text).context("the skin file in the recording")?.pose)
}

/// What a recording of the replay is of.
fn of_replay(args: &Args, session: &Session, patch: &PatchView<'_>) -> anyhow::Result<Session> {
    let given = args.skin.as_deref().map(std::fs::read_to_string).transpose();
    Ok(Session {
        patch: patch.bytes().to_vec(),
        skin: patch.header.skin.as_str().to_owned(),
        skin_file: given
            .context("cannot read the skin file once more")?
            .or_else(|| session.skin_file.clone()),
        ..session.clone()
    })
}

impl Same {
    /// Counts frames that are not there.
    fn follow(&mut self, last: &mut Option<u32>, sequence: u32) {
        if let Some(last) = last.replace(sequence) {
            let ahead = sequence.wrapping_sub(last);
            self.frames_missing += u64::from(ahead.saturating_sub(1)) * u64::from(ahead < u32::MAX / 2);
        }
    }

    fn compare(&mut self, recorded: &RecordedFrame, played: &Played, pose: Option<&Pose>) {
        let placed: Contacts = match pose {
            Some(pose) => played.contacts.iter().map(|contact| pose.contact(contact)).collect(),
            None => played.contacts.clone(),
        };
        let contacts = recorded.contacts.as_ref().map(|contacts| contacts[..] == placed[..]);
        let image = recorded.image.as_ref().map(|image| *image == played.image);
        let stamp = recorded.at == played.at;
        self.contacts_compared += u64::from(contacts.is_some());
        self.images_compared += u64::from(image.is_some());
        self.contacts_differ += u64::from(contacts.is_some_and(|same| !(same && stamp)));
        self.images_differ += u64::from(image == Some(false));
        if contacts == Some(false) || image == Some(false) || !stamp {
            self.first_to_differ.get_or_insert(recorded.at.sequence);
        }
    }
}

fn tell(session: &Session, before: u64, ending: &Ending, same: Option<&Same>) {
    // A file's names are only words.
    let board = escaped_lines(&session.board);
    if before > 0 {
        eprintln!("{before} frames before the first reference were left out");
    }
    match ending {
        Ending::Whole | Ending::Unknown => {}
        Ending::Cut => eprintln!("the recording was cut off; all before its last whole second was replayed"),
        Ending::Damaged(reason) => eprintln!("warning: the recording is damaged, and ends there: {reason}"),
    }
    let Some(Same { images_compared, contacts_compared, first_to_differ, frames_missing, .. }) = same else {
        return;
    };
    match first_to_differ {
        None => eprintln!(
            "the same as {board} sent, bit for bit: {images_compared} images, contacts of {contacts_compared} frames"
        ),
        Some(sequence) => {
            let why = if *frames_missing > 0 {
                format!("{frames_missing} frames are missing in the recording")
            } else {
                "another version of this program recorded it, or the board did".to_owned()
            };
            eprintln!("from frame {sequence} on it differs from what {board} sent: {why}");
        }
    }
}
