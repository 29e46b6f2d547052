//! Cost of one message within one thread: loan, fill, send, receive, free. Baseline: bare iceoryx2
//! with the same bytes, written and (`send_in_place`) untouched; the ratio is of alternating
//! blocks. Also the CDR form for the log, against a plain copy of as many bytes.
//!
//! Measured earlier on another machine of this kind: bare iceoryx2 loan + send 0.21 us, receive +
//! free 0.12 us.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use iceoryx2::prelude::{NodeBuilder, SignalHandlingMode, ZeroCopySend, ipc};
use ipc_types::bus::{Bus, BusOptions, PublisherOptions, RunSpace};
use ipc_types::cdr;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::{RunSize, Scan};
use statistics::quantile;

/// Payload sizes (bytes).
const SIZES: [usize; 6] = [64, 1 << 10, 16 << 10, 256 << 10, 1 << 20, 4 << 20];
/// Number of pairs of blocks; a ratio is their median.
const PAIRS: usize = 31;

/// A header of the same size as that of Protean's messages.
#[derive(Debug, Clone, Copy, Default, ZeroCopySend)]
#[repr(C)]
struct RawHeader {
    words: [u64; size_of::<ScanHeader>() / 8],
}

/// A run space that is removed when dropped.
struct Space(RunSpace);

impl Space {
    fn new() -> Self {
        let id = std::process::id();
        let space = RunSpace::new(format!("/tmp/pbench-{id}"), format!("pbench_{id}_"))
            .expect("a short name");
        space.create_root().expect("a new directory");
        Self(space)
    }
}

impl Drop for Space {
    fn drop(&mut self) {
        let _ = self.0.wipe();
    }
}

fn transport(criterion: &mut Criterion) {
    let space = Space::new();
    let options = BusOptions {
        size: RunSize {
            robots: 1,
            processes: 2,
            events: 1,
        },
        recorder_ticks: 2,
        overflow: false,
    };
    let most = SIZES.iter().max().map_or(1, |bytes| bytes / 4);
    let data: Vec<f32> = (0..most).map(|i| i as f32).collect();

    let bus = Bus::join(&space.0, options, "bench").expect("a bus");
    let _holder = bus.create::<Scan>().expect("a service");
    let publisher = bus
        .publisher::<Scan>(PublisherOptions::new(0, most))
        .expect("a publisher");
    let subscriber = bus.subscriber::<Scan>().expect("a subscriber");
    publisher.update_connections().expect("connections");

    let node = NodeBuilder::new()
        .config(&space.0.config(2).expect("a configuration"))
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<ipc::Service>()
        .expect("a node");
    let service = node
        .service_builder(&"raw/hop".try_into().expect("a name"))
        .publish_subscribe::<[f32]>()
        .user_header::<RawHeader>()
        .max_publishers(1)
        .max_subscribers(1)
        .enable_safe_overflow(false)
        .create()
        .expect("a service");
    let raw_out = service
        .publisher_builder()
        .initial_max_slice_len(most)
        .create()
        .expect("a publisher");
    let raw_in = service.subscriber_builder().create().expect("a subscriber");

    let ours = |elements: &[f32]| {
        publisher
            .send(ScanHeader::default(), black_box(elements))
            .expect("room");
        let message = subscriber.receive().expect("a bus").expect("a message");
        black_box(message.elements().len());
    };
    let raw = |elements: &[f32]| {
        let mut sample = raw_out.loan_slice_uninit(elements.len()).expect("memory");
        *sample.user_header_mut() = RawHeader::default();
        sample
            .write_from_slice(black_box(elements))
            .send()
            .expect("room");
        let message = raw_in.receive().expect("a bus").expect("a message");
        black_box(message.payload().len());
    };
    let untouched = |length: usize| {
        publisher
            .send_in_place(ScanHeader::default(), length, |_| {})
            .expect("room");
        let message = subscriber.receive().expect("a bus").expect("a message");
        black_box(message.elements().len());
    };
    let mut group = criterion.benchmark_group("send and receive");
    for bytes in SIZES {
        let elements = &data[..bytes / 4];
        group.throughput(Throughput::Bytes(bytes as u64));
        group.bench_function(BenchmarkId::new("ours", bytes), |b| {
            b.iter(|| ours(elements));
        });
        group.bench_function(BenchmarkId::new("raw iceoryx2", bytes), |b| {
            b.iter(|| raw(elements));
        });
        group.bench_function(BenchmarkId::new("ours, untouched", bytes), |b| {
            b.iter(|| untouched(elements.len()));
        });
        let ratio = ratio_in_turns(bytes, || ours(elements), || raw(elements));
        println!("ours over raw iceoryx2, {bytes} bytes: {ratio:.3}");
    }
    group.finish();

    let mut group = criterion.benchmark_group("nothing there");
    group.bench_function("ours", |b| {
        b.iter(|| black_box(subscriber.receive().expect("a bus").is_none()));
    });
    group.bench_function("raw iceoryx2", |b| {
        b.iter(|| black_box(raw_in.receive().expect("a bus").is_none()));
    });
    group.finish();
}

/// Returns the median ratio of the times of alternating blocks.
fn ratio_in_turns(bytes: usize, ours: impl Fn(), raw: impl Fn()) -> f64 {
    let calls = (1 << 20) / bytes.max(1 << 9) + 1;
    let block = |call: &dyn Fn()| {
        let begun = Instant::now();
        (0..calls).for_each(|_| call());
        begun.elapsed().as_secs_f64()
    };
    let mut ratios: Vec<f64> = (0..PAIRS).map(|_| block(&ours) / block(&raw)).collect();
    ratios.sort_by(f64::total_cmp);
    quantile(&ratios, 0.5).unwrap_or(f64::NAN)
}

fn encoding(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("CDR");
    for bytes in SIZES {
        let elements = vec![1.5_f32; bytes / 4];
        let header = ScanHeader::default();
        let total = cdr::encoded_len::<Scan>(elements.len());
        group.throughput(Throughput::Bytes(total as u64));
        let mut out = Vec::with_capacity(total);
        group.bench_function(BenchmarkId::new("encode", bytes), |b| {
            b.iter(|| {
                out.clear();
                cdr::encode::<Scan>(black_box(&header), black_box(&elements), &mut out);
                black_box(out.len())
            });
        });
        let plain = vec![0_u8; total];
        group.bench_function(BenchmarkId::new("plain copy", bytes), |b| {
            b.iter(|| {
                out.clear();
                out.extend_from_slice(black_box(&plain));
                black_box(out.len())
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = transport, encoding
}
criterion_main!(all);
