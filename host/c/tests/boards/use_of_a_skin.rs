//! What a controller does with a skin.

use super::{
    handle::{Handle, name},
    paced_board,
    testbench::{board_with, crc, square_patch},
};
use dermatome_c::{
    codes::*,
    functions::{dermatome_descriptor, dermatome_place},
    records::{Contact, Drive, Options, Pose},
};
use std::mem::MaybeUninit;

#[test]
fn a_press_is_told_with_its_place_its_image_and_how_sure_it_is() {
    let patch = square_patch("sixteen", 16, 14, 100.0);
    let board = board_with(&patch);
    let handle = Handle::at(board.address());
    assert_eq!(name(&handle.identity().unwrap().board), "simulated");
    let skin = handle.skin().unwrap();
    assert_eq!((name(&skin.name).as_str(), skin.patch_crc), ("sixteen", crc(&patch)));
    assert_eq!((skin.electrodes, skin.steps, skin.pixels, skin.has_reference), (16, 208, 196, 0));
    assert_eq!((skin.drive.frame_rate, skin.drive.gain), (100.0, 0));
    let pixels = handle.pixels();
    // Pixel 1 of a grid of 10 mm from (-10, 10) mm on.
    assert!((pixels[1].centre[0] - 0.005).abs() < 1e-5 && (pixels[1].centre[1] - 0.005).abs() < 1e-5);
    assert!(
        pixels.len() == 196 && pixels[1].normal == [0.0, 0.0, 1.0] && (pixels[1].area - 1e-4).abs() < 1e-9
    );
    handle.tare(5).unwrap();
    handle.start(Options { images_every: 1, ..Options::default() }).unwrap();
    let mut image = [0.0; 196];
    for n in 0..100 {
        let frame = handle.frame().unwrap();
        assert_eq!((frame.sequence, frame.counts.frames_missing, frame.valid), (5 + n, 0, 1));
        assert_eq!(handle.image(&mut image), 196);
        let expected = 0.001 * n as f32;
        assert!((image[1] - expected).abs() < 4e-4, "{n}: {}", image[1]);
        if expected > 0.0105 {
            let contact = frame.contacts[0];
            assert_eq!((frame.contact_count, frame.contacts[1]), (1, Contact::default()));
            assert!(contact.id > 0 && contact.force.is_nan() && contact.pressure.is_nan());
            let away = (contact.position[0] - 0.005).hypot(contact.position[1] - 0.005);
            assert!(away < 1e-4 && contact.normal == [0.0, 0.0, 1.0], "{contact:?}");
            assert!((contact.peak - expected).abs() < 1e-3 && contact.area > 0.0, "{contact:?}");
        }
    }
    handle.stop().unwrap();
    assert_eq!(handle.poll(&mut MaybeUninit::uninit()), DERMATOME_STATE);
    handle.start_plainly().unwrap();
    let frame = handle.frame().unwrap();
    assert_eq!((frame.has_contacts, frame.has_image, handle.image(&mut image)), (1, 0, DERMATOME_STATE));
    assert_eq!(frame.counts.images_every, 0);
}

#[test]
fn a_contact_is_placed_on_the_link_that_the_skin_lies_on() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    // A quarter turn about x takes y to z, and z to -y.
    let pose = Pose { position: [1.0, 2.0, 3.0], orientation: [half, 0.0, 0.0, half] };
    let contact =
        Contact { position: [0.1, 0.02, 0.003], normal: [0.0, 0.6, 0.8], id: 4, ..Contact::default() };
    let place = |pose: &Pose| {
        let mut placed = contact;
        let at = &raw mut placed;
        // SAFETY: all of it lives here; the same record in and out is allowed.
        (unsafe { dermatome_place(pose, at, at, size_of::<Contact>()) }, placed)
    };
    let (code, placed) = place(&pose);
    let is_near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert_eq!((code, placed.id), (DERMATOME_OK, 4));
    assert!(is_near(placed.position, [1.1, 1.997, 3.02]) && is_near(placed.normal, [0.0, -0.8, 0.6]));
    for orientation in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0]] {
        assert_eq!(place(&Pose { orientation, ..pose }), (DERMATOME_ARGUMENT, contact));
    }
    assert_eq!(place(&Pose { position: [f64::INFINITY; 3], ..pose }), (DERMATOME_ARGUMENT, contact));
}

#[test]
fn a_drive_and_a_tare_are_asked_for_before_the_loop_and_in_it() {
    let board = paced_board(100.0);
    let handle = Handle::at(board.address());
    let drive = Drive { amplitude: 0.5e-3, gain: 4, ..handle.skin().unwrap().drive };
    handle.set_drive(&drive).unwrap();
    assert_eq!(handle.skin().unwrap().drive, drive);
    assert_eq!(handle.set_drive(&Drive { gain: 3, ..drive }), Err(DERMATOME_ARGUMENT));
    assert!(handle.error().contains("drive.gain"), "{}", handle.error());
    assert_eq!(handle.tare(0), Err(DERMATOME_REFUSED));
    assert_eq!(handle.ask_tare(5), Err(DERMATOME_STATE), "no stream");
    handle.start_plainly().unwrap();
    handle.frame().unwrap();
    assert_eq!(handle.answer(), DERMATOME_OK, "nothing was asked");
    let tares = handle.counts().tares;
    handle.ask_tare(5).unwrap();
    assert_eq!(handle.ask_tare(5), Err(DERMATOME_STATE), "one at a time");
    answered(&handle, DERMATOME_OK);
    while handle.counts().tares == tares {
        handle.frame().unwrap();
    }
    handle.ask_tare(0).unwrap();
    answered(&handle, DERMATOME_REFUSED);
    assert!(handle.error().contains("number of frames"), "{}", handle.error());
    handle.ask_drive(&drive).unwrap();
    answered(&handle, DERMATOME_OK);
    assert_eq!(handle.tare(5), Err(DERMATOME_STATE), "a stream is under way");
    // SAFETY: an open board.
    assert!(unsafe { dermatome_descriptor(handle.0) } > 2);
}

/// Polls until there is an answer, which is this.
fn answered(handle: &Handle, expected: i32) {
    let mut code = DERMATOME_PENDING;
    handle.poll_until(|_| {
        code = handle.answer();
        code != DERMATOME_PENDING
    });
    assert_eq!(code, expected, "{}", handle.error());
}
