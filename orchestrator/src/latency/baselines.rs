//! What the messages of a mission would cost over other ways, between two processes that do nothing
//! else.

use std::time::Duration;

use crate::bench::link::{Blocks, Carrier, Idle, Link, LinkOptions, Placement, Way};
use crate::bench::pinning::allowed;
use crate::bench::{BenchError, Options};
use crate::latency::of_log::Measured;
use crate::statistics::Distribution;

/// Time between two messages: the receiver has fallen asleep, as in a mission.
const PAUSE: Duration = Duration::from_micros(500);
/// Topics whose messages are compared, if the mission has them.
const TOPICS: [&str; 3] = ["world/state", "perception/belief", "robot/command"];

/// One way for messages of one size.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// What carried them.
    pub way: Way,
    /// On which processors.
    pub placement: Placement,
    /// Messages of which topic are as large.
    pub topic: &'static str,
    /// Their size [bytes].
    pub bytes: usize,
    /// One way, from before the sending until all of it was there.
    pub latency: Distribution,
}

/// The topics of a mission that are compared, with the mean size of their messages [bytes].
pub fn payloads(measured: &Measured) -> Vec<(&'static str, usize)> {
    TOPICS
        .into_iter()
        .filter_map(|topic| {
            let mean = measured.sizes.get(topic)?.mean();
            // Whole elements of the bench's messages.
            let bytes = usize::try_from(mean).ok()?.next_multiple_of(8).max(8);
            Some((topic, bytes))
        })
        .collect()
}

/// The ways of a placement. On one core a receiver that polls must let the sender run.
pub fn ways(placement: Placement) -> [Way; 5] {
    let poll = if placement == Placement::OneCore {
        Idle::Yield
    } else {
        Idle::Spin
    };
    [
        Way::new(Carrier::Raw, poll),
        Way::new(Carrier::Raw, Idle::Event),
        Way::new(Carrier::Ours, Idle::Futex),
        Way::new(Carrier::Socket, Idle::Read),
        Way::new(Carrier::Pipe, Idle::Read),
    ]
}

/// The placements that this machine allows.
///
/// # Errors
/// [`BenchError`] if the system does not tell.
pub fn placements() -> Result<Vec<Placement>, BenchError> {
    let mut placements = vec![Placement::Unpinned, Placement::OneCore];
    if allowed()?.len() > 1 {
        placements.push(Placement::TwoCores);
    }
    Ok(placements)
}

/// Does something on a thread of its own, which may pin itself.
///
/// # Errors
/// Those of `work`.
pub fn apart<T: Send>(
    work: impl FnOnce() -> Result<T, BenchError> + Send,
) -> Result<T, BenchError> {
    let joined = std::thread::scope(|scope| scope.spawn(work).join());
    joined.unwrap_or_else(|_| {
        Err(BenchError::Process {
            process: "the measuring thread".into(),
            how: "panicked".into(),
        })
    })
}

/// Measures all ways with these payloads; what was measured before an interruption is kept.
///
/// # Errors
/// [`BenchError`] says what could not be measured.
pub fn measure(
    payloads: &[(&'static str, usize)],
    options: &Options,
    say: &mut (impl FnMut(&str) + Send),
) -> Result<Vec<Baseline>, BenchError> {
    let most = payloads.iter().map(|(_, bytes)| *bytes).max().unwrap_or(8);
    let mut all = Vec::new();
    for placement in placements()? {
        say(&format!("baselines, {}", placement.name()));
        let measured = apart(|| {
            let mut link = Link::start(LinkOptions {
                most,
                crowd: 0,
                placement,
            })?;
            let mut found = Vec::new();
            let ways = ways(placement);
            for (topic, bytes) in payloads {
                let blocks = Blocks {
                    ways: &ways,
                    bytes: *bytes,
                    blocks: options.repeats(5, 2),
                    messages: options.repeats(60, 30),
                    pause: PAUSE,
                };
                let measured = match blocks.measure(&mut link, || options.check()) {
                    Err(BenchError::Interrupted) => break,
                    measured => measured?,
                };
                let measured = ways.into_iter().zip(measured);
                found.extend(measured.map(|(way, of_way)| Baseline {
                    way,
                    placement,
                    topic,
                    bytes: *bytes,
                    latency: of_way.latency,
                }));
            }
            Ok(found)
        })?;
        all.extend(measured);
        if options.check().is_err() {
            break;
        }
    }
    Ok(all)
}
