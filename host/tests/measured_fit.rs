//! Contact impedances fitted to frames simulated on a skin whose impedances are known.

use dermatome::{
    model::Model,
    recorded::{
        fit::{Contact, Fit, fit},
        order::Arrangement,
    },
    sheet::ElectrodeModel,
    simulate::TrueSkin,
    skin::Skin,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::path::Path;

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");
const MEASURED: (&str, &str) = ("pattern = \"adjacent\"", "pattern = \"adjacent\"\ndriven = \"measured\"");
/// What the instrument makes of a volt at 1 A and 1 S.
const GAIN: f64 = 0.2;

fn skin(changes: &[(&str, &str)]) -> Skin {
    let change = |text: String, (from, to): &(&str, &str)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let text = changes.iter().fold(DISC.to_owned(), change);
    Skin::parse(Path::new("disc.toml"), &text).unwrap().made().unwrap()
}

/// Impedances between half and three times the skin file's.
fn factors() -> Vec<f64> {
    (0..16).map(|e| [1.0, 0.5, 2.0, 1.3, 3.0, 0.8, 1.6, 0.6][e % 8] * (1.0 + 0.02 * e as f64)).collect()
}

/// A frame of a skin with other impedances, from a mesh of its own, with white noise.
fn frame(skin: &Skin, factors: &[f64], snr_db: f64) -> Vec<Complex64> {
    let mut truth = skin.clone();
    let ElectrodeModel::Complete { contact_impedance, .. } = &mut truth.electrodes.model else { panic!() };
    contact_impedance.iter_mut().zip(factors).for_each(|(z, factor)| *z *= factor);
    let truth = TrueSkin::new(&truth).unwrap();
    let voltages = truth.voltages(&vec![1.0; truth.mesh().elements.len()], &skin.steps());
    let rms = (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt();
    let noise = Normal::new(0.0, rms * 10_f64.powf(-snr_db / 20.0)).unwrap();
    let mut random = rand_pcg::Pcg64::seed_from_u64(5);
    voltages.iter().map(|v| Complex64::from(GAIN * (v + noise.sample(&mut random)))).collect()
}

fn errors(fit: &Fit, factors: &[f64]) -> Vec<f64> {
    let error =
        |(contact, factor): (&Contact, &f64)| contact.contact_impedance / (contact.before * factor) - 1.0;
    fit.contacts.iter().zip(factors).map(error).collect()
}

/// Short edges at electrodes, so that impedances are not what the mesh lacks.
const FINE: (&str, &str) =
    ("edge_length = \"4.5 mm\"", "edge_length = \"4.5 mm\"\nelectrode_edge_length = \"0.5 mm\"");

#[test]
fn unequal_impedances_are_found_to_8_percent_where_driven_electrodes_are_measured_at_60_db() {
    let skin = skin(&[FINE, MEASURED]);
    let found = fit(&skin, &frame(&skin, &factors(), 60.0), &Arrangement::default()).unwrap();
    let errors = errors(&found, &factors());
    assert!(errors.iter().all(|error| error.abs() < 0.08), "{errors:.3?}");
    assert!((found.scale / GAIN - 1.0).abs() < 1e-3, "{}", found.scale);
    // 1 mA through the sheet is GAIN volts for each volt at 1 A and 1 S: here the frame is in volts.
    assert!((found.sheet_conductivity_s / (1e-3 / GAIN) - 1.0).abs() < 1e-3);
    // 60 dB are 0.1 %.
    assert!(found.residual_before_percent > 5.0, "{}", found.residual_before_percent);
    assert!((0.08..0.12).contains(&found.residual_percent), "{}", found.residual_percent);
    assert!(found.contacts.iter().all(|contact| contact.deviation_percent.unwrap() < 1.0));
}

#[test]
fn where_driven_electrodes_are_skipped_the_deviations_say_how_little_is_known() {
    let skin = skin(&[FINE]);
    let found = fit(&skin, &frame(&skin, &factors(), 60.0), &Arrangement::default()).unwrap();
    assert!(found.residual_percent < found.residual_before_percent / 2.0);
    for (contact, error) in found.contacts.iter().zip(errors(&found, &factors())) {
        let deviation = contact.deviation_percent.unwrap();
        assert!((5.0..15.0).contains(&deviation), "{deviation}");
        assert!(error.abs() < 3.0 * deviation / 100.0, "{error} of {deviation} %");
    }
    // Ten times the noise, and nothing is known.
    let noisy = fit(&skin, &frame(&skin, &factors(), 36.0), &Arrangement::default()).unwrap();
    assert!(noisy.contacts.iter().all(|contact| contact.deviation_percent.is_none_or(|d| d > 50.0)));
}

#[test]
fn the_skin_files_own_impedances_are_found_again_exactly_on_its_own_mesh() {
    let skin = skin(&[MEASURED]);
    let voltages = Model::build(&skin, |_| ()).unwrap().voltages;
    let frame: Vec<_> = voltages.iter().map(|v| Complex64::from(-GAIN * v)).collect();
    let found = fit(&skin, &frame, &Arrangement::default()).unwrap();
    assert!(found.residual_before_percent < 1e-9, "{found:?}");
    assert!(errors(&found, &[1.0; 16]).iter().all(|error| error.abs() < 1e-9));
}

#[test]
fn what_cannot_be_fitted_is_refused_with_the_reason() {
    let point = skin(&[
        ("model = \"complete\"", "model = \"point\""),
        ("width = \"11 mm\"", ""),
        ("contact_impedance = \"0.18 ohm m\"", ""),
    ]);
    let frame = vec![Complex64::ONE; 208];
    let refused =
        |skin: &Skin, frame: &[Complex64]| fit(skin, frame, &Arrangement::default()).unwrap_err().to_string();
    let words = refused(&point, &frame);
    assert!(words.contains("`electrodes.model` is \"point\"") && words.contains("\"complete\""), "{words}");
    let complete = skin(&[]);
    assert!(refused(&complete, &frame[..100]).contains("frames hold 100 measurements"));
    assert!(
        refused(&complete, &vec![Complex64::ZERO; 208]).starts_with("0 measurements are not zero, and 17")
    );
    let few = skin(&[("pattern = \"adjacent\"", "pattern = \"table\"\ntable = [[2, 1, 3, 4]]")]);
    assert!(refused(&few, &frame[..1]).starts_with("1 measurements are not zero"));
}
