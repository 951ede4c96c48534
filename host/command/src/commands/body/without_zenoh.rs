//! In place of `merged`, where the program is built without Zenoh.

use crate::commands::{JsonReport, network::Network};
use anyhow::bail;

pub(super) fn run(_: Option<&str>, _: &Network, _: &JsonReport, _: impl Fn() -> bool) -> anyhow::Result<()> {
    bail!(
        "`body`: this program is built without Zenoh; build it with `cargo build --release --features zenoh` (docs/zenoh.md)"
    )
}
