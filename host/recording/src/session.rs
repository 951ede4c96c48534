//! Session: what a recording is of.

use dermatome_shared::protocol::FrameSource;
use std::collections::BTreeMap;

/// Name of the MCAP metadata record that makes a file one of ours. One of a body tells of that, and each of its skins has one
/// of its own, named as its attachments are.
pub(crate) const METADATA: &str = "dermatome";
/// Names of the attachments; behind the space of a body's skin and a slash.
pub(crate) const PATCH: &str = "patch.dermatome";
pub(crate) const SKIN_FILE: &str = "skin.toml";
/// Keys of a body's metadata: its name, and those of its patches.
pub(crate) const BODY: &str = "body";
pub(crate) const PATCHES: &str = "patches";

/// A body whose skins are recorded together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Those of its patches: parts of topics, so without spaces.
    pub patches: Vec<String>,
}

impl Body {
    pub(crate) fn metadata(&self, host: &str) -> BTreeMap<String, String> {
        [(BODY, self.name.clone()), (PATCHES, self.patches.join(" ")), ("host", host.to_owned())]
            .map(|(key, value)| (key.to_owned(), value))
            .into()
    }

    /// Of a metadata record; none where that is of a skin.
    pub(crate) fn of_metadata(metadata: &BTreeMap<String, String>) -> Option<Self> {
        let patches = metadata.get(PATCHES)?.split_whitespace().map(str::to_owned).collect();
        Some(Self { name: metadata.get(BODY)?.clone(), patches })
    }

    /// The space of one of its patches, by which topics and attachments are named.
    #[must_use]
    pub fn space(&self, patch: &str) -> String {
        format!("{}/{patch}", self.name)
    }
}

/// The name of an attachment or metadata record of a skin, in a space where there are several.
pub(crate) fn attached(name: &str, space: Option<&str>) -> String {
    space.map_or_else(|| name.to_owned(), |space| format!("{space}/{name}"))
}

/// Where frames come from, as a file says it.
const SOURCES: [(FrameSource, &str); 3] = [
    (FrameSource::Simulated, "simulated"),
    (FrameSource::Skin, "skin"),
    (FrameSource::Synthetic, "synthetic"),
];

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Session {
    /// Name of the skin.
    pub skin: String,
    /// Kind of board.
    pub board: String,
    /// Version of its firmware.
    pub firmware: String,
    /// Where its frames came from.
    pub frame_source: FrameSource,
    /// The port that it was at.
    pub port: String,
    /// Version of the protocol that it spoke.
    pub protocol: u16,
    /// Version of the program that recorded.
    pub host: String,
    /// The patch that the board used, whole.
    pub patch: Vec<u8>,
    /// Text of the skin file, where it was known.
    pub skin_file: Option<String>,
}

impl Session {
    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        let Self { skin, board, firmware, frame_source, port, protocol, host, .. } = self;
        let protocol = protocol.to_string();
        let (_, frame_source) =
            SOURCES.iter().find(|(source, _)| source == frame_source).unwrap_or(&SOURCES[0]);
        [
            ("skin", skin),
            ("board", board),
            ("firmware", firmware),
            ("frame_source", &(*frame_source).to_owned()),
            ("port", port),
            ("protocol", &protocol),
            ("host", host),
        ]
        .map(|(key, value)| (key.to_owned(), value.clone()))
        .into()
    }

    /// Of a metadata record; what it does not hold stays empty, and its attachments follow.
    pub(crate) fn of_metadata(metadata: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| metadata.get(key).cloned().unwrap_or_default();
        let source = text("frame_source");
        let (frame_source, _) = SOURCES.iter().find(|(_, name)| *name == source).unwrap_or(&SOURCES[0]);
        Self {
            skin: text("skin"),
            board: text("board"),
            firmware: text("firmware"),
            frame_source: *frame_source,
            port: text("port"),
            protocol: text("protocol").parse().unwrap_or(0),
            host: text("host"),
            patch: Vec::new(),
            skin_file: None,
        }
    }
}
