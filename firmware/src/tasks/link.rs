//! Link task: reads requests, lets the device answer them, sends the replies.
//!
//! Nothing that comes over the line ends this task. A packet that is damaged or unknown is
//! dropped with a warning, and the host's time-out does the rest. After an error of the line
//! itself the link is opened anew.

use core::convert::Infallible;

use defmt::{Debug2Format, warn};
use dermatome_shared::{
    device::Device,
    protocol::{self, Identity, MAX_PACKET_BYTES, PacketReader, RequestPacket},
};
use embassy_stm32::usart::Error;
use embassy_time::{Duration, Timer};
use heapless::String;
use static_cell::{ConstStaticCell, StaticCell};

use crate::{
    board::{self, LinkParts},
    drivers::{
        flash_store::FlashStore,
        link::{Link, LinkPort, RING_BYTES},
    },
};

/// How long a failed link rests: the last reply leaves the UART (9 bytes, 0.1 ms), and a line
/// with endless errors cannot take the whole CPU.
const REOPEN_PAUSE: Duration = Duration::from_millis(2);

/// What answers the host. Its parts are too big for the stack.
struct Session {
    device: &'static mut Device<FlashStore>,
    reader: &'static mut PacketReader,
    outgoing: &'static mut [u8; MAX_PACKET_BYTES],
}

impl Session {
    /// The one session. Can be called once.
    fn take() -> Self {
        static DEVICE: StaticCell<Device<FlashStore>> = StaticCell::new();
        static READER: StaticCell<PacketReader> = StaticCell::new();
        static OUTGOING: ConstStaticCell<[u8; MAX_PACKET_BYTES]> =
            ConstStaticCell::new([0; MAX_PACKET_BYTES]);
        let identity = Identity { board: text(board::NAME), firmware: text(env!("CARGO_PKG_VERSION")) };
        Self {
            device: DEVICE.init_with(|| Device::new(identity, board::ELECTRODES, FlashStore)),
            reader: READER.init_with(PacketReader::default),
            outgoing: OUTGOING.take(),
        }
    }

    /// Takes one received byte; gives the packet to send where it completes a request.
    fn push(&mut self, byte: u8) -> Option<&[u8]> {
        match self.reader.push::<RequestPacket>(byte)? {
            Ok(request) => {
                let reply = self.device.handle(&request);
                protocol::encode(&reply, self.outgoing)
                    .inspect_err(|error| warn!("reply not sent: {}", Debug2Format(error)))
                    .ok()
            }
            Err(error) => {
                warn!("packet dropped: {}", Debug2Format(&error));
                None
            }
        }
    }

    /// Forgets a packet whose rest is lost, so that the next one starts clean.
    fn forget_partial_packet(&mut self) {
        let _ = self.reader.push::<RequestPacket>(0);
    }
}

/// A text known at build time, in the protocol's form.
fn text<const N: usize>(text: &str) -> String<N> {
    text.try_into().expect("names and versions fit their fields")
}

/// Serves the host for ever.
#[embassy_executor::task]
pub(crate) async fn run(parts: LinkParts) -> ! {
    static RING: ConstStaticCell<[u8; RING_BYTES]> = ConstStaticCell::new([0; RING_BYTES]);
    let mut session = Session::take();
    let mut port = LinkPort::new(parts, RING.take());
    loop {
        let mut link = port.open();
        let Err(error) = serve(&mut link, &mut session).await;
        warn!("link: {}; opening it anew", error);
        Timer::after(REOPEN_PAUSE).await;
        session.forget_partial_packet();
    }
}

/// Serves the host until the line fails.
async fn serve(link: &mut Link<'_>, session: &mut Session) -> Result<Infallible, Error> {
    let mut chunk = [0; 64];
    loop {
        let length = link.read(&mut chunk).await?;
        for &byte in &chunk[..length] {
            if let Some(packet) = session.push(byte) {
                link.write(packet).await?;
            }
        }
    }
}
