//! Soak: a board restarts, its cable is pulled, is slow or noisy, others knock, again and again; `stream` comes back each
//! time, counts what is lost, and shows nothing that is old.
//!
//! Some events in `./test`; an hour of a thousand with
//! `DERMATOME_BOUNDS=1 DERMATOME_SOAK_EVENTS=1000 cargo test --release -p dermatome --test link_soak -- --nocapture`
//! (`DERMATOME_SOAK_SEED` for another order).
#![cfg(target_os = "linux")]

mod program;
mod testbench;

use dermatome::simulate::{
    board::{BoardOptions, SimulatedBoard},
    instrument::{Instrument, ScanTable},
};
use dermatome_shared::frame::Frame;
use program::{Desk, memory, number, within};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::{
    collections::BTreeMap,
    io::Write,
    net::{Ipv4Addr, SocketAddr},
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use testbench::{
    Pressed, UNTOUCHED,
    cable::{Cable, Carries},
    raw, small_patch,
};

const FRAME_RATE: f32 = 50.0;
/// Contacts again after what was wrong has passed, at most, with `DERMATOME_BOUNDS=1`; a reader's clock adds to it.
const RECOVERY: Duration = Duration::from_secs(2);
/// Frames seen in a row before something happens.
const CALM_FRAMES: u32 = 10;

/// A skin that a finger holds in each frame that is streamed; counts its board's frames.
struct Held {
    skin: Pressed,
    frames: Arc<AtomicU32>,
}

impl Instrument for Held {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        self.frames.fetch_add(1, Ordering::SeqCst);
        let mut frame = self.skin.scan(table, None);
        if script_time.is_some() {
            frame.codes[1].0 += UNTOUCHED / 20;
        }
        frame
    }
}

/// A board that has just started, and how many frames it has made.
struct Board {
    board: SimulatedBoard,
    frames: Arc<AtomicU32>,
}

impl Board {
    fn start(listen: SocketAddr) -> Self {
        let frames = Arc::<AtomicU32>::default();
        let patch = Some(small_patch("small", FRAME_RATE));
        let options = BoardOptions { listen, patch, ..BoardOptions::default() };
        let skin = Held { skin: Pressed::new(1), frames: frames.clone() };
        Self { board: SimulatedBoard::start(options, skin).unwrap(), frames }
    }

    /// Number of the next frame that it scans.
    fn next_frame(&self) -> u32 {
        self.frames.load(Ordering::SeqCst)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Trouble {
    Restart,
    Pulled,
    Late,
    Slow,
    Noise,
    Knocking,
}

const TROUBLES: [Trouble; 6] =
    [Trouble::Restart, Trouble::Pulled, Trouble::Late, Trouble::Slow, Trouble::Noise, Trouble::Knocking];

/// What `stream` has written.
#[derive(Debug, Default)]
struct Seen {
    /// Number of the last frame since the board started.
    last: Option<u32>,
    is_after_gap: bool,
    frames: u64,
    /// Numbers passed over between two frames of one link.
    missing: u64,
    gaps: u64,
    /// Times that the board had started anew.
    starts: u64,
}

impl Seen {
    /// Takes a line: the contact of a frame, or a remark.
    fn take(&mut self, line: &str) {
        if line.starts_with("# gap of ") {
            self.gaps += 1;
            self.is_after_gap = true;
            // A board that has started anew counts from the beginning; one that was out of reach goes on.
            if line.contains("with a new reference") {
                (self.starts, self.last) = (self.starts + 1, None);
            }
            return;
        }
        assert!(!line.starts_with('#'), "{line}");
        let sequence: u32 = line.split('\t').next().unwrap().parse().unwrap();
        if let Some(last) = self.last {
            assert!(sequence > last, "frame {sequence} after {last}: stale, or twice");
            self.missing += if self.is_after_gap { 0 } else { u64::from(sequence - last - 1) };
        }
        (self.last, self.is_after_gap) = (Some(sequence), false);
        self.frames += 1;
    }
}

/// Others connect, some say nothing, some what no board understands.
fn knock(board: SocketAddr, random: &mut Pcg64) {
    for _ in 0..20 {
        let mut other = raw(board);
        if random.random() {
            let noise: [u8; 1000] = random.random();
            // Fails if the board has hung up.
            let _ = other.write_all(&noise);
        }
    }
}

/// Makes trouble for a while, and lets it pass.
fn trouble(what: Trouble, lasts: Duration, board: &mut Option<Board>, cable: &Cable, random: &mut Pcg64) {
    let address = board.as_ref().unwrap().board.address();
    match what {
        Trouble::Restart => {
            board.take().unwrap().board.stop().unwrap();
            thread::sleep(lasts);
            *board = Some(Board::start(address));
        }
        Trouble::Pulled => cable.pull(),
        Trouble::Late => cable.carry(Carries::Later),
        Trouble::Slow => cable.carry(Carries::Slowly),
        Trouble::Noise => cable.carry(Carries::Noise),
        Trouble::Knocking => knock(address, random),
    }
    if !matches!(what, Trouble::Restart | Trouble::Knocking) {
        thread::sleep(lasts);
        cable.carry(Carries::All);
    }
}

#[test]
fn a_stream_comes_back_each_time_and_counts_what_is_lost() {
    let (events, seed) = (number("DERMATOME_SOAK_EVENTS", 18), number("DERMATOME_SOAK_SEED", 1));
    let mut random = Pcg64::seed_from_u64(seed);
    let mut board = Some(Board::start((Ipv4Addr::LOCALHOST, 0).into()));
    let cable = Cable::to(board.as_ref().unwrap().board.address());
    let desk = Desk::empty();
    let port = format!("tcp:{}", cable.address());
    let mut stream = desk.start(&["stream", "--port", &port, "--json", "stream.json"]);
    let (mut seen, mut slowest) = (Seen::default(), BTreeMap::<Trouble, (u32, Duration)>::new());
    let (started, mut memory_before) = (Instant::now(), 0);
    for event in 0..events {
        (0..CALM_FRAMES).for_each(|_| seen.take(&stream.line()));
        if event == events / 4 {
            memory_before = memory(stream.id());
        }
        let what = TROUBLES[random.random_range(0..TROUBLES.len())];
        let lasts = Duration::from_millis(random.random_range(20..2500));
        let starts = seen.starts + u64::from(what == Trouble::Restart);
        trouble(what, lasts, &mut board, &cable, &mut random);
        let (passed, fresh) = (Instant::now(), board.as_ref().unwrap().next_frame());
        while seen.starts < starts || seen.last.is_none_or(|last| last < fresh) {
            seen.take(&stream.line());
        }
        let recovery = passed.elapsed();
        assert!(recovery < within(RECOVERY), "event {event}, {what:?} for {lasts:?}: {recovery:?}");
        let (count, longest) = slowest.entry(what).or_default();
        (*count, *longest) = (*count + 1, (*longest).max(recovery));
    }
    let (memory_after, lasted) = (memory(stream.id()), started.elapsed());
    stream.interrupt();
    let done = stream.finish().success();
    done.out.lines().for_each(|line| seen.take(line));
    let report = desk.report("stream.json");
    println!(
        "{events} events, seed {seed}, {:.0} s; contacts again, count and slowest: {slowest:?}",
        lasted.as_secs_f64()
    );
    println!("memory of `stream`: {memory_before} kB after a quarter, {memory_after} kB at the end");
    println!("{} frames, {} lost between others, {} gaps", seen.frames, seen.missing, seen.gaps);
    assert_eq!(report["frames_received"], seen.frames, "{report:#}");
    assert_eq!(report["frames_lost"], seen.missing, "{report:#}");
    let count = |name: &str| report[name].as_u64().unwrap();
    // Events that came before the reply to the request for them belong to no frame of the stream.
    assert!(
        (seen.missing..=seen.missing + count("packets_damaged")).contains(&count("events_lost")),
        "{report:#}"
    );
    assert_eq!(report["gaps"].as_array().unwrap().len() as u64, seen.gaps, "{report:#}");
    assert!(memory_after < memory_before + 4000, "{memory_before} kB, then {memory_after} kB");
}
