//! Acquire task: turns the samples of a scan into frames.
//!
//! It has an executor of its own in an interrupt, so that neither a reconstruction nor the link can
//! keep it from the samples. What it finds goes to the frames task through a queue.
//!
//! The reflexes of the patch look at a frame before all else, and their pins follow.
//!
//! A scan is ordered once and then goes on: without a pause where frames are wanted as fast as they
//! come, else with the front end off between frames. The thermometer has its turn before each, and so a
//! scan without a pause begins anew now and then.

use core::{
    cell::RefCell,
    sync::atomic::{AtomicBool, AtomicU32, Ordering},
};

use dermatome_firmware::{
    board::{self, ReflexPins, SensingParts, Thermometer, executor},
    drivers::front_end::{FrontEnd, Missed, RAMP_STEPS, Scan, Tables},
};
use dermatome_shared::{
    acquire::{Acquisition, SlotSamples},
    device::Arrival,
    frame::Frame,
    pipeline::reflex::Watch,
};
use embassy_futures::select::{Either, select};
use embassy_sync::{
    blocking_mutex::{CriticalSectionMutex, raw::CriticalSectionRawMutex},
    mutex::Mutex,
    signal::Signal,
    zerocopy_channel::{Channel, Receiver, Sender},
};
use embassy_time::{Duration, Instant, Timer};
use static_cell::StaticCell;

/// How often the ring of samples is looked at, at the longest. Looks cost time while a frame is computed, so
/// they are as rare as the ring allows: it takes 2 ms to fill.
const LOOK_INTERVAL: Duration = Duration::from_micros(1600);
/// What the last look of a frame leaves to itself: whoever waits for the contacts waits for it.
const LAST_LOOK: Duration = Duration::from_micros(150);
/// How old the temperature may become. A scan that begins anew for it loses a frame or two.
const TEMPERATURE_AGE: Duration = Duration::from_secs(10);
/// A pause shorter than this between frames is not worth stopping for.
const SHORTEST_PAUSE: Duration = Duration::from_millis(2);

/// What the frames task and this one share.
pub(crate) struct Orders {
    /// What looks at frames by the patch's reflexes.
    watch: &'static CriticalSectionMutex<RefCell<Watch>>,
    /// The scan to run; it is changed only while none runs.
    pub(crate) acquisition: Mutex<CriticalSectionRawMutex, Option<Acquisition>>,
    start: Signal<CriticalSectionRawMutex, Order>,
    stop: Signal<CriticalSectionRawMutex, ()>,
    stopped: Signal<CriticalSectionRawMutex, ()>,
    /// Whether current flows, and how often the samples were looked at so far.
    flows: AtomicBool,
    looks: AtomicU32,
    /// Bits of the chip's temperature, degrees Celsius; not a number until it is measured.
    temperature: AtomicU32,
}

/// How to run a scan.
#[derive(Clone, Copy)]
pub(crate) struct Order {
    /// Whether the current is made in the source's small range, and with which share of it, 0 to 1.
    pub(crate) in_small_range: bool,
    pub(crate) share: f32,
    /// Time from frame to frame.
    pub(crate) interval: Duration,
}

/// A frame, how it came, and what the scope saw in it.
#[derive(Default)]
pub(crate) struct Captured {
    pub(crate) frame: Frame,
    pub(crate) arrival: Arrival,
    pub(crate) scope: Option<SlotSamples>,
}

/// Frames on their way to the frames task.
pub(crate) type Frames = Sender<'static, CriticalSectionRawMutex, Captured>;
/// Where the frames task takes them.
pub(crate) type FramesEnd = Receiver<'static, CriticalSectionRawMutex, Captured>;

impl Orders {
    fn new(watch: &'static CriticalSectionMutex<RefCell<Watch>>) -> Self {
        Self {
            watch,
            acquisition: Mutex::new(None),
            start: Signal::new(),
            stop: Signal::new(),
            stopped: Signal::new(),
            flows: AtomicBool::new(false),
            looks: AtomicU32::new(0),
            temperature: AtomicU32::new(f32::NAN.to_bits()),
        }
    }

    /// Looks at the watch, or changes it, while no frame is seen.
    pub(crate) fn with_watch<R>(&self, look: impl FnOnce(&mut Watch) -> R) -> R {
        self.watch.lock(|watch| look(&mut watch.borrow_mut()))
    }

    /// Starts the scan that lies in `acquisition`.
    pub(crate) fn start(&self, order: Order) {
        self.stop.reset();
        self.stopped.reset();
        self.start.signal(order);
    }

    /// How often the samples were looked at, where current flows: then looks come every 1.6 ms at least.
    pub(crate) fn looks(&self) -> Option<u32> {
        self.flows.load(Ordering::Relaxed).then(|| self.looks.load(Ordering::Relaxed))
    }

    /// Temperature of the chip, degrees Celsius, 10 s old at most while current flows.
    pub(crate) fn temperature(&self) -> Option<f32> {
        let celsius = f32::from_bits(self.temperature.load(Ordering::Relaxed));
        (!celsius.is_nan()).then_some(celsius)
    }

    /// Measures the temperature: while no scan runs.
    fn measure(&self, thermometer: &mut Thermometer) {
        self.temperature.store(thermometer.celsius().to_bits(), Ordering::Relaxed);
    }

    /// Asks the scan to stop.
    pub(crate) fn stop(&self) {
        self.stop.signal(());
    }

    /// Waits until it has.
    pub(crate) async fn stopped(&self) {
        self.stopped.wait().await;
    }
}

/// Starts the task on an executor of its own; gives the way to order scans, and where frames come out.
/// Can be called once.
pub(crate) fn start(
    sensing: SensingParts,
    thermometer: Thermometer,
    pins: ReflexPins,
) -> (&'static Orders, FramesEnd) {
    static WATCH: CriticalSectionMutex<RefCell<Watch>> =
        CriticalSectionMutex::new(RefCell::new(Watch::new()));
    static TABLES: Tables = Tables::new();
    static ORDERS: StaticCell<Orders> = StaticCell::new();
    static QUEUE: StaticCell<[Captured; 2]> = StaticCell::new();
    static CHANNEL: StaticCell<Channel<'static, CriticalSectionRawMutex, Captured>> = StaticCell::new();
    let orders: &'static Orders = ORDERS.init_with(|| Orders::new(&WATCH));
    let queue = QUEUE.init_with(Default::default);
    let (frames, end) = CHANNEL.init_with(|| Channel::new(queue)).split();
    let spawner = executor::start();
    let front_end = FrontEnd::new(sensing, &TABLES);
    spawner.spawn(run(front_end, thermometer, pins, orders, frames).expect("spawned once"));
    (orders, end)
}

/// Runs one scan after the other.
#[embassy_executor::task]
async fn run(
    mut front_end: FrontEnd,
    mut thermometer: Thermometer,
    mut pins: ReflexPins,
    orders: &'static Orders,
    mut frames: Frames,
) -> ! {
    orders.measure(&mut thermometer);
    loop {
        let order = orders.start.wait().await;
        let mut acquisition = orders.acquisition.lock().await;
        if let Some(acquisition) = acquisition.as_mut() {
            let mut run = Run {
                acquisition,
                frames: &mut frames,
                pins: &mut pins,
                orders,
                is_stopping: false,
                missed: false,
            };
            run.scan(&mut front_end, &mut thermometer, order).await;
        }
        // Nobody looks any more.
        orders.with_watch(Watch::blind);
        pins.set(0);
        orders.stopped.signal(());
    }
}

/// One ordered scan.
struct Run<'a> {
    acquisition: &'a mut Acquisition,
    frames: &'a mut Frames,
    pins: &'a mut ReflexPins,
    orders: &'static Orders,
    is_stopping: bool,
    /// Whether samples were lost since the frame before.
    missed: bool,
}

impl Run<'_> {
    async fn scan(&mut self, front_end: &mut FrontEnd, thermometer: &mut Thermometer, order: Order) {
        let frame_time = board::duration_of_samples(self.acquisition.missing_samples());
        let pauses = order.interval > frame_time + SHORTEST_PAUSE;
        let mut due = front_end.choose_range(order.in_small_range);
        loop {
            self.wait_until(due).await;
            if self.is_stopping {
                return;
            }
            due = if pauses { Instant::now() + order.interval } else { Instant::MIN };
            self.acquisition.restart();
            self.orders.measure(thermometer);
            self.orders.flows.store(true, Ordering::Relaxed);
            let scan = front_end.start(self.acquisition, order.share);
            self.follow(scan, frame_time, pauses).await;
            self.orders.flows.store(false, Ordering::Relaxed);
        }
    }

    /// Takes samples until the scan has to stop: for a pause, an order, the thermometer, or samples lost.
    async fn follow(&mut self, mut scan: Scan<'_>, frame_time: Duration, pauses: bool) {
        let end = Instant::now() + TEMPERATURE_AGE;
        while !self.is_stopping() && Instant::now() < end {
            let missing = board::duration_of_samples(self.acquisition.missing_samples());
            // The current rises with each look, and has risen before the first frame ends, which does not count.
            let longest = if scan.is_rising() { frame_time / (RAMP_STEPS + 1) } else { LOOK_INTERVAL };
            Timer::at(scan.looked_at() + wait(missing).min(longest)).await;
            match self.look(&mut scan) {
                Ok(found) if pauses && found > 0 => break,
                Ok(_) => {}
                Err(Missed) => {
                    self.missed = true;
                    break;
                }
            }
        }
        scan.stop().await;
    }

    /// Takes the samples that are there; says how many frames they completed.
    fn look(&mut self, scan: &mut Scan<'_>) -> Result<usize, Missed> {
        let mut found = 0;
        // Only this task counts.
        self.orders.looks.store(self.orders.looks.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
        scan.take(|samples| {
            self.acquisition.push(samples, |frame, scope| {
                found += 1;
                let timestamp_us = Instant::now().as_micros();
                let (reflexes, high) =
                    self.orders.with_watch(|watch| (watch.see(frame, timestamp_us), watch.high_pins()));
                self.pins.set(high);
                let arrival = Arrival { timestamp_us, missed: self.missed, reflexes };
                self.missed = !send(self.frames, frame, scope, arrival);
            });
        })?;
        if self.acquisition.take_gains_changed() {
            scan.set_gains(self.acquisition.gains());
        }
        Ok(found)
    }

    async fn wait_until(&mut self, due: Instant) {
        let stop = self.orders.stop.wait();
        self.is_stopping |= matches!(select(stop, Timer::at(due)).await, Either::First(()));
    }

    fn is_stopping(&mut self) -> bool {
        self.is_stopping |= self.orders.stop.try_take().is_some();
        self.is_stopping
    }
}

/// Time to the next look, where samples of this duration are missing in a frame.
fn wait(missing: Duration) -> Duration {
    if missing <= 2 * LAST_LOOK {
        // A little more, so that the last sample is there.
        missing + Duration::from_micros(2)
    } else {
        (missing - LAST_LOOK).min(LOOK_INTERVAL)
    }
}

/// Sends a frame on; one that nobody has time for is lost, which this says.
fn send(frames: &mut Frames, frame: &Frame, scope: Option<&SlotSamples>, arrival: Arrival) -> bool {
    let Some(place) = frames.try_send() else { return false };
    place.frame.copy_from(frame);
    match scope {
        Some(samples) => place.scope = Some(samples.clone()),
        // Not one assignment for both, which would copy a kilobyte of nothing.
        None => place.scope = None,
    }
    place.arrival = arrival;
    frames.send_done();
    true
}
