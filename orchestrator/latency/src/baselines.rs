//! What the messages of a mission would cost over other transports, between two processes that do
//! nothing else.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use statistics::Distribution;

use super::link::{Link, LinkError, Placement, Transport};
use super::of_log::Measured;

/// Time between two messages: the receiver has fallen asleep, as in a mission.
const PAUSE: Duration = Duration::from_micros(500);
/// Topics whose messages are compared, if the mission has them.
const TOPICS: [&str; 3] = ["world/state", "perception/belief", "robot/command"];

/// One transport for messages of one size.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// What carried them.
    pub transport: Transport,
    /// On which processors.
    pub placement: Placement,
    /// Messages of which topic are as large.
    pub topic: &'static str,
    /// Their size (bytes).
    pub bytes: usize,
    /// One way, from before the sending until all of it was there.
    pub latency: Distribution,
}

/// The topics of a mission that are compared, with the mean size of their messages (bytes).
pub fn payloads(measured: &Measured) -> Vec<(&'static str, usize)> {
    TOPICS
        .into_iter()
        .filter_map(|topic| {
            let mean = measured.sizes.get(topic)?.mean();
            // Whole elements of the link's messages.
            let bytes = usize::try_from(mean).ok()?.next_multiple_of(8).max(8);
            Some((topic, bytes))
        })
        .collect()
}

/// Repetitions of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct Repetitions {
    /// Blocks of every transport; one more warms up.
    pub blocks: usize,
    /// Messages of a block.
    pub messages: usize,
}

impl Repetitions {
    /// For figures, and (`quick`) for a first impression.
    pub fn new(quick: bool) -> Self {
        if quick {
            Self {
                blocks: 2,
                messages: 30,
            }
        } else {
            Self {
                blocks: 5,
                messages: 60,
            }
        }
    }
}

/// Measures all transports with these payloads; what was measured before an interruption is kept.
///
/// # Errors
/// [`LinkError`] says what could not be measured.
pub fn measure(
    payloads: &[(&'static str, usize)],
    repetitions: Repetitions,
    interrupted: &AtomicBool,
    say: &mut (impl FnMut(&str) + Send),
) -> Result<Vec<Baseline>, LinkError> {
    let mut all = Vec::new();
    for placement in Placement::possible()? {
        if interrupted.load(Ordering::SeqCst) {
            break;
        }
        say(&format!("baselines, {}", placement.name()));
        // On a thread of its own, which is pinned.
        let joined = std::thread::scope(|scope| {
            let work = || measure_placed(payloads, placement, repetitions, interrupted);
            scope.spawn(work).join()
        });
        let measured = joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        all.extend(measured?);
    }
    Ok(all)
}

/// As [`measure`], on these processors.
fn measure_placed(
    payloads: &[(&'static str, usize)],
    placement: Placement,
    repetitions: Repetitions,
    interrupted: &AtomicBool,
) -> Result<Vec<Baseline>, LinkError> {
    let most = payloads.iter().map(|(_, bytes)| *bytes).max().unwrap_or(8);
    let mut link = Link::start(most, placement)?;
    let mut found = Vec::new();
    for &(topic, bytes) in payloads {
        let new = |transport| {
            Some(Baseline {
                transport,
                placement,
                topic,
                bytes,
                latency: Distribution::new()?,
            })
        };
        let mut own: Vec<Baseline> = Transport::ALL.into_iter().filter_map(new).collect();
        // The transports take turns, so that what else the machine does is in all of them.
        for block in 0..=repetitions.blocks {
            for baseline in &mut own {
                if interrupted.load(Ordering::SeqCst) {
                    return Ok(found);
                }
                let taken = link.block(baseline.transport, bytes, repetitions.messages, PAUSE)?;
                // The first block touches the memory for the first time.
                if block > 0 {
                    for ns in taken {
                        baseline.latency.record(ns);
                    }
                }
            }
        }
        found.extend(own);
    }
    Ok(found)
}
