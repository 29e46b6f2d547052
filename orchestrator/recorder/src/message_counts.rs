//! Number of messages of a run.

use core::fmt;
use std::collections::BTreeMap;

use ipc_types::topics::TopicId;

/// Number of messages of a run or log. The first is the same in every run of a scenario with one seed.
///
/// ```
/// use recorder::MessageCounts;
///
/// let topics = [("world/state", 400), ("robot/command", 800), ("process/status", 17), ("/tf", 400)];
/// let topics = topics.map(|(topic, messages)| (topic.to_owned(), messages)).into();
/// let counts = MessageCounts::from_topics(&topics, |messages| *messages);
/// assert_eq!(counts.simulated, 1200);
/// assert_eq!(counts.to_string(), "1200 simulated, 400 for viewers, 17 of processes");
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MessageCounts {
    /// Messages of the simulated history: those that the digest covers.
    pub simulated: u64,
    /// Messages on channels for viewers only.
    pub viewer: u64,
    /// Heartbeats, control and output of processes. Their number depends on the clock.
    pub process: u64,
}

impl MessageCounts {
    /// Adds up the numbers of messages of topics, by name.
    pub fn from_topics<T>(topics: &BTreeMap<String, T>, messages: impl Fn(&T) -> u64) -> Self {
        let mut counts = Self::default();
        for (topic, entry) in topics {
            *match TopicId::from_name(topic) {
                Some(topic) if topic.facts().simulated => &mut counts.simulated,
                Some(_) => &mut counts.process,
                None => &mut counts.viewer,
            } += messages(entry);
        }
        counts
    }
}

impl fmt::Display for MessageCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} simulated", self.simulated)?;
        if self.viewer > 0 {
            write!(f, ", {} for viewers", self.viewer)?;
        }
        if self.process > 0 {
            write!(f, ", {} of processes", self.process)?;
        }
        Ok(())
    }
}
