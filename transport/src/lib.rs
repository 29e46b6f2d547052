//! Definition of messages, and iceoryx2: the part of the bus that lies between processes. It knows no topic.
//!
//! * [`mod@message`]: definition of message types, with proofs at compile time;
//! * [`stamp`]: the first field of each header; [`clock`]: its times;
//! * [`Ports`], [`ExchangePorts`]: the ports of topics and services; [`raw`]: those of topics that a program declares
//!   while it runs;
//! * [`RunSpace`]: the files and memory of one isolated run.
//!
//! iceoryx2 is generic over services and messages. A crate that opens, uses or drops one of its
//! ports compiles all of it again, about 700 kB of machine code. So it is compiled only here: ports
//! are trait objects, and every topic and service declares [`Ports`] or [`ExchangePorts`] as a
//! `static`, which refers to the code for its messages.

// The macros name the crate whose users declare messages.
extern crate self as ipc_types;

mod agreement;
pub mod clock;
mod debug;
mod degradation;
pub mod error;
mod event;
mod exchange;
pub mod message;
mod node;
mod ports;
mod publisher;
pub mod raw;
mod run_space;
mod service;
pub mod stamp;
mod subscriber;

pub use event::{Listener, Notifier};
pub use exchange::ExchangePorts;
pub use node::{TransportConfig, quiet_transport};
pub use ports::Ports;
pub use run_space::{MemoryUse, RunSpace};
pub use service::TopicHolder;

pub use event::create as create_event;
pub use exchange::{Active, Answer, Client, PendingRequest, Server};
pub use node::{Home, join};
pub use publisher::{Sender, SenderOptions};
pub use service::{Limits, TopicIdentity};
pub use subscriber::{Loan, Receiver};
