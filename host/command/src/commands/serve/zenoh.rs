//! Zenoh: the body, told to other computers.

use crate::commands::network::Network;
use anyhow::Context;
use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Asked, Told},
};
use dermatome_patch::input::read_text;
use dermatome_zenoh::{Robot, Settings};

/// The body on the network.
pub(super) struct Zenoh {
    robot: Robot,
}

impl Zenoh {
    pub(super) fn start(file: &BodyFile, network: &Network, takes_orders: bool) -> anyhow::Result<Self> {
        let text = |path| read_text(path).with_context(|| format!("skin file `{}`", path.display()));
        let texts = file.patches.iter().map(|patch| text(&patch.path)).collect::<anyhow::Result<Vec<_>>>()?;
        let robot =
            Robot::start(file, &texts, &Settings::from(network), takes_orders).context("`--zenoh`")?;
        log::info!("dermatome/{} on the network", file.name);
        Ok(Self { robot })
    }

    /// Tells what a keeper told, after the body has taken it.
    pub(super) fn tell(&mut self, body: &Body, index: usize, told: &Told) {
        self.robot.tell(body, index, told);
    }

    /// Tells that this computer goes on; gives what others ask keepers to do, by their patches.
    pub(super) fn attend(&mut self, body: &Body) -> Vec<(usize, Asked)> {
        self.robot.attend(body)
    }

    /// Leaves the network.
    pub(super) fn end(self) {
        self.robot.end();
    }
}
