//! Log writers beside each other: `mcap_log`, the crate `mcap`, and Copper's `cu29-unifiedlog`.
//!
//! The workloads are those of foxglove/mcap#1611, with varied bytes: a million messages of 100 bytes in one channel, and ten seconds of
//! a robot with five channels (3750 messages, 102 MB). Writers take turns; the table has the medians of CPU and real
//! time, both with the data on disk at the end.
//!
//! ```sh
//! cargo run --release --manifest-path benchmarks/recorder_baseline/Cargo.toml -- 5
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};

use cu29_traits::{UnifiedLogType, WriteStream};
use cu29_unifiedlog::{UnifiedLogger, UnifiedLoggerBuilder, stream_write};
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use mcap_log::{ChannelSpec, Compression, LogOptions, LogWriter, Manifest};
use rustix::time::{ClockId, clock_gettime};

/// Channels of a workload: topic, sizes of the messages in turn, and rate (Hz).
type Channels = &'static [(&'static str, &'static [usize], u64)];
const FIXED: Channels = &[("/fixed", &[100], 100_000)];
const MIXED: Channels = &[
    ("/imu", &[96], 200),
    ("/odom", &[296], 50),
    ("/tf", &[80, 320, 800, 1600], 100),
    ("/lidar", &[230_400], 10),
    ("/camera", &[524_288], 15),
];
/// Length of both recordings (s).
const LENGTH_S: u64 = 10;

/// A message: channel, number and time (ns), and its bytes.
struct Message {
    channel: usize,
    sequence: u32,
    time_ns: u64,
    bytes: Vec<u8>,
}

/// Message for `cu29-unifiedlog`: the fields that the others have in their message headers, and the bytes.
#[derive(bincode::Encode)]
struct Record<'a>(u16, u32, u64, &'a [u8]);

impl core::fmt::Debug for Record<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Record")
            .field(&self.0)
            .field(&self.1)
            .finish()
    }
}

fn messages(channels: Channels) -> Vec<Message> {
    let mut messages = Vec::new();
    for (channel, (_, sizes, rate)) in channels.iter().enumerate() {
        for n in 0..rate * LENGTH_S {
            // Half of the bits are noise, as in measured values.
            let mut state = n.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
            let byte = |_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 60) as u8
            };
            messages.push(Message {
                channel,
                sequence: n as u32,
                time_ns: n * 1_000_000_000 / rate,
                bytes: (0..sizes[n as usize % sizes.len()]).map(byte).collect(),
            });
        }
    }
    messages.sort_by_key(|message| message.time_ns);
    messages
}

type Done = Result<(), Box<dyn Error>>;

fn ours(path: &Path, compression: Compression, channels: Channels, messages: &[Message]) -> Done {
    let options = LogOptions {
        compression,
        force: true,
        ..LogOptions::default()
    };
    let mut log = LogWriter::create(path, &options, &Manifest::default())?;
    let mut ids = Vec::new();
    for (topic, ..) in channels {
        ids.push(log.add_channel(&ChannelSpec {
            topic,
            schema_name: "",
            schema_encoding: "",
            schema: &[],
            message_encoding: "cdr",
            metadata: &BTreeMap::new(),
        })?);
    }
    for message in messages {
        let time_ns = message.time_ns;
        log.write(
            ids[message.channel],
            message.sequence,
            time_ns,
            time_ns,
            &message.bytes,
        )?;
    }
    log.finish()?;
    Ok(())
}

fn mcap_crate(
    path: &Path,
    compression: Compression,
    channels: Channels,
    messages: &[Message],
) -> Done {
    let options = WriteOptions::new()
        .compression_threads(0)
        .chunk_size(Some(LogOptions::default().chunk_bytes));
    let options = match compression {
        Compression::Zstd(level) => options.compression_level(level.cast_unsigned()),
        _ => options.compression(None),
    };
    // It writes each message of a chunk without compression by itself.
    let file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let mut log = options.create(file)?;
    let mut ids = Vec::new();
    for (topic, ..) in channels {
        ids.push(log.add_channel(log_schema(), topic, "cdr", &BTreeMap::new())?);
    }
    for message in messages {
        let header = MessageHeader {
            channel_id: ids[message.channel],
            sequence: message.sequence,
            log_time: message.time_ns,
            publish_time: message.time_ns,
        };
        log.write_to_known_channel(&header, &message.bytes)?;
    }
    log.finish()?;
    log.into_inner().into_inner()?.sync_all()?;
    Ok(())
}

/// No schema.
const fn log_schema() -> u16 {
    0
}

/// Without compression, checksums or index: it has none of them.
fn copper(path: &Path, messages: &[Message]) -> Done {
    let size: usize = messages
        .iter()
        .map(|message| message.bytes.len() + 64)
        .sum();
    let logger = UnifiedLoggerBuilder::new()
        .write(true)
        .create(true)
        .file_base_name(path)
        .preallocated_size(size * 5 / 4 + (8 << 20))
        .build()?;
    let UnifiedLogger::Write(logger) = logger else {
        return Err("a reader in place of a writer".into());
    };
    let logger = std::sync::Arc::new(std::sync::Mutex::new(logger));
    {
        let mut stream = stream_write(
            std::sync::Arc::clone(&logger),
            UnifiedLogType::CopperList,
            4 << 20,
        )?;
        for message in messages {
            let channel = message.channel as u16;
            stream.log(&Record(
                channel,
                message.sequence,
                message.time_ns,
                &message.bytes,
            ))?;
        }
    }
    drop(logger);
    for entry in std::fs::read_dir(path.parent().unwrap_or(path))? {
        File::open(entry?.path())?.sync_all()?;
    }
    Ok(())
}

fn cpu() -> Duration {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn main() -> Done {
    let turns: usize = std::env::args()
        .nth(1)
        .map_or(Ok(5), |turns| turns.parse())?;
    for (name, channels) in [("1 M x 100 B", FIXED), ("mixed, 102 MB", MIXED)] {
        let messages = messages(channels);
        let bytes: usize = messages.iter().map(|message| message.bytes.len()).sum();
        println!(
            "{name}: {} messages, {:.1} MB",
            messages.len(),
            bytes as f64 / 1e6
        );
        let zstd = LogOptions::default().compression;
        let writers: [(&str, &dyn Fn(&Path) -> Done); 5] = [
            ("protean, uncompressed", &|path| {
                ours(path, Compression::None, channels, &messages)
            }),
            ("mcap, uncompressed", &|path| {
                mcap_crate(path, Compression::None, channels, &messages)
            }),
            ("cu29-unifiedlog", &|path| copper(path, &messages)),
            ("protean, zstd", &|path| {
                ours(path, zstd, channels, &messages)
            }),
            ("mcap, zstd", &|path| {
                mcap_crate(path, zstd, channels, &messages)
            }),
        ];
        let mut times = vec![Vec::new(); writers.len()];
        let mut sizes = vec![0; writers.len()];
        for _ in 0..turns {
            for (n, (_, write)) in writers.iter().enumerate() {
                let folder = tempfile::tempdir_in(".")?;
                let (start, begun) = (cpu(), Instant::now());
                write(&folder.path().join("log.mcap"))?;
                times[n].push((cpu() - start, begun.elapsed()));
                let files = std::fs::read_dir(folder.path())?;
                sizes[n] = files
                    .map(|file| Ok(file?.metadata()?.len()))
                    .sum::<std::io::Result<u64>>()?;
            }
        }
        for (n, (writer, _)) in writers.iter().enumerate() {
            let median = |of: fn(&(Duration, Duration)) -> Duration| {
                let mut all: Vec<Duration> = times[n].iter().map(of).collect();
                all.sort();
                all[all.len() / 2].as_secs_f64() * 1e3
            };
            let (cpu_ms, wall_ms) = (median(|t| t.0), median(|t| t.1));
            println!(
                "  {writer:22} {cpu_ms:7.0} ms CPU {wall_ms:7.0} ms {:6.1} MB",
                sizes[n] as f64 / 1e6
            );
        }
    }
    Ok(())
}
