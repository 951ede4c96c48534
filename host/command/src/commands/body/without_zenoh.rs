//! In place of `merged`, where the program is built without Zenoh.

use crate::commands::{JsonReport, network::Network};
use anyhow::bail;
use dermatome_messages::dermatome::DriveRequest;

const WITHOUT: &str = "`body`: this program is built without Zenoh; build it with `cargo build --release --features zenoh` \
                       (docs/zenoh.md)";

pub(super) fn ask(
    _: Option<&str>,
    _: &[String],
    _: Option<&DriveRequest>,
    _: &Network,
    _: impl Fn() -> bool,
) -> anyhow::Result<()> {
    bail!(WITHOUT)
}

pub(super) fn run(_: Option<&str>, _: &Network, _: &JsonReport, _: impl Fn() -> bool) -> anyhow::Result<()> {
    bail!(WITHOUT)
}
