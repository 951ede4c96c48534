//! Cases of a firmware that cannot go on: it starts again and says why.

use super::{Case, Failure, ensure, next_frame, patches};
use crate::chip::map;
use crate::machine::Machine;
use crate::rig::{Capability, Rig};
use dermatome::link;
use dermatome_shared::{
    patch::PatchView,
    protocol::{MAX_PACKET_BYTES, Request, RequestPacket, Selection, encode},
    restart::Restart,
};
use std::time::Duration;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "a hung CPU is bitten by the watchdog, and the board says so",
        needs: &[Capability::BreakCpu],
        run: hangs,
    },
    Case {
        name: "an acquisition that looks at no samples while current flows is bitten as well",
        needs: &[Capability::BreakCpu],
        run: looks_away,
    },
    Case {
        name: "a flash that stays busy for ever is ended by the watchdog",
        needs: &[Capability::BreakCpu, Capability::FlashSteps],
        run: busy_for_ever,
    },
    Case {
        name: "a fault of the core restarts the board, which tells where it was",
        needs: &[Capability::BreakCpu],
        run: faults,
    },
    Case {
        name: "power and the reset button are told apart",
        needs: &[Capability::PowerCut, Capability::ResetButton],
        run: tells_causes,
    },
];

/// NVIC_ICER0 (ARMv7-M, B3.4.5).
const CLEAR_ENABLE: u32 = 0xE000_E180;

fn restart(rig: &Rig) -> Result<Restart, Failure> {
    Ok(rig.link()?.info()?.started_after)
}

fn hangs(rig: &Rig) -> Result<String, Failure> {
    rig.link()?;
    rig.emulated().with(Machine::hang);
    rig.wait(Duration::from_secs(3))?;
    let found = restart(rig)?;
    ensure(found == Restart::Watchdog, || format!("it says {found}"))?;
    Ok(String::new())
}

/// The interrupt that the acquisition runs in is switched off, and nothing else.
fn looks_away(rig: &Rig) -> Result<String, Failure> {
    let mut link = rig.link()?;
    let patch = patches::patch(64, true, 16);
    link::upload(&mut link, &patch, |_| ())?;
    let mut drive = PatchView::open(&patch).map_err(Failure::wrong)?.header.drive;
    drive.frame_rate = 1e4;
    link.request(&Request::Drive(Some(drive)))?;
    let mut stream = link.subscribe(Selection { measurements: 1, ..Selection::default() })?;
    next_frame(&mut stream)?;
    let interrupt = map::interrupt_number("FMAC");
    let (disable, bit) = (CLEAR_ENABLE + 4 * (interrupt / 32), 1 << (interrupt % 32));
    rig.emulated()
        .with(move |machine| machine.chip(|chip| chip.write(disable, 4, bit)))
        .map_err(Failure::wrong)?;
    rig.wait(Duration::from_secs(3))?;
    drop(stream);
    let found = restart(rig)?;
    ensure(found == Restart::Watchdog, || format!("it says {found}"))?;
    Ok(String::new())
}

fn busy_for_ever(rig: &Rig) -> Result<String, Failure> {
    rig.link()?;
    rig.emulated().with(|machine| machine.chip(|chip| chip.flash.stick()));
    // Erases the page of the commit record, and waits for that. Nobody waits here for the reply.
    let request = RequestPacket { sequence: 9, request: Request::BeginUpload { length: 9000, crc: 9 } };
    let mut buffer = [0; MAX_PACKET_BYTES];
    rig.send_raw(encode(&request, &mut buffer).map_err(Failure::wrong)?);
    rig.wait(Duration::from_millis(500))?;
    let busy = rig.emulated().with(|machine| machine.chip(|chip| chip.flash.operation().is_some()));
    ensure(busy, || "the flash was not asked to erase".to_owned())?;
    rig.wait(Duration::from_secs(3))?;
    let found = restart(rig)?;
    ensure(found == Restart::Watchdog, || format!("it says {found}"))?;
    Ok(String::new())
}

fn faults(rig: &Rig) -> Result<String, Failure> {
    rig.link()?;
    rig.emulated().with(Machine::inject_fault);
    rig.wait(Duration::from_millis(200))?;
    let found = restart(rig)?;
    let message = match &found {
        Restart::Crash { message } if message.contains("hard fault at 0x08") => message.to_string(),
        _ => return Err(Failure::wrong(format!("it says {found}"))),
    };
    rig.emulated().with(Machine::press_reset)?;
    let found = restart(rig)?;
    ensure(found == Restart::ResetPin, || format!("after the next reset it still says {found}"))?;
    Ok(message)
}

fn tells_causes(rig: &Rig) -> Result<String, Failure> {
    let found = restart(rig)?;
    ensure(found == Restart::PowerOn, || format!("after switching on it says {found}"))?;
    rig.emulated().with(Machine::press_reset)?;
    let found = restart(rig)?;
    ensure(found == Restart::ResetPin, || format!("after the button it says {found}"))?;
    rig.emulated().with(Machine::cut_power)?;
    let found = restart(rig)?;
    ensure(found == Restart::PowerOn, || format!("after a power cut it says {found}"))?;
    Ok(String::new())
}
