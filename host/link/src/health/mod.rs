//! Health: what a board's frames say about electrodes, wiring and the board itself, and what to do.

mod current;
mod diagnosis;

pub use current::{FittedCurrent, fit_current};
pub use diagnosis::{Diagnosis, Electrode, Finding, Known, State};

use crate::{
    assemble::{HealthReport, ScanFrame},
    error::LinkError,
    link::Link,
};
use dermatome_shared::{
    frame::FrameFlags,
    health::{Health, Vitals},
    protocol::{FrameStamp, Selection},
};
use std::time::Duration;

/// More electrodes than this are seldom bad by themselves.
const A_FEW: usize = 3;

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

    /// Mean reciprocity error, relative; none if the patch does not measure both ways.
    #[must_use]
    pub fn reciprocity(&self) -> Option<f32> {
        let errors: Vec<f32> = self.frames.iter().filter_map(|seen| seen.health.reciprocity_error).collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f32>() / errors.len() as f32)
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

#[cfg(test)]
mod tests;
