//! Script: where indenters press a simulated skin, and when.

mod hand;
mod path_file;

pub use hand::{Hand, HandError};

use dermatome_geometry::outline::Outline;
use dermatome_model::indenter::{Load, Press, PressError};
use nalgebra::Vector2;
use std::{f64::consts::TAU, path::PathBuf};

/// Indenters moving over time; the script starts again when its last moment has passed.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Moments of each indenter, by time.
    fingers: Vec<Vec<Moment>>,
    duration: f64,
}

/// Where one indenter is at one time; between moments it moves steadily.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time, s.
    pub time: f64,
    /// The indenter.
    pub press: Press,
}

impl Script {
    /// A script of these fingers' moments.
    pub fn new(fingers: Vec<Vec<Moment>>, outline: &Outline) -> Result<Self, ScriptError> {
        for moment in fingers.iter().flatten() {
            moment.press.check(outline)?;
        }
        let infinite = |moments: &Vec<Moment>| moments.iter().map(|m| m.time).find(|time| !time.is_finite());
        if let Some(time) = fingers.iter().find_map(infinite) {
            return Err(ScriptError::NotFinite { time });
        }
        let disorder = |moments: &Vec<Moment>| {
            moments.windows(2).find(|pair| pair[0].time >= pair[1].time).map(|pair| pair[1].time)
        };
        if let Some(time) = fingers.iter().find_map(disorder) {
            return Err(ScriptError::Time { time });
        }
        let turncoat = |moments: &Vec<Moment>| {
            let pairs = || moments.windows(2);
            let found = pairs().find(|pair| between(&pair[0].press, &pair[1].press, 0.5).is_none());
            found.map(|pair| pair[1].time)
        };
        if let Some(time) = fingers.iter().find_map(turncoat) {
            return Err(ScriptError::Kind { time });
        }
        let duration = fingers.iter().flatten().map(|moment| moment.time).fold(0.0, f64::max);
        Ok(Self { fingers, duration })
    }

    /// Nobody presses.
    #[must_use]
    pub fn nobody() -> Self {
        Self { fingers: Vec::new(), duration: 0.0 }
    }

    /// Fingers that stay.
    pub fn still(presses: &[Press], outline: &Outline) -> Result<Self, ScriptError> {
        let still = |press: &Press| vec![Moment { time: 0.0, press: press.clone() }];
        Self::new(presses.iter().map(still).collect(), outline)
    }

    /// A finger that goes round at half way to the rim, once in eight seconds; it lifts where there
    /// is no skin.
    #[must_use]
    pub fn round(outline: &Outline) -> Self {
        let ([x, y], middle) = (outline.half_size(), outline.middle());
        let at = |i: i32| {
            let angle = f64::from(i) / 64.0 * TAU;
            let position = middle + Vector2::new(0.5 * x * angle.cos(), 0.5 * y * angle.sin());
            let depth = if outline.depth(position) > 0.0 { 1.0 } else { 0.0 };
            Moment { time: f64::from(i) / 8.0, press: Press::finger(position.into(), 0.12 * x.min(y), depth) }
        };
        Self { fingers: vec![(0..=64).map(at).collect()], duration: 8.0 }
    }

    /// This script, after which fingers that move lift for so long, s, before it starts again.
    #[must_use]
    pub fn with_pause(mut self, pause: f64) -> Self {
        self.duration += pause;
        self
    }

    /// One indenter at a time; `None` before its first and after its last moment.
    #[must_use]
    pub fn at(moments: &[Moment], time: f64) -> Option<Press> {
        finger_at(moments, time)
    }

    /// Whether any load is a pressure or a force, which says nothing without a material.
    #[must_use]
    pub fn needs_material(&self) -> bool {
        self.fingers.iter().flatten().any(|moment| !matches!(moment.press.load, Load::Change(_)))
    }

    /// The indenters that touch the skin `time` seconds into the script.
    #[must_use]
    pub fn presses(&self, time: f64) -> Vec<Press> {
        let time = if self.duration > 0.0 { time % self.duration } else { 0.0 };
        self.fingers
            .iter()
            .filter_map(|moments| finger_at(moments, time))
            .filter(|press| press.load.value() != 0.0)
            .collect()
    }
}

/// Before its first and after its last moment an indenter is lifted, unless that is its only one.
fn finger_at(moments: &[Moment], time: f64) -> Option<Press> {
    if let [only] = moments {
        return Some(only.press.clone());
    }
    let pair = moments.windows(2).find(|pair| pair[0].time <= time && time <= pair[1].time)?;
    between(&pair[0].press, &pair[1].press, (time - pair[0].time) / (pair[1].time - pair[0].time))
}

/// What is `share` of the way from one press to another; `None` if they are of different kinds.
fn between(from: &Press, to: &Press, share: f64) -> Option<Press> {
    let mix = |a: f64, b: f64| a + (b - a) * share;
    Some(Press {
        position: [0, 1].map(|axis| mix(from.position[axis], to.position[axis])),
        angle: mix(from.angle, to.angle),
        footprint: from.footprint.towards(&to.footprint, share)?,
        load: from.load.towards(to.load, share)?,
    })
}

/// A loading machine: it brings one indenter to its load and back in equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadingMachine {
    /// Steps up, and as many down.
    pub steps: u32,
    /// Time of each step, s, of which a tenth goes into the change of load.
    pub hold: f64,
}

impl LoadingMachine {
    /// Shares of the full load, one for each step: up from nothing, and down to nothing again.
    pub fn shares(&self) -> impl Iterator<Item = f64> + use<> {
        let steps = self.steps.max(1);
        (0..=steps).chain((0..steps).rev()).map(move |step| f64::from(step) / f64::from(steps))
    }

    /// Moments of an indenter under the machine, `full` being the press under full load.
    #[must_use]
    pub fn moments(&self, full: &Press) -> Vec<Moment> {
        let at = |time: f64, share: f64| {
            let load = full.load.with(full.load.value() * share);
            Moment { time, press: Press { load, ..full.clone() } }
        };
        let held = |(step, share): (u32, f64)| {
            let begin = f64::from(step) * self.hold;
            [at(begin, share), at(begin + 0.9 * self.hold, share)]
        };
        (0..).zip(self.shares()).flat_map(held).collect()
    }
}

/// Why a script cannot be played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScriptError {
    /// A press makes no sense.
    #[error(transparent)]
    Press(#[from] PressError),
    /// A moment that never comes.
    #[error("time {time} s is not a finite number; allowed: ascending times for each finger")]
    NotFinite {
        /// The time.
        time: f64,
    },
    /// Moments of a finger are not in order.
    #[error("time {time} s is not later than the moment before it; allowed: ascending times for each finger")]
    Time {
        /// The time.
        time: f64,
    },
    /// An indenter becomes another one, or its load another kind of load.
    #[error(
        "at time {time} s the indenter's shape or kind of load changes; allowed: one shape and one kind of load \
         for each finger"
    )]
    Kind {
        /// The time.
        time: f64,
    },
    /// The file cannot be used.
    #[error("path script `{}`: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_model::indenter::Footprint;

    #[test]
    fn a_loading_machine_steps_up_and_down_and_holds() {
        let full = Press::new(Footprint::Square { side: 0.02 }, [0.0; 2], Load::Pressure(20e3));
        let machine = LoadingMachine { steps: 4, hold: 10.0 };
        assert_eq!(machine.shares().collect::<Vec<_>>(), [0.0, 0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.25, 0.0]);
        let script = Script::new(vec![machine.moments(&full)], &Outline::disc(0.1)).unwrap();
        assert!(script.needs_material());
        for (time, expected) in [(12.0, 5e3), (18.9, 5e3), (19.5, 7.5e3), (41.0, 20e3), (58.0, 15e3)] {
            let [press] = &script.presses(time)[..] else { panic!("{time}") };
            let pressure = press.mean_pressure().unwrap();
            assert!((pressure - expected).abs() < 1e-6, "{time}: {pressure}");
        }
        assert_eq!(script.presses(5.0), []);
    }

    #[test]
    fn in_the_pause_nothing_presses_and_then_it_starts_again() {
        let outline = Outline::disc(0.1);
        let (round, pausing) = (Script::round(&outline), Script::round(&outline).with_pause(4.0));
        for time in [0.0, 3.25, 7.875] {
            let presses = pausing.presses(time);
            assert_eq!((presses.len(), &presses), (1, &round.presses(time)));
            assert_eq!(pausing.presses(12.0 + time), presses);
        }
        for time in [8.1, 11.9] {
            assert_eq!(pausing.presses(time), []);
        }
    }

    #[test]
    fn shapes_move_turn_and_grow_and_never_become_others() {
        let square = |side, load| Press::new(Footprint::Square { side }, [0.0; 2], Load::Force(load));
        let moments = |from, to| vec![Moment { time: 0.0, press: from }, Moment { time: 2.0, press: to }];
        let outline = Outline::disc(0.1);
        let end = Press { angle: 1.0, position: [0.02, 0.0], ..square(0.75, 3.0) };
        let script = Script::new(vec![moments(square(0.25, 1.0), end)], &outline).unwrap();
        let middle = Press { angle: 0.5, position: [0.01, 0.0], ..square(0.5, 2.0) };
        assert_eq!(script.presses(1.0), [middle]);
        let refused =
            Script::new(vec![moments(square(0.01, 1.0), Press::finger([0.0; 2], 0.01, 1.0))], &outline);
        assert_eq!(refused, Err(ScriptError::Kind { time: 2.0 }));
    }
}
