//! Service: tare and drive of a skin, which answer once it is done, or cannot be.

use crate::node::{RELIABLE, RosError};
use dermatome_body::{
    Sense,
    keeper::{Phase, State, Told},
};
use dermatome_messages::dermatome::{DriveRequest, number_of_gain};
use dermatome_shared::drive::Drive;
use ros2_client::{
    Message, Name, Node, ServiceMapping, ServiceTypeName,
    service::{RmwRequestId, Server},
};
use serde::{Deserialize, Serialize};

/// What a keeper is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// Make a new reference.
    Tare,
    /// Drive the skin like this.
    Drive(Drive),
}

/// std_srvs/srv/Trigger_Request: nothing, but that DDS adds a byte to.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Nothing {}

/// As dermatome_msgs/srv/Drive_Request.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(transparent)]
struct DriveMessage(DriveRequest);

/// std_srvs/srv/Trigger_Response and dermatome_msgs/srv/Drive_Response
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Outcome {
    success: bool,
    message: String,
}

impl Message for Nothing {}
impl Message for DriveMessage {}
impl Message for Outcome {}

impl Outcome {
    fn done(message: impl Into<String>) -> Self {
        Self { success: true, message: message.into() }
    }

    fn refused(message: impl Into<String>) -> Self {
        Self { success: false, message: message.into() }
    }
}

/// What a request waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Awaited {
    Reference { has_begun: bool },
    Drive(Drive),
}

/// The services of one skin.
pub(crate) struct Services {
    tare: Desk<Nothing>,
    drive: Desk<DriveMessage>,
}

/// A service with what is not answered yet.
struct Desk<Request: Message> {
    server: Server<Request, Outcome>,
    waiting: Vec<(RmwRequestId, Awaited)>,
}

impl Services {
    /// Under `/ROBOT/SKIN`.
    pub(crate) fn start(node: &mut Node, space: &str, mapping: ServiceMapping) -> Result<Self, RosError> {
        Ok(Self {
            tare: Desk::open(node, space, "tare", &ServiceTypeName::new("std_srvs", "Trigger"), mapping)?,
            drive: Desk::open(
                node,
                space,
                "drive",
                &ServiceTypeName::new("dermatome_msgs", "Drive"),
                mapping,
            )?,
        })
    }

    /// Takes what has been asked for; what cannot be is answered.
    pub(crate) fn requests(&mut self, sense: &Sense) -> Vec<Asked> {
        let tares = self.tare.requests(|_| tare(&sense.state));
        let drives = self.drive.requests(|DriveMessage(request)| drive(request, sense));
        tares.into_iter().chain(drives).collect()
    }

    /// Answers the requests that this decides.
    pub(crate) fn hear(&mut self, told: &Told) {
        self.tare.hear(told);
        self.drive.hear(told);
    }
}

impl<Request: Message + Clone + 'static> Desk<Request> {
    fn open(
        node: &mut Node,
        space: &str,
        name: &str,
        kind: &ServiceTypeName,
        mapping: ServiceMapping,
    ) -> Result<Self, RosError> {
        let name = Name::new(space, name).map_err(|error| RosError::Name(error.to_string()))?;
        let server = node.create_server(mapping, &name, kind, RELIABLE, RELIABLE)?;
        Ok(Self { server, waiting: Vec::new() })
    }

    fn requests(&mut self, decide: impl Fn(&Request) -> Result<Asked, Outcome>) -> Vec<Asked> {
        let mut asked = Vec::new();
        loop {
            match self.server.receive_request() {
                Ok(Some((id, request))) => match decide(&request) {
                    Ok(wanted) => {
                        self.waiting.push((id, Awaited::of(wanted)));
                        asked.push(wanted);
                    }
                    Err(outcome) => answer(&self.server, id, outcome),
                },
                Ok(None) => return asked,
                Err(error) => {
                    log::warn!("a request that ROS sent cannot be read: {error:?}");
                    return asked;
                }
            }
        }
    }

    fn hear(&mut self, told: &Told) {
        let Self { server, waiting } = self;
        waiting.retain_mut(|(id, awaited)| {
            let outcome = awaited.outcome(told);
            outcome.map(|outcome| answer(server, *id, outcome)).is_none()
        });
    }
}

fn answer<Request: Message + 'static>(server: &Server<Request, Outcome>, id: RmwRequestId, outcome: Outcome) {
    if let Err(error) = server.send_response(id, outcome) {
        log::warn!("ROS does not take a reply: {error:?}");
    }
}

/// Whether a new reference can be made, or why not.
fn tare(state: &State) -> Result<Asked, Outcome> {
    match state.phase {
        Phase::Taring => Ok(Asked::Tare),
        Phase::Live if state.text.is_empty() => Ok(Asked::Tare),
        // It waits already.
        _ => Err(Outcome::refused(&state.text)),
    }
}

/// The drive that is asked for, or why it cannot be.
fn drive(request: &DriveRequest, sense: &Sense) -> Result<Asked, Outcome> {
    let is_there = matches!(sense.state.phase, Phase::Live | Phase::Taring);
    let driven = sense.driven.as_ref().filter(|_| is_there);
    let Some(driven) = driven else { return Err(Outcome::refused(&sense.state.text)) };
    let drive = request.of(&driven.drive);
    match driven.check(&drive) {
        Err(error) => Err(Outcome::refused(error.to_string())),
        Ok(()) if drive == driven.drive => Err(Outcome::done(in_words(&drive))),
        Ok(()) => Ok(Asked::Drive(drive)),
    }
}

fn in_words(drive: &Drive) -> String {
    let gain = match number_of_gain(drive.gain) {
        0 => "automatic".to_owned(),
        gain => gain.to_string(),
    };
    let Drive { frequency, amplitude, frame_rate, .. } = drive;
    format!("{frequency} Hz, {amplitude} A, {frame_rate} frames a second, gain {gain}")
}

impl Awaited {
    fn of(asked: Asked) -> Self {
        match asked {
            Asked::Tare => Self::Reference { has_begun: false },
            Asked::Drive(drive) => Self::Drive(drive),
        }
    }

    /// What became of it, if this tells.
    fn outcome(&mut self, told: &Told) -> Option<Outcome> {
        match (self, told) {
            (_, Told::State(state)) if !matches!(state.phase, Phase::Live | Phase::Taring) => {
                Some(Outcome::refused(&state.text))
            }
            (Self::Reference { has_begun }, Told::State(state)) => match state.phase {
                Phase::Taring => {
                    *has_begun = true;
                    None
                }
                _ if !state.text.is_empty() => Some(Outcome::refused(&state.text)),
                _ => has_begun.then(|| Outcome::done("the reference is made")),
            },
            (Self::Drive(wanted), Told::Driven(driven)) if driven.drive == *wanted => {
                Some(Outcome::done(in_words(&driven.drive)))
            }
            (Self::Drive(_), Told::NotDriven(why)) => Some(Outcome::refused(why)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_body::driven::Driven;

    fn state(phase: Phase, text: &str) -> Told {
        Told::State(State { phase, text: text.to_owned() })
    }

    #[test]
    fn a_tare_is_answered_once_its_reference_is_made() {
        let mut awaited = Awaited::of(Asked::Tare);
        // The end of one that was under way.
        assert_eq!(awaited.outcome(&state(Phase::Live, "")), None);
        let frame = Told::Frame { frame: Box::default(), received_ns: 0, missing: 0 };
        assert_eq!(awaited.outcome(&frame), None);
        assert_eq!(awaited.outcome(&state(Phase::Taring, "averaging the untouched skin")), None);
        let done = Some(Outcome::done("the reference is made"));
        assert_eq!(awaited.outcome(&state(Phase::Live, "")), done);
    }

    #[test]
    fn a_tare_under_a_press_or_of_a_board_that_is_lost_is_answered_with_the_reason() {
        for phase in [Phase::Live, Phase::Lost, Phase::NotTared] {
            let refused = Some(Outcome::refused("why"));
            assert_eq!(Awaited::of(Asked::Tare).outcome(&state(phase, "why")), refused);
        }
        let State { phase, text } = State { phase: Phase::Lost, text: "gone".to_owned() };
        assert_eq!(tare(&State { phase, text }), Err(Outcome::refused("gone")));
    }

    #[test]
    fn a_drive_is_answered_once_the_board_has_it_or_refused_it() {
        let drive = Drive::new(100e3, 1e-3, 50.0);
        let mut awaited = Awaited::of(Asked::Drive(drive));
        let driven = |drive| Told::Driven(Box::new(Driven { drive, front_end: None }));
        assert_eq!(awaited.outcome(&driven(Drive::new(50e3, 1e-3, 50.0))), None);
        let outcome = awaited.outcome(&driven(drive)).unwrap();
        assert_eq!(outcome, Outcome::done("100000 Hz, 0.001 A, 50 frames a second, gain automatic"));
        let refused = Some(Outcome::refused("no"));
        assert_eq!(awaited.outcome(&Told::NotDriven("no".to_owned())), refused);
    }
}
