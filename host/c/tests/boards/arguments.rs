//! Arguments that make no sense, and a fault of the library.

use super::{
    handle::Handle,
    testbench::{board_with, small_patch},
};
use dermatome_c::{
    codes::*,
    failure::Failure,
    functions::*,
    memory::with,
    records::{Contact, Counts, Drive, Frame, Identity, Options, Pixel, Pose, Skin},
};
use std::{
    ffi::{CStr, c_char},
    mem::MaybeUninit,
    ptr::{null, null_mut},
};

#[test]
fn null_is_refused_wherever_something_must_be() {
    let board = board_with(&small_patch("small", 50.0));
    let handle = Handle::at(board.address());
    // SAFETY: null is what is tried.
    let before = unsafe {
        [
            dermatome_get_skin(handle.0, null_mut(), size_of::<Skin>()),
            dermatome_get_pixels(handle.0, null_mut(), 4 * size_of::<Pixel>()),
        ]
    };
    assert_eq!(before, [DERMATOME_ARGUMENT; 2]);
    handle.start(Options { images_every: 3, ..Options::default() }).unwrap();
    while handle.frame().unwrap().has_image == 0 {}
    assert_eq!(handle.counts().images_every, 3);
    let (open, mut text, mut no_board) = (handle.0, [1; 8], null_mut());
    let (mut frame, mut contact) = (MaybeUninit::uninit(), Contact::default());
    let pose = Pose { position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] };
    let (at, length) = (&raw mut contact, size_of::<Contact>());
    // SAFETY: null is what is tried; all else lives here.
    let codes = unsafe {
        dermatome_close(null_mut());
        [
            dermatome_open(null(), &raw mut no_board, text.as_mut_ptr(), text.len()),
            dermatome_open(c"tcp:127.0.0.1:1".as_ptr(), null_mut(), text.as_mut_ptr(), text.len()),
            dermatome_error(null(), text.as_mut_ptr(), text.len()),
            dermatome_error(open, null_mut(), 10),
            dermatome_error(open, text.as_mut_ptr(), 0),
            dermatome_flag_words(1, null_mut(), 10),
            dermatome_get_identity(null_mut(), null_mut(), size_of::<Identity>()),
            dermatome_get_identity(open, null_mut(), size_of::<Identity>()),
            dermatome_get_skin(null_mut(), null_mut(), size_of::<Skin>()),
            dermatome_get_pixels(null_mut(), null_mut(), size_of::<Pixel>()),
            dermatome_get_counts(open, null_mut(), size_of::<Counts>()),
            dermatome_tare(null_mut(), 1),
            dermatome_set_drive(null_mut(), null(), size_of::<Drive>()),
            dermatome_start(null_mut(), null(), 0),
            dermatome_poll(null_mut(), frame.as_mut_ptr(), size_of::<Frame>()),
            dermatome_poll(open, null_mut(), size_of::<Frame>()),
            dermatome_wait(open, null_mut(), size_of::<Frame>(), 1),
            dermatome_image(null_mut(), null_mut(), 4),
            dermatome_descriptor(null_mut()),
            dermatome_ask_tare(null_mut(), 1),
            dermatome_ask_drive(null_mut(), null(), 0),
            dermatome_answer(null_mut()),
            dermatome_stop(null_mut()),
            dermatome_image(open, null_mut(), 16),
            dermatome_place(null(), at, at, length),
            dermatome_place(&raw const pose, null(), at, length),
            dermatome_place(&raw const pose, at, null_mut(), length),
        ]
    };
    assert_eq!(codes, [DERMATOME_ARGUMENT; 27]);
    handle.frame().unwrap();
}

#[test]
fn a_record_of_another_size_is_refused_and_no_frame_is_lost_with_it() {
    let board = board_with(&small_patch("small", 50.0));
    let handle = Handle::at(board.address());
    let mut identity = MaybeUninit::uninit();
    // SAFETY: the record lives here, and is longer than what is said.
    let code = unsafe { dermatome_get_identity(handle.0, identity.as_mut_ptr(), size_of::<Identity>() - 4) };
    assert_eq!(code, DERMATOME_SIZE);
    assert!(handle.error().contains("dermatome_identity of 76 bytes, and it is 80"), "{}", handle.error());
    let options = Options::default();
    // SAFETY: likewise.
    assert_eq!(unsafe { dermatome_start(handle.0, &raw const options, 4) }, DERMATOME_SIZE);
    let mut pixels = [Pixel::default(); 3];
    // SAFETY: likewise.
    let code = unsafe { dermatome_get_pixels(handle.0, pixels.as_mut_ptr(), size_of_val(&pixels)) };
    assert_eq!(code, DERMATOME_SIZE);
    assert!(handle.error().contains("room for 3 pixels, and there are 4"), "{}", handle.error());
    assert_eq!(
        handle.start(Options { contacts_every: 0, ..options }),
        Err(DERMATOME_ARGUMENT),
        "nothing to stream"
    );
    handle.start(Options { images_every: 1, ..options }).unwrap();
    let first = handle.frame().unwrap();
    let mut frame = MaybeUninit::uninit();
    for _ in 0..3 {
        // SAFETY: likewise.
        let code = unsafe { dermatome_wait(handle.0, frame.as_mut_ptr(), size_of::<Frame>() - 8, 100_000) };
        assert_eq!(code, DERMATOME_SIZE);
    }
    let mut three = [0.0; 3];
    assert_eq!(handle.image(&mut three), DERMATOME_SIZE);
    assert_eq!(handle.frame().unwrap().sequence, first.sequence + 1);
}

#[test]
fn words_are_cut_off_at_a_character_and_end_with_a_nul() {
    let mut words = [1 as c_char; 12];
    // SAFETY: the buffer lives here.
    let said = |room: usize, words: &mut [c_char; 12]| unsafe {
        assert_eq!(dermatome_flag_words(DERMATOME_MISSED | DERMATOME_SATURATED, words.as_mut_ptr(), room), 0);
        CStr::from_ptr(words.as_ptr()).to_str().unwrap().to_owned()
    };
    assert_eq!(said(12, &mut words), "saturated, ");
    assert_eq!(said(4, &mut words), "sat");
    assert_eq!(said(1, &mut words), "");
    let mut board = null_mut();
    let port = c"tcp:\xc3\xa4\xc3\xb6";
    // SAFETY: all of it lives here.
    let code = unsafe { dermatome_open(port.as_ptr(), &raw mut board, words.as_mut_ptr(), 8) };
    // SAFETY: likewise.
    let said = unsafe { CStr::from_ptr(words.as_ptr()) };
    assert_eq!((code, said.to_str().unwrap()), (DERMATOME_PORT, "`tcp:ä"));
    // SAFETY: likewise; no words are wanted.
    let code = unsafe { dermatome_open(c"\xff".as_ptr(), &raw mut board, null_mut(), 0) };
    assert_eq!(code, DERMATOME_ARGUMENT);
}

#[test]
fn every_code_and_the_version_have_their_words() {
    // SAFETY: the library's words stay.
    let name = |code| unsafe { CStr::from_ptr(dermatome_code_name(code)) }.to_str().unwrap();
    let names: std::collections::BTreeSet<_> = (DERMATOME_FAULT..=DERMATOME_PENDING).map(name).collect();
    assert_eq!((names.len(), names.contains("no code"), name(99)), (17, false, "no code"));
    // SAFETY: likewise.
    let version = unsafe { CStr::from_ptr(dermatome_version()) };
    assert_eq!(version.to_str().unwrap(), env!("CARGO_PKG_VERSION"));
}

#[test]
fn a_panic_ends_at_the_library_and_the_board_can_only_be_closed() {
    let board = board_with(&small_patch("small", 50.0));
    let handle = Handle::at(board.address());
    handle.start_plainly().unwrap();
    let panics = |_: &mut _| -> Result<i32, Failure> { panic!("a fault on purpose") };
    // SAFETY: an open board.
    assert_eq!(unsafe { with(handle.0, panics) }, DERMATOME_FAULT);
    assert_eq!(handle.frame().map(drop), Err(DERMATOME_FAULT));
    assert_eq!((handle.stop(), handle.answer()), (Err(DERMATOME_FAULT), DERMATOME_FAULT));
    assert!(handle.error().contains("close this handle"), "{}", handle.error());
    drop(handle);
    let handle = Handle::at(board.address());
    handle.start_plainly().unwrap();
    handle.frame().unwrap();
}
