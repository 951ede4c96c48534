//! ROS: the body as a node of ROS 2.

use anyhow::Context;
use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Asked, Told},
};
use dermatome_ros::{Robot, Settings};

/// The node.
pub(super) struct Ros {
    robot: Robot,
}

impl Ros {
    pub(super) fn start(file: &BodyFile, domain: Option<u16>) -> anyhow::Result<Self> {
        let settings = Settings::from_environment(domain)?;
        let robot = Robot::start(file, settings).context("`--ros`")?;
        log::info!("node /{}/dermatome in domain {}", file.name, settings.domain);
        Ok(Self { robot })
    }

    /// Publishes what a keeper told, after the body has taken it.
    pub(super) fn tell(&mut self, body: &Body, index: usize, told: &Told) {
        self.robot.tell(body, index, told);
    }

    /// Tells that all contacts are over.
    pub(super) fn end(&mut self, body: &Body) {
        self.robot.end(body);
    }

    /// What services ask keepers to do, by their patches.
    pub(super) fn attend(&mut self, body: &Body) -> Vec<(usize, Asked)> {
        self.robot.attend(body)
    }
}
