//! Cases of boards on one CAN bus: whatever happens to one of them, to the bus or to the host, the others go on, and all can be
//! reached again.

use super::{
    Case, Failure, TIMEOUT, ensure, ensure_complete, ensure_up, ensure_uploads_at_once, next_frame, patches,
};
use crate::{
    board::START_TIME,
    bus::{
        BusRig,
        can::{CanBus, Traffic, Wire, host::Host},
    },
    chip::{
        fdcan::frame::{Format, Frame},
        flash::Flash,
        time::Time,
        trace::Event as TraceEvent,
    },
    machine::{Halt, Options},
    rig::{Capability, Rig},
};
use dermatome::link::{self, Link, Subscription};
use dermatome_shared::{
    drive::Drive,
    frame::FrameFlags,
    patch::PatchView,
    protocol::{
        BoardPacket, Event, Request, Selection,
        can::{ADDRESSES, Carries, FRAME_BYTES},
        decode,
    },
    restart::Restart,
};
use std::sync::{Mutex, PoisonError};

const NEEDS: &[Capability] = &[Capability::CanBus];

pub(super) const CASES: &[Case] = &[
    Case {
        name: "three boards on one CAN bus stream contacts and images, and lose none",
        needs: NEEDS,
        run: three_stream,
    },
    Case {
        name: "a board on a CAN bus is reset, without power and hangs, and the others go on",
        needs: NEEDS,
        run: others_go_on,
    },
    Case {
        name: "a board on a CAN bus that nobody acknowledges, and that is shorted, comes back",
        needs: NEEDS,
        run: comes_back,
    },
    Case { name: "noise on a CAN bus, and a patch while another board streams", needs: NEEDS, run: noise },
    Case { name: "each address on a CAN bus is heard by its board alone", needs: NEEDS, run: addresses },
    Case {
        name: "two boards of one address on a CAN bus leave the others alone",
        needs: NEEDS,
        run: same_address,
    },
];

/// All that a frame shows of contacts.
const CONTACTS: Selection =
    Selection { images: 0, contacts: 1, measurements: 0, health: 20, scope: 0, scope_slot: 0 };
/// Bytes of stack that the firmware has (firmware/memory).
const STACK: u32 = 30_720;
/// Frames a second, at the least, of the disc's scan.
const LEAST_RATE: f64 = 170.0;

/// A flash with the firmware and the rig's skin's patch, which a board of its own has taken over the bus. Cases that need it
/// share it.
fn flashed(rig: &Rig) -> Result<Flash, Failure> {
    static FLASH: Mutex<Option<Flash>> = Mutex::new(None);
    let mut made = FLASH.lock().unwrap_or_else(PoisonError::into_inner);
    let flash = if let Some(flash) = made.take() { flash } else { flash_one(rig)? };
    Ok(made.insert(flash).clone())
}

fn flash_one(rig: &Rig) -> Result<Flash, Failure> {
    let bus = rig.bus().start_can(&[0], &rig.bus().flash())?;
    link::upload(&mut Host::new(bus.clone()).link(0)?, &patches::shipped("disc-210mm")?, |_| ())?;
    Ok(bus.with(|wire| wire.machine(0).chip(|chip| chip.flash.clone())))
}

fn now(bus: &CanBus) -> Time {
    bus.with(|wire| wire.now())
}

fn millis(time: Time) -> f64 {
    time.seconds() * 1e3
}

/// Boards at these addresses with the disc's patch, tared, and their links.
fn tared(rig: &Rig, shared: &BusRig, addresses: &[u8]) -> Result<(CanBus, Vec<Link>), Failure> {
    let bus = shared.start_can(addresses, &flashed(rig)?)?;
    let host = Host::new(bus.clone());
    let mut links: Vec<Link> =
        addresses.iter().map(|&address| host.link(address)).collect::<Result<_, _>>()?;
    for link in &mut links {
        let drive = link.info()?.drive.ok_or_else(|| Failure::wrong("the board has no drive"))?;
        link.request(&Request::Drive(Some(Drive { frame_rate: 200.0, ..drive })))?;
        link::tare(link, 10, TIMEOUT)?;
    }
    bus.with(Wire::take_traffic);
    Ok((bus, links))
}

/// The next frame, which has contacts and missed no samples.
fn next_whole(stream: &mut Subscription<'_>) -> Result<link::ScanFrame, Failure> {
    let frame = next_frame(stream)?;
    ensure(frame.contacts.is_some(), || "a frame has no contacts".to_owned())?;
    let missed = frame.at.is_some_and(|at| at.flags.contains(FrameFlags::MISSED));
    ensure(!missed, || "a frame says that samples were missed".to_owned())?;
    Ok(frame)
}

fn three_stream(rig: &Rig) -> Result<String, Failure> {
    let shared =
        BusRig { options: Options { keep_trace: true, ..rig.bus().options.clone() }, ..rig.bus().clone() };
    let (bus, mut links) = tared(rig, &shared, &[0, 1, 2])?;
    bus.with(|wire| wire.host.keeps_record = true);
    let mut started = Vec::new();
    let contacts = stream_all(&bus, &mut links, CONTACTS, 40, 5e-3, &mut started)?;
    let images = Selection { images: 7, ..CONTACTS };
    let images = stream_all(&bus, &mut links, images, 100, 35e-3, &mut started)?;
    Ok(format!("contacts alone: {contacts}; with an image of each seventh frame: {images}"))
}

/// All stream so many frames each, and none is lost; contacts come so long after the last slot of their scan at the most, s.
/// `started` is when the clocks of boards began to count; where it is not known yet, contacts come before the next scan ends.
fn stream_all(
    bus: &CanBus,
    links: &mut [Link],
    selection: Selection,
    frames: usize,
    longest: f64,
    started: &mut Vec<f64>,
) -> Result<String, Failure> {
    let boards = links.len();
    bus.with(move |wire| {
        (0..boards).for_each(|board| drop(wire.machine(board).chip(|chip| chip.trace.take())));
    });
    let mut streams =
        links.iter_mut().map(|link| link.subscribe(selection)).collect::<Result<Vec<_>, _>>()?;
    streams.iter_mut().try_for_each(|stream| next_whole(stream).map(drop))?;
    bus.with(|wire| (wire.take_traffic(), wire.host.take_record()));
    let since = now(bus);
    let (mut load, mut free_stack, mut images) = (0.0_f32, u32::MAX, 0);
    for _ in 0..frames {
        for stream in &mut streams {
            let frame = next_whole(stream)?;
            images += usize::from(frame.image.is_some());
            if let Some(health) = frame.health {
                load = load.max(health.vitals.load);
                free_stack = free_stack.min(health.vitals.free_stack);
            }
        }
    }
    let span = now(bus).since(since).seconds();
    let (traffic, heard) = bus.with(|wire| (wire.take_traffic(), wire.host.take_record()));
    streams.iter_mut().try_for_each(ensure_complete)?;
    drop(streams);
    let rate = frames as f64 / span;
    ensure(rate > LEAST_RATE, || format!("{rate:.1} frames a second"))?;
    ensure(free_stack >= STACK / 4, || format!("{free_stack} bytes of stack are free"))?;
    let wanted = boards * frames.checked_div(selection.images.into()).unwrap_or(0);
    ensure(images >= wanted, || format!("{images} images of {wanted}"))?;
    ensure(traffic.errors == 0, || format!("{} frames met errors", traffic.errors))?;
    let mut latencies = Vec::new();
    for board in 0..boards {
        let events = bus.with(move |wire| wire.machine(board).chip(|chip| chip.trace.take()));
        let (contacts, scans) = (contacts_said(&heard, board as u8), last_slots(&events));
        if started.len() == board {
            started.push(began_to_count(&contacts, &scans)?);
        }
        latencies.extend(contacts_after(&contacts, started[board], &scans));
    }
    latencies.sort_by(f64::total_cmp);
    ensure(latencies.len() + 3 * boards >= boards * frames, || format!("{} scans", latencies.len()))?;
    let (median, worst) = (latencies[latencies.len() / 2], latencies[latencies.len() - 1]);
    ensure(latencies[0] > 0.0 && worst < longest, || {
        format!("contacts {:.2} to {:.2} ms after their scans", 1e3 * latencies[0], 1e3 * worst)
    })?;
    Ok(format!(
        "{rate:.1} frames a second of each, {images} images, bus busy {:.0} %, {:.0} kB/s, contacts {:.2} ms after the last slot \
         of their scan (median), {:.2} at most, CPU at most {:.0} %, {free_stack} bytes of stack free",
        100.0 * traffic.busy.seconds() / span,
        traffic.bytes as f64 / span / 1e3,
        1e3 * median,
        1e3 * worst,
        100.0 * load
    ))
}

/// When the last slots of scans began, s.
fn last_slots(events: &[(Time, TraceEvent)]) -> Vec<f64> {
    let is_last =
        |(_, event): &&(Time, TraceEvent)| *event == TraceEvent::DmaComplete { controller: 1, channel: 4 };
    events.iter().filter(is_last).map(|(time, _)| time.seconds()).collect()
}

/// Contacts that a board said: when their last frame ended, and when by the board's clock their scan did, s.
fn contacts_said(heard: &[(Time, Frame)], address: u8) -> Vec<(f64, f64)> {
    let own = |(_, frame): &&(Time, Frame)| Carries::of(frame.identifier) == Some((Carries::Said, address));
    let (mut contacts, mut bytes) = (Vec::new(), Vec::new());
    for (at, frame) in heard.iter().filter(own) {
        for &byte in &frame.data {
            if byte != 0 {
                bytes.push(byte);
            } else if let Ok(BoardPacket::Event { event: Event::Contacts { at: stamp, .. }, .. }) =
                decode(&mut std::mem::take(&mut bytes))
            {
                contacts.push((at.seconds(), stamp.timestamp_us as f64 * 1e-6));
            }
        }
    }
    contacts
}

/// When a board's clock began to count: by the median of its contacts, each of the last scan before them.
fn began_to_count(contacts: &[(f64, f64)], scans: &[f64]) -> Result<f64, Failure> {
    let mut began: Vec<f64> = contacts
        .iter()
        .filter_map(|&(end, taken)| Some(scans.iter().rev().find(|&&scan| scan < end)? - taken))
        .collect();
    began.sort_by(f64::total_cmp);
    began.get(began.len() / 2).copied().ok_or_else(|| Failure::wrong("no contacts were sent"))
}

/// From the last slot of each scan to the end of its contacts, s.
fn contacts_after(contacts: &[(f64, f64)], started: f64, scans: &[f64]) -> Vec<f64> {
    let latency = |&(end, taken): &(f64, f64)| {
        let near = |scan: &&f64| (**scan - taken - started).abs();
        Some(end - scans.iter().min_by(|a, b| near(a).total_cmp(&near(b)))?)
    };
    contacts.iter().filter_map(latency).collect()
}

fn others_go_on(rig: &Rig) -> Result<String, Failure> {
    let (bus, mut links) = tared(rig, rig.bus(), &[0, 1])?;
    let since = now(&bus);
    let [first, second] = &mut links[..] else { return Err(Failure::wrong("two boards")) };
    let mut stream = first.subscribe(CONTACTS)?;
    let mut frames = 0;
    let mut pass = |span: u64| -> Result<(), Failure> {
        let end = now(&bus) + Time::from_millis(span);
        while now(&bus) < end {
            next_whole(&mut stream)?;
            frames += 1;
        }
        Ok(())
    };
    // It acknowledges and says much, and in the middle of a frame it does not any more.
    second.request(&Request::Stream(Selection { images: 1, ..CONTACTS }))?;
    pass(60)?;
    bus.with(|wire| until_it_sends(wire, 1).and_then(|()| wire.machine(1).press_reset()))?;
    pass(300)?;
    ensure_up(second, &Restart::ResetPin)?;
    second.request(&Request::Stream(Selection { images: 1, ..CONTACTS }))?;
    pass(60)?;
    bus.with(|wire| until_it_sends(wire, 1).and_then(|()| wire.cut_power(1)))?;
    pass(60)?;
    bus.with(|wire| wire.restore_power(1));
    pass(300)?;
    ensure_up(second, &Restart::PowerOn)?;
    bus.with(|wire| until_it_sends_or(wire, 1, Time::from_millis(1)).map(|()| wire.machine(1).hang()))?;
    pass(1400)?;
    ensure_up(second, &Restart::Watchdog)?;
    let rate = frames as f64 / now(&bus).since(since).seconds();
    ensure_complete(&mut stream)?;
    ensure(rate > LEAST_RATE, || format!("{rate:.1} frames a second"))?;
    let Traffic { errors, .. } = bus.with(Wire::take_traffic);
    // One frame broke off at the reset, one where power went.
    ensure(errors == 2, || format!("{errors} frames met errors"))?;
    Ok(format!("{frames} frames, {rate:.1} a second; {errors} frames broke off"))
}

/// Lets time pass until a board sends.
fn until_it_sends(wire: &mut Wire, board: usize) -> Result<(), Halt> {
    until_it_sends_or(wire, board, Time::from_millis(100))
}

fn until_it_sends_or(wire: &mut Wire, board: usize, longest: Time) -> Result<(), Halt> {
    let end = wire.now() + longest;
    while wire.now() < end && !wire.machine(board).chip(|chip| chip.fdcan.is_sending()) {
        wire.run_slice()?;
    }
    Ok(())
}

fn comes_back(rig: &Rig) -> Result<String, Failure> {
    /// How long the host is away, ms.
    const AWAY: u64 = 900;
    let (bus, mut links) = tared(rig, rig.bus(), &[0])?;
    let mut stream = links[0].subscribe(CONTACTS)?;
    let sequence = |stream: &mut Subscription<'_>| -> Result<u32, Failure> {
        let frame = next_whole(stream)?;
        frame.at.map(|at| at.sequence).ok_or_else(|| Failure::wrong("a frame without a stamp"))
    };
    for _ in 0..10 {
        next_whole(&mut stream)?;
    }
    // The host is away.
    let (before, since) = (sequence(&mut stream)?, now(&bus));
    bus.with(|wire| wire.host.is_on = false);
    bus.run(Time::from_millis(AWAY))?;
    let passive = bus.with(|wire| wire.machine(0).chip(|chip| chip.fdcan.is_passive()));
    ensure(passive, || "a board that nobody acknowledges is not passive".to_owned())?;
    let tries = bus.with(Wire::take_traffic).errors;
    ensure(tries > 100, || format!("{tries} frames were tried"))?;
    bus.with(|wire| wire.host.is_on = true);
    // What waited comes first.
    for _ in 0..200 {
        next_whole(&mut stream)?;
        if stream.link().events_lost() > 0 {
            break;
        }
    }
    let lost = stream.link().events_lost();
    ensure(lost > 0, || "what nobody acknowledged was not counted".to_owned())?;
    ensure_scans(before, since, sequence(&mut stream)?, &bus)?;
    // Its wires touch, again and again it goes off the bus.
    let (before, since) = (sequence(&mut stream)?, now(&bus));
    bus.with(|wire| wire.short(true));
    bus.run(Time::from_millis(100))?;
    let off = bus.with(Wire::take_traffic).errors;
    bus.with(|wire| wire.short(false));
    let mended = now(&bus);
    let mut recovered = None;
    for _ in 0..30 {
        next_whole(&mut stream)?;
        recovered = recovered.or(Some(now(&bus).since(mended)));
    }
    let lost_shorted = stream.link().events_lost() - lost;
    ensure_scans(before, since, sequence(&mut stream)?, &bus)?;
    drop(stream);
    ensure_up(&mut links[0], &Restart::PowerOn)?;
    let recovered = recovered.map_or(f64::NAN, millis);
    ensure(recovered < 20.0, || format!("the first frame comes {recovered:.1} ms after the short"))?;
    ensure(off > 60, || format!("{off} frames were tried while it was shorted"))?;
    Ok(format!(
        "nobody acknowledges for {AWAY} ms: {tries} tries, {lost} events lost; shorted for 100 ms: {off} tries, {lost_shorted} \
         lost, back after {recovered:.1} ms"
    ))
}

/// Scans went on all the time, at their rate.
fn ensure_scans(before: u32, since: Time, after: u32, bus: &CanBus) -> Result<(), Failure> {
    let rate = f64::from(after - before) / now(bus).since(since).seconds();
    ensure(rate > LEAST_RATE, || format!("{rate:.1} scans a second"))
}

fn noise(rig: &Rig) -> Result<String, Failure> {
    let (bus, mut links) = tared(rig, rig.bus(), &[0, 1])?;
    let [first, second] = &mut links[..] else { return Err(Failure::wrong("two boards")) };
    let patch = patches::patch(36, true, 7);
    let mut stream = first.subscribe(Selection { images: 2, ..CONTACTS })?;
    bus.with(|wire| wire.disturb(20, 5));
    // The links' reads and the upload's take turns with virtual time.
    let since = now(&bus);
    link::upload(second, &patch, |_| ())?;
    let upload = now(&bus).since(since);
    while now(&bus) < since + Time::from_millis(700) {
        next_whole(&mut stream)?;
    }
    bus.with(|wire| wire.disturb(0, 0));
    let Traffic { frames, errors, missed, .. } = bus.with(Wire::take_traffic);
    for _ in 0..20 {
        next_whole(&mut stream)?;
    }
    ensure_complete(&mut stream)?;
    ensure(errors > 10, || format!("{errors} of {frames} frames met noise"))?;
    ensure(missed == 0, || format!("{missed} frames were missed by a passive board"))?;
    let held = second.info()?.patch.map(|patch| patch.crc);
    let sent = PatchView::open(&patch).map_err(Failure::wrong)?.crc();
    ensure(held == Some(sent), || format!("it holds {held:x?}, not {sent:08x}"))?;
    drop(stream);
    ensure_up(first, &Restart::PowerOn)?;
    ensure_up(second, &Restart::PowerOn)?;
    Ok(format!(
        "{errors} of {} frames damaged, each sent again; nothing lost; {} bytes uploaded in {:.2} s meanwhile",
        frames + errors,
        patch.len(),
        upload.seconds()
    ))
}

fn addresses(rig: &Rig) -> Result<String, Failure> {
    let present = [0, 5, 10, 15];
    let bus = rig.bus().start_can(&present, &rig.bus().flash())?;
    let host = Host::new(bus.clone());
    for address in present {
        let identity = host.link(address)?.identity().clone();
        ensure(identity.board == "nucleo-g474re-can", || format!("it calls itself {}", identity.board))?;
    }
    // What is for nobody is acknowledged by all, and comes to none.
    bus.with(Wire::take_traffic);
    bus.with(move |wire| {
        let now = wire.now();
        for address in (0..ADDRESSES).filter(|address| !present.contains(address)) {
            let identifier = Carries::Request.identifier(address);
            let data = vec![0; FRAME_BYTES];
            wire.host.send(Frame { identifier, format: Format::Switching, data }, now);
        }
        wire.run_until(now + Time::from_millis(10))
    })?;
    let traffic = bus.with(Wire::take_traffic);
    let strangers = usize::from(ADDRESSES) - present.len();
    ensure(traffic.frames == strangers, || format!("{} frames of {strangers}", traffic.frames))?;
    for board in 0..present.len() {
        let received = bus.with(move |wire| wire.machine(board).chip(|chip| chip.fdcan.received()));
        ensure(received < 20, || format!("board {board} has received {received} frames"))?;
    }
    ensure(traffic.errors == 0, || format!("{} frames met errors", traffic.errors))?;
    ensure_uploads_at_once(present, |address| host.link(address))?;
    // A full-size patch, with the bus for itself.
    let patch = patches::shipped("disc-210mm")?;
    let since = now(&bus);
    link::upload(&mut host.link(5)?, &patch, |_| ())?;
    let upload = now(&bus).since(since).seconds();
    let Traffic { errors, .. } = bus.with(Wire::take_traffic);
    ensure(errors == 0, || format!("{errors} frames met errors"))?;
    let lost: usize = (0..present.len())
        .map(|board| bus.with(move |wire| wire.machine(board).chip(|chip| chip.fdcan.lost())))
        .sum();
    ensure(lost == 0, || format!("{lost} frames found no room in a board's FIFO"))?;
    Ok(format!("{present:?}; {} bytes uploaded in {upload:.2} s", patch.len()))
}

fn same_address(rig: &Rig) -> Result<String, Failure> {
    let bus = rig.bus().start_can(&[0, 3, 3], &rig.bus().flash())?;
    let host = Host::new(bus.clone());
    let mut alone = host.link(0)?;
    // They have not been up for the same time, which they say.
    bus.with(|wire| wire.cut_power(2))?;
    bus.run(Time::from_millis(33))?;
    bus.with(|wire| wire.restore_power(2));
    bus.run(START_TIME)?;
    bus.with(Wire::take_traffic);
    let mut answered = 0;
    for _ in 0..5 {
        answered += usize::from(host.link(3).and_then(|mut link| link.info()).is_ok());
        alone.info()?;
    }
    let Traffic { collisions, .. } = bus.with(Wire::take_traffic);
    ensure(collisions > 10, || format!("{collisions} frames collided"))?;
    bus.with(|wire| wire.cut_power(2))?;
    let info = host.link(3)?.info()?;
    let up = now(&bus).nanoseconds() / 1_000_000;
    ensure(info.uptime_ms + 100 > up, || format!("it is up for {} ms of {up}", info.uptime_ms))?;
    alone.info()?;
    Ok(format!("{answered} of 5 requests answered, {collisions} frames collided"))
}
