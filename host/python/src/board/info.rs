//! Info: what a board holds and does.

use dermatome_shared::protocol::{self, FrameSource};
use pyo3::prelude::*;

/// What a board holds and does.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Info {
    /// Kind of board.
    board: String,
    /// Version of its firmware.
    firmware: String,
    /// Electrodes wired to it.
    electrodes: u8,
    /// Where its frames come from: "skin", "simulated" or "synthetic", which are numbers without meaning.
    frame_source: &'static str,
    /// Volts between two electrodes for one step of a code; None of a board without an analogue front end.
    volts_per_code: Option<f32>,
    /// How long ago it started, s.
    uptime: f64,
    /// Whether it has a reference, so that images can be made.
    tared: bool,
    /// Name of the skin whose patch it uses; None without a patch, as all that follows.
    skin: Option<String>,
    /// Checksum of the patch, which identifies it.
    patch_crc: Option<u32>,
    /// Steps of a frame.
    steps: Option<u16>,
    /// Measurements after reciprocal steps are averaged.
    measurements: Option<u16>,
    /// Pixels of an image.
    pixels: Option<u16>,
    /// Frames a second, at most.
    frame_rate: Option<f32>,
}

impl Info {
    pub(super) fn new(identity: &protocol::Identity, info: &protocol::Info) -> Self {
        let patch = info.patch.as_ref();
        Self {
            board: identity.board.as_str().to_owned(),
            firmware: identity.firmware.as_str().to_owned(),
            electrodes: info.electrodes,
            frame_source: source_in_words(info.frame_source),
            volts_per_code: info.front_end.as_ref().map(|front_end| front_end.volts_per_code),
            uptime: info.uptime_ms as f64 / 1e3,
            tared: info.tared,
            skin: patch.map(|patch| patch.skin.as_str().to_owned()),
            patch_crc: patch.map(|patch| patch.crc),
            steps: patch.map(|patch| patch.steps),
            measurements: patch.map(|patch| patch.measurements),
            pixels: patch.map(|patch| patch.pixels),
            frame_rate: patch.map(|patch| info.drive.unwrap_or(patch.drive).frame_rate),
        }
    }
}

#[pymethods]
impl Info {
    fn __repr__(&self) -> String {
        let Self { board, firmware, frame_source, tared, .. } = self;
        let skin = self.skin.as_deref().unwrap_or("no patch");
        let tared = if *tared { "tared" } else { "not tared" };
        format!("<Info {board} {firmware}, {skin}, frames {frame_source}, {tared}>")
    }
}

/// Where frames come from, in a word.
pub(crate) fn source_in_words(source: FrameSource) -> &'static str {
    match source {
        FrameSource::Skin => "skin",
        FrameSource::Simulated => "simulated",
        FrameSource::Synthetic => "synthetic",
    }
}
