//! Every message of Protean, every topic and its quality of service, and the iceoryx2 bus that
//! opens them. Knows nothing of who sends or receives.
//!
//! * [`mod@message`]: how a message type is defined, and what is proved about it at compile time;
//! * [`messages`]: the messages; [`stamp`]: what stands first in each;
//! * [`topics`]: the topics with their quality of service;
//! * [`bus`]: publishers, subscribers, request–response and events of one isolated run;
//! * [`transport`]: what iceoryx2 does for it;
//! * [`schema`], [`cdr`]: how logs and other languages see them;
//! * [`consumer`]: what takes the messages of a run in order, from the bus or from a log.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod bus;
pub mod cdr;
pub mod clock;
pub mod consumer;
mod error;
pub mod message;
pub mod messages;
pub mod python;
pub mod schema;
pub mod stamp;
pub mod topics;
pub mod transport;
