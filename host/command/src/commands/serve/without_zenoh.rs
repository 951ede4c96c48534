//! In place of `zenoh`, where the program is built without it.

use crate::commands::network::Network;
use anyhow::bail;
use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Asked, Told},
};

/// There is none.
pub(super) enum Zenoh {}

impl Zenoh {
    pub(super) fn start(_: &BodyFile, _: &Network, _: bool) -> anyhow::Result<Self> {
        bail!(
            "`--zenoh`: this program is built without Zenoh; build it with `cargo build --release --features zenoh` (docs/zenoh.md)"
        )
    }

    pub(super) fn tell(&mut self, _: &Body, _: usize, _: &Told) {
        match *self {}
    }

    pub(super) fn attend(&mut self, _: &Body) -> Vec<(usize, Asked)> {
        match *self {}
    }

    pub(super) fn end(self) {
        match self {}
    }
}
