//! A bench for tests: small patches, a seeded frame source, a fake board.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub(crate) mod cable;
pub(crate) mod can;
pub(crate) mod rs485;

use dermatome::{
    link::{Link, LinkError, Port},
    patch::matrix::FixedMatrix,
    simulate::{
        board::{BoardOptions, Pace, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
};
use dermatome_shared::{
    calibration::Calibration,
    drive::Drive,
    frame::Frame,
    image::{Geometry, PixelGrid},
    patch::{
        CombinedInto, Difference, PatchContents, PatchHeader, matrix::MatrixLayout, reflexes::ReflexTables,
    },
    protocol::{
        self, BoardPacket, Identity, Info, MAX_PACKET_BYTES, PacketReader, Reply, Request, RequestPacket,
        Selection, Version, encode,
    },
    restart::Restart,
    stimulation::{Driven, pattern},
    units::{AdcCode, RelativeConductivity},
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::{
    io::{Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{Arc, Mutex},
    thread,
    time::Duration,
};

/// Code of every step of an untouched skin, without noise.
pub(crate) const UNTOUCHED: i32 = 1_000_000;

/// A patch of 8 electrodes and 2 x 2 pixels of 10 mm; pixel p is the relative change of
/// measurement p.
pub(crate) fn small_patch(name: &str, frame_rate: f32) -> Vec<u8> {
    square_patch(name, 8, 2, frame_rate)
}

/// As [`small_patch`], with `side` x `side` pixels, at most as many as steps.
pub(crate) fn square_patch(name: &str, electrodes: u8, side: u8, frame_rate: f32) -> Vec<u8> {
    let steps: Vec<_> = pattern(electrodes, 1, 1, Driven::Skipped).collect();
    let combination: Vec<_> =
        (0..steps.len() as u16).map(|measurement| CombinedInto { measurement, flipped: false }).collect();
    let pixels = usize::from(side) * usize::from(side);
    let grid = PixelGrid { columns: side, rows: side, pitch: 0.01, left: -0.01, top: 0.01 };
    let geometry = Geometry::first_cells(grid, pixels);
    let (places, neighbours) = geometry.tables();
    let header = PatchHeader {
        skin: name.try_into().unwrap(),
        electrodes,
        steps: steps.len() as u16,
        measurements: steps.len() as u16,
        pixels: pixels as u16,
        difference: Difference::Normalised,
        neighbours: neighbours.len() as u16,
        surface: geometry.scale(),
        grid: Some(grid),
        drive: Drive::new(50e3, 1e-3, frame_rate),
        contact_threshold: RelativeConductivity::from_f64(0.01),
        drift_time: 0.0,
        calibration: Calibration::default(),
        test_resistances: Default::default(),
        play_operators: 0,
        reflexes: 0,
        reflex_rows: 0,
        matrix: MatrixLayout::default(),
        detection: Default::default(),
    };
    let mut matrix = vec![0; pixels * steps.len()];
    for pixel in 0..pixels {
        matrix[pixel * steps.len() + pixel] = 1 << 14;
    }
    let matrix = FixedMatrix::from_data(vec![0; steps.len()], vec![14; pixels], &matrix);
    let header = PatchHeader { matrix: matrix.tables().layout(), ..header };
    let contents = PatchContents {
        play_operators: &[],
        reflexes: ReflexTables::default(),
        header: &header,
        steps: &steps,
        combination: &combination,
        pixels: &places,
        neighbours: &neighbours,
        matrix: matrix.tables(),
        places: Default::default(),
    };
    let mut out = vec![0; dermatome_shared::limits::FLASH_SLOT_BYTES];
    let length = contents.write(&mut out).unwrap();
    out.truncate(length);
    out
}

/// Checksum of a patch: its last four bytes.
pub(crate) fn crc(patch: &[u8]) -> u32 {
    u32::from_le_bytes(*patch.last_chunk().unwrap())
}

/// A skin whose measurement 1 rises with script time, 10 % a second, under a little noise.
pub(crate) struct Pressed {
    random: Pcg32,
    /// Script time of every scan so far.
    pub(crate) log: Arc<Mutex<Vec<Option<f64>>>>,
}

impl Pressed {
    pub(crate) fn new(seed: u64) -> Self {
        Self { random: Pcg32::seed_from_u64(seed), log: Arc::default() }
    }
}

impl Instrument for Pressed {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        self.log.lock().unwrap().push(script_time);
        let mut noisy = || AdcCode(UNTOUCHED + self.random.random_range(-100..=100));
        let mut frame = Frame { codes: table.steps.iter().map(|_| noisy()).collect(), ..Frame::default() };
        frame.codes[1].0 += (f64::from(UNTOUCHED) * 0.1 * script_time.unwrap_or(0.0)) as i32;
        frame
    }
}

/// A skin on which a finger lies for its board's first scans, also while there is no script.
pub(crate) struct Held {
    skin: Pressed,
    scans: u32,
}

impl Held {
    pub(crate) fn new(scans: u32) -> Self {
        Self { skin: Pressed::new(2), scans }
    }
}

impl Instrument for Held {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let mut frame = self.skin.scan(table, script_time);
        self.scans = self.scans.saturating_sub(1);
        frame.codes[3].0 += if self.scans > 0 { UNTOUCHED / 10 } else { 0 };
        frame
    }
}

/// An unpaced board without a patch.
pub(crate) fn empty_board() -> SimulatedBoard {
    let options = BoardOptions { pace: Pace::Unpaced, ..BoardOptions::default() };
    SimulatedBoard::start(options, Pressed::new(1)).unwrap()
}

/// An unpaced board that holds `patch`.
pub(crate) fn board_with(patch: &[u8]) -> SimulatedBoard {
    let options =
        BoardOptions { pace: Pace::Unpaced, patch: Some(patch.to_vec()), ..BoardOptions::default() };
    SimulatedBoard::start(options, Pressed::new(1)).unwrap()
}

pub(crate) fn connect(address: SocketAddr) -> Result<Link, LinkError> {
    dermatome::link::open(&Port::Tcp(address.to_string()))
}

/// A plain connection for mischief, with the read timeout a link needs.
pub(crate) fn raw(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_nodelay(true).unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    stream
}

/// What a fake board does with a request.
pub(crate) enum Answer {
    Reply(Box<Reply>),
    Silence,
    Gone,
}

/// Something that listens and answers requests by `answer`; `None` closes the connection.
pub(crate) fn fake_board(mut answer: impl FnMut(Request) -> Option<Reply> + Send + 'static) -> SocketAddr {
    fake_line(move |packet| {
        answer(packet.request).map_or(Answer::Gone, |reply| Answer::Reply(Box::new(reply)))
    })
}

/// As [`fake_board`], by whole packets.
pub(crate) fn fake_line(mut answer: impl FnMut(RequestPacket) -> Answer + Send + 'static) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut reader = PacketReader::default();
        let mut byte = [0];
        while stream.read(&mut byte).is_ok_and(|length| length == 1) {
            let Some(packet) = reader.push::<RequestPacket>(byte[0]) else { continue };
            let packet = packet.unwrap();
            let sequence = packet.sequence;
            let reply = match answer(packet) {
                Answer::Reply(reply) => *reply,
                Answer::Silence => continue,
                Answer::Gone => return,
            };
            let mut buffer = [0; MAX_PACKET_BYTES];
            let bytes = encode(&BoardPacket::Reply { sequence, reply }, &mut buffer).unwrap();
            stream.write_all(bytes).unwrap();
        }
    });
    address
}

/// What a fake board says to Hello.
pub(crate) fn hello(version: Version) -> Reply {
    let identity = Identity { board: "fake".try_into().unwrap(), firmware: "0.0.1".try_into().unwrap() };
    Reply::Hello { version, identity }
}

/// What a fake board says to Info.
pub(crate) fn info(electrodes: u8, max_patch_bytes: u32) -> Reply {
    Reply::Info(Info {
        electrodes,
        max_patch_bytes,
        frame_source: protocol::FrameSource::Skin,
        front_end: None,
        drive: None,
        started_after: Restart::PowerOn,
        uptime_ms: 1,
        patch: None,
        tared: false,
        streaming: Selection::default(),
    })
}
