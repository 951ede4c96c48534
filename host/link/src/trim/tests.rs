use super::*;
use dermatome_shared::acquire::CurrentRange;
use dermatome_shared::stimulation::{Driven, pattern};

/// The reference board's, as designed.
const FRONT_END: FrontEnd = FrontEnd {
    sample_rate: 2_000_000,
    volts_per_code: 9.87e-9,
    full_scale_current: 1e-3,
    small_range: Some(CurrentRange { full_current: 28.73e-6, bandwidth: 163.3e3 }),
    gain_bandwidth: 13e6,
    largest_gain: 64,
    bandwidths: [844e3, 157e3, 10e6, 965e3],
    lead_corner: 575e3,
    waveform_rate: 1_000_000,
    lead: -1.24e-6,
    trim: Trim::NONE,
};

fn steps() -> Vec<Step> {
    pattern(16, 1, 1, Driven::Skipped).collect()
}

/// What a board needs at a setting: another at each carrier and gain.
fn need(setting: &Setting) -> Factor {
    let [carrier, gain] = [setting.carrier, setting.gain].map(|place| place as f32);
    [1.02 + 0.03 * gain - 0.01 * carrier, 0.02 * carrier * (gain - 2.0)]
}

/// A volt of the plug.
fn lagging(carrier: f32) -> [f32; 2] {
    [1.0, -std::f32::consts::TAU * carrier * PLUG_LAG as f32]
}

/// The voltages of such a board: its current is `odd(share)` times what was asked, and its amplifier adds some of
/// what both inputs have in common.
fn measured(odd: impl Fn(f64) -> f64) -> Vec<Measured> {
    measured_on(&Plug::new(10.0, 100.0), odd)
}

fn measured_on(plug: &Plug, odd: impl Fn(f64) -> f64) -> Vec<Measured> {
    let one = |setting: Setting| {
        let [real, imaginary] = need(&setting);
        let size = real * real + imaginary * imaginary;
        let carrier = CARRIERS[setting.carrier];
        let inverse = [real / size, -imaginary / size];
        let drive = Drive::new(carrier, setting.share as f32 * FRONT_END.full_scale_current, 1e3);
        let unit = FRONT_END.corrected(&drive, setting.gain, lagging(carrier), inverse);
        let current = odd(setting.share) * setting.share * 1e-3;
        let volts = steps().into_iter().map(|step| {
            let volts = current * plug.transfer(step);
            [volts * f64::from(unit[0]) + 0.02 * current, volts * f64::from(unit[1]) - 0.01 * current]
        });
        Measured { setting, volts: volts.collect() }
    };
    settings(&FRONT_END, plug).into_iter().map(one).collect()
}

#[test]
fn every_gain_has_room_and_is_compared_with_its_neighbour_at_the_same_current() {
    let settings = settings(&FRONT_END, &Plug::new(10.0, 100.0));
    assert_eq!(settings.len(), 45);
    let gains: Vec<usize> = settings[..9].iter().map(|setting| setting.gain).collect();
    assert_eq!(gains, [0, 1, 2, 2, 3, 4, 4, 5, 6]);
    let shares: Vec<f64> = settings[..9].iter().map(|setting| setting.share).collect();
    assert!(shares[..3] == [1.0; 3] && shares[3] == shares[5] && shares[8] < 0.12, "{shares:?}");
    for setting in &settings {
        let lsb = setting.share * 1e-3 * 11.364 / f64::from(FRONT_END.volts_per_code) / 4096.0;
        assert!(lsb * f64::from(GAINS[setting.gain]) < 1700.0, "{setting:?}");
    }
    let without_gains = FrontEnd { largest_gain: 1, ..FRONT_END };
    assert_eq!(super::settings(&without_gains, &Plug::new(10.0, 100.0)).len(), 5);
}

#[test]
fn the_factors_that_a_board_needs_are_found_whatever_its_dac_does_at_small_amplitudes() {
    let odd = |share: f64| if share == 1.0 { 1.0 } else { 1.0 + 0.004 / share.sqrt() };
    let measured = measured(odd);
    let trim = fit(&FRONT_END, &Plug::new(10.0, 100.0), &steps(), &measured).unwrap();
    for Measured { setting, .. } in &measured {
        let (found, need) = (trim.0[setting.carrier][setting.gain], need(setting));
        let error = (found[0] - need[0]).hypot(found[1] - need[1]);
        assert!(error < 1e-3, "{setting:?}: {found:?} for {need:?}");
    }
    // A board that is trimmed already needs nothing more.
    let trimmed = FrontEnd { trim, ..FRONT_END };
    let plug = Plug::new(10.0, 100.0);
    let perfect: Vec<Measured> = settings(&trimmed, &plug)
        .into_iter()
        .map(|setting| {
            let unit = lagging(CARRIERS[setting.carrier]).map(f64::from);
            let volts = steps()
                .into_iter()
                .map(|step| unit.map(|part| part * setting.share * 1e-3 * plug.transfer(step)));
            Measured { setting, volts: volts.collect() }
        })
        .collect();
    let again = fit(&trimmed, &plug, &steps(), &perfect).unwrap();
    for (one, other) in again.0.as_flattened().iter().zip(trim.0.as_flattened()) {
        assert!((one[0] - other[0]).hypot(one[1] - other[1]) < 1e-4, "{one:?} {other:?}");
    }
}

#[test]
fn a_plug_of_large_resistors_takes_the_small_range_for_large_gains() {
    let plug = Plug::new(100.0, 1000.0);
    let measured = measured_on(&plug, |_| 1.0);
    let is_small = |measured: &&Measured| measured.setting.share < 28e-3;
    assert_eq!(measured.iter().filter(is_small).count(), 15);
    let trim = fit(&FRONT_END, &plug, &steps(), &measured).unwrap();
    for Measured { setting, .. } in &measured {
        let (found, need) = (trim.0[setting.carrier][setting.gain], need(setting));
        let error = (found[0] - need[0]).hypot(found[1] - need[1]);
        assert!(error < 1e-3, "{setting:?}: {found:?} for {need:?}");
    }
}

#[test]
fn what_is_not_the_plug_is_told_with_the_electrodes_and_the_factor_that_nothing_needs_with_its_gain() {
    let plug = Plug::new(10.0, 100.0);
    let mut broken = measured(|_| 1.0);
    let place = steps().iter().position(|step| step.to_bytes() == [2, 1, 5, 6]).unwrap();
    broken[10].volts[place][0] *= 0.9;
    let error = fit(&FRONT_END, &plug, &steps(), &broken).unwrap_err();
    assert!(matches!(error, TrimError::Plug { at: (20e3, 2), sensed: [5, 6], .. }), "{error}");
    let words = error.to_string();
    assert!(words.starts_with("20 kHz, gain 2: between electrodes 6 and 7 the plug gives "), "{words}");
    let open: Vec<Measured> = measured(|_| 1.0)
        .into_iter()
        .map(|Measured { setting, volts }| Measured { setting, volts: vec![[0.0; 2]; volts.len()] })
        .collect();
    assert!(matches!(fit(&FRONT_END, &plug, &steps(), &open), Err(TrimError::Plug { .. })));
    let error = fit(&FRONT_END, &plug, &steps(), &measured(|_| 0.4)).unwrap_err().to_string();
    assert!(error.starts_with("12.5 kHz, gain 1: the board would need a factor of 2.5"), "{error}");
}
