//! Creating and opening a request–response service.

use iceoryx2::prelude::{Node, ipc};

use super::super::service::{TopicHolder, service_name};
use super::super::{BusError, BusOptions, agreement};
use super::{Factory, OPEN_REQUESTS};
use crate::message::Message;
use crate::topics::Service;

/// Fingerprint of the messages' layout.
fn layout<S: Service>() -> String {
    let size = |d: crate::message::Descriptor| format!("{}:{}", d.name, d.fields.len());
    let parts = [
        size(S::RequestHeader::DESCRIPTOR),
        size(S::RequestElement::DESCRIPTOR),
        size(S::ResponseHeader::DESCRIPTOR),
        size(S::ResponseElement::DESCRIPTOR),
    ];
    blake3::hash(parts.join(",").as_bytes()).to_hex()[..16].to_owned()
}

pub(in crate::bus) fn create<S: Service>(
    node: &Node<ipc::Service>,
    options: &BusOptions,
) -> Result<TopicHolder, BusError> {
    let failed = |reason: String| BusError::Create {
        topic: S::NAME,
        reason,
    };
    let attributes = agreement::define(&layout::<S>()).map_err(failed)?;
    let service = node
        .service_builder(&service_name(S::NAME)?)
        .request_response::<[S::RequestElement], [S::ResponseElement]>()
        .request_user_header::<S::RequestHeader>()
        .response_user_header::<S::ResponseHeader>()
        .max_active_requests_per_client(OPEN_REQUESTS)
        .max_servers(1)
        // A process that drives several robots may ask for each.
        .max_clients(options.size.processes + options.size.robots + 1)
        .max_nodes(crate::bus::nodes(&options.size))
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(TopicHolder::new(S::NAME, service))
}

pub(super) fn open<S: Service>(node: &Node<ipc::Service>) -> Result<Factory<S>, BusError> {
    let failed = |reason: String| BusError::Open {
        topic: S::NAME,
        reason,
    };
    let layout = layout::<S>();
    let verifier = agreement::require(&layout).map_err(failed)?;
    node.service_builder(&service_name(S::NAME)?)
        .request_response::<[S::RequestElement], [S::ResponseElement]>()
        .request_user_header::<S::RequestHeader>()
        .response_user_header::<S::ResponseHeader>()
        .open_with_attributes(&verifier)
        .map_err(|e| failed(format!("{e:?} (this process: schema {layout})")))
}
