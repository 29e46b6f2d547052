//! All messages of Protean, all topics with their quality of service, and the iceoryx2 bus that
//! opens them. This crate does not depend on the processes that send or receive.
//!
//! * [`mod@message`]: definition of message types, with proofs at compile time;
//! * [`messages`]: the messages; [`stamp`]: the first field of each;
//! * [`topics`]: the topics with their quality of service;
//! * [`bus`]: publishers, subscribers, request–response and events of one isolated run;
//! * [`transport`]: the parts of the bus that use iceoryx2;
//! * [`schema`], [`cdr`]: the messages in logs;
//! * [`layout`]: topics that a program declares while it runs; [`marks`]: the drawn elements of messages;
//! * [`consumer`]: consumers of the messages of a run in order, from the bus or from a log;
//! * [`event_names`]: events in words.

// The macros name the crate as others do.
extern crate self as ipc_types;

pub mod bus;
pub mod cdr;
pub mod consumer;
pub mod event_names;
pub mod layout;
pub mod marks;
pub mod messages;
pub mod schema;
pub mod topics;

pub use ::transport;
pub use ::transport::{clock, headers, message, stamp};
