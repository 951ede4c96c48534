use super::*;
use crate::{jacobian::step_counts, model::Model, skin::Skin};
use std::path::Path;

fn shipped(name: &str, image: Option<[&str; 2]>) -> Model {
    let file = format!("{}/../../models/{name}/skin.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap();
    let text = image.map_or(text.clone(), |[from, to]| text.replacen(from, to, 1));
    Model::build(&Skin::parse(Path::new(&file), &text).unwrap().made().unwrap(), |_| ()).unwrap()
}

fn frame_of<T>(model: &Model, look: impl FnOnce(&Frame<'_>) -> T) -> T {
    let square: f64 = model.voltages.iter().map(|v| v * v).sum();
    look(&Frame {
        jacobian: &model.jacobian,
        voltages: &model.measurements(),
        step_counts: &step_counts(&model.combination),
        step_size: (square / model.voltages.len() as f64).sqrt(),
    })
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2])
}

/// Median and least d' by the way from the axis, 0 to 0.5, to 0.8, to 1, of a finger of 4 % at full depth and 60 dB: from
/// detection_limit.py (kept with the project's design), which reads `dermatome export` and takes out nothing common.
#[test]
fn discriminability_is_that_of_another_program_before_what_is_common_is_taken_out() {
    let skins = [
        ("disc-210mm", 0.21, [[58.4, 42.1], [205.2, 96.1], [478.9, 332.2]]),
        ("hemisphere-120mm", 0.12, [[12.1, 10.5], [22.0, 14.3], [207.1, 33.8]]),
    ];
    for (name, size, expected) in skins {
        let model = shipped(name, None);
        let sought = Sought::finger(size, 60.0);
        let presses = model.pixels.presses(sought.radius);
        let without = frame_of(&model, |frame| whitened(&presses, frame, &deviations(frame, 60.0)));
        let found = model.detectability(&sought);
        let way = |place: &AtPlace| place.position.xy().coords.norm() / (size / 2.0);
        for (ring, [of_median, of_least]) in [0.0..0.5, 0.5..0.8, 0.8..1.01].iter().zip(expected) {
            let inside: Vec<_> =
                (0..found.places.len()).filter(|&n| ring.contains(&way(&found.places[n]))).collect();
            let mut values: Vec<_> =
                inside.iter().map(|&place| sought.strength * without.col(place).norm_l2()).collect();
            let median = median(&mut values);
            // They are printed with one decimal.
            assert!((median - of_median).abs() < 0.06, "{name} {ring:?}: median {median}");
            assert!((values[0] - of_least).abs() < 0.06, "{name} {ring:?}: least {}", values[0]);
            for place in inside {
                let all = sought.strength * without.col(place).norm_l2();
                assert!(
                    found.places[place].significance < all * (1.0 + 1e-12),
                    "{name}: {:?}",
                    found.places[place]
                );
            }
        }
    }
}

#[test]
fn a_change_of_all_voltages_is_not_detected_and_noise_counts_in_proportion() {
    let model = shipped("disc-210mm", None);
    let everywhere = Sought { radius: 1.0, strength: 1.0, snr_db: 60.0 };
    let finger = Sought::finger(0.21, 60.0);
    let [all, one, noisy] = [everywhere, finger, Sought { snr_db: 40.0, ..finger }]
        .map(|sought| model.detectability(&sought).places[400]);
    let presses = model.pixels.presses(everywhere.radius);
    let before =
        frame_of(&model, |frame| whitened(&presses, frame, &deviations(frame, 60.0))).col(400).norm_l2();
    // What is left is of the contact impedances, which do not change with the sheet.
    assert!(all.significance < 0.02 * before, "{before}, {all:?}");
    assert!((one.significance / noisy.significance - 10.0).abs() < 1e-9);
    assert!((noisy.position_deviation / one.position_deviation - 10.0).abs() < 1e-9);
    assert!((one.smallest / finger.strength - f64::from(LEVEL) / one.significance).abs() < 1e-12);
}

/// Derivatives are differences over pixels: smaller pixels must not change them much.
#[test]
fn deviations_of_places_do_not_follow_the_pixels() {
    let sought = Sought::finger(0.21, 60.0);
    let models = ["columns = 24", "columns = 48"]
        .map(|columns| shipped("disc-210mm", Some(["columns = 32", columns])));
    for at in [[0.0, 0.0], [0.05, 0.02], [-0.03, 0.07]] {
        let [coarse, fine] = [0, 1].map(|n| {
            let found = models[n].detectability(&sought);
            found.nearest(Point3::new(at[0], at[1], 0.0)).unwrap().position_deviation
        });
        println!("{at:?}: {:.3} and {:.3} mm", coarse * 1e3, fine * 1e3);
        assert!((coarse / fine - 1.0).abs() < 0.2, "{at:?}: {coarse} and {fine} m");
    }
}

#[test]
fn a_skin_is_deaf_where_noise_covers_the_press_and_nowhere_else() {
    let model = shipped("disc-210mm", None);
    assert_eq!(model.detectability(&Sought::finger(0.21, 60.0)).deaf(), None);
    let found = model.detectability(&Sought::finger(0.21, 40.0));
    let deaf = found.deaf().unwrap();
    assert!(deaf.worst.position.coords.norm() < 0.03, "{deaf:?}");
    let counted = found.places.iter().filter(|place| place.significance <= f64::from(LEVEL)).count();
    assert!((deaf.share - counted as f64 / found.places.len() as f64).abs() < 0.02, "{deaf:?}");
    assert!(found.median() > deaf.worst.significance);
    assert_eq!(Some(&deaf.worst), found.worst());
}
