//! Frames task: orders scans while something needs frames, takes each frame through the device, and
//! queues the events that follow.
//!
//! A frame that comes while the one before is still computed waits; events that do not fit their queue
//! are dropped whole, and their numbers show the gap. Contacts go ahead of all that is long.

use dermatome_shared::{
    acquire::Acquisition,
    protocol::{BoardPacket, MAX_PACKET_BYTES},
};
use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_time::Duration;
use static_cell::ConstStaticCell;

use super::{
    State,
    acquire::{Captured, FramesEnd, Order, Orders},
};

/// Longest time between frames; slower frame rates count as this.
const MAX_INTERVAL: Duration = Duration::from_secs(3600);

/// Takes frames for ever.
#[embassy_executor::task]
pub(crate) async fn run(state: &'static State, orders: &'static Orders, frames: FramesEnd) -> ! {
    static SCRATCH: ConstStaticCell<[u8; MAX_PACKET_BYTES]> = ConstStaticCell::new([0; MAX_PACKET_BYTES]);
    let mut task = Task { state, orders, frames, scratch: SCRATCH.take() };
    loop {
        match task.prepare().await {
            Some(order) => task.scan(order).await,
            None => state.answered.wait().await,
        }
    }
}

struct Task {
    state: &'static State,
    orders: &'static Orders,
    frames: FramesEnd,
    scratch: &'static mut [u8],
}

/// What a scan was ordered for: any change of this ends it.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Purpose {
    scan: u32,
    scope_slot: Option<u16>,
}

impl Purpose {
    /// What frames are needed for now, if they are.
    fn now(state: &State) -> Option<Self> {
        let device = state.device.borrow();
        let streaming = device.streaming();
        let scope_slot = (streaming.scope > 0).then_some(streaming.scope_slot);
        device.needs_frames().then_some(Self { scan: device.scan(), scope_slot })
    }
}

impl Task {
    /// Puts the scan that is needed into its place; none if no frames are.
    async fn prepare(&mut self) -> Option<Order> {
        let purpose = Purpose::now(self.state)?;
        let mut place = self.orders.acquisition.lock().await;
        self.orders.with_watch(|watch| self.state.device.borrow().begin_watch(watch));
        put_scan(self.state, purpose, &mut place)
    }

    /// Runs one scan as long as it is what is needed.
    async fn scan(&mut self, order: Order) {
        let purpose = Purpose::now(self.state);
        self.orders.start(order);
        while Purpose::now(self.state) == purpose {
            match select(self.frames.receive(), self.state.answered.wait()).await {
                Either::First(captured) => {
                    // An answer may have come first, and a frame of the old scan means nothing to a new one.
                    if Purpose::now(self.state) == purpose {
                        process(self.state, captured, self.scratch);
                        self.orders.with_watch(|watch| self.state.device.borrow().brief(watch));
                    }
                    self.frames.receive_done();
                    // Where frames come faster than they are computed, others have a turn all the same: the
                    // link, and the watchdog.
                    yield_now().await;
                }
                Either::Second(()) => {}
            }
        }
        self.orders.stop();
        // Frames of the old scan mean nothing any more.
        while let Either::First(_) = select(self.frames.receive(), self.orders.stopped()).await {
            self.frames.receive_done();
        }
        self.frames.clear();
    }
}

/// Puts a scan of the patch in use into its place, and gives the order that runs it. Not inlined, so that
/// its stack is free again while the task waits.
#[inline(never)]
fn put_scan(state: &State, purpose: Purpose, place: &mut Option<Acquisition>) -> Option<Order> {
    let device = state.device.borrow();
    let (patch, drive, front_end) = (device.patch()?, device.drive()?, device.front_end()?);
    let mut acquisition = Acquisition::new(&patch, &drive, front_end)?;
    acquisition.watch(purpose.scope_slot);
    *place = Some(acquisition);
    let interval = Duration::from_micros((1e6 / drive.frame_rate) as u64).min(MAX_INTERVAL);
    let in_small_range = front_end.uses_small_range(drive.amplitude);
    Some(Order { in_small_range, share: front_end.share_of_range(drive.amplitude), interval })
}

/// Takes one frame through the device. Not inlined, so that its stack is free again while the task waits.
#[inline(never)]
fn process(state: &State, captured: &mut Captured, scratch: &mut [u8]) {
    let device = &mut *state.device.borrow_mut();
    let mut queues = state.events.borrow_mut();
    let mut queue = |packet: &BoardPacket| {
        if queues.push(packet, scratch).is_err() {
            defmt::debug!("event dropped: the link is too slow");
        }
    };
    device.process(&mut captured.frame, &captured.arrival, &mut queue);
    if let Some(samples) = captured.scope.as_ref().filter(|_| device.wants_scope(captured.frame.sequence)) {
        device.show_scope(samples, &mut queue);
    }
    state.queued.signal(());
}
