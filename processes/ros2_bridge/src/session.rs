//! The participant of the bridge in a ROS 2 domain: publishers, subscriptions, and what other nodes have opened.

use core::net::{IpAddr, Ipv4Addr};
use core::time::Duration;
use std::thread::JoinHandle;
use std::time::Instant;

use async_io::Timer;
use futures_lite::future;
use ros_messages::RosType;
use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, Subscription,
};
use rustdds::DomainParticipantBuilder;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::BridgeError;

/// Messages that a slow reader may lag behind.
const DEPTH: usize = 10;
/// Events that readers receive that come later.
const EVENTS: usize = 1000;
/// Time for which a writer waits for space.
const FULL: Duration = Duration::from_secs(1);

/// Reliable, for readers that are present.
const VOLATILE: QosProfile = QosProfile {
    reliability: Reliability::Reliable {
        when_full: WhenFull::Wait(FULL),
    },
    history: History::KeepLast { depth: DEPTH },
    ..QosProfile::publisher_default()
};

/// Messages that readers receive which come later.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// None.
    Nothing,
    /// The last one.
    Last,
    /// All events, as `/rosout` of ROS 2 nodes.
    Events,
}

impl Kept {
    /// Quality of service of its publishers.
    pub(crate) const fn profile(self) -> QosProfile {
        let depth = match self {
            Self::Nothing => return VOLATILE,
            Self::Last => 1,
            Self::Events => EVENTS,
        };
        QosProfile {
            durability: Durability::TransientLocal,
            history: History::KeepLast { depth },
            ..VOLATILE
        }
    }
}

/// A node in a domain, with the thread that follows its discovery.
pub struct Session {
    domain: u16,
    context: Context,
    node: Node,
    spinner: Option<JoinHandle<()>>,
}

/// Publisher of a topic.
pub struct RosPublisher<M: Serialize> {
    topic: String,
    publisher: Publisher<M>,
}

/// Subscription to a topic.
pub struct RosSubscription<M: 'static> {
    topic: String,
    subscription: Subscription<M>,
}

impl Session {
    /// Joins a domain as the node `protean_NAME`; with `loopback`, over the loopback interface only.
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn join(domain: u16, name: &str, loopback: bool) -> Result<Self, BridgeError> {
        let refused = |what: &str, reason: String| BridgeError::Create {
            domain,
            what: what.to_owned(),
            reason,
        };
        let mut builder = DomainParticipantBuilder::new(domain);
        if loopback {
            builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let participant = builder
            .build()
            .map_err(|error| refused("participant", error.to_string()))?;
        let context = Context::from_domain_participant(participant)
            .map_err(|error| refused("context", error.to_string()))?;
        let name: String = name
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
            .collect();
        let name = NodeName::new("/", &format!("protean_{name}"))
            .map_err(|error| refused("node", error.to_string()))?;
        let mut node = context
            .new_node(name, NodeOptions::new())
            .map_err(|error| refused("node", error.to_string()))?;
        let spinner = node
            .spinner()
            .map_err(|error| refused("node", error.to_string()))?;
        let spinner = std::thread::Builder::new()
            .name("ros2".to_owned())
            .spawn(move || {
                // It ends with the node; without discovery the waits below end with their own errors.
                let _ = async_io::block_on(spinner.spin());
            })
            .map_err(|error| refused("thread", error.to_string()))?;
        Ok(Self {
            domain,
            context,
            node,
            spinner: Some(spinner),
        })
    }

    /// Opens a publisher of a topic, `/robot/odom`.
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn publisher<M: RosType + Serialize>(
        &mut self,
        topic: &str,
        kept: Kept,
    ) -> Result<RosPublisher<M>, BridgeError> {
        self.publisher_of_type(topic, &M::name(), kept)
    }

    /// Opens a publisher of messages of a type (`PACKAGE/NAME`).
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn publisher_of_type<M: Serialize>(
        &mut self,
        topic: &str,
        type_name: &str,
        kept: Kept,
    ) -> Result<RosPublisher<M>, BridgeError> {
        let opened = self.topic(topic, type_name, &kept.profile())?;
        let publisher = self
            .node
            .create_publisher(&opened, None)
            .map_err(|error| self.refused(topic, error.to_string()))?;
        Ok(RosPublisher {
            topic: topic.to_owned(),
            publisher,
        })
    }

    /// Opens a subscription to a topic.
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn subscription<M: RosType + DeserializeOwned + 'static>(
        &mut self,
        topic: &str,
    ) -> Result<RosSubscription<M>, BridgeError> {
        let opened = self.topic(topic, &M::name(), &VOLATILE)?;
        let subscription = self
            .node
            .create_subscription(&opened, None)
            .map_err(|error| self.refused(topic, error.to_string()))?;
        Ok(RosSubscription {
            topic: topic.to_owned(),
            subscription,
        })
    }

    fn topic(
        &self,
        topic: &str,
        type_name: &str,
        profile: &QosProfile,
    ) -> Result<rustdds::Topic, BridgeError> {
        let name = Name::parse(topic).map_err(|error| self.refused(topic, error.to_string()))?;
        let (package, message) = type_name.split_once('/').unwrap_or_default();
        self.node
            .create_topic(&name, MessageTypeName::new(package, message), profile)
            .map_err(|error| self.refused(topic, error.to_string()))
    }

    fn refused(&self, topic: &str, reason: String) -> BridgeError {
        BridgeError::Create {
            domain: self.domain,
            what: format!("topic {topic}"),
            reason,
        }
    }

    /// The domain.
    pub const fn domain(&self) -> u16 {
        self.domain
    }

    /// Returns `true` if another node writes a topic.
    pub fn is_written_elsewhere(&self, topic: &str) -> bool {
        self.node.publisher_count(topic) > 0
    }

    /// Types with which other nodes have opened a topic.
    pub fn types_of(&self, topic: &str) -> Vec<String> {
        let name = format!("rt{topic}");
        let mut types: Vec<String> = self
            .context
            .discovered_topics()
            .into_iter()
            .filter(|found| found.name == name)
            .map(|found| found.type_name)
            .collect();
        types.sort_unstable();
        types.dedup();
        types
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.node.stop_spinner();
        if let Some(spinner) = self.spinner.take() {
            // A thread that panicked has nothing to hand over.
            let _ = spinner.join();
        }
    }
}

impl<M: Serialize + core::fmt::Debug> RosPublisher<M> {
    /// Sends a message.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`].
    pub fn send(&self, message: M) -> Result<(), BridgeError> {
        self.publisher
            .publish(message)
            .map_err(|error| BridgeError::Transfer {
                topic: self.topic.clone(),
                attempt: "written",
                reason: format!("{error:?}"),
            })
    }

    /// Number of readers of other nodes.
    pub fn readers(&self, session: &Session) -> usize {
        self.publisher.get_subscription_count(&session.node)
    }
}

impl<M: DeserializeOwned + 'static> RosSubscription<M> {
    /// Takes the next message if one has arrived.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`] if it cannot be read.
    pub fn take(&self) -> Result<Option<M>, BridgeError> {
        let taken = self.subscription.take();
        Ok(taken.map_err(|error| self.unread(&error))?.map(|(m, _)| m))
    }

    /// Waits for the next message until a moment; `None` if none has arrived by then.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`] if it cannot be read.
    pub fn wait(&self, until: Instant) -> Result<Option<M>, BridgeError> {
        if let Some(message) = self.take()? {
            return Ok(Some(message));
        }
        let message = async { Some(self.subscription.async_take().await) };
        let timeout = async {
            Timer::at(until).await;
            None
        };
        match async_io::block_on(future::or(message, timeout)) {
            Some(Ok((message, _))) => Ok(Some(message)),
            Some(Err(error)) => Err(self.unread(&error)),
            None => Ok(None),
        }
    }

    /// Number of writers of other nodes.
    pub fn writers(&self, session: &Session) -> usize {
        self.subscription.get_publisher_count(&session.node)
    }

    fn unread(&self, error: &dyn core::fmt::Debug) -> BridgeError {
        BridgeError::Transfer {
            topic: self.topic.clone(),
            attempt: "read",
            reason: format!("{error:?}"),
        }
    }
}
