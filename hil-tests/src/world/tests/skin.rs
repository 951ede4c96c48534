use super::{super::multiplexers::word, analogue, handle, ideal, skin, words};
use crate::{
    chip::{time::Time, world::World},
    world::{AnalogueWorld, Setup, WorldError, WorldHandle},
};
use dermatome::{
    material::Material,
    simulate::{Footprint, Load, Press, Script, script::Moment},
    skin::Skin,
};
use std::path::Path;

const PRESS: Press = Press::finger([0.03, -0.02], 0.02, 1.0);

/// Largest difference of `truth` from the forward model's own voltages, over the largest of those.
fn error_of(handle: &WorldHandle) -> f64 {
    let words = words();
    let full = words.iter().map(|&word| handle.skin_truth(word).norm()).fold(0.0, f64::max);
    let error = words.iter().map(|&word| (handle.truth(word) - handle.skin_truth(word)).norm());
    error.fold(0.0, f64::max) / full
}

#[test]
fn without_strays_the_board_sees_what_the_forward_model_says() {
    let handle = handle(ideal());
    assert!(error_of(&handle) < 1e-5, "{}", error_of(&handle));
    handle.press(&[PRESS]);
    assert!(error_of(&handle) < 1e-5, "{}", error_of(&handle));
    // With strays it does not.
    assert!(error_of(&super::handle(analogue())) > 1e-3);
}

#[test]
fn a_contact_with_capacitance_shows_a_phase() {
    let setup = Setup::new(skin(), ideal(), 5e-6, 1).unwrap();
    let handle = WorldHandle::new(setup);
    assert!(error_of(&handle) < 1e-5, "{}", error_of(&handle));
    // Current through both contacts: the driven electrodes sensed as well.
    let own = handle.truth(word([0, 1, 0, 1]));
    assert!(own.im < -0.01 * own.re, "{own}");
    handle.set_frequency(200e3).unwrap();
    let higher = handle.truth(word([0, 1, 0, 1]));
    assert!(higher.re < own.re, "{higher} at four times the frequency, {own} before");
    assert!(handle.set_frequency(f64::NAN).unwrap_err().to_string().contains("allowed"));
}

#[test]
fn drive_and_sense_pairs_may_be_exchanged() {
    let handle = handle(ideal());
    handle.press(&[PRESS]);
    for (there, back) in [([0, 1, 5, 6], [5, 6, 0, 1]), ([3, 4, 9, 10], [9, 10, 3, 4])] {
        let (there, back) = (handle.truth(word(there)), handle.truth(word(back)));
        assert!((there - back).norm() < 1e-5 * there.norm(), "{there} {back}");
    }
}

#[test]
fn drift_is_interpolated_without_a_step() {
    let handle = handle(ideal());
    handle.press(&[PRESS]);
    let mut world = AnalogueWorld::new(handle.clone());
    let before = handle.truth(words()[3]);
    handle.drift(-0.01);
    // 37 s at one per cent a minute.
    world.voltage(2, 16, Time::from_millis(37_000));
    assert!((handle.conditions().scale - (1.0 - 0.01 * 37.0 / 60.0)).abs() < 1e-4);
    assert!(error_of(&handle) < 1e-5, "{}", error_of(&handle));
    let after = handle.truth(words()[3]);
    assert!((after.norm() / before.norm() - 1.006).abs() < 1e-3, "{before} {after}");
}

#[test]
fn a_script_moves_fingers_in_virtual_time() {
    let handle = handle(ideal());
    let outline = dermatome::outline::Outline::disc(0.105);
    handle.run_script(Script::round(&outline));
    let mut world = AnalogueWorld::new(handle.clone());
    world.voltage(2, 16, Time::from_millis(10));
    let first = handle.conditions().touch.presses;
    world.voltage(2, 16, Time::from_millis(2010));
    let later = handle.conditions().touch.presses;
    assert_eq!((first.len(), later.len()), (1, 1));
    // A quarter of the way round.
    assert!(first[0].position[0] > 0.05 && later[0].position[1] > 0.05, "{first:?} {later:?}");
}

#[test]
fn a_sheet_of_a_material_answers_to_force_and_remembers_it_until_a_script_begins_anew() {
    let handle = handle(ideal());
    handle.set_material(Material::named("sample-1").unwrap());
    let outline = dermatome::outline::Outline::disc(0.105);
    let press = |time, force| Moment {
        time,
        press: Press::new(Footprint::Disc { radius: 0.02 }, [0.03, -0.02], Load::Force(force)),
    };
    // Lifted from two seconds on.
    let script = Script::new(vec![vec![press(0.0, 40.0), press(2.0, 40.0)], vec![press(3.0, 0.0)]], &outline);
    let script = script.unwrap();
    let words = words();
    let mut world = AnalogueWorld::new(handle.clone());
    let seen = |world: &mut AnalogueWorld, millis| {
        world.voltage(2, 16, Time::from_millis(millis));
        handle.truth(words[3]).norm()
    };
    let untouched = seen(&mut world, 10);
    handle.run_script(script.clone());
    let [pressed, lifted] = [1500, 2900].map(|millis| seen(&mut world, millis));
    assert!(pressed < 0.999 * untouched, "{pressed} under load, {untouched} without");
    assert!(lifted > pressed && lifted < 0.9999 * untouched, "{lifted} afterwards, {untouched} at first");
    handle.run_script(Script::nobody());
    let anew = seen(&mut world, 2950);
    assert!((anew / untouched - 1.0).abs() < 1e-3, "{anew} anew, {untouched} at first");
}

#[test]
fn more_electrodes_than_channels_are_refused() {
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/disc-210mm/skin.toml"));
    let text = text.unwrap().replace("count = 16", "count = 20");
    let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    let error = Setup::new(skin, ideal(), 0.0, 1).unwrap_err();
    assert!(matches!(error, WorldError::Electrodes { electrodes: 20, .. }), "{error}");
}
