//! `dermatome scope`.

use super::{
    BoardReport, JsonReport,
    board::open,
    interrupt,
    outputs::{Kind, Output},
    tare::patch_of,
};
use dermatome_link::{
    scope::{Trace, capture},
    silence_timeout,
};
use dermatome_patch::output::write_whole;
use dermatome_shared::stimulation::Step;
use dermatome_simulate::port::Port;
use dermatome_view::trace;
use serde::Serialize;

/// Show the samples behind one voltage, as the converter took them.
///
/// The scan measures the patch's steps, then a test of each electrode; each of them is a slot. The plot
/// shows the slot's samples with the part that settles, the limits of the converter, and the sine that
/// the lock-in finds.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome scope --port /dev/ttyACM0\n  \
    dermatome scope --port tcp:127.0.0.1:7000 --slot 12 --png slot12.png")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    /// Slot of the scan, from 0.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    slot: u16,
    /// Draw the plot into this file instead of on the terminal.
    #[arg(long, value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `scope` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    board: BoardReport<'a>,
    slot: u16,
    /// Of the patch; none in the test of an electrode.
    step: Option<[u8; 4]>,
    gain: u8,
    settling: usize,
    samples_per_period: usize,
    samples_per_second: u32,
    clipped: usize,
    fit: Option<Sine>,
    samples: &'a [u16],
}

/// The sine that the lock-in finds.
#[derive(Serialize)]
struct Sine {
    offset: f64,
    amplitude: f64,
    phase_degrees: f64,
    residual: f64,
}

impl<'a> Report<'a> {
    fn new(board: BoardReport<'a>, step: Option<Step>, trace: &'a Trace) -> Self {
        let fit = trace.fit().map(|fit| Sine {
            offset: fit.offset,
            amplitude: fit.amplitude,
            phase_degrees: fit.phase,
            residual: fit.residual,
        });
        Self {
            board,
            slot: trace.slot,
            step: step.map(Step::to_bytes),
            gain: trace.gain,
            settling: trace.settling,
            samples_per_period: trace.period,
            samples_per_second: trace.sample_rate,
            clipped: trace.clipped(),
            fit,
            samples: &trace.samples,
        }
    }
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let mut link = open(&args.port)?;
    let patch = patch_of(&mut link)?;
    let info = link.info()?;
    let trace = capture(&mut link, &info, args.slot, silence_timeout(&patch), || !interrupt::requested())?;
    let Some(trace) = trace else { return Ok(()) };
    let steps = link.steps()?;
    let step = steps.get(usize::from(args.slot)).copied();
    let what = match step {
        Some(step) => format!("step {}, {}", args.slot, electrodes(step)),
        None => format!("test of electrode {}", args.slot.saturating_sub(patch.steps) + 1),
    };
    let title = format!("slot {} of `{}`: {what}", args.slot, patch.skin);
    say!("{title}");
    trace::summary(&trace).iter().for_each(|line| say!("{line}"));
    match &args.png {
        Some(path) => {
            write_whole(path, &trace::png(&trace, &title)?)?;
            say!("picture   {}", path.display());
        }
        None => say!("{}", trace::text(&trace).trim_end()),
    }
    args.json.write(&Report::new(BoardReport::new(&link, &patch), step, &trace))
}

/// Electrodes of a step, from 1 as people count them.
fn electrodes(step: Step) -> String {
    let [plus, minus, sense_plus, sense_minus] = step.to_bytes().map(|electrode| u16::from(electrode) + 1);
    format!("current {minus} -> {plus}, voltage {sense_plus} - {sense_minus}")
}
