//! Health: what a board's frames say about electrodes, wiring and the board itself, and what to do.

mod current;

pub use current::{FittedCurrent, fit_current};

use crate::{
    assemble::{HealthReport, ScanFrame},
    error::LinkError,
    link::Link,
};
use dermatome_shared::{
    frame::FrameFlags,
    health::{ElectrodeSet, Health, Vitals},
    protocol::{FrameStamp, Selection},
};
use serde::Serialize;
use std::time::Duration;

/// A contact impedance this many times the median is worth a look.
const HIGH_RATIO: f32 = 3.0;
/// Largest share of time in which the CPU may work.
const BUSY: f32 = 0.95;
/// Bytes of stack that must never have been used.
const LITTLE_STACK: u32 = 512;

/// More electrodes than this are seldom bad by themselves.
const A_FEW: usize = 3;

const BELOW_ZERO: &str = "contact impedances come out below zero";

/// Health events of some frames.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    frames: Vec<Seen>,
    /// Events that were lost on the way.
    pub events_lost: u64,
}

#[derive(Clone, Debug)]
struct Seen {
    at: FrameStamp,
    health: Health,
    vitals: Vitals,
    missed: u32,
    drift: f32,
}

/// How an electrode is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Nothing is wrong.
    Ok,
    /// It touches worse than most.
    High,
    /// It touches worse than when the reference was made.
    Worse,
    /// Its test says nothing: no current flows, or the next electrode, which it needs, is open.
    Unknown,
    /// It has no contact.
    Open,
    /// It is connected to a neighbour.
    Shorted,
}

/// One electrode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Electrode {
    /// Number, from 0.
    pub electrode: usize,
    /// Mean contact impedance, ohm; none where its test was clipped.
    pub contact_impedance_ohm: Option<f32>,
    /// How it is.
    pub state: State,
}

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What.
    pub what: String,
    /// What to do about it.
    pub advice: String,
}

impl Finding {
    fn new(what: impl Into<String>, advice: &str) -> Self {
        Self { what: what.into(), advice: advice.to_owned() }
    }
}

/// What some frames say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Frames looked at.
    pub frames: usize,
    /// Frames per second, by the board's clock; none for one frame.
    pub frames_per_second: Option<f64>,
    /// Electrodes; empty if the board does not test them.
    pub electrodes: Vec<Electrode>,
    /// Mean reciprocity error, per cent; none if the patch does not measure both ways.
    pub reciprocity_error_percent: Option<f32>,
    /// Drift of all voltages that is taken out of the images, per cent.
    pub drift_percent: f32,
    /// Frames with each flag that was set.
    pub flags: Vec<(&'static str, usize)>,
    /// Temperature of the chip, degrees Celsius, if it can tell.
    pub temperature_c: Option<f32>,
    /// Share of time in which the CPU works, per cent; none on a simulated board.
    pub load_percent: Option<f32>,
    /// Bytes of stack never used; none on a simulated board.
    pub free_stack_bytes: Option<u32>,
    /// What is wrong.
    pub findings: Vec<Finding>,
}

impl Diagnosis {
    /// Median contact impedance of the electrodes whose is known, ohm; 0 if none is.
    #[must_use]
    pub fn median_contact_ohm(&self) -> f32 {
        let known: Vec<_> = self.electrodes.iter().map(|electrode| electrode.contact_impedance_ohm).collect();
        median(&known)
    }

    /// Puts the cause in the place of what a flag alone says.
    pub fn explain(&mut self, flag: FrameFlags, cause: Finding) {
        let words =
            FrameFlags::ALL.into_iter().find(|(other, _)| *other == flag).map_or("", |(_, words)| words);
        self.findings.retain(|finding| !finding.what.starts_with(&format!("{words} in ")));
        self.findings.push(cause);
    }

    /// Takes back that contacts below zero tell another sheet: its conductivity is known by other means.
    pub fn know_sheet(&mut self) {
        self.findings.retain(|finding| !finding.what.starts_with(BELOW_ZERO));
    }

    /// Takes back what the electrodes' tests say of contacts that touch badly: where wires are not where the patch takes
    /// them to be, a test goes through more of the sheet.
    pub fn distrust_contacts(&mut self) {
        self.know_sheet();
        let high = |electrode: &&mut Electrode| electrode.state == State::High;
        for electrode in self.electrodes.iter_mut().filter(high) {
            let said = finding_of_electrode(electrode);
            self.findings.retain(|finding| Some(finding) != said.as_ref());
            electrode.state = State::Unknown;
        }
    }
}

/// Streams health for so many frames; fewer if `go_on` says no. Silence for `timeout` is an error.
pub fn watch(
    link: &mut Link,
    frames: usize,
    timeout: Duration,
    go_on: impl Fn() -> bool,
) -> Result<Watch, LinkError> {
    let mut stream = link.subscribe(Selection { health: 1, ..Selection::default() })?;
    let mut watch = Watch::default();
    while watch.frames.len() < frames && go_on() {
        let Some(frame) = stream.next_while(timeout, &go_on)? else { break };
        watch.frames.extend(Seen::of(frame));
    }
    stream.stop()?;
    watch.events_lost = link.events_lost();
    Ok(watch)
}

impl Seen {
    /// The health of a frame, if it came.
    fn of(frame: ScanFrame) -> Option<Self> {
        let HealthReport { health, vitals, drift, missed } = frame.health?;
        Some(Self { at: frame.at?, health, vitals, missed, drift })
    }
}

impl Watch {
    /// Whether the current was too large for an electrode's test.
    #[must_use]
    pub fn has_clipped_tests(&self) -> bool {
        let mut tests = self.frames.iter().flat_map(|seen| &seen.health.contact_impedance);
        tests.any(|ohms| ohms.is_infinite())
    }

    /// Whether voltages of a frame were beyond the converter's range.
    #[must_use]
    pub fn is_saturated(&self) -> bool {
        self.has(FrameFlags::SATURATED)
    }

    /// Whether voltages with drive and sense exchanged differ, and no bad electrode makes them.
    #[must_use]
    pub fn is_not_reciprocal(&self) -> bool {
        self.has(FrameFlags::NOT_RECIPROCAL) && self.has_sound_electrodes()
    }

    fn has(&self, flag: FrameFlags) -> bool {
        self.frames.iter().any(|seen| seen.at.flags.contains(flag))
    }

    /// Whether voltages that count were beyond the converter's range, or the tests of more than a few electrodes: those of
    /// one that is bad, and of its neighbours, say nothing of the current.
    #[must_use]
    pub fn has_too_much_current(&self) -> bool {
        self.frames
            .iter()
            .any(|seen| seen.at.flags.contains(FrameFlags::SATURATED) || clipped_tests(&seen.health) > A_FEW)
    }

    /// Takes contact impedances from another watch, whose current was smaller.
    pub fn take_contacts(&mut self, smaller: &Self) {
        for (seen, other) in self.frames.iter_mut().zip(smaller.frames.iter().cycle()) {
            seen.health.contact_impedance.clone_from(&other.health.contact_impedance);
        }
    }

    /// Adds ohms to all contact impedances: `[electrode]`. A board takes from its tests what the sheet adds to them by the
    /// patch's model, which is too much where the sheet conducts better.
    pub fn add_to_contacts(&mut self, ohms: &[f32]) {
        for seen in &mut self.frames {
            seen.health.contact_impedance.iter_mut().zip(ohms).for_each(|(contact, more)| *contact += more);
        }
    }

    /// Whether current flows and no frame says that an electrode is open or shorted, or touches worse than before.
    #[must_use]
    pub fn has_sound_electrodes(&self) -> bool {
        self.frames.iter().all(|seen| {
            seen.health.bad_electrodes().is_empty() && !seen.at.flags.contains(FrameFlags::NO_CURRENT)
        })
    }

    /// What the frames say; none if there are none. Vitals mean nothing on a simulated board.
    #[must_use]
    pub fn diagnosis(&self, is_simulated: bool) -> Option<Diagnosis> {
        let last = self.frames.last()?;
        let electrodes = self.electrodes();
        let mut findings: Vec<Finding> = electrodes.iter().filter_map(finding_of_electrode).collect();
        findings.extend(self.below_zero());
        findings.extend(self.flags().filter_map(|(flag, words, frames)| self.finding(flag, words, frames)));
        let vitals = (!is_simulated).then_some(last.vitals);
        findings.extend(vitals.iter().flat_map(|vitals| findings_of_vitals(vitals, last.missed)));
        if self.events_lost > 0 {
            let what = format!("{} events were lost on the way", self.events_lost);
            findings.push(Finding::new(what, "close other programs, or lower `drive.frame_rate`"));
        }
        Some(Diagnosis {
            frames: self.frames.len(),
            frames_per_second: self.rate(),
            reciprocity_error_percent: self.reciprocity().map(|error| 100.0 * error),
            drift_percent: 100.0 * last.drift,
            flags: self.flags().map(|(_, words, frames)| (words, frames)).collect(),
            temperature_c: last.vitals.temperature,
            load_percent: vitals.map(|vitals| 100.0 * vitals.load),
            free_stack_bytes: vitals.map(|vitals| vitals.free_stack),
            electrodes,
            findings,
        })
    }

    fn rate(&self) -> Option<f64> {
        let (first, last) = (self.frames.first()?.at, self.frames.last()?.at);
        let frames = last.sequence.wrapping_sub(first.sequence);
        let us = last.timestamp_us.saturating_sub(first.timestamp_us);
        (frames > 0 && us > 0).then(|| f64::from(frames) / (us as f64 * 1e-6))
    }

    /// Mean contact impedance of each electrode, ohm; none where a test was clipped.
    fn contacts(&self) -> Vec<Option<f32>> {
        let count = self.frames.iter().map(|seen| seen.health.contact_impedance.len()).max().unwrap_or(0);
        let mean = |electrode: usize| {
            let each = || self.frames.iter().filter_map(|seen| seen.health.contact_impedance.get(electrode));
            let mean = each().sum::<f32>() / each().count().max(1) as f32;
            mean.is_finite().then_some(mean)
        };
        (0..count).map(mean).collect()
    }

    /// Contacts cannot be below zero: the model is not of this sheet.
    fn below_zero(&self) -> Option<Finding> {
        let median = median(&self.contacts());
        let what = format!("{BELOW_ZERO} ({median:.1} ohm)");
        let advice = "the sheet conducts better than the patch says, or it is another skin's: `dermatome check --skin SKIN` tells";
        (median < 0.0 && self.has_sound_electrodes()).then(|| Finding::new(what, advice))
    }

    fn electrodes(&self) -> Vec<Electrode> {
        let means = self.contacts();
        let count = means.len();
        let median = median(&means);
        let ever = |pick: fn(&Health) -> ElectrodeSet| {
            self.frames.iter().fold(ElectrodeSet::default(), |set, seen| set.union(pick(&seen.health)))
        };
        let [open, shorted, worse] =
            [ever(|health| health.open), ever(|health| health.shorted), ever(|health| health.worse)];
        let is_dead = self.flags().any(|(flag, ..)| flag == FrameFlags::NO_CURRENT);
        let state = |electrode: u8, ohms: Option<f32>| match electrode {
            _ if is_dead => State::Unknown,
            e if open.contains(e) => State::Open,
            e if shorted.contains(e) => State::Shorted,
            e if open.contains((e + 1) % count.max(1) as u8) => State::Unknown,
            e if worse.contains(e) => State::Worse,
            // Below zero the sheet's share is unknown, and so is every ratio.
            _ if median > 0.0 && ohms.is_some_and(|ohms| ohms > HIGH_RATIO * median) => State::High,
            _ => State::Ok,
        };
        let electrode = |(electrode, &ohms): (usize, &Option<f32>)| Electrode {
            electrode,
            contact_impedance_ohm: ohms,
            state: state(electrode as u8, ohms),
        };
        means.iter().enumerate().map(electrode).collect()
    }

    /// Mean reciprocity error, relative; none if the patch does not measure both ways.
    #[must_use]
    pub fn reciprocity(&self) -> Option<f32> {
        let errors: Vec<f32> = self.frames.iter().filter_map(|seen| seen.health.reciprocity_error).collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f32>() / errors.len() as f32)
    }

    /// Flags that were set, each with its words and the number of frames.
    fn flags(&self) -> impl Iterator<Item = (FrameFlags, &'static str, usize)> {
        let count = |flag| self.frames.iter().filter(|seen| seen.at.flags.contains(flag)).count();
        let counted = FrameFlags::ALL.into_iter().map(move |(flag, words)| (flag, words, count(flag)));
        counted.filter(|&(.., frames)| frames > 0)
    }

    /// What follows from a flag, unless the electrodes' table says it.
    fn finding(&self, flag: FrameFlags, words: &str, frames: usize) -> Option<Finding> {
        let bad = self.frames.iter().map(|seen| seen.health.bad_electrodes().iter().count()).max()?;
        // What needs a bad electrode is not reciprocal, and counts for nothing; many of them are a multiplexer's.
        if flag == FrameFlags::NOT_RECIPROCAL && (1..=A_FEW).contains(&bad) {
            return None;
        }
        let what = format!("{words} in {frames} of {} frames", self.frames.len());
        Some(Finding::new(what, advice(flag)?))
    }
}

/// Tests that are clipped and pass no current through an electrode that is open or shorted.
fn clipped_tests(health: &Health) -> usize {
    let count = health.contact_impedance.len();
    let bad = health.open.union(health.shorted);
    let is_sound = |electrode: usize| !bad.contains((electrode % count) as u8);
    let tests = health.contact_impedance.iter().enumerate();
    // Current flows out of an electrode and into the next; the one before senses.
    tests.filter(|(e, ohms)| ohms.is_infinite() && (e + count - 1..=e + count + 1).all(is_sound)).count()
}

/// Of those that are known; 0 if none is.
fn median(ohms: &[Option<f32>]) -> f32 {
    let mut sorted: Vec<f32> = ohms.iter().flatten().copied().collect();
    sorted.sort_by(f32::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

fn finding_of_electrode(electrode: &Electrode) -> Option<Finding> {
    let number = electrode.electrode + 1;
    let (what, advice) = match electrode.state {
        State::Ok | State::Unknown => return None,
        State::High => (
            format!("electrode {number} touches worse than most"),
            "clean its contact, or press it on harder",
        ),
        State::Worse => (
            format!("electrode {number} touches worse than when the skin was tared"),
            "clean its contact, or press it on harder; until then nothing that needs it counts",
        ),
        State::Open => (format!("electrode {number} has no contact"), "check its wire, plug and contact"),
        State::Shorted => (
            format!("electrode {number} is connected to a neighbour"),
            "look for a bridge between its wire or contact and the next",
        ),
    };
    Some(Finding::new(what, advice))
}

fn findings_of_vitals(vitals: &Vitals, missed: u32) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut add = |is_so: bool, what: String, advice| {
        if is_so {
            findings.push(Finding::new(what, advice));
        }
    };
    add(
        missed > 0,
        format!("the board has lost samples {missed} times since its start"),
        "lower `drive.frame_rate`, or use fewer `image.columns`",
    );
    add(
        vitals.load > BUSY,
        format!("the CPU works {:.0} % of the time", 100.0 * vitals.load),
        "lower `drive.frame_rate`, or use fewer `image.columns`",
    );
    add(
        vitals.free_stack < LITTLE_STACK,
        format!("only {} bytes of stack were never used", vitals.free_stack),
        "please report this: the firmware needs a larger stack",
    );
    findings
}

/// What to do where a flag is set; none where another finding says it.
fn advice(flag: FrameFlags) -> Option<&'static str> {
    match flag {
        FrameFlags::SATURATED => {
            Some("lower gain or amplitude (`dermatome drive`); `dermatome scope` shows the samples")
        }
        FrameFlags::NO_CURRENT => Some("check the current source, its supply and its wire from the board"),
        FrameFlags::NOT_RECIPROCAL => {
            Some("check the multiplexers' address lines; try a longer `dermatome drive --settling`")
        }
        FrameFlags::IMPLAUSIBLE => {
            Some("tare with nothing on the skin (`dermatome tare`); if it stays, check the wiring")
        }
        FrameFlags::MISSED => Some("lower `drive.frame_rate`, or use fewer `image.columns`"),
        FrameFlags::HOT => Some("let the board cool, and give it air"),
        // Electrodes that are open, shorted or touch worse have findings of their own, and masking follows from them.
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch(flags: FrameFlags, health: &Health, vitals: Vitals, missed: u32) -> Watch {
        let at = |sequence: u32| FrameStamp { sequence, timestamp_us: u64::from(sequence) * 20_000, flags };
        let seen = |sequence| Seen { at: at(sequence), health: health.clone(), vitals, missed, drift: 0.01 };
        Watch { frames: (0..5).map(seen).collect(), events_lost: 0 }
    }

    fn healthy() -> (Health, Vitals) {
        let health = Health {
            contact_impedance: (0..8).map(|_| 30.0).collect(),
            reciprocity_error: Some(0.001),
            ..Health::default()
        };
        (health, Vitals { temperature: Some(35.0), load: 0.5, free_stack: 4096 })
    }

    #[test]
    fn a_healthy_board_has_no_findings() {
        let (health, vitals) = healthy();
        let diagnosis = watch(FrameFlags::default(), &health, vitals, 0).diagnosis(false).unwrap();
        assert_eq!(diagnosis.findings, []);
        assert!((diagnosis.frames_per_second.unwrap() - 50.0).abs() < 1e-9);
        assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Ok));
        assert_eq!(Watch::default().diagnosis(false), None);
    }

    #[test]
    fn contacts_whose_tests_were_clipped_come_from_a_watch_with_a_smaller_current() {
        let (mut health, vitals) = healthy();
        let smaller = watch(FrameFlags::default(), &health, vitals, 0);
        health.contact_impedance[2] = f32::INFINITY;
        let mut clipped = watch(FrameFlags::default(), &health, vitals, 0);
        let diagnosis = clipped.diagnosis(false).unwrap();
        assert!(clipped.has_clipped_tests() && diagnosis.findings.is_empty());
        assert!(!clipped.has_too_much_current(), "one contact alone is bad by itself");
        assert_eq!(diagnosis.electrodes[2].contact_impedance_ohm, None);
        clipped.take_contacts(&smaller);
        assert!(!clipped.has_clipped_tests());
        assert_eq!(clipped.diagnosis(false).unwrap().electrodes[2].contact_impedance_ohm, Some(30.0));
    }

    #[test]
    fn a_current_is_too_large_where_voltages_or_many_tests_clip_but_not_beside_a_bad_electrode() {
        let (healthy, vitals) = healthy();
        let is_too_large = |flags, health: &Health| watch(flags, health, vitals, 0).has_too_much_current();
        assert!(!is_too_large(FrameFlags::default(), &healthy));
        assert!(is_too_large(FrameFlags::SATURATED, &healthy));
        let clipped = |electrodes: std::ops::Range<usize>| {
            let mut health = healthy.clone();
            health.contact_impedance[electrodes].fill(f32::INFINITY);
            health
        };
        assert!(is_too_large(FrameFlags::default(), &clipped(0..4)));
        assert!(!is_too_large(FrameFlags::default(), &clipped(0..3)));
        let mut open = clipped(0..5);
        open.open.insert(1);
        assert!(!is_too_large(FrameFlags::default(), &open));
    }

    #[test]
    fn contacts_below_zero_say_that_the_model_is_not_of_this_sheet_and_blame_no_electrode() {
        let (mut health, vitals) = healthy();
        health.contact_impedance = (0..8).map(|electrode| electrode as f32 - 9.0).collect();
        let mut watch = watch(FrameFlags::default(), &health, vitals, 0);
        let diagnosis = watch.diagnosis(false).unwrap();
        assert_eq!(diagnosis.findings.len(), 1, "{diagnosis:?}");
        assert_eq!(diagnosis.findings[0].what, "contact impedances come out below zero (-5.0 ohm)");
        assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Ok));
        watch.add_to_contacts(&[30.0; 8]);
        assert_eq!(watch.diagnosis(false).unwrap().findings, []);
    }

    #[test]
    fn contacts_are_distrusted_where_wires_are_wrong() {
        let (mut health, vitals) = healthy();
        health.contact_impedance[4] = 200.0;
        let mut diagnosis = watch(FrameFlags::MISSED, &health, vitals, 0).diagnosis(false).unwrap();
        assert_eq!((diagnosis.findings.len(), diagnosis.electrodes[4].state), (2, State::High));
        diagnosis.distrust_contacts();
        assert_eq!((diagnosis.findings.len(), diagnosis.electrodes[4].state), (1, State::Unknown));
    }

    #[test]
    fn every_fault_has_a_finding() {
        let (mut health, vitals) = healthy();
        health.open.insert(2);
        health.shorted.insert(5);
        health.worse.insert(3);
        health.contact_impedance[1] = 80.0;
        health.contact_impedance[7] = 200.0;
        health.open.insert(6);
        let vitals = Vitals { load: 0.99, free_stack: 100, ..vitals };
        let all = FrameFlags::ALL.iter().fold(0, |bits, (flag, _)| bits | flag.0) & !FrameFlags::NO_CURRENT.0;
        let diagnosis = watch(FrameFlags(all), &health, vitals, 3).diagnosis(false).unwrap();
        let whats: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.what.as_str()).collect();
        for words in [
            "electrode 3 has no contact",
            "electrode 7 has no contact",
            "electrode 6 is connected to a neighbour",
            "electrode 4 touches worse than when the skin was tared",
            "electrode 8 touches worse than most",
            "saturated in 5 of 5 frames",
            "not reciprocal in 5 of 5 frames",
            "implausible in 5 of 5 frames",
            "samples missed in 5 of 5 frames",
            "chip too hot in 5 of 5 frames",
            "the board has lost samples 3 times since its start",
            "the CPU works 99 % of the time",
            "only 100 bytes of stack were never used",
        ] {
            assert!(whats.contains(&words), "{words} not in {whats:?}");
        }
        assert_eq!(whats.len(), 13);
    }

    #[test]
    fn an_open_electrode_is_no_multiplexer() {
        let (mut health, vitals) = healthy();
        let whats = |health: &Health| {
            let diagnosis = watch(FrameFlags::NOT_RECIPROCAL, health, vitals, 0).diagnosis(false).unwrap();
            diagnosis.findings.into_iter().map(|finding| finding.what).collect::<Vec<_>>()
        };
        assert_eq!(whats(&health), ["not reciprocal in 5 of 5 frames"]);
        health.open.insert(2);
        assert_eq!(whats(&health), ["electrode 3 has no contact"]);
    }

    #[test]
    fn without_current_no_electrode_is_blamed() {
        let (mut health, vitals) = healthy();
        health.contact_impedance[7] = 200.0;
        let diagnosis = watch(FrameFlags::NO_CURRENT, &health, vitals, 0).diagnosis(false).unwrap();
        assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Unknown));
        assert_eq!(diagnosis.findings.len(), 1);
        assert_eq!(diagnosis.findings[0].what, "no current in 5 of 5 frames");
    }

    #[test]
    fn a_simulated_board_has_no_vitals_to_judge() {
        let (health, _) = healthy();
        let diagnosis = watch(FrameFlags::default(), &health, Vitals::default(), 0).diagnosis(true).unwrap();
        assert_eq!((diagnosis.findings.len(), diagnosis.free_stack_bytes), (0, None));
    }
}
