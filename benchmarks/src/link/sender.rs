//! The sending side of a link: this process.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher as RawPublisher;
use iceoryx2::port::update_connections::UpdateConnections as _;
use iceoryx2::prelude::{AllocationStrategy, Node, ipc};
use ipc_types::bus::{Bus, Publisher, PublisherOptions, TopicHolder};
use ipc_types::clock::monotonic_ns;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::Scan;
use rustix::fs::OFlags;

use super::transport::{
    FRAME, RawHeader, pipe_path, raw_event, raw_node, raw_service, socket_path,
};
use super::{
    END, LATENCY, LinkError, MODE, Placement, READY, RECEIVED, SENT, SINK_KIND, SharedWords,
    SinkConfig, Transport, allowed, pin, sleep_while, store_and_wake,
};
use mission::child_process::Executable;
use mission::process_group::{AwaitError, ProcessGroup};
use mission::run_directory::RunDirectory;

/// Time limit for each step of the receiver's start.
const READY_WITHIN: Duration = Duration::from_secs(10);
/// Time limit for one message; exceeded only if the receiver is dead.
const ARRIVES_WITHIN: Duration = Duration::from_secs(5);

/// The sending side, with the receiving process. It is used on the thread that starts it.
pub struct Link {
    bus_out: Publisher<Scan>,
    raw_out: RawPublisher<ipc::Service, [f32], RawHeader>,
    raw_event: Notifier<ipc::Service>,
    socket: UnixStream,
    pipe: File,
    page: SharedWords,
    sent: u32,
    elements: Vec<f32>,
    frame: Vec<u8>,
    yields: bool,
    receiver: Receiver,
    // These must live as long as their ports.
    _holder: TopicHolder,
    _bus: Bus,
    _node: Node<ipc::Service>,
    _space: RunDirectory,
}

impl Link {
    /// Starts the receiver for payloads of at most `most` bytes and connects; pins the calling
    /// thread according to the placement.
    ///
    /// # Errors
    /// [`LinkError`] if a transport or the receiver cannot be set up.
    pub fn start(most: usize, placement: Placement) -> Result<Self, LinkError> {
        let space = RunDirectory::create()?;
        let config = SinkConfig {
            root: space.space().root().to_owned(),
            prefix: space.space().prefix().to_owned(),
            most,
            processor: match placement {
                Placement::Unpinned => None,
                Placement::OneCore => Some(0),
                Placement::TwoCores => Some(allowed()?.len().min(2) - 1),
            },
            yields: placement == Placement::OneCore,
        };
        let elements = (most / size_of::<f32>()).max(1);
        let page = SharedWords::create(&config.prefix)?;
        let bus = Bus::join(space.space(), SinkConfig::bus_options(), "latency")?;
        let holder = bus.create::<Scan>()?;
        let bus_out = bus.publisher(PublisherOptions::new(0, elements))?;
        let node = raw_node(space.space())?;
        let raw_out = raw_service(&node)?
            .publisher_builder()
            .initial_max_slice_len(elements)
            .allocation_strategy(AllocationStrategy::Static)
            .create()
            .map_err(LinkError::raw("publish"))?;
        let raw_event = raw_event(&node)?
            .notifier_builder()
            .create()
            .map_err(LinkError::raw("notify"))?;
        let listener = UnixListener::bind(socket_path(&config.root))
            .map_err(LinkError::system("cannot create a socket"))?;
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        let fifo = rustix::fs::FileType::Fifo;
        rustix::fs::mknodat(rustix::fs::CWD, pipe_path(&config.root), fifo, mode, 0)
            .map_err(|e| LinkError::system("cannot create a pipe")(e.into()))?;
        // The receiver pins itself before it opens anything.
        let mut receiver = Receiver::start(&config)?;
        let is_ready = |count| page.word(READY).load(Ordering::SeqCst) >= count;
        receiver.wait("open its ports", || is_ready(1))?;
        // The receiver has connected, or its exit was detected.
        let (socket, _) = listener
            .accept()
            .map_err(LinkError::system("cannot accept at the socket"))?;
        let pipe = receiver.writing_end(&config)?;
        receiver.wait("open the pipe", || is_ready(2))?;
        if placement != Placement::Unpinned {
            pin(0)?;
        }
        bus_out.update_connections()?;
        let connected = raw_out.update_connections();
        connected.map_err(LinkError::raw("connect"))?;
        Ok(Self {
            bus_out,
            raw_out,
            raw_event,
            socket,
            pipe,
            page,
            sent: 0,
            elements: (0..elements).map(|i| i as f32).collect(),
            frame: vec![1; FRAME + most],
            yields: config.yields,
            receiver,
            _holder: holder,
            _bus: bus,
            _node: node,
            _space: space,
        })
    }

    /// Sends `messages` messages of this size (bytes), each `pause` after the previous one was
    /// received. Returns the latency of each message (ns).
    ///
    /// # Errors
    /// [`LinkError`] if a message is not received.
    pub fn block(
        &mut self,
        transport: Transport,
        bytes: usize,
        messages: usize,
        pause: Duration,
    ) -> Result<Vec<u64>, LinkError> {
        store_and_wake(self.page.word(MODE), transport as u32);
        let mut latencies = Vec::with_capacity(messages);
        for _ in 0..messages {
            std::thread::sleep(pause);
            self.send(transport, bytes)?;
            self.wait_received(transport)?;
            latencies.push(u64::from(self.page.word(LATENCY).load(Ordering::SeqCst)));
        }
        self.end_block(transport)?;
        Ok(latencies)
    }

    /// Ends the receiver's wait for this transport.
    fn end_block(&mut self, transport: Transport) -> Result<(), LinkError> {
        let failed = LinkError::system("cannot end a block");
        let end = [0; FRAME];
        match transport {
            Transport::Socket => self.socket.write_all(&end).map_err(failed)?,
            Transport::Pipe => self.pipe.write_all(&end).map_err(failed)?,
            _ => {}
        }
        store_and_wake(self.page.word(MODE), 0);
        store_and_wake(self.page.word(SENT), self.sent);
        if transport == Transport::RawWoken {
            self.notify()?;
        }
        Ok(())
    }

    /// Sends one message and wakes the receiver.
    fn send(&mut self, transport: Transport, bytes: usize) -> Result<(), LinkError> {
        let bytes = bytes.min(self.frame.len() - FRAME);
        let elements = &self.elements[..bytes / size_of::<f32>()];
        self.sent = self.sent.wrapping_add(1);
        let begun = monotonic_ns();
        match transport {
            Transport::Bus => {
                let mut header = ScanHeader::default();
                header.stamp.origin_ns = begun;
                self.bus_out.send(header, elements)?;
                store_and_wake(self.page.word(SENT), self.sent);
            }
            Transport::RawPolled | Transport::RawWoken => {
                let loaned = self.raw_out.loan_slice_uninit(elements.len());
                let mut sample = loaned.map_err(LinkError::raw("loan memory"))?;
                sample.user_header_mut().words = [begun; size_of::<ScanHeader>() / 8];
                let sent = sample.write_from_slice(elements).send();
                sent.map_err(LinkError::raw("send"))?;
                if transport == Transport::RawWoken {
                    self.notify()?;
                }
            }
            Transport::Socket | Transport::Pipe => {
                let message = &mut self.frame[..FRAME + bytes];
                let (frame, _) = message.split_at_mut(FRAME);
                let (first, second) = frame.split_at_mut(FRAME / 2);
                first.copy_from_slice(&begun.to_le_bytes());
                second.copy_from_slice(&(bytes as u64).to_le_bytes());
                match transport {
                    Transport::Socket => self.socket.write_all(message),
                    _ => self.pipe.write_all(message),
                }
                .map_err(LinkError::system("cannot send a message"))?;
            }
        }
        Ok(())
    }

    fn notify(&self) -> Result<(), LinkError> {
        let notified = self.raw_event.notify();
        notified.map_err(LinkError::raw("notify"))?;
        Ok(())
    }

    fn wait_received(&mut self, transport: Transport) -> Result<(), LinkError> {
        let mut turns = 0_u32;
        let mut limit = None;
        loop {
            let seen = self.page.word(RECEIVED).load(Ordering::SeqCst);
            if seen == self.sent {
                return Ok(());
            }
            turns = turns.wrapping_add(1);
            if transport != Transport::RawPolled {
                sleep_while(self.page.word(RECEIVED), seen, Duration::from_millis(100));
            } else if self.yields {
                std::thread::yield_now();
                if !turns.is_multiple_of(64) {
                    continue;
                }
            } else {
                std::hint::spin_loop();
                if !turns.is_multiple_of(4096) {
                    continue;
                }
                // The receiver may have no processor: yield this one.
                std::thread::yield_now();
            }
            if Instant::now() > *limit.get_or_insert_with(|| Instant::now() + ARRIVES_WITHIN) {
                self.receiver.check()?;
                return Err(LinkError::TooSlow {
                    what: "receive a message",
                    limit: ARRIVES_WITHIN,
                });
            }
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        store_and_wake(self.page.word(MODE), END);
        store_and_wake(self.page.word(SENT), self.sent.wrapping_add(1));
        // A receiver that reads a socket or a pipe reaches its end, and exits.
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
    }
}

/// The receiving process; dropping it ends the process.
struct Receiver(ProcessGroup);

impl Receiver {
    fn start(config: &SinkConfig) -> Result<Self, LinkError> {
        let mut group = ProcessGroup::default();
        let executable = Executable::Kind(SINK_KIND.into());
        group.start(&config.root, SINK_KIND, &executable, config)?;
        Ok(Self(group))
    }

    /// Fails if the process has ended.
    fn check(&mut self) -> Result<(), LinkError> {
        self.0.check().map_err(|error| failed("go on", error))
    }

    /// Waits until `done`; fails if the process ends first, or at the time limit.
    fn wait(&mut self, what: &'static str, done: impl FnMut() -> bool) -> Result<(), LinkError> {
        let waited = self.0.wait(READY_WITHIN, done);
        waited.map_err(|error| failed(what, error))
    }

    /// Opens the writing end of the pipe, once the receiver has opened the other.
    fn writing_end(&mut self, config: &SinkConfig) -> Result<File, LinkError> {
        const WHAT: &str = "open the pipe";
        let mut options = OpenOptions::new();
        // Without a reader this fails instead of blocking.
        options
            .write(true)
            .custom_flags(OFlags::NONBLOCK.bits() as i32);
        let mut opened = None;
        self.wait(WHAT, || {
            opened = options.open(pipe_path(&config.root)).ok();
            opened.is_some()
        })?;
        let limit = READY_WITHIN;
        let pipe = opened.ok_or(LinkError::TooSlow { what: WHAT, limit })?;
        rustix::fs::fcntl_setfl(&pipe, OFlags::empty())
            .map_err(|e| LinkError::system("cannot set up the pipe")(e.into()))?;
        Ok(pipe)
    }
}

/// Converts the failure of the receiver to do something.
fn failed(what: &'static str, error: AwaitError) -> LinkError {
    match error {
        AwaitError::Ended { last_lines, .. } => LinkError::Receiver(last_lines.join(" / ")),
        AwaitError::TooSlow(limit) => LinkError::TooSlow { what, limit },
    }
}
