//! Codes: what functions return, and what the flags of a frame mean.

use core::ffi::CStr;
use dermatome_link::shared::frame::FrameFlags;

/// Done. For `dermatome_poll` and `dermatome_wait`: no frame has come yet.
pub const DERMATOME_OK: i32 = 0;
/// A frame was written.
pub const DERMATOME_FRAME: i32 = 1;
/// The answer to what was asked has not come yet.
pub const DERMATOME_PENDING: i32 = 2;
/// A null pointer, or a number out of range.
pub const DERMATOME_ARGUMENT: i32 = -1;
/// A record or a buffer is not as long as it must be: header and library are not of one version, or there is too little room.
pub const DERMATOME_SIZE: i32 = -2;
/// Not now: it needs a stream, or that there is none.
pub const DERMATOME_STATE: i32 = -3;
/// The port does not exist, is no port, or cannot be opened.
pub const DERMATOME_PORT: i32 = -4;
/// This user may not open the port.
pub const DERMATOME_PERMISSION: i32 = -5;
/// Another program holds the port, or the board serves another host.
pub const DERMATOME_IN_USE: i32 = -6;
/// Nothing came back, or nothing that is readable: no board, another baud rate, a bad cable.
pub const DERMATOME_NO_ANSWER: i32 = -7;
/// The board has gone or closed the link, or the cable was pulled. Close the handle and open the port anew.
pub const DERMATOME_CUT: i32 = -8;
/// Board and library speak different versions of the protocol: update the older one.
pub const DERMATOME_VERSION: i32 = -9;
/// The board did not do it, and says why.
pub const DERMATOME_REFUSED: i32 = -10;
/// The board holds no patch: it does not know its skin.
pub const DERMATOME_NO_PATCH: i32 = -11;
/// The board holds another patch than the one asked for.
pub const DERMATOME_WRONG_PATCH: i32 = -12;
/// No frame has come for as long as `silence_ms` says, also while a board makes its reference for longer than that (of 20
/// frames at the start, or of those that were asked for): poll on, as stopping ends that reference. A board that has started
/// anew behind a serial adapter sends none until it is told to: stop and start, or close the handle and open the port anew.
pub const DERMATOME_SILENT: i32 = -13;
/// A fault of this library. The handle can only be closed.
pub const DERMATOME_FAULT: i32 = -14;

/// A sample reached the end of the converter's range.
pub const DERMATOME_SATURATED: u16 = 1;
/// An electrode has no contact.
pub const DERMATOME_OPEN_ELECTRODE: u16 = 2;
/// An electrode is connected to its neighbour.
pub const DERMATOME_SHORTED_ELECTRODE: u16 = 4;
/// No current flows.
pub const DERMATOME_NO_CURRENT: u16 = 8;
/// Voltages with drive and sense exchanged differ.
pub const DERMATOME_NOT_RECIPROCAL: u16 = 16;
/// Voltages differ from the reference by more than any press could explain.
pub const DERMATOME_IMPLAUSIBLE: u16 = 32;
/// The board lost samples between the frame before and this one; alone it leaves a frame valid.
pub const DERMATOME_MISSED: u16 = 64;
/// Measurements with bad electrodes count for nothing.
pub const DERMATOME_MASKED: u16 = 128;
/// The board's chip is hotter than it may be.
pub const DERMATOME_HOT: u16 = 256;
/// Voltages have changed unlike a press: a stretched skin, a moved electrode.
pub const DERMATOME_UNLIKE_PRESS: u16 = 512;
/// What pressed when the reference was made has been lifted.
pub const DERMATOME_LIFTED: u16 = 1024;
/// An electrode touches worse than when the reference was made.
pub const DERMATOME_WORSE_CONTACT: u16 = 2048;

/// The name of a code, for messages.
#[must_use]
pub fn name(code: i32) -> &'static CStr {
    match code {
        DERMATOME_OK => c"done",
        DERMATOME_FRAME => c"a frame",
        DERMATOME_PENDING => c"not yet",
        DERMATOME_ARGUMENT => c"wrong argument",
        DERMATOME_SIZE => c"wrong size",
        DERMATOME_STATE => c"not now",
        DERMATOME_PORT => c"no such port",
        DERMATOME_PERMISSION => c"no permission",
        DERMATOME_IN_USE => c"in use",
        DERMATOME_NO_ANSWER => c"no answer",
        DERMATOME_CUT => c"cut",
        DERMATOME_VERSION => c"another version",
        DERMATOME_REFUSED => c"refused",
        DERMATOME_NO_PATCH => c"no patch",
        DERMATOME_WRONG_PATCH => c"another patch",
        DERMATOME_SILENT => c"silent",
        DERMATOME_FAULT => c"a fault of the library",
        _ => c"no code",
    }
}

/// What C reads as numbers is what boards send.
const _: () = {
    let flags = [
        (DERMATOME_SATURATED, FrameFlags::SATURATED),
        (DERMATOME_OPEN_ELECTRODE, FrameFlags::OPEN_ELECTRODE),
        (DERMATOME_SHORTED_ELECTRODE, FrameFlags::SHORTED_ELECTRODE),
        (DERMATOME_NO_CURRENT, FrameFlags::NO_CURRENT),
        (DERMATOME_NOT_RECIPROCAL, FrameFlags::NOT_RECIPROCAL),
        (DERMATOME_IMPLAUSIBLE, FrameFlags::IMPLAUSIBLE),
        (DERMATOME_MISSED, FrameFlags::MISSED),
        (DERMATOME_MASKED, FrameFlags::MASKED),
        (DERMATOME_HOT, FrameFlags::HOT),
        (DERMATOME_UNLIKE_PRESS, FrameFlags::UNLIKE_PRESS),
        (DERMATOME_LIFTED, FrameFlags::LIFTED),
        (DERMATOME_WORSE_CONTACT, FrameFlags::WORSE_CONTACT),
    ];
    assert!(flags.len() == FrameFlags::ALL.len());
    let mut n = 0;
    while n < flags.len() {
        assert!(flags[n].0 == flags[n].1.0);
        n += 1;
    }
};
