//! The sending side of a link: this process.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use iceoryx2::port::notifier::Notifier as RawNotifier;
use iceoryx2::port::publisher::Publisher as RawPublisher;
use iceoryx2::port::update_connections::UpdateConnections as _;
use iceoryx2::prelude::{AllocationStrategy, Node, ipc};
use ipc_types::bus::{Bus, Notifier, Publisher, PublisherOptions, TopicHolder};
use ipc_types::clock::monotonic_ns;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::Scan;
use rustix::fs::OFlags;

use super::transport::{FRAME, RawHeader, pipe_path, raw_event, raw_service, socket_path};
use super::{
    Carrier, END, EVENT, Idle, LATENCY, LinkOptions, MODE, Placement, READY, RECEIVED, SENT,
    SinkConfig, Way,
};
use crate::bench::crew::{Crew, launch};
use crate::bench::pinning::{allowed, pin};
use crate::bench::shared::{SharedWords, sleep_while, store_and_wake};
use crate::bench::{BenchError, raw};
use crate::mission::spaces::OwnedSpace;

/// Longest wait for one message; only a dead receiver needs it.
const ARRIVES_WITHIN: Duration = Duration::from_secs(5);

/// What one message took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Taken {
    /// From before its memory was loaned until the receiver had it [ns].
    pub latency_ns: u64,
    /// Of that, until the sender was done with it [ns].
    pub sending_ns: u64,
}

/// The sending side, with the processes of the other. It is measured on the thread that starts it.
pub struct Link {
    ours: Publisher<Scan>,
    ours_event: Notifier,
    raw: RawPublisher<ipc::Service, [f32], RawHeader>,
    raw_event: RawNotifier<ipc::Service>,
    socket: UnixStream,
    pipe: File,
    page: SharedWords,
    sent: u32,
    data: Vec<f32>,
    bytes: Vec<u8>,
    crew: Crew,
    crowd: Crew,
    _holders: [TopicHolder; 2],
    _bus: Bus,
    _node: Node<ipc::Service>,
    _space: OwnedSpace,
}

impl Link {
    /// Starts the processes and connects; pins the calling thread as the placement says.
    ///
    /// # Errors
    /// [`BenchError`] says what could not be set up.
    pub fn start(options: LinkOptions) -> Result<Self, BenchError> {
        let second = match options.placement {
            Placement::Unpinned => None,
            Placement::OneCore => Some(0),
            Placement::TwoCores => Some(allowed()?.len().min(2) - 1),
        };
        let space = OwnedSpace::create()?;
        let config = SinkConfig {
            root: space.space().root().to_owned(),
            prefix: space.space().prefix().to_owned(),
            crowd: options.crowd,
            most: options.most,
            processor: second,
        };
        let elements = (options.most / size_of::<f32>()).max(1);
        let page = SharedWords::create(&config.prefix)?;
        let bus = Bus::join(space.space(), config.bus_options(), "bench")?;
        let holders = [bus.create::<Scan>()?, bus.create_event(EVENT)?];
        let ours = bus.publisher(PublisherOptions::new(0, elements))?;
        let node = raw::node(space.space())?;
        let raw = raw_service(&node, &config)?
            .publisher_builder()
            .initial_max_slice_len(elements)
            .allocation_strategy(AllocationStrategy::Static)
            .create()
            .map_err(BenchError::raw("publish"))?;
        let raw_event = raw_event(&node)?
            .notifier_builder()
            .create()
            .map_err(BenchError::raw("notify"))?;
        let listener = UnixListener::bind(socket_path(&config.root))
            .map_err(BenchError::system("cannot make a socket"))?;
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        let fifo = rustix::fs::FileType::Fifo;
        rustix::fs::mknodat(rustix::fs::CWD, pipe_path(&config.root), fifo, mode, 0)
            .map_err(|e| BenchError::system("cannot make a pipe")(e.into()))?;
        // The receiver pins itself before it opens anything.
        let mut crew = launch(&space, "bench-sink", std::slice::from_ref(&config))?;
        let sleepers = vec![config.clone(); options.crowd];
        let mut crowd = launch(&space, "bench-crowd", &sleepers)?;
        let said = |count: u32| page.word(READY).load(Ordering::SeqCst) >= count;
        let others = options.crowd as u32;
        crowd.wait("subscribers to be there", || said(others))?;
        crew.wait("the receiver to be ready", || said(others + 1))?;
        // It has connected, or its exit was seen.
        let (socket, _) = listener
            .accept()
            .map_err(BenchError::system("cannot accept at the socket"))?;
        let pipe = writing_end(&config, &mut crew)?;
        crew.wait("the receiver to be ready", || said(others + 2))?;
        if options.placement != Placement::Unpinned {
            pin(0)?;
        }
        let mut link = Self {
            ours,
            ours_event: bus.notifier(EVENT)?,
            raw,
            raw_event,
            socket,
            pipe,
            page,
            sent: 0,
            data: (0..elements).map(|i| i as f32).collect(),
            bytes: vec![1; FRAME + options.most],
            crew,
            crowd,
            _holders: holders,
            _bus: bus,
            _node: node,
            _space: space,
        };
        link.connect()?;
        Ok(link)
    }

    fn connect(&mut self) -> Result<(), BenchError> {
        self.crowd.check()?;
        self.ours.update_connections()?;
        let connected = self.raw.update_connections();
        connected.map_err(BenchError::raw("connect"))
    }

    /// Sends messages of this many bytes one after the other, each this long after the one before
    /// has arrived.
    ///
    /// # Errors
    /// [`BenchError`] if one does not arrive.
    pub fn block(
        &mut self,
        way: Way,
        bytes: usize,
        messages: usize,
        pause: Duration,
    ) -> Result<Vec<Taken>, BenchError> {
        store_and_wake(self.page.word(MODE), way.word());
        let mut all = Vec::with_capacity(messages);
        for _ in 0..messages {
            if !pause.is_zero() {
                std::thread::sleep(pause);
            }
            let sending_ns = self.send(way, bytes)?;
            self.wait_received(way.idle)?;
            all.push(Taken {
                latency_ns: u64::from(self.page.word(LATENCY).load(Ordering::SeqCst)),
                sending_ns,
            });
        }
        self.end_block(way)?;
        Ok(all)
    }

    /// The receiver leaves its way.
    fn end_block(&mut self, way: Way) -> Result<(), BenchError> {
        let failed = BenchError::system("cannot end a block");
        let end = [0; FRAME];
        match way.carrier {
            Carrier::Socket => self.socket.write_all(&end).map_err(failed)?,
            Carrier::Pipe => self.pipe.write_all(&end).map_err(failed)?,
            Carrier::Ours | Carrier::Raw => {}
        }
        store_and_wake(self.page.word(MODE), 0);
        store_and_wake(self.page.word(SENT), self.sent);
        match (way.carrier, way.idle) {
            (Carrier::Ours, Idle::Event) => self.ours_event.notify(0).map(drop)?,
            (Carrier::Raw, Idle::Event) => {
                let notified = self.raw_event.notify();
                notified.map_err(BenchError::raw("notify"))?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Sends one message and wakes the receiver; how long that took [ns].
    fn send(&mut self, way: Way, bytes: usize) -> Result<u64, BenchError> {
        let elements = self.data.get(..bytes / size_of::<f32>());
        let elements = elements.unwrap_or(&self.data);
        self.sent = self.sent.wrapping_add(1);
        let begun = monotonic_ns();
        match way.carrier {
            Carrier::Ours => {
                let mut header = ScanHeader::default();
                header.stamp.origin_ns = begun;
                if way.written {
                    self.ours.send(header, elements)?;
                } else {
                    self.ours.send_in_place(header, elements.len(), |_| {})?;
                }
                if way.idle == Idle::Event {
                    self.ours_event.notify(0)?;
                }
            }
            Carrier::Raw => {
                self.send_raw(begun, elements, way.written)?;
                if way.idle == Idle::Event {
                    let notified = self.raw_event.notify();
                    notified.map_err(BenchError::raw("notify"))?;
                }
            }
            Carrier::Socket | Carrier::Pipe => {
                let failed = BenchError::system("cannot send a message");
                let (frame, _) = self.bytes.split_at_mut(FRAME);
                let (first, second) = frame.split_at_mut(FRAME / 2);
                first.copy_from_slice(&begun.to_le_bytes());
                second.copy_from_slice(&(bytes as u64).to_le_bytes());
                let message = self.bytes.get(..FRAME + bytes).unwrap_or(&self.bytes);
                match way.carrier {
                    Carrier::Socket => self.socket.write_all(message),
                    _ => self.pipe.write_all(message),
                }
                .map_err(failed)?;
            }
        }
        if way.idle == Idle::Futex {
            store_and_wake(self.page.word(SENT), self.sent);
        }
        Ok(monotonic_ns().saturating_sub(begun))
    }

    fn send_raw(&self, begun: u64, elements: &[f32], written: bool) -> Result<(), BenchError> {
        let loaned = self.raw.loan_slice_uninit(elements.len());
        let mut sample = loaned.map_err(BenchError::raw("loan memory"))?;
        sample.user_header_mut().words = [begun; size_of::<ScanHeader>() / 8];
        let sample = if written {
            sample.write_from_slice(elements)
        } else {
            // SAFETY: the memory is a shared file mapping, which the kernel hands out as zeros; it
            // holds those or what an earlier message left, and any bytes are valid `f32`s.
            unsafe { sample.assume_init() }
        };
        sample.send().map_err(BenchError::raw("send"))?;
        Ok(())
    }

    fn wait_received(&mut self, idle: Idle) -> Result<(), BenchError> {
        let mut turns = 0_u32;
        let mut limit = None;
        loop {
            let seen = self.page.word(RECEIVED).load(Ordering::SeqCst);
            if seen == self.sent {
                return Ok(());
            }
            turns = turns.wrapping_add(1);
            match idle {
                Idle::Spin => {
                    std::hint::spin_loop();
                    if !turns.is_multiple_of(4096) {
                        continue;
                    }
                    // The receiver may be without a processor: give it this one.
                    std::thread::yield_now();
                }
                Idle::Yield => {
                    std::thread::yield_now();
                    if !turns.is_multiple_of(64) {
                        continue;
                    }
                }
                Idle::Futex | Idle::Event | Idle::Read => {
                    sleep_while(self.page.word(RECEIVED), seen, Duration::from_millis(100));
                }
            }
            if Instant::now() > *limit.get_or_insert_with(|| Instant::now() + ARRIVES_WITHIN) {
                self.crew.check()?;
                return Err(BenchError::Lost("a link"));
            }
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        store_and_wake(self.page.word(MODE), END);
        store_and_wake(self.page.word(SENT), self.sent.wrapping_add(1));
        // Whoever reads a socket or a pipe gets its end, and then leaves.
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
    }
}

/// The writing end of the pipe, once the receiver reads the other.
fn writing_end(config: &SinkConfig, crew: &mut Crew) -> Result<File, BenchError> {
    let mut options = OpenOptions::new();
    // Without a reader this fails instead of waiting for one for ever.
    options
        .write(true)
        .custom_flags(OFlags::NONBLOCK.bits() as i32);
    let mut opened = None;
    crew.wait("the receiver to open the pipe", || {
        opened = options.open(pipe_path(&config.root)).ok();
        opened.is_some()
    })?;
    let pipe = opened.ok_or(BenchError::Lost("a pipe"))?;
    rustix::fs::fcntl_setfl(&pipe, OFlags::empty())
        .map_err(|e| BenchError::system("cannot set up the pipe")(e.into()))?;
    Ok(pipe)
}
