//! The publish–subscribe service of a topic: creation and opening.

use iceoryx2::prelude::{
    IceoryxSend, MessagingPattern, Node, PortFactory as _, Service as _, ServiceName, ZeroCopySend,
    ipc,
};
use iceoryx2::service::builder::publish_subscribe::{Builder, PublishSubscribeOpenError};
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;
use iceoryx2::service::static_config::messaging_pattern::MessagingPattern as Details;

use super::agreement;
use crate::error::BusError;
use crate::message::{Descriptor, Message};
use crate::stamp::Header;

/// Name of a topic and hash of its schema, on which the processes of a run agree.
#[derive(Debug, Clone, Copy)]
pub struct TopicIdentity<'a> {
    /// Name of the topic.
    pub topic: &'static str,
    /// Hash of the schema.
    pub schema: &'a str,
}

/// The limits of a topic's service.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Number of messages kept for late joiners.
    pub history: usize,
    /// Maximum number of unread messages of a receiver.
    pub buffer: usize,
    /// Maximum number of senders.
    pub publishers: usize,
    /// Maximum number of receivers.
    pub subscribers: usize,
    /// Maximum number of processes of the run.
    pub nodes: usize,
    /// `true` if a full buffer drops its oldest message.
    pub overflow: bool,
}

/// Keeps a created service alive; drop it when the run has ended.
pub struct TopicHolder {
    topic: &'static str,
    /// Holds the service.
    listeners: Box<dyn Fn() -> usize + Send>,
}

impl TopicHolder {
    /// Holds the service of this topic.
    pub fn new<S: Send + 'static>(topic: &'static str, service: S) -> Self {
        Self::counting(topic, service, |_| 0)
    }

    fn counting<S: Send + 'static>(
        topic: &'static str,
        service: S,
        listeners: fn(&S) -> usize,
    ) -> Self {
        Self {
            topic,
            listeners: Box::new(move || listeners(&service)),
        }
    }

    /// The topic whose service is held.
    pub fn topic(&self) -> &'static str {
        self.topic
    }

    /// The current number of subscribers of the topic in all processes; 0 for a service that is not
    /// a topic, and for a bus within one process. Subscribers of a dead process count until the
    /// clean-up.
    pub fn listeners(&self) -> usize {
        (self.listeners)()
    }
}

crate::debug_with! { [] TopicHolder, own => own.topic }

pub fn service_name(topic: &'static str) -> Result<ServiceName, BusError> {
    topic.try_into().map_err(|e| BusError::Open {
        topic,
        reason: format!("{e:?}"),
    })
}

pub fn create<H: Header, E: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    limits: &Limits,
) -> Result<TopicHolder, BusError> {
    let topic = agreed.topic;
    let failed = |reason: String| BusError::Create { topic, reason };
    let attributes = agreement::define(topic, agreed.schema)?;
    let builder = node.service_builder(&service_name(topic)?);
    let builder = builder.publish_subscribe::<[E]>().user_header::<H>();
    let service = limited(builder, limits)
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(held(topic, service))
}

/// Holds a created service.
pub fn held<P, H>(topic: &'static str, service: PortFactory<ipc::Service, P, H>) -> TopicHolder
where
    P: IceoryxSend + core::fmt::Debug + ?Sized + 'static,
    H: core::fmt::Debug + ZeroCopySend + 'static,
{
    TopicHolder::counting(topic, service, |service| {
        service.dynamic_config().number_of_subscribers()
    })
}

/// Applies the limits of a topic to a service to be created.
pub fn limited<P, H>(
    builder: Builder<P, H, ipc::Service>,
    limits: &Limits,
) -> Builder<P, H, ipc::Service>
where
    P: IceoryxSend + core::fmt::Debug + ?Sized,
    H: core::fmt::Debug + ZeroCopySend,
{
    builder
        .history_size(limits.history)
        .subscriber_max_buffer_size(limits.buffer)
        // The recorder and the processes copy the messages that they keep: one borrowed message at a
        // time, one more for a caller that holds it while it requests the next.
        .subscriber_max_borrowed_samples(2)
        .max_publishers(limits.publishers)
        .max_subscribers(limits.subscribers)
        .max_nodes(limits.nodes)
        .enable_safe_overflow(limits.overflow)
}

pub fn open<H: Header, E: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
) -> Result<PortFactory<ipc::Service, [E], H>, BusError> {
    let topic = agreed.topic;
    let verifier = agreement::require(topic, agreed.schema)?;
    node.service_builder(&service_name(topic)?)
        .publish_subscribe::<[E]>()
        .user_header::<H>()
        .open_with_attributes(&verifier)
        .map_err(|e| refused(node, agreed, e, &H::DESCRIPTOR, &E::DESCRIPTOR))
}

/// Describes why a service was not opened with these types.
pub fn refused(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    error: PublishSubscribeOpenError,
    header: &Descriptor,
    element: &Descriptor,
) -> BusError {
    let reason = match error {
        PublishSubscribeOpenError::IncompatibleTypes
        | PublishSubscribeOpenError::IncompatibleAttributes => {
            return mismatch(node, agreed, header, element);
        }
        PublishSubscribeOpenError::DoesNotExist => format!(
            "no such service in the run at {} (prefix {})",
            node.config().global.root_path(),
            node.config().global.prefix
        ),
        other => format!("{other:?}"),
    };
    BusError::Open {
        topic: agreed.topic,
        reason,
    }
}

/// Describes both sides of a type mismatch.
fn mismatch(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    header: &Descriptor,
    element: &Descriptor,
) -> BusError {
    let ours = format!(
        "[{}] of {} bytes with header {} of {} bytes, schema {}",
        element.name, element.size, header.name, header.size, agreed.schema
    );
    let theirs = service_name(agreed.topic)
        .ok()
        .and_then(|name| {
            ipc::Service::details(&name, node.config(), MessagingPattern::PublishSubscribe)
                .ok()
                .flatten()
        })
        .map_or_else(
            || "a service whose details cannot be read".to_owned(),
            |details| {
                let schema = details
                    .static_details
                    .attributes()
                    .iter()
                    .find(|a| a.key().to_string().contains(agreement::ATTRIBUTE))
                    .map_or_else(|| "none".to_owned(), |a| a.value().to_string());
                match details.static_details.messaging_pattern() {
                    Details::PublishSubscribe(config) => {
                        let types = config.message_type_details();
                        format!(
                            "[{}] of {} bytes with header {} of {} bytes, schema {schema}",
                            types.payload.type_name(),
                            types.payload.size(),
                            types.user_header.type_name(),
                            types.user_header.size(),
                        )
                    }
                    _ => "another messaging pattern".to_owned(),
                }
            },
        );
    BusError::Mismatch {
        topic: agreed.topic,
        ours,
        theirs,
    }
}
