//! `run`: an emulated board that any program can talk to over TCP.
//!
//! Virtual time follows the clock on the wall, as far as the machine is fast enough: a board that
//! idles takes next to nothing.

use super::boot::{Firmware, boot, check_faults};
use dermatome::{
    link::{self, Link, Port, program::log::Log, trim::Plug},
    model::Model,
    quantize,
    simulate::Press,
    skin::Skin,
};
use dermatome_hil::{
    board::VirtualBoard,
    chip::{time::Time, usart::Symbol},
    fault::{Fault, Schedule},
    probe::emulated::LogReader,
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

/// Options of `run`.
#[derive(clap::Args)]
pub(super) struct Run {
    #[command(flatten)]
    firmware: Firmware,
    /// Skin that the board measures, instead of the rig's; the board holds its patch from the start, as if
    /// it had been flashed before.
    #[arg(long)]
    skin: Option<PathBuf>,
    /// A finger that rests on the skin: x,y,radius,depth (m, m, m, relative). Can be repeated.
    #[arg(long = "press", allow_hyphen_values = true)]
    presses: Vec<Press>,
    /// The test plug of docs/hardware.md takes the place of skin and leads, for `dermatome trim`.
    #[arg(long, conflicts_with = "presses")]
    plug: bool,
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
        let (board, firmware) = boot(&self.firmware, false, skin.clone())?;
        let log = self.logs.then(|| Log::new(&firmware)).transpose()?;
        let mut log = log.as_ref().map(|log| LogReader::new(log, io::stderr().is_terminal()));
        if let Some(skin) = &skin {
            flash(&board, skin)?;
        }
        press(&board, &self.presses)?;
        if self.plug {
            let world =
                board.world().ok_or("the rig has no `[world]`, so that there is nowhere to plug it in")?;
            world.plug(Some(*Plug::new(2.2, 22.0).ohms()));
        }
        check_faults(&self.faults, &board)?;
        say!("board         {} (emulated STM32G474RE)", self.firmware.name());
        say!("listening at  tcp:{}   (Ctrl-C stops it)", listener.local_addr()?);
        serve(&listener, &board, &self.faults, log.as_mut())
    }
}

/// Runs the board for ever, at the pace of the clock on the wall, and carries its bytes to and from a program.
fn serve(
    listener: &TcpListener,
    board: &VirtualBoard,
    faults: &[Fault],
    mut log: Option<&mut LogReader<'_>>,
) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let start = board.with(|machine| machine.now());
    let faults = Arc::new(Mutex::new(Schedule::new(&shifted(faults, start))));
    let wall = Instant::now();
    let mut client: Option<TcpStream> = None;
    loop {
        if client.is_none() {
            client = accept(listener)?;
        }
        let (now, sent) = run_slice(board, &faults)?;
        for line in log.as_mut().map_or(Ok(Vec::new()), |log| log.lines(board))? {
            eprintln!("{line}");
        }
        if let Some(stream) = &mut client
            && !exchange(stream, board, &sent)
        {
            client = None;
            board.with(|machine| machine.chip(|chip| chip.uart.unplug()));
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
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

fn press(board: &VirtualBoard, presses: &[Press]) -> Result<(), Box<dyn Error>> {
    if presses.is_empty() {
        return Ok(());
    }
    let world = board.world().ok_or("the rig has no `[world]`, so that there is no skin to press")?;
    let outline = world.setup().skin.shape.flat()?;
    presses.iter().try_for_each(|press| press.check(outline))?;
    world.press(presses);
    Ok(())
}

fn flash(board: &VirtualBoard, skin: &Skin) -> Result<(), Box<dyn Error>> {
    let model = Model::build(skin, |_| ())?;
    let patch = quantize::patch(skin, &model)?;
    link::upload(&mut Link::connect("virtual", board.line())?, &patch, |_| ())?;
    Ok(())
}

/// The next program that connects, if one does. Others wait until it has gone.
fn accept(listener: &TcpListener) -> io::Result<Option<TcpStream>> {
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
fn run_slice(board: &VirtualBoard, faults: &Arc<Mutex<Schedule>>) -> Result<(Time, Vec<u8>), Box<dyn Error>> {
    let schedule = faults.clone();
    let (now, sent, happened) = board.with(move |machine| {
        let deadline = machine.now() + SLICE;
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
fn exchange(stream: &mut TcpStream, board: &VirtualBoard, sent: &[u8]) -> bool {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(0) => return false,
        Ok(length) => {
            board.send(Symbol::undamaged(&buffer[..length]));
        }
        Err(error) if error.kind() == ErrorKind::WouldBlock => {}
        Err(_) => return false,
    }
    write_all(stream, sent).is_ok()
}

/// Waits for a program that reads slowly, as a line with flow control does.
fn write_all(stream: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
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
