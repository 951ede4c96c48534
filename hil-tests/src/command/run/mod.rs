//! `run`: an emulated board, or several on one line or bus, that any program can talk to over TCP.
//!
//! Virtual time follows the clock on the wall, as far as the machine is fast enough: a board that
//! idles takes next to nothing.

mod alone;
mod can;
mod line;
mod program;

use super::{
    boot::{Firmware, boot_on, check_faults},
    fingers::{Fingers, Pressing},
};
use dermatome::{
    link::{self, Port, program::log::Log, trim::Plug},
    model::Model,
    quantize,
    skin::Skin,
};
use dermatome_hil::{
    bus::{BusRig, Shared, can::host::Host, master::Master},
    chip::flash::Flash,
    chip::time::Time,
    fault::{Fault, Schedule},
    probe::emulated::LogReader,
    rig::Rig,
    world::WorldHandle,
};
use std::{
    error::Error,
    io::{self, IsTerminal},
    net::TcpListener,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{Arc, Mutex},
};

/// Options of `run`.
#[derive(clap::Args)]
pub(super) struct Run {
    #[command(flatten)]
    firmware: Firmware,
    /// How many boards there are on the line of hil-tests/rigs/rs485.toml or the bus of hil-tests/rigs/can.toml, at
    /// addresses from 0 on [default: 1]. What they send over the line, and what is sent to them, is that of
    /// docs/protocol.md, "Bus"; the CAN bus is reached through an adapter that speaks slcan.
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=16), conflicts_with_all = ["faults", "logs"])]
    boards: Option<u8>,
    /// Skin that the board measures, instead of the rig's; the board holds its patch from the start, as if
    /// it had been flashed before.
    #[arg(long)]
    skin: Option<PathBuf>,
    #[command(flatten)]
    pressing: Pressing,
    /// The test plug of docs/hardware.md takes the place of skin and leads, for `dermatome trim`.
    #[arg(long, conflicts_with_all = ["presses", "path", "material"])]
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
        let rig_file = self.firmware.rig_file();
        match (self.firmware.open()?, self.boards) {
            (Rig::Bus(_), _) if !self.faults.is_empty() || self.logs => Err(format!(
                "rig `{}` puts boards on one line or bus: `--fault` and `--logs` are for one alone",
                rig_file.display()
            )
            .into()),
            (Rig::Bus(rig), boards) => self.run_several(&listener, rig, boards.unwrap_or(1), skin.as_ref()),
            (_, Some(_)) => Err(format!(
                "rig `{}` is one board: `--boards` is for --rig hil-tests/rigs/rs485.toml and can.toml",
                rig_file.display()
            )
            .into()),
            (rig, None) => self.run_alone(&listener, rig, &rig_file, skin.as_ref()),
        }
    }

    fn run_alone(
        &self,
        listener: &TcpListener,
        rig: Rig,
        rig_file: &Path,
        skin: Option<&Skin>,
    ) -> Result<ExitCode, Box<dyn Error>> {
        let (board, firmware) = boot_on(rig, rig_file, false, skin.cloned())?;
        let log = self.logs.then(|| Log::new(&firmware)).transpose()?;
        let log = log.as_ref().map(|log| LogReader::new(log, io::stderr().is_terminal()));
        if let Some(skin) = skin {
            link::upload(&mut board.link()?, &patch_of(skin)?, |_| ())?;
        }
        let fingers = self.touch(board.world())?;
        check_faults(&self.faults, &board)?;
        say!("board         {} (emulated STM32G474RE)", self.firmware.name());
        say!("listening at  tcp:{}   (Ctrl-C stops it)", listener.local_addr()?);
        let start = board.with(|machine| machine.now());
        let faults = Arc::new(Mutex::new(Schedule::new(&shifted(&self.faults, start))));
        alone::serve(listener, alone::Served { board, faults, log, fingers })
    }

    /// Runs boards at addresses from 0 on.
    fn run_several(
        &self,
        listener: &TcpListener,
        mut rig: BusRig,
        boards: u8,
        skin: Option<&Skin>,
    ) -> Result<ExitCode, Box<dyn Error>> {
        let mut flash = rig.flash();
        if let Some(skin) = skin {
            if let Some(world) = &mut rig.options.world {
                *world = world.with_skin(skin.clone())?.into();
            }
            flash = flashed(&rig, &flash, &patch_of(skin)?)?;
        }
        let addresses: Vec<u8> = (0..boards).collect();
        let places = 0..usize::from(boards);
        let named = || {
            let name = self.firmware.name();
            say!("boards        {boards} x {name} (emulated STM32G474RE), addresses 0 to {}", boards - 1);
        };
        match rig.shared {
            Shared::Line => {
                let bus = rig.start(&addresses, &flash)?;
                let worlds = places.map(|board| bus.with(move |line| line.machine(board).world().cloned()));
                let fingers = self.touch_all(worlds)?;
                named();
                say!("listening at  tcp:{}   (Ctrl-C stops it)", listener.local_addr()?);
                program::serve(listener, line::Boards::new(bus, fingers))
            }
            Shared::Can => {
                let bus = rig.start_can(&addresses, &flash)?;
                let worlds = places.map(|board| bus.with(move |wire| wire.machine(board).world().cloned()));
                let fingers = self.touch_all(worlds)?;
                named();
                say!("listening at  tcp:{}   (slcan; Ctrl-C stops it)", listener.local_addr()?);
                program::serve(listener, can::Boards::new(bus, fingers))
            }
        }
    }

    fn touch_all(
        &self,
        mut worlds: impl Iterator<Item = Option<WorldHandle>>,
    ) -> Result<Vec<Fingers>, Box<dyn Error>> {
        worlds.try_fold(Vec::new(), |mut fingers, world| {
            fingers.extend(self.touch(world)?);
            Ok(fingers)
        })
    }

    /// Presses a board's skin, or puts the plug in its place.
    fn touch(&self, world: Option<WorldHandle>) -> Result<Option<Fingers>, Box<dyn Error>> {
        if self.plug {
            let world = world.ok_or("the rig has no `[world]`, so that there is nowhere to plug it in")?;
            world.plug(Some(*Plug::new(2.2, 22.0).ohms()));
            return Ok(None);
        }
        self.pressing.fingers(world)
    }
}

/// A flash with a patch that a board of its own takes over its line or bus.
fn flashed(rig: &BusRig, flash: &Flash, patch: &[u8]) -> Result<Flash, Box<dyn Error>> {
    Ok(match rig.shared {
        Shared::Line => {
            let bus = rig.start(&[0], flash)?;
            link::upload(&mut Master::new(bus.clone(), &[0]).link(0)?, patch, |_| ())?;
            bus.with(|line| line.machine(0).chip(|chip| chip.flash.clone()))
        }
        Shared::Can => {
            let bus = rig.start_can(&[0], flash)?;
            link::upload(&mut Host::new(bus.clone()).link(0)?, patch, |_| ())?;
            bus.with(|wire| wire.machine(0).chip(|chip| chip.flash.clone()))
        }
    })
}

fn patch_of(skin: &Skin) -> Result<Vec<u8>, Box<dyn Error>> {
    let model = Model::build(skin, |_| ())?;
    Ok(quantize::patch(skin, &model)?)
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
