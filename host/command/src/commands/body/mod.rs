//! `dermatome body`: a robot's skins over several computers.

#[cfg_attr(not(feature = "zenoh"), path = "without_zenoh.rs")]
mod merged;

use super::{JsonReport, drive::quantity, interrupt, network::Network};
use anyhow::ensure;
use dermatome_body::file::is_part_of_topic;
use dermatome_messages::dermatome::DriveRequest;
use dermatome_model::skin::quantity::{CURRENT, FREQUENCY, Quantity};
use dermatome_shared::drive::GAINS;
use std::time::{Duration, Instant};

/// Hear what all computers of a robot serve, as one body: contacts of every skin, and what presses on each link.
///
/// Each computer runs `dermatome serve --zenoh`. Skins of several computers on one link are summed up. A computer that is
/// gone takes its contacts along at once, and is heard again when it is back. Loss and latency are counted for each skin.
/// Times are by this computer's clock. Needs a program built with `--features zenoh`.
///
/// Prints the lines that `serve` prints (docs/serve.md); on a terminal a table instead.
///
/// With `--tare` or `--drive` it asks computers whose `serve` has `--zenoh-orders` for that, says what became of it, and ends:
/// with an error where a skin is not tared, or not driven like that.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome body
  dermatome body arm --zenoh-listen tcp/0.0.0.0:7447 | python3 controller.py
  dermatome body arm --tare palm --tare elbow
  dermatome body arm --tare all
  dermatome body arm --drive palm --frequency \"100 kHz\" --gain 8
  dermatome body arm --zenoh-config body.json5 --duration 60 --json report.json > contacts.jsonl")]
pub(super) struct Args {
    /// Name of the robot, of its body files; the only one that is there, unless it is given.
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Stop after so many seconds, instead of at Ctrl-C.
    #[arg(long, value_name = "SECONDS", value_parser = super::stream::seconds)]
    duration: Option<Duration>,
    /// Make a new reference of this skin, or of `all`; may be repeated. Where something presses, that is said, and it is made
    /// once the skin is free.
    #[arg(long, value_name = "PATCH", conflicts_with_all = ["drive", "duration", "json"])]
    tare: Vec<String>,
    /// Drive this skin, or `all`, otherwise; may be repeated. A new reference follows. Where something
    /// presses, that is said, and it waits until the skin is free.
    #[arg(long, value_name = "PATCH", requires = "Change", conflicts_with_all = ["duration", "json"])]
    drive: Vec<String>,
    #[command(flatten)]
    change: Change,
    #[command(flatten)]
    network: Network,
    #[command(flatten)]
    json: JsonReport,
}

/// How skins are to be driven; what their boards cannot do they say themselves.
#[derive(clap::Args)]
struct Change {
    /// Carrier frequency: "50 kHz", or a number in Hz.
    #[arg(long, value_name = "FREQUENCY", requires = "drive", allow_hyphen_values = true, value_parser = frequency)]
    frequency: Option<f32>,
    /// Current amplitude: "0.5 mA".
    #[arg(long, value_name = "AMPLITUDE", requires = "drive", allow_hyphen_values = true, value_parser = amplitude)]
    amplitude: Option<f32>,
    /// Frames a second: "50 Hz", or a number.
    #[arg(long, value_name = "RATE", requires = "drive", allow_hyphen_values = true, value_parser = frequency)]
    frame_rate: Option<f32>,
    /// Gain of the programmable amplifier: automatic, 1, 2, 4, 8, 16, 32 or 64.
    #[arg(long, value_name = "GAIN", requires = "drive", value_parser = gain)]
    gain: Option<u8>,
}

impl Change {
    fn request(&self) -> DriveRequest {
        let as_it_is = DriveRequest::AS_IT_IS;
        DriveRequest {
            frequency: self.frequency.unwrap_or(as_it_is.frequency),
            amplitude: self.amplitude.unwrap_or(as_it_is.amplitude),
            frame_rate: self.frame_rate.unwrap_or(as_it_is.frame_rate),
            gain: self.gain.unwrap_or(as_it_is.gain),
        }
    }
}

fn frequency(text: &str) -> Result<f32, &'static str> {
    positive(quantity(text, FREQUENCY)).ok_or("allowed: more than 0, in Hz, kHz or MHz")
}

fn amplitude(text: &str) -> Result<f32, &'static str> {
    // A number alone could be mA.
    let current = CURRENT.read(&Quantity::Text(text.to_owned())).map(|current| current as f32);
    positive(current).ok_or("allowed: more than 0, in A, mA or uA")
}

fn positive(value: Option<f32>) -> Option<f32> {
    value.filter(|value| *value > 0.0 && value.is_finite())
}

/// 0 for automatic.
fn gain(text: &str) -> Result<u8, &'static str> {
    let fixed = GAINS.into_iter().find(|gain| gain.to_string() == text);
    fixed.or((text == "automatic").then_some(0)).ok_or("allowed: automatic, 1, 2, 4, 8, 16, 32 or 64")
}

/// The skins that are named, none of which stands for all.
fn named(patches: &[String]) -> &[String] {
    if patches.iter().any(|patch| patch == "all") { &[] } else { patches }
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let name = args.name.as_deref();
    if let Some(name) = name {
        ensure!(
            is_part_of_topic(name),
            "`NAME` is {name:?}; allowed: 1 to 32 letters, digits and \"_\", no digit first"
        );
    }
    interrupt::install()?;
    let begun = Instant::now();
    let is_over =
        || interrupt::requested() || args.duration.is_some_and(|duration| begun.elapsed() >= duration);
    if !args.drive.is_empty() {
        let request = args.change.request();
        return merged::ask(name, named(&args.drive), Some(&request), &args.network, is_over);
    }
    if !args.tare.is_empty() {
        return merged::ask(name, named(&args.tare), None, &args.network, is_over);
    }
    merged::run(name, &args.network, &args.json, is_over)
}
