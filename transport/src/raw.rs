//! Ports of topics whose messages are known as bytes alone, with the layout of their parts.

use core::slice;
use std::time::Duration;

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::{Node, ipc};
use iceoryx2::service::builder::publish_subscribe::Builder;
use iceoryx2::service::marker::{CustomHeaderMarker, CustomPayloadMarker};
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;
use iceoryx2::service::static_config::message_type_details::{TypeDetail, TypeVariant};

use super::degradation::Failures;
use super::publisher::{self, SenderOptions};
use super::service::{self, Limits, TopicHolder, TopicIdentity};
use crate::clock::monotonic_ns;
use crate::error::{BusError, ReceiveError, SendError};
use crate::message::Descriptor;
use crate::stamp::Stamp;

/// Name and messages of a topic.
#[derive(Debug, Clone, Copy)]
pub struct RawFormat {
    /// Name of the topic.
    pub name: &'static str,
    /// The user header.
    pub header: &'static Descriptor,
    /// The elements.
    pub element: &'static Descriptor,
}

type RawBuilder = Builder<[CustomPayloadMarker], CustomHeaderMarker, ipc::Service>;
type RawService = PortFactory<ipc::Service, [CustomPayloadMarker], CustomHeaderMarker>;

/// Returns the builder of the service, with the types that a program with these messages has.
fn builder(node: &Node<ipc::Service>, format: RawFormat) -> Result<RawBuilder, BusError> {
    let topic = format.name;
    let detail = |variant, of: &Descriptor| {
        TypeDetail::__internal_new_from_parts(variant, of.name, of.size, of.align).map_err(|e| {
            BusError::Open {
                topic,
                reason: format!("name of message {}: {e:?}", of.name),
            }
        })
    };
    let payload = detail(TypeVariant::Dynamic, format.element)?;
    let header = detail(TypeVariant::FixedSize, format.header)?;
    let builder = node
        .service_builder(&service::service_name(topic)?)
        .publish_subscribe::<[CustomPayloadMarker]>()
        .user_header::<CustomHeaderMarker>();
    // SAFETY: the ports below read and write headers and elements with the sizes in these details.
    Ok(unsafe {
        builder
            .__internal_set_payload_type_details(&payload)
            .__internal_set_user_header_type_details(&header)
    })
}

/// Creates the service and holds it.
///
/// # Errors
/// [`BusError`] if iceoryx2 refuses.
pub fn create(
    node: &Node<ipc::Service>,
    format: RawFormat,
    agreed: &TopicIdentity<'_>,
    limits: &Limits,
) -> Result<TopicHolder, BusError> {
    let topic = agreed.topic;
    let failed = |reason: String| BusError::Create { topic, reason };
    let attributes = super::agreement::define(topic, agreed.schema)?;
    let service = service::limited(builder(node, format)?, limits)
        .create_with_attributes(&attributes)
        .map_err(|e| failed(format!("{e:?}")))?;
    Ok(service::held(topic, service))
}

fn open(
    node: &Node<ipc::Service>,
    format: RawFormat,
    agreed: &TopicIdentity<'_>,
) -> Result<RawService, BusError> {
    let topic = agreed.topic;
    let verifier = super::agreement::require(topic, agreed.schema)?;
    let opened = builder(node, format)?.open_with_attributes(&verifier);
    opened.map_err(|e| service::refused(node, agreed, e, format.header, format.element))
}

/// A sending end.
pub struct Sender {
    format: RawFormat,
    inner: iceoryx2::port::publisher::Publisher<
        ipc::Service,
        [CustomPayloadMarker],
        CustomHeaderMarker,
    >,
    patience: Duration,
}

impl Sender {
    /// The sending end of a topic that exists.
    ///
    /// # Errors
    /// [`BusError`] if iceoryx2 refuses.
    pub fn open(
        node: &Node<ipc::Service>,
        format: RawFormat,
        agreed: &TopicIdentity<'_>,
        options: &SenderOptions,
    ) -> Result<Self, BusError> {
        let factory = open(node, format, agreed)?;
        let failures = Failures::default();
        let builder = publisher::configured(factory.publisher_builder(), options, &failures);
        Ok(Self {
            format,
            inner: failures.checked(agreed.topic, "publisher", builder.create())?,
            patience: options.patience,
        })
    }

    fn failed(&self, reason: String) -> SendError {
        SendError::Transport {
            topic: self.format.name,
            reason,
        }
    }

    /// As `update_connections` of a publisher.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    pub fn update_connections(&self) -> Result<(), SendError> {
        let updated = self.inner.update_connections();
        updated.map_err(|e| self.failed(format!("{e:?}")))
    }

    /// Sends a message of `count` elements, whose bytes have the lengths of the format; returns the number of receivers. With
    /// `timed`, the stamp at the begin of the header gets the time of sending.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    pub fn send(
        &self,
        header: &[u8],
        elements: &[u8],
        count: usize,
        timed: bool,
    ) -> Result<usize, SendError> {
        let (header_bytes, element_bytes) = (self.format.header.size, self.format.element.size);
        if header.len() != header_bytes || Some(elements.len()) != count.checked_mul(element_bytes)
        {
            return Err(self.failed("bytes that are no message of the topic".to_owned()));
        }
        // SAFETY: the service has elements of a variable number, and their memory is written below.
        let sample = unsafe { self.inner.loan_custom_payload(count) };
        let mut sample = sample.map_err(|e| self.failed(format!("cannot loan memory: {e:?}")))?;
        let own_header = core::ptr::from_mut(sample.user_header_mut()).cast::<u8>();
        // SAFETY: the details of the service reserve this many bytes for the header.
        let own_header = unsafe { slice::from_raw_parts_mut(own_header, header_bytes) };
        own_header.copy_from_slice(header);
        if timed {
            let now = monotonic_ns().to_le_bytes();
            for offset in [Stamp::COMPUTED_AT, Stamp::SENT_AT] {
                if let Some(clock) = own_header.get_mut(offset..offset + 8) {
                    clock.copy_from_slice(&now);
                }
            }
        }
        let payload = sample.payload_mut();
        if payload.len() != elements.len() {
            return Err(self.failed("its memory has another size".to_owned()));
        }
        // SAFETY: both have this many bytes, and the loaned memory is another one.
        unsafe {
            core::ptr::copy_nonoverlapping(
                elements.as_ptr(),
                payload.as_mut_ptr().cast::<u8>(),
                elements.len(),
            );
        }
        // SAFETY: all bytes were written above.
        let sent = unsafe { sample.assume_init() }.send();
        sent.map_err(|e| publisher::undelivered(self.format.name, self.patience, e))
    }
}

/// A receiving end.
pub struct Receiver {
    format: RawFormat,
    inner: iceoryx2::port::subscriber::Subscriber<
        ipc::Service,
        [CustomPayloadMarker],
        CustomHeaderMarker,
    >,
}

impl Receiver {
    /// The receiving end of a topic that exists, with a buffer of this many messages.
    ///
    /// # Errors
    /// [`BusError`] if iceoryx2 refuses.
    pub fn open(
        node: &Node<ipc::Service>,
        format: RawFormat,
        agreed: &TopicIdentity<'_>,
        buffer: usize,
    ) -> Result<Self, BusError> {
        let failures = Failures::default();
        let created = open(node, format, agreed)?
            .subscriber_builder()
            .buffer_size(buffer)
            .set_degradation_handler(failures.handler())
            .create();
        let inner = failures.checked(agreed.topic, "subscriber", created)?;
        Ok(Self { format, inner })
    }

    fn failed(&self, reason: String) -> ReceiveError {
        ReceiveError::Transport {
            topic: self.format.name,
            reason,
        }
    }

    /// As `update_connections` of a subscriber.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    pub fn update_connections(&self) -> Result<(), ReceiveError> {
        let updated = self.inner.update_connections();
        updated.map_err(|e| self.failed(format!("{e:?}")))
    }

    /// Hands over header and elements of the next unread message; returns `false` if there is none.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    pub fn receive(&self, take: &mut dyn FnMut(&[u8], &[u8])) -> Result<bool, ReceiveError> {
        let sample = self.inner.receive();
        let Some(sample) = sample.map_err(|e| self.failed(format!("{e:?}")))? else {
            return Ok(false);
        };
        let header = core::ptr::from_ref(sample.user_header()).cast::<u8>();
        // SAFETY: the details of the service reserve this many bytes for the header; it lives as long as the sample.
        let header = unsafe { slice::from_raw_parts(header, self.format.header.size) };
        let payload = sample.payload();
        // SAFETY: a marker is one byte, and any byte is a valid value; they live as long as the sample.
        let elements = unsafe { slice::from_raw_parts(payload.as_ptr().cast(), payload.len()) };
        take(header, elements);
        Ok(true)
    }
}
