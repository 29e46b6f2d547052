//! Latencies of messages as large as those of a mission over Protean's bus and other transports,
//! between two otherwise idle processes.

use std::time::Duration;

use latency::mission::{RunOptions, run};
use scenario::Loader;
use statistics::Distribution;

use super::link::{Link, LinkError, Placement, Transport};
use super::report::Figure;
use super::{Options, Result, say};

const ITEM: &str = "links";
/// Transport beside which the others are set.
const BARE: Transport = Transport::RawWoken;
/// Time between two messages: long enough that the receiver sleeps, as in a mission.
const PAUSE: Duration = Duration::from_micros(500);
/// Topics whose messages are compared.
const TOPICS: [&str; 3] = ["world/state", "perception/belief", "robot/command"];

/// Latency of one transport for messages of one size.
struct LinkLatency {
    transport: Transport,
    placement: Placement,
    topic: &'static str,
    /// Size of the messages (bytes).
    bytes: usize,
    /// One-way latency: from before sending until the whole message was received.
    latency: Distribution,
}

/// Repetitions of a measurement.
#[derive(Clone, Copy)]
struct Repetitions {
    /// Blocks per transport; one more block warms up.
    blocks: usize,
    /// Messages per block.
    messages: usize,
}

/// Measures all transports in all placements with the mean sizes of the messages of the chase.
///
/// # Errors
/// The reason of a failed mission, or of a transport that cannot be measured.
pub fn measure(options: Options) -> Result<Vec<Figure>> {
    say("links, sizes of the messages of the chase");
    let payloads = payloads()?;
    let repetitions = Repetitions {
        blocks: options.repeats(5, 2),
        messages: options.repeats(60, 30),
    };
    let mut figures = Vec::new();
    for placement in Placement::possible()? {
        say(&format!("links, {}", placement.name()));
        // On a separate thread, which is pinned.
        let joined = std::thread::scope(|scope| {
            let work = || measure_placed(&payloads, placement, repetitions);
            scope.spawn(work).join()
        });
        let measured = joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        for link in &measured {
            let bare = measured.iter().find(|other| {
                (other.topic, other.transport) == (link.topic, BARE) && link.transport != BARE
            });
            for (part, at) in [("p50", 0.5), ("p99", 0.99)] {
                let name = format!(
                    "{}, {} B, {}, {}, {part}",
                    link.topic,
                    link.bytes,
                    link.placement.name(),
                    link.transport.name()
                );
                let figure = Figure::once(ITEM, name, link.latency.at(at), "us");
                figures.push(match bare {
                    Some(bare) => figure.against(BARE.name(), bare.latency.at(at)),
                    None => figure,
                });
            }
        }
    }
    Ok(figures)
}

/// Returns the topics that are compared, with the mean size of their messages in a short chase
/// (bytes).
fn payloads() -> Result<Vec<(&'static str, usize)>> {
    let short = ["rules.time_limit=2".to_owned()];
    let scenario = Loader::new(kinds::KINDS).load("chase", &short, None)?;
    let options = RunOptions {
        quiet: true,
        ..RunOptions::default()
    };
    let (measured, _) = run(&scenario, &options)?;
    let of = |topic| {
        let mean = measured.sizes.get(topic)?.mean();
        // A multiple of the element size of the link's messages.
        let bytes = usize::try_from(mean).ok()?.next_multiple_of(8).max(8);
        Some((topic, bytes))
    };
    Ok(TOPICS.into_iter().filter_map(of).collect())
}

/// Measures all transports on these processors.
fn measure_placed(
    payloads: &[(&'static str, usize)],
    placement: Placement,
    repetitions: Repetitions,
) -> std::result::Result<Vec<LinkLatency>, LinkError> {
    let max = payloads.iter().map(|(_, bytes)| *bytes).max().unwrap_or(8);
    let mut link = Link::start(max, placement)?;
    let mut found = Vec::new();
    for &(topic, bytes) in payloads {
        let new = |transport| {
            Some(LinkLatency {
                transport,
                placement,
                topic,
                bytes,
                latency: Distribution::new()?,
            })
        };
        let mut own: Vec<LinkLatency> = Transport::ALL.into_iter().filter_map(new).collect();
        // The transports alternate, so that other load on the machine affects all of them.
        for block in 0..=repetitions.blocks {
            for measured in &mut own {
                let taken = link.block(measured.transport, bytes, repetitions.messages, PAUSE)?;
                // The first block touches the memory for the first time.
                if block > 0 {
                    for ns in taken {
                        measured.latency.record(ns);
                    }
                }
            }
        }
        found.extend(own);
    }
    Ok(found)
}
