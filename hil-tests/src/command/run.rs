//! `run`: an emulated board, or several on one line, that any program can talk to over TCP.
//!
//! Virtual time follows the clock on the wall, as far as the machine is fast enough: a board that
//! idles takes next to nothing.

use super::{
    boot::{Firmware, boot_on, check_faults},
    fingers::{Fingers, Pressing},
    run_bus,
};
use dermatome::{
    link::{self, Port, program::log::Log, trim::Plug},
    model::Model,
    quantize,
    skin::Skin,
};
use dermatome_hil::{
    board::VirtualBoard,
    chip::{time::Time, usart::Symbol},
    fault::{Fault, Schedule},
    probe::emulated::LogReader,
    rig::Rig,
};
use std::{
    error::Error,
    io::{self, ErrorKind, IsTerminal, Read, Write},
    net::{TcpListener, TcpStream},
    path::PathBuf,
    process::ExitCode,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Virtual time between two polls of the connection.
const SLICE: Time = Time::from_millis(1);
/// The same of a board that is behind the clock on the wall, which has no time for more polls.
const SLICE_BEHIND: Time = Time::from_millis(5);

/// Options of `run`.
#[derive(clap::Args)]
pub(super) struct Run {
    #[command(flatten)]
    pub(super) firmware: Firmware,
    /// How many boards there are on the line of hil-tests/rigs/rs485.toml, at addresses from 0 on [default: 1]. What
    /// they send, and what is sent to them, is that of docs/protocol.md, "Bus".
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=16), conflicts_with_all = ["faults", "logs"])]
    boards: Option<u8>,
    /// Skin that the board measures, instead of the rig's; the board holds its patch from the start, as if
    /// it had been flashed before.
    #[arg(long)]
    skin: Option<PathBuf>,
    #[command(flatten)]
    pub(super) pressing: Pressing,
    /// The test plug of docs/hardware.md takes the place of skin and leads, for `dermatome trim`.
    #[arg(long, conflicts_with_all = ["presses", "path", "material"])]
    pub(super) plug: bool,
    /// Where programs reach the board.
    #[arg(long, default_value = "tcp:127.0.0.1:7000")]
    listen: Port,
    /// What goes wrong, and when (in virtual time from here on), e.g. power@2s. Can be repeated.
    #[arg(long = "fault")]
    faults: Vec<Fault>,
    /// Also print the firmware's log, on standard error.
    #[arg(long)]
    logs: bool,
}

impl Run {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let Port::Tcp(address) = &self.listen else {
            return Err(format!("cannot listen at `{}`: allowed is tcp:HOST:PORT", self.listen).into());
        };
        let listener = TcpListener::bind(address)
            .map_err(|error| format!("cannot listen at `{}`: {error}", self.listen))?;
        let skin = self.skin.as_deref().map(|path| Skin::load(path)?.made()).transpose()?;
        let rig_file = self.firmware.rig_file();
        let (board, firmware) = match (self.firmware.open()?, self.boards) {
            (Rig::Bus(_), _) if !self.faults.is_empty() || self.logs => {
                return Err(format!(
                    "rig `{}` puts boards on one line: `--fault` and `--logs` are for one alone",
                    rig_file.display()
                )
                .into());
            }
            (Rig::Bus(rig), boards) => return run_bus::run(&self, rig, boards.unwrap_or(1), &listener, skin),
            (_, Some(_)) => {
                return Err(format!(
                    "rig `{}` is one board: `--boards` is for --rig hil-tests/rigs/rs485.toml",
                    rig_file.display()
                )
                .into());
            }
            (rig, None) => boot_on(rig, &rig_file, false, skin.clone())?,
        };
        let log = self.logs.then(|| Log::new(&firmware)).transpose()?;
        let log = log.as_ref().map(|log| LogReader::new(log, io::stderr().is_terminal()));
        if let Some(skin) = &skin {
            flash(&board, skin)?;
        }
        let fingers = self.pressing.fingers(board.world())?;
        if self.plug {
            let world =
                board.world().ok_or("the rig has no `[world]`, so that there is nowhere to plug it in")?;
            world.plug(Some(*Plug::new(2.2, 22.0).ohms()));
        }
        check_faults(&self.faults, &board)?;
        say!("board         {} (emulated STM32G474RE)", self.firmware.name());
        say!("listening at  tcp:{}   (Ctrl-C stops it)", listener.local_addr()?);
        let faults = Arc::new(Mutex::new(Schedule::new(&shifted(&self.faults, now(&board)))));
        serve(&listener, Served { board, faults, log, fingers })
    }
}

/// A board, and what goes on beside it.
struct Served<'a> {
    board: VirtualBoard,
    faults: Arc<Mutex<Schedule>>,
    log: Option<LogReader<'a>>,
    fingers: Option<Fingers>,
}

fn now(board: &VirtualBoard) -> Time {
    board.with(|machine| machine.now())
}

/// Runs the board for ever, at the pace of the clock on the wall, and carries its bytes to and from a program.
fn serve(listener: &TcpListener, mut served: Served<'_>) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let (start, wall) = (now(&served.board), Instant::now());
    let mut client: Option<TcpStream> = None;
    let mut slice = SLICE;
    loop {
        if client.is_none() {
            client = accept(listener)?;
        }
        let Served { board, faults, log, fingers } = &mut served;
        let (now, sent) = run_slice(board, faults, slice)?;
        for line in log.as_mut().map_or(Ok(Vec::new()), |log| log.lines(board))? {
            eprintln!("{line}");
        }
        if let Some(fingers) = fingers {
            fingers.hear_board(&sent);
        }
        if let Some(stream) = &mut client
            && !exchange(stream, board, &sent, fingers.as_mut())
        {
            client = None;
            board.with(|machine| machine.chip(|chip| chip.uart.unplug()));
            fingers.iter_mut().for_each(Fingers::lose_host);
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
        slice = if ahead.is_zero() { SLICE_BEHIND } else { SLICE };
        std::thread::sleep(ahead);
    }
}

/// Times of faults count from when the board is handed over.
fn shifted(faults: &[Fault], start: Time) -> Vec<Fault> {
    use dermatome_hil::fault::When;
    let shift = |when| match when {
        When::Time(time) => When::Time(time + start),
        operation => operation,
    };
    faults.iter().map(|fault| Fault { when: shift(fault.when), ..*fault }).collect()
}

fn flash(board: &VirtualBoard, skin: &Skin) -> Result<(), Box<dyn Error>> {
    let model = Model::build(skin, |_| ())?;
    let patch = quantize::patch(skin, &model)?;
    link::upload(&mut board.link()?, &patch, |_| ())?;
    Ok(())
}

/// The next program that connects, if one does. Others wait until it has gone.
pub(super) fn accept(listener: &TcpListener) -> io::Result<Option<TcpStream>> {
    match listener.accept() {
        Ok((stream, _)) => {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            Ok(Some(stream))
        }
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}

/// Lets the board run for a while; gives its time and what it has sent, and prints what went wrong.
fn run_slice(
    board: &VirtualBoard,
    faults: &Arc<Mutex<Schedule>>,
    slice: Time,
) -> Result<(Time, Vec<u8>), Box<dyn Error>> {
    let schedule = faults.clone();
    let (now, sent, happened) = board.with(move |machine| {
        let deadline = machine.now() + slice;
        let happened = schedule.lock().unwrap_or_else(PoisonError::into_inner).run(machine, deadline);
        let sent: Vec<u8> =
            machine.chip(|chip| chip.uart.take_sent()).into_iter().map(|(_, byte)| byte).collect();
        (machine.now(), sent, happened)
    });
    for (time, what) in happened? {
        say!("{:>12.3} s  {what}", time.seconds());
    }
    Ok((now, sent))
}

/// Carries bytes between a program and the board; says whether the program is still there.
fn exchange(
    stream: &mut TcpStream,
    board: &VirtualBoard,
    sent: &[u8],
    fingers: Option<&mut Fingers>,
) -> bool {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(0) => return false,
        Ok(length) => {
            fingers.into_iter().for_each(|fingers| fingers.hear_host(&buffer[..length]));
            board.send(Symbol::undamaged(&buffer[..length]));
        }
        Err(error) if error.kind() == ErrorKind::WouldBlock => {}
        Err(_) => return false,
    }
    write_all(stream, sent).is_ok()
}

/// Waits for a program that reads slowly, as a line with flow control does.
pub(super) fn write_all(stream: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::BrokenPipe.into()),
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                std::thread::sleep(Duration::from_millis(1));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
