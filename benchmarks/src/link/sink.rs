//! The receiving side of a link.

use std::fs::File;
use std::io::Read;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use iceoryx2::port::listener::Listener;
use iceoryx2::port::subscriber::Subscriber as RawSubscriber;
use iceoryx2::prelude::{Node, ipc};
use ipc_types::bus::{Bus, Subscriber};
use ipc_types::clock::monotonic_ns;
use ipc_types::topics::Scan;
use platform::eprintln;

use super::transport::{
    FRAME, RawHeader, pipe_path, raw_event, raw_node, raw_service, socket_path,
};
use super::{
    END, LATENCY, LinkError, MODE, READY, RECEIVED, SENT, SharedWords, SinkConfig, Transport, pin,
    sleep_while, store_and_wake,
};

/// Maximum sleep between checks for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

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
    bus_in: Subscriber<Scan>,
    raw_in: RawSubscriber<ipc::Service, [f32], RawHeader>,
    raw_event: Listener<ipc::Service>,
    socket: UnixStream,
    pipe: File,
    page: SharedWords,
    received: u32,
    buffer: Vec<u8>,
    yields: bool,
    // These must live as long as their ports.
    _node: Node<ipc::Service>,
    _bus: Bus,
}

/// Next event of a transport.
enum Next {
    /// A message: the times of its sending and of its reception (ns).
    Message(u64, u64),
    /// No event yet.
    Nothing,
    /// End of the messages of this block.
    EndOfBlock,
    /// The sender has ended.
    Closed,
}

impl Sink {
    fn open(config: &SinkConfig) -> Result<Self, LinkError> {
        let stop = Arc::new(AtomicBool::new(false));
        runtime::guard::watch_parent(Arc::clone(&stop))
            .map_err(LinkError::system("cannot watch the parent process"))?;
        if let Some(processor) = config.processor {
            pin(processor)?;
        }
        let space = config.space()?;
        let bus = Bus::join(&space, SinkConfig::bus_options(), "latency-sink")?;
        let bus_in: Subscriber<Scan> = bus.subscriber()?;
        bus_in.update_connections()?;
        let node = raw_node(&space)?;
        let raw_in = raw_service(&node)?
            .subscriber_builder()
            .create()
            .map_err(LinkError::raw("subscribe"))?;
        let raw_event = raw_event(&node)?
            .listener_builder()
            .create()
            .map_err(LinkError::raw("listen"))?;
        let socket = UnixStream::connect(socket_path(&config.root))
            .map_err(LinkError::system("cannot connect to the socket"))?;
        let page = SharedWords::open(&config.prefix)?;
        page.word(READY).fetch_add(1, Ordering::SeqCst);
        // Blocks until the writing end is opened.
        let pipe = File::open(pipe_path(&config.root))
            .map_err(LinkError::system("cannot open the pipe"))?;
        page.word(READY).fetch_add(1, Ordering::SeqCst);
        Ok(Self {
            stop,
            bus_in,
            raw_in,
            raw_event,
            socket,
            pipe,
            page,
            received: 0,
            buffer: vec![0; FRAME + config.most],
            yields: config.yields,
            _node: node,
            _bus: bus,
        })
    }

    fn run(&mut self) -> Result<(), LinkError> {
        let mut misses = 0_u32;
        loop {
            let mode = self.page.word(MODE).load(Ordering::SeqCst);
            if mode == END || self.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let Some(transport) = Transport::of_word(mode) else {
                sleep_while(self.page.word(MODE), mode, POLL_INTERVAL);
                continue;
            };
            let sent = self.page.word(SENT).load(Ordering::SeqCst);
            match self.next(transport)? {
                Next::Message(begun, now) => {
                    self.took(now.saturating_sub(begun));
                    misses = 0;
                }
                Next::Nothing => {
                    misses = misses.wrapping_add(1);
                    self.wait(transport, sent, misses)?;
                }
                // The mode is about to change.
                Next::EndOfBlock => sleep_while(self.page.word(MODE), mode, POLL_INTERVAL),
                Next::Closed => return Ok(()),
            }
        }
    }

    fn next(&mut self, transport: Transport) -> Result<Next, LinkError> {
        let begun = match transport {
            Transport::Socket => return framed(&mut self.socket, &mut self.buffer),
            Transport::Pipe => return framed(&mut self.pipe, &mut self.buffer),
            Transport::Bus => {
                let message = self.bus_in.receive()?;
                message.map(|message| message.header().stamp.origin_ns)
            }
            Transport::RawPolled | Transport::RawWoken => {
                let message = self.raw_in.receive();
                let message = message.map_err(LinkError::raw("receive"))?;
                message.map(|message| message.user_header().words[0])
            }
        };
        Ok(begun.map_or(Next::Nothing, |begun| Next::Message(begun, monotonic_ns())))
    }

    /// Waits for a message as this transport does; `sent` was read before the last unsuccessful
    /// attempt.
    fn wait(&self, transport: Transport, sent: u32, misses: u32) -> Result<(), LinkError> {
        match transport {
            Transport::Bus => sleep_while(self.page.word(SENT), sent, POLL_INTERVAL),
            Transport::RawWoken => {
                let waited = self.raw_event.timed_wait(|_| {}, POLL_INTERVAL);
                waited.map_err(LinkError::raw("wait"))?;
            }
            _ if self.yields || misses.is_multiple_of(4096) => std::thread::yield_now(),
            _ => std::hint::spin_loop(),
        }
        Ok(())
    }

    /// Acknowledges a message with its latency (ns).
    fn took(&mut self, latency: u64) {
        let latency = u32::try_from(latency).unwrap_or(u32::MAX);
        self.page.word(LATENCY).store(latency, Ordering::SeqCst);
        self.received = self.received.wrapping_add(1);
        store_and_wake(self.page.word(RECEIVED), self.received);
    }
}

fn framed(from: &mut impl Read, buffer: &mut [u8]) -> Result<Next, LinkError> {
    let failed = LinkError::system("cannot read a message");
    let (frame, payload) = buffer.split_at_mut(FRAME);
    let read = from.read_exact(frame).and_then(|()| {
        let word = |at: usize| {
            let bytes = frame.get(at..at + 8).and_then(|b| b.try_into().ok());
            u64::from_le_bytes(bytes.unwrap_or_default())
        };
        let (begun, bytes) = (word(0), word(8));
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        let payload = payload.get_mut(..bytes).ok_or_else(|| {
            std::io::Error::new(
                std::io::ErrorKind::InvalidData,
                "longer than the maximum payload",
            )
        })?;
        from.read_exact(payload)?;
        Ok((begun, monotonic_ns()))
    });
    match read {
        Ok((0, _)) => Ok(Next::EndOfBlock),
        Ok((begun, now)) => Ok(Next::Message(begun, now)),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(Next::Closed),
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
    fn complete_frames_are_read_and_oversized_ones_refused() {
        let mut buffer = vec![0; FRAME + 4];
        let mut read = |bytes: &[u8]| framed(&mut &bytes[..], &mut buffer);
        assert!(matches!(
            read(&bytes(7, 3, b"abc")),
            Ok(Next::Message(7, _))
        ));
        assert!(matches!(read(&bytes(0, 0, b"")), Ok(Next::EndOfBlock)));
        assert!(matches!(read(&bytes(7, 3, b"ab")), Ok(Next::Closed)));
        assert!(matches!(read(b""), Ok(Next::Closed)));
        assert!(
            read(&bytes(7, u64::MAX, b"abc")).is_err(),
            "longer than the maximum payload"
        );
    }
}
