//! Onlookers: the page and other programs, for which each skin has a space of its own.

use super::robot::{Figure, fixed};
use crate::commands::{
    doors::Doors,
    outlets::Outlets,
    view::calls::{self, Change, DRIVE, OF_EACH, TARE},
};
use anyhow::bail;
use dermatome_body::{
    Sense,
    file::{BodyFile, Patch},
    keeper::{Keeper, Phase, State, Told},
};
use dermatome_messages::{
    dermatome::{Status, number_of_gain},
    skin::Look,
};
use dermatome_page::{Call, Server};
use dermatome_shared::patch::PatchView;
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
    server: Server,
    stands: Vec<Stand>,
    told: Instant,
    /// The robot, where the body file names its description.
    figure: Option<Figure>,
}

/// What they see of one skin.
struct Stand {
    outlets: Outlets,
    look: Look,
    status: Status,
    /// Frames when they were last told.
    frames: u64,
}

impl Onlookers {
    /// Opens the page for a body whose skins look so.
    pub(super) fn open(
        doors: &Doors,
        listen: SocketAddr,
        file: &BodyFile,
        looks: Vec<Look>,
    ) -> anyhow::Result<Self> {
        let spaces: Vec<String> =
            file.patches.iter().map(|patch| format!("{}/{}", file.name, patch.name)).collect();
        let robot = file.urdf.as_ref().map(|urdf| &urdf.robot);
        // Standard output is for lines.
        let server =
            doors.open(listen, &OF_EACH, spaces.clone(), robot.is_some(), |url| eprintln!("{url}"))?;
        let fixed = robot.map(fixed).unwrap_or_default();
        let stand = |(index, (patch, look)): (usize, (&Patch, Look))| Stand {
            outlets: Outlets::on_robot(server.speaker(index), spaces[index].clone(), fixed.clone()),
            look,
            status: Status {
                port: patch.port.to_string(),
                skin: patch.skin.name.clone(),
                signal_to_noise: f32::NAN,
                ..Status::default()
            },
            frames: 0,
        };
        let stands = file.patches.iter().zip(looks).enumerate().map(stand).collect();
        let figure = robot.map(|robot| Figure::show(robot, server.speaker(0)));
        Ok(Self { server, stands, told: Instant::now(), figure })
    }

    /// A keeper told something of a patch.
    pub(super) fn tell(&mut self, index: usize, patch: &Patch, told: &Told) {
        let Stand { outlets, look, status, .. } = &mut self.stands[index];
        match told {
            Told::Patch { bytes, board, .. } => {
                // The keeper has looked at it.
                let Ok(view) = PatchView::validate(bytes) else { return };
                outlets.show_patch(&view, Some(&patch.pose), look, board.clone());
                (status.board, status.patch_crc) = (board.clone(), view.crc());
                status.patches = vec![format!("{} (on the board)", status.skin)];
            }
            Told::Driven(driven) => {
                let in_effect = driven.drive;
                outlets.drive(&in_effect, None);
                (status.frequency, status.amplitude) = (in_effect.frequency, in_effect.amplitude);
                (status.gain, status.frame_rate) = (number_of_gain(in_effect.gain), in_effect.frame_rate);
            }
            Told::Frame { frame, .. } => {
                outlets.frame(frame, None);
            }
            Told::NotDriven(why) => status.warnings = vec![format!("the board keeps its drive: {why}")],
            Told::State(_) | Told::Reference(_) => {}
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
            let (state, advice) = in_words(&sense.state);
            let status = &mut stand.status;
            (status.state, status.text, status.advice) =
                (state.to_owned(), sense.state.text.clone(), advice.to_owned());
            (status.frames, status.frames_lost) = (sense.frames, sense.missing);
            status.frames_per_second = (sense.frames - stand.frames) as f32 / since.as_secs_f32();
            stand.frames = sense.frames;
            let status = status.clone();
            stand.outlets.status(status);
        }
    }

    /// Tells, now and then, where the robot's joints are.
    pub(super) fn tell_joints(&mut self, position: impl Fn(&Joint) -> f64) {
        if let Some(figure) = &mut self.figure {
            figure.tell(position);
        }
    }

    /// Does what they ask for.
    pub(super) fn answer(&mut self, keepers: &[Keeper], senses: &[Sense]) {
        while let Some(call) = self.server.call() {
            let done = self
                .done(&call, &keepers[call.space], &senses[call.space])
                .map_err(|error| format!("{error:#}"));
            call.answer(done);
        }
    }

    fn done(&mut self, call: &Call, keeper: &Keeper, sense: &Sense) -> anyhow::Result<Value> {
        match call.service {
            TARE => keeper.tare(),
            DRIVE => {
                let Some(driven) = &sense.driven else { bail!("the board has not answered yet") };
                let wanted = calls::request::<Change>(call)?.of(&driven.drive)?;
                driven.check(&wanted)?;
                self.stands[call.space].status.warnings.clear();
                keeper.drive(wanted);
            }
            other => bail!("there is no service `{other}`"),
        }
        Ok(json!({}))
    }
}

/// The page's word for how a board stands, and what to do.
fn in_words(state: &State) -> (&'static str, &'static str) {
    match state.phase {
        Phase::NoBoard => ("no_board", "plug the board in, and close other programs that use its port"),
        Phase::Lost => ("lost", "plug it in again; all goes on by itself when it answers"),
        Phase::NoPatch | Phase::OtherPatch => ("no_patch", "send the skin's patch to it"),
        Phase::NotTared => ("not_tared", "free the skin: the board makes its new reference then"),
        Phase::Taring => ("taring", "do not touch the skin until it is done"),
        Phase::Live => ("live", ""),
        Phase::Ended => ("ended", ""),
    }
}
