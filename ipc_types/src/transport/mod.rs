//! iceoryx2: the implementation of the bus between processes.
//!
//! iceoryx2 is generic over services and messages. A crate that opens, uses or drops one of its
//! ports compiles all of it again, about 700 kB of machine code. So it is compiled only here: ports
//! are trait objects, and every topic and service declares [`Ports`] or [`ExchangePorts`] as a
//! `static`, which refers to the code for its messages.

mod agreement;
mod degradation;
mod event;
mod exchange;
mod node;
mod ports;
mod publisher;
pub(crate) mod raw;
mod run_space;
mod service;
mod subscriber;

pub use event::{Listener, Notifier};
pub use exchange::ExchangePorts;
pub use node::{TransportConfig, quiet_transport};
pub use ports::Ports;
pub use run_space::{MemoryUse, RunSpace};
pub use service::TopicHolder;

pub(crate) use event::create as create_event;
pub(crate) use exchange::{Active, Answer, Client, Pending, Server};
pub(crate) use node::{Home, join};
pub(crate) use publisher::{Sender, SenderOptions};
pub(crate) use service::{Agreed, Limits};
pub(crate) use subscriber::{Loan, Receiver};
