//! Faults of bags.

use config::Diagnostics;
use ros_messages::CdrError;

/// Reason why a bag cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum BagFault {
    /// Topics are missing.
    #[error(
        "no message of {wanted}: expected at least one; --topic NAME=TOPIC names others, the bag has {known}"
    )]
    Missing {
        /// The topics.
        wanted: String,
        /// Topics that can be imported, with their types.
        known: String,
    },
    /// A topic has another type or encoding.
    #[error(
        "{topic} is {found}: expected {expected} in cdr; --topic NAME=TOPIC names another topic"
    )]
    Type {
        /// The topic.
        topic: String,
        /// Its type and encoding.
        found: String,
        /// Expected type.
        expected: &'static str,
    },
    /// A message is not CDR of its type.
    #[error("{topic}, message {number}: {source}")]
    Message {
        /// The topic.
        topic: String,
        /// Number of the message in its file, from 1.
        number: u64,
        /// The fault.
        source: CdrError,
    },
    /// A message has values that no run takes.
    #[error("{topic}: the message of {at_s:.3} s is not usable: expected {expected}")]
    Value {
        /// The topic.
        topic: String,
        /// Time in its header (s).
        at_s: f64,
        /// The expectation.
        expected: &'static str,
    },
    /// No message near a tick.
    #[error(
        "{topic}: no message from {from_s:.3} s to {to_s:.3} s: expected one within {max_age_s} s of each tick; --max-age S permits \
         more"
    )]
    Gap {
        /// The topic.
        topic: String,
        /// Time of the message before (s).
        from_s: f64,
        /// Time of the message after (s).
        to_s: f64,
        /// The limit (s).
        max_age_s: f64,
    },
    /// There is no time at which all topics have messages.
    #[error("its topics were recorded one after another: expected a time with messages of all")]
    Apart,
    /// The scenario does not fit the map, the starts or the scanners of the bag.
    #[error("the scenario does not fit its map, starts and scanners:\n{0}")]
    Scenario(Diagnostics),
}
