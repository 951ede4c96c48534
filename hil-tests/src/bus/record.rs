//! Record: who drove a line when and said what, and whether that was in turn.

use super::LATENCY;
use crate::chip::time::Time;
use dermatome_shared::protocol::bus::{Ear, Heard, Mark, TURN_BYTES, TURN_LAPSES_MS};

/// Who drives a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Speaker {
    /// Its host.
    Host,
    /// A board, by its place.
    Board(usize),
}

/// What happened on a line.
#[derive(Debug, Default)]
pub struct Record {
    drives: Vec<(Speaker, Time, Time)>,
    said: Vec<Said>,
}

/// A byte on the line.
#[derive(Clone, Copy, Debug)]
struct Said {
    speaker: Speaker,
    at: Time,
    byte: u8,
    collides: bool,
}

/// What a record shows.
#[derive(Debug, Default)]
pub struct Findings {
    /// Turns that were given.
    pub turns: usize,
    /// Of the turns, those that were not answered.
    pub lapsed: usize,
    /// From the arrival of each turn that was answered at its board to the board's driver, in order.
    pub latencies: Vec<Time>,
    /// Bytes of all.
    pub bytes: usize,
    /// Of these, those that collided.
    pub collided: usize,
    /// Bytes of what boards said, without marks and ends of turns.
    pub payload: usize,
}

/// A turn that was given.
#[derive(Clone, Copy)]
struct Turn {
    board: usize,
    arrived: Time,
    begun: bool,
    ended: bool,
    said: usize,
}

impl Record {
    pub(super) fn drove(&mut self, speaker: Speaker, on: Time, off: Time) {
        self.drives.push((speaker, on, off));
    }

    pub(super) fn said(&mut self, speaker: Speaker, at: Time, byte: u8, collides: bool) {
        self.said.push(Said { speaker, at, byte, collides });
    }

    /// Bytes that collided with others.
    #[must_use]
    pub fn collided(&self) -> usize {
        self.said.iter().filter(|said| said.collides).count()
    }

    /// Checks that each board drove the line in its own turns only, began them in time and ended them; `addresses` are
    /// those of the boards. Says what is wrong first, if anything is.
    pub fn check(&self, addresses: &[u8]) -> Result<Findings, String> {
        let mut findings =
            Findings { bytes: self.said.len(), collided: self.collided(), ..Findings::default() };
        let mut ears = vec![Ear::default(); addresses.len() + 1];
        let mut drives: Vec<_> =
            self.drives.iter().filter(|(speaker, ..)| *speaker != Speaker::Host).collect();
        drives.sort_by_key(|(_, on, _)| *on);
        let mut drives = drives.into_iter().peekable();
        let mut turn: Option<Turn> = None;
        for said in &self.said {
            while let Some(&&(speaker, on, _)) = drives.peek().filter(|(_, on, _)| *on < said.at) {
                check_drive(speaker, on, &mut turn, &mut findings)?;
                drives.next();
            }
            let (ear, own) = match said.speaker {
                Speaker::Host => (0, None),
                Speaker::Board(place) => (place + 1, Some(place)),
            };
            let heard = ears[ear].hear(said.byte);
            match (own, heard) {
                (None, Some(Heard::Token { mark: Mark::Turn, address })) => {
                    findings.lapsed += usize::from(turn.is_some_and(|turn| !turn.begun));
                    findings.turns += 1;
                    let board = addresses.iter().position(|&own| own == address);
                    turn = board.map(|board| Turn {
                        board,
                        arrived: said.at + LATENCY,
                        begun: false,
                        ended: false,
                        said: 0,
                    });
                }
                (Some(place), heard) => {
                    let Some(turn) = turn.as_mut().filter(|turn| turn.board == place) else {
                        return Err(format!(
                            "board {place} says {:#04x} at {}, without a turn",
                            said.byte, said.at
                        ));
                    };
                    turn.say(said, heard, addresses[place], &mut findings)?;
                }
                _ => {}
            }
        }
        drives.try_for_each(|&(speaker, on, _)| check_drive(speaker, on, &mut turn, &mut findings))?;
        findings.latencies.sort();
        Ok(findings)
    }
}

/// A board that begins to drive has the turn, and has not ended it.
fn check_drive(
    speaker: Speaker,
    on: Time,
    turn: &mut Option<Turn>,
    findings: &mut Findings,
) -> Result<(), String> {
    let Some(turn) = turn.as_mut().filter(|turn| speaker == Speaker::Board(turn.board) && !turn.ended) else {
        return Err(format!("{speaker:?} drives the line at {on}, without a turn"));
    };
    let waited = on - turn.arrived;
    if !turn.begun && waited > Time::from_millis(TURN_LAPSES_MS) {
        return Err(format!("{speaker:?} begins its turn after {waited}, at {on}"));
    }
    if !turn.begun {
        findings.latencies.push(waited);
    }
    turn.begun = true;
    Ok(())
}

impl Turn {
    fn say(
        &mut self,
        said: &Said,
        heard: Option<Heard>,
        own: u8,
        findings: &mut Findings,
    ) -> Result<(), String> {
        let at = said.at;
        if self.ended {
            return Err(format!("board {} speaks on at {at}, after it has ended its turn", self.board));
        }
        match heard {
            Some(Heard::Token { mark: Mark::End, address }) if address == own => self.ended = true,
            Some(Heard::Byte { mark: Mark::Said, address, .. }) if address == own => findings.payload += 1,
            Some(other) => return Err(format!("board {} says {other:?} at {at}", self.board)),
            None if said.byte == Mark::Said.byte(own) && self.said > TURN_BYTES => {
                return Err(format!(
                    "board {} begins a packet after {} bytes, at {at}",
                    self.board, self.said
                ));
            }
            None => {}
        }
        self.said += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn micros(micros: u64) -> Time {
        Time::from_micros(micros)
    }

    /// A host's turn for address 5 from 0 us on, and what board 0 says from this time on.
    fn record(from: u64, said: &[u8]) -> Record {
        let mut record = Record::default();
        for (place, byte) in (1..).zip([&[0][..], &Mark::Turn.block(5)].concat()) {
            record.said(Speaker::Host, micros(5 * place), byte, false);
        }
        record.drove(Speaker::Board(0), micros(from), micros(from + 5 * said.len() as u64));
        for (place, &byte) in (1..).zip(said) {
            record.said(Speaker::Board(0), micros(from + 5 * place), byte, false);
        }
        record
    }

    fn packet() -> Vec<u8> {
        [&[0, 0x35, !0x35, 7, 0, 0][..], &Mark::End.block(5)].concat()
    }

    #[test]
    fn what_a_board_says_in_its_turn_is_in_order() {
        let findings = record(165, &packet()).check(&[5]).unwrap();
        assert_eq!((findings.turns, findings.lapsed, findings.payload), (1, 0, 2));
        assert_eq!(findings.latencies, [micros(100)]);
    }

    #[test]
    fn what_a_board_says_too_late_out_of_turn_or_after_its_end_is_not() {
        let wrong = |record: Record, addresses: &[u8]| record.check(addresses).unwrap_err();
        assert!(wrong(record(10_100, &packet()), &[5]).contains("begins its turn after"));
        assert!(wrong(record(165, &packet()), &[4]).contains("without a turn"));
        assert!(wrong(record(10, &packet()), &[5]).contains("without a turn"));
        let on = [&packet()[..], &[1]].concat();
        assert!(wrong(record(165, &on), &[5]).contains("speaks on"));
        let other = [&[0][..], &Mark::End.block(4)].concat();
        assert!(wrong(record(165, &other), &[5]).contains("says Token"));
        let filler = [1; TURN_BYTES - 3];
        let long = [&[0, 0x35, !0x35][..], &filler, &[0, 0, 0x35]].concat();
        assert!(record(165, &long[..long.len() - 1]).check(&[5]).is_ok());
        assert!(wrong(record(165, &long), &[5]).contains("begins a packet after"));
    }
}
