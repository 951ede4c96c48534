//! Session: a skin's patch on a board that measures that skin.

use super::super::{Failure, TIMEOUT, next_with};
use crate::{
    board::VirtualBoard,
    chip::time::Time,
    rig::{Rig, RigError},
    world::{Setup, WorldHandle},
};
use dermatome::{
    link::{self, Link, Subscription},
    model::Model,
    quantize,
    skin::Skin,
};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    patch::PatchView,
    protocol::{FrameStamp, Selection},
};

/// An emulated board that measures a skin. Its link is apart, so that the skin may change while the link is lent to a
/// stream.
pub(super) struct Session {
    pub(super) board: VirtualBoard,
    pub(super) world: WorldHandle,
    pub(super) skin: Skin,
    patch: Vec<u8>,
}

impl Session {
    /// A fresh board before the rig's skin, which `change` may alter first, with that skin's patch; and a link to it.
    pub(super) fn open(rig: &Rig, change: impl FnOnce(&mut Skin)) -> Result<(Self, Link), Failure> {
        let world = rig.emulated().world().ok_or_else(|| Failure::wrong("the rig has no `[world]`"))?;
        let mut skin = Skin::clone(&world.setup().skin);
        change(&mut skin);
        Self::before(rig, world.setup().with_skin(skin).map_err(RigError::from)?)
    }

    /// A fresh board before a world, with its skin's patch; and a link to it.
    pub(super) fn before(rig: &Rig, setup: Setup) -> Result<(Self, Link), Failure> {
        let skin = Skin::clone(&setup.skin);
        let model = Model::build(&skin, |_| ()).map_err(Failure::wrong)?;
        let patch = quantize::patch(&skin, &model).map_err(Failure::wrong)?;
        let rig = rig.before(setup)?;
        let board = rig.emulated().clone();
        let world = board.world().ok_or_else(|| Failure::wrong("the rig lost its world"))?;
        let mut link = rig.link()?;
        link::upload(&mut link, &patch, |_| ())?;
        Ok((Self { board, world, skin, patch }, link))
    }

    /// Greets the board again, after it has started anew.
    pub(super) fn reconnect(&self) -> Result<Link, Failure> {
        Ok(self.board.link()?)
    }

    /// The patch.
    pub(super) fn patch(&self) -> PatchView<'_> {
        PatchView::open(&self.patch).expect("the patch was written by the host")
    }

    /// Lets virtual time pass, while nobody listens.
    pub(super) fn run(&self, time: Time) -> Result<(), Failure> {
        Ok(self.board.run(time)?)
    }

    /// When the board's own clock began, s of virtual time; right to a millisecond.
    pub(super) fn started(&self, link: &mut Link) -> Result<f64, Failure> {
        let uptime = link.info()?.uptime_ms as f64 * 1e-3;
        Ok(self.board.with(|machine| machine.now()).seconds() - uptime - 1e-3)
    }
}

/// The board's front end and the drive in effect.
pub(super) fn front_end(link: &mut Link) -> Result<(FrontEnd, Drive), Failure> {
    let info = link.info()?;
    let both = info.front_end.zip(info.drive);
    both.ok_or_else(|| Failure::wrong("the board has no front end or no drive"))
}

pub(super) fn tare(link: &mut Link, frames: u16) -> Result<(), Failure> {
    Ok(link::tare(link, frames, TIMEOUT)?)
}

/// Volts in phase and in quadrature of `frames` frames: `[frame][step]`.
pub(super) fn voltages(link: &mut Link, frames: usize) -> Result<Vec<Vec<[f64; 2]>>, Failure> {
    let (front_end, _) = front_end(link)?;
    let volts = f64::from(front_end.volts_per_code);
    let mut stream = link.subscribe(Selection { measurements: 1, ..Selection::default() })?;
    let mut found = Vec::new();
    for _ in 0..frames {
        let (_, measured) = next_with(&mut stream, |frame| frame.measurements)?;
        let both = measured.codes.iter().zip(&measured.quadrature);
        found.push(both.map(|(i, q)| [f64::from(i.0) * volts, f64::from(q.0) * volts]).collect());
    }
    stream.stop()?;
    Ok(found)
}

/// Mean over standard deviation of each step's part in phase, dB, smallest first; of frames `[frame][step]`.
pub(super) fn signal_to_noise(frames: &[Vec<[f64; 2]>]) -> Vec<f64> {
    let ratio = |step: usize| {
        let values = || frames.iter().map(|frame| frame[step][0]);
        let mean = values().sum::<f64>() / frames.len() as f64;
        let variance = values().map(|v| (v - mean).powi(2)).sum::<f64>() / (frames.len() - 1) as f64;
        20.0 * (mean.abs() / variance.sqrt()).log10()
    };
    let mut ratios: Vec<f64> = (0..frames[0].len()).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios
}

/// Stamps of `count` frames with contacts.
pub(super) fn stamps(stream: &mut Subscription<'_>, count: usize) -> Result<Vec<FrameStamp>, Failure> {
    (0..count).map(|_| Ok(next_with(stream, |frame| frame.contacts)?.0)).collect()
}
