//! The receiving side of a link.

use std::fs::File;
use std::io::Read;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use iceoryx2::port::listener::Listener as RawListener;
use iceoryx2::port::subscriber::Subscriber as RawSubscriber;
use iceoryx2::prelude::{Node, ipc};
use ipc_types::bus::{Bus, Listener, Subscriber};
use ipc_types::clock::monotonic_ns;
use ipc_types::topics::Scan;

use super::transport::{FRAME, RawHeader, pipe_path, raw_event, raw_service, socket_path};
use super::{Carrier, END, EVENT, Idle, LATENCY, MODE, READY, RECEIVED, SENT, SinkConfig, Way};
use crate::bench::pinning::pin;
use crate::bench::shared::{SharedWords, sleep_while, store_and_wake};
use crate::bench::{BenchError, raw};

/// Longest sleep before looking whether to end.
const LOOK_UP: Duration = Duration::from_millis(100);

/// Runs the receiving side to its end.
pub fn sink(config: &Path) -> ExitCode {
    let ended = SinkConfig::load(config)
        .and_then(|config| Sink::open(&config))
        .and_then(|mut sink| sink.run());
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Sink {
    stop: Arc<AtomicBool>,
    ours: Subscriber<Scan>,
    ours_event: Listener,
    raw: RawSubscriber<ipc::Service, [f32], RawHeader>,
    raw_event: RawListener<ipc::Service>,
    socket: UnixStream,
    pipe: File,
    page: SharedWords,
    received: u32,
    buffer: Vec<u8>,
    // They live as long as their ports.
    _node: Node<ipc::Service>,
    _bus: Bus,
}

impl Sink {
    fn open(config: &SinkConfig) -> Result<Self, BenchError> {
        let stop = Arc::new(AtomicBool::new(false));
        kit::guard::watch_parent(Arc::clone(&stop))
            .map_err(BenchError::system("cannot start the parent guard"))?;
        if let Some(processor) = config.processor {
            pin(processor)?;
        }
        let space = config.space()?;
        let bus = Bus::join(&space, config.bus_options(), "bench-sink")?;
        let ours: Subscriber<Scan> = bus.subscriber()?;
        ours.update_connections()?;
        let node = raw::node(&space)?;
        let raw = raw_service(&node, config)?
            .subscriber_builder()
            .create()
            .map_err(BenchError::raw("subscribe"))?;
        let raw_event = raw_event(&node)?
            .listener_builder()
            .create()
            .map_err(BenchError::raw("listen"))?;
        let socket = UnixStream::connect(socket_path(&config.root))
            .map_err(BenchError::system("cannot connect to the socket"))?;
        let page = SharedWords::open(&config.prefix)?;
        page.word(READY).fetch_add(1, Ordering::SeqCst);
        // Waits for the writing end.
        let pipe = File::open(pipe_path(&config.root))
            .map_err(BenchError::system("cannot open the pipe"))?;
        Ok(Self {
            stop,
            ours_event: bus.listener(EVENT)?,
            ours,
            raw,
            raw_event,
            socket,
            pipe,
            page,
            received: 0,
            buffer: vec![0; FRAME + config.most],
            _node: node,
            _bus: bus,
        })
    }

    fn run(&mut self) -> Result<(), BenchError> {
        self.page.word(READY).fetch_add(1, Ordering::SeqCst);
        let mut misses = 0_u32;
        loop {
            let mode = self.page.word(MODE).load(Ordering::SeqCst);
            if mode == END || self.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let Some(way) = Way::of_word(mode) else {
                sleep_while(self.page.word(MODE), mode, LOOK_UP);
                continue;
            };
            let sent = self.page.word(SENT).load(Ordering::SeqCst);
            let begun = match way.carrier {
                Carrier::Ours => self.take_ours()?,
                Carrier::Raw => self.take_raw()?,
                Carrier::Socket => match framed(&mut self.socket, &mut self.buffer)? {
                    Framed::Message(begun, now) => Some((begun, now)),
                    Framed::EndOfBlock => None,
                    Framed::Closed => return Ok(()),
                },
                Carrier::Pipe => match framed(&mut self.pipe, &mut self.buffer)? {
                    Framed::Message(begun, now) => Some((begun, now)),
                    Framed::EndOfBlock => None,
                    Framed::Closed => return Ok(()),
                },
            };
            if let Some((begun, now)) = begun {
                self.took(now.saturating_sub(begun));
                misses = 0;
                continue;
            }
            misses = misses.wrapping_add(1);
            match (way.carrier, way.idle) {
                (Carrier::Socket | Carrier::Pipe, _) => {
                    // The block is over: the mode changes now.
                    sleep_while(self.page.word(MODE), mode, LOOK_UP);
                }
                (_, Idle::Spin) => {
                    std::hint::spin_loop();
                    if misses.is_multiple_of(4096) {
                        std::thread::yield_now();
                    }
                }
                (_, Idle::Yield | Idle::Read) => std::thread::yield_now(),
                (_, Idle::Futex) => sleep_while(self.page.word(SENT), sent, LOOK_UP),
                (Carrier::Ours, Idle::Event) => self.ours_event.wait(LOOK_UP, |_| {})?,
                (Carrier::Raw, Idle::Event) => {
                    let waited = self.raw_event.timed_wait(|_| {}, LOOK_UP);
                    waited.map_err(BenchError::raw("wait"))?;
                }
            }
        }
    }

    /// Says that a message is here, and how long it took.
    fn took(&mut self, latency: u64) {
        let latency = u32::try_from(latency).unwrap_or(u32::MAX);
        self.page.word(LATENCY).store(latency, Ordering::SeqCst);
        self.received = self.received.wrapping_add(1);
        store_and_wake(self.page.word(RECEIVED), self.received);
    }

    /// When the next message was begun, and when it was here.
    fn take_ours(&self) -> Result<Option<(u64, u64)>, BenchError> {
        let message = self.ours.receive()?;
        Ok(message.map(|message| (message.header().stamp.origin_ns, monotonic_ns())))
    }

    fn take_raw(&self) -> Result<Option<(u64, u64)>, BenchError> {
        let message = self.raw.receive();
        let message = message.map_err(BenchError::raw("receive"))?;
        Ok(message.map(|message| (message.user_header().words[0], monotonic_ns())))
    }
}

/// What came over a socket or pipe.
enum Framed {
    /// A message: when it was begun, and when all of it was here.
    Message(u64, u64),
    /// No more messages in this block.
    EndOfBlock,
    /// The sender is gone.
    Closed,
}

fn framed(from: &mut impl Read, buffer: &mut [u8]) -> Result<Framed, BenchError> {
    let failed = BenchError::system("cannot read a message");
    let (frame, payload) = buffer.split_at_mut(FRAME);
    let read = from.read_exact(frame).and_then(|()| {
        let word = |at: usize| {
            let bytes = frame.get(at..at + 8).and_then(|b| b.try_into().ok());
            u64::from_le_bytes(bytes.unwrap_or_default())
        };
        let (begun, bytes) = (word(0), word(8));
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        let payload = payload.get_mut(..bytes).ok_or_else(|| {
            std::io::Error::new(std::io::ErrorKind::InvalidData, "longer than agreed")
        })?;
        from.read_exact(payload)?;
        Ok((begun, monotonic_ns()))
    });
    match read {
        Ok((0, _)) => Ok(Framed::EndOfBlock),
        Ok((begun, now)) => Ok(Framed::Message(begun, now)),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(Framed::Closed),
        Err(error) => Err(failed(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(begun: u64, length: u64, payload: &[u8]) -> Vec<u8> {
        [&begun.to_le_bytes()[..], &length.to_le_bytes(), payload].concat()
    }

    #[test]
    fn frames_are_read_whole_ended_and_refused() {
        let mut buffer = vec![0; FRAME + 4];
        let mut read = |bytes: &[u8]| framed(&mut &bytes[..], &mut buffer);
        assert!(matches!(
            read(&bytes(7, 3, b"abc")),
            Ok(Framed::Message(7, _))
        ));
        assert!(matches!(read(&bytes(0, 0, b"")), Ok(Framed::EndOfBlock)));
        assert!(matches!(read(&bytes(7, 3, b"ab")), Ok(Framed::Closed)));
        assert!(matches!(read(b""), Ok(Framed::Closed)));
        assert!(
            read(&bytes(7, u64::MAX, b"abc")).is_err(),
            "longer than agreed"
        );
    }
}
