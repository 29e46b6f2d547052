//! Declaration of an external program in words, as the program states it, and as a scenario and a log contain it.

use std::collections::BTreeMap;

use ipc_types::bus::AnyTopic;
use ipc_types::layout::{LayoutError, TopicLayout};
use ipc_types::topics::TopicId;
use serde::{Deserialize, Serialize};

use super::{Declaration, Flow, Input, Output, When};

/// Maximum number of elements of a message of an external program.
const MAX_ELEMENTS: usize = 1 << 20;

/// Reason why a declaration is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeclarationError {
    /// A topic that it writes.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The maximum number of elements of such a topic.
    #[error("topic {topic:?}: elements = {elements}: expected from 1 to {MAX_ELEMENTS}")]
    Elements {
        /// Name of the topic.
        topic: String,
        /// The declared number.
        elements: usize,
    },
    /// A topic that it reads is unknown.
    #[error("it reads {0}, but no process writes it")]
    Unwritten(String),
    /// A topic that it reads is not of the simulated history.
    #[error("it reads {0}, which processes do not read")]
    Internal(String),
}

/// Inputs and outputs of an external program that commands no robots.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WrittenDeclaration {
    /// Names of the topics that it reads, beside `world/state`.
    pub reads: Vec<String>,
    /// The topics that it writes.
    pub writes: Vec<WrittenOutput>,
}

/// A topic that an external program writes.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct WrittenOutput {
    /// The topic.
    #[serde(flatten)]
    pub topic: WrittenTopic,
    /// Maximum number of elements of a message.
    pub elements: usize,
    /// `true` if only one process of a run may write it.
    pub sole: bool,
}

/// A topic that is not built in: [`TopicLayout`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct WrittenTopic {
    /// Name.
    pub name: String,
    /// Fields of its messages.
    pub message: String,
    /// Name of the element; by the name of the topic if empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub element: String,
    /// Name of the header; plain if empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub header: String,
    /// `true` if each message has exactly one element.
    #[serde(skip_serializing_if = "core::ops::Not::not")]
    pub one: bool,
    /// `true` if its messages count in the next tick, `false` if readers wait for them within the tick.
    pub later: bool,
    /// Fields in which infinity is valid.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub may_be_infinite: Vec<String>,
    /// Form of the elements in pictures.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub drawing: BTreeMap<String, String>,
}

impl WrittenTopic {
    /// Returns a known topic in words.
    pub fn from_topic(topic: TopicId, later: bool) -> Self {
        Self::from_layout(TopicLayout::for_topic(topic), later)
    }

    /// Returns the topic with a layout.
    pub fn from_layout(layout: TopicLayout, later: bool) -> Self {
        Self {
            name: layout.name,
            message: layout.message,
            element: layout.element,
            header: layout.header,
            one: layout.is_one,
            later,
            may_be_infinite: layout.may_be_infinite,
            drawing: layout.drawing,
        }
    }

    /// Returns the topic, and registers it if it is new.
    ///
    /// # Errors
    /// As [`TopicLayout::register`].
    pub fn register(&self) -> Result<TopicId, LayoutError> {
        let layout = TopicLayout {
            name: self.name.clone(),
            message: self.message.clone(),
            element: self.element.clone(),
            header: self.header.clone(),
            is_one: self.one,
            may_be_infinite: self.may_be_infinite.clone(),
            drawing: self.drawing.clone(),
        };
        layout.register()
    }

    fn when(&self) -> When {
        if self.later {
            When::NextTick
        } else {
            When::ThisTick
        }
    }
}

/// Returns the input of an external program that reads a topic. Other external programs may write those that are built in.
pub fn input(topic: TopicId, written: &[WrittenTopic]) -> Input {
    let input = Input::new(Flow::Topic(topic), reading_time(topic, written));
    if topic.is_built_in() && topic != TopicId::Scan {
        input.optional()
    } else {
        input
    }
}

/// Returns the time at which messages of a topic count for an external program: as its writers declare it.
pub fn reading_time(topic: TopicId, written: &[WrittenTopic]) -> When {
    let facts = topic.facts();
    let known = written.iter().find(|known| known.name == facts.name);
    match topic {
        _ if known.is_some_and(|known| known.later) => When::NextTick,
        _ if !topic.is_built_in() => When::ThisTick,
        TopicId::WorldMap | TopicId::WorldShapes => When::Latched,
        TopicId::WorldState | TopicId::Scan | TopicId::Sightings | TopicId::Belief => {
            When::ThisTick
        }
        _ => When::NextTick,
    }
}

impl WrittenDeclaration {
    /// Registers the topics that it writes.
    ///
    /// # Errors
    /// [`DeclarationError`] for a topic that it writes.
    pub fn register(&self) -> Result<(), DeclarationError> {
        for output in &self.writes {
            output.topic.register()?;
            if !(1..=MAX_ELEMENTS).contains(&output.elements) {
                return Err(DeclarationError::Elements {
                    topic: output.topic.name.clone(),
                    elements: output.elements,
                });
            }
        }
        Ok(())
    }

    /// Returns it with the topics; those that it reads are known.
    ///
    /// # Errors
    /// [`DeclarationError`] names the topic.
    pub fn declaration(&self) -> Result<Declaration, DeclarationError> {
        self.register()?;
        let mut declared = Declaration::default().reads(Input::STATE);
        for output in &self.writes {
            declared = declared.writes(Output {
                flow: Flow::Topic(output.topic.register()?),
                when: output.topic.when(),
                elements: output.elements,
                is_sole: output.sole,
            });
        }
        for name in &self.reads {
            let topic = readable(name)?;
            let flow = Flow::Topic(topic);
            if declared.input(flow).is_none() {
                let own: Vec<WrittenTopic> =
                    self.writes.iter().map(|own| own.topic.clone()).collect();
                declared = declared.reads(input(topic, &own));
            }
        }
        Ok(declared)
    }
}

/// Returns the topic with this name that a program may read.
///
/// # Errors
/// [`DeclarationError`] if the topic is unknown, or not of the simulated history.
pub fn readable(name: &str) -> Result<TopicId, DeclarationError> {
    let topic = TopicId::from_name(name).filter(|topic| AnyTopic::find(*topic).is_some());
    let topic = topic.ok_or_else(|| DeclarationError::Unwritten(name.to_owned()))?;
    if !topic.facts().simulated
        || matches!(
            topic,
            TopicId::ObstacleEvents | TopicId::Commands | TopicId::Tree
        )
    {
        return Err(DeclarationError::Internal(name.to_owned()));
    }
    Ok(topic)
}
