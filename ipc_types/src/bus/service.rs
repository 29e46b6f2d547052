//! Creating and opening the publish–subscribe service of a topic.

use iceoryx2::prelude::{MessagingPattern, Node, PortFactory as _, Service as _, ServiceName, ipc};
use iceoryx2::service::builder::publish_subscribe::PublishSubscribeOpenError;
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;
use iceoryx2::service::static_config::messaging_pattern::MessagingPattern as Details;

use super::{BusError, BusOptions, LOOP_TICKS, agreement};
use crate::message::Message;
use crate::schema;
use crate::topics::{Qos, Topic};

pub(super) type TopicService<T> =
    PortFactory<ipc::Service, [<T as Topic>::Element], <T as Topic>::Header>;

/// Keeps a created service alive; drop it when the run has ended.
pub struct TopicHolder {
    topic: &'static str,
    /// Holds the service.
    listeners: Box<dyn Fn() -> usize + Send>,
}

impl TopicHolder {
    pub(super) fn new<S: Send + 'static>(topic: &'static str, service: S) -> Self {
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

    /// How many subscribers the topic has now, in all processes; 0 of what is no topic, and of a bus
    /// within one process. Those of a process that died count until somebody cleans up.
    pub fn listeners(&self) -> usize {
        (self.listeners)()
    }
}

impl core::fmt::Debug for TopicHolder {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("TopicHolder")
            .field("topic", &self.topic)
            .finish_non_exhaustive()
    }
}

pub(super) fn service_name(topic: &'static str) -> Result<ServiceName, BusError> {
    topic.try_into().map_err(|e| BusError::Open {
        topic,
        reason: format!("{e:?}"),
    })
}

/// Buffer that a subscriber needs to hold `ticks` ticks of one publisher.
pub(super) fn buffer(qos: &Qos, ticks: usize) -> usize {
    qos.per_tick.saturating_mul(ticks).max(2)
}

pub(super) fn create<T: Topic>(
    node: &Node<ipc::Service>,
    options: &BusOptions,
) -> Result<TopicHolder, BusError> {
    let failed = |reason: String| BusError::Create {
        topic: T::NAME,
        reason,
    };
    let qos = T::ID.qos(&options.size);
    let attributes = agreement::define(&schema::hash::<T>()).map_err(failed)?;
    let service = node
        .service_builder(&service_name(T::NAME)?)
        .publish_subscribe::<[T::Element]>()
        .user_header::<T::Header>()
        .history_size(qos.history)
        .subscriber_max_buffer_size(buffer(&qos, options.recorder_ticks.max(LOOP_TICKS)))
        // The recorder and the processes copy what they keep: one borrowed message at a time,
        // one more for a caller that holds it while it asks for the next.
        .subscriber_max_borrowed_samples(2)
        .max_publishers(qos.publishers)
        .max_subscribers(qos.subscribers)
        .max_nodes(super::nodes(&options.size))
        .enable_safe_overflow(options.overflow)
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(TopicHolder::counting(
        T::NAME,
        service,
        |service: &TopicService<T>| service.dynamic_config().number_of_subscribers(),
    ))
}

pub(super) fn open<T: Topic>(node: &Node<ipc::Service>) -> Result<TopicService<T>, BusError> {
    let failed = |reason: String| BusError::Open {
        topic: T::NAME,
        reason,
    };
    let verifier = agreement::require(&schema::hash::<T>()).map_err(failed)?;
    node.service_builder(&service_name(T::NAME)?)
        .publish_subscribe::<[T::Element]>()
        .user_header::<T::Header>()
        .open_with_attributes(&verifier)
        .map_err(|e| match e {
            PublishSubscribeOpenError::IncompatibleTypes
            | PublishSubscribeOpenError::IncompatibleAttributes => mismatch::<T>(node),
            PublishSubscribeOpenError::DoesNotExist => failed(format!(
                "no such service in the run at {} (prefix {})",
                node.config().global.root_path(),
                node.config().global.prefix
            )),
            other => failed(format!("{other:?}")),
        })
}

/// Describes both sides of a type mismatch.
fn mismatch<T: Topic>(node: &Node<ipc::Service>) -> BusError {
    let header = T::Header::DESCRIPTOR;
    let element = T::Element::DESCRIPTOR;
    let ours = format!(
        "[{}] of {} bytes with header {} of {} bytes, schema {}",
        element.name,
        element.size,
        header.name,
        header.size,
        schema::hash::<T>()
    );
    let theirs = service_name(T::NAME)
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
        topic: T::NAME,
        ours,
        theirs,
    }
}
