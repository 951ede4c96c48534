//! Frames task: makes a frame whenever one is due, and queues the events that follow from it.
//!
//! Frames are synthetic until the board can measure, and the board says so in its info. They come at
//! the patch's frame rate, only while a tare or a stream needs them. A frame that is late is not made
//! up for. Events that do not fit the queue are dropped whole, and their numbers show the gap.

use dermatome_firmware::drivers::flash::SlotFlash;
use dermatome_shared::{
    device::Device, frame::Frame, protocol::MAX_PACKET_BYTES, slots::SlotStore, synthetic,
};
use embassy_time::{Duration, Instant, Timer};
use static_cell::ConstStaticCell;

use super::State;

/// Which synthetic frames.
const SEED: u32 = 1;
/// Longest time between frames; slower frame rates count as this.
const MAX_PERIOD: Duration = Duration::from_secs(3600);

/// Makes frames for ever.
#[embassy_executor::task]
pub(crate) async fn run(state: &'static State) -> ! {
    static SCRATCH: ConstStaticCell<[u8; MAX_PACKET_BYTES]> = ConstStaticCell::new([0; MAX_PACKET_BYTES]);
    let scratch = SCRATCH.take();
    let mut sequence = 0_u32;
    loop {
        state.answered.wait().await;
        let mut due = Instant::now();
        while let Some(period) = period(state) {
            due = (due + period).max(Instant::now());
            // Yields even where the frame is due already.
            Timer::at(due).await;
            if make_frame(state, sequence, scratch) {
                sequence = sequence.wrapping_add(1);
            }
        }
    }
}

/// Time between frames, if frames are needed.
fn period(state: &State) -> Option<Duration> {
    let device = state.device.borrow();
    let patch = device.patch().filter(|_| device.needs_frames())?;
    let micros = (1e6 / patch.header.drive.frame_rate) as u64;
    Some(Duration::from_micros(micros.max(1)).min(MAX_PERIOD))
}

/// Takes one frame through the device, if it still needs one.
fn make_frame(state: &State, sequence: u32, scratch: &mut [u8]) -> bool {
    let device = &mut *state.device.borrow_mut();
    let Some(patch) = device.patch().filter(|_| device.needs_frames()) else { return false };
    let frame = synthetic::frame(SEED, sequence, Instant::now().as_micros(), patch.steps());
    process(device, &frame, state, scratch);
    true
}

fn process(device: &mut Device<SlotStore<SlotFlash>>, frame: &Frame, state: &State, scratch: &mut [u8]) {
    let mut events = state.events.borrow_mut();
    device.process(frame, |packet| {
        if events.push(&packet, scratch).is_err() {
            defmt::debug!("event dropped: the link is too slow");
        }
    });
    state.queued.signal(());
}
