//! Rig: which board the cases run against, and what can be done to it.
//!
//! A rig file names an emulated board or a real one. A case sees a link to the board and the list of
//! what the rig can do, and cannot tell the two apart.

use crate::{
    board::{START_TIME, VirtualBoard},
    bus::{BusRig, Shared},
    chip::{flash::Flash, time::Time, usart::Symbol},
    machine::{Halt, Machine, Options, cycles::Timing},
    probe::{Programmer, ProgrammerError, emulated},
    world::{Analogue, Setup, WorldError, parameters::ParameterError},
};
use dermatome::{
    link::{
        Link,
        program::firmware::{Firmware, FirmwareError},
    },
    simulate::port::{self, OpenError, Port},
    skin::{Skin, SkinError},
};
use serde::Deserialize;
use std::{
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

/// What a rig can do to its board, beyond talking to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Capability {
    /// Switch its power off and on, at any moment.
    PowerCut,
    /// Tell what its flash is doing, and cut the power at any step of that.
    FlashSteps,
    /// Send any bytes over its line, damaged ones too.
    RawLine,
    /// Press its reset button.
    ResetButton,
    /// Start it anew, in whatever way.
    Reset,
    /// Program its firmware.
    Program,
    /// Read its log.
    Log,
    /// Make its CPU hang, or fault.
    BreakCpu,
    /// Measure time on the board's own clock, and say what happened when.
    VirtualTime,
    /// Put several boards on one line.
    SharedLine,
    /// Put several boards on one CAN bus.
    CanBus,
    /// Plug the cable of a link over USB, and let the host do anything.
    Usb,
}

impl fmt::Display for Capability {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::PowerCut => "cut the power",
            Self::FlashSteps => "stop at steps of the flash",
            Self::RawLine => "send damaged bytes",
            Self::ResetButton => "press reset",
            Self::Reset => "start it anew",
            Self::Program => "program it",
            Self::Log => "read its log",
            Self::BreakCpu => "make the CPU hang or fault",
            Self::VirtualTime => "tell virtual time",
            Self::SharedLine => "put several boards on one line",
            Self::CanBus => "put several boards on one CAN bus",
            Self::Usb => "plug a cable of USB",
        })
    }
}

/// A rig file.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum RigFile {
    /// The firmware's ELF on an emulated STM32G474.
    Virtual(EmulatedTable),
    /// The same on several of them, whose links share a line.
    Bus(EmulatedTable),
    /// The same on several of them, on one CAN bus.
    Can(EmulatedTable),
    /// A real board.
    Board {
        /// Its serial port.
        port: String,
        /// Its debug probe: a serial number, or vendor and product as in `0483:374e`.
        probe: Option<String>,
        /// The firmware that the probe programs first, seen from the rig file's folder.
        elf: Option<PathBuf>,
    },
}

/// What a rig file says of emulated boards.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmulatedTable {
    /// The firmware's ELF, seen from the rig file's folder.
    pub elf: PathBuf,
    /// What the manuals leave open of the core's cycles: `pessimistic` or `optimistic`.
    pub timing: Timing,
    /// Bits per second of the host's end of the link.
    pub baud: u64,
    /// Whether the link goes over USB, for which `baud` means nothing.
    #[serde(default)]
    pub usb: bool,
    /// What is random.
    pub seed: u64,
    /// What it measures; without it, nothing is connected.
    pub world: Option<WorldTable>,
}

/// `[world]` of a rig file: what an emulated board measures. Files are seen from the rig file's folder.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldTable {
    /// The skin's file.
    pub skin: PathBuf,
    /// The analogue front end's file.
    pub analogue: PathBuf,
    /// Capacitance beside the resistance of each contact, F per metre of electrode.
    #[serde(default)]
    pub contact_capacitance: f64,
    /// Whether there is noise.
    #[serde(default = "yes")]
    pub noise: bool,
}

fn yes() -> bool {
    true
}

impl EmulatedTable {
    /// Firmware, its file and how it runs; `elf` takes the place of the rig file's own.
    fn parts(self, path: &Path, elf: Option<&Path>) -> Result<(Arc<Firmware>, PathBuf, Options), RigError> {
        let Self { elf: own, timing, baud, usb, seed, world } = self;
        let folder = path.parent().unwrap_or(Path::new("."));
        let world = world.map(|world| world.setup(folder, seed).map(Arc::new)).transpose();
        let world = world.map_err(|reason| RigError::World { path: path.to_owned(), reason })?;
        let options =
            options(timing, baud, seed).map_err(|reason| RigError::File { path: path.to_owned(), reason })?;
        let elf = elf.map_or_else(|| beside(path, &own), Path::to_owned);
        Ok((Arc::new(Firmware::load(&elf)?), elf, Options { usb, world, ..options }))
    }

    fn sharing(self, shared: Shared, path: &Path, elf: Option<&Path>) -> Result<Rig, RigError> {
        let (firmware, _, options) = self.parts(path, elf)?;
        Ok(Rig::Bus(BusRig { shared, firmware, options }))
    }
}

impl WorldTable {
    fn setup(&self, folder: &Path, seed: u64) -> Result<Setup, WorldProblem> {
        if !(0.0..=1.0).contains(&self.contact_capacitance) {
            return Err(WorldError::Value {
                field: "world.contact_capacitance",
                value: format!("{} F/m", self.contact_capacitance),
                allowed: "0 to 1 F/m".to_owned(),
            }
            .into());
        }
        let skin = Skin::load(&folder.join(&self.skin))?.made()?;
        let analogue = Analogue::load(&folder.join(&self.analogue))?;
        let mut setup = Setup::new(skin, analogue, self.contact_capacitance, seed)?;
        setup.noise = self.noise;
        Ok(setup)
    }
}

/// Why a rig has no world.
#[derive(Debug, thiserror::Error)]
pub enum WorldProblem {
    /// The skin's file is not usable.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The front end's file is not usable.
    #[error(transparent)]
    Analogue(#[from] ParameterError),
    /// The two make no world.
    #[error(transparent)]
    World(#[from] WorldError),
}

/// Why there is no rig.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The rig file cannot be read.
    #[error("cannot read the rig file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// The rig file does not describe a rig.
    #[error("rig file `{}`: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The rig file's world cannot be.
    #[error("rig file `{}`, `[world]`: {reason}", path.display())]
    World {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: WorldProblem,
    },
    /// A case's skin does not go with the rig's front end.
    #[error(transparent)]
    Skin(#[from] WorldError),
    /// The firmware is no firmware.
    #[error(transparent)]
    Firmware(#[from] FirmwareError),
    /// The real board cannot be programmed or reset.
    #[error(transparent)]
    Programmer(#[from] ProgrammerError),
    /// The emulated board does not start.
    #[error("the emulated board does not start: {0}")]
    Halt(#[from] Halt),
    /// The real board does not respond.
    #[error("the rig has no board: {0}")]
    Open(#[from] OpenError),
}

/// A board and what can be done to it.
#[derive(Debug)]
pub enum Rig {
    /// An emulated board.
    Virtual(VirtualRig),
    /// What emulated boards that share a line or a bus are made of; a case makes them.
    Bus(BusRig),
    /// A real one.
    Board {
        /// Where it is.
        port: Port,
        /// Its debug probe, if the rig has one.
        programmer: Option<Programmer>,
    },
}

/// An emulated board and what it was made of.
#[derive(Debug)]
pub struct VirtualRig {
    /// The board.
    pub board: VirtualBoard,
    /// Its firmware.
    pub firmware: Arc<Firmware>,
    /// Where that came from.
    pub elf: PathBuf,
    /// How it runs.
    pub options: Options,
}

impl VirtualRig {
    /// An emulated board with this firmware, switched on for the first time.
    pub fn start(firmware: Arc<Firmware>, elf: PathBuf, options: Options) -> Result<Self, Halt> {
        let mut flash = Flash::default();
        emulated::program(&mut flash, &firmware);
        let board = VirtualBoard::start(flash, options.clone())?;
        Ok(Self { board, firmware, elf, options })
    }

    /// Programs a firmware, and starts the board anew.
    pub fn program(&self, firmware: Arc<Firmware>) -> Result<(), Halt> {
        self.board.with(move |machine| {
            machine.chip(|chip| emulated::program(&mut chip.flash, &firmware));
            machine.press_reset()
        })
    }
}

impl Rig {
    /// The rig of a file, its board switched on. `elf` takes the place of the file's firmware.
    pub fn open(path: &Path, elf: Option<&Path>) -> Result<Self, RigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|reason| RigError::Read { path: path.to_owned(), reason })?;
        let wrong = |reason: String| RigError::File { path: path.to_owned(), reason };
        match toml::from_str(&text).map_err(|error| wrong(error.to_string()))? {
            RigFile::Virtual(table) => {
                let (firmware, elf, options) = table.parts(path, elf)?;
                Ok(Self::Virtual(VirtualRig::start(firmware, elf, options)?))
            }
            RigFile::Bus(table) => table.sharing(Shared::Line, path, elf),
            RigFile::Can(table) => table.sharing(Shared::Can, path, elf),
            RigFile::Board { port, probe, elf: own } => {
                let port: Port = port.parse().map_err(|error| wrong(format!("`port`: {error}")))?;
                let own = own.map(|own| beside(path, &own));
                let programmer = match (probe, elf.or(own.as_deref())) {
                    (Some(id), elf) => Some(Programmer::open(&id, elf)?),
                    (None, None) => None,
                    (None, Some(elf)) => return Err(wrong(without_probe(elf))),
                };
                Self::Board { port, programmer }.take_over()
            }
        }
    }

    /// Programs a real board, if the rig can, and checks that it responds.
    fn take_over(self) -> Result<Self, RigError> {
        if self.can(Capability::Program) {
            self.program()?;
        } else if self.can(Capability::Reset) {
            self.reset()?;
        }
        self.link()?;
        Ok(self)
    }

    /// A board that nothing has happened to: a new emulated one, or the real one, reset if the rig can.
    pub fn fresh(&self) -> Result<Self, RigError> {
        match self {
            Self::Virtual(VirtualRig { firmware, elf, options, .. }) => {
                Ok(Self::Virtual(VirtualRig::start(firmware.clone(), elf.clone(), options.clone())?))
            }
            Self::Bus(rig) => Ok(Self::Bus(rig.clone())),
            Self::Board { port, programmer } => {
                let board = Self::Board { port: port.clone(), programmer: programmer.clone() };
                if board.can(Capability::Reset) {
                    board.reset()?;
                }
                Ok(board)
            }
        }
    }

    /// A fresh emulated board before another world, whose events are kept.
    pub fn before(&self, world: impl Into<Arc<Setup>>) -> Result<Self, RigError> {
        let VirtualRig { firmware, elf, options, .. } = self.emulated_rig();
        let options = Options { world: Some(world.into()), keep_trace: true, ..options.clone() };
        Ok(Self::Virtual(VirtualRig::start(firmware.clone(), elf.clone(), options)?))
    }

    /// What the rig can do. To an emulated board anything can be done; a real one has its link, and what its
    /// debug probe can do.
    #[must_use]
    pub fn can(&self, capability: Capability) -> bool {
        match self {
            Self::Virtual(rig) => match capability {
                Capability::SharedLine | Capability::CanBus => false,
                Capability::Usb => rig.options.usb,
                Capability::RawLine => !rig.options.usb,
                _ => true,
            },
            Self::Bus(rig) => match rig.shared {
                Shared::Line => capability == Capability::SharedLine,
                Shared::Can => capability == Capability::CanBus,
            },
            Self::Board { programmer, .. } => {
                programmer.as_ref().is_some_and(|programmer| match capability {
                    Capability::Reset => true,
                    Capability::Program => programmer.can_program(),
                    _ => false,
                })
            }
        }
    }

    /// Starts the board anew, and waits until it has. Needs [`Capability::Reset`].
    pub fn reset(&self) -> Result<(), RigError> {
        match self {
            Self::Virtual(rig) => rig.board.with(Machine::press_reset)?,
            Self::Bus(_) => panic!("{UNDECLARED}"),
            Self::Board { programmer, .. } => needed(programmer).reset()?,
        }
        Ok(self.wait(START_TIME.into())?)
    }

    /// Programs the firmware again, and starts the board anew. Needs [`Capability::Program`].
    pub fn program(&self) -> Result<(), RigError> {
        match self {
            Self::Virtual(rig) => rig.program(rig.firmware.clone())?,
            Self::Bus(_) => panic!("{UNDECLARED}"),
            Self::Board { programmer, .. } => needed(programmer).program()?,
        }
        Ok(self.wait(START_TIME.into())?)
    }

    /// A link to the board.
    pub fn link(&self) -> Result<Link, OpenError> {
        match self {
            Self::Virtual(rig) => {
                // A person is not faster than a board that starts.
                let _ = rig.board.run(START_TIME);
                Ok(rig.board.link()?)
            }
            Self::Bus(_) => panic!("{UNDECLARED}"),
            Self::Board { port, .. } => port::open(port),
        }
    }

    /// Lets time pass.
    pub fn wait(&self, time: Duration) -> Result<(), Halt> {
        match self {
            Self::Virtual(rig) => rig.board.run(Time::from(time)),
            Self::Bus(_) => panic!("{UNDECLARED}"),
            Self::Board { .. } => {
                std::thread::sleep(time);
                Ok(())
            }
        }
    }

    /// The emulated board, for what only that can do.
    ///
    /// # Panics
    /// If the board is real: a case says which capabilities it needs.
    #[must_use]
    pub fn emulated(&self) -> &VirtualBoard {
        &self.emulated_rig().board
    }

    /// The emulated board with its firmware and options.
    ///
    /// # Panics
    /// If the board is real, as [`Rig::emulated`].
    #[must_use]
    pub fn emulated_rig(&self) -> &VirtualRig {
        match self {
            Self::Virtual(rig) => rig,
            Self::Bus(_) | Self::Board { .. } => panic!("{UNDECLARED}"),
        }
    }

    /// What boards that share a line or a bus are made of.
    ///
    /// # Panics
    /// If the rig cannot put them there, as [`Rig::emulated`].
    #[must_use]
    pub fn bus(&self) -> &BusRig {
        match self {
            Self::Bus(rig) => rig,
            Self::Virtual(_) | Self::Board { .. } => panic!("{UNDECLARED}"),
        }
    }

    /// Sends bytes as they are.
    pub fn send_raw(&self, bytes: &[u8]) {
        self.emulated().send(Symbol::undamaged(bytes));
    }
}

const UNDECLARED: &str = "a case does what it did not say that it needs";

/// The probe of a rig of which a case said that it needs one.
fn needed(programmer: &Option<Programmer>) -> &Programmer {
    programmer.as_ref().expect(UNDECLARED)
}

/// How an emulated board runs, as its rig file says.
fn options(timing: Timing, baud: u64, seed: u64) -> Result<Options, String> {
    if !(1200..=10_000_000).contains(&baud) {
        return Err(format!("`baud` is {baud}, allowed are 1200 to 10000000"));
    }
    Ok(Options { timing, wire_baud: baud, seed, keep_trace: false, usb: false, world: None })
}

/// A path in a rig file counts from the file's folder.
fn beside(rig: &Path, path: &Path) -> PathBuf {
    rig.parent().unwrap_or(Path::new(".")).join(path)
}

fn without_probe(elf: &Path) -> String {
    format!(
        "there is firmware to program (`{}`) but no `probe` to do it: add `probe`, the ID that `dermatome devices` \
         shows, or leave the firmware away",
        elf.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::tests::{firmware, programmer};

    #[test]
    fn a_real_board_can_do_what_its_probe_can() {
        let can = |programmer| {
            let rig = Rig::Board { port: "/dev/ttyACM0".parse().unwrap(), programmer };
            [Capability::Reset, Capability::Program, Capability::PowerCut, Capability::Log]
                .map(|capability| rig.can(capability))
        };
        assert_eq!(can(None), [false; 4]);
        assert_eq!(can(Some(programmer(None))), [true, false, false, false]);
        assert_eq!(can(Some(programmer(Some(firmware())))), [true, true, false, false]);
    }
}
