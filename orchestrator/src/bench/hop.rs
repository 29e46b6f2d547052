//! One message from one process to another, both polling: our publisher and subscriber against bare
//! iceoryx2 with the same bytes.
//!
//! The sender takes the clock before it loans memory, the receiver when it has the message in
//! hands; then it says so on a shared page and the next message goes out. The two transports take
//! turns in short blocks.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use iceoryx2::port::publisher::Publisher as RawPublisher;
use iceoryx2::port::subscriber::Subscriber as RawSubscriber;
use iceoryx2::port::update_connections::UpdateConnections as _;
use iceoryx2::prelude::{AllocationStrategy, Node, ZeroCopySend, ipc};
use ipc_types::bus::{Bus, BusOptions, Publisher, PublisherOptions, Subscriber};
use ipc_types::clock::monotonic_ns;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::{RunSize, Scan};

use super::raw::{self, RawConfig};
use super::report::{Figure, Goal};
use super::shared::{LINE, SharedWords, sleep_while, store_and_wake};
use super::stats::{Spread, paired_ratio, percentile};
use super::{BenchError, Deadline, Options};
use crate::mission::children::{Executable, RunningProcess, end_all};
use crate::mission::spaces::OwnedSpace;

const ITEM: &str = "hop";
/// How much longer than the raw hop ours may take.
const GOAL: f64 = 1.2;
/// Payloads [bytes], each a multiple of four.
const SIZES: [usize; 5] = [64, 1 << 10, 16 << 10, 256 << 10, 1 << 20];
/// Longest wait for one message; only a dead receiver needs it.
const ARRIVES_WITHIN: Duration = Duration::from_secs(5);
/// Time that the receiver has to open its ports.
const READY_WITHIN: Duration = Duration::from_secs(10);

/// What the receiver polls: 0 nothing, or one of the [`Way`]s, or the end.
const MODE: usize = 0;
/// Messages received so far.
const RECEIVED: usize = LINE;
/// How long the last one took [ns].
const LATENCY: usize = 2 * LINE;
/// 1 when the receiver's ports are open.
const READY: usize = 3 * LINE;
const END: u32 = 100;

/// How a message goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Our publisher, every byte written.
    Ours = 1,
    /// Bare iceoryx2, every byte written.
    Raw = 2,
    /// Bare iceoryx2, memory handed over as it is.
    Untouched = 3,
}

/// As many bytes as the header of our messages has.
#[derive(Debug, Clone, Copy, Default, ZeroCopySend)]
#[repr(C)]
pub struct RawHeader {
    words: [u64; size_of::<ScanHeader>() / 8],
}

fn bus_options() -> BusOptions {
    BusOptions {
        size: RunSize {
            robots: 1,
            processes: 2,
            events: 1,
        },
        recorder_ticks: 2,
        overflow: false,
    }
}

type RawService =
    iceoryx2::service::port_factory::publish_subscribe::PortFactory<ipc::Service, [f32], RawHeader>;

fn raw_service(node: &Node<ipc::Service>) -> Result<RawService, BenchError> {
    node.service_builder(&raw::name("raw/hop")?)
        .publish_subscribe::<[f32]>()
        .user_header::<RawHeader>()
        .max_publishers(1)
        .max_subscribers(1)
        .subscriber_max_buffer_size(4)
        .enable_safe_overflow(false)
        .open_or_create()
        .map_err(BenchError::raw("open a service"))
}

/// Measures every size.
///
/// # Errors
/// [`BenchError`] says what could not be measured.
pub fn measure(options: &Options, say: &mut impl FnMut(&str)) -> Result<Vec<Figure>, BenchError> {
    let deadline = Deadline::new();
    let mut sender = Sender::start()?;
    let mut figures = Vec::new();
    for bytes in SIZES {
        say(&format!("one hop of {}", size_name(bytes)));
        figures.extend(sender.size(bytes, options, deadline)?);
    }
    Ok(figures)
}

fn size_name(bytes: usize) -> String {
    match bytes {
        b if b >= 1 << 20 => format!("{} MiB", b >> 20),
        b if b >= 1 << 10 => format!("{} KiB", b >> 10),
        b => format!("{b} B"),
    }
}

/// The sending side: this process.
struct Sender {
    ours: Publisher<Scan>,
    raw: RawPublisher<ipc::Service, [f32], RawHeader>,
    page: SharedWords,
    sent: u32,
    data: Vec<f32>,
    crew: [RunningProcess; 1],
    _holder: ipc_types::bus::TopicHolder,
    _bus: Bus,
    _node: Node<ipc::Service>,
    _space: OwnedSpace,
}

impl Sender {
    fn start() -> Result<Self, BenchError> {
        let most = SIZES.iter().max().map_or(1, |bytes| bytes / 4);
        let space = OwnedSpace::create()?;
        let page = SharedWords::create(space.space().prefix())?;
        let bus = Bus::join(space.space(), bus_options(), "bench")?;
        let holder = bus.create::<Scan>()?;
        let ours = bus.publisher(PublisherOptions::new(0, most))?;
        let node = raw::node(space.space())?;
        let raw = raw_service(&node)?
            .publisher_builder()
            .initial_max_slice_len(most)
            .allocation_strategy(AllocationStrategy::Static)
            .create()
            .map_err(BenchError::raw("publish"))?;
        let config = RawConfig {
            root: space.space().root().to_owned(),
            prefix: space.space().prefix().to_owned(),
            index: 1,
        };
        let path = space.space().root().join("process-1.json");
        let written = serde_json::to_vec(&config)
            .map_err(Into::into)
            .and_then(|text| std::fs::write(&path, text));
        written.map_err(BenchError::system(format!("{}", path.display())))?;
        let kind = Executable::Kind("bench-sink".into());
        let process = RunningProcess::start("bench-sink", 1, &kind, &path, true)?;
        space.note_processes(std::iter::once(process.pid()))?;
        let mut sender = Self {
            ours,
            raw,
            page,
            sent: 0,
            data: (0..most).map(|i| i as f32).collect(),
            crew: [process],
            _holder: holder,
            _bus: bus,
            _node: node,
            _space: space,
        };
        let limit = Instant::now() + READY_WITHIN;
        while sender.page.word(READY).load(Ordering::SeqCst) == 0 {
            sender.check_receiver()?;
            if Instant::now() > limit {
                return Err(BenchError::TooSlow {
                    what: "the receiver to be ready".into(),
                    limit: READY_WITHIN,
                });
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        sender.ours.update_connections()?;
        sender
            .raw
            .update_connections()
            .map_err(BenchError::raw("connect"))?;
        Ok(sender)
    }

    fn check_receiver(&mut self) -> Result<(), BenchError> {
        let [process] = &mut self.crew;
        if process.check_exit() {
            return Err(BenchError::Process {
                process: process.name.clone(),
                how: format!("ended: {}", process.last_words().join(" / ")),
            });
        }
        Ok(())
    }

    /// Blocks of all ways in turn with this payload.
    fn size(
        &mut self,
        bytes: usize,
        options: &Options,
        deadline: Deadline,
    ) -> Result<Vec<Figure>, BenchError> {
        const WAYS: [Way; 3] = [Way::Ours, Way::Raw, Way::Untouched];
        let blocks = options.repeats(12, 4);
        let messages = if bytes > 100_000 { 200 } else { 1000 };
        let mut all: [Vec<u64>; 3] = Default::default();
        let mut medians: [Vec<f64>; 3] = Default::default();
        for block in 0..=blocks {
            for (way, (all, medians)) in
                WAYS.into_iter().zip(all.iter_mut().zip(medians.iter_mut()))
            {
                options.check()?;
                deadline.check("a hop")?;
                let mut latencies = self.block(way, bytes / 4, messages)?;
                // The first block touches the memory for the first time.
                if block > 0 {
                    medians.extend(percentile(&mut latencies, 0.5).map(|ns| ns as f64 * 1e-3));
                    all.append(&mut latencies);
                }
            }
        }
        let [ours, raw, untouched] = &mut all;
        let us = |values: &mut Vec<u64>, share| {
            percentile(values, share).map_or(0.0, |ns| ns as f64 * 1e-3)
        };
        let name = size_name(bytes);
        let mut figures = Vec::new();
        if let (Some(value), Some(ratio)) = (
            Spread::of(medians[0].iter().copied()),
            paired_ratio(&medians[0], &medians[1]),
        ) {
            figures.push(
                Figure::new(ITEM, format!("{name} written, p50"), value, "us")
                    .against("raw iceoryx2", us(raw, 0.5))
                    .with_ratio(ratio.median)
                    .with_goal(Goal::RatioAtMost(GOAL)),
            );
        }
        figures.push(
            Figure::once(ITEM, format!("{name} written, p99"), us(ours, 0.99), "us")
                .against("raw iceoryx2", us(raw, 0.99)),
        );
        figures.push(Figure::once(
            ITEM,
            format!("{name} untouched, raw iceoryx2, p50"),
            us(untouched, 0.5),
            "us",
        ));
        Ok(figures)
    }

    /// Sends messages one after the other; their latencies [ns].
    fn block(&mut self, way: Way, count: usize, messages: usize) -> Result<Vec<u64>, BenchError> {
        store_and_wake(self.page.word(MODE), way as u32);
        let mut latencies = Vec::with_capacity(messages);
        for _ in 0..messages {
            self.send(way, count)?;
            self.sent = self.sent.wrapping_add(1);
            self.wait_received()?;
            latencies.push(u64::from(self.page.word(LATENCY).load(Ordering::SeqCst)));
        }
        store_and_wake(self.page.word(MODE), 0);
        Ok(latencies)
    }

    fn send(&self, way: Way, count: usize) -> Result<(), BenchError> {
        let elements = self.data.get(..count).unwrap_or(&self.data);
        let begun = monotonic_ns();
        if way == Way::Ours {
            let mut header = ScanHeader::default();
            header.stamp.origin_ns = begun;
            self.ours.send(header, elements)?;
            return Ok(());
        }
        let mut sample = self
            .raw
            .loan_slice_uninit(elements.len())
            .map_err(BenchError::raw("loan memory"))?;
        sample.user_header_mut().words = [begun; size_of::<ScanHeader>() / 8];
        let sample = if way == Way::Raw {
            sample.write_from_slice(elements)
        } else {
            // SAFETY: the memory is a shared file mapping, which the kernel hands out as zeros; it
            // holds those or what an earlier message left, and any bytes are valid `f32`s.
            unsafe { sample.assume_init() }
        };
        sample.send().map_err(BenchError::raw("send"))?;
        Ok(())
    }

    fn wait_received(&mut self) -> Result<(), BenchError> {
        let mut spins = 0_u32;
        let mut limit = None;
        while self.page.word(RECEIVED).load(Ordering::SeqCst) != self.sent {
            std::hint::spin_loop();
            spins += 1;
            // The receiver may be without a processor: give it this one.
            if spins.is_multiple_of(4096) {
                std::thread::yield_now();
                let limit = *limit.get_or_insert_with(|| Instant::now() + ARRIVES_WITHIN);
                if spins.is_multiple_of(1 << 20) {
                    self.check_receiver()?;
                }
                if Instant::now() > limit {
                    return Err(BenchError::Lost("hop"));
                }
            }
        }
        Ok(())
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        store_and_wake(self.page.word(MODE), END);
        end_all(&mut self.crew, Duration::from_secs(3));
    }
}

/// Runs the receiving side to its end.
pub fn sink(config: &Path) -> ExitCode {
    match RawConfig::load(config).and_then(|config| sink_with(&config)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn sink_with(config: &RawConfig) -> Result<(), BenchError> {
    let stop = Arc::new(AtomicBool::new(false));
    kit::guard::watch_parent(Arc::clone(&stop))
        .map_err(BenchError::system("cannot start the parent guard"))?;
    let space = config.space()?;
    let bus = Bus::join(&space, bus_options(), "bench-sink")?;
    let ours: Subscriber<Scan> = bus.subscriber()?;
    let node = raw::node(&space)?;
    let raw = raw_service(&node)?
        .subscriber_builder()
        .create()
        .map_err(BenchError::raw("subscribe"))?;
    let page = SharedWords::open(&config.prefix)?;
    page.word(READY).store(1, Ordering::SeqCst);
    let mut received = 0_u32;
    let mut misses = 0_u32;
    loop {
        let mode = page.word(MODE).load(Ordering::SeqCst);
        if mode == END || stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        if mode == 0 {
            sleep_while(page.word(MODE), 0, Duration::from_millis(100));
            continue;
        }
        let begun = if mode == Way::Ours as u32 {
            take_ours(&ours)?
        } else {
            take_raw(&raw)?
        };
        if let Some((begun, now)) = begun {
            let latency = u32::try_from(now.saturating_sub(begun)).unwrap_or(u32::MAX);
            page.word(LATENCY).store(latency, Ordering::SeqCst);
            received = received.wrapping_add(1);
            page.word(RECEIVED).store(received, Ordering::SeqCst);
            misses = 0;
        } else {
            std::hint::spin_loop();
            misses = misses.wrapping_add(1);
            if misses.is_multiple_of(4096) {
                std::thread::yield_now();
            }
        }
    }
}

/// When the next message was begun, and when it was here.
fn take_ours(subscriber: &Subscriber<Scan>) -> Result<Option<(u64, u64)>, BenchError> {
    Ok(subscriber
        .receive()?
        .map(|message| (message.header().stamp.origin_ns, monotonic_ns())))
}

fn take_raw(
    subscriber: &RawSubscriber<ipc::Service, [f32], RawHeader>,
) -> Result<Option<(u64, u64)>, BenchError> {
    let message = subscriber.receive().map_err(BenchError::raw("receive"))?;
    Ok(message.map(|message| (message.user_header().words[0], monotonic_ns())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_names_and_whole_elements() {
        let names = SIZES.map(size_name);
        assert_eq!(names, ["64 B", "1 KiB", "16 KiB", "256 KiB", "1 MiB"]);
        assert!(SIZES.iter().all(|bytes| bytes % 4 == 0));
    }
}
