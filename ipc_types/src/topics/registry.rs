//! Identifiers of topics: the built-in ones are constants, others are registered by name when they are first used.

use std::sync::{OnceLock, PoisonError, RwLock};

use super::built_in::FACTS;
use super::topic_id::TopicId;
use super::{Qos, RunSize, TopicFacts};

/// Facts of the topics that are not built in, in the order of registration.
static OTHERS: RwLock<Vec<&'static TopicFacts>> = RwLock::new(Vec::new());

impl TopicId {
    /// Returns the identifier of a topic that is not built in, and registers it if it is new. Of two topics with one
    /// name the first counts; a port of the other finds another layout.
    pub fn intern(facts: &'static TopicFacts) -> Self {
        if let Some(known) = Self::from_name(facts.name) {
            return known;
        }
        let mut others = OTHERS.write().unwrap_or_else(PoisonError::into_inner);
        let place = others.iter().position(|other| other.name == facts.name);
        let place = place.unwrap_or_else(|| {
            others.push(facts);
            others.len() - 1
        });
        Self::from_index(FACTS.len() + place)
    }

    /// All topics known to this program: the built-in ones, then the others in the order of registration.
    pub fn all() -> impl ExactSizeIterator<Item = Self> + Clone {
        (0..Self::count()).map(Self::from_index)
    }

    /// Number of topics known to this program.
    pub fn count() -> usize {
        let others = OTHERS.read().unwrap_or_else(PoisonError::into_inner);
        FACTS.len() + others.len()
    }

    /// Returns `true` for a topic of Protean's own processes.
    pub const fn is_built_in(self) -> bool {
        self.rank() < FACTS.len()
    }

    /// The topic with this name, if this program knows it.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|topic| topic.name() == name)
    }

    /// The facts of the topic.
    pub fn facts(self) -> &'static TopicFacts {
        if let Some(facts) = FACTS.get(self.rank()) {
            return facts;
        }
        let others = OTHERS.read().unwrap_or_else(PoisonError::into_inner);
        // Identifiers come from registration, which nothing undoes.
        others[self.rank() - FACTS.len()]
    }

    /// Name of the service and of the log's channel.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Quality of service in a run of this size.
    pub fn qos(self, size: &RunSize) -> Qos {
        (self.facts().qos)(size)
    }

    /// Returns `true` if only one process of a run publishes it.
    pub fn has_one_publisher(self) -> bool {
        let size = RunSize {
            robots: 1,
            processes: 2,
            events: 1,
        };
        self.qos(&size).publishers == 1
    }
}

/// A value of every topic, made when it is first asked for.
#[derive(Debug)]
pub struct PerTopic<V: 'static> {
    make: fn(TopicId) -> V,
    built_in: [OnceLock<V>; FACTS.len()],
    others: RwLock<Vec<(TopicId, &'static V)>>,
}

impl<V> PerTopic<V> {
    /// Creates it with the function that makes a value.
    pub const fn new(make: fn(TopicId) -> V) -> Self {
        Self {
            make,
            built_in: [const { OnceLock::new() }; FACTS.len()],
            others: RwLock::new(Vec::new()),
        }
    }

    /// Returns the value of a topic.
    pub fn get(&'static self, topic: TopicId) -> &'static V {
        if let Some(value) = self.built_in.get(topic.rank()) {
            return value.get_or_init(|| (self.make)(topic));
        }
        let find = |others: &[(TopicId, &'static V)]| {
            let found = others.iter().find(|(known, _)| *known == topic);
            found.map(|(_, value)| *value)
        };
        let known = find(&self.others.read().unwrap_or_else(PoisonError::into_inner));
        known.unwrap_or_else(|| {
            let value = (self.make)(topic);
            let mut others = self.others.write().unwrap_or_else(PoisonError::into_inner);
            find(&others).unwrap_or_else(|| {
                // Lives as long as the registration of the topic: until the end of the program.
                let value: &'static V = Box::leak(Box::new(value));
                others.push((topic, value));
                value
            })
        })
    }
}
