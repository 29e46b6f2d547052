//! What the recorder knows of every topic, without its Rust types.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::LazyLock;

use ipc_types::message::Message;
use ipc_types::topics::{
    Belief, Commands, Coverage, Dominance, ObstacleEvents, Plan, Predictions, ProcessEvents,
    ProcessLog, Scan, Shape, Sightings, Status, Topic, TopicVisitor, Tree, Verdicts, Waypoints,
    WorldEvents, WorldMap, WorldState, for_each_topic,
};
use ipc_types::{cdr, schema};

use super::checks::Finite;

/// What the recorder does with the messages of a topic besides writing them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    State,
    Map,
    Event,
    Coverage,
    Obstacle,
    Scan,
    Sighting,
    Belief,
    Command,
    Plan,
    Tree,
    Waypoint,
    Verdict,
    Prediction,
    Dominance,
    Status,
    ProcessEvent,
    ProcessLog,
    Other,
}

impl Role {
    pub(crate) fn of(name: &str) -> Self {
        match name {
            WorldState::NAME => Self::State,
            WorldMap::NAME => Self::Map,
            WorldEvents::NAME => Self::Event,
            Coverage::NAME => Self::Coverage,
            ObstacleEvents::NAME => Self::Obstacle,
            Scan::NAME => Self::Scan,
            Sightings::NAME => Self::Sighting,
            Belief::NAME => Self::Belief,
            Commands::NAME => Self::Command,
            Plan::NAME => Self::Plan,
            Tree::NAME => Self::Tree,
            Waypoints::NAME => Self::Waypoint,
            Verdicts::NAME => Self::Verdict,
            Predictions::NAME => Self::Prediction,
            Dominance::NAME => Self::Dominance,
            Status::NAME => Self::Status,
            ProcessEvents::NAME => Self::ProcessEvent,
            ProcessLog::NAME => Self::ProcessLog,
            _ => Self::Other,
        }
    }
}

/// One topic of [`ipc_types::topics`].
#[derive(Debug)]
pub(super) struct TopicInfo {
    pub(super) name: &'static str,
    pub(super) role: Role,
    pub(super) simulated: bool,
    pub(super) shape: Shape,
    /// Size of the user header [bytes].
    pub(super) header_bytes: usize,
    /// Size of one element [bytes].
    pub(super) element_bytes: usize,
    pub(super) schema_name: String,
    pub(super) schema: String,
    /// Size, alignment and fingerprint of the message, so that a replay can refuse a mismatch.
    pub(super) metadata: BTreeMap<String, String>,
    pub(super) finite: Finite,
}

impl TopicInfo {
    pub(super) fn of<T: Topic>() -> Self {
        let (header, element) = (T::Header::DESCRIPTOR, T::Element::DESCRIPTOR);
        let metadata = [
            ("schema_hash", schema::hash::<T>()),
            ("header_type", header.name.to_owned()),
            ("header_bytes", header.size.to_string()),
            ("element_type", element.name.to_owned()),
            ("element_bytes", element.size.to_string()),
            ("element_align", element.align.to_string()),
            ("simulated", T::SIMULATED.to_string()),
        ];
        Self {
            name: T::NAME,
            role: Role::of(T::NAME),
            simulated: T::SIMULATED,
            shape: T::SHAPE,
            header_bytes: header.size,
            element_bytes: element.size,
            schema_name: schema::message_name::<T>(),
            schema: schema::ros2msg::<T>(),
            metadata: metadata
                .into_iter()
                .map(|(k, v)| (k.to_owned(), v))
                .collect(),
            finite: Finite::of(T::NAME, &header, &element),
        }
    }

    /// Whether a message with this many elements has a CDR form that readers can decode.
    pub(super) fn is_decodable(&self, elements: usize) -> bool {
        self.shape == Shape::Many || elements == 1
    }
}

/// All topics, in the order of [`ipc_types::topics::NAMES`]: a topic's place in it is its rank.
pub(super) fn all() -> &'static [TopicInfo] {
    static ALL: LazyLock<Vec<TopicInfo>> = LazyLock::new(collect);
    &ALL
}

fn collect() -> Vec<TopicInfo> {
    struct Collect(Vec<TopicInfo>);
    impl TopicVisitor for Collect {
        type Error = Infallible;
        fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
            self.0.push(TopicInfo::of::<T>());
            Ok(())
        }
    }
    let mut collect = Collect(Vec::new());
    let Ok(()) = for_each_topic(&mut collect);
    collect.0
}

/// Place of a topic in [`ipc_types::topics::NAMES`]; `usize::MAX` for a topic that is not in it.
pub(super) fn rank<T: Topic>() -> usize {
    ipc_types::topics::NAMES
        .iter()
        .position(|&name| name == T::NAME)
        .unwrap_or(usize::MAX)
}

/// A logged message seen as its topic's type, without copying it into a vector.
pub(super) fn view<T: Topic>(
    bytes: &[u8],
) -> Option<(
    T::Header,
    impl ExactSizeIterator<Item = T::Element> + Clone + '_,
)> {
    use zerocopy::FromBytes;
    let (header, _) = T::Header::read_from_prefix(bytes.get(4..)?).ok()?;
    let size = size_of::<T::Element>();
    let elements = bytes.get(cdr::encoded_len::<T>(0)..)?;
    let elements = match T::SHAPE {
        Shape::One => elements.get(..size)?,
        Shape::Many => elements,
    };
    // The bytes of the log are not aligned: `read_from_bytes` copies, and any bytes are a message.
    let elements = elements
        .chunks_exact(size)
        .map(|bytes| T::Element::read_from_bytes(bytes).unwrap_or_default());
    Some((header, elements))
}
