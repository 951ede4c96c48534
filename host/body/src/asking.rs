//! Asking: what others ask of a board over a network, and when that is answered.

use crate::{
    Sense,
    keeper::{Asked, Phase, State, Told},
};
use dermatome_messages::dermatome::{DriveRequest, number_of_gain};
use dermatome_shared::drive::Drive;
use serde::{Deserialize, Serialize};

/// What became of it; as std_srvs/srv/Trigger_Response and dermatome_msgs/srv/Drive_Response.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// Whether it is done.
    pub success: bool,
    /// What is done, or why it is not, in words.
    pub message: String,
}

const GIVEN_UP: &str = "another drive was asked for before the skin was free";

/// Who waits for what they have asked of one board, by who they are.
#[derive(Debug)]
pub struct Waiting<Asker>(Vec<(Asker, Awaited)>);

/// What a request waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Awaited {
    Reference { has_begun: bool },
    Drive(Drive),
}

/// Whether a new reference can be asked for, or why not.
pub fn tare(sense: &Sense) -> Result<Asked, Outcome> {
    let state = &sense.state;
    match state.phase {
        Phase::Taring => Ok(Asked::Tare),
        Phase::Live if !(state.waits() || state.drive_waits()) => Ok(Asked::Tare),
        _ => Err(Outcome::refused(&state.text)),
    }
}

/// The drive that can be asked for, or why not.
pub fn drive(request: &DriveRequest, sense: &Sense) -> Result<Asked, Outcome> {
    let is_there = matches!(sense.state.phase, Phase::Live | Phase::Taring);
    let driven = sense.driven.as_ref().filter(|_| is_there);
    let Some(driven) = driven else { return Err(Outcome::refused(&sense.state.text)) };
    let drive = request.of(&driven.drive);
    match driven.check(&drive) {
        Err(error) => Err(Outcome::refused(error.to_string())),
        // That of now too, as it gives up another one that waits.
        Ok(()) => Ok(Asked::Drive(drive)),
    }
}

impl Outcome {
    fn done(message: impl Into<String>) -> Self {
        Self { success: true, message: message.into() }
    }

    /// Why it is not done.
    pub fn refused(message: impl Into<String>) -> Self {
        Self { success: false, message: message.into() }
    }
}

impl<Asker> Default for Waiting<Asker> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<Asker> Waiting<Asker> {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Somebody waits for this.
    pub fn add(&mut self, asker: Asker, asked: &Asked) {
        let awaited = match *asked {
            Asked::Tare => Awaited::Reference { has_begun: false },
            Asked::Drive(drive) => Awaited::Drive(drive),
        };
        self.0.push((asker, awaited));
    }

    /// Answers those who wait no longer, by what the board's keeper has told.
    pub fn hear(&mut self, told: &Told, mut answer: impl FnMut(Asker, Outcome)) {
        for (asker, mut awaited) in std::mem::take(&mut self.0) {
            match awaited.outcome(told) {
                Some(outcome) => answer(asker, outcome),
                None => self.0.push((asker, awaited)),
            }
        }
    }
}

impl Awaited {
    /// What became of it, if this tells.
    fn outcome(&mut self, told: &Told) -> Option<Outcome> {
        match (self, told) {
            (_, Told::State(state)) if !matches!(state.phase, Phase::Live | Phase::Taring) => {
                Some(Outcome::refused(&state.text))
            }
            (Self::Reference { has_begun }, Told::State(state)) => Self::reference(has_begun, state),
            (Self::Drive(wanted), Told::Driven(driven)) if driven.drive == *wanted => {
                Some(Outcome::done(in_words(&driven.drive)))
            }
            (Self::Drive(wanted), Told::NotDriven { drive, why }) if drive == wanted => {
                Some(Outcome::refused(why))
            }
            (Self::Drive(wanted), Told::GivenUp(drive)) if drive == wanted => {
                Some(Outcome::refused(GIVEN_UP))
            }
            (Self::Drive(_), Told::State(state)) if state.drive_waits() => {
                Some(Outcome::refused(&state.text))
            }
            _ => None,
        }
    }

    fn reference(has_begun: &mut bool, state: &State) -> Option<Outcome> {
        if state.phase == Phase::Taring {
            *has_begun = true;
            None
        } else if state.waits() || state.drive_waits() {
            Some(Outcome::refused(&state.text))
        } else {
            has_begun.then(|| Outcome::done("the reference is made"))
        }
    }
}

fn in_words(drive: &Drive) -> String {
    let gain = match number_of_gain(drive.gain) {
        0 => "automatic".to_owned(),
        gain => gain.to_string(),
    };
    let Drive { frequency, amplitude, frame_rate, .. } = drive;
    format!("{frequency} Hz, {amplitude} A, {frame_rate} frames a second, gain {gain}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        driven::Driven,
        keeper::{DRIVE_WAITS, WAITS},
    };

    fn state(phase: Phase, text: &str) -> Told {
        Told::State(State { phase, text: text.to_owned() })
    }

    /// What who has asked for this is answered when this is told, one after the other.
    fn answers(asked: Asked, told: &[Told]) -> Vec<Option<Outcome>> {
        let mut waiting = Waiting::default();
        waiting.add("who asks", &asked);
        let each = told.iter().map(|told| {
            let mut answered = None;
            waiting.hear(told, |asker, outcome| {
                assert_eq!(asker, "who asks");
                answered = Some(outcome);
            });
            answered
        });
        each.collect()
    }

    #[test]
    fn a_tare_is_answered_once_its_reference_is_made() {
        let frame = Told::Frame { frame: Box::default(), received_ns: 0, missing: 0 };
        let told = [
            // The end of one that was under way.
            state(Phase::Live, ""),
            frame,
            state(Phase::Taring, "averaging the untouched skin"),
            state(Phase::Live, ""),
            state(Phase::Live, ""),
        ];
        let done = Some(Outcome::done("the reference is made"));
        assert_eq!(answers(Asked::Tare, &told), [None, None, None, done.clone(), None]);
        // On a bus that carries no more.
        let thinned_out = "images of one frame in 3: the bus that the board shares carries no more";
        let told = [Phase::Live, Phase::Taring, Phase::Live].map(|phase| state(phase, thinned_out));
        assert_eq!(answers(Asked::Tare, &told), [None, None, done]);
    }

    #[test]
    fn a_tare_under_a_press_or_of_a_board_that_is_lost_is_answered_with_the_reason() {
        for (phase, why) in [(Phase::Live, WAITS), (Phase::Lost, "gone"), (Phase::NotTared, WAITS)] {
            assert_eq!(answers(Asked::Tare, &[state(phase, why)]), [Some(Outcome::refused(why))]);
        }
    }

    #[test]
    fn a_drive_is_answered_once_the_board_has_it_or_refused_it() {
        let drive = Drive::new(100e3, 1e-3, 50.0);
        let driven = |drive| Told::Driven(Box::new(Driven { drive, front_end: None }));
        let told = [driven(Drive::new(50e3, 1e-3, 50.0)), driven(drive)];
        let done = Some(Outcome::done("100000 Hz, 0.001 A, 50 frames a second, gain automatic"));
        assert_eq!(answers(Asked::Drive(drive), &told), [None, done]);
        let refused = |words: &str| [None, Some(Outcome::refused(words))];
        let not_driven = |drive| Told::NotDriven { drive, why: "no".to_owned() };
        let other = Drive::new(50e3, 1e-3, 50.0);
        assert_eq!(answers(Asked::Drive(drive), &[not_driven(other), not_driven(drive)]), refused("no"));
        let given_up = [Told::GivenUp(other), Told::GivenUp(drive)];
        assert_eq!(answers(Asked::Drive(drive), &given_up), refused(GIVEN_UP));
    }

    #[test]
    fn who_asks_for_a_drive_or_a_tare_while_a_drive_waits_is_told_that_it_does() {
        let waits = || [Some(Outcome::refused(DRIVE_WAITS))];
        for asked in [Asked::Tare, Asked::Drive(Drive::new(100e3, 1e-3, 50.0))] {
            assert_eq!(answers(asked, &[state(Phase::Live, DRIVE_WAITS)]), waits());
        }
    }
}
