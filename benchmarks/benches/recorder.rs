//! Cost of recording, in CPU time of the recorder's thread, so that other load does not count.
//!
//! * `compression`: levels and chunk sizes; the sizes of the files are printed.
//! * `tick`: all work of a recorder for one tick of a chase (goal < 60 µs), by part.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ipc_types::cdr;
use ipc_types::messages::perception::{BeliefHeader, Particle, Sighting};
use ipc_types::messages::robot::{Command, PlanHeader, PlanPoint};
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Belief, Commands, Plan, Sightings, Topic, WorldState};
use mcap_log::{ChannelSpec, Compression, LogOptions, LogWriter, Manifest};
use recorder::{ProcessInfo, Recording, RobotInfo, RunInfo};
use viewer::{ViewerOptions, viewer_topics};

const ROBOTS: u32 = 6;
const PARTICLES: usize = 300;
const TICKS: u64 = 400;
const PERIOD_NS: u64 = 50_000_000;

/// Numbers with the entropy of noisy simulated ones.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// All messages of a tick of a chase.
struct Tick {
    state: (WorldHeader, Vec<RobotState>),
    sightings: (PlainHeader, Vec<Sighting>),
    beliefs: Vec<(BeliefHeader, Vec<Particle>)>,
    commands: Vec<(PlainHeader, Command)>,
    plans: Vec<(PlanHeader, Vec<PlanPoint>)>,
}

fn stamp(tick: u64, source: u32, sequence: u64) -> Stamp {
    let sent_ns = 1_000_000_000 + tick * 250_000 + u64::from(source) * 17_000;
    Stamp {
        tick,
        time_ns: tick * PERIOD_NS,
        sequence,
        source,
        reserved: 0,
        origin_ns: 1_000_000_000 + tick * 250_000,
        received_ns: sent_ns - 9_000,
        begun_ns: sent_ns - 8_500,
        computed_ns: sent_ns - 500,
        sent_ns,
    }
}

#[expect(clippy::too_many_lines, reason = "one topic after the other")]
fn chase() -> Vec<Tick> {
    let mut noise = Noise(7);
    let mut poses = [[0.0; 3]; ROBOTS as usize];
    let robot_source = |robot: u32| 2 + robot;
    (0..TICKS)
        .map(|tick| {
            let robots = (0..ROBOTS)
                .map(|robot| {
                    let [x, y, theta] = &mut poses[robot as usize];
                    (*x, *y, *theta) = (
                        *x + 0.1 * noise.next(),
                        *y + 0.1 * noise.next(),
                        *theta + noise.next(),
                    );
                    RobotState {
                        x: *x,
                        y: *y,
                        theta: *theta,
                        v: 0.2 * noise.next(),
                        omega: noise.next(),
                        distance: tick as f64 * 0.01,
                        robot,
                        team: if robot < 4 { 1 } else { 2 },
                        ..RobotState::default()
                    }
                })
                .collect();
            let state = (
                WorldHeader {
                    stamp: stamp(tick, 0, tick),
                    tick_period_ns: PERIOD_NS,
                    map_revision: 1,
                    phase: 0,
                },
                robots,
            );
            let sightings = (0..2)
                .map(|i| Sighting {
                    x: noise.next(),
                    robot: 4 + i,
                    ..Sighting::default()
                })
                .collect();
            let beliefs = (0..2)
                .map(|i| {
                    let particles = (0..PARTICLES)
                        .map(|_| Particle {
                            x: (10.0 + noise.next()) as f32,
                            y: (5.0 + noise.next()) as f32,
                            theta: noise.next() as f32,
                            weight: 1.0 / PARTICLES as f32,
                        })
                        .collect();
                    let header = BeliefHeader {
                        stamp: stamp(tick, 1, 2 * tick + u64::from(i)),
                        mean_x: noise.next(),
                        robot: 4 + i,
                        ..BeliefHeader::default()
                    };
                    (header, particles)
                })
                .collect();
            let commands = (0..ROBOTS)
                .map(|robot| {
                    let header = PlainHeader {
                        stamp: stamp(tick, robot_source(robot), tick),
                    };
                    let (v, omega) = (noise.next(), noise.next());
                    (
                        header,
                        Command {
                            v,
                            omega,
                            robot,
                            reserved: 0,
                        },
                    )
                })
                .collect();
            let plans = (0..ROBOTS)
                .map(|robot| {
                    let stamp = stamp(tick, robot_source(robot), tick);
                    let points = (0..2)
                        .map(|_| PlanPoint {
                            x: noise.next(),
                            y: noise.next(),
                            ..PlanPoint::default()
                        })
                        .collect();
                    (
                        PlanHeader {
                            stamp,
                            robot,
                            target: 4,
                        },
                        points,
                    )
                })
                .collect();
            Tick {
                state,
                sightings: (
                    PlainHeader {
                        stamp: stamp(tick, 1, tick),
                    },
                    sightings,
                ),
                beliefs,
                commands,
                plans,
            }
        })
        .collect()
}

/// Returns the messages of all ticks in their CDR form: channel, time, bytes.
fn encoded(ticks: &[Tick]) -> Vec<(usize, u64, Vec<u8>)> {
    fn one<T: Topic>(header: &T::Header, elements: &[T::Element]) -> Vec<u8> {
        let mut out = Vec::new();
        cdr::encode::<T>(header, elements, &mut out);
        out
    }
    let mut messages = Vec::new();
    for (tick, sent) in ticks.iter().enumerate() {
        let time = tick as u64 * PERIOD_NS;
        messages.push((0, time, one::<WorldState>(&sent.state.0, &sent.state.1)));
        messages.push((
            1,
            time,
            one::<Sightings>(&sent.sightings.0, &sent.sightings.1),
        ));
        for (header, particles) in &sent.beliefs {
            messages.push((2, time, one::<Belief>(header, particles)));
        }
        for (header, command) in &sent.commands {
            messages.push((3, time, one::<Commands>(header, &[*command])));
        }
        for (header, points) in &sent.plans {
            messages.push((4, time, one::<Plan>(header, points)));
        }
    }
    messages
}

const CHANNELS: [&str; 5] = ["state", "sighting", "belief", "command", "plan"];

fn write_ours(path: &Path, options: &LogOptions, messages: &[(usize, u64, Vec<u8>)]) -> u64 {
    let mut log = LogWriter::create(path, options, &Manifest::default()).unwrap();
    let channels = CHANNELS.map(|topic| {
        log.add_channel(&ChannelSpec {
            topic,
            schema_name: "",
            schema_encoding: "",
            schema: &[],
            message_encoding: "cdr",
            metadata: &BTreeMap::new(),
        })
        .unwrap()
    });
    for (i, (channel, time, bytes)) in messages.iter().enumerate() {
        log.write(channels[*channel], i as u32, *time, *time, bytes)
            .unwrap();
        if i % 64 == 0 {
            log.flush_if_due().unwrap();
        }
    }
    log.finish().unwrap().file_bytes
}

fn record(path: &Path, log: &LogOptions, viewer: &ViewerOptions, ticks: &[Tick]) {
    let run = run_info();
    let log = LogWriter::create(path, log, &Manifest::default()).unwrap();
    let mut recording = Recording::new(&run, Arc::default())
        .with_log(log, viewer_topics(&run, viewer))
        .unwrap();
    for (tick, sent) in ticks.iter().enumerate() {
        recording.push::<WorldState>(&sent.state.0, &sent.state.1);
        recording.push::<Sightings>(&sent.sightings.0, &sent.sightings.1);
        for (header, particles) in &sent.beliefs {
            recording.push::<Belief>(header, particles);
        }
        for (header, command) in &sent.commands {
            recording.push::<Commands>(header, &[*command]);
        }
        for (header, points) in &sent.plans {
            recording.push::<Plan>(header, points);
        }
        // A recorder wakes every few ticks.
        if tick % 16 == 15 {
            recording.advance(tick as u64, &mut ()).unwrap();
            recording.flush_if_due().unwrap();
        }
    }
    let summary = recording.finish(&mut ()).unwrap();
    assert_eq!(summary.topics["perception/belief"].messages, 2 * TICKS);
    assert!(
        summary
            .topics
            .values()
            .all(|t| t.gaps == 0 && t.rejected == 0),
        "{:?}",
        summary.topics
    );
    black_box((path, summary));
}

fn run_info() -> RunInfo {
    RunInfo {
        processes: (0..2 + ROBOTS)
            .map(|index| ProcessInfo {
                index,
                name: format!("process_{index}"),
                kind: ["simulator", "perception"]
                    .get(index as usize)
                    .unwrap_or(&"pursuer")
                    .to_string(),
                upstream: if index >= 2 { vec![1] } else { Vec::new() },
            })
            .collect(),
        robots: (0..ROBOTS)
            .map(|robot| RobotInfo {
                name: format!("robot_{robot}"),
                team: if robot < 4 { "police" } else { "evader" }.to_owned(),
                radius: 0.1,
                visits_waypoints: false,
                lap_limit_s: None,
            })
            .collect(),
        obstacles: std::collections::BTreeMap::new(),
        tick_period_ns: PERIOD_NS,
        seed: 1,
        ..RunInfo::default()
    }
}

/// CPU time of this thread.
fn cpu() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn cpu_of(iterations: u64, mut body: impl FnMut()) -> Duration {
    let start = cpu();
    for _ in 0..iterations {
        body();
    }
    cpu().saturating_sub(start)
}

fn log_options(compression: Compression, chunk_bytes: u64) -> LogOptions {
    LogOptions {
        compression,
        chunk_bytes,
        force: true,
        ..LogOptions::default()
    }
}

fn benches(c: &mut Criterion) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bench.mcap");
    let ticks = chase();
    let messages = encoded(&ticks);
    let bytes: u64 = messages.iter().map(|m| m.2.len() as u64).sum();
    println!(
        "{} messages and {} bytes per tick",
        messages.len() as u64 / TICKS,
        bytes / TICKS
    );

    let mut group = c.benchmark_group("compression");
    group
        .throughput(Throughput::Elements(TICKS))
        .sample_size(10);
    for (name, compression, chunk) in [
        ("none", Compression::None, 512),
        ("zstd -7", Compression::Zstd(-7), 512),
        ("zstd -3", Compression::Zstd(-3), 512),
        ("zstd -1", Compression::Zstd(-1), 512),
        ("zstd 1", Compression::Zstd(1), 512),
        ("zstd 3", Compression::Zstd(3), 512),
        ("zstd -3", Compression::Zstd(-3), 128),
        ("zstd -3", Compression::Zstd(-3), 2048),
    ] {
        let options = log_options(compression, chunk * 1024);
        let size = write_ours(&path, &options, &messages);
        println!(
            "{name}, chunks of {chunk} KiB: {:.3} of the payload",
            size as f64 / bytes as f64
        );
        group.bench_function(BenchmarkId::new(name, chunk), |b| {
            b.iter_custom(|n| {
                cpu_of(n, || {
                    write_ours(&path, &options, &messages);
                })
            });
        });
    }
    group.finish();

    let mut group = c.benchmark_group("tick");
    group
        .throughput(Throughput::Elements(TICKS))
        .sample_size(10);
    let off = ViewerOptions {
        rate_hz: 0.0,
        ..ViewerOptions::default()
    };
    let on = ViewerOptions::default();
    for (name, compression, viewer) in [
        ("everything", LogOptions::default().compression, &on),
        ("no viewer topics", LogOptions::default().compression, &off),
        ("no compression", Compression::None, &on),
        ("no viewer topics, no compression", Compression::None, &off),
    ] {
        let log = log_options(compression, LogOptions::default().chunk_bytes);
        group.bench_function(name, |b| {
            b.iter_custom(|n| cpu_of(n, || record(&path, &log, viewer, &ticks)));
        });
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = benches
}
criterion_main!(all);
