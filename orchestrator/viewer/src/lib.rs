//! A run as it happens, for Foxglove and Lichtblick: what goes into the log goes to viewers that
//! have connected as well, over the Foxglove `WebSocket` protocol.
//!
//! * [`LiveServer`] listens on the loopback address and answers for everybody who connects;
//! * the tap of its [`Hub`] mirrors the log: same topics, same schemas, same bytes, same times;
//! * `door` decides who comes in, `wire` is the protocol, `client` one viewer and its thread.
//!
//! The server only sends. It offers the capability `time` and nothing else, so that a viewer can
//! neither publish nor change parameters, call services or move the time; whatever it sends besides
//! subscriptions is not even looked at. The run never waits for a viewer: who cannot keep up is
//! left out of messages, which are counted, and who takes nothing at all is cut off.
//!
//! The `foxglove` crate has a server too. It lets anybody in who can reach the port, every page of
//! the web in a browser on this machine included; what could be put in front of it would leave its
//! own port open. So the handshake is ours, and the messages are still that crate's.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod client;
mod door;
mod error;
mod hub;
mod server;
mod wire;

pub use error::LiveError;
pub use hub::{Hub, HubTap, LiveTotals};
pub use server::LiveServer;
