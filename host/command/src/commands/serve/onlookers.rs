//! Onlookers: the page, other programs and a recording, for which each skin has a space of its own.

use super::{
    record::{Begun, Tape},
    robot::Figure,
};
use crate::commands::{
    doors::Doors,
    outlets::{LIVE, Outlets},
    outputs::Output,
    view::calls::{self, Change, DRIVE, OF_EACH, TARE},
};
use anyhow::bail;
use dermatome_body::{
    Sense,
    file::{BodyFile, Patch},
    keeper::{Asked, Keeper, Phase, State, Told},
};
use dermatome_link::words;
use dermatome_messages::{
    clock::now_ns,
    dermatome::{Status, number_of_gain},
    skin::Look,
};
use dermatome_page::{Call, Server};
use dermatome_shared::patch::{PatchView, reflexes::ReflexRule};
use dermatome_urdf::urdf::tree::Joint;
use serde_json::{Value, json};
use std::{
    net::SocketAddr,
    time::{Duration, Instant},
};

/// How often they are told how the boards stand.
const STATUS_PERIOD: Duration = Duration::from_millis(500);

/// Those who look on.
pub(super) struct Onlookers {
    /// None where all is but recorded.
    server: Option<Server>,
    stands: Vec<Stand>,
    tape: Option<Tape>,
    told: Instant,
    /// The robot, until the recording ends.
    figure: Option<Figure>,
}

/// What they see of one skin.
struct Stand {
    outlets: Outlets,
    look: Look,
    status: Status,
    /// Of the patch on the board.
    rules: Vec<ReflexRule>,
    /// Why the board was not driven as it was asked to.
    refused: Option<String>,
    /// Frames when they were last told.
    frames: u64,
}

impl Onlookers {
    /// Opens the page and the recording, whichever is wanted, of a body whose skins look so.
    pub(super) fn open(
        page: Option<(SocketAddr, &Doors)>,
        record: Option<&Output>,
        file: &BodyFile,
        looks: Vec<Look>,
    ) -> anyhow::Result<Self> {
        let tape = record.map(|record| Tape::begin(record, file)).transpose()?;
        let spaces: Vec<String> =
            file.patches.iter().map(|patch| format!("{}/{}", file.name, patch.name)).collect();
        let robot = file.urdf.as_ref().map(|urdf| &urdf.robot);
        // Standard output is for lines.
        let open = |(listen, doors): (SocketAddr, &Doors)| {
            doors.open(listen, &OF_EACH, spaces.clone(), robot.is_some(), |url| eprintln!("{url}"))
        };
        let server = page.map(open).transpose()?;
        let speaker = |index| server.as_ref().map(|server: &Server| server.speaker(index));
        let stand = |(index, (patch, look)): (usize, (&Patch, Look))| Stand {
            outlets: Outlets::on_robot(speaker(index), spaces[index].clone()),
            look,
            status: Status {
                port: patch.port.to_string(),
                skin: patch.skin.name.clone(),
                signal_to_noise: f32::NAN,
                ..Status::default()
            },
            rules: Vec::new(),
            refused: None,
            frames: 0,
        };
        let stands = file.patches.iter().zip(looks).enumerate().map(stand).collect();
        let places = file.patches.iter().zip(&spaces).map(|(patch, space)| (&patch.pose, space.as_str()));
        let figure = Figure::show(robot, places, speaker(0), tape.as_ref().map(Tape::of_robot));
        Ok(Self { server, stands, tape, told: Instant::now(), figure: Some(figure) })
    }

    /// A keeper told something of a patch.
    pub(super) fn tell(&mut self, index: usize, patch: &Patch, told: &Told, sense: &Sense) {
        let Stand { outlets, look, status, rules, refused, .. } = &mut self.stands[index];
        match told {
            Told::Patch { bytes, board, firmware, .. } => {
                // The keeper has looked at it.
                let Ok(view) = PatchView::validate(bytes) else { return };
                let board = format!("{board} {firmware}");
                outlets.show_patch(&view, Some(&patch.pose), look, board.clone());
                (status.board, status.patch_crc) = (board, view.crc());
                *rules = view.reflex_rules().collect();
                status.patches = vec![format!("{} (on the board)", status.skin)];
                match self.tape.as_mut().and_then(|tape| tape.patch(index, patch, told)) {
                    Some(Begun::Anew(recorder)) => outlets.record_from(recorder, now_ns()),
                    Some(Begun::Otherwise) if outlets.recorder().is_some() => {
                        let name = &patch.name;
                        eprintln!(
                            "warning: the board of `{name}` has another patch now, and is recorded no more"
                        );
                        // What became of the file the whole of it tells.
                        let _ = outlets.finish_recording();
                    }
                    Some(Begun::Otherwise) | None => {}
                }
            }
            Told::Driven(driven) => {
                let in_effect = driven.drive;
                outlets.drive(&in_effect, None);
                (status.frequency, status.amplitude) = (in_effect.frequency, in_effect.amplitude);
                (status.gain, status.frame_rate) = (number_of_gain(in_effect.gain), in_effect.frame_rate);
            }
            Told::Frame { frame, received_ns, .. } => {
                outlets.frame_of(frame, None, *received_ns);
                // One that trips is not waited with.
                let warnings = warnings(refused.as_deref(), rules, sense);
                if status.warnings != warnings {
                    status.warnings = warnings;
                    outlets.status(status.clone());
                }
            }
            Told::NotDriven { why, .. } => *refused = Some(format!("the board keeps its drive: {why}")),
            Told::State(state) => {
                stand_so(status, state);
                outlets.status(status.clone());
            }
            Told::GivenUp(_) | Told::Reference(_) => {}
        }
    }

    /// Tells, now and then, how the boards stand.
    pub(super) fn tell_states(&mut self, senses: &[Sense]) {
        let since = self.told.elapsed();
        if since < STATUS_PERIOD {
            return;
        }
        self.told = Instant::now();
        for (stand, sense) in self.stands.iter_mut().zip(senses) {
            let status = &mut stand.status;
            stand_so(status, &sense.state);
            status.warnings = warnings(stand.refused.as_deref(), &stand.rules, sense);
            (status.frames, status.frames_lost) = (sense.frames, sense.missing);
            status.frames_per_second = (sense.frames - stand.frames) as f32 / since.as_secs_f32();
            stand.frames = sense.frames;
            if let Some(tape) = &self.tape {
                let recorded = tape.recorded();
                status.recording = tape.path().display().to_string();
                (status.recorded_bytes, status.recorded_frames) = (recorded.bytes, recorded.frames);
            }
            let status = status.clone();
            stand.outlets.status(status);
        }
        if let Some(tape) = &mut self.tape {
            tape.warn();
        }
    }

    /// Ends the recording, if there is one, and says what is in it.
    pub(super) fn end(&mut self) -> anyhow::Result<()> {
        let Some(tape) = self.tape.take() else { return Ok(()) };
        for Stand { outlets, .. } in &mut self.stands {
            // What became of the file the whole of it tells.
            let _ = outlets.finish_recording();
        }
        self.figure = None;
        tape.end()
    }

    /// Tells, now and then, where the robot's joints are.
    pub(super) fn tell_joints(&mut self, position: impl Fn(&Joint) -> f64) {
        if let Some(figure) = &mut self.figure {
            figure.tell(position);
        }
    }

    /// Does what they ask for.
    pub(super) fn answer(&mut self, keepers: &[Keeper], senses: &[Sense]) {
        while let Some(call) = self.server.as_ref().and_then(Server::call) {
            let done = self
                .done(&call, &keepers[call.space], &senses[call.space])
                .map_err(|error| format!("{error:#}"));
            call.answer(done);
        }
    }

    fn done(&mut self, call: &Call, keeper: &Keeper, sense: &Sense) -> anyhow::Result<Value> {
        match call.service {
            TARE => keeper.ask(Asked::Tare),
            DRIVE => {
                let Some(driven) = &sense.driven else { bail!("the board has not answered yet") };
                let wanted = calls::request::<Change>(call)?.of(&driven.drive)?;
                driven.check(&wanted)?;
                self.stands[call.space].refused = None;
                keeper.ask(Asked::Drive(wanted));
            }
            other => bail!("there is no service `{other}`"),
        }
        Ok(json!({}))
    }
}

/// What is wrong with a skin, in words.
fn warnings(refused: Option<&str>, rules: &[ReflexRule], sense: &Sense) -> Vec<String> {
    let of_reflexes = sense.reflexes.as_ref().map(|now| words::reflexes(rules, now));
    refused.map(str::to_owned).into_iter().chain(of_reflexes.unwrap_or_default()).collect()
}

/// A board stands so from now on.
fn stand_so(status: &mut Status, state: &State) {
    let (word, advice) = in_words(state);
    (status.state, status.text, status.advice) = (word.to_owned(), state.text.clone(), advice.to_owned());
}

/// The page's word for how a board stands, and what to do.
fn in_words(state: &State) -> (&'static str, &'static str) {
    match state.phase {
        Phase::NoBoard => ("no_board", "plug the board in, and close other programs that use its port"),
        Phase::Lost => ("lost", "plug it in again; all goes on by itself when it answers"),
        Phase::NoPatch | Phase::OtherPatch => ("no_patch", "send the skin's patch to it"),
        Phase::NotTared => ("not_tared", "free the skin: the board makes its new reference then"),
        Phase::Taring => ("taring", "do not touch the skin until it is done"),
        Phase::Live => (LIVE, ""),
        Phase::Ended => ("ended", ""),
    }
}
