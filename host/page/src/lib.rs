//! The page of `dermatome view`, and what it looks at: a server of the Foxglove WebSocket protocol on the same port.
//!
//! A [`dermatome_messages::Packed`] message -> [`Speaker::publish`] -> the outbox of each client that subscribes to its
//! topic -> the client, ours or another program (Foxglove, Lichtblick). What clients ask for comes as [`Call`]s.
//!
//! Who may come in is decided at the [`gate`]: this computer alone unless a token is set, and of browsers no page but our
//! own. That is why the server is not the one of the crate `foxglove`, which shows neither origin nor token to its user.
#![forbid(unsafe_code)]

mod assets;
mod client;
mod foxglove;
pub mod gate;
mod http;
mod outbox;
mod room;
mod server;

pub use foxglove::Service;
pub use room::Call;
pub use server::{Options, Server, ServerError, Speaker};
