//! `dermatome trim`.

use super::{
    JsonReport,
    board::{advised, open},
    drive::quantity,
    interrupt,
    progress::counting,
};
use anyhow::bail;
use dermatome_link::{
    Link,
    trim::{self, Plug, TrimError},
};
use dermatome_model::skin::quantity::Kind;
use dermatome_shared::{
    acquire::trim::{CARRIERS, Factor, Trim},
    drive::GAINS,
    protocol::{FrameSource, Request},
    stimulation::Step,
};
use dermatome_simulate::port::Port;
use serde::Serialize;

const RESISTANCE: Kind = Kind::new(&[("ohm", 1.0), ("kohm", 1e3)]);

/// Measure a board's gains and phases on a plug of known resistors.
///
/// Put the plug of docs/hardware.md in the skin's place first. The board keeps the trim for good.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome trim --port /dev/ttyACM0\n  \
    dermatome trim --port COM5 --first \"2.21 ohm\" --second \"22.01 ohm\"")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS or can:BUS#ADDRESS.
    #[arg(long)]
    port: Port,
    /// Resistor between electrodes 1 and 2, 3 and 4, ...: "2.2 ohm", or a number in ohm.
    #[arg(long, value_name = "RESISTANCE", default_value = "2.2 ohm")]
    first: String,
    /// Resistor between electrodes 2 and 3, 4 and 5, ..., 16 and 1.
    #[arg(long, value_name = "RESISTANCE", default_value = "22 ohm")]
    second: String,
    /// Back to the front end as designed.
    #[arg(long, conflicts_with_all = ["first", "second"])]
    forget: bool,
    #[command(flatten)]
    json: JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    port: &'a str,
    carriers: Vec<Carrier>,
    /// Largest error that is left, relative.
    residual: Option<f32>,
}

/// Factors of one carrier.
#[derive(Serialize)]
struct Carrier {
    frequency_hz: f32,
    /// Real and imaginary part: `[gain]`.
    factors: [Factor; GAINS.len()],
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let plug = Plug::new(resistance("first", &args.first)?, resistance("second", &args.second)?);
    if plug.ohms()[0] == plug.ohms()[1] {
        bail!("`--first` and `--second` are both {}; allowed: two values that differ", args.first);
    }
    interrupt::install()?;
    let mut link = open(&args.port)?;
    if link.info()?.frame_source != FrameSource::Skin {
        bail!("the board at `{}` has no front end to trim: its frames are computed", link.port());
    }
    let (trim, residual) = if args.forget {
        link.request(&Request::Trim(Trim::NONE))?;
        say!("the board counts on its front end as designed");
        (Trim::NONE, None)
    } else {
        let bench = Bench { plug, steps: link.steps().map_err(advised)? };
        let (trim, residual) = bench.trim(&mut link)?;
        print(&trim);
        say!("kept on the board; measured again, the worst is {:.3} % off", 100.0 * residual);
        (trim, Some(residual))
    };
    say!("put the skin back and make a new reference: `dermatome tare`");
    args.json.write(&Report { port: link.port(), carriers: carriers(&trim), residual })
}

/// A plug, and how the board's patch measures it.
struct Bench {
    plug: Plug,
    steps: Vec<Step>,
}

impl Bench {
    /// Measures, lets the board keep what follows, and measures again: the trim, and the largest error that is left.
    fn trim(&self, link: &mut Link) -> anyhow::Result<(Trim, f32)> {
        let trim = self.measured(link, "measuring the plug")?;
        link.request(&Request::Trim(trim))?;
        let again = self.measured(link, "measuring it again")?;
        let both = again.0.as_flattened().iter().zip(trim.0.as_flattened());
        let errors =
            both.map(|(again, kept)| (again[0] - kept[0]).hypot(again[1] - kept[1]) / kept[0].hypot(kept[1]));
        Ok((trim, errors.fold(0.0, f32::max)))
    }

    fn measured(&self, link: &mut Link, words: &'static str) -> anyhow::Result<Trim> {
        let front_end = trim::front_end(link)?;
        let settings = trim::settings(&front_end, &self.plug);
        let bar = counting();
        bar.set_length(settings.len() as u64);
        bar.set_message(words);
        let measured = trim::measure(link, &settings, |done| {
            bar.set_position(done as u64);
            !interrupt::requested()
        });
        bar.finish_and_clear();
        if !matches!(measured, Err(TrimError::Link(_))) {
            // Whatever came of it, the drive is the patch's again.
            link.request(&Request::Drive(None))?;
        }
        Ok(trim::fit(&front_end, &self.plug, &self.steps, &measured?)?)
    }
}

fn resistance(option: &str, text: &str) -> anyhow::Result<f64> {
    match quantity(text, RESISTANCE) {
        Some(ohms) if (1.0..=1000.0).contains(&ohms) => Ok(ohms.into()),
        _ => {
            bail!(
                "`--{option}` is {text:?}; allowed: 1 ohm to 1 kohm, a number in ohm or text in ohm or kohm"
            )
        }
    }
}

fn carriers(trim: &Trim) -> Vec<Carrier> {
    let factors = CARRIERS.iter().zip(trim.0);
    factors.map(|(&frequency_hz, factors)| Carrier { frequency_hz, factors }).collect()
}

/// What the board does otherwise than its design: the inverse of the factors.
fn print(trim: &Trim) {
    say!("{:>9} {:>18} {:>20}", "carrier", "gain error/%", "phase error/deg");
    for (carrier, frequency) in CARRIERS.iter().enumerate() {
        let [sizes, phases] = trim::spread(trim, carrier);
        let gain = |size: f64| 100.0 * (1.0 / size - 1.0);
        say!(
            "{:>5} kHz {:>18} {:>20}",
            frequency / 1e3,
            format!("{:.2} to {:.2}", gain(*sizes.end()), gain(*sizes.start())),
            format!("{:.2} to {:.2}", -phases.end(), -phases.start())
        );
    }
}
