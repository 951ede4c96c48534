//! `run` with boards on one line: a program at the other end of the TCP connection is its host, and gives the turns.

use super::{
    fingers::Fingers,
    run::{Run, accept, write_all},
};
use dermatome::{link, link::trim::Plug, model::Model, quantize, skin::Skin};
use dermatome_hil::{
    bus::{Bus, BusRig, SLICE, master::Master},
    chip::time::Time,
    machine::Halt,
};
use dermatome_shared::protocol::bus::{Ear, Heard, Mark};
use std::{
    error::Error,
    io::{ErrorKind, Read},
    net::{TcpListener, TcpStream},
    process::ExitCode,
    thread,
    time::{Duration, Instant},
};

/// Slices of the line between two polls of the connection.
const SLICES: u64 = 5;

/// Boards on a line, and what goes on beside it.
struct Served {
    bus: Bus,
    /// Of each board, where somebody presses.
    fingers: Vec<Fingers>,
    /// What the fingers go by.
    host: Ear,
    boards: Ear,
}

/// Runs boards at addresses from 0 on for ever, at the pace of the clock on the wall.
pub(super) fn run(
    options: &Run,
    mut rig: BusRig,
    boards: u8,
    listener: &TcpListener,
    skin: Option<Skin>,
) -> Result<ExitCode, Box<dyn Error>> {
    let mut flash = rig.flash();
    if let Some(skin) = skin {
        if let Some(world) = &mut rig.options.world {
            *world = world.with_skin(skin.clone())?.into();
        }
        flash = flashed(&rig, &skin)?;
    }
    let addresses: Vec<u8> = (0..boards).collect();
    let bus = rig.start(&addresses, &flash)?;
    let world = |board| bus.with(move |line| line.machine(board).world().cloned());
    let mut fingers = Vec::new();
    for board in 0..usize::from(boards) {
        fingers.extend(options.pressing.fingers(world(board))?);
        if options.plug {
            let world =
                world(board).ok_or("the rig has no `[world]`, so that there is nowhere to plug it in")?;
            world.plug(Some(*Plug::new(2.2, 22.0).ohms()));
        }
    }
    say!(
        "boards        {boards} x {} (emulated STM32G474RE), addresses 0 to {}",
        options.firmware.name(),
        boards - 1
    );
    say!("listening at  tcp:{}   (Ctrl-C stops it)", listener.local_addr()?);
    serve(listener, Served { bus, fingers, host: Ear::default(), boards: Ear::default() })
}

/// A flash with the firmware and a skin's patch, which a board of its own has taken over the line.
fn flashed(rig: &BusRig, skin: &Skin) -> Result<dermatome_hil::chip::flash::Flash, Box<dyn Error>> {
    let model = Model::build(skin, |_| ())?;
    let patch = quantize::patch(skin, &model)?;
    let bus = rig.start(&[0], &rig.flash())?;
    link::upload(&mut Master::new(bus.clone(), &[0]).link(0)?, &patch, |_| ())?;
    Ok(bus.with(|line| line.machine(0).chip(|chip| chip.flash.clone())))
}

fn serve(listener: &TcpListener, mut served: Served) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let (start, wall) = (served.bus.with(|line| line.now()), Instant::now());
    let mut client: Option<TcpStream> = None;
    loop {
        if client.is_none() {
            client = accept(listener)?;
        }
        let asked = client.as_mut().map_or(Some(Vec::new()), read);
        let is_there = asked.is_some();
        let (now, heard) = served.pass(asked.unwrap_or_default())?;
        if let Some(stream) = &mut client
            && !(is_there && write_all(stream, &heard).is_ok())
        {
            client = None;
            served.fingers.iter_mut().for_each(Fingers::lose_host);
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
        thread::sleep(ahead);
    }
}

/// What a program has sent; none if it has gone.
fn read(stream: &mut TcpStream) -> Option<Vec<u8>> {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(0) => None,
        Ok(length) => Some(buffer[..length].to_vec()),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Some(Vec::new()),
        Err(_) => None,
    }
}

impl Served {
    /// Puts bytes on the line and lets some time pass; gives the time and what the host hears.
    fn pass(&mut self, asked: Vec<u8>) -> Result<(Time, Vec<u8>), Halt> {
        for &byte in &asked {
            self.follow(byte, Mark::Request);
        }
        let (now, heard) = self.bus.with(move |line| {
            if !asked.is_empty() {
                line.say(&asked);
            }
            line.run_until(line.now() + SLICE * SLICES)?;
            let heard: Vec<u8> = line.take_heard().into_iter().map(|(_, byte)| byte).collect();
            Ok::<_, Halt>((line.now(), heard))
        })?;
        for &byte in &heard {
            self.follow(byte, Mark::Said);
        }
        Ok((now, heard))
    }

    /// Fingers hear what their own boards are asked and say.
    fn follow(&mut self, byte: u8, of: Mark) {
        let ear = if of == Mark::Request { &mut self.host } else { &mut self.boards };
        let Some(Heard::Byte { mark, address, byte }) = ear.hear(byte) else { return };
        let Some(fingers) = self.fingers.get_mut(usize::from(address)).filter(|_| mark == of) else { return };
        match of {
            Mark::Request => fingers.hear_host(&[byte]),
            _ => fingers.hear_board(&[byte]),
        }
    }
}
