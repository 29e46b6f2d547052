//! Blocks of messages over several ways, which take turns.

use std::time::Duration;

use super::{Link, Way};
use crate::bench::BenchError;
use crate::statistics::Distribution;

/// Blocks of messages over several ways, which take turns.
#[derive(Debug, Clone, Copy)]
pub struct Blocks<'a> {
    /// The ways.
    pub ways: &'a [Way],
    /// Payload of every message.
    pub bytes: usize,
    /// Blocks of every way; one more warms up.
    pub blocks: usize,
    /// Messages of a block.
    pub messages: usize,
    /// Time between the arrival of one and the sending of the next.
    pub pause: Duration,
}

/// What one way took.
#[derive(Debug, Clone)]
pub struct OfWay {
    /// Of all messages.
    pub latency: Distribution,
    /// Of all messages, the sender's share.
    pub sending: Distribution,
    /// Of every block, the median latency [us].
    pub medians: Vec<f64>,
}

impl Blocks<'_> {
    /// Measures; `check` is asked before every block whether to go on.
    ///
    /// # Errors
    /// [`BenchError`] if a message does not arrive, or what `check` says.
    pub fn measure(
        &self,
        link: &mut Link,
        mut check: impl FnMut() -> Result<(), BenchError>,
    ) -> Result<Vec<OfWay>, BenchError> {
        let new = || {
            Some(OfWay {
                latency: Distribution::new()?,
                sending: Distribution::new()?,
                medians: Vec::new(),
            })
        };
        let mut all: Vec<OfWay> = self.ways.iter().filter_map(|_| new()).collect();
        for block in 0..=self.blocks {
            for (way, of_way) in self.ways.iter().zip(&mut all) {
                check()?;
                let taken = link.block(*way, self.bytes, self.messages, self.pause)?;
                // The first block touches the memory for the first time.
                let Some(mut own) = Distribution::new().filter(|_| block > 0) else {
                    continue;
                };
                for message in taken {
                    own.record(message.latency_ns);
                    of_way.latency.record(message.latency_ns);
                    of_way.sending.record(message.sending_ns);
                }
                of_way.medians.push(own.at(0.5));
            }
        }
        Ok(all)
    }
}
