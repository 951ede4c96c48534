use super::*;
use dermatome_shared::{calibration::Calibration, hysteresis::PlayOperator};
use dermatome_simulate::{material::Material, rig::PlaceRig};

/// Frames while a load is held; the second half of them makes the reading.
const FRAMES: usize = 40;
/// Noise of a frame's strength, share of the material's full change.
const NOISE: f64 = 0.005;
/// Changes up to this share of the full change are averaged (half a contact threshold on a board).
const AVERAGED: f64 = 0.03;

fn stairs(shares: impl DoubleEndedIterator<Item = f64> + Clone) -> Vec<f64> {
    shares.clone().chain(shares.rev().skip(1)).collect()
}

fn even(top: f64, steps: usize) -> Vec<f64> {
    stairs((0..=steps).map(move |step| top * step as f64 / steps as f64))
}

/// A place under a loading machine, as a board sees it: noisy strengths of frames.
struct Loaded {
    material: Material,
    rig: PlaceRig,
}

impl Loaded {
    fn new(name: &str, seed: u64) -> Self {
        let material = Material::named(name).unwrap();
        Self { rig: PlaceRig::new(&material, NOISE, seed), material }
    }

    /// Strengths of all frames while this share of the range is held.
    fn hold(&mut self, share: f64, seconds: f64) -> Vec<f64> {
        self.rig.hold(share * self.material.range_kpa, seconds, FRAMES)
    }

    fn trial(&mut self, shares: &[f64], seconds: f64) -> (Trial, Vec<f64>) {
        let frames: Vec<f64> = shares.iter().flat_map(|&share| self.hold(share, seconds)).collect();
        (self.reading(shares, &frames), frames)
    }

    /// The mean of each load's later frames.
    fn reading(&self, shares: &[f64], frames: &[f64]) -> Trial {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let one = |(share, frames): (&f64, &[f64])| Reading {
            pressure_kpa: share * self.material.range_kpa,
            strength: mean(&frames[FRAMES / 2..]),
            deviation: 0.0,
            area_mm2: None,
            place: None,
        };
        trials(&shares.iter().zip(frames.chunks(FRAMES)).map(one).collect::<Vec<_>>()).remove(0)
    }
}

/// One loading cycle of one place, and the curve and plays from it.
fn identified(name: &str) -> (Trial, Calibration, Vec<PlayOperator>) {
    let up = [0.0, 0.02].into_iter().chain((1..=10).map(|n| 0.1 * f64::from(n)));
    let (trial, _) = Loaded::new(name, 500).trial(&stairs(up), 10.0);
    let calibration = Curve::of_loading(std::slice::from_ref(&trial)).calibration().unwrap();
    let plays = identify(&trial, &calibration);
    (trial, calibration, plays)
}

/// Mean over places and trials of the hysteresis, raw and compensated, per cent of the loop's own span.
fn judged(name: &str, shares: &[f64], seconds: f64) -> [f64; 3] {
    let (_, calibration, plays) = identified(name);
    let mut figures = Vec::new();
    for seed in 0..8 {
        let mut place = Loaded::new(name, seed);
        let (mut strengths, mut raw) = (Vec::new(), Vec::new());
        for _ in 0..3 {
            let (trial, frames) = place.trial(shares, seconds);
            raw.push(hysteresis(&trial));
            strengths.extend(frames);
            strengths.extend(place.hold(0.0, 1200.0));
        }
        let noise = AVERAGED * place.material.full_change;
        let pressures = compensated(&strengths, &plays, &calibration, noise);
        let trial_frames = (shares.len() + 1) * FRAMES;
        for (frames, raw) in pressures.chunks(trial_frames).zip(raw) {
            let frames = &frames[..shares.len() * FRAMES];
            figures.push([raw, hysteresis(&place.reading(shares, frames))]);
        }
    }
    let mean = |which: usize| figures.iter().map(|f| f[which]).sum::<f64>() / figures.len() as f64;
    [mean(0), mean(1), figures.iter().map(|f| f[1]).fold(0.0, f64::max)]
}

#[test]
fn hysteresis_of_loops_not_used_to_fit_it_is_at_most_8_percent() {
    for name in ["sample-1", "sample-2", "sample-3-single", "sample-3-dual"] {
        println!("{name}: plays {:?}", identified(name).2);
        for (what, shares, seconds, most) in [
            ("full, 10 s a load", even(1.0, 12), 10.0, 8.0),
            ("full, 3 s a load", even(1.0, 12), 3.0, 8.0),
            ("full, 30 s a load", even(1.0, 12), 30.0, 14.0),
            ("three quarters", even(0.75, 12), 10.0, 8.0),
            ("half", even(0.5, 12), 10.0, 8.0),
        ] {
            let [raw, mean, worst] = judged(name, &shares, seconds);
            println!("{name}, {what}: raw {raw:.1} %, compensated {mean:.1} %, worst of 24 {worst:.1} %");
            assert!(mean <= most, "{name}, {what}: {mean}");
            assert!(raw > 2.0 * mean, "{name}, {what}: {raw} {mean}");
        }
    }
}

/// Mean hysteresis of loops on other places, from their readings: plays, and networks that learnt from the
/// plays' cycle or from that and two smaller ones, per cent.
fn compared(name: &str, shares: &[f64]) -> [f64; 3] {
    let (full, calibration, plays) = identified(name);
    let smaller = [0.75, 0.5].map(|top| Loaded::new(name, 500).trial(&even(top, 10), 10.0).0);
    let one = Network::train(&[&full.readings], 1);
    let three = Network::train(&[&full.readings, &smaller[0].readings, &smaller[1].readings], 1);
    let mut sums = [0.0; 3];
    for seed in 0..8 {
        let (trial, _) = Loaded::new(name, seed).trial(shares, 10.0);
        let strengths: Vec<f64> = trial.readings.iter().map(|reading| reading.strength).collect();
        let ways = [
            compensated(&strengths, &plays, &calibration, 0.0),
            one.pressures(&strengths),
            three.pressures(&strengths),
        ];
        for (sum, pressures) in sums.iter_mut().zip(ways) {
            *sum += hysteresis(&trial.with_strengths(&pressures)) / 8.0;
        }
    }
    sums
}

#[test]
fn the_preisach_network_closes_loops_and_the_plays_close_them_better() {
    let mut wins = 0;
    for name in ["sample-1", "sample-2", "sample-3-single", "sample-3-dual"] {
        for (what, shares) in [("full", even(1.0, 12)), ("six tenths", even(0.6, 12))] {
            let [plays, one, three] = compared(name, &shares);
            println!(
                "{name}, {what}: plays {plays:.1} %, network of one cycle {one:.1} %, of three {three:.1} %"
            );
            wins += usize::from(plays < three);
        }
    }
    println!("the plays are better on {wins} of 8");
    assert!(wins >= 4);
}

fn reading(pressure_kpa: f64, strength: f64) -> Reading {
    Reading { pressure_kpa, strength, deviation: 0.0, area_mm2: None, place: None }
}

#[test]
fn figures_follow_the_definitions_of_the_thesis() {
    let one = [(0.0, 0.0), (1.0, 0.2), (2.0, 0.5), (1.0, 0.4), (0.0, 0.1)];
    let two = [(1.0, 0.25), (2.0, 0.5), (1.0, 0.35), (0.0, 0.1)];
    let readings: Vec<_> = one.into_iter().chain(two).map(|(p, s)| reading(p, s)).collect();
    let trials = trials(&readings);
    assert_eq!(trials.iter().map(|trial| trial.readings.len()).collect::<Vec<_>>(), [5, 5]);
    assert!((hysteresis(&trials[0]) - 100.0 * 0.2 / 0.5).abs() < 1e-9);
    // The second trial starts where the first one ended: 0.1 against 0, over the mean span.
    assert!((repeatability(&trials).unwrap() - 100.0 * 0.1 / 0.45).abs() < 1e-9);
    assert_eq!(repeatability(&trials[..1]), None);
}

#[test]
fn isotonic_regression_pools_what_falls() {
    assert_eq!(isotonic(&[1.0, 3.0, 2.0, 4.0], &[1.0; 4]), [1.0, 2.5, 2.5, 4.0]);
    assert_eq!(isotonic(&[4.0, 1.0], &[1.0, 2.0]), [2.0, 2.0]);
}

#[test]
fn a_curve_of_many_loads_keeps_the_16_points_that_shape_it() {
    let up: Vec<_> = (0..=40).map(|n| f64::from(n) / 40.0).map(|x| reading(60.0 * x, x.sqrt())).collect();
    let curve = Curve::of_loading(&trials(&up));
    let calibration = curve.calibration().unwrap();
    assert_eq!(calibration.points.len(), 16);
    for x in [0.05_f64, 0.3, 0.5, 0.77, 1.0] {
        let pressure = f64::from(calibration.pressure(x.sqrt() as f32).unwrap()) / 1e3;
        assert!((pressure - 60.0 * x).abs() < 0.6, "{x}: {pressure}");
    }
    let falling: Vec<_> = up.iter().map(|r| reading(r.pressure_kpa, -r.strength)).collect();
    assert_eq!(Curve::of_loading(&trials(&falling)).calibration(), None);
}

#[test]
fn bad_files_name_file_line_column_and_what_is_allowed() {
    let file = tempfile::NamedTempFile::new().unwrap();
    for (text, words) in [
        ("time_s,pressure_kpa\n0,0\n1,5\n1,0\n", "line 4, column `time_s` is 1"),
        ("time_s,pressure_kpa\n0,0\n1,-5\n2,0\n", "line 3, column `pressure_kpa` is -5"),
        ("time_s,pressure_kpa\n0,0\n1,x\n2,0\n", "line 3"),
        ("time_s,pressure_kpa\n0,0\n", "1 rows"),
        ("time,pressure_kpa\n0,0\n1,5\n2,0\n", "time_s"),
    ] {
        std::fs::write(file.path(), text).unwrap();
        let message = read_loads(file.path()).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
        assert!(
            message.contains(&*file.path().to_string_lossy()) && message.contains("allowed"),
            "{message}"
        );
    }
    std::fs::write(file.path(), "pressure_kpa,strength\n0,0\n5,nan\n0,0\n").unwrap();
    let message = read_readings(file.path()).unwrap_err().to_string();
    assert!(message.contains("line 3, column `strength` is \"nan\""), "{message}");
}

/// Loads up and down again, each held for a second.
fn holds() -> Vec<Hold> {
    let loads = [0.0, 2.0, 5.0, 10.0, 20.0, 10.0, 5.0, 2.0, 0.0];
    loads.iter().enumerate().map(|(n, &pressure_kpa)| Hold { time_s: n as f64, pressure_kpa }).collect()
}

/// Frames under [`holds`] at 50 a second, clear of the holds' limits: time, and the contact from 5 kPa on.
fn frames() -> Vec<(f64, Option<Strongest>)> {
    let loads = holds();
    let frame = |n: usize| {
        let time = 0.02 * n as f64 + 0.01;
        let kpa = loads[n / 50].pressure_kpa;
        let ripple = 1e-3 * f64::from(n as u32 % 7);
        let contact = Strongest { strength: 0.02 * kpa + ripple, area_mm2: 2000.0 + 10.0 * kpa, place: None };
        (time, (kpa >= 5.0).then_some(contact))
    };
    (0..450).map(frame).collect()
}

/// The lines of `stream` for these frames, on a board that has run for a while; weaker contacts follow the strongest.
fn lines(frames: &[(f64, Option<Strongest>)], header: bool) -> String {
    let mut text = String::new();
    if header {
        text += "sequence\ttime_s\tx_mm\ty_mm\tz_mm\tarea_mm2\tstrength\tpressure_kpa\tforce_n\n";
    }
    for (n, (time, contact)) in frames.iter().enumerate() {
        for (strongest, share) in contact.iter().flat_map(|contact| [(contact, 1.0), (contact, 0.4)]) {
            let (at, area, strength) = (1000.0 + time, strongest.area_mm2, share * strongest.strength);
            text += &format!("{}\t{at:.6}\t1.0\t2.0\t0.0\t{area:.2}\t{strength:.6}\t\t\n", 700 + n);
        }
    }
    text
}

fn paired(frames: &[(f64, Option<Strongest>)], loads: &[Hold]) -> Vec<Reading> {
    let mut pairing = Pairing::new(loads);
    for &(time, contact) in frames.iter().chain([&(1e3, None)]) {
        pairing.add(time, contact).unwrap();
    }
    pairing.into_readings()
}

#[test]
fn a_recording_gives_the_readings_that_the_board_would_have_given() {
    let (loads, frames) = (holds(), frames());
    let live = paired(&frames, &loads);
    assert_eq!(live.iter().filter(|reading| reading.area_mm2.is_some()).count(), 5);
    assert!((live[4].strength - 0.403).abs() < 1e-3 && (live[4].area_mm2.unwrap() - 2200.0).abs() < 1e-9);
    let file = tempfile::NamedTempFile::new().unwrap();
    for header in [false, true] {
        std::fs::write(file.path(), lines(&frames, header)).unwrap();
        let recording = Recording::read(file.path()).unwrap();
        // 2 kPa do not show, so that the first contact is not the first load: the start has to be told.
        let recorded = recording.readings(&loads, Some(1000.0)).unwrap();
        assert_eq!(recorded.len(), live.len());
        for (a, b) in recorded.iter().zip(&live) {
            assert!(
                (a.strength - b.strength).abs() < 1e-6 && a.pressure_kpa == b.pressure_kpa,
                "{a:?} {b:?}"
            );
            assert!((a.deviation - b.deviation).abs() < 1e-6 && a.area_mm2 == b.area_mm2, "{a:?} {b:?}");
        }
        let bold: Vec<Hold> = loads.iter().copied().filter(|load| load.pressure_kpa != 2.0).collect();
        for (a, b) in recording.readings(&bold, None).unwrap()[1..4].iter().zip(&live[2..5]) {
            // The first contact comes up to a frame after its load.
            assert!((a.strength - b.strength).abs() < 5e-4 && a.area_mm2 == b.area_mm2, "{a:?} {b:?}");
        }
    }
}

#[test]
fn recordings_that_are_cut_off_or_no_recordings_are_refused() {
    let (loads, frames) = (holds(), frames());
    let file = tempfile::NamedTempFile::new().unwrap();
    let read = |text: &str| {
        std::fs::write(file.path(), text).unwrap();
        let readings = Recording::read(file.path()).map_err(RecordingError::from);
        readings.and_then(|recording| recording.readings(&loads, Some(1000.0))).unwrap_err().to_string()
    };
    let good = lines(&frames, false);
    let first = good.lines().next().unwrap();
    let cut: String = good.lines().take(300).map(|line| format!("{line}\n")).collect();
    for (text, words) in [
        (cut.as_str(), ["last contact", "before the load of 10 kPa"]),
        (&format!("{good}{first}\n"), ["line 501", "column `sequence` is 800"]),
        (&good.replace("\t1002.030000\t", "\t1001.5\t"), ["line 3", "column `time_s` is 1001.5"]),
        (&good.replacen("\t2050.00\t", "\twide\t", 1), ["line 1", "column `area_mm2` is \"wide\""]),
        ("800\t1002.0\n801\t1002.1\n", ["line 1", "column `area_mm2` is \"\""]),
        ("frame\ttime_s\n1\t2\n", ["line 1", "column `sequence`"]),
        ("", ["0 frames", "two or more"]),
    ] {
        let message = read(text);
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
        assert!(
            message.contains(&*file.path().to_string_lossy()) && message.contains("allowed"),
            "{message}"
        );
    }
}

#[test]
fn the_load_share_is_the_indenters_area_over_the_regions_that_count_by_their_pressure() {
    let reading = |pressure_kpa, area_mm2| Reading { area_mm2, ..reading(pressure_kpa, 0.1) };
    let readings = [
        reading(0.0, Some(900.0)),
        reading(10.0, Some(2600.0)),
        reading(30.0, Some(1800.0)),
        reading(5.0, None),
    ];
    assert!((load_share(&readings, 400.0).unwrap() - 0.2).abs() < 1e-12);
    assert_eq!(load_share(&[reading(0.0, Some(900.0)), reading(5.0, None)], 400.0), None);
}

/// Way up and way back of loads from 2 to 10 kPa, by strength; `back` of it on the way back.
fn loop_of(back: fn(f64) -> f64) -> Vec<Reading> {
    let up = (0..=5).map(|n| reading(2.0 * f64::from(n), 0.05 * f64::from(n)));
    up.chain((0..5).rev().map(|n| reading(2.0 * f64::from(n), back(0.05 * f64::from(n))))).collect()
}

#[test]
fn a_trial_without_a_way_back_has_no_hysteresis_and_no_plays() {
    let loading = &loop_of(|x| x)[..6];
    for readings in [loading, &[loading, &[reading(0.0, 0.01)]].concat()] {
        let fit = Fit::new(readings, None, true).unwrap();
        assert_eq!((fit.hysteresis(), fit.compensation), (None, Compensation::NoWayBack));
        assert!(fit.play_operators.is_empty() && fit.loops == [Loop::default()]);
        assert_eq!((fit.calibration.points.len(), fit.calibration.load_share), (5, None));
    }
}

#[test]
fn plays_that_make_their_own_trial_no_better_are_not_stored() {
    // Strengths that are lower on the way back are no hysteresis that a memory of higher ones explains.
    let fit = Fit::new(&loop_of(|x| 0.6 * x), None, true).unwrap();
    assert!(matches!(fit.compensation, Compensation::Useless { trial: 0, .. }), "{:?}", fit.compensation);
    assert!(fit.play_operators.is_empty() && fit.loops[0].raw.unwrap() > 20.0);
    let fit = Fit::new(&loop_of(|x| 0.25 - 4.0 * (0.25 - x) * (0.25 - x)), None, true).unwrap();
    let [raw, after] = [fit.loops[0].raw, fit.loops[0].compensated].map(Option::unwrap);
    assert!(fit.compensation == Compensation::On { trial: 0 } && after < 0.5 * raw, "{raw} {after}");
    assert_eq!(Fit::new(&loop_of(|x| x), None, false).unwrap().compensation, Compensation::Off);
}

#[test]
fn readings_that_are_no_calibration_are_refused() {
    let of = |pairs: &[(f64, f64)]| pairs.iter().map(|&(p, s)| reading(p, s)).collect::<Vec<_>>();
    let equal = of(&[(5.0, 0.1); 3]);
    let two = of(&[(0.0, 0.0), (5.0, 0.1), (10.0, 0.2), (5.0, 0.12), (0.0, 0.0)]);
    let unloading = of(&[(10.0, 0.3), (8.0, 0.25), (5.0, 0.2), (2.0, 0.1), (0.0, 0.0)]);
    for (readings, found) in [(equal, 1), (two, 2), (unloading, 1), (of(&[(0.0, 0.1); 3]), 0)] {
        assert_eq!(Fit::new(&readings, None, true).unwrap_err(), FitError::Loads { found });
    }
    let level = of(&[(0.0, 0.1), (5.0, 0.1), (10.0, 0.1), (15.0, 0.1), (20.0, 0.1)]);
    let falling = of(&[(0.0, 0.3), (5.0, 0.2), (10.0, 0.1), (15.0, 0.05)]);
    // Whatever happens to press while the machine does not.
    let unrelated =
        of(&[(0.0, 0.2), (5.0, 0.4), (10.0, 0.1), (15.0, 0.5), (20.0, 0.15), (25.0, 0.45), (30.0, 0.2)]);
    for readings in [level, falling, unrelated] {
        let error = Fit::new(&readings, None, true).unwrap_err();
        assert!(matches!(error, FitError::NoRise { .. }), "{error}");
        assert!(error.to_string().contains("allowed: 3 points or more and 75 %"), "{error}");
    }
    let no_area = Fit::new(&loop_of(|x| x), Some(400.0), true).unwrap_err();
    assert_eq!(no_area, FitError::NoArea);
}
