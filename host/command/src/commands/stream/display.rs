//! Display: frames on the terminal, or contacts as lines for a pipe.

use super::gap::Gap;
use crate::commands::{
    contact_lines::{contact_lines, json_line},
    lines::Lines,
};
use dermatome_link::{
    Link, ScanFrame,
    contacts::{LinkFinger, LinkFrame, LinkReflexes},
    pose::Pose,
};
use dermatome_model::{multi_contact::FittedContact, skin::Skin};
use dermatome_patch::layout::Layout;
use dermatome_shared::{contact::Contacts, pipeline::reflex::Reflexes};
use dermatome_view::{
    live::{Live, Shown},
    terminal::Screen,
};
use serde_json::json;
use std::{io, time::SystemTime};

/// Where frames go, and in whose frame their contacts lie.
pub(super) enum Display<'a> {
    /// Pictures, drawn in place; contacts on the link, if a skin's pose on one is known.
    Terminal(Box<Live>, Option<&'a Pose>),
    /// One line per contact, in the skin's frame.
    Lines(Lines),
    /// One line of JSON per frame, in the frame of the link.
    LinkFrames(Lines, &'a Pose),
}

impl<'a> Display<'a> {
    /// Pictures if standard output is a terminal, with the board's geometry if `images` are wanted. Contacts
    /// are given in the frame of the link, if a skin's pose on one is known. Fitted fingers are lines always.
    pub(super) fn new(
        link: &mut Link,
        images: bool,
        on_link: Option<&'a (Skin, Pose)>,
        is_resolved: bool,
    ) -> anyhow::Result<Self> {
        let pose = on_link.map(|(_, pose)| pose);
        if !is_resolved && Screen::default().is_visible() {
            let skin = on_link.map(|(skin, _)| skin);
            let shown = images.then(|| shown(link, skin)).transpose()?;
            return Ok(Self::Terminal(Box::new(Live::new(shown)), pose));
        }
        Ok(match pose {
            Some(pose) => Self::LinkFrames(Lines::start(dropped_as_json)?, pose),
            None => Self::Lines(Lines::start(dropped_as_text)?),
        })
    }

    pub(super) fn wants_images(&self) -> bool {
        matches!(self, Self::Terminal(live, _) if live.has_images())
    }

    /// Says what is wrong with a frame, beside lines that somebody else reads; pictures say it themselves.
    pub(super) fn warn(&self, frame: &ScanFrame, what: &[&str]) {
        let is_picture = matches!(self, Self::Terminal(..));
        if let (Some(at), false, false) = (frame.at, is_picture, what.is_empty()) {
            eprintln!("warning: frame {} has flags not seen before: {}", at.sequence, what.join(", "));
        }
    }

    /// Says that rules trip or release, beside lines.
    pub(super) fn reflexes(&self, before: Option<&Reflexes>, now: Option<&Reflexes>) {
        let (Some(now), false) = (now, matches!(self, Self::Terminal(..))) else { return };
        if before.map(Reflexes::state) != Some(now.state()) {
            eprintln!("{}", in_words(now));
        }
    }

    /// Shows in lines for somebody else that the board was lost; pictures go on.
    pub(super) fn gap(&mut self, gap: &Gap) {
        match self {
            Self::Terminal(..) => {}
            Self::Lines(lines) => lines.remark(&gap.line()),
            Self::LinkFrames(lines, _) => lines.remark(&json!({ "gap": gap }).to_string()),
        }
    }

    /// Frames that nobody got, because whoever reads standard output stalled.
    pub(super) fn dropped(&self) -> u64 {
        match self {
            Self::Terminal(..) => 0,
            Self::Lines(lines) | Self::LinkFrames(lines, _) => lines.dropped(),
        }
    }

    /// Nothing more will be shown.
    pub(super) fn end(&mut self) -> io::Result<()> {
        match self {
            Self::Terminal(..) => Ok(()),
            Self::Lines(lines) | Self::LinkFrames(lines, _) => lines.end(),
        }
    }

    /// Shows a frame that came now, with the fingers that were found in it.
    pub(super) fn show(
        &mut self,
        frame: &ScanFrame,
        fingers: Option<&[FittedContact]>,
        now: SystemTime,
    ) -> io::Result<()> {
        if let (Self::Terminal(live, _), Some(image)) = (&mut *self, &frame.image) {
            live.keep_image(image.values().collect());
        }
        let Some((at, contacts)) = frame.at.zip(frame.contacts.as_ref()) else { return Ok(()) };
        let note = frame.reflexes.as_ref().map(in_words).unwrap_or_default();
        match self {
            // Contacts are drawn with their own image.
            Self::Terminal(live, _) if live.has_images() && frame.image.is_none() => Ok(()),
            Self::Terminal(live, Some(pose)) => {
                let on_link: Contacts = contacts.iter().map(|contact| pose.contact(contact)).collect();
                live.draw_if_due(at, contacts, &on_link, &note)
            }
            Self::Terminal(live, None) => live.draw_if_due(at, contacts, contacts, &note),
            Self::Lines(_) if contacts.is_empty() => Ok(()),
            Self::Lines(lines) => lines.frame(contact_lines(at, contacts, Some(now))),
            Self::LinkFrames(lines, pose) => {
                let finger =
                    |finger: &FittedContact| LinkFinger::new(finger.position.into(), finger.strength, pose);
                let fingers = fingers.map(|all| all.iter().map(finger).collect());
                let reflexes = frame.reflexes.as_ref().map(LinkReflexes::from);
                let frame = LinkFrame { fingers, reflexes, ..LinkFrame::new(pose, at, contacts) };
                lines.frame(json_line(&frame, Some(now))?)
            }
        }
    }
}

/// What the rules say: their numbers, from 1.
fn in_words(now: &Reflexes) -> String {
    let LinkReflexes { tripped, blind, .. } = now.into();
    let blind = if blind { ", and the board cannot tell" } else { "" };
    match &tripped[..] {
        [] => format!("reflexes: no rule is tripped{blind}"),
        rules => format!("reflexes: tripped {rules:?}{blind}"),
    }
}

/// What a picture needs of the board's skin; its electrodes are in the skin file alone.
fn shown(link: &mut Link, skin: Option<&Skin>) -> anyhow::Result<Shown> {
    let electrodes = skin.map(|skin| skin.shape.electrode_centres()).unwrap_or_default();
    Ok(Shown {
        layout: Layout::from(&link.surface()?),
        threshold: link.contact_threshold()?,
        electrodes: electrodes.iter().map(|centre| [centre.x, centre.y]).collect(),
    })
}

fn dropped_as_text(frames: u64) -> String {
    format!("# {frames} frames dropped: they were not read in time")
}

fn dropped_as_json(frames: u64) -> String {
    json!({ "dropped": { "frames": frames } }).to_string()
}
