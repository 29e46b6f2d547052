//! Request–response services.

use iceoryx2::prelude::{Node, ipc};
use iceoryx2::service::port_factory::request_response::PortFactory;

use super::agreement;
use super::degradation::Failures;
use super::service::{TopicHolder, TopicIdentity, service_name};
use crate::clock::monotonic_ns;
use crate::error::{BusError, ReceiveError, SendError};
use crate::message::Message;
use crate::stamp::Header;

/// Maximum number of open requests per client.
const OPEN_REQUESTS: usize = 4;

/// Header and elements of an answer, copied from shared memory.
pub type Answer<AH, AE> = (AH, Vec<AE>);

/// Client side of a service with request header `QH`, request elements `QE`, answer header `AH` and
/// answer elements `AE`.
pub trait Client<QH, QE, AH, AE> {
    /// Sends a request.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    fn ask(
        &self,
        header: QH,
        elements: &[QE],
    ) -> Result<Box<dyn PendingRequest<AH, AE>>, SendError>;
}

/// A request that waits for its answer; dropping it cancels the request.
pub trait PendingRequest<AH, AE> {
    /// The answer, if it has arrived.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    fn poll(&self) -> Result<Option<Answer<AH, AE>>, ReceiveError>;

    /// Returns `true` if a server still works on it.
    fn is_open(&self) -> bool;
}

/// Server side.
pub trait Server<QH, QE, AH, AE> {
    /// The next request, if any.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    #[allow(clippy::type_complexity)]
    fn receive(&self) -> Result<Option<Box<dyn Active<QH, QE, AH, AE>>>, ReceiveError>;
}

/// A request in progress; dropping it ends the exchange.
pub trait Active<QH, QE, AH, AE> {
    /// Header of the request.
    fn header(&self) -> &QH;

    /// Elements of the request.
    fn elements(&self) -> &[QE];

    /// Returns `true` if the client still waits.
    fn is_wanted(&self) -> bool;

    /// Sends the answer; the stamp gets the time of sending.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    fn answer(&self, header: AH, elements: &[AE]) -> Result<(), SendError>;
}

type PortCreator = fn(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    clients: usize,
    nodes: usize,
) -> Result<TopicHolder, BusError>;
type PortOpener<P> = fn(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    capacity: usize,
) -> Result<P, BusError>;

/// Creates a service and its ports. As a `static` it is compiled in the crate that declares the
/// service.
#[derive(Debug)]
pub struct ExchangePorts<QH: Header, QE: Message, AH: Header, AE: Message> {
    /// Creates the service.
    pub create: PortCreator,
    /// Opens it as a client.
    pub client: PortOpener<Box<dyn Client<QH, QE, AH, AE>>>,
    /// Opens it as the server.
    pub server: PortOpener<Box<dyn Server<QH, QE, AH, AE>>>,
}

impl<QH: Header, QE: Message, AH: Header, AE: Message> ExchangePorts<QH, QE, AH, AE> {
    /// The ports of a service.
    #[allow(clippy::new_without_default)]
    pub const fn new() -> Self {
        Self {
            create: create::<QH, QE, AH, AE>,
            client: open_client::<QH, QE, AH, AE>,
            server: open_server::<QH, QE, AH, AE>,
        }
    }
}

fn create<QH: Header, QE: Message, AH: Header, AE: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    clients: usize,
    nodes: usize,
) -> Result<TopicHolder, BusError> {
    let topic = agreed.topic;
    let failed = |reason: String| BusError::Create { topic, reason };
    let attributes = agreement::define(topic, agreed.schema)?;
    let service = node
        .service_builder(&service_name(topic)?)
        .request_response::<[QE], [AE]>()
        .request_user_header::<QH>()
        .response_user_header::<AH>()
        .max_active_requests_per_client(OPEN_REQUESTS)
        .max_servers(1)
        .max_clients(clients)
        .max_nodes(nodes)
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(TopicHolder::new(topic, service))
}

type Factory<QH, QE, AH, AE> = PortFactory<ipc::Service, [QE], QH, [AE], AH>;

fn open<QH: Header, QE: Message, AH: Header, AE: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
) -> Result<Factory<QH, QE, AH, AE>, BusError> {
    let topic = agreed.topic;
    let failed = |reason: String| BusError::Open { topic, reason };
    let verifier = agreement::require(topic, agreed.schema)?;
    node.service_builder(&service_name(topic)?)
        .request_response::<[QE], [AE]>()
        .request_user_header::<QH>()
        .response_user_header::<AH>()
        .open_with_attributes(&verifier)
        .map_err(|e| failed(format!("{e:?} (this process: schema {})", agreed.schema)))
}

fn open_client<QH: Header, QE: Message, AH: Header, AE: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    capacity: usize,
) -> Result<Box<dyn Client<QH, QE, AH, AE>>, BusError> {
    let topic = agreed.topic;
    let failures = Failures::default();
    let created = open::<QH, QE, AH, AE>(node, agreed)?
        .client_builder()
        .initial_max_slice_len(capacity)
        .set_request_degradation_handler(failures.handler())
        .set_response_degradation_handler(failures.handler())
        .create();
    let port = failures.checked(topic, "client", created)?;
    Ok(Box::new(NamedPort { topic, port }))
}

fn open_server<QH: Header, QE: Message, AH: Header, AE: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    capacity: usize,
) -> Result<Box<dyn Server<QH, QE, AH, AE>>, BusError> {
    let topic = agreed.topic;
    let failures = Failures::default();
    let created = open::<QH, QE, AH, AE>(node, agreed)?
        .server_builder()
        .initial_max_slice_len(capacity)
        .set_request_degradation_handler(failures.handler())
        .set_response_degradation_handler(failures.handler())
        .create();
    let port = failures.checked(topic, "server", created)?;
    Ok(Box::new(NamedPort { topic, port }))
}

/// A port with the name of its service, for errors.
struct NamedPort<P> {
    topic: &'static str,
    port: P,
}

impl<P> NamedPort<P> {
    fn not_sent(&self, reason: String) -> SendError {
        SendError::Transport {
            topic: self.topic,
            reason,
        }
    }

    fn not_received(&self, reason: String) -> ReceiveError {
        ReceiveError::Transport {
            topic: self.topic,
            reason,
        }
    }
}

type ClientPort<QH, QE, AH, AE> = iceoryx2::port::client::Client<ipc::Service, [QE], QH, [AE], AH>;
type PendingPort<QH, QE, AH, AE> =
    iceoryx2::pending_response::PendingResponse<ipc::Service, [QE], QH, [AE], AH>;
type ServerPort<QH, QE, AH, AE> = iceoryx2::port::server::Server<ipc::Service, [QE], QH, [AE], AH>;
type ActivePort<QH, QE, AH, AE> =
    iceoryx2::active_request::ActiveRequest<ipc::Service, [QE], QH, [AE], AH>;

impl<QH: Header, QE: Message, AH: Header, AE: Message> Client<QH, QE, AH, AE>
    for NamedPort<ClientPort<QH, QE, AH, AE>>
{
    fn ask(
        &self,
        header: QH,
        elements: &[QE],
    ) -> Result<Box<dyn PendingRequest<AH, AE>>, SendError> {
        let mut request = self
            .port
            .loan_slice_uninit(elements.len())
            .map_err(|e| self.not_sent(format!("cannot loan memory: {e:?}")))?;
        *request.user_header_mut() = header;
        let port = request
            .write_from_slice(elements)
            .send()
            .map_err(|e| self.not_sent(format!("{e:?}")))?;
        let topic = self.topic;
        Ok(Box::new(NamedPort { topic, port }))
    }
}

impl<QH: Header, QE: Message, AH: Header, AE: Message> PendingRequest<AH, AE>
    for NamedPort<PendingPort<QH, QE, AH, AE>>
{
    fn poll(&self) -> Result<Option<Answer<AH, AE>>, ReceiveError> {
        let response = self.port.receive();
        response
            .map(|response| response.map(|r| (*r.user_header(), r.payload().to_vec())))
            .map_err(|e| self.not_received(format!("{e:?}")))
    }

    fn is_open(&self) -> bool {
        self.port.is_connected()
    }
}

impl<QH: Header, QE: Message, AH: Header, AE: Message> Server<QH, QE, AH, AE>
    for NamedPort<ServerPort<QH, QE, AH, AE>>
{
    fn receive(&self) -> Result<Option<Box<dyn Active<QH, QE, AH, AE>>>, ReceiveError> {
        let request = self.port.receive();
        let request = request.map_err(|e| self.not_received(format!("{e:?}")))?;
        let topic = self.topic;
        Ok(request
            .map(|port| -> Box<dyn Active<QH, QE, AH, AE>> { Box::new(NamedPort { topic, port }) }))
    }
}

impl<QH: Header, QE: Message, AH: Header, AE: Message> Active<QH, QE, AH, AE>
    for NamedPort<ActivePort<QH, QE, AH, AE>>
{
    fn header(&self) -> &QH {
        self.port.user_header()
    }

    fn elements(&self) -> &[QE] {
        self.port.payload()
    }

    fn is_wanted(&self) -> bool {
        self.port.is_connected()
    }

    fn answer(&self, mut header: AH, elements: &[AE]) -> Result<(), SendError> {
        let mut response = self
            .port
            .loan_slice_uninit(elements.len())
            .map_err(|e| self.not_sent(format!("cannot loan memory: {e:?}")))?;
        header.stamp_mut().sent_ns = monotonic_ns();
        *response.user_header_mut() = header;
        response
            .write_from_slice(elements)
            .send()
            .map_err(|e| self.not_sent(format!("{e:?}")))
    }
}
