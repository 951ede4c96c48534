//! Health task: feeds the watchdog, says how the board itself is, and notices that a host has gone.
//!
//! It runs on the executor that all but the acquisition share, so a task that does not yield starves it,
//! and the watchdog resets the chip. So it does where current flows and the acquisition does not look at
//! samples. The longest that a task rightly keeps the executor is the check of a whole patch and the erasure
//! of a page, some tens of milliseconds each.

use dermatome_firmware::drivers::vitals::VitalSigns;
use dermatome_shared::health::Vitals;
use embassy_stm32::{Peri, peripherals, wdg::IndependentWatchdog};
use embassy_time::{Duration, Instant, Timer};

use super::{State, acquire::Orders};

/// How long the board may hang. The watchdog's own clock is off by up to a tenth.
const TIMEOUT_US: u32 = 1_000_000;
const FEEDING_INTERVAL: Duration = Duration::from_millis(200);

/// Feeds the watchdog for ever.
#[embassy_executor::task]
pub(crate) async fn run(
    watchdog: Peri<'static, peripherals::IWDG>,
    mut signs: VitalSigns,
    state: &'static State,
    orders: &'static Orders,
) -> ! {
    let mut watchdog = IndependentWatchdog::new(watchdog, TIMEOUT_US);
    watchdog.unleash();
    let mut seen = None;
    loop {
        let looks = orders.looks();
        if looks.is_none() || looks != core::mem::replace(&mut seen, looks) {
            watchdog.pet();
        }
        let host_has_gone = {
            let mut device = state.device.borrow_mut();
            device.set_vitals(Vitals {
                temperature: orders.temperature(),
                load: signs.load(),
                free_stack: signs.free_stack(),
            });
            device.check_host(Instant::now().as_millis())
        };
        if host_has_gone {
            // As after an answer: what frames are needed for has changed.
            state.answered.signal(());
        }
        Timer::after(FEEDING_INTERVAL).await;
    }
}
