//! Cases of a board on USB: what its host sees of it, and what becomes of the board when cable, bus or host do not behave.
//! After each disturbance a host finds it again, and it has missed no sample.

use super::{Case, Failure, TIMEOUT, ensure, ensure_complete, next_frame, next_with, patches};
use crate::{
    board::{START_TIME, VirtualBoard},
    chip::{
        flash::Flash,
        time::Time,
        usb::host::{Host, Refused, Request as ToDevice},
    },
    machine::Machine,
    rig::{Capability, Rig},
};
use dermatome::{
    link::{self, Link},
    model::Model,
    quantize,
    skin::{FoundIn, ImageLayout, Skin},
};
use dermatome_shared::{
    frame::FrameFlags,
    patch::PatchView,
    protocol::{FrameStamp, Request, Selection},
    restart::Restart,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::sync::{Mutex, PoisonError};

mod descriptors;

const NEEDS: &[Capability] = &[Capability::Usb];

pub(super) const CASES: &[Case] = &[
    Case { name: "a cable that comes out at any moment and goes in again", needs: NEEDS, run: replugged },
    Case {
        name: "images and raw frames of every frame over USB, and none is lost",
        needs: NEEDS,
        run: streams,
    },
    Case { name: "a host that resets the bus at any moment", needs: NEEDS, run: reset },
    Case { name: "a host that stops reading, and then another one", needs: NEEDS, run: stops_reading },
    Case { name: "a host that sleeps and wakes up", needs: NEEDS, run: sleeps },
    Case { name: "an upload over USB, and power cuts in it", needs: NEEDS, run: uploads },
    Case { name: "a host enumerates the board by the rules", needs: NEEDS, run: descriptors::enumerates },
    Case {
        name: "endpoints that were halted or configured again begin anew",
        needs: NEEDS,
        run: begins_anew,
    },
    Case { name: "an answer of whole packets reaches the program at once", needs: NEEDS, run: whole_packets },
    Case { name: "a program that does not set DTR is answered", needs: NEEDS, run: without_dtr },
];

/// Everything of every frame.
const ALL: Selection =
    Selection { images: 1, contacts: 1, measurements: 1, health: 10, scope: 0, scope_slot: 0 };

/// Does something with the host.
fn host<T: Send + 'static>(
    board: &VirtualBoard,
    act: impl FnOnce(&mut Host, Time) -> T + Send + 'static,
) -> T {
    board.with(|machine: &mut Machine| {
        let now = machine.now();
        machine.chip(|chip| act(chip.usb.host_mut(), now))
    })
}

fn now(board: &VirtualBoard) -> Time {
    board.with(|machine| machine.now())
}

/// A flash with the firmware and a patch that leaves the board time at its fastest, which a board of its own has taken.
/// Cases share it.
fn flashed(rig: &Rig) -> Result<Flash, Failure> {
    static FLASH: Mutex<Option<Flash>> = Mutex::new(None);
    let mut made = FLASH.lock().unwrap_or_else(PoisonError::into_inner);
    let flash = if let Some(flash) = made.take() {
        flash
    } else {
        link::upload(&mut rig.link()?, &patch(rig)?, |_| ())?;
        rig.emulated().with(|machine| machine.chip(|chip| chip.flash.clone()))
    };
    Ok(made.insert(flash).clone())
}

/// The patch of the rig's skin, with contacts found in an image of 256 pixels.
fn patch(rig: &Rig) -> Result<Vec<u8>, Failure> {
    let world = rig.emulated().world().ok_or_else(|| Failure::wrong("the rig has no `[world]`"))?;
    let mut skin = Skin::clone(&world.setup().skin);
    skin.image = ImageLayout::Grid { columns: 18 };
    skin.contacts_found_in = FoundIn::Image;
    skin.drive.frame_rate = 1e4;
    let model = Model::build(&skin, |_| ()).map_err(Failure::wrong)?;
    quantize::patch(&skin, &model).map_err(Failure::wrong)
}

/// A board with that patch, tared.
fn tared(rig: &Rig) -> Result<(VirtualBoard, Link), Failure> {
    let board = VirtualBoard::start(flashed(rig)?, rig.emulated_rig().options.clone())?;
    board.run(START_TIME)?;
    let mut link = board.link()?;
    link::tare(&mut link, 20, TIMEOUT)?;
    Ok((board, link))
}

/// Another program on the port, whose requests have numbers of their own.
fn again(board: &VirtualBoard, number: usize) -> Result<Link, Failure> {
    let link = Link::connect("virtual", board.line()).map_err(|error| {
        let problems = host(board, |host, _| format!("{:?}, port {}", host.problems(), host.has_port()));
        Failure::wrong(format!("{error} ({problems})"))
    })?;
    Ok(link.counting_from(1000 * number as u16))
}

/// The board has run since it was switched on, and has missed no sample; gives its latest frame.
fn ensure_unharmed(link: &mut Link) -> Result<FrameStamp, Failure> {
    let info = link.info()?;
    ensure(info.started_after == Restart::PowerOn, || format!("it started after {:?}", info.started_after))?;
    let mut stream = link.subscribe(Selection { health: 1, contacts: 1, ..Selection::default() })?;
    let (at, missed) = next_with(&mut stream, |frame| Some(frame.health?.missed))?;
    ensure(missed == 0, || format!("samples were missed {missed} times"))?;
    ensure(!at.flags.contains(FrameFlags::MISSED), || "samples were missed".to_owned())?;
    Ok(at)
}

/// The board goes on measuring from one frame to the other. At most 178 a second come, fewer where streams begin in
/// between.
fn ensure_went_on(before: FrameStamp, after: FrameStamp) -> Result<(), Failure> {
    let (frames, time) = (after.sequence - before.sequence, after.timestamp_us - before.timestamp_us);
    let rate = 1e6 * f64::from(frames) / time as f64;
    ensure(rate > 60.0, || format!("{frames} frames in {:.3} s", 1e-6 * time as f64))
}

fn streams(rig: &Rig) -> Result<String, Failure> {
    const FRAMES: usize = 200;
    let (board, mut link) = tared(rig)?;
    let mut stream = link.subscribe(ALL)?;
    next_frame(&mut stream)?;
    host(&board, |host, _| (host.take_most_packets(), host.take_carried()));
    let (since, mut load) = (now(&board), 0.0_f32);
    for _ in 0..FRAMES {
        let frame = next_frame(&mut stream)?;
        let is_whole = frame.image.is_some() && frame.contacts.is_some() && frame.measurements.is_some();
        ensure(is_whole, || format!("of a frame, {:?} is missing", frame.missing))?;
        load = load.max(frame.health.map_or(0.0, |health| health.vitals.load));
    }
    let seconds = now(&board).since(since).seconds();
    ensure_complete(&mut stream)?;
    drop(stream);
    let (most, carried) = host(&board, |host, _| (host.take_most_packets(), host.take_carried()));
    ensure_unharmed(&mut link)?;
    let rate = FRAMES as f64 / seconds;
    ensure(rate > 150.0, || format!("{rate:.1} frames a second"))?;
    let bytes = carried as f64 / FRAMES as f64;
    Ok(format!(
        "{FRAMES} frames, {rate:.1} a second, {bytes:.0} bytes each, up to {most} packets in a millisecond: there is room for \
         {:.0} frames a second; CPU {:.0} %",
        most as f64 * 64e3 / bytes,
        100.0 * load
    ))
}

fn replugged(rig: &Rig) -> Result<String, Failure> {
    const TIMES: usize = 8;
    disturbed(rig, TIMES, 31, |board, random| {
        let apart = Time::from_micros(random.random_range(0..60_000));
        host(board, Host::unplug);
        board.run(apart)?;
        host(board, Host::plug);
        Ok(())
    })
}

fn reset(rig: &Rig) -> Result<String, Failure> {
    const TIMES: usize = 5;
    disturbed(rig, TIMES, 32, |board, _| {
        host(board, Host::reset_bus);
        Ok(())
    })
}

/// Something happens to the bus in the middle of streams and of an upload; each time a new program finds the board.
fn disturbed(
    rig: &Rig,
    times: usize,
    seed: u64,
    mut disturb: impl FnMut(&VirtualBoard, &mut Pcg64) -> Result<(), Failure>,
) -> Result<String, Failure> {
    let mut random = Pcg64::seed_from_u64(seed);
    let (board, mut link) = tared(rig)?;
    let before = ensure_unharmed(&mut link)?;
    link.request(&Request::Stream(ALL))?;
    for time in 1..=times {
        board.run(Time::from_micros(random.random_range(0..15_000)))?;
        disturb(&board, &mut random)?;
        // The program notices that its port is gone, and makes room for another.
        board.run(Time::from_micros(10))?;
        drop(link);
        link = again(&board, time)?;
        ensure(host(&board, move |host, _| host.enumerations()) == time + 1, || {
            "the board was not enumerated again".to_owned()
        })?;
        link.request(&Request::Stream(ALL))?;
    }
    let after = {
        let mut stream = link.subscribe(ALL)?;
        next_with(&mut stream, |frame| frame.image)?.0
    };
    ensure_went_on(before, after)?;
    ensure_unharmed(&mut link)?;
    // In the middle of an upload, after which the old patch is in force, until another one comes.
    let held = link.info()?.patch.map(|patch| patch.crc);
    let patch = patches::patch(36, true, seed);
    let mut chunks = random.random_range(2..9);
    let broken = link::upload(&mut link, &patch, |_| {
        chunks -= 1;
        if chunks == 0 {
            disturb(&board, &mut random).expect("the board goes on");
        }
    });
    ensure(broken.is_err(), || "an upload without its port succeeds".to_owned())?;
    drop(link);
    let mut link = again(&board, times + 1)?;
    let now_held = link.info()?.patch.map(|patch| patch.crc);
    ensure(now_held == held, || format!("it holds {now_held:x?}, not {held:x?}"))?;
    link::upload(&mut link, &patch, |_| ())?;
    let problems = host(&board, |host, _| host.problems().to_vec());
    ensure(problems.is_empty(), || format!("the host meets {problems:?}"))?;
    Ok(format!("{times} times in a stream, once in an upload, and found again each time"))
}

fn stops_reading(rig: &Rig) -> Result<String, Failure> {
    let (board, mut link) = tared(rig)?;
    let before = ensure_unharmed(&mut link)?;
    link.request(&Request::Stream(ALL))?;
    board.run(Time::from_millis(30))?;
    // It goes on: what waited comes, and what came meanwhile is missing.
    host(&board, |host, _| host.set_reading(false));
    board.run(Time::from_millis(400))?;
    host(&board, |host, _| host.set_reading(true));
    let mut stream = link.subscribe(ALL)?;
    (0..20).try_for_each(|_| next_frame(&mut stream).map(drop))?;
    drop(stream);
    let after = ensure_unharmed(&mut link)?;
    ensure_went_on(before, after)?;
    let (lost, damaged) = (link.events_lost(), link.packets_damaged());
    ensure(lost > 80 && damaged == 0, || format!("{lost} events lost, {damaged} packets damaged"))?;
    // It leaves, and the next one finds nothing of what it did not read but the packet that waited in the chip.
    link.request(&Request::Stream(ALL))?;
    host(&board, |host, _| host.set_reading(false));
    board.run(Time::from_millis(100))?;
    drop(link);
    board.run(Time::from_millis(20))?;
    let mut link = again(&board, 1)?;
    let after = ensure_unharmed(&mut link)?;
    ensure_went_on(before, after)?;
    ensure(link.packets_damaged() <= 1, || format!("{} packets damaged", link.packets_damaged()))?;
    Ok(format!("{lost} events were dropped while nobody read"))
}

fn sleeps(rig: &Rig) -> Result<String, Failure> {
    let (board, mut link) = tared(rig)?;
    let before = ensure_unharmed(&mut link)?;
    link.request(&Request::Stream(ALL))?;
    for asleep in [2, 30, 300] {
        board.run(Time::from_micros(7_300))?;
        host(&board, |host, _| host.suspend());
        board.run(Time::from_millis(asleep))?;
        host(&board, Host::resume);
        board.run(Time::from_millis(40))?;
        let after = ensure_unharmed(&mut link)?;
        ensure_went_on(before, after)?;
        link.request(&Request::Stream(ALL))?;
    }
    let lost = link.events_lost();
    ensure(lost > 0, || "nothing was lost while it slept".to_owned())?;
    // The cable comes out of a host that sleeps.
    host(&board, |host, _| host.suspend());
    board.run(Time::from_millis(20))?;
    host(&board, Host::unplug);
    board.run(Time::from_millis(20))?;
    drop(link);
    host(&board, Host::plug);
    ensure_unharmed(&mut again(&board, 1)?)?;
    Ok(format!("2, 30 and 300 ms: the program goes on with its port; {lost} events were lost"))
}

fn uploads(rig: &Rig) -> Result<String, Failure> {
    let board = VirtualBoard::start(flashed(rig)?, rig.emulated_rig().options.clone())?;
    board.run(START_TIME)?;
    let mut link = board.link()?;
    let old = link.info()?.patch.map(|patch| patch.crc);
    let patch = patches::patch(250, true, 33);
    let new = Some(PatchView::open(&patch).map_err(Failure::wrong)?.crc());
    let mut random = Pcg64::seed_from_u64(34);
    for time in 1..=5 {
        let mut chunks = random.random_range(1..60);
        let broken = link::upload(&mut link, &patch, |_| {
            chunks -= 1;
            if chunks == 0 {
                board.with(Machine::cut_power).expect("the board starts again");
            }
        });
        ensure(broken.is_err(), || "an upload without power succeeds".to_owned())?;
        drop(link);
        link = again(&board, time)?;
        let info = link.info()?;
        let held = info.patch.map(|patch| patch.crc);
        ensure(held == old, || format!("it holds {held:x?}, not {old:x?}"))?;
    }
    let since = now(&board);
    link::upload(&mut link, &patch, |_| ())?;
    let seconds = now(&board).since(since).seconds();
    let held = link.info()?.patch.map(|patch| patch.crc);
    ensure(held == new, || format!("it holds {held:x?}, not {new:x?}"))?;
    Ok(format!("5 cuts; then {} bytes in {seconds:.2} s", patch.len()))
}

fn begins_anew(rig: &Rig) -> Result<String, Failure> {
    let (board, mut link) = tared(rig)?;
    let ask = |request: ToDevice| -> Result<Vec<u8>, Failure> {
        host(&board, |host, _| host.ask(request));
        board.run(Time::from_millis(5))?;
        let answers = host(&board, |host, _| host.take_answers());
        let [answer] = &answers[..] else { return Err(Failure::wrong(format!("{} answers", answers.len()))) };
        answer.clone().map_err(Failure::wrong)
    };
    // An odd and an even number of packets have gone before, each way.
    for packets in 0..2 {
        for endpoint in [0x02, 0x82] {
            link.request(&Request::Info)?;
            (0..packets).try_for_each(|_| link.request(&Request::Stream(Selection::default())).map(drop))?;
            ask(ToDevice::new(0x02, 3, 0, endpoint, 0))?;
            ensure(ask(ToDevice::new(0x82, 0, 0, endpoint, 2))? == [1, 0], || "it is not halted".to_owned())?;
            ask(ToDevice::new(0x02, 1, 0, endpoint, 0))?;
            ensure(ask(ToDevice::new(0x82, 0, 0, endpoint, 2))? == [0, 0], || "it stays halted".to_owned())?;
            link.info()?;
        }
        (0..packets).try_for_each(|_| link.request(&Request::Stream(Selection::default())).map(drop))?;
        ask(ToDevice::new(0x00, 9, 1, 0, 0))?;
        ask(ToDevice::new(0x21, 0x22, 3, 0, 0))?;
        link.info()?;
    }
    let (repeated, problems) = host(&board, |host, _| (host.repeated(), host.problems().to_vec()));
    ensure(repeated == 0, || format!("{repeated} packets had the wrong toggle"))?;
    ensure(problems.iter().all(|&problem| problem == Refused::Stall), || format!("{problems:?}"))?;
    // Without a configuration there is no port.
    ask(ToDevice::new(0x00, 9, 0, 0, 0))?;
    ensure(ask(ToDevice::new(0x82, 0, 0, 0x82, 2)).is_err(), || "it tells of an endpoint".to_owned())?;
    Ok(String::new())
}

/// Answers of each length up to two packets: where the last one is full, the host's driver waits for a short one.
fn whole_packets(rig: &Rig) -> Result<String, Failure> {
    let (board, mut link) = tared(rig)?;
    let length = patch(rig)?.len() as u32;
    for bytes in 1..=2 * 64 {
        let since = now(&board);
        link.request(&Request::ReadPatch { offset: length - bytes })?;
        let time = now(&board).since(since);
        ensure(time < Time::from_millis(10), || format!("{bytes} bytes of patch come after {time}"))?;
    }
    Ok(String::new())
}

fn without_dtr(rig: &Rig) -> Result<String, Failure> {
    let board = VirtualBoard::start(flashed(rig)?, rig.emulated_rig().options.clone())?;
    board.run(Time::from_millis(600))?;
    host(&board, |host, _| host.open_quietly());
    let identity = again(&board, 1)?.identity().clone();
    ensure(identity.board == "nucleo-g474re-usb", || format!("it calls itself {}", identity.board))?;
    Ok(String::new())
}
