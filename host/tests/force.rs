//! Newtons: what a skin that was calibrated with one indenter in one place says of other indenters elsewhere.
//!
//! Everything is simulated: `disc-210mm` of sample 2 (65 kPa), voltages of a true skin with noise at 60 dB, means of 20
//! frames, each press on a sheet that was never pressed before. Images, contacts and newtons are the board's own
//! arithmetic. `cargo test -p dermatome --test force -- --nocapture` prints the table of docs/materials.md.

use dermatome::{
    calibrate::{Fit, Reading},
    learn::judge::board_contacts,
    material::Material,
    model::Model,
    patch::write::with_calibration,
    quantize,
    simulate::{Footprint, Load, Press, Sheet, TrueSkin},
    skin::Skin,
};
use dermatome_shared::{
    contact::Contacts, hysteresis::Places, patch::PatchView, units::RelativeConductivity,
};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::path::Path;

/// Noise of one frame, share of the root mean square of the untouched voltages: 60 dB.
const NOISE: f64 = 1e-3;
/// Frames in a mean.
const FRAMES: f64 = 20.0;
/// Seconds for which a load is held.
const HOLD: f64 = 10.0;
/// Frames after which the board has averaged the noise out.
const SETTLED: usize = 60;
/// Of the presses that are judged, kPa.
const PRESSURES: [f64; 4] = [16.0, 32.0, 48.0, 65.0];
/// x of the places, m; y is two fifths of it.
const PLACES: [f64; 5] = [0.0, 0.025, 0.05, 0.07, 0.085];
/// The indenter of the calibration, cm^2.
const INDENTER: f64 = 4.0;

struct Rig {
    model: Model,
    patch: Vec<u8>,
    truth: TrueSkin,
    material: Material,
    untouched: Vec<f64>,
    random: Pcg64Mcg,
}

/// A square of this area in cm^2, `x` m from the middle of the skin.
fn square(area: f64, x: f64, kpa: f64) -> Press {
    let footprint = Footprint::Square { side: area.sqrt() * 1e-2 };
    Press { position: [x, 0.4 * x], angle: 0.0, footprint, load: Load::Pressure(kpa * 1e3) }
}

impl Rig {
    fn new() -> Self {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml");
        // A square centimetre in the middle stays below the file's threshold of 0.05.
        let skin = Skin { contact_threshold: 0.02, ..Skin::load(&file).unwrap().made().unwrap() };
        let model = Model::build(&skin, |_| ()).unwrap();
        let patch = quantize::patch(&skin, &model).unwrap();
        let truth = TrueSkin::new(&skin).unwrap();
        let untouched = truth.voltages(&truth.conductivity(&[]), &model.steps);
        let material = Material::named("sample-2").unwrap();
        Self { model, patch, truth, material, untouched, random: Pcg64Mcg::seed_from_u64(7) }
    }

    /// Contacts under a press on a sheet, after it was held.
    fn contacts(&mut self, sheet: &mut Sheet, press: &Press) -> Contacts {
        let conductivity = sheet.respond(&self.truth.pressure(std::slice::from_ref(press)), HOLD);
        let size = (self.untouched.iter().map(|v| v * v).sum::<f64>() / self.untouched.len() as f64).sqrt();
        let noise = NOISE * size / FRAMES.sqrt();
        let voltages = self.truth.voltages(&conductivity, &self.model.steps);
        let random = &mut self.random;
        let changes = voltages.iter().zip(&self.untouched).map(|(v, before)| {
            let unit: f64 = StandardNormal.sample(random);
            v - before + noise * unit
        });
        let data = self.model.difference_data(&changes.collect::<Vec<_>>(), &self.untouched);
        board_contacts(&PatchView::validate(&self.patch).unwrap(), &data)
    }

    /// Readings of three trials of 8 loads up and down in the middle.
    fn readings(&mut self) -> Vec<Reading> {
        let mut sheet = Sheet::new(&self.material, 1);
        let loads = (0..3).flat_map(|_| (0..=8).chain((0..8).rev()));
        let range = self.material.range_kpa;
        let read = |step: i32| {
            let pressure_kpa = range * f64::from(step) / 8.0;
            let contacts = self.contacts(&mut sheet, &square(INDENTER, 0.0, pressure_kpa));
            let contact = contacts.first();
            Reading {
                pressure_kpa,
                strength: contact.map_or(0.0, |contact| contact.strength.into()),
                deviation: 0.0,
                area_mm2: contact.map(|contact| f64::from(contact.area) * 1e6),
            }
        };
        loads.map(read).collect()
    }

    /// Force over true force of a first press; none if it does not show.
    fn ratio(&mut self, area: f64, x: f64, kpa: f64) -> Option<f64> {
        let press = square(area, x, kpa);
        let mut contacts = self.contacts(&mut Sheet::new(&self.material.clone(), 2), &press);
        let patch = PatchView::validate(&self.patch).unwrap();
        let mut places = Places::default();
        for _ in 0..SETTLED {
            let noise = RelativeConductivity(patch.header.contact_threshold.0 / 2);
            let operators = patch.play_operators();
            let strengths = places.compensate(&operators, &contacts, noise, || RelativeConductivity(0));
            patch.header.calibration.apply(&mut contacts, &strengths);
        }
        let true_newtons = kpa * 1e3 * area * 1e-4;
        contacts.first().map(|contact| f64::from(contact.force().expect("calibrated")) / true_newtons)
    }
}

/// Ratios of presses that show: by place, in the order of [`PRESSURES`].
fn table(rig: &mut Rig, area: f64) -> Vec<Vec<Option<f64>>> {
    let row = |x: f64, rig: &mut Rig| {
        let ratios: Vec<_> = PRESSURES.iter().map(|&kpa| rig.ratio(area, x, kpa)).collect();
        let words = |ratio: &Option<f64>| ratio.map_or("   -".to_owned(), |ratio| format!("{ratio:4.2}"));
        let words: Vec<_> = ratios.iter().map(words).collect();
        println!("{area:>2} cm2, {:>3.0} mm from the middle: {}", 1e3 * x.hypot(0.4 * x), words.join("  "));
        ratios
    };
    PLACES.map(|x| row(x, rig)).to_vec()
}

/// Least and largest of the ratios that there are.
fn spread(rows: &[Vec<Option<f64>>]) -> [f64; 2] {
    let seen = || rows.iter().flatten().flatten().copied();
    [seen().fold(f64::INFINITY, f64::min), seen().fold(0.0, f64::max)]
}

#[test]
fn a_skin_calibrated_with_four_square_centimetres_reads_the_force_of_one_four_and_nine() {
    let mut rig = Rig::new();
    let fit = Fit::new(&rig.readings(), Some(INDENTER * 100.0), true).unwrap();
    let share = fit.calibration.load_share.unwrap();
    println!(
        "load share {share:.3}, {} points, {} plays",
        fit.calibration.points.len(),
        fit.play_operators.len()
    );
    rig.patch = with_calibration(&rig.patch, &fit.stored()).unwrap();
    let [one, four, nine, large] = [1.0, 4.0, 9.0, 25.0].map(|area| table(&mut rig, area));
    let within = |rows: &[Vec<Option<f64>>], least: f64, most: f64| {
        let [lowest, highest] = spread(rows);
        assert!(lowest >= least && highest <= most, "{lowest:.2} to {highest:.2}: {rows:.2?}");
    };
    // Without the load share all of these would be 1 / 0.115 = 8.7 times as large.
    within(&four[..2], 0.85, 1.15);
    within(&one[..4], 0.4, 1.0);
    within(&four[..4], 0.8, 1.8);
    within(&nine[..4], 1.2, 2.3);
    // On the rim, and with indenters larger than the blur: not better than this.
    within(&[&one[4..], &four[4..], &nine[4..], &large].concat(), 0.9, 2.5);
    let unseen = |rows: &[Vec<Option<f64>>]| rows.iter().flatten().filter(|ratio| ratio.is_none()).count();
    assert!(unseen(&one) <= 2 && unseen(&[four, nine, large].concat()) == 0);
}
