//! Session: a skin's patch on a board that measures that skin.

use super::super::{Failure, check};
use crate::{board::VirtualBoard, chip::time::Time, rig::Rig, world::Scene};
use dermatome::{
    link::{self, Link},
    model::Model,
    quantize,
    skin::Skin,
};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    patch::PatchView,
    protocol::{Event, FrameStamp, Selection},
};
use std::{collections::VecDeque, time::Duration};

/// Longest wait for an event, of the host's time.
const PATIENCE: Duration = Duration::from_secs(60);

/// An emulated board that measures a skin, with a host that talks to it.
pub(super) struct Session {
    pub(super) board: VirtualBoard,
    pub(super) scene: Scene,
    pub(super) skin: Skin,
    pub(super) link: Link,
    patch: Vec<u8>,
    waiting: VecDeque<Event>,
}

impl Session {
    /// A fresh board before the rig's skin, which `change` may alter first, with that skin's patch.
    pub(super) fn open(rig: &Rig, change: impl FnOnce(&mut Skin)) -> Result<Self, Failure> {
        let wrong = |error: String| Failure::Wrong(error);
        let scene = rig.emulated().scene().ok_or_else(|| wrong("the rig has no `[world]`".to_owned()))?;
        let mut skin = Skin::clone(&scene.setup().skin);
        change(&mut skin);
        let model = Model::build(&skin, |_| ()).map_err(|error| wrong(error.to_string()))?;
        let patch = quantize::patch(&skin, &model).map_err(|error| wrong(error.to_string()))?;
        let rig = rig.before(skin.clone())?;
        let board = rig.emulated().clone();
        let scene = board.scene().ok_or_else(|| wrong("the rig lost its world".to_owned()))?;
        let mut link = rig.link()?;
        link::upload(&mut link, &patch, |_| ())?;
        Ok(Self { board, scene, skin, link, patch, waiting: VecDeque::new() })
    }

    /// Greets the board again, after it has started anew.
    pub(super) fn reconnect(&mut self) -> Result<(), Failure> {
        self.waiting.clear();
        self.link = Link::connect("virtual", self.board.line())?;
        Ok(())
    }

    /// The patch.
    pub(super) fn patch(&self) -> PatchView<'_> {
        PatchView::open(&self.patch).expect("the patch was written by the host")
    }

    /// The board's front end and the drive in effect.
    pub(super) fn front_end(&mut self) -> Result<(FrontEnd, Drive), Failure> {
        let info = self.link.info()?;
        let both = info.front_end.zip(info.drive);
        both.ok_or_else(|| Failure::Wrong("the board has no front end or no drive".to_owned()))
    }

    pub(super) fn tare(&mut self, frames: u16) -> Result<(), Failure> {
        Ok(link::tare(&mut self.link, frames, PATIENCE)?)
    }

    pub(super) fn stream(&mut self, selection: Selection) -> Result<(), Failure> {
        link::stream(&mut self.link, selection)?;
        Ok(())
    }

    /// Lets virtual time pass, while nobody listens.
    pub(super) fn run(&self, time: Time) -> Result<(), Failure> {
        Ok(self.board.run(time)?)
    }

    /// The next event.
    pub(super) fn event(&mut self) -> Result<Event, Failure> {
        if let Some(event) = self.waiting.pop_front() {
            return Ok(event);
        }
        let event = self.link.next_event(PATIENCE)?;
        event.ok_or_else(|| Failure::Wrong("no event comes any more".to_owned()))
    }

    /// The next event that `choose` likes.
    pub(super) fn find<T>(&mut self, mut choose: impl FnMut(Event) -> Option<T>) -> Result<T, Failure> {
        for _ in 0..100_000 {
            if let Some(found) = choose(self.event()?) {
                return Ok(found);
            }
        }
        Err(Failure::Wrong("the event that was waited for does not come".to_owned()))
    }

    /// Volts in phase and a quarter period later of `frames` frames: `[frame][step]`.
    pub(super) fn voltages(&mut self, frames: usize) -> Result<Vec<Vec<[f64; 2]>>, Failure> {
        let (front_end, _) = self.front_end()?;
        let volts = f64::from(front_end.volts_per_code);
        self.stream(Selection { measurements: 1, ..Selection::default() })?;
        let mut found = Vec::new();
        while found.len() < frames {
            found.push(self.find(|event| match event {
                Event::Measurements { codes, quadrature, .. } => {
                    let both = codes.iter().zip(&quadrature);
                    Some(both.map(|(i, q)| [f64::from(i.0) * volts, f64::from(q.0) * volts]).collect())
                }
                _ => None,
            })?);
        }
        self.stream(Selection::default())?;
        Ok(found)
    }

    /// Stamps of `count` frames with contacts.
    pub(super) fn stamps(&mut self, count: usize) -> Result<Vec<FrameStamp>, Failure> {
        (0..count)
            .map(|_| {
                self.find(|event| match event {
                    Event::Contacts { at, .. } => Some(at),
                    _ => None,
                })
            })
            .collect()
    }

    /// When the board's own clock began, s of virtual time; right to a millisecond.
    pub(super) fn started(&mut self) -> Result<f64, Failure> {
        let uptime = self.link.info()?.uptime_ms as f64 * 1e-3;
        Ok(self.board.with(|machine| machine.now()).seconds() - uptime - 1e-3)
    }

    /// No event is lost.
    pub(super) fn check_complete(&self) -> Result<(), Failure> {
        check(self.link.events_lost() == 0, || format!("{} events are lost", self.link.events_lost()))
    }
}
