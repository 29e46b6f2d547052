//! Topics with their facts; [`topic!`](crate::topic!) states each fact once, in any crate. No code opens a service by a literal
//! name.
//!
//! * [`Topic`]: a topic as a type, with the types of its messages; [`TopicId`]: a topic as a value;
//!   [`TopicFacts`]: the facts;
//! * `built_in`: the topics of Protean's own processes; `registry`: those of others;
//! * [`TopicLayout`](crate::layout::TopicLayout): a topic that a program declares while it runs; [`Drawing`]: the form of its elements in pictures;
//! * [`Service`]: request–response; the constants at the end: events.

mod built_in;
mod drawing;
mod pattern;
mod registry;
mod service;
mod topic_id;

pub use built_in::*;
pub use drawing::Drawing;
pub use pattern::fits;
pub use registry::PerTopic;
pub use service::{OptimiserPlan, PortsOf, Service};
pub use topic_id::TopicId;

use crate::message::{Descriptor, Message};
use crate::stamp::Header;
use crate::transport::Ports;

/// Number of elements of the messages of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arity {
    /// Always exactly one element.
    One,
    /// Any number of elements up to the publisher's capacity.
    Many,
}

/// The facts of a topic that do not depend on the size of the run.
#[derive(Debug, Clone, Copy)]
pub struct TopicFacts {
    /// Name of the service and of the log's channel.
    pub name: &'static str,
    /// One element or many.
    pub arity: Arity,
    /// Name of the sequence in schemas of [`Arity::Many`] topics.
    pub elements: &'static str,
    /// The user header.
    pub header: Descriptor,
    /// The element of the payload slice.
    pub element: Descriptor,
    /// `true` if the topic is part of the simulated history (its payloads are in the digest).
    pub simulated: bool,
    /// `true` if late joiners get the last message, because it describes a lasting state.
    pub latched: bool,
    /// `true` if a message is sent in answer to the input of its tick, so that its stamp contains the
    /// duration of its sender's step.
    pub timed: bool,
    /// Fields in which infinity is valid (see their documentation); in all others, a message with a
    /// number that is not finite is rejected. For elements that are plain numbers: the name of the
    /// sequence.
    pub may_be_infinite: &'static [&'static str],
    /// Form of its elements in pictures; `None` if they have none.
    pub drawing: Option<Drawing>,
    /// Quality of service in a run of a size.
    pub qos: fn(&RunSize) -> Qos,
}

/// Quality of service of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Number of samples that a publisher keeps for late joiners.
    pub history: usize,
    /// Maximum number of messages that one publisher sends per tick; buffers are multiples of it.
    pub per_tick: usize,
    /// Maximum number of publishers.
    pub publishers: usize,
    /// Maximum number of subscribers, including the recorder and four external ones.
    pub subscribers: usize,
}

/// Inputs of a topic's quality of service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunSize {
    /// Number of robots in the run, ≥ 1.
    pub robots: usize,
    /// Number of processes of the run without the orchestrator, ≥ 1.
    pub processes: usize,
    /// Number of obstacle events of the scenario.
    pub events: usize,
}

/// Number of subscribers reserved on every topic for external programs (viewers, the command-line tool).
pub const EXTERNAL_SUBSCRIBERS: usize = 4;

impl RunSize {
    /// Maximum number of subscribers: every process, the recorder, and external ones.
    pub const fn readers(&self) -> usize {
        self.processes + 1 + EXTERNAL_SUBSCRIBERS
    }
}

/// A publish–subscribe topic as a type.
pub trait Topic: Send + Sync + 'static {
    /// Its facts.
    const FACTS: &'static TopicFacts;
    /// Name of the service and of the log's channel.
    const NAME: &'static str = Self::FACTS.name;
    /// One element or many.
    const ARITY: Arity = Self::FACTS.arity;
    /// The user header.
    type Header: Header;
    /// The element of the payload slice.
    type Element: Message;

    /// The topic as a value.
    fn id() -> TopicId;

    /// Its ports between processes.
    fn ports() -> &'static Ports<Self::Header, Self::Element>;
}

/// Declares topics, each with its facts: a type that implements [`Topic`].
///
/// ```
/// use ipc_types::message::ZeroCopySend;
/// use ipc_types::stamp::PlainHeader;
/// use ipc_types::topics::Topic;
///
/// ipc_types::message! {
///     /// Bearing of a robot.
///     pub struct Bearing = "example/Bearing" {
///         angle: f64 = "direction in the frame of the sensor [rad]",
///         robot: u64 = "index of the robot",
///     }
/// }
///
/// ipc_types::topic! {
///     /// Bearings of all robots in view: sonar → trackers.
///     Bearings = "sonar/bearing": Many, "bearings", PlainHeader, Bearing,
///         simulated true, latched false, timed true,
///         may_be_infinite [],
///         qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
/// }
///
/// assert_eq!(Bearings::NAME, "sonar/bearing");
/// ```
#[macro_export]
macro_rules! topic {
    (@ $id:expr; $(#[doc = $doc:literal])+
        $topic:ident = $name:literal : $arity:ident, $elements:literal, $header:ty, $element:ty,
        simulated $simulated:literal, latched $latched:literal, timed $timed:literal,
        may_be_infinite $infinite:expr,
        qos |$size:ident| per_tick $per_tick:expr, publishers $publishers:expr,
        subscribers $subscribers:expr $(, drawing $drawing:expr)?;
    ) => {
        $(#[doc = $doc])+
        #[derive(Debug, Clone, Copy)]
        pub struct $topic;

        impl $crate::topics::Topic for $topic {
            const FACTS: &'static $crate::topics::TopicFacts = &$crate::topics::TopicFacts {
                name: $name,
                arity: $crate::topics::Arity::$arity,
                elements: $elements,
                header: <$header as $crate::message::Message>::DESCRIPTOR,
                element: <$element as $crate::message::Message>::DESCRIPTOR,
                simulated: $simulated,
                latched: $latched,
                timed: $timed,
                may_be_infinite: &$infinite,
                drawing: $crate::topic!(@drawing $($drawing)?),
                qos: |$size| $crate::topics::Qos {
                    history: if $latched { 1 } else { 0 },
                    per_tick: $per_tick,
                    publishers: $publishers,
                    subscribers: $subscribers,
                },
            };
            type Header = $header;
            type Element = $element;

            fn id() -> $crate::topics::TopicId {
                $id
            }

            fn ports() -> &'static $crate::transport::Ports<$header, $element> {
                static PORTS: $crate::transport::Ports<$header, $element> =
                    $crate::transport::Ports::new();
                &PORTS
            }
        }
    };
    ($(
        $(#[doc = $doc:literal])+
        $topic:ident = $name:literal : $arity:ident, $elements:literal, $header:ty, $element:ty,
        simulated $simulated:literal, latched $latched:literal, timed $timed:literal,
        may_be_infinite $infinite:expr,
        qos |$size:ident| per_tick $per_tick:expr, publishers $publishers:expr,
        subscribers $subscribers:expr $(, drawing $drawing:expr)?;
    )+) => {$(
        $crate::topic! {@
            {
                static ID: ::std::sync::OnceLock<$crate::topics::TopicId> =
                    ::std::sync::OnceLock::new();
                *ID.get_or_init(|| {
                    $crate::topics::TopicId::intern(<$topic as $crate::topics::Topic>::FACTS)
                })
            };
            $(#[doc = $doc])+
            $topic = $name: $arity, $elements, $header, $element,
            simulated $simulated, latched $latched, timed $timed,
            may_be_infinite $infinite,
            qos |$size| per_tick $per_tick, publishers $publishers, subscribers $subscribers
            $(, drawing $drawing)?;
        }
    )+};
    (@drawing) => { None };
    (@drawing $drawing:expr) => { Some($drawing) };
}

/// An operation for every built-in topic, each with its own types.
pub trait TopicVisitor {
    /// Error of the visitor.
    type Error;
    /// Called once per topic.
    ///
    /// # Errors
    /// Any error of the visitor; it ends the visit.
    fn visit<T: Topic>(&mut self) -> Result<(), Self::Error>;
}

/// Largest id of an event, which is the index of a process.
pub const MAX_EVENT_ID: usize = 128;
