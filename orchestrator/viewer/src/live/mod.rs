//! Live viewers, over the Foxglove `WebSocket` protocol, and the page of the run for a browser.
//!
//! * [`LiveServer`] listens on the loopback address and serves all viewers that connect;
//! * the handle of its [`Broadcaster`] observes a log: same topics, schemas, bytes and times;
//! * `request` reads what a connection asks for, `handshake` accepts or refuses it; `wire` encodes the protocol,
//!   `client` serves one viewer on its thread;
//! * `browser` serves the page of the report, with data that grow with the log: `page` reads the log, not the messages of
//!   the run, and only while a page is open.
//!
//! The server only sends, unless its caller lets pages control the run: `control` keeps what they ask for, and the run asks
//! it. It offers the capability `time` only, so that a viewer can neither publish nor change parameters, call services or set
//! the time; the server ignores all messages of viewers except subscriptions. The run never waits for a viewer: the server drops messages for a slow viewer, counts them,
//! and disconnects a viewer that does not read.
//!
//! The `foxglove` crate also has a server, but it accepts every connection to the port, including those of
//! web pages in a browser on this machine; a proxy in front of it would leave its port open. The project
//! therefore implements the handshake, and uses the messages of that crate.

mod admission;
mod broadcaster;
mod browser;
mod client;
mod control;
mod error;
mod handshake;
mod page;
mod request;
mod server;
mod what_if;
mod wire;

pub use broadcaster::{BroadcastHandle, Broadcaster, LiveTotals};
pub use control::{Control, Wish};
pub use error::LiveError;
pub use server::{LiveOptions, LiveServer};
