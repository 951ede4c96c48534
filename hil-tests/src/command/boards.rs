//! `boards`: what tolerances do to voltages, and what `dermatome trim` leaves of it.
//!
//! Each board has parts drawn from their limits and the same firmware. Its voltages come from the circuit by frequencies
//! and from the firmware's own acquisition ([`dermatome_hil::world::readings`]); the plug's resistors are drawn as well.

use super::boot::{Firmware, boot};
use dermatome::{
    link::trim::{self, Measured, Plug, Setting},
    model::Model,
    quantize,
};
use dermatome_hil::world::{
    Response, Setup, WorldHandle,
    readings::{FULL_DRIVE_CODES, Readings, first_sample},
};
use dermatome_shared::{
    acquire::{
        FrontEnd,
        trim::{CARRIERS, Trim},
    },
    drive::{Drive, GAINS, Gain},
    patch::PatchView,
    stimulation::Step,
};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::{error::Error, process::ExitCode};

/// Clocks of the converter from a trigger to the sample: 2 of latency, give or take a half, and 12.5.
const SAMPLE_CLOCKS: [f64; 2] = [14.0, 15.0];
/// The plug, ohm, and the tolerances of its resistors.
const PLUG: [f64; 2] = [2.2, 22.0];
const PLUG_TOLERANCES: [f64; 2] = [1e-2, 1e-3];
/// Settling, s.
const SETTLING: f32 = 30e-6;
/// Frames of the plug that are averaged, as `dermatome trim` does.
const PLUG_FRAMES: usize = 16;
/// Largest error after the trim, of the converter's range, up to 100 kHz.
const LIMIT: f64 = 2e-3;

/// Options of `boards`.
#[derive(clap::Args)]
pub(super) struct Boards {
    #[command(flatten)]
    firmware: Firmware,
    /// How many boards.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    boards: u64,
    /// Number of the first board: the same number is the same board.
    #[arg(long, default_value_t = 1)]
    first: u64,
}

impl Boards {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let bench = Bench::new(&self.firmware)?;
        let numbers: Vec<u64> = (self.first..).take(self.boards as usize).collect();
        let halves = numbers.split_at(numbers.len() / 2);
        let errors: Result<Vec<_>, String> = std::thread::scope(|scope| {
            let other = scope.spawn(|| bench.all(halves.0));
            let own = bench.all(halves.1);
            let mut errors = other.join().map_err(|_| "a board crashed".to_owned())??;
            errors.extend(own?);
            Ok(errors)
        });
        Ok(report(&errors?))
    }
}

/// Worst channel's errors of a board.
#[derive(Default)]
struct Errors {
    /// `[carrier]`, before and after the trim; in phase and in quadrature, of the converter's range.
    carriers: [[[f64; 2]; 2]; CARRIERS.len()],
    /// In the current source's small range, at the patch's carrier, before and after the trim; in phase, of the largest
    /// voltage.
    small_range: [f64; 2],
}

fn report(errors: &[Errors]) -> ExitCode {
    say!("worst channel in phase (in quadrature), % of the converter's range, {} boards", errors.len());
    say!(
        "{:>9}  {:>21} {:>21}  {:>21} {:>21}",
        "carrier",
        "median as built",
        "worst",
        "median trimmed",
        "worst"
    );
    let mut is_met = true;
    for (carrier, frequency) in CARRIERS.iter().enumerate() {
        let cell = |trimmed: usize, rank: fn(usize) -> usize| {
            let [real, imaginary] = [0, 1].map(|part| {
                let mut values: Vec<f64> =
                    errors.iter().map(|errors| errors.carriers[carrier][trimmed][part]).collect();
                values.sort_by(f64::total_cmp);
                values[rank(values.len())]
            });
            (real, format!("{:.3} ({:.3})", 100.0 * real, 100.0 * imaginary))
        };
        let (median, last) = (|count| count / 2, |count| count - 1);
        let cells = [cell(0, median), cell(0, last), cell(1, median), cell(1, last)];
        is_met &= *frequency > 100e3 || cells[3].0 <= LIMIT;
        let [a, b, c, d] = cells.map(|(_, words)| words);
        say!("{:>5} kHz  {a:>21} {b:>21}  {c:>21} {d:>21}", frequency / 1e3);
    }
    let worst = [0, 1]
        .map(|trimmed| 100.0 * errors.iter().map(|errors| errors.small_range[trimmed]).fold(0.0, f64::max));
    say!(
        "in the small range, worst, % of the largest voltage: {:.3} as built, {:.3} trimmed",
        worst[0],
        worst[1]
    );
    if is_met {
        return ExitCode::SUCCESS;
    }
    say!("more than {} % is left up to 100 kHz", 100.0 * LIMIT);
    ExitCode::FAILURE
}

/// What all boards have in common.
struct Bench {
    setup: Setup,
    front_end: FrontEnd,
    drive: Drive,
    patch: Vec<u8>,
    steps: Vec<Step>,
}

impl Bench {
    fn new(firmware: &Firmware) -> Result<Self, Box<dyn Error>> {
        let (board, _) = boot(firmware, false, None)?;
        let setup = board.world().ok_or("the rig has no `[world]`")?.setup().clone();
        let front_end = board.link()?.info()?.front_end;
        let patch = quantize::patch(&setup.skin, &Model::build(&setup.skin, |_| ())?)?;
        let view = PatchView::open(&patch).map_err(|_| "the patch is damaged")?;
        let (steps, drive) = (view.steps().collect(), view.header.drive);
        Ok(Self { setup, front_end: front_end.ok_or("the board has no front end")?, drive, patch, steps })
    }

    fn patch(&self) -> PatchView<'_> {
        PatchView::open(&self.patch).expect("it was opened before")
    }

    fn all(&self, numbers: &[u64]) -> Result<Vec<Errors>, String> {
        numbers.iter().map(|&number| self.errors(number)).collect()
    }

    fn errors(&self, number: u64) -> Result<Errors, String> {
        let mut random = Pcg64::seed_from_u64(number ^ 0x0b0a_7d50);
        let world = WorldHandle::new(self.setup.drawn(number));
        let clocks = random.random_range(SAMPLE_CLOCKS[0]..SAMPLE_CLOCKS[1]);
        let mut board = Readings {
            world: &world,
            front_end: self.front_end,
            full_drive_codes: FULL_DRIVE_CODES,
            first_sample: first_sample(clocks),
        };
        let mut plug = *Plug::new(PLUG[0], PLUG[1]).ohms();
        for (ohms, tolerance) in plug.iter_mut().zip(PLUG_TOLERANCES.into_iter().cycle()) {
            *ohms *= random.random_range(1.0 - tolerance..1.0 + tolerance);
        }
        world.plug(Some(plug));
        let trim = self.trim(&board, number)?;
        world.plug(None);
        world.noise(0.0);
        let mut errors = Errors::default();
        for (trimmed, trim) in [Trim::NONE, trim].into_iter().enumerate() {
            board.front_end.trim = trim;
            for (carrier, &frequency) in CARRIERS.iter().enumerate() {
                let drive = Drive { frequency, gain: Gain::Automatic, ..self.drive };
                let full = self.setup.analogue.adc.full_scale / 2.0 / self.setup.analogue.amplifier.gain;
                let (worst, _) = self.worst(&board, drive).ok_or("a carrier is not possible")?;
                errors.carriers[carrier][trimmed] = worst.map(|part| part / full);
            }
            let small = self.front_end.small_range.ok_or("the board has no small range")?;
            let drive = Drive { amplitude: small.full_current, gain: Gain::Automatic, ..self.drive };
            let (worst, largest) = self.worst(&board, drive).ok_or("a carrier is not possible")?;
            errors.small_range[trimmed] = worst[0] / largest;
        }
        Ok(errors)
    }

    /// What `dermatome trim` would keep on the board.
    fn trim(&self, board: &Readings<'_>, seed: u64) -> Result<Trim, String> {
        let plug = Plug::new(PLUG[0], PLUG[1]);
        let mut known: Option<(usize, Vec<Response>)> = None;
        let measured = trim::settings(&board.front_end, &plug).into_iter().map(|setting| {
            let drive = self.drive_of(setting);
            if known.as_ref().is_none_or(|(carrier, _)| *carrier != setting.carrier) {
                board.world.set_frequency(drive.frequency.into()).map_err(|error| error.to_string())?;
                known = Some((setting.carrier, board.responses(&self.patch(), &drive)));
            }
            let responses = known.as_ref().map_or(&[][..], |(_, responses)| responses);
            let volts = board.volts(&self.patch(), &drive, responses, PLUG_FRAMES, seed);
            Ok(Measured { setting, volts: volts.ok_or("a carrier is not possible")? })
        });
        let measured: Vec<Measured> = measured.collect::<Result<_, String>>()?;
        trim::fit(&board.front_end, &plug, &self.steps, &measured).map_err(|error| error.to_string())
    }

    fn drive_of(&self, setting: Setting) -> Drive {
        let frequency = CARRIERS[setting.carrier];
        Drive {
            frequency,
            amplitude: setting.share as f32 * self.front_end.full_scale_current,
            gain: Gain::Fixed(GAINS[setting.gain]),
            settling: (SETTLING * frequency).max(0.25),
            ..self.drive
        }
    }

    /// Errors of the worst channel of the skin in phase and in quadrature, and its largest voltage, V.
    fn worst(&self, board: &Readings<'_>, drive: Drive) -> Option<([f64; 2], f64)> {
        board.world.set_frequency(drive.frequency.into()).ok()?;
        let responses = board.responses(&self.patch(), &drive);
        let volts = board.volts(&self.patch(), &drive, &responses, 1, 0)?;
        let words = self.steps.iter().map(|&step| dermatome_shared::scan::multiplexer_word(step));
        let truth = words.map(|word| board.world.truth(word) * f64::from(drive.amplitude));
        let (mut worst, mut largest) = ([0.0_f64; 2], 0.0_f64);
        for (truth, [i, q]) in truth.zip(volts) {
            let error = Complex64::new(i, q) - truth;
            worst = [worst[0].max(error.re.abs()), worst[1].max(error.im.abs())];
            largest = largest.max(truth.norm());
        }
        Some((worst, largest))
    }
}
