//! Wires that are faulty from the start, or become so and are mended.

use super::FINGER;
use crate::trust::{Bench, Figure, Options, Trial, TrustError, Voltages, figure::mean_95_largest, place_of};
use dermatome_simulate::Fault;
use nalgebra::distance;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

/// Frames before something breaks, while it is broken, and after it is mended.
const HEALTHY: usize = 20;
const BROKEN: usize = 40;
const MENDED: usize = 60;
/// Resistances added to a contact, each so many times what electrodes' tests read.
const WORSE: [f64; 4] = [0.1, 0.3, 1.0, 10.0];
/// Where fingers are set down on a skin that lacks electrodes.
const RADII: Range<f64> = 0.0..0.75;
/// A finger on such a skin, and electrodes that are off: one, and any two.
const OFF: [(usize, f64); 2] = [(1, 3.0), (2, 6.0)];

/// Frames with contacts, of all, in a phase of a scene.
#[derive(Default)]
struct Count {
    frames: usize,
    with_contact: usize,
}

impl Count {
    fn see(&mut self, trial: &mut Trial<'_>, voltages: &Voltages, frames: usize) {
        for _ in 0..frames {
            self.frames += 1;
            self.with_contact += usize::from(!trial.see(voltages).contacts().is_empty());
        }
    }

    fn figure(&self, what: String, snr_db: f64) -> Figure {
        Figure::share(what, snr_db, self.with_contact, self.frames).at_most(0.0, true)
    }
}

pub(super) fn run(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        for (words, faults) in kinds(bench) {
            figures.extend(untouched(bench, options, snr_db, &words, &faults)?);
        }
        for (off, asked) in OFF {
            figures.extend(touched(bench, options, snr_db, off, asked)?);
        }
    }
    Ok(figures)
}

/// Each fault at each electrode.
fn kinds(bench: &Bench) -> Vec<(String, Vec<Fault>)> {
    let count = bench.skin().electrodes.count;
    let each = |of: &dyn Fn(u8) -> Fault| (0..count).map(of).collect::<Vec<_>>();
    let ohms = bench.test_resistance();
    let worse = WORSE.map(|times| {
        (format!("a contact worse by {times} times its test"), each(&|e| Fault::Contact(e, times * ohms)))
    });
    let others = [
        ("an electrode off".to_owned(), each(&Fault::Open)),
        ("neighbours shorted".to_owned(), each(&|e| Fault::Shorted(e, (e + 1) % count))),
        ("electrodes apart shorted".to_owned(), each(&|e| Fault::Shorted(e, (e + count / 3) % count))),
    ];
    others.into_iter().chain(worse).collect()
}

/// Nobody touches a skin whose wires break and are mended, and one whose wires were broken before.
fn untouched(
    bench: &Bench,
    options: &Options,
    snr_db: f64,
    words: &str,
    faults: &[Fault],
) -> Result<[Figure; 3], TrustError> {
    let (mut arrives, mut goes, mut stays) = (Count::default(), Count::default(), Count::default());
    let healthy = bench.untouched();
    let mut trial = Trial::new(bench, snr_db, options.seed)?;
    for fault in faults {
        let broken = bench.wired(&bench.truth().conductivity(&[]), &[*fault]);
        trial.tare_untouched();
        stays.see(&mut trial, &healthy, HEALTHY);
        arrives.see(&mut trial, &broken, BROKEN);
        goes.see(&mut trial, &healthy, MENDED);
        trial.tare(&broken);
        stays.see(&mut trial, &broken, BROKEN);
    }
    Ok([
        arrives.figure(format!("contacts as {words}, untouched"), snr_db),
        goes.figure("  and when that is mended".to_owned(), snr_db),
        stays.figure("  and where it was so before the tare".to_owned(), snr_db),
    ])
}

/// One finger at a time on a skin some of whose electrodes were off from the start.
fn touched(
    bench: &Bench,
    options: &Options,
    snr_db: f64,
    off: usize,
    asked: f64,
) -> Result<[Figure; 2], TrustError> {
    let mut random = Pcg64Mcg::seed_from_u64(options.seed);
    let places = bench.places(options.seed).draw(options.presses, &RADII, 0.0)?;
    let mut trial = Trial::new(bench, snr_db, options.seed)?;
    let (mut errors, mut one) = (Vec::new(), 0);
    for place in &places {
        let electrodes = rand::seq::index::sample(&mut random, bench.skin().electrodes.count.into(), off);
        let faults: Vec<_> = electrodes.iter().map(|electrode| Fault::Open(electrode as u8)).collect();
        let wired = |conductivity: &[f64]| bench.wired(conductivity, &faults);
        trial.tare(&wired(&bench.truth().conductivity(&[])));
        let depth = random.random_range(0.5..1.0);
        let finger = bench.fingers(&[*place], FINGER, depth);
        let pressed = trial.press(&wired(&bench.truth().conductivity(&finger)));
        one += usize::from(pressed.are_exactly(1));
        errors.extend(
            pressed.last().first().map(|contact| 100.0 * distance(&place_of(contact), place) / bench.size()),
        );
    }
    let [mean, most_95, largest] = mean_95_largest(&errors);
    let words = format!("{off} of the electrodes off: a finger of 4 %, at 0.5 to 1");
    Ok([
        Figure::new(format!("{words}, is off by, mean"), "% size", snr_db, mean)
            .at_most(asked, true)
            .note(format!("95 %: {most_95:.2}, largest {largest:.2}")),
        Figure::share(format!("{words}, is one contact"), snr_db, one, places.len()),
    ])
}
