//! Service: tare and drive of a skin, which answer once it is done, or cannot be.

use crate::node::{RELIABLE, RosError};
use dermatome_body::{
    Sense,
    asking::{self, Outcome, Waiting},
    keeper::{Asked, Told},
};
use dermatome_messages::dermatome::DriveRequest;
use ros2_client::{
    Message, Name, Node, ServiceMapping, ServiceTypeName,
    service::{RmwRequestId, Server},
};
use serde::{Deserialize, Serialize};

/// std_srvs/srv/Trigger_Request: nothing, but that DDS adds a byte to.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Nothing {}

/// As dermatome_msgs/srv/Drive_Request.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(transparent)]
struct DriveMessage(DriveRequest);

/// std_srvs/srv/Trigger_Response and dermatome_msgs/srv/Drive_Response
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
struct OutcomeMessage(Outcome);

impl Message for Nothing {}
impl Message for DriveMessage {}
impl Message for OutcomeMessage {}

/// The services of one skin.
pub(crate) struct Services {
    tare: Desk<Nothing>,
    drive: Desk<DriveMessage>,
}

/// A service with what is not answered yet.
struct Desk<Request: Message> {
    server: Server<Request, OutcomeMessage>,
    waiting: Waiting<RmwRequestId>,
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
        let tares = self.tare.requests(|_| asking::tare(sense));
        let drives = self.drive.requests(|DriveMessage(request)| asking::drive(request, sense));
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
        Ok(Self { server, waiting: Waiting::default() })
    }

    fn requests(&mut self, decide: impl Fn(&Request) -> Result<Asked, Outcome>) -> Vec<Asked> {
        let mut asked = Vec::new();
        loop {
            match self.server.receive_request() {
                Ok(Some((id, request))) => match decide(&request) {
                    Ok(wanted) => {
                        self.waiting.add(id, &wanted);
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
        waiting.hear(told, |id, outcome| answer(server, id, outcome));
    }
}

fn answer<Request: Message + 'static>(
    server: &Server<Request, OutcomeMessage>,
    id: RmwRequestId,
    outcome: Outcome,
) {
    if let Err(error) = server.send_response(id, OutcomeMessage(outcome)) {
        log::warn!("ROS does not take a reply: {error:?}");
    }
}
