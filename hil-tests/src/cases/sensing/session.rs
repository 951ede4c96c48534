//! Session: a skin's patch on a board that measures that skin.

use super::super::{Failure, ensure};
use crate::{board::VirtualBoard, chip::time::Time, rig::Rig, world::WorldHandle};
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

/// Timeout of an event, in the host's time.
const TIMEOUT: Duration = Duration::from_secs(60);

/// An emulated board that measures a skin, with a host that talks to it.
pub(super) struct Session {
    pub(super) board: VirtualBoard,
    pub(super) world: WorldHandle,
    pub(super) skin: Skin,
    pub(super) link: Link,
    patch: Vec<u8>,
    waiting: VecDeque<Event>,
}

impl Session {
    /// A fresh board before the rig's skin, which `change` may alter first, with that skin's patch.
    pub(super) fn open(rig: &Rig, change: impl FnOnce(&mut Skin)) -> Result<Self, Failure> {
        let world = rig.emulated().world().ok_or_else(|| Failure::wrong("the rig has no `[world]`"))?;
        let mut skin = Skin::clone(&world.setup().skin);
        change(&mut skin);
        let model = Model::build(&skin, |_| ()).map_err(Failure::wrong)?;
        let patch = quantize::patch(&skin, &model).map_err(Failure::wrong)?;
        let rig = rig.before(skin.clone())?;
        let board = rig.emulated().clone();
        let world = board.world().ok_or_else(|| Failure::wrong("the rig lost its world"))?;
        let mut link = rig.link()?;
        link::upload(&mut link, &patch, |_| ())?;
        Ok(Self { board, world, skin, link, patch, waiting: VecDeque::new() })
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
        both.ok_or_else(|| Failure::wrong("the board has no front end or no drive"))
    }

    pub(super) fn tare(&mut self, frames: u16) -> Result<(), Failure> {
        Ok(link::tare(&mut self.link, frames, TIMEOUT)?)
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
        let event = self.link.next_event(TIMEOUT)?;
        event.ok_or_else(|| Failure::wrong("no event comes any more"))
    }

    /// The next event that `choose` likes.
    pub(super) fn find<T>(&mut self, mut choose: impl FnMut(Event) -> Option<T>) -> Result<T, Failure> {
        for _ in 0..100_000 {
            if let Some(found) = choose(self.event()?) {
                return Ok(found);
            }
        }
        Err(Failure::wrong("the event that was waited for does not come"))
    }

    /// Volts in phase and in quadrature of `frames` frames: `[frame][step]`.
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
        ensure(self.link.events_lost() == 0, || format!("{} events are lost", self.link.events_lost()))
    }
}
