//! What a log costs: our writer beside the bare `mcap` crate, and a chase with a log beside the same
//! chase without.
//!
//! Times are processor time of this thread: what else the machine does does not count. Files are in
//! memory, so that no disk does either.

use std::collections::BTreeMap;
use std::path::Path;

use mcap::WriteOptions;
use mcap::records::MessageHeader;

use super::in_process::cpu_time;
use super::report::{Figure, Goal};
use super::stats::{Spread, paired_ratio};
use super::{BenchError, Deadline, Options};
use crate::in_process::{self, InProcessOptions};
use crate::mission::spaces::OwnedSpace;
use crate::recorder::{ChannelSpec, Compression, LogOptions, LogWriter, Manifest};
use crate::scenario::{ResolvedScenario, load};

const ITEM: &str = "recorder";
/// Share of the bare crate's throughput that our writer should reach.
const GOAL: f64 = 0.8;
/// Messages between two looks at the clock by which our writer hands chunks over.
const FLUSH_EVERY: usize = 64;

/// Records a chase, writes its messages again in both ways, and plays it with and without a log.
///
/// # Errors
/// [`BenchError`] says what could not be measured.
pub fn measure(options: &Options, say: &mut impl FnMut(&str)) -> Result<Vec<Figure>, BenchError> {
    let set = options.quick.then(|| "rules.time_limit=10".to_owned());
    measure_chase(set.as_slice(), options, say)
}

fn measure_chase(
    set: &[String],
    options: &Options,
    say: &mut impl FnMut(&str),
) -> Result<Vec<Figure>, BenchError> {
    let deadline = Deadline::new();
    let space = OwnedSpace::create()?;
    let path = space.space().root().join("bench.mcap");
    let scenario = load("chase", set, None).map_err(|e| failed("chase", e))?;
    say("a chase, for its messages");
    // Plays it once before anything is measured: caches are warm then.
    play(&scenario, Some(&path))?;
    let messages = Messages::read(&path)?;
    say("its messages, written by the recorder's writer and by the mcap crate");
    let (mut ours, mut bare) = (Vec::new(), Vec::new());
    for round in 0..options.repeats(15, 5) {
        options.check()?;
        deadline.check("writing messages")?;
        let rate = |seconds: f64| messages.bytes as f64 / 1e6 / seconds;
        // Who comes first may be at an advantage.
        for ours_next in [round % 2 == 0, round % 2 != 0] {
            if ours_next {
                ours.push(rate(seconds_of(|| messages.write(&path))?));
            } else {
                bare.push(rate(seconds_of(|| messages.write_bare(&path))?));
            }
        }
    }
    say("the chase in one process, with and without its log");
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for _ in 0..options.repeats(6, 2) {
        options.check()?;
        deadline.check("playing chases")?;
        let mut ticks = 0.0;
        with.push(seconds_of(|| {
            ticks = play(&scenario, Some(&path))?;
            Ok(())
        })?);
        without.push(seconds_of(|| play(&scenario, None).map(drop))?);
        let per_tick = |seconds: &mut f64| *seconds *= 1e6 / f64::max(ticks, 1.0);
        with.last_mut().into_iter().for_each(per_tick);
        without.last_mut().into_iter().for_each(per_tick);
    }
    Ok(figures(&ours, &bare, &with, &without))
}

/// The figures from pairs of measurements: rates [MB/s], and processor time per tick [µs].
fn figures(ours: &[f64], bare: &[f64], with: &[f64], without: &[f64]) -> Vec<Figure> {
    let beside = |name: &str, values: &[f64], baseline: &str, base: &[f64], unit| {
        let value = Spread::of(values.iter().copied())?;
        let base_value = Spread::of(base.iter().copied())?;
        let ratio = paired_ratio(values, base)?;
        let figure = Figure::new(ITEM, name, value, unit);
        Some(
            figure
                .against(baseline, base_value.median)
                .with_ratio(ratio.median),
        )
    };
    let write = beside(
        "messages of a chase into a log",
        ours,
        "mcap crate alone",
        bare,
        "MB/s",
    );
    let tick = beside(
        "tick of a chase in one process, with a log",
        with,
        "without a log",
        without,
        "us",
    );
    let pairs = with.iter().zip(without).filter(|(with, _)| **with > 0.0);
    let share = Spread::of(pairs.map(|(with, without)| 100.0 * (1.0 - without / with)));
    [
        write.map(|figure| figure.with_goal(Goal::RatioAtLeast(GOAL))),
        tick,
        share.map(|share| Figure::new(ITEM, "share of the log in it", share, "%")),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Plays a chase in this thread, with a log or without; its ticks.
fn play(scenario: &ResolvedScenario, log: Option<&Path>) -> Result<f64, BenchError> {
    let options = InProcessOptions {
        out: log.map(Path::to_owned),
        force: true,
        ..InProcessOptions::default()
    };
    let report = in_process::run(scenario, &options).map_err(|e| failed("chase", e))?;
    Ok(report.summary.ticks as f64)
}

/// Processor time of this thread that something takes [s].
fn seconds_of(work: impl FnOnce() -> Result<(), BenchError>) -> Result<f64, BenchError> {
    let begun = cpu_time();
    work()?;
    let took = cpu_time().saturating_sub(begun);
    Ok(took.as_secs_f64().max(1e-9))
}

fn failed(process: &str, error: impl core::fmt::Display) -> BenchError {
    BenchError::Process {
        process: process.to_owned(),
        how: error.to_string(),
    }
}

/// The messages of a log, in memory.
struct Messages {
    /// Topic and message encoding by channel.
    channels: Vec<(String, String)>,
    /// Channel, log time [ns], bytes.
    all: Vec<(usize, u64, Vec<u8>)>,
    /// Bytes of all messages.
    bytes: u64,
}

impl Messages {
    fn read(path: &Path) -> Result<Self, BenchError> {
        let bytes = std::fs::read(path).map_err(BenchError::system("cannot read the log"))?;
        let stream = mcap::MessageStream::new(&bytes).map_err(|e| failed("reading", e))?;
        let mut read = Self {
            channels: Vec::new(),
            all: Vec::new(),
            bytes: 0,
        };
        let mut places = BTreeMap::new();
        for message in stream {
            let message = message.map_err(|e| failed("reading", e))?;
            let channel = *places.entry(message.channel.id).or_insert_with(|| {
                let channel = &message.channel;
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                read.channels.push((topic.clone(), encoding.clone()));
                read.channels.len() - 1
            });
            read.bytes += message.data.len() as u64;
            let message = (channel, message.log_time, message.data.into_owned());
            read.all.push(message);
        }
        Ok(read)
    }

    /// As the recorder writes them.
    fn write(&self, path: &Path) -> Result<(), BenchError> {
        let error = |e| failed("writing", e);
        let options = LogOptions {
            force: true,
            ..LogOptions::default()
        };
        let mut log = LogWriter::create(path, &options, &Manifest::default()).map_err(error)?;
        let mut channels = Vec::new();
        for (topic, encoding) in &self.channels {
            let id = log.add_channel(&ChannelSpec {
                topic,
                schema_name: "",
                schema_encoding: "",
                schema: &[],
                message_encoding: encoding,
                metadata: &BTreeMap::new(),
            });
            channels.push(id.map_err(error)?);
        }
        for (i, (channel, time, bytes)) in self.all.iter().enumerate() {
            if let Some(&channel) = channels.get(*channel) {
                log.write(channel, i as u32, *time, *time, bytes)
                    .map_err(error)?;
            }
            if i % FLUSH_EVERY == 0 {
                log.flush_if_due().map_err(error)?;
            }
        }
        log.finish().map_err(error)?;
        Ok(())
    }

    /// With the bare crate, compressed in the same way in chunks of the same size.
    fn write_bare(&self, path: &Path) -> Result<(), BenchError> {
        let error = |e| failed("the mcap crate", e);
        let LogOptions {
            compression,
            chunk_bytes,
            ..
        } = LogOptions::default();
        let options = WriteOptions::new()
            .compression_threads(0)
            .chunk_size(Some(chunk_bytes));
        let options = match compression {
            Compression::Zstd(level) => options.compression_level(level.cast_unsigned()),
            Compression::None => options.compression(None),
        };
        let file = std::fs::File::create(path).map_err(BenchError::system("cannot write"))?;
        let mut log = options.create(file).map_err(error)?;
        let mut channels = Vec::new();
        for (topic, encoding) in &self.channels {
            let schema = log.add_schema("", "", &[]).map_err(error)?;
            let id = log.add_channel(schema, topic, encoding, &BTreeMap::new());
            channels.push(id.map_err(error)?);
        }
        for (i, (channel, time, bytes)) in self.all.iter().enumerate() {
            if let Some(&channel_id) = channels.get(*channel) {
                let header = MessageHeader {
                    channel_id,
                    sequence: i as u32,
                    log_time: *time,
                    publish_time: *time,
                };
                log.write_to_known_channel(&header, bytes).map_err(error)?;
            }
        }
        log.finish().map_err(error)?;
        let file = log.into_inner();
        file.sync_all().map_err(BenchError::system("cannot sync"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_write_the_same_messages_and_are_reported() {
        let options = Options {
            quick: true,
            ..Options::default()
        };
        let set = ["rules.time_limit=1".to_owned()];
        let figures = measure_chase(&set, &options, &mut |_| {}).unwrap();
        let [write, tick, share] = &figures[..] else {
            panic!("{figures:?}");
        };
        for (figure, baseline) in [(write, "mcap crate alone"), (tick, "without a log")] {
            let beside = figure.baseline.as_ref().unwrap();
            assert_eq!(beside.name, baseline);
            assert!(figure.value.min > 0.0 && beside.value > 0.0, "{figure:?}");
            assert!(figure.ratio.unwrap() > 0.0);
        }
        assert!(write.met().is_some() && tick.met().is_none());
        assert!(share.value.max < 100.0, "{share:?}");

        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let scenario = load("chase", &set, None).unwrap();
        play(&scenario, Some(&at("run.mcap"))).unwrap();
        let messages = Messages::read(&at("run.mcap")).unwrap();
        messages.write(&at("ours.mcap")).unwrap();
        messages.write_bare(&at("bare.mcap")).unwrap();
        for name in ["ours.mcap", "bare.mcap"] {
            let again = Messages::read(&at(name)).unwrap();
            assert!(again.all == messages.all, "{name}");
            assert_eq!(again.channels, messages.channels);
            assert!(again.bytes > 100_000);
        }
    }

    #[test]
    fn the_share_of_the_log_is_that_of_the_time_with_it() {
        let figures = figures(&[80.0], &[100.0], &[10.0, 20.0], &[8.0, 16.0]);
        assert_eq!(figures[0].ratio, Some(0.8));
        assert_eq!(figures[0].met(), Some(true));
        assert_eq!(figures[1].ratio, Some(1.25));
        assert!((figures[2].value.median - 20.0).abs() < 1e-9);
    }
}
