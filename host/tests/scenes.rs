//! Random contacts on the hemisphere, through the surface's model and the flattened one.

use dermatome::{
    link,
    model::Model,
    quantize,
    scenes::{Options, figures, play},
    simulate::{
        Noise, Press, Script, SimulatedSkin,
        board::{BoardOptions, Pace, SimulatedBoard},
    },
    skin::Skin,
};
use dermatome_shared::protocol::Selection;
use nalgebra::{Point3, Vector3};
use std::{path::Path, time::Duration};

fn shipped(file: &str) -> Skin {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/hemisphere-210mm/");
    Skin::load(&Path::new(folder).join(file)).unwrap().made().unwrap()
}

/// Away from the pole: more than 20 degrees of the sphere.
fn away(centre: &Point3<f64>) -> bool {
    centre.z < centre.coords.norm() * 0.94
}

/// A number that the environment gives, to play other scenes by hand.
fn given<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// Also prints the figures of as many scenes as `DERMATOME_SCENES` says, of the seed `DERMATOME_SEED`, at
/// `DERMATOME_SNR` dB and with fingers that change the conductivity by `DERMATOME_DEPTH`.
#[test]
fn contacts_are_counted_and_the_surface_places_them_twice_as_well_as_its_flattened_model() {
    let usual = Options { scenes: 60, ..Options::default() };
    let options = Options {
        scenes: given("DERMATOME_SCENES", usual.scenes),
        seed: given("DERMATOME_SEED", usual.seed),
        snr_db: given("DERMATOME_SNR", usual.snr_db),
        depth: given("DERMATOME_DEPTH", usual.depth),
        ..usual
    };
    let played = play(&shipped("skin.toml"), &shipped("formula.toml"), &options).unwrap();
    let figures = figures(&played, 0.105, away);
    eprintln!("{options:?}: {figures:#?}");
    if options.snr_db >= usual.snr_db && options.depth >= usual.depth {
        assert!(2.0 * figures.surface_error_mm <= figures.flattened_error_mm, "{figures:?}");
        assert!(figures.surface_error_mm < 4.0, "{figures:?}");
        assert!(figures.resolved_error_mm < 2.0, "{figures:?}");
        assert!(figures.resolved.right_of_all >= 0.98, "{figures:?}");
        assert!(figures.board.right_of_all >= 0.88, "{figures:?}");
    }
}

#[test]
fn a_board_with_a_curved_patch_tells_where_its_pixels_and_contacts_lie_in_space() {
    let skin = shipped("skin.toml");
    let model = Model::build(&skin, |_| ()).unwrap();
    let patch = quantize::patch(&skin, &model).unwrap();
    let press = Press::finger([0.06, 0.045], 0.0126, 1.0);
    let outline = skin.shape.from_above().unwrap();
    let script = Script::still(&[press], &outline).unwrap();
    let source = SimulatedSkin::new(&skin, script, Noise { snr_db: 60.0, seed: 1 }).unwrap();
    let options = BoardOptions { electrodes: 16, pace: Pace::Unpaced, ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = board.connect("sim:hemisphere").unwrap();
    link::upload(&mut link, &patch, |_| ()).unwrap();
    assert_eq!(link.surface().unwrap(), model.surface().unwrap());
    link::tare(&mut link, 20, Duration::from_secs(60)).unwrap();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() }).unwrap();
    let frame = stream.next(Duration::from_secs(20)).unwrap().expect("the board streams");
    let contacts = frame.contacts.unwrap();
    let [contact] = contacts.as_slice() else { panic!("{contacts:?}") };
    let found = Point3::from(contact.position.map(f64::from));
    let truth = Point3::new(0.06, 0.045, (0.105_f64.powi(2) - 0.075_f64.powi(2)).sqrt());
    assert!((found.coords.norm() / 0.105 - 1.0).abs() < 0.01, "{found}");
    assert!((found - truth).norm() < 0.012, "{found}");
    let normal = Vector3::from(contact.normal.map(f64::from));
    assert!(normal.dot(&truth.coords) / truth.coords.norm() > 0.98, "{normal}");
}
