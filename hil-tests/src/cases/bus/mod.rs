//! Cases of boards on one line: each speaks in its turn and in no other, whatever happens to it, to the line and to
//! the others. What the line's own record shows is checked after each of them.

mod turns;

use super::{
    Case, Failure, TIMEOUT, ensure, ensure_complete, ensure_up, ensure_uploads_at_once, next_frame, patches,
};
use crate::{
    bus::{Bus, Line, master::Master, record::Findings},
    chip::{flash::Flash, time::Time},
    machine::{Halt, Machine},
    rig::{Capability, Rig},
};
use dermatome::link::{self, Link};
use dermatome_shared::{
    drive::Drive,
    frame::FrameFlags,
    protocol::{
        MAX_PACKET_BYTES, Request, Selection,
        bus::{ADDRESSES, Mark},
    },
    restart::Restart,
};
use std::sync::{Mutex, PoisonError};

const NEEDS: &[Capability] = &[Capability::SharedLine];

pub(super) const CASES: &[Case] = &[
    Case { name: "three boards on one line stream contacts, and lose none", needs: NEEDS, run: three_stream },
    Case {
        name: "a board alone on a line takes a patch and streams contacts and images",
        needs: NEEDS,
        run: alone,
    },
    Case { name: "a line with noise, resets and lost power goes on", needs: NEEDS, run: disturbed },
    Case {
        name: "two boards of one address damage what they say, and no more",
        needs: NEEDS,
        run: same_address,
    },
    Case { name: "a board that hangs in its turn leaves the line", needs: NEEDS, run: hangs },
    Case {
        name: "a turn that comes while the CPU stands still lapses, or is answered in time",
        needs: NEEDS,
        run: turns::stands_still,
    },
    Case {
        name: "a turn that comes before a board knows that its last one has ended is answered",
        needs: NEEDS,
        run: turns::follows_at_once,
    },
    Case { name: "a turn that fills a read", needs: NEEDS, run: turns::fills_a_read },
    Case { name: "each address is heard by its board alone", needs: NEEDS, run: addresses },
];

/// Bytes of stack that the firmware has (firmware/memory).
const STACK: u32 = 30_720;

/// All that a frame shows of contacts.
const CONTACTS: Selection =
    Selection { images: 0, contacts: 1, measurements: 0, health: 100, scope: 0, scope_slot: 0 };

/// A flash with the firmware and the rig's skin's patch, which a board of its own has taken over the line. Cases that
/// need it share it.
fn flashed(rig: &Rig) -> Result<Flash, Failure> {
    static FLASH: Mutex<Option<Flash>> = Mutex::new(None);
    let mut made = FLASH.lock().unwrap_or_else(PoisonError::into_inner);
    let flash = if let Some(flash) = made.take() { flash } else { flash_one(rig)? };
    Ok(made.insert(flash).clone())
}

fn flash_one(rig: &Rig) -> Result<Flash, Failure> {
    let bus = rig.bus().start(&[0], &rig.bus().flash())?;
    bus.with(Line::take_record);
    link::upload(&mut Master::new(bus.clone(), &[0]).link(0)?, &patches::shipped("disc-210mm")?, |_| ())?;
    checked(&bus, &[0])?;
    Ok(bus.with(|line| line.machine(0).chip(|chip| chip.flash.clone())))
}

/// What the line's record shows, if all was in turn.
fn checked(bus: &Bus, addresses: &[u8]) -> Result<Findings, Failure> {
    let record = bus.with(Line::take_record);
    record.check(addresses).map_err(Failure::wrong)
}

/// The same, where nothing collided.
fn checked_clean(bus: &Bus, addresses: &[u8]) -> Result<Findings, Failure> {
    let findings = checked(bus, addresses)?;
    ensure(findings.collided == 0, || format!("{} bytes collided", findings.collided))?;
    Ok(findings)
}

fn now(bus: &Bus) -> Time {
    bus.with(|line| line.now())
}

/// How long a board's CPU has slept, s.
fn slept(bus: &Bus, board: usize) -> f64 {
    bus.with(move |line| line.machine(board).slept().seconds())
}

fn millis(time: Time) -> f64 {
    time.seconds() * 1e3
}

/// Median and longest time to an answer, in words.
fn latency(findings: &Findings) -> String {
    let (median, worst) = (findings.latencies.get(findings.latencies.len() / 2), findings.latencies.last());
    let [median, worst] = [median, worst].map(|time| time.copied().map_or(f64::NAN, millis));
    format!("{median:.3} ms to an answer (median), {worst:.3} at most")
}

/// Since this time, in words.
fn utilisation(findings: &Findings, bus: &Bus, since: Time) -> String {
    let share = |bytes: usize| 100.0 * 5e-6 * bytes as f64 / now(bus).since(since).seconds();
    format!("line busy {:.0} %, {:.0} % with packets", share(findings.bytes), share(findings.payload))
}

fn alone(rig: &Rig) -> Result<String, Failure> {
    let bus = rig.bus().start(&[0], &rig.bus().flash())?;
    bus.with(|line| line.let_hear_itself(0, true));
    bus.with(Line::take_record);
    let mut link = Master::new(bus.clone(), &[0]).link(0)?;
    let board = link.identity().board.clone();
    let patch = patches::shipped("disc-210mm")?;
    let since = now(&bus);
    link::upload(&mut link, &patch, |_| ())?;
    let upload = now(&bus).since(since).seconds();
    checked_clean(&bus, &[0])?;
    link::tare(&mut link, 20, TIMEOUT)?;
    let since = now(&bus);
    let mut stream = link.subscribe(Selection { images: 1, ..CONTACTS })?;
    let (mut images, mut load, mut free_stack) = (0, 0.0_f32, u32::MAX);
    for _ in 0..150 {
        let frame = next_frame(&mut stream)?;
        images += usize::from(frame.image.is_some());
        ensure(frame.contacts.is_some(), || "a frame has no contacts".to_owned())?;
        if let Some(health) = frame.health {
            load = load.max(health.vitals.load);
            free_stack = free_stack.min(health.vitals.free_stack);
        }
    }
    ensure_complete(&mut stream)?;
    drop(stream);
    // As of a board alone.
    ensure(free_stack >= STACK / 4, || format!("{free_stack} bytes of stack are free"))?;
    ensure(images >= 149, || format!("{images} images in 150 frames"))?;
    let findings = checked_clean(&bus, &[0])?;
    ensure(findings.lapsed == 0, || format!("{} turns were not answered", findings.lapsed))?;
    Ok(format!(
        "{board}, which hears itself, {free_stack} bytes of its stack free: {} bytes uploaded in {upload:.2} s; {images} images, {}; {}; CPU {:.0} %",
        patch.len(),
        latency(&findings),
        utilisation(&findings, &bus, since),
        100.0 * load
    ))
}

/// Boards at these addresses with the disc's patch, tared, and their links.
fn tared(rig: &Rig, addresses: &[u8]) -> Result<(Bus, Master, Vec<Link>), Failure> {
    let bus = rig.bus().start(addresses, &flashed(rig)?)?;
    bus.with(Line::take_record);
    let master = Master::new(bus.clone(), addresses);
    let mut links: Vec<Link> =
        (0..addresses.len()).map(|place| master.link(place)).collect::<Result<_, _>>()?;
    for link in &mut links {
        let drive = link.info()?.drive.ok_or_else(|| Failure::wrong("the board has no drive"))?;
        link.request(&Request::Drive(Some(Drive { frame_rate: 200.0, ..drive })))?;
        link::tare(link, 20, TIMEOUT)?;
    }
    Ok((bus, master, links))
}

fn three_stream(rig: &Rig) -> Result<String, Failure> {
    const FRAMES: usize = 300;
    let addresses = [0, 1, 2];
    let (bus, _, mut links) = tared(rig, &addresses)?;
    checked_clean(&bus, &addresses)?;
    let since = now(&bus);
    let mut streams = links
        .iter_mut()
        .map(|link| link.subscribe(Selection { images: 7, ..CONTACTS }))
        .collect::<Result<Vec<_>, _>>()?;
    let (mut load, mut missed) = (0.0_f32, 0);
    for _ in 0..FRAMES {
        for stream in &mut streams {
            let frame = next_frame(stream)?;
            missed += usize::from(frame.at.is_some_and(|at| at.flags.contains(FrameFlags::MISSED)));
            ensure(frame.contacts.is_some(), || "a frame has no contacts".to_owned())?;
            load = load.max(frame.health.map_or(0.0, |health| health.vitals.load));
        }
    }
    let rate = FRAMES as f64 / now(&bus).since(since).seconds();
    streams.iter_mut().try_for_each(ensure_complete)?;
    drop(streams);
    let findings = checked_clean(&bus, &addresses)?;
    ensure(findings.lapsed == 0, || format!("{} turns were not answered", findings.lapsed))?;
    ensure(rate > 95.0, || format!("{rate:.1} frames a second"))?;
    ensure(missed == 0, || {
        format!("{missed} frames say that samples were missed, at {rate:.1} frames a second")
    })?;
    for link in &mut links {
        link.info()?;
    }
    Ok(format!(
        "{FRAMES} frames of each, {rate:.1} a second; {} turns, {}; {}; CPU at most {:.0} %",
        findings.turns,
        latency(&findings),
        utilisation(&findings, &bus, since),
        100.0 * load
    ))
}

/// Gives a board that streams its turn, and lets time pass until it drives the line, as long as a turn may take to be
/// answered. It has more to say by then than a slice carries.
fn until_it_speaks(line: &mut Line, board: usize, address: u8) -> Result<(), Halt> {
    line.run_until(line.now() + Time::from_millis(30))?;
    line.say(&[&[0][..], &Mark::Turn.block(address)].concat());
    let end = line.now() + Time::from_millis(12);
    while !line.drives(board) && line.now() < end {
        line.run_slice()?;
    }
    Ok(())
}

/// Interrupts a board in the middle of its turn. Says whether it drove the line before, and after.
fn in_its_turn(
    bus: &Bus,
    board: usize,
    address: u8,
    what: impl FnOnce(&mut Machine) -> Result<(), Halt> + Send + 'static,
) -> Result<(bool, bool), Failure> {
    Ok(bus.with(move |line| {
        until_it_speaks(line, board, address)?;
        let before = line.drives(board);
        what(line.machine(board))?;
        Ok::<_, Halt>((before, line.drives(board)))
    })?)
}

fn disturbed(rig: &Rig) -> Result<String, Failure> {
    let addresses = [0, 1, 2];
    let (bus, master, mut links) = tared(rig, &addresses)?;
    for link in &mut links[1..] {
        link.request(&Request::Stream(Selection { measurements: 1, ..CONTACTS }))?;
    }
    checked_clean(&bus, &addresses)?;
    let since = now(&bus);
    {
        let mut stream = links[0].subscribe(CONTACTS)?;
        master.run(Time::from_millis(200))?;
        let drove = in_its_turn(&bus, 1, 1, Machine::press_reset)?;
        ensure(drove == (true, false), || format!("reset in its turn: it drove the line {drove:?}"))?;
        master.run(Time::from_millis(400))?;
        let drove = bus.with(|line| {
            until_it_speaks(line, 2, 2)?;
            let before = line.drives(2);
            line.cut_power(2)?;
            Ok::<_, Halt>((before, line.drives(2)))
        })?;
        ensure(drove == (true, false), || format!("without power in its turn: it drove the line {drove:?}"))?;
        let lapsed = master.lapsed(2);
        master.run(Time::from_millis(300))?;
        ensure(master.lapsed(2) > lapsed, || "a board without power answers its turns".to_owned())?;
        bus.with(|line| line.restore_power(2));
        master.run(Time::from_millis(400))?;
        let frames = (100.0 * now(&bus).since(since).seconds()) as usize - 2;
        for _ in 0..frames {
            let frame = next_frame(&mut stream)?;
            ensure(frame.contacts.is_some(), || "a frame has no contacts".to_owned())?;
        }
        ensure_complete(&mut stream)?;
    }
    ensure(master.lapsed(0) == 0, || format!("{} turns of board 0 were not answered", master.lapsed(0)))?;
    ensure_up(&mut links[1], &Restart::ResetPin)?;
    ensure_up(&mut links[2], &Restart::PowerOn)?;
    checked_clean(&bus, &addresses)?;
    // What is lost now is lost for good: these only keep the line busy.
    for link in &mut links {
        link.request(&Request::Stream(CONTACTS))?;
    }
    let lapsed = |master: &Master| -> usize { (0..3).map(|place| master.lapsed(place)).sum() };
    let before = lapsed(&master);
    bus.with(|line| line.disturb(700, 5));
    master.run(Time::from_millis(2000))?;
    bus.with(|line| line.disturb(0, 0));
    let lost = lapsed(&master) - before;
    let findings = checked_clean(&bus, &addresses)?;
    ensure(lost > 0, || "no noise was noticed".to_owned())?;
    master.run(Time::from_millis(50))?;
    let after = lapsed(&master);
    master.run(Time::from_millis(200))?;
    ensure(lapsed(&master) == after, || "turns lapse after the noise".to_owned())?;
    for (link, started) in links.iter_mut().zip([Restart::PowerOn, Restart::ResetPin, Restart::PowerOn]) {
        ensure_up(link, &started)?;
    }
    checked_clean(&bus, &addresses)?;
    Ok(format!("one symbol in 700 damaged: {lost} of {} turns without an end", findings.turns))
}

fn same_address(rig: &Rig) -> Result<String, Failure> {
    let bus = rig.bus().start(&[0, 3, 3], &rig.bus().flash())?;
    bus.with(Line::take_record);
    let master = Master::new(bus.clone(), &[0, 3]);
    let mut link = master.link(0)?;
    let mut collided = Vec::new();
    for hear_themselves in [false, true] {
        bus.with(move |line| [1, 2].map(|board| line.let_hear_itself(board, hear_themselves)));
        let lapsed = [0, 1].map(|place| master.lapsed(place));
        master.run(Time::from_millis(500))?;
        link.info()?;
        ensure(master.lapsed(0) == lapsed[0], || {
            "the board with an address of its own is disturbed".to_owned()
        })?;
        ensure(master.lapsed(1) > lapsed[1] + 5, || "two boards of one address answer as one".to_owned())?;
        collided.push(bus.with(Line::take_record).collided());
    }
    ensure(collided.iter().all(|&bytes| bytes > 20), || format!("{collided:?} bytes collided"))?;
    // Without the other one it is understood, and has been up all the time.
    bus.with(|line| line.cut_power(2))?;
    master.run(Time::from_millis(20))?;
    let info = master.link(1)?.info()?;
    let up = now(&bus).nanoseconds() / 1_000_000;
    ensure(info.uptime_ms + 100 > up, || format!("it is up for {} ms of {up}", info.uptime_ms))?;
    Ok(format!("{} bytes collided, {} where they hear themselves", collided[0], collided[1]))
}

fn hangs(rig: &Rig) -> Result<String, Failure> {
    let addresses = [0, 1];
    let (bus, master, mut links) = tared(rig, &addresses)?;
    links[1].request(&Request::Stream(Selection { images: 1, ..CONTACTS }))?;
    master.run(Time::from_millis(100))?;
    let drove = in_its_turn(&bus, 1, 1, |machine| {
        machine.hang();
        Ok(())
    })?;
    ensure(drove == (true, true), || format!("it hangs in its turn: it drove the line {drove:?}"))?;
    let drives = bus.with(|line| {
        let begun = line.now();
        while line.drives(1) {
            line.run_slice()?;
        }
        Ok::<_, Halt>(line.now().since(begun))
    })?;
    // What the DMA was told to send, and nothing more.
    let longest = Time::from_micros(5 * (MAX_PACKET_BYTES as u64 + 10));
    ensure(drives < longest, || format!("it drives the line for {drives} after it hangs"))?;
    let lapsed = master.lapsed(0);
    master.run(Time::from_millis(1500))?;
    ensure(master.lapsed(0) == lapsed, || "the other board is disturbed".to_owned())?;
    ensure_up(&mut links[1], &Restart::Watchdog)?;
    ensure_up(&mut links[0], &Restart::PowerOn)?;
    checked_clean(&bus, &addresses)?;
    Ok(format!("its driver goes off {:.2} ms later", millis(drives)))
}

fn addresses(rig: &Rig) -> Result<String, Failure> {
    let present = [0, 5, 10, 15];
    let bus = rig.bus().start(&present, &rig.bus().flash())?;
    bus.with(Line::take_record);
    let all: Vec<u8> = (0..ADDRESSES).collect();
    let master = Master::new(bus.clone(), &all);
    let quiet = Time::from_millis(400);
    master.run(quiet)?;
    for &address in &all {
        let (place, is_present) = (usize::from(address), present.contains(&address));
        let lapsed = master.lapsed(place);
        ensure((lapsed == 0) == is_present, || {
            format!("{lapsed} turns of address {address} are not answered")
        })?;
    }
    for address in present {
        let identity = master.link(address.into())?.identity().clone();
        ensure(identity.board == "nucleo-g474re-rs485", || format!("it calls itself {}", identity.board))?;
    }
    ensure_uploads_at_once(present, |address| master.link(address.into()))?;
    checked_clean(&bus, &present)?;
    // What a turn costs those whose it is, and those whose it is not.
    let mut costs = Vec::new();
    for address in [0, 5] {
        let master = Master::new(bus.clone(), &[address]);
        bus.with(Line::take_record);
        let since = slept(&bus, 0);
        let begun = now(&bus);
        master.run(quiet)?;
        let busy = now(&bus).since(begun).seconds() - (slept(&bus, 0) - since);
        costs.push(1e6 * busy / checked_clean(&bus, &present)?.turns as f64);
    }
    let [own, other] = costs[..] else { return Err(Failure::wrong("two turns are compared")) };
    Ok(format!("{present:?}; a turn keeps its board awake for {own:.0} us, another one for {other:.0}"))
}
