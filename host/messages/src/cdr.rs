//! CDR: messages as bytes, little-endian, as ROS 2 encodes them (OMG DDSI-RTPS 2.3, section 10; XCDR1).

use byteorder::LittleEndian;
use serde::{Serialize, de::DeserializeOwned};

/// What stands before each message: plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Bytes that are not the message they should be.
#[derive(Debug, thiserror::Error)]
pub enum CdrError {
    /// Another encoding.
    #[error("it begins with {0:02x?}; allowed: 00 01 00 00, CDR in little-endian order")]
    Encapsulation(Vec<u8>),
    /// Too short, or a text that is none.
    #[error("it is not a message of its type: {0}")]
    Content(#[from] cdr_encoding::Error),
}

/// A message as bytes.
#[must_use]
pub fn encode(message: &impl Serialize) -> Vec<u8> {
    let mut bytes = ENCAPSULATION.to_vec();
    // Plain numbers, texts and lists of them, into memory: none of it can fail.
    let content = cdr_encoding::to_vec::<_, LittleEndian>(message).unwrap_or_default();
    bytes.extend_from_slice(&content);
    bytes
}

/// The message in some bytes.
pub fn decode<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, CdrError> {
    let Some(content) = bytes.strip_prefix(&ENCAPSULATION) else {
        return Err(CdrError::Encapsulation(bytes[..bytes.len().min(4)].to_vec()));
    };
    let (message, _) = cdr_encoding::from_bytes::<M, LittleEndian>(content)?;
    Ok(message)
}
