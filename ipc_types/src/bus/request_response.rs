//! Request–response services.

use core::cell::Cell;

use iceoryx2::prelude::{AttributeSpecifier, AttributeVerifier, Node, ipc};
use iceoryx2::service::port_factory::request_response::PortFactory;

use super::service::{TopicHolder, service_name};
use super::{BusError, BusOptions, ReceiveError, SendError};
use crate::clock;
use crate::message::Message;
use crate::stamp::Header;
use crate::topics::Service;

/// Requests that one client may have open at a time.
const OPEN_REQUESTS: usize = 4;

type Factory<S> = PortFactory<
    ipc::Service,
    [<S as Service>::RequestElement],
    <S as Service>::RequestHeader,
    [<S as Service>::ResponseElement],
    <S as Service>::ResponseHeader,
>;

type ClientPort<S> = iceoryx2::port::client::Client<
    ipc::Service,
    [<S as Service>::RequestElement],
    <S as Service>::RequestHeader,
    [<S as Service>::ResponseElement],
    <S as Service>::ResponseHeader,
>;
type ServerPort<S> = iceoryx2::port::server::Server<
    ipc::Service,
    [<S as Service>::RequestElement],
    <S as Service>::RequestHeader,
    [<S as Service>::ResponseElement],
    <S as Service>::ResponseHeader,
>;
type PendingPort<S> = iceoryx2::pending_response::PendingResponse<
    ipc::Service,
    [<S as Service>::RequestElement],
    <S as Service>::RequestHeader,
    [<S as Service>::ResponseElement],
    <S as Service>::ResponseHeader,
>;
type ActivePort<S> = iceoryx2::active_request::ActiveRequest<
    ipc::Service,
    [<S as Service>::RequestElement],
    <S as Service>::RequestHeader,
    [<S as Service>::ResponseElement],
    <S as Service>::ResponseHeader,
>;
/// Header and elements of an answer, copied out of shared memory.
pub type Answer<S> = (
    <S as Service>::ResponseHeader,
    Vec<<S as Service>::ResponseElement>,
);

/// Key and value of the attribute that both sides must agree on beyond what iceoryx2 compares.
fn layout<S: Service>() -> (&'static str, String) {
    let size = |d: crate::message::Descriptor| format!("{}:{}", d.name, d.fields.len());
    let parts = [
        size(S::RequestHeader::DESCRIPTOR),
        size(S::RequestElement::DESCRIPTOR),
        size(S::ResponseHeader::DESCRIPTOR),
        size(S::ResponseElement::DESCRIPTOR),
    ];
    (
        "protean.schema",
        blake3::hash(parts.join(",").as_bytes()).to_hex()[..16].to_owned(),
    )
}

pub(super) fn create<S: Service>(
    node: &Node<ipc::Service>,
    options: &BusOptions,
) -> Result<TopicHolder, BusError> {
    let failed = |reason: String| BusError::Create {
        topic: S::NAME,
        reason,
    };
    let (key, value) = layout::<S>();
    let attributes = AttributeSpecifier::new()
        .define(
            &key.try_into().map_err(|e| failed(format!("{e:?}")))?,
            &value
                .as_str()
                .try_into()
                .map_err(|e| failed(format!("{e:?}")))?,
        )
        .map_err(|e| failed(format!("{e:?}")))?;
    let service = node
        .service_builder(&service_name(S::NAME)?)
        .request_response::<[S::RequestElement], [S::ResponseElement]>()
        .request_user_header::<S::RequestHeader>()
        .response_user_header::<S::ResponseHeader>()
        .max_active_requests_per_client(OPEN_REQUESTS)
        .max_servers(1)
        .max_clients(options.size.processes + 1)
        .max_nodes(super::nodes(&options.size))
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(TopicHolder::new(S::NAME, service))
}

fn open<S: Service>(node: &Node<ipc::Service>) -> Result<Factory<S>, BusError> {
    let failed = |reason: String| BusError::Open {
        topic: S::NAME,
        reason,
    };
    let (key, value) = layout::<S>();
    let verifier = AttributeVerifier::new()
        .require(
            &key.try_into().map_err(|e| failed(format!("{e:?}")))?,
            &value
                .as_str()
                .try_into()
                .map_err(|e| failed(format!("{e:?}")))?,
        )
        .map_err(|e| failed(format!("{e:?}")))?;
    node.service_builder(&service_name(S::NAME)?)
        .request_response::<[S::RequestElement], [S::ResponseElement]>()
        .request_user_header::<S::RequestHeader>()
        .response_user_header::<S::ResponseHeader>()
        .open_with_attributes(&verifier)
        .map_err(|e| failed(format!("{e:?} (this process: schema {value})")))
}

/// The asking side.
pub struct Client<S: Service> {
    port: ClientPort<S>,
    sequence: Cell<u64>,
}

impl<S: Service> Client<S> {
    pub(super) fn open(node: &Node<ipc::Service>, capacity: usize) -> Result<Self, BusError> {
        let port = open::<S>(node)?
            .client_builder()
            .initial_max_slice_len(capacity.max(1))
            .create()
            .map_err(|e| BusError::Port {
                topic: S::NAME,
                port: "client",
                reason: format!("{e:?}"),
            })?;
        Ok(Self {
            port,
            sequence: Cell::new(0),
        })
    }

    /// Sends a request; the answer is polled from the returned handle.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 fails, e.g. with too many open requests.
    pub fn ask(
        &self,
        mut header: S::RequestHeader,
        elements: &[S::RequestElement],
    ) -> Result<PendingResponse<S>, SendError> {
        let failed = |reason: String| SendError::Transport {
            topic: S::NAME,
            reason,
        };
        let mut request = self
            .port
            .loan_slice_uninit(elements.len())
            .map_err(|e| failed(format!("cannot loan memory: {e:?}")))?;
        header.stamp_mut().sequence = self.sequence.replace(self.sequence.get() + 1);
        header.stamp_mut().sent_ns = clock::monotonic_ns();
        *request.user_header_mut() = header;
        let pending = request
            .write_from_slice(elements)
            .send()
            .map_err(|e| failed(format!("{e:?}")))?;
        Ok(PendingResponse { pending })
    }
}

impl<S: Service> core::fmt::Debug for Client<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Client")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}

/// A request that waits for its answer; dropping it tells the server to give up.
pub struct PendingResponse<S: Service> {
    pending: PendingPort<S>,
}

impl<S: Service> PendingResponse<S> {
    /// The answer, if it has come.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn poll(&self) -> Result<Option<Answer<S>>, ReceiveError> {
        self.pending
            .receive()
            .map(|response| response.map(|r| (*r.user_header(), r.payload().to_vec())))
            .map_err(|e| ReceiveError::Transport {
                topic: S::NAME,
                reason: format!("{e:?}"),
            })
    }

    /// Whether a server still works on it. Stays true after a server was killed until its remains
    /// are cleaned up, so a client needs a deadline of its own.
    pub fn is_open(&self) -> bool {
        self.pending.is_connected()
    }
}

impl<S: Service> core::fmt::Debug for PendingResponse<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("PendingResponse")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}

/// The answering side.
pub struct Server<S: Service> {
    port: ServerPort<S>,
}

impl<S: Service> Server<S> {
    pub(super) fn open(node: &Node<ipc::Service>, capacity: usize) -> Result<Self, BusError> {
        let port = open::<S>(node)?
            .server_builder()
            .initial_max_slice_len(capacity.max(1))
            .create()
            .map_err(|e| BusError::Port {
                topic: S::NAME,
                port: "server",
                reason: format!("{e:?}"),
            })?;
        Ok(Self { port })
    }

    /// The next request, if any.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn receive(&self) -> Result<Option<ActiveRequest<S>>, ReceiveError> {
        self.port
            .receive()
            .map(|request| request.map(|request| ActiveRequest { request }))
            .map_err(|e| ReceiveError::Transport {
                topic: S::NAME,
                reason: format!("{e:?}"),
            })
    }
}

impl<S: Service> core::fmt::Debug for Server<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Server")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}

/// A request being worked on; dropping it ends the exchange.
pub struct ActiveRequest<S: Service> {
    request: ActivePort<S>,
}

impl<S: Service> ActiveRequest<S> {
    /// The request's header.
    pub fn header(&self) -> &S::RequestHeader {
        self.request.user_header()
    }

    /// The request's elements.
    pub fn elements(&self) -> &[S::RequestElement] {
        self.request.payload()
    }

    /// Whether the client still waits.
    pub fn is_wanted(&self) -> bool {
        self.request.is_connected()
    }

    /// Sends the answer.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 fails or the answer has more elements than the server
    /// was opened for.
    pub fn answer(
        &self,
        mut header: S::ResponseHeader,
        elements: &[S::ResponseElement],
    ) -> Result<(), SendError> {
        let failed = |reason: String| SendError::Transport {
            topic: S::NAME,
            reason,
        };
        let mut response = self
            .request
            .loan_slice_uninit(elements.len())
            .map_err(|e| failed(format!("cannot loan memory: {e:?}")))?;
        header.stamp_mut().sent_ns = clock::monotonic_ns();
        *response.user_header_mut() = header;
        response
            .write_from_slice(elements)
            .send()
            .map_err(|e| failed(format!("{e:?}")))
    }
}

impl<S: Service> core::fmt::Debug for ActiveRequest<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ActiveRequest")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}
