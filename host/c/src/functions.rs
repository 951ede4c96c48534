//! Functions: those of the header.

use crate::{
    board::Board,
    codes::{self, DERMATOME_FRAME, DERMATOME_OK},
    failure::Failure,
    memory::{caught, get, put, put_all, put_text, text, with},
    records::{Contact, Counts, Drive, Frame, Identity, Options, Pixel, Pose, Skin},
};
use core::{
    ffi::{c_char, c_int},
    fmt, ptr,
};
use dermatome_link::shared::frame::FrameFlags;
use std::{ffi::CStr, time::Duration};

/// Version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn dermatome_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// The name of a code in few words.
#[unsafe(no_mangle)]
pub extern "C" fn dermatome_code_name(code: c_int) -> *const c_char {
    codes::name(code).as_ptr()
}

/// What the flags of a frame say, in words with commas between them, at most `size` bytes with the NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_flag_words(flags: u16, words: *mut c_char, size: usize) -> c_int {
    code(caught(|| {
        let said = FrameFlags(flags).words().collect::<Vec<_>>().join(", ");
        // SAFETY: as in the head of the header.
        unsafe { put_text(words, size, &said) }
    }))
}

/// Opens the port of a board, `/dev/ttyACM0`, `tcp:HOST:PORT`, `rs485:LINE#ADDRESS` or `can:BUS#ADDRESS`, and makes sure that
/// board and library understand each other: some seconds at most. Where it fails, `*board` is null and `words` (of `size`
/// bytes; may be null) says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_open(
    port: *const c_char,
    board: *mut *mut Board,
    words: *mut c_char,
    size: usize,
) -> c_int {
    // SAFETY: as in the head of the header.
    let opened = caught(|| {
        // SAFETY: likewise.
        unsafe { put(board, size_of::<*mut Board>(), "board", ptr::null_mut()) }?;
        // SAFETY: likewise.
        let opened = Board::open(unsafe { text(port) }?)?;
        // SAFETY: likewise.
        unsafe { put(board, size_of::<*mut Board>(), "board", Box::into_raw(Box::new(opened))) }
    });
    let said: &dyn std::fmt::Display = opened.as_ref().err().map_or(&"", |failure| failure);
    if !words.is_null() {
        // SAFETY: likewise. Where there is no room there are no words.
        let _ = caught(|| unsafe { put_text(words, size, said) });
    }
    code(opened.map(|()| DERMATOME_OK))
}

/// Closes a board, and ends its stream. Null is no board, and nothing is done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_close(board: *mut Board) {
    if board.is_null() {
        return;
    }
    // SAFETY: as in the head of the header: `dermatome_open` gave it, and nobody uses it any more.
    let mut board = unsafe { Box::from_raw(board) };
    let _ = caught(|| {
        if !board.is_faulty() {
            // Fails where there is none, or the board has gone: it then stops by itself.
            let _ = board.stop();
        }
        drop(board);
        Ok(())
    });
}

/// Why the last call with this board that failed did, in words.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_error(board: *const Board, words: *mut c_char, size: usize) -> c_int {
    code(caught(|| {
        // SAFETY: as in the head of the header.
        let Some(board) = (unsafe { board.as_ref() }) else {
            return Err(Failure::Argument("there is no board"));
        };
        let said: &dyn fmt::Display = board.failure().map_or(&"", |failure| failure);
        // SAFETY: likewise.
        unsafe { put_text(words, size, said) }
    }))
}

/// Who the board is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_get_identity(
    board: *mut Board,
    identity: *mut Identity,
    size: usize,
) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| put(identity, size, "dermatome_identity", board.identity()?).map(done)) }
}

/// The skin that the board knows by its patch; before `dermatome_start`. DERMATOME_NO_PATCH where it knows none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_get_skin(board: *mut Board, skin: *mut Skin, size: usize) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| put(skin, size, "dermatome_skin", board.skin()?).map(done)) }
}

/// Where the pixels of its images lie: `[pixel]`, in `size` bytes; before `dermatome_start`. Gives how many there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_get_pixels(board: *mut Board, pixels: *mut Pixel, size: usize) -> c_int {
    let read = |board: &mut Board| {
        let tables = board.surface()?;
        let surface = tables.view();
        let all = tables.pixels.iter().map(|pixel| Pixel::new(&surface, pixel));
        // SAFETY: as in the head of the header.
        unsafe { put_all(pixels, size, "pixels", all) }
    };
    // SAFETY: likewise.
    unsafe { with(board, read) }
}

/// Makes a new reference of `frames` frames of the untouched skin (20 are usual), and waits for it; before
/// `dermatome_start`. A board without a reference makes one by itself when it starts to stream.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_tare(board: *mut Board, frames: u16) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| board.tare(frames).map(done)) }
}

/// Drives the skin like this from now on; null: as its patch says. Before `dermatome_start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_set_drive(board: *mut Board, drive: *const Drive, size: usize) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| board.set_drive(given(drive, size, "dermatome_drive")?).map(done)) }
}

/// Has the board stream; null: the contacts of each frame. All memory that the loop needs is there afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_start(board: *mut Board, options: *const Options, size: usize) -> c_int {
    let start = |board: &mut Board| {
        // SAFETY: as in the head of the header.
        let options = unsafe { given(options, size, "dermatome_options") }?;
        board.start(options.unwrap_or_default()).map(done)
    };
    // SAFETY: likewise.
    unsafe { with(board, start) }
}

/// The next frame that is there, without waiting: DERMATOME_FRAME where it was written, DERMATOME_OK where none has come. Call it
/// until it does not say DERMATOME_FRAME any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_poll(board: *mut Board, frame: *mut Frame, size: usize) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| next(frame, size, || board.poll())) }
}

/// The same, waiting for a frame `timeout_us` microseconds at most.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_wait(
    board: *mut Board,
    frame: *mut Frame,
    size: usize,
    timeout_us: u32,
) -> c_int {
    let timeout = Duration::from_micros(timeout_us.into());
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| next(frame, size, || board.wait(timeout))) }
}

/// The image of the last frame: relative conductivity change, `[pixel]`, in `size` bytes. Gives how many pixels there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_image(board: *mut Board, values: *mut f32, size: usize) -> c_int {
    let read = |board: &mut Board| {
        let image = board.image()?;
        let values_of = image.values().map(|value| value as f32);
        // SAFETY: as in the head of the header.
        unsafe { put_all(values, size, "pixels", values_of) }
    };
    // SAFETY: likewise.
    unsafe { with(board, read) }
}

/// What has come since `dermatome_start`, and what has not; each frame has it too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_get_counts(board: *mut Board, counts: *mut Counts, size: usize) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| put(counts, size, "dermatome_counts", board.counts()?).map(done)) }
}

/// The file descriptor of the port, for poll(2), select(2) and epoll(7): once it is readable, call `dermatome_poll`. It is the
/// library's: neither read nor close it. Call `dermatome_poll` each few seconds also where it is not readable. A board on a
/// bus with others has none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_descriptor(board: *mut Board) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, Board::descriptor) }
}

/// Asks for a new reference of `frames` frames of the untouched skin, without waiting. `dermatome_answer` says whether the board
/// does it; `counts.tares` grows when it has. Meanwhile there are no contacts, and polling may say DERMATOME_SILENT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_ask_tare(board: *mut Board, frames: u16) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| board.ask_tare(frames).map(done)) }
}

/// Asks for another drive, without waiting; null: as the patch says. The board needs a new reference then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_ask_drive(board: *mut Board, drive: *const Drive, size: usize) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| board.ask_drive(given(drive, size, "dermatome_drive")?).map(done)) }
}

/// What became of the last request: DERMATOME_OK where the board does it or nothing was asked, DERMATOME_PENDING until its answer
/// has come in by `dermatome_poll`; else what went wrong. One request waits at a time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_answer(board: *mut Board) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, Board::answer) }
}

/// Ends the stream, and waits for the board to have done so. It may be started again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_stop(board: *mut Board) -> c_int {
    // SAFETY: as in the head of the header.
    unsafe { with(board, |board| board.stop().map(done)) }
}

/// A contact of the skin's frame in the frame of the link that the skin lies on with this pose. `placed` may be `contact`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dermatome_place(
    pose: *const Pose,
    contact: *const Contact,
    placed: *mut Contact,
    size: usize,
) -> c_int {
    code(caught(|| {
        // SAFETY: as in the head of the header.
        let pose = unsafe { get(pose, size_of::<Pose>(), "dermatome_pose") }?.read()?;
        // SAFETY: likewise.
        let contact = unsafe { get(contact, size, "dermatome_contact") }?;
        // SAFETY: likewise.
        unsafe { put(placed, size, "dermatome_contact", contact.placed(&pose)) }.map(done)
    }))
}

fn code(done: Result<c_int, Failure>) -> c_int {
    done.unwrap_or_else(|failure| failure.code())
}

fn done(_: ()) -> c_int {
    DERMATOME_OK
}

/// A record, unless there is none.
unsafe fn given<T: Copy>(from: *const T, size: usize, what: &'static str) -> Result<Option<T>, Failure> {
    if from.is_null() {
        return Ok(None);
    }
    // SAFETY: as in the head of the header.
    unsafe { get(from, size, what) }.map(Some)
}

/// Writes the frame that there is. The record is looked at first, so that no frame is lost with a wrong one.
unsafe fn next(
    to: *mut Frame,
    size: usize,
    frame: impl FnOnce() -> Result<Option<Frame>, Failure>,
) -> Result<c_int, Failure> {
    crate::memory::check(to, size, "dermatome_frame")?;
    let Some(frame) = frame()? else { return Ok(DERMATOME_OK) };
    // SAFETY: as in the head of the header.
    unsafe { put(to, size, "dermatome_frame", frame) }?;
    Ok(DERMATOME_FRAME)
}
