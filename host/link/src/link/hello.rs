//! Hello: board and host check that they understand each other.

use super::wire::Wire;
use crate::error::{LinkError, LinkErrorKind};
use dermatome_shared::protocol::{BoardPacket, Identity, Refusal, Reply, Request, RequestPacket, Version};
use std::time::Duration;

/// Only Hello carries this number.
pub(super) const HELLO_SEQUENCE: u16 = 0;
/// Hello is sent again after this time: a board may have been starting when the first one came.
const HELLO_TIMEOUT: Duration = Duration::from_secs(1);
const HELLO_ATTEMPTS: u32 = 2;

/// Ends any line noise with a zero byte, then says hello; gives who the board is.
pub(super) fn hello(wire: &mut Wire) -> Result<Identity, LinkError> {
    wire.send_bytes(&[0])?;
    let request = RequestPacket { sequence: HELLO_SEQUENCE, request: Request::Hello(Version::current()) };
    for _ in 0..HELLO_ATTEMPTS {
        wire.send(&request)?;
        let deadline = wire.time() + HELLO_TIMEOUT;
        while let Some(packet) = wire.receive(deadline)? {
            if let BoardPacket::Reply { sequence: HELLO_SEQUENCE, reply } = packet {
                return check(reply).map_err(|kind| wire.error(kind));
            }
        }
    }
    Err(wire.no_answer(HELLO_TIMEOUT * HELLO_ATTEMPTS, 0))
}

fn check(reply: Reply) -> Result<Identity, LinkErrorKind> {
    let host = Version::current();
    match reply {
        Reply::Hello { version, .. } if version.protocol != host.protocol => {
            Err(LinkErrorKind::ProtocolVersion { board: version.protocol })
        }
        Reply::Hello { version, identity } if version.schema != host.schema => Err(LinkErrorKind::Schema {
            firmware: identity.firmware.to_string(),
            board: version.schema,
            host: host.schema,
        }),
        Reply::Hello { identity, .. } => Ok(identity),
        Reply::Refused(Refusal::Version { board }) => Err(LinkErrorKind::ProtocolVersion { board }),
        Reply::Refused(refusal) => Err(LinkErrorKind::Refused(refusal)),
        _ => Err(LinkErrorKind::WrongReply { request: "Hello" }),
    }
}
