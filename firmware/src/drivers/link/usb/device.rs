//! Device: answers what a host asks of any USB device (USB 2.0, chapter 9) and of a serial port (PSTN 1.2, 6.3).
//!
//! embassy-usb does it too, but with it the firmware does not fit its part of the flash, by 3 KB.
//!
//! Whatever happens on the bus ends a request that is under way, wherever it is: after a reset, the host begins anew.

use embassy_futures::select::{Either, select};
use embassy_usb_driver::{Bus, ControlPipe, EndpointError, Event};

use super::{
    BUS_PACKET_BYTES, Presence,
    descriptors::{self, FROM_HOST, NOTIFICATIONS, TO_HOST},
};
use crate::board;

const ENDPOINTS: [u8; 3] = [NOTIFICATIONS, FROM_HOST, TO_HOST];
/// `wValue` of a feature: the endpoint is halted.
const ENDPOINT_HALT: u16 = 0;

/// Serves the host's requests for ever.
pub(super) async fn serve(mut bus: impl Bus, mut pipe: impl ControlPipe, presence: &Presence) -> ! {
    let [a, b, c, d] = 115_200_u32.to_le_bytes();
    let mut device =
        Device { presence, is_configured: false, line_coding: [a, b, c, d, 0, 0, 8], text: [0; _] };
    loop {
        if let Err(event) = device.serve_request(&mut bus, &mut pipe).await {
            device.take(event);
        }
    }
}

struct Device<'a> {
    presence: &'a Presence,
    is_configured: bool,
    /// Rate, stop bits, parity and data bits, which mean nothing here.
    line_coding: [u8; 7],
    /// An answer that is made as it is asked for.
    text: [u8; BUS_PACKET_BYTES],
}

/// What a host asks, in the words of the standard.
struct Setup {
    /// `bmRequestType` and `bRequest`.
    what: [u8; 2],
    value: u16,
    index: u16,
    length: u16,
}

/// What comes of it.
enum Answer<'a> {
    Data(&'a [u8]),
    Done,
    Address(u8),
    Refused,
}

impl Setup {
    fn new([kind, request, value @ .., i, j, m, n]: [u8; 8]) -> Self {
        let [value, index, length] = [value, [i, j], [m, n]].map(u16::from_le_bytes);
        Self { what: [kind, request], value, index, length }
    }

    fn asks_for_data(&self) -> bool {
        self.what[0] & 0x80 != 0
    }
}

/// Waits for what is under way, unless something happens on the bus.
async fn unless_event<T>(bus: &mut impl Bus, what: impl Future<Output = T>) -> Result<T, Event> {
    match select(bus.poll(), what).await {
        Either::First(event) => Err(event),
        Either::Second(result) => Ok(result),
    }
}

impl Device<'_> {
    async fn serve_request(&mut self, bus: &mut impl Bus, pipe: &mut impl ControlPipe) -> Result<(), Event> {
        let setup = Setup::new(unless_event(bus, pipe.setup()).await?);
        let wanted = usize::from(setup.length);
        let mut data = [0; 7];
        if !setup.asks_for_data() && wanted > 0 {
            let Some(place) = data.get_mut(..wanted) else {
                return unless_event(bus, pipe.reject()).await;
            };
            match unless_event(bus, pipe.data_out(place, true, true)).await? {
                Ok(length) if length == wanted => {}
                // There is another request.
                Err(EndpointError::Disabled) => return Ok(()),
                _ => return unless_event(bus, pipe.reject()).await,
            }
        }
        match self.answer(bus, &setup, &data[..wanted.min(data.len())]) {
            Answer::Data(data) if wanted > 0 => {
                // None has a multiple of a packet's bytes and is shorter than what is asked for, which would take an empty packet.
                let data = &data[..wanted.min(data.len())];
                for (number, packet) in data.chunks(BUS_PACKET_BYTES).enumerate() {
                    let is_last = (number + 1) * BUS_PACKET_BYTES >= data.len();
                    if unless_event(bus, pipe.data_in(packet, number == 0, is_last)).await?.is_err() {
                        break;
                    }
                }
                Ok(())
            }
            Answer::Data(_) | Answer::Done => unless_event(bus, pipe.accept()).await,
            Answer::Address(address) => unless_event(bus, pipe.accept_set_address(address)).await,
            Answer::Refused => unless_event(bus, pipe.reject()).await,
        }
    }

    fn answer(&mut self, bus: &mut impl Bus, setup: &Setup, data: &[u8]) -> Answer<'_> {
        let [value, kind] = setup.value.to_le_bytes();
        let endpoint = setup.index as u8;
        let has_endpoint = self.is_configured && ENDPOINTS.contains(&endpoint);
        let has_interface = self.is_configured && setup.index < 2;
        match setup.what {
            // GET_STATUS of the device, which supplies itself; of an interface; of an endpoint.
            [0x80, 0] => Answer::Data(&[1, 0]),
            [0x81, 0] if has_interface => Answer::Data(&[0, 0]),
            [0x82, 0] if has_endpoint && bus.endpoint_is_stalled(endpoint.into()) => Answer::Data(&[1, 0]),
            [0x82, 0] if has_endpoint || endpoint & 0x7F == 0 => Answer::Data(&[0, 0]),
            // CLEAR_FEATURE, SET_FEATURE
            [0x02, 1] if has_endpoint && setup.value == ENDPOINT_HALT => {
                begin_anew(bus, endpoint);
                Answer::Done
            }
            [0x02, 3] if has_endpoint && setup.value == ENDPOINT_HALT => {
                bus.endpoint_set_stalled(endpoint.into(), true);
                Answer::Done
            }
            // SET_ADDRESS
            [0x00, 5] if setup.value < 128 => Answer::Address(value),
            // GET_DESCRIPTOR
            [0x80, 6] => self.describe(kind, value),
            // GET_CONFIGURATION, SET_CONFIGURATION
            [0x80, 8] => Answer::Data(if self.is_configured { &[1] } else { &[0] }),
            [0x00, 9] if setup.value < 2 => {
                self.configure(bus, value == 1);
                Answer::Done
            }
            // GET_INTERFACE, SET_INTERFACE: each has one setting.
            [0x81, 10] if has_interface => Answer::Data(&[0]),
            [0x01, 11] if has_interface && setup.value == 0 => {
                let (first, second) = ENDPOINTS.split_at(1);
                for &endpoint in if setup.index == 0 { first } else { second } {
                    begin_anew(bus, endpoint);
                }
                Answer::Done
            }
            // SET_LINE_CODING, GET_LINE_CODING, SET_CONTROL_LINE_STATE, to the interface for control
            [0x21, 0x20] if has_interface && data.len() == self.line_coding.len() => {
                self.line_coding.copy_from_slice(data);
                Answer::Done
            }
            [0xA1, 0x21] if has_interface => Answer::Data(&self.line_coding),
            [0x21, 0x22] if has_interface => {
                self.presence.set_data_terminal_ready(value & 1 != 0);
                Answer::Done
            }
            _ => Answer::Refused,
        }
    }

    fn describe(&mut self, kind: u8, number: u8) -> Answer<'_> {
        match (kind, number) {
            (1, 0) => Answer::Data(&descriptors::DEVICE),
            (2, 0) => Answer::Data(&descriptors::CONFIGURATION),
            (3, 0) => Answer::Data(&descriptors::LANGUAGES),
            (3, _) => match descriptors::string(number, &mut self.text) {
                Some(descriptor) => Answer::Data(descriptor),
                None => Answer::Refused,
            },
            // A device that knows no high speed has no qualifier.
            _ => Answer::Refused,
        }
    }

    fn configure(&mut self, bus: &mut impl Bus, is_configured: bool) {
        self.is_configured = is_configured;
        self.presence.end_session();
        for endpoint in ENDPOINTS {
            bus.endpoint_set_enabled(endpoint.into(), is_configured);
            board::begin_with_data0(endpoint);
        }
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Reset => {
                self.is_configured = false;
                self.presence.end_session();
                self.presence.sleeps.set(false);
            }
            // Where both have happened, they do not come in order.
            Event::Suspend | Event::Resume => self.presence.sleeps.set(board::host_sleeps()),
            Event::PowerDetected | Event::PowerRemoved => {}
        }
    }
}

/// Ends a halt of an endpoint. Without one, what waits there still goes out.
fn begin_anew(bus: &mut impl Bus, endpoint: u8) {
    if bus.endpoint_is_stalled(endpoint.into()) {
        // embassy-stm32 ends a halt no other way.
        bus.endpoint_set_enabled(endpoint.into(), false);
        bus.endpoint_set_enabled(endpoint.into(), true);
    }
    board::begin_with_data0(endpoint);
}
