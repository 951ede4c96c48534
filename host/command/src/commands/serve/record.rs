//! Record: all skins of a body in one file, each from when its board is there.

use crate::commands::{
    outlets::{recorded_in_words, warn_of},
    outputs::Output,
};
use anyhow::Context;
use dermatome_body::{
    file::{BodyFile, Patch},
    keeper::Told,
};
use dermatome_link::pose::Pose;
use dermatome_patch::input::read_text;
use dermatome_recording::{
    session::{Body, Session},
    write::{Recorded, Recorder},
};
use dermatome_shared::protocol::PROTOCOL_VERSION;
use std::path::Path;
use toml_edit::{Array, DocumentMut, Item, Table, value};

const HOST: &str = env!("CARGO_PKG_VERSION");

/// A recording of a body.
pub(super) struct Tape {
    recorder: Recorder,
    /// Whether a skin's part has begun: `[patch]`.
    begun: Vec<bool>,
    /// Skin files as recordings hold them: `[patch]`.
    texts: Vec<String>,
    has_warned: bool,
}

/// What the patch of a board is to the recording.
pub(super) enum Begun {
    /// Its first: the skin's part of the file.
    Anew(Recorder),
    /// Another one than the skin's frames were recorded with.
    Otherwise,
}

impl Tape {
    /// Begins the file.
    pub(super) fn begin(path: &Output, file: &BodyFile) -> anyhow::Result<Self> {
        let texts = file.patches.iter().map(text_of).collect::<anyhow::Result<Vec<_>>>()?;
        let patches = file.patches.iter().map(|patch| patch.name.clone()).collect();
        let body = Body { name: file.name.clone(), patches };
        let recorder = Recorder::create_of_body(path, HOST, &body)?;
        Ok(Self { recorder, begun: vec![false; texts.len()], texts, has_warned: false })
    }

    /// A board holds this patch of the body's place `index`, as its keeper told; none of what else it told.
    pub(super) fn patch(&mut self, index: usize, patch: &Patch, told: &Told) -> Option<Begun> {
        let Told::Patch { bytes, board, firmware, frame_source, .. } = told else { return None };
        if std::mem::replace(&mut self.begun[index], true) {
            return Some(Begun::Otherwise);
        }
        let mut part = self.recorder.part(index);
        part.begin(&Session {
            skin: patch.skin.name.clone(),
            board: board.clone(),
            firmware: firmware.clone(),
            frame_source: *frame_source,
            port: patch.port.to_string(),
            protocol: PROTOCOL_VERSION,
            host: HOST.to_owned(),
            patch: bytes.clone(),
            skin_file: Some(self.texts[index].clone()),
        });
        Some(Begun::Anew(part))
    }

    /// Where what is of the whole robot is recorded.
    pub(super) fn of_robot(&self) -> Recorder {
        self.recorder.of_robot()
    }

    pub(super) fn path(&self) -> &Path {
        self.recorder.path()
    }

    /// How far it has come.
    pub(super) fn recorded(&self) -> Recorded {
        self.recorder.recorded()
    }

    /// Says once if it has ended early.
    pub(super) fn warn(&mut self) {
        self.has_warned = self.has_warned || warn_of(&self.recorder);
    }

    /// Ends the file, whose parts have ended, and says what is in it.
    pub(super) fn end(self) -> anyhow::Result<()> {
        let file = self.path().display().to_string();
        eprintln!("{}", recorded_in_words(&file, &self.recorder.finish()?));
        Ok(())
    }
}

/// The skin file of a patch, with the place that the skin has on this body.
fn text_of(patch: &Patch) -> anyhow::Result<String> {
    let name = || format!("skin file `{}`", patch.path.display());
    let text = read_text(&patch.path).with_context(name)?;
    if patch.skin.pose.as_ref() == Some(&patch.pose) {
        return Ok(text);
    }
    let mut document: DocumentMut = text.parse().with_context(name)?;
    document["pose"] = Item::Table(table_of(&patch.pose));
    Ok(document.to_string())
}

fn table_of(pose: &Pose) -> Table {
    let list = |numbers: &[f64]| value(numbers.iter().copied().collect::<Array>());
    let fields = [
        ("link", value(&pose.link)),
        ("position", list(&pose.position)),
        ("orientation", list(&pose.orientation)),
    ];
    fields.into_iter().collect()
}
