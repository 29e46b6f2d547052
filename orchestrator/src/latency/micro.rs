//! One hop, by payload, by subscribers, and by what the receiver does until a message comes: our
//! publisher and subscriber against bare iceoryx2.

use std::time::Duration;

use super::baselines::{apart, placements};
use crate::bench::link::{Blocks, Carrier, Idle, Link, LinkOptions, OfWay, Placement, Way};
use crate::bench::{BenchError, Options, paired_ratio};
use crate::statistics::Percentiles;

/// Payloads [bytes].
pub const SIZES: [usize; 9] = [
    64,
    256,
    1 << 10,
    4 << 10,
    16 << 10,
    64 << 10,
    256 << 10,
    1 << 20,
    4 << 20,
];
/// The largest payload for which the hop has to be nearly as fast as bare iceoryx2 [bytes].
pub const GOAL_UP_TO: usize = 1 << 20;
/// Subscribers.
pub const SUBSCRIBERS: [usize; 5] = [1, 2, 4, 8, 16];
/// Payload where the number of subscribers or the idle strategy is varied [bytes].
const SMALL: usize = 64;

/// One measured hop.
#[derive(Debug, Clone)]
pub struct Hop {
    /// What varies: `payload`, `subscribers` or `idle`.
    pub part: &'static str,
    /// How the message went.
    pub way: Way,
    /// On which processors.
    pub placement: Placement,
    /// Payload [bytes].
    pub bytes: usize,
    /// Subscribers, each a process of its own.
    pub subscribers: usize,
    /// From before the sending until the receiver had it.
    pub latency: Percentiles,
    /// Of that, until the sender was done.
    pub sending: Percentiles,
    /// For ours: latency over that of bare iceoryx2, the median over pairs of neighbouring blocks.
    pub ratio: Option<f64>,
}

/// All hops.
#[derive(Debug, Clone, Default)]
pub struct Micro {
    /// In the order of measuring.
    pub hops: Vec<Hop>,
}

impl Micro {
    fn of(&self, part: &'static str) -> impl Iterator<Item = &Hop> {
        self.hops.iter().filter(move |hop| hop.part == part)
    }

    /// The largest ratio to bare iceoryx2 over the payloads that have to be as fast.
    pub fn worst_ratio(&self) -> Option<f64> {
        self.of("payload")
            .filter(|hop| hop.way.written && hop.bytes <= GOAL_UP_TO)
            .filter_map(|hop| hop.ratio)
            .max_by(f64::total_cmp)
    }

    /// Median latency of the largest payload over that of the smallest, both handed over untouched
    /// by ours: 1 if it is flat.
    pub fn flatness(&self) -> Option<f64> {
        let ours = || {
            self.of("payload")
                .filter(|hop| hop.way.carrier == Carrier::Ours && !hop.way.written)
        };
        let least = ours().min_by_key(|hop| hop.bytes)?;
        let most = ours().max_by_key(|hop| hop.bytes)?;
        Some(most.latency.p50 / least.latency.p50.max(1e-3))
    }
}

/// Measures everything; what was measured before an interruption is kept.
///
/// # Errors
/// [`BenchError`] says what could not be measured.
pub fn measure(
    options: &Options,
    say: &mut (impl FnMut(&str) + Send),
) -> Result<Micro, BenchError> {
    let mut micro = Micro::default();
    let hops = &mut micro.hops;
    let measured = by_payload(options, say, hops)
        .and_then(|()| by_subscribers(options, say, hops))
        .and_then(|()| by_idle(options, say, hops));
    match measured {
        Ok(()) | Err(BenchError::Interrupted) => Ok(micro),
        Err(error) => Err(error),
    }
}

fn by_payload(
    options: &Options,
    say: &mut (impl FnMut(&str) + Send),
    hops: &mut Vec<Hop>,
) -> Result<(), BenchError> {
    let ours = Way::new(Carrier::Ours, Idle::Spin);
    let raw = Way::new(Carrier::Raw, Idle::Spin);
    let ways = [ours, raw, ours.untouched(), raw.untouched()];
    apart(|| {
        let mut link = Link::start(LinkOptions {
            most: SIZES.into_iter().max().unwrap_or(SMALL),
            crowd: 0,
            placement: Placement::Unpinned,
        })?;
        for bytes in SIZES {
            say(&format!("one hop of {bytes} bytes"));
            let blocks = Blocks {
                ways: &ways,
                bytes,
                blocks: options.repeats(12, 3),
                messages: match bytes {
                    0..100_000 => options.repeats(1000, 150),
                    _ => options.repeats(200, 30),
                },
                pause: Duration::ZERO,
            };
            let measured = blocks.measure(&mut link, || options.check())?;
            hops.extend(pairs(&ways, &measured, |way| Hop {
                part: "payload",
                way,
                placement: Placement::Unpinned,
                bytes,
                subscribers: 1,
                latency: Percentiles::default(),
                sending: Percentiles::default(),
                ratio: None,
            }));
        }
        Ok(())
    })
}

fn by_subscribers(
    options: &Options,
    say: &mut (impl FnMut(&str) + Send),
    hops: &mut Vec<Hop>,
) -> Result<(), BenchError> {
    let ways = [
        Way::new(Carrier::Ours, Idle::Spin),
        Way::new(Carrier::Raw, Idle::Spin),
    ];
    for subscribers in SUBSCRIBERS {
        options.check()?;
        say(&format!("one hop to {subscribers} subscribers"));
        apart(|| {
            let mut link = Link::start(LinkOptions {
                most: SMALL,
                crowd: subscribers - 1,
                placement: Placement::Unpinned,
            })?;
            let blocks = Blocks {
                ways: &ways,
                bytes: SMALL,
                blocks: options.repeats(12, 3),
                messages: options.repeats(1000, 150),
                pause: Duration::ZERO,
            };
            let measured = blocks.measure(&mut link, || options.check())?;
            hops.extend(pairs(&ways, &measured, |way| Hop {
                part: "subscribers",
                way,
                placement: Placement::Unpinned,
                bytes: SMALL,
                subscribers,
                latency: Percentiles::default(),
                sending: Percentiles::default(),
                ratio: None,
            }));
            Ok(())
        })?;
    }
    Ok(())
}

fn by_idle(
    options: &Options,
    say: &mut (impl FnMut(&str) + Send),
    hops: &mut Vec<Hop>,
) -> Result<(), BenchError> {
    for placement in placements()? {
        options.check()?;
        say(&format!("idle strategies, {}", placement.name()));
        apart(|| {
            let mut link = Link::start(LinkOptions {
                most: SMALL,
                crowd: 0,
                placement,
            })?;
            for idle in [Idle::Spin, Idle::Yield, Idle::Futex, Idle::Event] {
                if placement == Placement::OneCore && idle == Idle::Spin {
                    // Nobody else runs there while one asks again and again.
                    continue;
                }
                let ways = [Way::new(Carrier::Ours, idle), Way::new(Carrier::Raw, idle)];
                let blocks = Blocks {
                    ways: &ways,
                    bytes: SMALL,
                    blocks: options.repeats(10, 3),
                    messages: options.repeats(300, 50),
                    pause: Duration::ZERO,
                };
                let measured = blocks.measure(&mut link, || options.check())?;
                hops.extend(pairs(&ways, &measured, |way| Hop {
                    part: "idle",
                    way,
                    placement,
                    bytes: SMALL,
                    subscribers: 1,
                    latency: Percentiles::default(),
                    sending: Percentiles::default(),
                    ratio: None,
                }));
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// What was measured, ours with the ratio to bare iceoryx2 with as much written.
fn pairs(ways: &[Way], measured: &[OfWay], hop: impl Fn(Way) -> Hop) -> Vec<Hop> {
    let of = |way: &Way| {
        let at = ways.iter().position(|other| other == way)?;
        measured.get(at)
    };
    ways.iter()
        .zip(measured)
        .map(|(way, own)| {
            let raw = Way {
                carrier: Carrier::Raw,
                ..*way
            };
            let ratio = (way.carrier == Carrier::Ours)
                .then(|| paired_ratio(&own.medians, &of(&raw)?.medians))
                .flatten();
            Hop {
                latency: own.latency.percentiles(),
                sending: own.sending.percentiles(),
                ratio: ratio.map(|ratio| ratio.median),
                ..hop(*way)
            }
        })
        .collect()
}
