//! `dermatome devices`.

use super::{
    board::open,
    drive::{self, DriveReport},
};
use anyhow::Context;
use dermatome_link::{
    self as link, Bus, Link, LinkError, LinkErrorKind,
    devices::{SerialPort, serial_ports},
    program::probe::DebugProbe,
};
use dermatome_shared::protocol::{FrameSource, Info, bus::ADDRESSES};
use dermatome_simulate::port::Port;
use serde::Serialize;
use std::{thread, time::Duration};

/// List serial ports and debug probes, or ask one board what it is and holds.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome devices\n  \
    dermatome devices --json devices.json\n  \
    dermatome devices --port /dev/ttyACM0\n  \
    dermatome devices --bus rs485:/dev/ttyUSB0\n  \
    dermatome devices --bus can:can0\n\n\
    Debug probes are listed by a program built with `--features probe`.")]
pub(super) struct Args {
    /// Board to ask, instead of a list: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or
    /// sim:SKIN.toml.
    #[arg(long)]
    port: Option<Port>,
    /// Bus whose boards to list, each with its address: rs485:LINE or can:BUS.
    #[arg(long, conflicts_with = "port")]
    bus: Option<Bus>,
    #[command(flatten)]
    json: super::JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    ports: &'a [SerialPort],
    probes: Option<&'a [DebugProbe]>,
}

#[derive(Serialize)]
struct BusReport<'a> {
    boards: &'a [Found],
}

/// A board on a bus.
#[derive(Serialize)]
struct Found {
    port: String,
    board: String,
    firmware: String,
    skin: Option<String>,
    /// Why it cannot be used.
    error: Option<String>,
}

impl Found {
    /// None where nobody answers; an error where the bus itself fails.
    fn at(port: &link::Port) -> Result<Option<Self>, LinkError> {
        let opened = link::open(port);
        let port = port.to_string();
        let found = |board: String, firmware: String, asked: Result<Info, LinkError>| {
            let (skin, error) = match asked {
                Ok(info) => (info.patch.map(|patch| patch.skin.to_string()), None),
                Err(error) => (None, Some(error.to_string())),
            };
            Ok(Some(Self { port, board, firmware, skin, error }))
        };
        match opened {
            Ok(mut link) => {
                let identity = link.identity().clone();
                found(identity.board.to_string(), identity.firmware.to_string(), link.info())
            }
            Err(error) => match error.kind {
                LinkErrorKind::NoAnswer { .. } => Ok(None),
                LinkErrorKind::Damaged { .. }
                | LinkErrorKind::ProtocolVersion { .. }
                | LinkErrorKind::Schema { .. }
                | LinkErrorKind::Refused(_)
                | LinkErrorKind::WrongReply { .. } => found(String::new(), String::new(), Err(error)),
                _ => Err(error),
            },
        }
    }

    fn line(&self) -> String {
        match (&self.error, &self.skin) {
            (Some(error), _) => format!("{}  {error}", self.port),
            (None, Some(skin)) => {
                format!("{}  {}, firmware {}, patch `{skin}`", self.port, self.board, self.firmware)
            }
            (None, None) => format!("{}  {}, firmware {}, no patch", self.port, self.board, self.firmware),
        }
    }
}

/// What a board is, holds and does.
#[derive(Serialize)]
struct BoardAnswer<'a> {
    port: &'a str,
    board: &'a str,
    firmware: &'a str,
    electrodes: u8,
    frame_source: &'static str,
    started_after: String,
    uptime_s: f64,
    patch_crc: Option<String>,
    skin: Option<&'a str>,
    drive: Option<DriveReport>,
    #[serde(skip)]
    drive_line: Option<String>,
    tared: bool,
    streaming: bool,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    match (&args.port, &args.bus) {
        (Some(port), _) => ask(args, port),
        (None, Some(bus)) => ask_all(args, bus),
        (None, None) => list(args),
    }
}

/// Who answers on a bus; all are asked at once, as those that are not there take their time.
fn ask_all(args: &Args, bus: &Bus) -> anyhow::Result<()> {
    let asked = thread::scope(|scope| {
        let one = |address| scope.spawn(move || Found::at(&link::Port::Bus(bus.clone(), address)));
        let all: Vec<_> = (0..ADDRESSES).map(one).collect();
        all.into_iter().map(|one| one.join().expect("asking does not panic")).collect::<Result<Vec<_>, _>>()
    });
    let asked = asked.context("`--bus`")?;
    let boards: Vec<_> = asked.into_iter().flatten().collect();
    for board in &boards {
        say!("{}", board.line());
    }
    if boards.is_empty() {
        say!("no board answers on `{bus}`");
    }
    args.json.write(&BusReport { boards: &boards })
}

fn list(args: &Args) -> anyhow::Result<()> {
    let ports = serial_ports()?;
    if ports.is_empty() {
        say!("no serial ports found");
    }
    for port in &ports {
        say!("{}", line(port));
    }
    let probes = probes();
    if probes.as_ref().is_some_and(Vec::is_empty) {
        say!("no debug probes found");
    }
    for probe in probes.iter().flatten() {
        say!("{}", probe_line(probe));
    }
    args.json.write(&Report { ports: &ports, probes: probes.as_deref() })
}

/// The debug probes, if this program can tell.
#[cfg(feature = "probe")]
fn probes() -> Option<Vec<DebugProbe>> {
    Some(dermatome_link::program::probe::attached::probes())
}

/// The debug probes, if this program can tell.
#[cfg(not(feature = "probe"))]
fn probes() -> Option<Vec<DebugProbe>> {
    None
}

fn probe_line(probe: &DebugProbe) -> String {
    let denied = if probe.accessible { "" } else { "  (no permission)" };
    format!("probe {}  {:04x}:{:04x}  {}{denied}", probe.id(), probe.vendor_id, probe.product_id, probe.name)
}

fn ask(args: &Args, port: &Port) -> anyhow::Result<()> {
    let mut link = open(port)?;
    let info = link.info()?;
    let answer = BoardAnswer::new(&link, &info);
    for line in answer.lines() {
        say!("{line}");
    }
    args.json.write(&answer)
}

impl<'a> BoardAnswer<'a> {
    fn new(link: &'a Link, info: &'a Info) -> Self {
        let (identity, patch) = (link.identity(), info.patch.as_ref());
        Self {
            port: link.port(),
            board: &identity.board,
            firmware: &identity.firmware,
            electrodes: info.electrodes,
            frame_source: source(info.frame_source),
            started_after: info.started_after.to_string(),
            uptime_s: Duration::from_millis(info.uptime_ms).as_secs_f64(),
            patch_crc: patch.map(|patch| super::patch_id(patch.crc)),
            skin: patch.map(|patch| patch.skin.as_str()),
            drive: info.drive.map(|drive| DriveReport::new(&drive, info.front_end.as_ref())),
            drive_line: info.drive.map(|drive| drive::line(&drive, info.front_end.as_ref())),
            tared: info.tared,
            streaming: info.streaming.any(),
        }
    }

    fn lines(&self) -> Vec<String> {
        let patch = match (self.skin, &self.patch_crc) {
            (Some(skin), Some(crc)) => {
                format!("`{skin}` (id {crc}), {}tared", if self.tared { "" } else { "not " })
            }
            _ => "none (send one with `dermatome flash`)".to_owned(),
        };
        let mut lines = vec![
            format!("{} at {}, firmware {}", self.board, self.port, self.firmware),
            format!("electrodes  {}", self.electrodes),
            format!("frames      {}", self.frame_source),
            format!("started     {:.1} s ago, after {}", self.uptime_s, self.started_after),
            format!("patch       {patch}"),
        ];
        lines.extend(self.drive_line.iter().map(|line| format!("drive       {line}")));
        lines
    }
}

/// Where frames come from, in words.
fn source(source: FrameSource) -> &'static str {
    match source {
        FrameSource::Skin => "measured on its skin",
        FrameSource::Simulated => "computed from a simulated skin",
        FrameSource::Synthetic => "synthetic: numbers without meaning, for this board cannot measure yet",
    }
}

fn line(port: &SerialPort) -> String {
    let mut line = port.port.clone();
    if let (Some(vendor), Some(product)) = (port.vendor_id, port.product_id) {
        line += &format!("  {vendor:04x}:{product:04x}");
    }
    for text in [&port.manufacturer, &port.product].into_iter().flatten() {
        line += &format!("  {text}");
    }
    line + if port.likely_board { "  <- likely a board" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_likely_board_stands_out() {
        let mut port = SerialPort {
            port: "COM5".to_owned(),
            likely_board: true,
            vendor_id: Some(0x0483),
            product_id: Some(0x374e),
            manufacturer: None,
            product: Some("STLINK-V3".to_owned()),
            serial_number: None,
        };
        assert_eq!(line(&port), "COM5  0483:374e  STLINK-V3  <- likely a board");
        port = SerialPort { likely_board: false, vendor_id: None, product: None, ..port };
        assert_eq!(line(&port), "COM5");
    }

    #[test]
    fn a_probe_shows_the_id_that_chooses_it() {
        let probe = DebugProbe {
            name: "STLink V3".to_owned(),
            vendor_id: 0x0483,
            product_id: 0x374e,
            serial_number: Some("0042".to_owned()),
            accessible: false,
        };
        assert_eq!(probe_line(&probe), "probe 0042  0483:374e  STLink V3  (no permission)");
    }
}
