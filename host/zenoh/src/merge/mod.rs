//! Merge: what any number of computers say of a robot's skins, as one body.
//!
//! A skin is there while a run of a program says that it serves it; the first run counts as long as it is heard. A run that
//! is gone, or silent, takes its contacts along. What is lost on the way shows as a gap in running numbers.

use crate::{
    key::Space,
    latency::{Latencies, Latency},
    listener::Heard,
    message::{Contacts, DecodeError, Stamp, State},
    offset::Offset,
    robot::PULSE,
};
use dermatome_body::{
    Body, Report, Sense,
    keeper::{self, Phase},
};
use serde::Serialize;
use std::{
    collections::{BTreeMap, HashMap},
    time::{Duration, Instant},
};

/// Most skins that are merged: a stranger may say that it serves any number.
pub const MOST_SKINS: usize = 1024;
/// Most runs that may serve one skin.
const MOST_RUNS: usize = 8;
/// Nothing heard for so long: three states have not come.
const SILENT: Duration = PULSE.saturating_mul(3);
/// A run that has started anew is not told from a second one before its predecessor is known to be gone.
const SECOND: Duration = Duration::from_secs(3);
/// Most findings that are kept.
const MOST_FINDINGS: usize = 256;

/// What has changed of a skin, by its place among the body's senses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// How its board stands.
    State(usize),
    /// Contacts of a frame have come.
    Frame(usize),
}

/// What is wrong with how a skin is served.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The skin's name.
    pub patch: String,
    /// The link that it lies on.
    pub link: String,
    /// In words.
    pub finding: String,
}

/// What became of one skin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Totals {
    /// The skin's name.
    pub patch: String,
    /// The link that it lies on.
    pub link: String,
    /// Name of the computer that serves it, or did.
    pub computer: String,
    /// How its board stands.
    pub state: Phase,
    /// Why, in words.
    pub text: String,
    /// Frames whose contacts have come here.
    pub frames: u64,
    /// Frames whose contacts were sent and have not come here.
    pub frames_lost: u64,
    /// Frames of the board that have not come to its computer.
    pub frames_missing: u64,
    /// Messages of others that claim the same skin.
    pub ignored: u64,
    /// Messages that could not be read.
    pub unreadable: u64,
    /// Times that the skin was lost.
    pub losses: u64,
    /// From the end of a scan until its contacts came here.
    pub latency: Option<Latency>,
    /// By how much the clock of its computer is ahead of this one's, ms,
    pub clock_ahead_ms: Option<f64>,
    /// and by how much that is wrong at most, and so are latencies.
    pub clock_doubt_ms: Option<f64>,
}

/// A robot's skins, whoever serves them.
pub struct Merge {
    body: Body,
    skins: BTreeMap<Space, Skin>,
    /// Of the clocks of the computers: by run.
    offsets: HashMap<u64, Offset>,
    findings: Vec<Finding>,
    /// Findings that [`Merge::take_findings`] has given.
    told: usize,
}

struct Skin {
    index: usize,
    /// Those that say they serve it, and since when.
    runs: Vec<(u64, Instant)>,
    /// The one that counts, and when it was heard last.
    speaker: Option<(u64, Instant)>,
    /// The run that was heard last, and the number of its last contacts.
    last: Option<(u64, u64)>,
    computer: String,
    lost: u64,
    ignored: u64,
    unreadable: u64,
    has_second: bool,
    latencies: Latencies,
    clock: Option<crate::offset::Answer>,
}

impl Default for Merge {
    fn default() -> Self {
        let body = Body::new(&[]);
        Self { body, skins: BTreeMap::new(), offsets: HashMap::new(), findings: Vec::new(), told: 0 }
    }
}

impl Merge {
    /// All skins that were ever there.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Takes what was heard.
    pub fn take(&mut self, heard: Heard, now: Instant) -> Vec<Change> {
        match heard {
            Heard::Alive { space, run } => self.alive(space, run, now),
            Heard::Gone { space, run } => return self.gone(&space, run, now),
            Heard::Contacts { space, stamp, contacts, received_ns } => {
                return self.contacts(&space, stamp, *contacts, received_ns, now);
            }
            Heard::State { space, stamp, state } => return self.state(&space, stamp, state, now),
            Heard::Clock { run, asked_ns, theirs_ns, answered_ns } => {
                if let Some(offset) = self.offsets.get_mut(&run) {
                    offset.hear(asked_ns, theirs_ns, answered_ns);
                }
            }
            Heard::Unreadable { space, error } => return self.unreadable(&space, &error),
        }
        Vec::new()
    }

    /// Takes away what is stale; to be called often.
    pub fn look(&mut self, now: Instant) -> Vec<Change> {
        let mut changes = Vec::new();
        for skin in self.skins.values_mut() {
            let Some((run, heard)) = skin.speaker else { continue };
            if now.duration_since(heard) < SILENT {
                continue;
            }
            // A run that has said nothing yet that is understood has nothing to lose.
            if !skin.computer.is_empty() {
                let text = format!("nothing is heard from its computer `{}`", skin.computer);
                changes.extend(lose(&mut self.body, skin.index, text));
            }
            if let Some((other, _)) = skin.runs.iter().find(|(other, _)| *other != run) {
                skin.speaker = Some((*other, now));
            }
        }
        changes
    }

    /// Findings since this was asked last.
    pub fn take_findings(&mut self) -> &[Finding] {
        let since = std::mem::replace(&mut self.told, self.findings.len());
        &self.findings[since..]
    }

    /// All findings.
    #[must_use]
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// What became of each skin.
    #[must_use]
    pub fn totals(&self) -> Vec<Totals> {
        self.skins.values().map(|skin| skin.totals(&self.body.senses()[skin.index])).collect()
    }

    fn alive(&mut self, space: Space, run: u64, now: Instant) {
        let count = self.skins.len();
        if count >= MOST_SKINS && !self.skins.contains_key(&space) {
            return;
        }
        let body = &mut self.body;
        let skin = self
            .skins
            .entry(space)
            .or_insert_with_key(|space| Skin::new(body.join(&space.patch, &space.link)));
        if skin.runs.len() < MOST_RUNS && !skin.runs.iter().any(|(other, _)| *other == run) {
            skin.runs.push((run, now));
            skin.speaker.get_or_insert((run, now));
            self.offsets.entry(run).or_default();
        }
    }

    fn gone(&mut self, space: &Space, run: u64, now: Instant) -> Vec<Change> {
        let Some(skin) = self.skins.get_mut(space) else { return Vec::new() };
        skin.runs.retain(|(other, _)| *other != run);
        let mut changes = Vec::new();
        if skin.speaker.is_some_and(|(speaker, _)| speaker == run) {
            skin.speaker = skin.runs.first().map(|(next, _)| (*next, now));
            let text = format!("its computer `{}` is gone", skin.computer);
            changes.extend(lose(&mut self.body, skin.index, text));
        }
        if !self.skins.values().any(|skin| skin.runs.iter().any(|(other, _)| *other == run)) {
            self.offsets.remove(&run);
        }
        changes
    }

    fn contacts(
        &mut self,
        space: &Space,
        stamp: Stamp,
        message: Contacts,
        received_ns: u64,
        now: Instant,
    ) -> Vec<Change> {
        let Some(skin) = self.skins.get_mut(space).filter(|skin| skin.is_served_by(stamp.run)) else {
            return Vec::new();
        };
        if !skin.hears(stamp.run, now) {
            skin.ignored += 1;
            return Vec::new();
        }
        if !skin.is_next(stamp) {
            return Vec::new();
        }
        let clock = self.offsets.get(&stamp.run).and_then(Offset::best);
        let ahead = clock.map_or(0, |clock| clock.ahead);
        let time_ns = message.ended_ns.saturating_add_signed(ahead.saturating_neg());
        if clock.is_some() {
            skin.clock = clock;
            skin.latencies.count(received_ns.wrapping_sub(time_ns) as i64);
        }
        let mut changes = Vec::new();
        changes.extend(stand(&mut self.body, skin.index, Phase::Live, String::new(), true));
        let Contacts { at, missing, contacts, .. } = message;
        self.body.report(skin.index, Report { at, time_ns, received_ns, contacts, image: None }, missing);
        changes.push(Change::Frame(skin.index));
        changes
    }

    fn state(&mut self, space: &Space, stamp: Stamp, state: State, now: Instant) -> Vec<Change> {
        let Some(skin) = self.skins.get_mut(space).filter(|skin| skin.is_served_by(stamp.run)) else {
            return Vec::new();
        };
        if skin.hears(stamp.run, now) {
            skin.computer.clone_from(&state.computer);
            return stand(&mut self.body, skin.index, state.phase, state.text, false).into_iter().collect();
        }
        let is_second =
            skin.runs.iter().any(|(run, since)| *run == stamp.run && now.duration_since(*since) > SECOND);
        if is_second && !std::mem::replace(&mut skin.has_second, true) {
            let words = format!(
                "it is served twice, by `{}` and by `{}`: only the first counts; give one of the skins another name or link",
                skin.computer, state.computer
            );
            self.find(space, words);
        }
        Vec::new()
    }

    fn unreadable(&mut self, space: &Space, error: &DecodeError) -> Vec<Change> {
        let Some(skin) = self.skins.get_mut(space) else { return Vec::new() };
        skin.unreadable += 1;
        if skin.unreadable > 1 {
            return Vec::new();
        }
        let (words, index) = match error {
            DecodeError::Version { .. } => (
                format!("its computer sends {error}: run the same version of dermatome on all computers"),
                Some(skin.index),
            ),
            _ => (format!("somebody sends under its name {error}"), None),
        };
        self.find(space, words.clone());
        let changed = index.and_then(|index| stand(&mut self.body, index, Phase::NoBoard, words, false));
        changed.into_iter().collect()
    }

    fn find(&mut self, space: &Space, finding: String) {
        if self.findings.len() < MOST_FINDINGS {
            let (patch, link) = (space.patch.clone(), space.link.clone());
            self.findings.push(Finding { patch, link, finding });
        }
    }
}

/// Its contacts are gone, whatever its board does.
fn lose(body: &mut Body, index: usize, text: String) -> Option<Change> {
    let is_lost = body.senses().get(index).is_some_and(|sense| sense.state.phase == Phase::Lost);
    if is_lost { None } else { stand(body, index, Phase::Lost, text, false) }
}

/// A board stands so; where only its phase counts, words about that stay.
fn stand(body: &mut Body, index: usize, phase: Phase, text: String, only_phase: bool) -> Option<Change> {
    let now = &body.senses().get(index)?.state;
    if now.phase == phase && (only_phase || now.text == text) {
        return None;
    }
    body.stand(index, keeper::State { phase, text });
    Some(Change::State(index))
}

impl Skin {
    fn new(index: usize) -> Self {
        Self {
            index,
            runs: Vec::new(),
            speaker: None,
            last: None,
            computer: String::new(),
            lost: 0,
            ignored: 0,
            unreadable: 0,
            has_second: false,
            latencies: Latencies::default(),
            clock: None,
        }
    }

    fn is_served_by(&self, run: u64) -> bool {
        self.runs.iter().any(|(other, _)| *other == run)
    }

    /// Whether this run is the one that counts, which is heard now.
    fn hears(&mut self, run: u64, now: Instant) -> bool {
        match &mut self.speaker {
            Some((speaker, heard)) if *speaker == run => {
                *heard = now;
                true
            }
            _ => false,
        }
    }

    /// Whether contacts are newer than the last ones; counts those between that have not come.
    fn is_next(&mut self, stamp: Stamp) -> bool {
        if let Some((run, number)) = self.last
            && run == stamp.run
        {
            if stamp.number <= number {
                return false;
            }
            self.lost += stamp.number - number - 1;
        }
        self.last = Some((stamp.run, stamp.number));
        true
    }

    fn totals(&self, sense: &Sense) -> Totals {
        Totals {
            patch: sense.name.clone(),
            link: sense.link.clone(),
            computer: self.computer.clone(),
            state: sense.state.phase,
            text: sense.state.text.clone(),
            frames: sense.frames,
            frames_lost: self.lost,
            frames_missing: sense.missing,
            ignored: self.ignored,
            unreadable: self.unreadable,
            losses: sense.losses,
            latency: self.latencies.summary(),
            clock_ahead_ms: self.clock.map(|clock| clock.ahead as f64 * 1e-6),
            clock_doubt_ms: self.clock.map(|clock| clock.doubt as f64 * 1e-6),
        }
    }
}

#[cfg(test)]
mod tests;
