//! Memory: what a caller in C gives, looked at before it is used. The one place that touches pointers.

use crate::{board::Board, codes, failure::Failure, words::Text};
use core::{
    ffi::{CStr, c_char},
    fmt::{self, Write as _},
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Lets `work` work with a board; what fails is kept, so that its words can be asked for. After a panic the board works no
/// more.
///
/// # Safety
/// As in the head of the header.
pub unsafe fn with(board: *mut Board, work: impl FnOnce(&mut Board) -> Result<i32, Failure>) -> i32 {
    // SAFETY: null, or a handle that is open and that no other thread uses.
    let Some(board) = (unsafe { board.as_mut() }) else { return codes::DERMATOME_ARGUMENT };
    if board.is_faulty() {
        return codes::DERMATOME_FAULT;
    }
    let failure = match caught(|| work(board)) {
        Ok(code) => return code,
        Err(failure) => failure,
    };
    let code = failure.code();
    board.failed(failure);
    code
}

/// What `work` gives; a panic ends here, as no caller in C could catch it.
pub fn caught<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(Err(Failure::Fault))
}

/// Writes a record.
///
/// # Safety
/// As in the head of the header.
pub unsafe fn put<T: Copy>(to: *mut T, size: usize, what: &'static str, value: T) -> Result<(), Failure> {
    check(to, size, what)?;
    // SAFETY: not null, aligned, and as long as the caller's record.
    unsafe { to.write(value) };
    Ok(())
}

/// Whether a pointer may lead to a record of this size.
pub fn check<T>(at: *const T, size: usize, what: &'static str) -> Result<(), Failure> {
    if at.is_null() || !at.is_aligned() {
        return Err(Failure::Argument("a pointer is null or not aligned"));
    }
    let expected = size_of::<T>();
    if size == expected { Ok(()) } else { Err(Failure::Size { what, given: size, expected }) }
}

/// Reads a record.
///
/// # Safety
/// As in the head of the header.
pub unsafe fn get<T: Copy>(from: *const T, size: usize, what: &'static str) -> Result<T, Failure> {
    check(from, size, what)?;
    // SAFETY: not null, aligned, and as long as the caller's record.
    Ok(unsafe { from.read() })
}

/// Writes as many as there are; gives how many.
///
/// # Safety
/// As in the head of the header: `to` leads to `size` bytes.
pub unsafe fn put_all<T: Copy>(
    to: *mut T,
    size: usize,
    what: &'static str,
    values: impl ExactSizeIterator<Item = T>,
) -> Result<i32, Failure> {
    let (room, count) = (size / size_of::<T>(), values.len());
    if room < count {
        return Err(Failure::Room { what, given: room, needed: count });
    }
    check(to, size_of::<T>(), what)?;
    for (place, value) in values.enumerate() {
        // SAFETY: not null, aligned, and within the room that the caller has.
        unsafe { to.add(place).write(value) };
    }
    Ok(count as i32)
}

/// Text of the caller.
///
/// # Safety
/// As in the head of the header: text ends with a NUL, and stays until the call is over.
pub unsafe fn text<'a>(from: *const c_char) -> Result<&'a str, Failure> {
    if from.is_null() {
        return Err(Failure::Argument("a text is null"));
    }
    // SAFETY: not null, and ended by a NUL.
    let text = unsafe { CStr::from_ptr(from) };
    text.to_str().map_err(|_| Failure::Argument("a text is not UTF-8"))
}

/// Writes words and a NUL; what has no room is left away.
///
/// # Safety
/// As in the head of the header: `to` leads to `size` bytes.
pub unsafe fn put_text(to: *mut c_char, size: usize, words: &dyn fmt::Display) -> Result<i32, Failure> {
    if to.is_null() || size == 0 {
        return Err(Failure::Argument("there is no room for a text"));
    }
    // SAFETY: not null, and as long as the caller's buffer, which is zeros before it is read.
    let room = unsafe {
        to.write_bytes(0, size);
        core::slice::from_raw_parts_mut(to.cast::<u8>(), size)
    };
    // Fails where the room ends.
    let _ = write!(Text::within(room), "{words}");
    Ok(codes::DERMATOME_OK)
}
