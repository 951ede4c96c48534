//! In place of `ros`, where the program is built without it.

use anyhow::bail;
use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Asked, Told},
};

/// There is none.
pub(super) enum Ros {}

impl Ros {
    pub(super) fn start(_: &BodyFile, _: Option<u16>) -> anyhow::Result<Self> {
        bail!(
            "`--ros`: this program is built without ROS; build it with `cargo build --release --features ros` (docs/ros.md)"
        )
    }

    pub(super) fn tell(&mut self, _: &Body, _: usize, _: &Told) {
        match *self {}
    }

    pub(super) fn end(&mut self, _: &Body) {
        match *self {}
    }

    pub(super) fn attend(&mut self, _: &Body) -> Vec<(usize, Asked)> {
        match *self {}
    }
}
