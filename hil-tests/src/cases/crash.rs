//! Cases of a firmware that cannot go on: it starts again and says why.

use super::{Case, Failure, ensure, next_frame, patches};
use crate::chip::{RAM_START, map};
use crate::machine::Machine;
use crate::rig::{Capability, Rig};
use dermatome::link;
use dermatome_shared::{
    patch::PatchView,
    protocol::{MAX_PACKET_BYTES, Request, RequestPacket, Selection, encode},
    restart::Restart,
};
use std::{collections::BTreeMap, time::Duration};

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
        name: "a stack that overflows faults before it reaches a static, at any moment",
        needs: &[Capability::BreakCpu],
        run: overflows,
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

/// It starts again at once, and the watchdog's next bite is not taken for that crash.
fn faults(rig: &Rig) -> Result<String, Failure> {
    rig.link()?;
    rig.emulated().with(Machine::inject_fault);
    rig.wait(Duration::from_millis(200))?;
    let info = rig.link()?.info()?;
    let message = match &info.started_after {
        Restart::Crash { message } if message.contains("hard fault at 0x08") => message.to_string(),
        found => return Err(Failure::wrong(format!("it says {found}"))),
    };
    // Both waits for a start lie behind it.
    ensure(info.uptime_ms >= 300, || format!("it has started only {} ms ago", info.uptime_ms))?;
    hangs(rig)?;
    Ok(message)
}

/// Moments at which the stack overflows, us after each other: in sleep, in a scan's interrupts, in the tasks.
const MOMENTS: u64 = 40;

/// While the board streams, the code that runs calls itself without end. The board faults before any static has
/// changed that interrupts do not change, starts again, says why, and holds its patch.
fn overflows(rig: &Rig) -> Result<String, Failure> {
    let firmware = &rig.emulated_rig().firmware;
    let symbol = |name| firmware.symbol(name).ok_or_else(|| Failure::wrong(format!("no symbol `{name}`")));
    let (bottom, statics) = (symbol("_stack_end")?, symbol("_stack_start")?);
    ensure(bottom == u64::from(RAM_START) && statics > bottom, || {
        format!("the stack ends at {bottom:#x}: what overflows it does not leave RAM at {RAM_START:#x}")
    })?;
    let patch = patches::patch(64, true, 17);
    link::upload(&mut rig.link()?, &patch, |_| ())?;
    let mut told = BTreeMap::<String, u32>::new();
    for moment in 0..MOMENTS {
        let mut link = rig.link()?;
        let mut stream = link.subscribe(Selection { contacts: 1, health: 1, ..Selection::default() })?;
        next_frame(&mut stream)?;
        rig.wait(Duration::from_micros(997 * moment))?;
        rig.emulated().with(Machine::overflow_stack);
        rig.wait(Duration::from_millis(200))?;
        drop(stream);
        let info = rig.link()?.info()?;
        let Restart::Crash { message } = &info.started_after else {
            return Err(Failure::wrong(format!("at moment {moment} it says {}", info.started_after)));
        };
        let message = message.split(" at ").next().unwrap_or_default();
        ensure(message.starts_with("stack overflow"), || format!("at moment {moment} it says {message}"))?;
        *told.entry(message.to_owned()).or_default() += 1;
        let held = info.patch.map(|patch| patch.crc);
        let right = PatchView::open(&patch).map_err(Failure::wrong)?.crc();
        ensure(held == Some(right), || format!("at moment {moment} it holds {held:x?}"))?;
    }
    Ok(format!("{MOMENTS} moments: {told:?}"))
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
