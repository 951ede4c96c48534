//! Node: on the network, and what it publishes.

use crate::settings::Settings;
use ros2_client::{
    Context, CreateError, MessageTypeName, Node, NodeName, NodeOptions, Publisher,
    dds::rustdds::DomainParticipantBuilder,
    qos::{Durability, History, QosProfile, Reliability, WhenFull},
};
use serde::Serialize;
use std::net::Ipv4Addr;

/// How ROS has data of sensors: the newest counts, and none is sent twice.
pub(crate) const SENSOR_DATA: QosProfile =
    QosProfile::subscription_default().history(History::KeepLast { depth: 5 });
/// Such that none is lost, and whoever comes later gets the last one.
pub(crate) const LASTING: QosProfile =
    RELIABLE.durability(Durability::TransientLocal).history(History::KeepLast { depth: 1 });
/// Such that none is lost, unless the reader is stuck: who writes does not wait for it.
pub(crate) const RELIABLE: QosProfile = QosProfile::publisher_default()
    .reliability(Reliability::Reliable { when_full: WhenFull::Fail })
    .history(History::KeepLast { depth: 10 });

/// Why there is no node.
#[derive(Debug, thiserror::Error)]
pub enum RosError {
    /// Two names that are the same in topics, or one that ROS does not take.
    #[error("ROS takes no such name: {0}")]
    Name(String),
    /// DDS does not make what a node consists of.
    #[error("ROS: {0}")]
    Node(String),
}

impl From<CreateError> for RosError {
    fn from(error: CreateError) -> Self {
        Self::Node(error.to_string())
    }
}

/// Makes a node's publishers.
pub(crate) struct Publishers {
    context: Context,
    pub(crate) node: Node,
}

impl Publishers {
    /// Of a topic with messages of `PACKAGE/TYPE`.
    pub(crate) fn make<M: Serialize>(
        &mut self,
        topic: &str,
        kind: &str,
        qos: QosProfile,
    ) -> Result<Publisher<M>, RosError> {
        let (package, name) = kind.split_once('/').unwrap_or(("", kind));
        let topic =
            self.context.create_topic(format!("rt{topic}"), MessageTypeName::new(package, name), &qos)?;
        Ok(self.node.create_publisher(&topic, Some(qos))?)
    }
}

impl Publishers {
    /// The node `/ROBOT/dermatome`.
    pub(crate) fn start(robot: &str, settings: Settings) -> Result<Self, RosError> {
        let mut participant = DomainParticipantBuilder::new(settings.domain);
        if settings.is_local {
            participant = participant.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let context = Context::from_domain_participant(participant.build().map_err(CreateError::from)?)?;
        let name = NodeName::new(&format!("/{robot}"), "dermatome");
        let name = name.map_err(|error| RosError::Name(error.to_string()))?;
        let node = context.new_node(name, NodeOptions::new().enable_rosout(false));
        let node = node.map_err(|error| RosError::Node(error.to_string()))?;
        Ok(Self { context, node })
    }
}

/// Sends a message; one that cannot be sent is dropped, as there is a next one.
pub(crate) fn publish<M: Serialize>(publisher: &Publisher<M>, message: M) {
    if let Err(error) = publisher.publish(message) {
        log::debug!("a message is not published: {error}");
    }
}
