//! Words: text that ends with a NUL, in the room that there is.

use core::{
    ffi::c_char,
    fmt::{self, Write as _},
};

/// Text in an array of `char`, with its NUL; what has no room is left away.
#[must_use]
pub fn array<const N: usize>(words: &str) -> [c_char; N] {
    let mut bytes = [0_u8; N];
    // Fails where the room ends.
    let _ = Text::within(&mut bytes).write_str(words);
    bytes.map(|byte| byte as c_char)
}

/// Text that grows within its room, of which the last byte stays free.
pub struct Text<'a> {
    room: &'a mut [u8],
    length: usize,
}

impl<'a> Text<'a> {
    /// None yet. The room is all zero, and not empty.
    pub fn within(room: &'a mut [u8]) -> Self {
        Self { room, length: 0 }
    }
}

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, words: &str) -> fmt::Result {
        let free = self.room.len().saturating_sub(self.length + 1);
        let whole = whole_characters(words, free);
        self.room[self.length..self.length + whole].copy_from_slice(&words.as_bytes()[..whole]);
        self.length += whole;
        if whole == words.len() { Ok(()) } else { Err(fmt::Error) }
    }
}

/// Bytes of a text that are whole characters, `most` of them at most.
fn whole_characters(words: &str, most: usize) -> usize {
    let is_end = |length: &usize| words.is_char_boundary(*length);
    (0..=most.min(words.len())).rev().find(is_end).unwrap_or(0)
}
