//! Limits: the sizes that fix memory on a board, and with it what a patch may ask for.

/// Most electrodes a board can switch: one nibble of the multiplexer word each.
pub const MAX_ELECTRODES: usize = 16;
/// Most stimulation steps in one frame (16 drives, 16 sense pairs each).
pub const MAX_STEPS: usize = 256;
/// Most slots in a frame: its steps, and a test of each electrode.
pub const MAX_SLOTS: usize = MAX_STEPS + MAX_ELECTRODES;
/// Most samples in a carrier period.
pub const MAX_PERIOD: usize = 160;
/// Most measurements, after reciprocal steps are combined.
pub const MAX_MEASUREMENTS: usize = 256;
/// Most image pixels.
pub const MAX_PIXELS: usize = 1024;
/// Most columns, and most rows, of the pixel grid.
pub const MAX_GRID_SIDE: usize = 64;
/// Most contacts reported for one image.
pub const MAX_CONTACTS: usize = 8;
/// Pins that reflexes can have, from 1.
pub const REFLEX_PINS: u8 = 4;
/// Bytes of a flash slot of the reference board, the record of its commit included.
pub const FLASH_SLOT_BYTES: usize = 184 * 1024;
/// Bytes of the record of a commit: a double word of flash.
pub const RECORD_BYTES: usize = 8;
/// Longest patch a board can hold, bytes: one of its two flash slots, without the record of its commit.
pub const MAX_PATCH_BYTES: usize = FLASH_SLOT_BYTES - RECORD_BYTES;
