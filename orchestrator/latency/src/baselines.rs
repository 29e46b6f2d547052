//! Latencies of the messages of a mission over other transports, between two otherwise idle
//! processes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use statistics::Distribution;

use super::link::{Link, LinkError, Placement, Transport};
use super::of_log::Measured;

/// Time between two messages: long enough that the receiver sleeps, as in a mission.
const PAUSE: Duration = Duration::from_micros(500);
/// Topics whose messages are compared, if the mission has them.
const TOPICS: [&str; 3] = ["world/state", "perception/belief", "robot/command"];

/// Latency of one transport for messages of one size.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// Transport of the messages.
    pub transport: Transport,
    /// Placement of the processes on processors.
    pub placement: Placement,
    /// Topic whose messages have this size.
    pub topic: &'static str,
    /// Size of the messages (bytes).
    pub bytes: usize,
    /// One-way latency: from before sending until the whole message was received.
    pub latency: Distribution,
}

/// Returns the topics of a mission that are compared, with the mean size of their messages (bytes).
pub fn payloads(measured: &Measured) -> Vec<(&'static str, usize)> {
    TOPICS
        .into_iter()
        .filter_map(|topic| {
            let mean = measured.sizes.get(topic)?.mean();
            // A multiple of the element size of the link's messages.
            let bytes = usize::try_from(mean).ok()?.next_multiple_of(8).max(8);
            Some((topic, bytes))
        })
        .collect()
}

/// Repetitions of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct Repetitions {
    /// Blocks per transport; one more block warms up.
    pub blocks: usize,
    /// Messages per block.
    pub messages: usize,
}

impl Repetitions {
    /// Returns the repetitions for figures, or (`quick`) for a first impression.
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

/// Measures all transports with these payloads; keeps results from before an interruption.
///
/// # Errors
/// [`LinkError`] if a transport cannot be measured.
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
        // On a separate thread, which is pinned.
        let joined = std::thread::scope(|scope| {
            let work = || measure_placed(payloads, placement, repetitions, interrupted);
            scope.spawn(work).join()
        });
        let measured = joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        all.extend(measured?);
    }
    Ok(all)
}

/// Like [`measure`], on these processors.
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
        // The transports alternate, so that other load on the machine affects all of them.
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
