//! RAM: where it lies, and one without a CPU for benches and tests.

/// Where the RAM lies: SRAM1, SRAM2 and the second address of CCM SRAM, side by side (2.4).
pub const RAM_START: u32 = 0x2000_0000;
/// Bytes of RAM.
pub const RAM_BYTES: u32 = 128 * 1024;

/// RAM, for whoever copies without the CPU.
pub trait Memory {
    /// Reads bytes of RAM.
    fn read(&self, address: u32, bytes: &mut [u8]);
    /// Writes bytes of RAM.
    fn write(&mut self, address: u32, bytes: &[u8]);
}

/// All bytes of RAM, from [`RAM_START`] on.
#[derive(Clone, Debug)]
pub struct Ram(pub Vec<u8>);

impl Default for Ram {
    fn default() -> Self {
        Self(vec![0; RAM_BYTES as usize])
    }
}

impl Memory for Ram {
    fn read(&self, address: u32, bytes: &mut [u8]) {
        let start = (address - RAM_START) as usize;
        bytes.copy_from_slice(&self.0[start..start + bytes.len()]);
    }
    fn write(&mut self, address: u32, bytes: &[u8]) {
        let start = (address - RAM_START) as usize;
        self.0[start..start + bytes.len()].copy_from_slice(bytes);
    }
}
