//! A board by its handle: each method is one call of the library.

use dermatome_c::{
    board::Board,
    codes::{DERMATOME_FRAME, DERMATOME_OK},
    functions::*,
    records::{Counts, Drive, Frame, Identity, Options, Pixel, Skin},
};
use std::{
    ffi::{CStr, CString, c_char},
    mem::MaybeUninit,
    net::SocketAddr,
    ptr::null,
    time::{Duration, Instant},
};

pub(crate) struct Handle(pub(crate) *mut Board);

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: `open` gave it, and this is its end.
        unsafe { dermatome_close(self.0) };
    }
}

/// A record that a call fills where it succeeds.
fn filled<T>(call: impl FnOnce(*mut T, usize) -> i32) -> Result<T, i32> {
    let mut record = MaybeUninit::uninit();
    match call(record.as_mut_ptr(), size_of::<T>()) {
        // SAFETY: the call has filled it.
        DERMATOME_OK => Ok(unsafe { record.assume_init() }),
        code => Err(code),
    }
}

fn done(code: i32) -> Result<(), i32> {
    if code == DERMATOME_OK { Ok(()) } else { Err(code) }
}

/// The words in a buffer.
fn words(buffer: &[c_char]) -> String {
    // SAFETY: the library ends words with a NUL within the buffer.
    unsafe { CStr::from_ptr(buffer.as_ptr()) }.to_str().unwrap().to_owned()
}

impl Handle {
    pub(crate) fn open(port: &str) -> Result<Self, (i32, String)> {
        let (port, mut board, mut said) = (CString::new(port).unwrap(), std::ptr::null_mut(), [1; 400]);
        // SAFETY: all of it lives here.
        let code = unsafe { dermatome_open(port.as_ptr(), &raw mut board, said.as_mut_ptr(), said.len()) };
        assert_eq!(board.is_null(), code != DERMATOME_OK);
        if code == DERMATOME_OK { Ok(Self(board)) } else { Err((code, words(&said))) }
    }

    pub(crate) fn at(address: SocketAddr) -> Self {
        Self::open(&format!("tcp:{address}")).unwrap()
    }

    pub(crate) fn error(&self) -> String {
        let mut said = [1; 400];
        // SAFETY: an open board and a buffer that live meanwhile.
        assert_eq!(unsafe { dermatome_error(self.0, said.as_mut_ptr(), said.len()) }, DERMATOME_OK);
        words(&said)
    }

    pub(crate) fn identity(&self) -> Result<Identity, i32> {
        // SAFETY: an open board and a record that live meanwhile; so in all that follow.
        filled(|record, size| unsafe { dermatome_get_identity(self.0, record, size) })
    }

    pub(crate) fn skin(&self) -> Result<Skin, i32> {
        // SAFETY: as above.
        filled(|record, size| unsafe { dermatome_get_skin(self.0, record, size) })
    }

    pub(crate) fn counts(&self) -> Counts {
        // SAFETY: as above.
        filled(|record, size| unsafe { dermatome_get_counts(self.0, record, size) }).unwrap()
    }

    pub(crate) fn pixels(&self) -> Vec<Pixel> {
        let mut pixels = vec![Pixel::default(); 1024];
        // SAFETY: as above.
        let count =
            unsafe { dermatome_get_pixels(self.0, pixels.as_mut_ptr(), size_of_val(pixels.as_slice())) };
        pixels.truncate(usize::try_from(count).unwrap());
        pixels
    }

    /// Fills the start of `values`; gives a code, or how many there are.
    pub(crate) fn image(&self, values: &mut [f32]) -> i32 {
        // SAFETY: as above.
        unsafe { dermatome_image(self.0, values.as_mut_ptr(), size_of_val(values)) }
    }

    pub(crate) fn tare(&self, frames: u16) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_tare(self.0, frames) })
    }

    pub(crate) fn set_drive(&self, drive: &Drive) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_set_drive(self.0, drive, size_of::<Drive>()) })
    }

    pub(crate) fn start(&self, options: Options) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_start(self.0, &raw const options, size_of::<Options>()) })
    }

    /// Starts with null: the contacts of each frame.
    pub(crate) fn start_plainly(&self) -> Result<(), i32> {
        // SAFETY: as above; null is allowed.
        done(unsafe { dermatome_start(self.0, null(), 0) })
    }

    pub(crate) fn stop(&self) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_stop(self.0) })
    }

    /// Writes a frame where one is there.
    pub(crate) fn poll(&self, frame: &mut MaybeUninit<Frame>) -> i32 {
        // SAFETY: as above.
        unsafe { dermatome_poll(self.0, frame.as_mut_ptr(), size_of::<Frame>()) }
    }

    /// Waits for a frame two seconds at most.
    pub(crate) fn frame(&self) -> Result<Frame, i32> {
        let mut frame = MaybeUninit::uninit();
        // SAFETY: as above.
        let code = unsafe { dermatome_wait(self.0, frame.as_mut_ptr(), size_of::<Frame>(), 2_000_000) };
        if code != DERMATOME_FRAME {
            return Err(code);
        }
        // SAFETY: the call has filled it.
        Ok(unsafe { frame.assume_init() })
    }

    pub(crate) fn ask_tare(&self, frames: u16) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_ask_tare(self.0, frames) })
    }

    pub(crate) fn ask_drive(&self, drive: &Drive) -> Result<(), i32> {
        // SAFETY: as above.
        done(unsafe { dermatome_ask_drive(self.0, drive, size_of::<Drive>()) })
    }

    pub(crate) fn answer(&self) -> i32 {
        // SAFETY: as above.
        unsafe { dermatome_answer(self.0) }
    }

    /// Polls until `is_so`, within five seconds; gives the last code.
    pub(crate) fn poll_until(&self, mut is_so: impl FnMut(i32) -> bool) -> i32 {
        let (mut frame, begun) = (MaybeUninit::uninit(), Instant::now());
        loop {
            let code = self.poll(&mut frame);
            if is_so(code) {
                return code;
            }
            assert!(begun.elapsed() < Duration::from_secs(5), "polling says {code}: {}", self.error());
            std::thread::yield_now();
        }
    }
}

/// A name in a record.
pub(crate) fn name(array: &[c_char]) -> String {
    words(array)
}
