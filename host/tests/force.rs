//! Newtons: what a skin that was calibrated with one indenter in one place says of other indenters elsewhere.
//!
//! Everything is simulated: `disc-210mm` of sample 2 (65 kPa), codes of a true skin with noise at 60 dB, each press on a
//! sheet that was never pressed before. Contacts and newtons are the board's own arithmetic.
//! `cargo test -p dermatome --test force -- --nocapture` prints the table of docs/materials.md.

use dermatome::{
    calibrate::{Field, Fit, NoField, Reading, at_places},
    material::Material,
    patch::write::with_calibration,
    simulate::{
        Footprint, Load, Noise, Press, Rig as SkinRig, Sheet,
        rig::{Observer, SETTLED},
    },
    skin::Skin,
};
use dermatome_shared::contact::{Contact, Contacts};
use std::path::Path;

/// Signal-to-noise ratio of one frame, dB.
const SNR_DB: f64 = 60.0;
/// Frames of one press: some until all is found, and those that are averaged.
const FRAMES: u16 = SETTLED + 10;
/// Seconds for which a load is held.
const HOLD: f64 = 10.0;
/// Of the presses that are judged, kPa.
const PRESSURES: [f64; 4] = [16.0, 32.0, 48.0, 65.0];
/// x of the places, m; y is two fifths of it.
const PLACES: [f64; 5] = [0.0, 0.025, 0.05, 0.07, 0.085];
/// The indenter of the calibration, cm^2.
const INDENTER: f64 = 4.0;

struct Rig {
    board: Observer,
    skin: SkinRig,
    material: Material,
}

/// A square of this area in cm^2, `x` m from the middle of the skin.
fn square(area: f64, x: f64, kpa: f64) -> Press {
    let footprint = Footprint::Square { side: area.sqrt() * 1e-2 };
    Press { position: [x, 0.4 * x], angle: 0.0, footprint, load: Load::Pressure(kpa * 1e3) }
}

/// What the strongest contact reads under a pressure.
fn reading(contacts: &Contacts, pressure_kpa: f64, place: Option<[f64; 3]>) -> Reading {
    let contact = contacts.first();
    Reading {
        pressure_kpa,
        strength: contact.map_or(0.0, |contact| contact.strength.into()),
        deviation: 0.0,
        area_mm2: contact.map(|contact| f64::from(contact.area) * 1e6),
        place,
    }
}

impl Rig {
    fn new() -> Self {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml");
        let skin = Skin::load(&file).unwrap().made().unwrap();
        let board = Observer::new(&skin).unwrap();
        let rig = SkinRig::new(&skin, &board.patch(), Noise { snr_db: SNR_DB, seed: 7 }).unwrap();
        let mut rig = Self { board, skin: rig, material: Material::named("sample-2").unwrap() };
        rig.tare();
        rig
    }

    fn tare(&mut self) {
        let untouched = self.skin.truth().conductivity(&[]);
        self.board.tare(&self.skin.tare(&untouched));
    }

    /// The board with what was calibrated.
    fn calibrate(&mut self, fit: &Fit) {
        let patch = with_calibration(self.board.patch_bytes(), &fit.stored()).unwrap();
        self.board = Observer::with_patch(self.board.model().clone(), patch).unwrap();
        self.tare();
    }

    /// Contacts under a press on a sheet, after it was held.
    fn contacts(&mut self, sheet: &mut Sheet, press: &Press) -> Contacts {
        let conductivity = sheet.respond(&self.skin.truth().pressure(std::slice::from_ref(press)), HOLD);
        let phasors = self.skin.solve(&conductivity);
        let frames = self.skin.scans(&phasors, FRAMES);
        self.board.glance(&frames).contacts().clone()
    }

    /// Readings of three trials of 8 loads up and down in the middle.
    fn readings(&mut self) -> Vec<Reading> {
        let mut sheet = Sheet::new(&self.material, 1);
        let loads = (0..3).flat_map(|_| (0..=8).chain((0..8).rev()));
        let range = self.material.range_kpa;
        let read = |step: i32| {
            let pressure_kpa = range * f64::from(step) / 8.0;
            let contacts = self.contacts(&mut sheet, &square(INDENTER, 0.0, pressure_kpa));
            reading(&contacts, pressure_kpa, None)
        };
        loads.map(read).collect()
    }

    /// Readings of one press on each of some places over the inner nine tenths of the radius, on fresh sheets.
    fn readings_elsewhere(&mut self, count: usize) -> Vec<Reading> {
        let read = |number: usize| {
            let radius = 0.095 * ((number as f64 + 0.5) / count as f64).sqrt();
            let (sin, cos) = (2.4 * number as f64).sin_cos();
            let (x, y) = (radius * cos, radius * sin);
            let pressure_kpa = PRESSURES[number % PRESSURES.len()];
            let footprint = Footprint::Square { side: INDENTER.sqrt() * 1e-2 };
            let load = Load::Pressure(pressure_kpa * 1e3);
            let press = Press { position: [x, y], angle: 0.0, footprint, load };
            let contacts = self.contacts(&mut Sheet::new(&self.material.clone(), 2), &press);
            reading(&contacts, pressure_kpa, Some([x, y, 0.0]))
        };
        (0..count).map(read).collect()
    }

    /// Force of all contacts over the true force of a first press; none if it does not show.
    fn ratio(&mut self, area: f64, x: f64, kpa: f64) -> Option<f64> {
        let press = square(area, x, kpa);
        let contacts = self.contacts(&mut Sheet::new(&self.material.clone(), 2), &press);
        let force = |sum: f64, contact| sum + f64::from(Contact::force(contact).expect("calibrated"));
        let true_newtons = kpa * 1e3 * area * 1e-4;
        (!contacts.is_empty()).then(|| contacts.iter().fold(0.0, force) / true_newtons)
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
    rig.calibrate(&fit);
    let [one, four, nine, large] = [1.0, 4.0, 9.0, 25.0].map(|area| table(&mut rig, area));
    let within = |rows: &[Vec<Option<f64>>], least: f64, most: f64| {
        let [lowest, highest] = spread(rows);
        assert!(lowest >= least && highest <= most, "{lowest:.2} to {highest:.2}: {rows:.2?}");
    };
    // Wherever it presses, the indenter of the calibration reads right.
    within(&four, 0.75, 1.2);
    // The sheet's change bends with the pressure, and where nothing says how large an area is, it is taken for that of the
    // calibration.
    within(&one, 0.4, 1.0);
    // At the rim, which cuts it, a light press of it reads as little as this.
    within(&nine, 0.75, 2.0);
    // Larger than a board takes for one contact: not better than this.
    within(&large, 0.8, 3.1);
    let unseen = |rows: &[Vec<Option<f64>>]| rows.iter().flatten().filter(|ratio| ratio.is_none()).count();
    assert_eq!(unseen(&[one, four, nine, large].concat()), 0);
}

#[test]
fn where_an_indenter_of_one_size_presses_shows_no_field_of_gain() {
    let mut rig = Rig::new();
    let in_the_middle =
        rig.readings().into_iter().map(|reading| Reading { place: Some([0.0; 3]), ..reading });
    let readings: Vec<Reading> = in_the_middle.chain(rig.readings_elsewhere(20)).collect();
    let patch = rig.board.patch();
    let found = Field::fit(&at_places(&readings, &patch).unwrap(), &patch);
    // The errors of the table above are those of other sizes, and no field of places mends them.
    let [without, with] = match found {
        Err(NoField::NoBetter { without, with }) => [without, with],
        Ok(Field { left_out, .. }) => left_out.map(|deviation| 100.0 * deviation),
        Err(_) => panic!("{found:?}"),
    };
    println!("a place that is left out is {without:.1} % off, {with:.1} % with a field");
    assert!(with > 0.95 * without);
    assert!(without < 7.0);
}
