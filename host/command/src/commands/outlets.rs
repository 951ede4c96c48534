//! Outlets: where a board's frames go beside this command's own output: into a recording, and to whoever looks on.

use super::outputs::{Kind, Output};
use anyhow::Context;
use dermatome_link::{Link, LinkError, ScanFrame, pose::Pose};
use dermatome_messages::{
    Packed, Topic, cdr,
    clock::now_ns,
    dermatome::{Reference, Status},
    frame::{Outlook, Place, ScopeTiming},
    scene::{ERROR, Scene, WARN, transform, transforms},
    skin::{Look, skin},
};
use dermatome_page::Speaker;
use dermatome_recording::{
    frames::{Item, RecordedFrame},
    session::Session,
    write::{Recorded, Recorder},
};
use dermatome_shared::{
    device::MAX_TARE_FRAMES,
    drive::Drive,
    patch::PatchView,
    pipeline::UNFIT,
    protocol::{PROTOCOL_VERSION, Request},
    reference::DEFAULT_TARE_FRAMES,
    scan::Timing,
};
use std::path::Path;

/// Records what the board sends.
#[derive(clap::Args)]
pub(super) struct Record {
    /// Record all frames to this file: raw, images and contacts, with patch and settings (MCAP). It begins with a new
    /// reference, so that `replay` makes the same of it bit for bit; nothing may touch the skin then.
    #[arg(long, value_name = "FILE.mcap", value_parser = Kind::Recording.parser())]
    record: Option<Output>,
}

impl Record {
    /// Begins the recording, if there is to be one, of what `link` leads to.
    pub(super) fn begin(
        &self,
        link: &mut Link,
        skin_file: Option<&Path>,
        pose: Option<&Pose>,
    ) -> anyhow::Result<Option<Outlets>> {
        let Some(file) = &self.record else { return Ok(None) };
        let text = skin_file.map(std::fs::read_to_string).transpose();
        let session = session(link, text.context("cannot read the skin file once more")?)?;
        let mut outlets = Outlets::new(&session, pose, &Look::default())?;
        outlets.record(file, &session)?;
        Ok(Some(outlets))
    }

    /// The file, if there is to be one.
    pub(super) fn file(&self) -> Option<&Path> {
        self.record.as_deref()
    }
}

/// What a recording of the board at this link is of.
pub(super) fn session(link: &mut Link, skin_file: Option<String>) -> anyhow::Result<Session> {
    let info = link.info()?;
    let patch = link.patch()?;
    let skin = PatchView::validate(&patch).context("the board's patch")?.header.skin.as_str().to_owned();
    let identity = link.identity();
    Ok(Session {
        skin,
        board: identity.board.as_str().to_owned(),
        firmware: identity.firmware.as_str().to_owned(),
        frame_source: info.frame_source,
        port: link.port().to_owned(),
        protocol: PROTOCOL_VERSION,
        host: env!("CARGO_PKG_VERSION").to_owned(),
        patch,
        skin_file,
    })
}

/// Frames that a board averages: they come without contacts, and which of them make the reference shows in the end. A
/// board takes the last ones that are fit for it.
#[derive(Debug, Default)]
struct Averaging {
    /// How many the board was asked to average; none if it has begun by itself.
    asked: Option<u16>,
    /// Those that have come, with their messages.
    frames: Vec<(RecordedFrame, Vec<Packed>)>,
}

/// Most frames that wait for the end of a tare: beyond, the oldest are of no use.
const MOST_AVERAGED: usize = 2 * MAX_TARE_FRAMES as usize;

impl Averaging {
    /// Takes a frame without contacts.
    fn wait(&mut self, frame: RecordedFrame, messages: Vec<Packed>) {
        if self.frames.len() == MOST_AVERAGED {
            self.frames.remove(0);
        }
        self.frames.push((frame, messages));
    }

    /// The tare is over: how many frames it took, and the place of the first of them; none if they did not all come.
    fn end(&mut self) -> Option<(u16, usize)> {
        let wanted = self.asked.unwrap_or(DEFAULT_TARE_FRAMES);
        let is_fit = |(frame, _): &(RecordedFrame, Vec<Packed>)| !frame.at.flags.intersects(UNFIT);
        let fit = self.frames.iter().enumerate().rev().filter(|(_, frame)| is_fit(frame));
        let first = fit.map(|(place, _)| place).nth(usize::from(wanted).checked_sub(1)?)?;
        self.asked = None;
        Some((wanted, first))
    }
}

/// The status while frames come.
pub(super) const LIVE: &str = "live";
/// Those of one that makes a reference, or will.
const TARES: [&str; 2] = ["taring", "not_tared"];

/// Where frames go.
pub(super) struct Outlets {
    outlook: Outlook,
    scene: Scene,
    /// What holds for good: shape of the skin, place on its link.
    lasting: Vec<Packed>,
    recorder: Option<Recorder>,
    speaker: Option<Speaker>,
    /// The skin's name on a robot, whose frames somebody else tells of.
    on_robot: Option<String>,
    averaging: Averaging,
    /// How the skin is driven.
    drive: Option<Drive>,
    /// The last reference and the frames that it was made of, for other patches.
    tare: Vec<Item>,
    has_warned: bool,
    /// Whether frames have ever come.
    has_lived: bool,
    /// How the board stood, as was told last.
    state: String,
}

impl Outlets {
    /// Of a board with this session's patch, whose skin lies so and looks so.
    pub(super) fn new(session: &Session, pose: Option<&Pose>, look: &Look) -> anyhow::Result<Self> {
        let mut outlets = Self::empty();
        let patch = PatchView::validate(&session.patch).context("the board's patch")?;
        outlets.drive = Some(patch.header.drive);
        outlets.show_patch(&patch, pose, look, format!("{} {}", session.board, session.firmware));
        Ok(outlets)
    }

    /// Of a board that is not there yet.
    fn empty() -> Self {
        Self {
            outlook: Outlook::default(),
            scene: Scene::new(String::new(), Place::default(), Vec::new(), String::new()),
            lasting: Vec::new(),
            recorder: None,
            speaker: None,
            on_robot: None,
            averaging: Averaging::default(),
            drive: None,
            tare: Vec::new(),
            has_warned: false,
            has_lived: false,
            state: String::new(),
        }
    }

    /// For those who look on, while there is no board.
    pub(super) fn telling(speaker: Speaker) -> Self {
        Self { speaker: Some(speaker), ..Self::empty() }
    }

    /// Of one of several skins, of this name, on a robot whose frames somebody else tells of; for those who look on, if anybody
    /// can.
    pub(super) fn on_robot(speaker: Option<Speaker>, name: String) -> Self {
        Self { speaker, on_robot: Some(name), ..Self::empty() }
    }

    /// Images are those of this patch from now on.
    pub(super) fn show_patch(
        &mut self,
        patch: &PatchView<'_>,
        pose: Option<&Pose>,
        look: &Look,
        board: String,
    ) {
        let name = patch.header.skin.as_str();
        let place = Place::of(name, pose);
        let now = now_ns();
        let shape = skin(patch, look, &place, now);
        let centres = shape.pixel_centres.chunks_exact(3).map(|at| [at[0], at[1], at[2]]).collect();
        let name_there = self.on_robot.clone().unwrap_or_else(|| name.to_owned());
        self.scene = Scene::new(name_there, place.clone(), centres, board);
        self.outlook.place = place;
        self.lasting = vec![Packed::now(Topic::Skin, now, cdr::encode(&shape))];
        if let Some(pose) = pose.filter(|_| self.on_robot.is_none()) {
            self.lasting.push(transforms(vec![transform(pose, name, now)], now));
        }
        for packed in self.lasting.clone() {
            self.send(packed);
        }
    }

    /// The skin is driven like this, and, where the board takes samples, so many a second.
    pub(super) fn drive(&mut self, drive: &Drive, sample_rate: Option<u32>) {
        self.drive = Some(*drive);
        let Some(sample_rate) = sample_rate else { return };
        self.outlook.scope = Timing::new(drive, sample_rate).map_or(ScopeTiming::default(), |timing| {
            ScopeTiming { settling: timing.settling, period: timing.period, sample_rate }
        });
    }

    /// Those who look on are told from now on.
    pub(super) fn tell(&mut self, speaker: Speaker) {
        for packed in self.lasting.clone() {
            speaker.publish(packed);
        }
        self.speaker = Some(speaker);
    }

    /// Begins to record.
    pub(super) fn record(&mut self, file: &Path, session: &Session) -> anyhow::Result<()> {
        self.record_from(Recorder::create(file, session)?, now_ns());
        Ok(())
    }

    /// Records to what has just begun, from this time on, ns since 1970.
    pub(super) fn record_from(&mut self, mut recorder: Recorder, time: u64) {
        // What lasts is known from the recording's first moment on.
        let lasting = self.lasting.iter();
        recorder.record(
            lasting.map(|packed| Packed { log_time: time, publish_time: time, ..packed.clone() }).collect(),
        );
        (self.recorder, self.has_warned) = (Some(recorder), false);
    }

    pub(super) fn recorder(&self) -> Option<&Recorder> {
        self.recorder.as_ref()
    }

    /// Ends the recording, if there is one: gives its file and what is in it.
    pub(super) fn finish_recording(&mut self) -> anyhow::Result<Option<(String, Recorded)>> {
        let waiting = std::mem::take(&mut self.averaging.frames);
        let Some(mut recorder) = self.recorder.take() else { return Ok(None) };
        waiting.into_iter().for_each(|(_, messages)| recorder.record(messages));
        let file = recorder.path().display().to_string();
        Ok(Some((file, recorder.finish()?)))
    }

    /// Asks a board that streams, raw codes and contacts among others, for a new reference, whose frames come with the others.
    pub(super) fn tare(&mut self, link: &mut Link) -> Result<(), LinkError> {
        link.request(&Request::Tare { frames: DEFAULT_TARE_FRAMES })?;
        self.tare_begins(DEFAULT_TARE_FRAMES);
        Ok(())
    }

    /// The board was asked to average so many frames into a new reference.
    pub(super) fn tare_begins(&mut self, frames: u16) {
        self.averaging.asked = Some(frames);
    }

    /// Whether a reference that was asked for is still being made.
    pub(super) fn is_taring(&self) -> bool {
        self.averaging.asked.is_some()
    }

    /// The last reference and the frames that it was made of.
    pub(super) fn last_tare(&self) -> &[Item] {
        &self.tare
    }

    /// Takes a frame that has come now; `shown`, if it is another, is what those see who look on. Says whether the board has
    /// a new reference with it.
    pub(super) fn frame(&mut self, frame: &ScanFrame, shown: Option<&ScanFrame>) -> bool {
        self.frame_of(frame, shown, now_ns())
    }

    /// The same of a frame that came at this time, ns since 1970.
    pub(super) fn frame_of(&mut self, frame: &ScanFrame, shown: Option<&ScanFrame>, now: u64) -> bool {
        let (is_recorded, speaker) = (self.recorder.is_some(), self.speaker.as_ref());
        let is_looked_at = |topic| speaker.is_some_and(|speaker| speaker.wants(topic));
        let wants = |topic| is_recorded || shown.is_none() && is_looked_at(topic);
        let mut messages = self.outlook.messages(frame, now, wants);
        let drawn = [Topic::Pressure, Topic::Markers, Topic::Diagnostics];
        if is_recorded || drawn.into_iter().any(is_looked_at) {
            messages.extend(self.scene.messages(shown.unwrap_or(frame), now));
        }
        // While it averages, a board has raw codes and no contacts.
        let is_averaged = frame.measurements.is_some() && frame.contacts.is_none();
        let mut is_tared = false;
        match RecordedFrame::of(frame, now).filter(|_| is_averaged) {
            Some(averaged) => {
                let kept = if is_recorded { messages.clone() } else { Vec::new() };
                self.averaging.wait(averaged, kept);
            }
            None => {
                if frame.contacts.is_some() && !self.averaging.frames.is_empty() {
                    is_tared = self.end_of_tare();
                }
                if let Some(recorder) = &mut self.recorder {
                    recorder.record(messages.clone());
                }
            }
        }
        let Some(speaker) = &self.speaker else { return is_tared };
        if let Some(shown) = shown {
            messages.retain(|packed| drawn.contains(&packed.topic));
            messages.extend(self.outlook.messages(shown, now, |topic| speaker.wants(topic)));
        }
        messages.into_iter().for_each(|packed| speaker.publish(packed));
        is_tared
    }

    /// Contacts have come again: whether a new reference was made, and of which frames, is known now, and they are recorded.
    /// Else it was a frame whose contacts were lost.
    fn end_of_tare(&mut self) -> bool {
        let made = self.averaging.end();
        let frames = std::mem::take(&mut self.averaging.frames);
        if made.is_some() {
            self.tare.clear();
        }
        for (place, (frame, messages)) in frames.into_iter().enumerate() {
            if let Some((count, first)) = made
                && let Some(drive) = self.drive.filter(|_| place == first)
            {
                // Those who sort by time find it before its frames.
                let header = self.outlook.place.header(frame.log_time);
                let reference = Reference::new(header, frame.at.sequence, count, &drive);
                self.send(Packed::now(Topic::Reference, frame.log_time, cdr::encode(&reference)));
                self.tare.push(Item::Reference(reference));
            }
            if let Some(recorder) = &mut self.recorder {
                recorder.record(messages);
            }
            if made.is_some_and(|(_, first)| place >= first) {
                self.tare.push(Item::Frame(Box::new(frame)));
            }
        }
        made.is_some()
    }

    /// Tells how the session stands. What the board said is over when it is no longer live.
    pub(super) fn status(&mut self, status: Status) {
        let now = now_ns();
        let is_live = status.state == LIVE;
        self.has_lived |= is_live;
        let before = std::mem::replace(&mut self.state, status.state.clone());
        if self.has_lived && !is_live && before != self.state {
            let level = if TARES.contains(&status.state.as_str()) { WARN } else { ERROR };
            self.scene.over(level, &status.text, now).into_iter().for_each(|packed| self.send(packed));
        }
        let status = Status { header: self.outlook.place.header(now), ..status };
        self.send(Packed::now(Topic::Status, now, cdr::encode(&status)));
    }

    /// Says once if the recording has ended early; the stream goes on.
    pub(super) fn warn(&mut self) {
        let Some(recorder) = self.recorder.as_ref().filter(|_| !self.has_warned) else { return };
        self.has_warned = warn_of(recorder);
    }

    fn send(&mut self, packed: Packed) {
        if let Some(recorder) = &mut self.recorder {
            recorder.record(vec![packed.clone()]);
        }
        if let Some(speaker) = &self.speaker {
            speaker.publish(packed);
        }
    }
}

/// Says if a recording has ended early.
pub(super) fn warn_of(recorder: &Recorder) -> bool {
    let failure = recorder.recorded().failure;
    if let Some(reason) = &failure {
        let file = recorder.path().display();
        eprintln!("warning: the recording `{file}` has ended: {reason}; all else goes on");
    }
    failure.is_some()
}

/// What a recording holds, in words.
pub(super) fn recorded_in_words(file: &str, recorded: &Recorded) -> String {
    let Recorded { frames, bytes, dropped, .. } = recorded;
    let lost = if *dropped > 0 {
        format!(", {dropped} messages dropped: the disk was too slow")
    } else {
        String::new()
    };
    format!("recorded {frames} frames to {file}, {:.1} MB{lost}", *bytes as f64 / 1e6)
}
