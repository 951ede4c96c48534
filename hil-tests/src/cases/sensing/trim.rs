//! Trim: a board whose parts are not as marked measures the plug, and is as designed from then on.

use super::{
    super::Failure,
    ensure,
    session::{self, Session},
};
use crate::{board::START_TIME, machine::Machine, rig::Rig};
use dermatome::link::{
    Link,
    trim::{self, Plug},
};
use dermatome_shared::{
    acquire::{
        FrontEnd,
        trim::{CARRIERS, Trim},
    },
    drive::Drive,
    protocol::Request,
    scan::multiplexer_word,
};

/// The board, by its number among those that the parts' tolerances make.
const BOARD: u64 = 3;
/// The plug, ohm, and how far its resistors are off, by turns above and below.
const PLUG: [f64; 2] = [2.2, 22.0];
const PLUG_TOLERANCES: [f64; 2] = [1e-2, 1e-3];
/// Places in [`CARRIERS`] that are trimmed and tried: the usual one, and the fastest up to 100 kHz.
const TRIED: [usize; 2] = [2, 3];
/// Such a board is off by at least as much as built, of the converter's range, and by at most as much once trimmed.
const AS_BUILT: f64 = 5e-3;
const TRIMMED: f64 = 2e-3;
/// How long a switched voltage of the skin settles, s.
const SETTLING: f32 = 10e-6;

pub(super) fn drawn_board(rig: &Rig) -> Result<String, Failure> {
    let world = rig.emulated().world().ok_or_else(|| Failure::wrong("the rig has no `[world]`"))?;
    let (session, mut link) = Session::before(rig, world.setup().drawn(BOARD))?;
    let front_end = trim::front_end(&mut link)?;
    let before = worst(&session, &mut link, &front_end)?;
    ensure(before > AS_BUILT, || {
        format!("as built the board is off by no more than {:.3} %", 100.0 * before)
    })?;
    let trim = trimmed(&session, &mut link, &front_end)?;
    drop(link);
    session.board.with(Machine::press_reset)?;
    session.run(START_TIME)?;
    let mut link = session.reconnect()?;
    let kept = trim::front_end(&mut link)?;
    ensure(kept.trim == trim, || "the board has another trim after a reset".to_owned())?;
    let after = worst(&session, &mut link, &kept)?;
    ensure(after <= TRIMMED, || format!("trimmed, the board is off by {:.3} %", 100.0 * after))?;
    Ok(format!(
        "worst channel of 50 and 100 kHz: {:.3} % of the converter's range as built, {:.3} % trimmed and after a reset",
        100.0 * before,
        100.0 * after
    ))
}

/// What `dermatome trim` does, at the carriers that are tried.
fn trimmed(session: &Session, link: &mut Link, front_end: &FrontEnd) -> Result<Trim, Failure> {
    let plug = Plug::new(PLUG[0], PLUG[1]);
    let ohms = std::array::from_fn(|lead| {
        let sign = if lead % 4 < 2 { 1.0 } else { -1.0 };
        plug.ohms()[lead] * (1.0 + sign * PLUG_TOLERANCES[lead % 2])
    });
    session.world.plug(Some(ohms));
    let is_tried = |setting: &trim::Setting| TRIED.contains(&setting.carrier);
    let settings: Vec<_> = trim::settings(front_end, &plug).into_iter().filter(is_tried).collect();
    let steps = link.steps()?;
    let measured = trim::measure(link, &settings, |_| true).map_err(Failure::wrong)?;
    let trim = trim::fit(front_end, &plug, &steps, &measured).map_err(Failure::wrong)?;
    link.request(&Request::Trim(trim))?;
    session.world.plug(None);
    Ok(trim)
}

/// Largest error in phase of any channel of the skin, of the converter's range at gain 1.
fn worst(session: &Session, link: &mut Link, front_end: &FrontEnd) -> Result<f64, Failure> {
    let full_scale = 1.65 / session.world.setup().analogue.amplifier.gain;
    let mut worst = 0.0_f64;
    session.world.noise(0.0);
    for carrier in TRIED {
        let frequency = CARRIERS[carrier];
        let drive = Drive {
            settling: SETTLING * frequency,
            ..Drive::new(frequency, front_end.full_scale_current, 1e3)
        };
        link.request(&Request::Drive(Some(drive)))?;
        session.world.set_frequency(frequency.into()).map_err(Failure::wrong)?;
        let volts = session::voltages(link, 1)?.remove(0);
        for (word, [real, _]) in session.patch().steps().map(multiplexer_word).zip(volts) {
            let truth = session.world.truth(word).re * f64::from(drive.amplitude);
            worst = worst.max((real - truth).abs() / full_scale);
        }
    }
    session.world.noise(1.0);
    Ok(worst)
}
