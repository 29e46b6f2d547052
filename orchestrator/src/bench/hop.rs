//! One message from one process to another, both polling: our publisher and subscriber against bare
//! iceoryx2 with the same bytes. `protean latency --micro` measures more of the same.

use std::time::Duration;

use super::link::{Blocks, Carrier, Idle, Link, LinkOptions, Placement, Way};
use super::report::{Figure, Goal};
use super::stats::{Spread, paired_ratio};
use super::{BenchError, Deadline, Options};

const ITEM: &str = "hop";
/// How much longer than the raw hop ours may take.
pub const GOAL: f64 = 1.2;
/// Payloads [bytes], each a multiple of four.
const SIZES: [usize; 5] = [64, 1 << 10, 16 << 10, 256 << 10, 1 << 20];

/// Measures every size.
///
/// # Errors
/// [`BenchError`] says what could not be measured.
pub fn measure(options: &Options, say: &mut impl FnMut(&str)) -> Result<Vec<Figure>, BenchError> {
    let deadline = Deadline::new();
    let mut link = Link::start(LinkOptions {
        most: SIZES.into_iter().max().unwrap_or(1),
        crowd: 0,
        placement: Placement::Unpinned,
    })?;
    let mut figures = Vec::new();
    for bytes in SIZES {
        say(&format!("one hop of {}", size_name(bytes)));
        figures.extend(size(&mut link, bytes, options, deadline)?);
    }
    Ok(figures)
}

/// A number of bytes in words: `64 B`, `16 KiB`.
pub fn size_name(bytes: usize) -> String {
    match bytes {
        b if b >= 1 << 20 && b % (1 << 20) == 0 => format!("{} MiB", b >> 20),
        b if b >= 1 << 10 && b % (1 << 10) == 0 => format!("{} KiB", b >> 10),
        b => format!("{b} B"),
    }
}

/// Blocks of all ways in turn with this payload.
fn size(
    link: &mut Link,
    bytes: usize,
    options: &Options,
    deadline: Deadline,
) -> Result<Vec<Figure>, BenchError> {
    let ours = Way::new(Carrier::Ours, Idle::Spin);
    let raw = Way::new(Carrier::Raw, Idle::Spin);
    let ways = [ours, raw, raw.untouched()];
    let messages = if bytes > 100_000 { 200 } else { 1000 };
    let blocks = Blocks {
        ways: &ways,
        bytes,
        blocks: options.repeats(12, 4),
        messages,
        pause: Duration::ZERO,
    };
    let measured = blocks.measure(link, || {
        options.check()?;
        deadline.check("a hop")
    })?;
    let [ours, raw, untouched] = &measured[..] else {
        return Ok(Vec::new());
    };
    let name = size_name(bytes);
    let mut figures = Vec::new();
    if let (Some(value), Some(ratio)) = (
        Spread::of(ours.medians.iter().copied()),
        paired_ratio(&ours.medians, &raw.medians),
    ) {
        figures.push(
            Figure::new(ITEM, format!("{name} written, p50"), value, "us")
                .against("raw iceoryx2", raw.latency.at(0.5))
                .with_ratio(ratio.median)
                .with_goal(Goal::RatioAtMost(GOAL)),
        );
    }
    let p99 = ours.latency.at(0.99);
    figures.push(
        Figure::once(ITEM, format!("{name} written, p99"), p99, "us")
            .against("raw iceoryx2", raw.latency.at(0.99)),
    );
    figures.push(Figure::once(
        ITEM,
        format!("{name} untouched, raw iceoryx2, p50"),
        untouched.latency.at(0.5),
        "us",
    ));
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_names_and_whole_elements() {
        let names = SIZES.map(size_name);
        assert_eq!(names, ["64 B", "1 KiB", "16 KiB", "256 KiB", "1 MiB"]);
        assert_eq!(size_name(1500), "1500 B");
        assert!(SIZES.iter().all(|bytes| bytes % 4 == 0));
    }
}
