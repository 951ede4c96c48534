//! `dermatome drive`.

use super::board::open;
use anyhow::{Context, bail};
use dermatome_model::skin::quantity::{self, Kind, Quantity};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::{Component, Drive, Gain},
    protocol::{Info, Refusal, Request},
    scan::Timing,
};
use dermatome_simulate::port::Port;
use serde::Serialize;

/// Show how a board drives its skin, or change it until the next patch or restart.
///
/// With no option, shows the drive in effect. A change begins the scan anew: the board makes its next
/// reference by itself from 20 steady frames, so leave the skin untouched.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome drive --port /dev/ttyACM0\n  \
    dermatome drive --port /dev/ttyACM0 --frequency \"100 kHz\" --amplitude 50%\n  \
    dermatome drive --port COM5 --gain 8 --settling 0.5 --integration 2\n  \
    dermatome drive --port COM5 --patch")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    #[command(flatten)]
    change: Change,
    /// Back to what the patch says.
    #[arg(long, conflicts_with = "Change")]
    patch: bool,
    #[command(flatten)]
    json: super::JsonReport,
}

#[derive(clap::Args)]
struct Change {
    /// Carrier frequency: "50 kHz", or a number in Hz.
    #[arg(long, value_name = "FREQUENCY", allow_hyphen_values = true)]
    frequency: Option<String>,
    /// Current amplitude: "0.5 mA", or a share of the board's full scale: "50%".
    #[arg(long, value_name = "AMPLITUDE", allow_hyphen_values = true)]
    amplitude: Option<String>,
    /// Gain of the programmable amplifier: automatic, 1, 2, 4, 8, 16, 32 or 64.
    #[arg(long, value_name = "GAIN")]
    gain: Option<String>,
    /// By how much the in-phase reference lags the current, degrees.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    phase: Option<f32>,
    /// Carrier periods between switching and measuring.
    #[arg(long, value_name = "PERIODS", allow_negative_numbers = true)]
    settling: Option<f32>,
    /// Carrier periods over which a voltage is measured.
    #[arg(long, value_name = "PERIODS", allow_negative_numbers = true)]
    integration: Option<i64>,
    /// Part of each voltage that goes into the image: real, imaginary or magnitude.
    #[arg(long, value_name = "PART")]
    component: Option<String>,
}

/// A drive as reports show it.
#[derive(Serialize)]
pub(super) struct DriveReport {
    frequency_hz: f32,
    amplitude_a: f32,
    amplitude_percent: Option<f32>,
    frame_rate: f32,
    phase_deg: f32,
    settling_periods: f32,
    integration_periods: u8,
    /// 0 for automatic.
    gain: u8,
    component: &'static str,
}

#[derive(Serialize)]
struct Report<'a> {
    port: &'a str,
    drive: DriveReport,
    of_patch: bool,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let mut link = open(&args.port)?;
    let info = link.info()?;
    let patch = info.patch.as_ref().ok_or(Refusal::NoPatch);
    let patch = patch.with_context(|| format!("nothing to drive at `{}`", link.port()))?.clone();
    let before = info.drive.unwrap_or(patch.drive);
    let wanted = args.change.apply(before, &info)?;
    if args.patch {
        link.request(&Request::Drive(None))?;
    } else if args.change.any() {
        link.request(&Request::Drive(Some(wanted)))?;
    }
    let drive = link.info()?.drive.unwrap_or(patch.drive);
    for (name, value) in rows(&drive, info.front_end.as_ref()) {
        say!("{name:<12} {value}");
    }
    let of_patch = drive == patch.drive;
    say!("{}", if of_patch { "as the patch says" } else { "until the next patch or restart" });
    let drive = DriveReport::new(&drive, info.front_end.as_ref());
    args.json.write(&Report { port: link.port(), drive, of_patch })
}

/// A value that is not allowed.
fn refuse<T>(option: &str, value: impl std::fmt::Display, allowed: &str) -> anyhow::Result<T> {
    bail!("`--{option}` is {}; allowed: {allowed}", shown(&value.to_string()))
}

/// A value as it is told: one that is empty can be seen.
fn shown(value: &str) -> &str {
    if value.is_empty() { "\"\"" } else { value }
}

impl Change {
    fn any(&self) -> bool {
        self.frequency.is_some()
            || self.amplitude.is_some()
            || self.gain.is_some()
            || self.phase.is_some()
            || self.settling.is_some()
            || self.integration.is_some()
            || self.component.is_some()
    }

    /// The drive with these changes, checked as far as a host can.
    fn apply(&self, mut drive: Drive, info: &Info) -> anyhow::Result<Drive> {
        if let Some(text) = &self.frequency {
            drive.frequency = frequency(text)?;
        }
        if let Some(text) = &self.amplitude {
            drive.amplitude = amplitude(text, info.front_end.as_ref())?;
        }
        if let Some(text) = &self.gain {
            drive.gain = gain(text)?;
        }
        if let Some(text) = &self.component {
            drive.component = component(text)?;
        }
        drive.phase = self.phase.unwrap_or(drive.phase);
        drive.settling = self.settling.unwrap_or(drive.settling);
        // What no board could know becomes a number that the check refuses.
        drive.integration = self.integration.map_or(drive.integration, |n| u8::try_from(n).unwrap_or(0));
        self.check(&drive)?;
        self.check_carrier(&drive, info.front_end.as_ref())?;
        Ok(drive)
    }

    /// The shared check, in the words of this command's options.
    fn check(&self, drive: &Drive) -> anyhow::Result<()> {
        let Err(words) = drive.check() else { return Ok(()) };
        let (field, allowed) = words.split_once(" (").unwrap_or((words, ""));
        let option = field.trim_start_matches("drive.").replace('_', "-");
        let value = match option.as_str() {
            "frequency" => self.frequency.clone().unwrap_or_else(|| drive.frequency.to_string()),
            "amplitude" => self.amplitude.clone().unwrap_or_else(|| drive.amplitude.to_string()),
            "phase" => drive.phase.to_string(),
            "settling" => drive.settling.to_string(),
            "integration" => self.integration.unwrap_or(drive.integration.into()).to_string(),
            "gain" => self.gain.clone().unwrap_or_default(),
            _ => drive.frame_rate.to_string(),
        };
        refuse(&option, value, allowed.trim_end_matches(')'))
    }

    /// Whether the board's samples fit the carrier, where it takes samples.
    fn check_carrier(&self, drive: &Drive, front_end: Option<&FrontEnd>) -> anyhow::Result<()> {
        let Some(front_end) = front_end else { return Ok(()) };
        let full = front_end.full_scale_current;
        if let Some(text) = self.amplitude.as_ref().filter(|_| !front_end.reaches(drive.amplitude)) {
            let allowed = format!("above 0 to {} mA, which is 100%", rounded(full * 1e3));
            return refuse("amplitude", text, &allowed);
        }
        let fits =
            |frequency: f32| Timing::new(&Drive { frequency, ..*drive }, front_end.sample_rate).is_some();
        match self.frequency.as_ref().filter(|_| !fits(drive.frequency)) {
            None => Ok(()),
            Some(text) => {
                let known = [12.5e3, 20e3, 50e3, 100e3, 200e3].into_iter().filter(|&f| fits(f));
                let known: Vec<_> = known.map(|f| format!("{} kHz", rounded(f * 1e-3))).collect();
                let rate = front_end.sample_rate;
                let allowed = format!(
                    "{}, or another of which a period is an even number of samples, 8 to 160, at {rate} a second",
                    known.join(", ")
                );
                refuse("frequency", text, &allowed)
            }
        }
    }
}

pub(super) fn quantity(text: &str, kind: Kind) -> Option<f32> {
    let quantity = text.trim().parse().map_or_else(|_| Quantity::Text(text.to_owned()), Quantity::Number);
    kind.read(&quantity).map(|value| value as f32)
}

fn frequency(text: &str) -> anyhow::Result<f32> {
    match quantity(text, quantity::FREQUENCY) {
        Some(frequency) => Ok(frequency),
        None => refuse("frequency", text, "a number in Hz, or text in Hz, kHz or MHz"),
    }
}

fn amplitude(text: &str, front_end: Option<&FrontEnd>) -> anyhow::Result<f32> {
    let allowed = "a current in A, mA or uA, or a share of full scale as in 50%";
    if let Some(percent) = text.trim().strip_suffix('%') {
        let Some(front_end) = front_end else {
            return refuse("amplitude", text, "a current: this board does not tell its full scale");
        };
        return match percent.trim().parse::<f32>() {
            Ok(percent) => Ok(percent / 100.0 * front_end.full_scale_current),
            Err(_) => refuse("amplitude", text, allowed),
        };
    }
    // A number alone could be mA or %.
    match quantity::CURRENT.read(&Quantity::Text(text.to_owned())) {
        Some(amplitude) => Ok(amplitude as f32),
        None => refuse("amplitude", text, allowed),
    }
}

fn gain(text: &str) -> anyhow::Result<Gain> {
    match (text, text.parse()) {
        ("automatic", _) => Ok(Gain::Automatic),
        (_, Ok(gain)) => Ok(Gain::Fixed(gain)),
        _ => refuse("gain", text, "automatic, 1, 2, 4, 8, 16, 32 or 64"),
    }
}

fn component(text: &str) -> anyhow::Result<Component> {
    match text {
        "real" => Ok(Component::Real),
        "imaginary" => Ok(Component::Imaginary),
        "magnitude" => Ok(Component::Magnitude),
        _ => refuse("component", text, "real, imaginary or magnitude"),
    }
}

fn name(component: Component) -> &'static str {
    match component {
        Component::Real => "real",
        Component::Imaginary => "imaginary",
        Component::Magnitude => "magnitude",
    }
}

/// Six digits, for numbers that single precision made crooked.
pub(super) fn rounded(value: f32) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(f64::NAN)
}

fn rows(drive: &Drive, front_end: Option<&FrontEnd>) -> Vec<(&'static str, String)> {
    let share = front_end.map_or(String::new(), |front_end| {
        format!(" ({} % of full scale)", rounded(100.0 * drive.amplitude / front_end.full_scale_current))
    });
    let gain = match drive.gain {
        Gain::Automatic => "automatic".to_owned(),
        Gain::Fixed(gain) => gain.to_string(),
    };
    vec![
        ("frequency", format!("{} kHz", rounded(drive.frequency * 1e-3))),
        ("amplitude", format!("{} mA{share}", rounded(drive.amplitude * 1e3))),
        ("frame rate", format!("{} a second at most", drive.frame_rate)),
        ("phase", format!("{} deg", drive.phase)),
        ("settling", format!("{} carrier periods", drive.settling)),
        ("integration", format!("{} carrier periods", drive.integration)),
        ("gain", gain),
        ("component", name(drive.component).to_owned()),
    ]
}

/// The drive in one line.
pub(super) fn line(drive: &Drive, front_end: Option<&FrontEnd>) -> String {
    let rows = rows(drive, front_end);
    let value = |wanted: &str| rows.iter().find(|(name, _)| *name == wanted).map_or("", |(_, value)| value);
    format!(
        "{}, {}, {} frames a second at most, gain {}, {} part",
        value("frequency"),
        value("amplitude"),
        drive.frame_rate,
        value("gain"),
        value("component")
    )
}

impl DriveReport {
    pub(super) fn new(drive: &Drive, front_end: Option<&FrontEnd>) -> Self {
        Self {
            frequency_hz: drive.frequency,
            amplitude_a: drive.amplitude,
            amplitude_percent: front_end.map(|front| 100.0 * drive.amplitude / front.full_scale_current),
            frame_rate: drive.frame_rate,
            phase_deg: drive.phase,
            settling_periods: drive.settling,
            integration_periods: drive.integration,
            gain: match drive.gain {
                Gain::Automatic => 0,
                Gain::Fixed(gain) => gain,
            },
            component: name(drive.component),
        }
    }
}
