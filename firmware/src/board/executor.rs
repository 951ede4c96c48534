//! Executor: an interrupt that nothing else uses, for tasks that must not wait for those that compute.

use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_stm32::interrupt::{
    InterruptExt, Priority,
    typelevel::{Handler, Interrupt},
};

use super::AcquisitionInterrupt;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// Runs what is due; the board binds it to its interrupt.
pub struct InterruptHandler;

impl Handler<AcquisitionInterrupt> for InterruptHandler {
    #[expect(unsafe_code, reason = "an interrupt handler of an executor")]
    unsafe fn on_interrupt() {
        // SAFETY: this is the interrupt that the executor is started with.
        unsafe { EXECUTOR.on_interrupt() }
    }
}

/// For more tasks, once the executor has been started.
pub fn spawner() -> SendSpawner {
    EXECUTOR.spawner()
}

/// Starts the executor. Can be called once.
pub fn start() -> SendSpawner {
    // Below the timer and the DMA, above everything that computes.
    AcquisitionInterrupt::IRQ.set_priority(Priority::P6);
    EXECUTOR.start(AcquisitionInterrupt::IRQ)
}
