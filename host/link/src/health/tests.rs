use super::*;

fn watch(flags: FrameFlags, health: &Health, vitals: Vitals, missed: u32) -> Watch {
    let at = |sequence: u32| FrameStamp { sequence, timestamp_us: u64::from(sequence) * 20_000, flags };
    let seen = |sequence| Seen { at: at(sequence), health: health.clone(), vitals, missed, drift: 0.01 };
    Watch { frames: (0..5).map(seen).collect(), events_lost: 0 }
}

fn healthy() -> (Health, Vitals) {
    let health = Health {
        contact_impedance: (0..8).map(|_| 30.0).collect(),
        reciprocity_error: Some(0.001),
        ..Health::default()
    };
    (health, Vitals { temperature: Some(35.0), load: 0.5, free_stack: 4096 })
}

#[test]
fn a_healthy_board_has_no_findings() {
    let (health, vitals) = healthy();
    let diagnosis =
        watch(FrameFlags::default(), &health, vitals, 0).diagnosis(false, Known::default()).unwrap();
    assert_eq!(diagnosis.findings, []);
    assert!((diagnosis.frames_per_second.unwrap() - 50.0).abs() < 1e-9);
    assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Ok));
    assert_eq!(Watch::default().diagnosis(false, Known::default()), None);
}

#[test]
fn contacts_whose_tests_were_clipped_come_from_a_watch_with_a_smaller_current() {
    let (mut health, vitals) = healthy();
    let smaller = watch(FrameFlags::default(), &health, vitals, 0);
    health.contact_impedance[2] = f32::INFINITY;
    let mut clipped = watch(FrameFlags::default(), &health, vitals, 0);
    let diagnosis = clipped.diagnosis(false, Known::default()).unwrap();
    assert!(clipped.has_clipped_tests() && diagnosis.findings.is_empty());
    assert!(!clipped.has_too_much_current(), "one contact alone is bad by itself");
    assert_eq!(diagnosis.electrodes[2].contact_impedance_ohm, None);
    clipped.take_contacts(&smaller);
    assert!(!clipped.has_clipped_tests());
    assert_eq!(
        clipped.diagnosis(false, Known::default()).unwrap().electrodes[2].contact_impedance_ohm,
        Some(30.0)
    );
}

#[test]
fn a_current_is_too_large_where_voltages_or_many_tests_clip_but_not_beside_a_bad_electrode() {
    let (healthy, vitals) = healthy();
    let is_too_large = |flags, health: &Health| watch(flags, health, vitals, 0).has_too_much_current();
    assert!(!is_too_large(FrameFlags::default(), &healthy));
    assert!(is_too_large(FrameFlags::SATURATED, &healthy));
    let clipped = |electrodes: std::ops::Range<usize>| {
        let mut health = healthy.clone();
        health.contact_impedance[electrodes].fill(f32::INFINITY);
        health
    };
    assert!(is_too_large(FrameFlags::default(), &clipped(0..4)));
    assert!(!is_too_large(FrameFlags::default(), &clipped(0..3)));
    let mut open = clipped(0..5);
    open.open.insert(1);
    assert!(!is_too_large(FrameFlags::default(), &open));
}

#[test]
fn contacts_below_zero_say_that_the_model_is_not_of_this_sheet_and_blame_no_electrode() {
    let (mut health, vitals) = healthy();
    health.contact_impedance = (0..8).map(|electrode| electrode as f32 - 9.0).collect();
    let mut watch = watch(FrameFlags::default(), &health, vitals, 0);
    let diagnosis = watch.diagnosis(false, Known::default()).unwrap();
    assert_eq!(diagnosis.findings.len(), 1, "{diagnosis:?}");
    assert_eq!(diagnosis.findings[0].what, "contact impedances come out below zero (-5.0 ohm)");
    assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Ok));
    let sheet = Known { sheet: true, ..Known::default() };
    assert_eq!(watch.diagnosis(false, sheet).unwrap().findings, []);
    watch.add_to_contacts(&[30.0; 8]);
    assert_eq!(watch.diagnosis(false, Known::default()).unwrap().findings, []);
}

#[test]
fn contacts_are_distrusted_where_wires_are_wrong() {
    let (mut health, vitals) = healthy();
    health.contact_impedance[4] = 200.0;
    let watch = watch(FrameFlags::MISSED, &health, vitals, 0);
    let diagnosis = |known| watch.diagnosis(false, known).unwrap();
    let unknown = diagnosis(Known::default());
    assert_eq!((unknown.findings.len(), unknown.electrodes[4].state), (2, State::High));
    let wires = diagnosis(Known { wires: true, ..Known::default() });
    assert_eq!((wires.findings.len(), wires.electrodes[4].state), (1, State::Unknown));
    let flag = diagnosis(Known { flags: FrameFlags::MISSED, ..Known::default() });
    assert_eq!((flag.findings.len(), flag.electrodes[4].state), (1, State::High));
}

#[test]
fn every_fault_has_a_finding() {
    let (mut health, vitals) = healthy();
    health.open.insert(2);
    health.shorted.insert(5);
    health.worse.insert(3);
    health.contact_impedance[1] = 80.0;
    health.contact_impedance[7] = 200.0;
    health.open.insert(6);
    let vitals = Vitals { load: 0.99, free_stack: 100, ..vitals };
    let all = FrameFlags::ALL.iter().fold(0, |bits, (flag, _)| bits | flag.0) & !FrameFlags::NO_CURRENT.0;
    let diagnosis = watch(FrameFlags(all), &health, vitals, 3).diagnosis(false, Known::default()).unwrap();
    let whats: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.what.as_str()).collect();
    for words in [
        "electrode 3 has no contact",
        "electrode 7 has no contact",
        "electrode 6 is connected to a neighbour",
        "electrode 4 touches worse than when the skin was tared",
        "electrode 8 touches worse than most",
        "saturated in 5 of 5 frames",
        "not reciprocal in 5 of 5 frames",
        "implausible in 5 of 5 frames",
        "samples missed in 5 of 5 frames",
        "chip too hot in 5 of 5 frames",
        "the board has lost samples 3 times since its start",
        "the CPU works 99 % of the time",
        "only 100 bytes of stack were never used",
    ] {
        assert!(whats.contains(&words), "{words} not in {whats:?}");
    }
    assert_eq!(whats.len(), 13);
}

#[test]
fn an_open_electrode_is_no_multiplexer() {
    let (mut health, vitals) = healthy();
    let whats = |health: &Health| {
        let diagnosis =
            watch(FrameFlags::NOT_RECIPROCAL, health, vitals, 0).diagnosis(false, Known::default()).unwrap();
        diagnosis.findings.into_iter().map(|finding| finding.what).collect::<Vec<_>>()
    };
    assert_eq!(whats(&health), ["not reciprocal in 5 of 5 frames"]);
    health.open.insert(2);
    assert_eq!(whats(&health), ["electrode 3 has no contact"]);
}

#[test]
fn without_current_no_electrode_is_blamed() {
    let (mut health, vitals) = healthy();
    health.contact_impedance[7] = 200.0;
    let diagnosis =
        watch(FrameFlags::NO_CURRENT, &health, vitals, 0).diagnosis(false, Known::default()).unwrap();
    assert!(diagnosis.electrodes.iter().all(|electrode| electrode.state == State::Unknown));
    assert_eq!(diagnosis.findings.len(), 1);
    assert_eq!(diagnosis.findings[0].what, "no current in 5 of 5 frames");
}

#[test]
fn a_simulated_board_has_no_vitals_to_judge() {
    let (health, _) = healthy();
    let diagnosis = watch(FrameFlags::default(), &health, Vitals::default(), 0)
        .diagnosis(true, Known::default())
        .unwrap();
    assert_eq!((diagnosis.findings.len(), diagnosis.free_stack_bytes), (0, None));
}
