//! Tasks: each joins drivers to the shared code, and runs for ever.

pub(crate) mod acquire;
pub(crate) mod frames;
pub(crate) mod health;
pub(crate) mod link;

use core::cell::RefCell;

use dermatome_firmware::{
    board,
    drivers::{flash::SlotFlash, link::OWN_BYTES},
};
use dermatome_shared::{
    device::{BoardFacts, Device, flash_slots::FlashSlotStore},
    pipeline::PipelineState,
    protocol::{EventQueue, FrameSource, Identity},
    restart::Restart,
};
use embassy_stm32::{Peri, peripherals};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, signal::Signal};
use heapless::String;
use static_cell::{ConstStaticCell, StaticCell};

/// Bytes of short events that wait for the link: some ten contact lists.
const SHORT_EVENT_BYTES: usize = 2 * 1024;
/// Bytes of long ones: some three full images, less what the link needs of the memory.
const LONG_EVENT_BYTES: usize = 6 * 1024 - OWN_BYTES;

/// Events that wait for the link.
pub(crate) type Events = EventQueue<SHORT_EVENT_BYTES, LONG_EVENT_BYTES>;

/// What the tasks share. All run on one executor, and none holds a borrow while it waits.
pub(crate) struct State {
    /// The board's state machine.
    device: RefCell<Device<FlashSlotStore<SlotFlash>, &'static mut PipelineState>>,
    /// Its events.
    events: &'static RefCell<Events>,
    /// A request was answered: frames may be needed now.
    answered: Signal<NoopRawMutex, ()>,
    /// An event was queued.
    queued: Signal<NoopRawMutex, ()>,
}

impl State {
    /// The one state, with the patch that the flash holds. Can be called once.
    pub(crate) fn take(flash: Peri<'static, peripherals::FLASH>, started_after: Restart) -> &'static Self {
        static STATE: StaticCell<State> = StaticCell::new();
        static EVENTS: ConstStaticCell<RefCell<Events>> = ConstStaticCell::new(RefCell::new(Events::new()));
        // Apart, so that it never lies on the stack.
        static PIPELINE: StaticCell<PipelineState> = StaticCell::new();
        let pipeline = PIPELINE.init_with(PipelineState::default);
        STATE.init_with(|| Self {
            device: RefCell::new(Device::new(
                facts(started_after),
                FlashSlotStore::open(SlotFlash::new(flash)),
                pipeline,
            )),
            events: EVENTS.take(),
            answered: Signal::new(),
            queued: Signal::new(),
        })
    }
}

fn facts(started_after: Restart) -> BoardFacts {
    let identity = Identity { board: text(board::NAME), firmware: text(env!("CARGO_PKG_VERSION")) };
    BoardFacts {
        identity,
        electrodes: board::ELECTRODES,
        frame_source: FrameSource::Skin,
        front_end: Some(board::FRONT_END),
        started_after,
        sees_host_go: false,
    }
}

/// A text known at build time, in the protocol's form.
fn text<const N: usize>(text: &str) -> String<N> {
    text.try_into().expect("names and versions fit their fields")
}
