//! Messages of topics as a library gets them.

use runtime::raw_inputs::RawInputs;

use crate::abi::{Message, Messages};
use crate::error::Unexpected;

/// The messages of the topics that a library reads, in a tick.
#[derive(Debug, Default)]
pub struct Records {
    topics: Vec<(&'static str, Vec<Message>)>,
    /// Bytes of headers and elements, aligned as numbers of any type.
    _words: Vec<Vec<u64>>,
}

impl Records {
    /// Returns the messages of a tick.
    pub fn new(inputs: &RawInputs) -> Self {
        let mut words = Vec::new();
        let mut kept = |bytes: &[u8]| {
            let aligned = aligned(bytes);
            let first = aligned.as_ptr();
            words.push(aligned);
            first.cast()
        };
        let topics = inputs.topics().iter().map(|input| {
            let facts = input.topic().facts();
            let messages = input.messages().iter().map(|raw| Message {
                header: kept(&raw.header),
                elements: kept(&raw.elements),
                count: raw.elements.len() / facts.element.size.max(1),
                tick: raw.tick,
                source: raw.source,
            });
            (facts.name, messages.collect())
        });
        Self {
            topics: topics.collect(),
            _words: words,
        }
    }

    /// Returns the messages of a topic, which are valid as long as the records.
    ///
    /// # Errors
    /// [`Unexpected`] names the topics.
    pub fn messages(&self, topic: &str) -> Result<Messages, Unexpected> {
        let mut topics = self.topics.iter();
        match topics.find(|(name, _)| *name == topic) {
            Some((_, messages)) => Ok(Messages {
                all: messages.as_ptr(),
                count: messages.len(),
            }),
            None => Err(unknown(
                "protean_read",
                topic,
                self.topics.iter().map(|(name, _)| *name),
            )),
        }
    }
}

/// Returns the error about a topic that a library has not declared.
pub fn unknown(
    function: &str,
    topic: &str,
    known: impl Iterator<Item = &'static str>,
) -> Unexpected {
    let known: Vec<&str> = known.collect();
    let expected = match known.as_slice() {
        [] => "no call, as its table names no topic".to_owned(),
        [only] => (*only).to_owned(),
        all => format!("one of {}", all.join(", ")),
    };
    Unexpected::new(format!("{function}: topic {topic:?}"), expected)
}

fn aligned(bytes: &[u8]) -> Vec<u64> {
    let word = |bytes: &[u8]| {
        let mut word = [0; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        u64::from_ne_bytes(word)
    };
    bytes.chunks(8).map(word).collect()
}
