//! Request–response services.

mod client;
mod server;
mod service;

pub use client::{Client, PendingResponse};
pub use server::{ActiveRequest, Attendant, Server};
pub(super) use service::create;

use iceoryx2::prelude::ipc;
use iceoryx2::service::port_factory::request_response::PortFactory;

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
