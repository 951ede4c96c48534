//! `dermatome body`: a robot's skins over several computers.

#[cfg_attr(not(feature = "zenoh"), path = "without_zenoh.rs")]
mod merged;

use super::{JsonReport, interrupt, network::Network};
use anyhow::ensure;
use dermatome_body::file::is_part_of_topic;
use std::time::{Duration, Instant};

/// Hear what all computers of a robot serve, as one body: contacts of every skin, and what presses on each link.
///
/// Each computer runs `dermatome serve --zenoh`. Skins of several computers on one link are summed up. A computer that is
/// gone takes its contacts along at once, and is heard again when it is back. Loss and latency are counted for each skin.
/// Times are by this computer's clock. Needs a program built with `--features zenoh`.
///
/// Prints the lines that `serve` prints (docs/serve.md); on a terminal a table instead.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome body
  dermatome body arm --zenoh-listen tcp/0.0.0.0:7447 | python3 controller.py
  dermatome body arm --zenoh-config body.json5 --duration 60 --json report.json > contacts.jsonl")]
pub(super) struct Args {
    /// Name of the robot, of its body files; the only one that is there, unless it is given.
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Stop after so many seconds, instead of at Ctrl-C.
    #[arg(long, value_name = "SECONDS", value_parser = super::stream::seconds)]
    duration: Option<Duration>,
    #[command(flatten)]
    network: Network,
    #[command(flatten)]
    json: JsonReport,
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
    merged::run(name, &args.network, &args.json, is_over)
}
