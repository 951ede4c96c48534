//! Diagnosis: what is wrong by the frames that were watched, and what to do about it.

use super::{A_FEW, Watch};
use dermatome_shared::{
    frame::FrameFlags,
    health::{ElectrodeSet, Health, Vitals},
};
use serde::Serialize;

/// A contact impedance this many times the median is worth a look.
const HIGH_RATIO: f32 = 3.0;
/// Largest share of time in which the CPU may work.
const BUSY: f32 = 0.95;
/// Bytes of stack that must never have been used.
const LITTLE_STACK: u32 = 512;

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
}

/// What is known by other means, so that what follows from it is not told as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// Flags whose cause is known.
    pub flags: FrameFlags,
    /// The sheet's conductivity, which contacts below zero would tell to be another.
    pub sheet: bool,
    /// Wires are not where the patch takes them to be: a test goes through more of the sheet, and says nothing of how its
    /// contact touches beside the others.
    pub wires: bool,
}

impl Watch {
    /// What the frames say beside what is known; none if there are none. Vitals mean nothing on a simulated board.
    #[must_use]
    pub fn diagnosis(&self, is_simulated: bool, known: Known) -> Option<Diagnosis> {
        let last = self.frames.last()?;
        let electrodes = self.electrodes(known);
        let mut findings: Vec<Finding> = electrodes.iter().filter_map(finding_of_electrode).collect();
        findings.extend(self.below_zero().filter(|_| !known.sheet && !known.wires));
        let flags = self.flags().filter(|(flag, ..)| !known.flags.contains(*flag));
        findings.extend(flags.filter_map(|(flag, words, frames)| self.finding(flag, words, frames)));
        // A board that plays another instrument's frames knows none.
        let is_known = !is_simulated && last.vitals != Vitals::default();
        let vitals = is_known.then_some(last.vitals);
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
        let what = format!("contact impedances come out below zero ({median:.1} ohm)");
        let advice = "the sheet conducts better than the patch says, or it is another skin's: `dermatome check --skin SKIN` tells";
        (median < 0.0 && self.has_sound_electrodes()).then(|| Finding::new(what, advice))
    }

    fn electrodes(&self, known: Known) -> Vec<Electrode> {
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
            _ if median > 0.0 && ohms.is_some_and(|ohms| ohms > HIGH_RATIO * median) => {
                if known.wires {
                    State::Unknown
                } else {
                    State::High
                }
            }
            _ => State::Ok,
        };
        let electrode = |(electrode, &ohms): (usize, &Option<f32>)| Electrode {
            electrode,
            contact_impedance_ohm: ohms,
            state: state(electrode as u8, ohms),
        };
        means.iter().enumerate().map(electrode).collect()
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
        FrameFlags::NOT_RECIPROCAL => Some(
            "check the multiplexers' address lines; on a sheet of many kiloohms per square shorten the leads, which take \
                 current, or try a lower `dermatome drive --frequency`, or a longer `--settling`",
        ),
        FrameFlags::IMPLAUSIBLE => {
            Some("tare with nothing on the skin (`dermatome tare`); if it stays, check the wiring")
        }
        FrameFlags::MISSED => Some("lower `drive.frame_rate`, or use fewer `image.columns`"),
        FrameFlags::HOT => Some("let the board cool, and give it air"),
        // Electrodes that are open, shorted or touch worse have findings of their own, and masking follows from them.
        _ => None,
    }
}
