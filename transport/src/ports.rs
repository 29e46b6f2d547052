//! The service and the ports of a topic.

use iceoryx2::prelude::{Node, ipc};

use super::publisher::{self, Sender, SenderOptions};
use super::service::{self, Limits, TopicHolder, TopicIdentity};
use super::subscriber::{self, Receiver};
use crate::error::BusError;
use crate::message::Message;
use crate::stamp::Header;

type Create = fn(&Node<ipc::Service>, &TopicIdentity<'_>, &Limits) -> Result<TopicHolder, BusError>;
type OpenSender<H, E> = fn(
    &Node<ipc::Service>,
    &TopicIdentity<'_>,
    SenderOptions,
) -> Result<Box<dyn Sender<H, E>>, BusError>;
type OpenReceiver<H, E> =
    fn(&Node<ipc::Service>, &TopicIdentity<'_>, usize) -> Result<Box<dyn Receiver<H, E>>, BusError>;

/// Creates the service and the ports of a topic with header `H` and elements `E`. As a `static` it
/// is compiled in the crate that declares the topic.
#[derive(Debug)]
pub struct Ports<H: Header, E: Message> {
    /// Creates the service.
    pub create: Create,
    /// Opens it as a sender.
    pub publisher: OpenSender<H, E>,
    /// Opens it as a receiver with a buffer of this many messages.
    pub subscriber: OpenReceiver<H, E>,
}

impl<H: Header, E: Message> Ports<H, E> {
    /// The ports of a topic.
    #[allow(clippy::new_without_default)]
    pub const fn new() -> Self {
        Self {
            create: service::create::<H, E>,
            publisher: publisher::open::<H, E>,
            subscriber: subscriber::open::<H, E>,
        }
    }
}
