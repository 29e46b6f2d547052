//! Digest of the simulated history of a run.

use ipc_types::topics::TopicId;

use super::parts::Parts;

/// Size of the buffer before the hash (bytes): BLAKE3 is fastest on many chunks of 1024 bytes at once, which
/// must end at a power of two.
const BUFFER_BYTES: usize = 16 * 1024;

/// Digest with a separate hash for each topic and source, over messages in the order of sending. The result
/// does not depend on the interleaving of sources, on batches, cores or clocks.
#[derive(Debug, Default)]
pub(super) struct Digest {
    /// Streams in order of their first message.
    streams: Vec<Stream>,
}

#[derive(Debug)]
struct Stream {
    topic: TopicId,
    source: u32,
    hasher: blake3::Hasher,
    buffer: Vec<u8>,
    messages: u64,
}

impl Digest {
    /// Adds the next message of a source.
    ///
    /// Excludes the clock readings at the end of the stamp.
    pub(super) fn update(&mut self, topic: TopicId, source: u32, message: &Parts<'_>) {
        // A run has one or two dozen streams: a linear search is faster than a map.
        let known = self
            .streams
            .iter()
            .position(|stream| stream.source == source && stream.topic == topic);
        let at = known.unwrap_or_else(|| {
            self.streams
                .push(Stream::new(topic, source, blake3::Hasher::new()));
            self.streams.len() - 1
        });
        let Some(stream) = self.streams.get_mut(at) else {
            return;
        };
        stream.messages += 1;
        // The length distinguishes two messages from one with the same bytes.
        stream.push(&(message.history_len() as u64).to_le_bytes());
        for bytes in message.without_clocks() {
            stream.push(bytes);
        }
    }

    /// Begins the stream of a source with the hash state after its first message ([`Digest::beginning`]);
    /// returns `false` if the stream exists.
    pub(super) fn begin(&mut self, topic: TopicId, source: u32, hasher: &blake3::Hasher) -> bool {
        let mut streams = self.streams.iter();
        if streams.any(|stream| stream.source == source && stream.topic == topic) {
            return false;
        }
        let mut stream = Stream::new(topic, source, hasher.clone());
        stream.messages = 1;
        self.streams.push(stream);
        true
    }

    /// Returns the hash state after the first message of a source, if it is the only one.
    pub(super) fn beginning(&mut self, topic: TopicId, source: u32) -> Option<blake3::Hasher> {
        let mut streams = self.streams.iter_mut();
        let stream = streams.find(|stream| stream.source == source && stream.topic == topic)?;
        if stream.messages != 1 {
            return None;
        }
        stream.empty();
        Some(stream.hasher.clone())
    }

    /// Returns the digest of all messages so far, as 64 hexadecimal digits.
    pub(super) fn finish(&mut self) -> String {
        self.streams
            .sort_unstable_by_key(|stream| (stream.topic.name(), stream.source));
        let mut all = blake3::Hasher::new();
        for stream in &mut self.streams {
            stream.empty();
            let name = stream.topic.name();
            all.update(&(name.len() as u64).to_le_bytes());
            all.update(name.as_bytes());
            all.update(&stream.source.to_le_bytes());
            all.update(&stream.messages.to_le_bytes());
            all.update(stream.hasher.finalize().as_bytes());
        }
        all.finalize().to_hex().to_string()
    }
}

impl Stream {
    fn new(topic: TopicId, source: u32, hasher: blake3::Hasher) -> Self {
        Self {
            topic,
            source,
            hasher,
            buffer: Vec::with_capacity(BUFFER_BYTES),
            messages: 0,
        }
    }

    fn push(&mut self, bytes: &[u8]) {
        let room = BUFFER_BYTES - self.buffer.len();
        if bytes.len() < room {
            self.buffer.extend_from_slice(bytes);
            return;
        }
        let (fitting, mut rest) = bytes.split_at(room);
        self.buffer.extend_from_slice(fitting);
        self.empty();
        if rest.len() >= BUFFER_BYTES {
            let (whole, behind) = rest.split_at(rest.len() - rest.len() % BUFFER_BYTES);
            self.hasher.update(whole);
            rest = behind;
        }
        self.buffer.extend_from_slice(rest);
    }

    fn empty(&mut self) {
        self.hasher.update(&self.buffer);
        self.buffer.clear();
    }
}

#[cfg(test)]
mod tests {
    use ipc_types::cdr;
    use ipc_types::messages::world::{RobotState, WorldHeader};
    use ipc_types::topics::WorldState;
    use proptest::prelude::*;

    use super::*;

    fn message(tick: u64, source: u32, x: f64, clock: u64, robots: usize) -> Vec<u8> {
        let mut header = WorldHeader::default();
        header.stamp.tick = tick;
        header.stamp.source = source;
        for (later, its) in (0..).zip(header.stamp.clocks_mut()) {
            *its = clock + later;
        }
        let mut bytes = Vec::new();
        let robots = vec![
            RobotState {
                x,
                ..RobotState::default()
            };
            robots
        ];
        cdr::encode::<WorldState>(&header, &robots, &mut bytes);
        bytes
    }

    fn digest(messages: &[(u32, Vec<u8>)]) -> String {
        let mut digest = Digest::default();
        for (source, bytes) in messages {
            let robots = cdr::decode::<WorldState>(bytes).unwrap().1.len();
            digest.update(
                TopicId::WorldState,
                *source,
                &Parts::of_cdr(TopicId::WorldState, bytes, robots),
            );
        }
        digest.finish()
    }

    #[test]
    fn the_digest_covers_everything_except_clock_readings() {
        let one = digest(&[(0, message(1, 0, 2.0, 100, 1))]);
        assert_eq!(one, digest(&[(0, message(1, 0, 2.0, 999, 1))]));
        assert_ne!(one, digest(&[(0, message(2, 0, 2.0, 100, 1))]));
        assert_ne!(one, digest(&[(0, message(1, 0, 2.5, 100, 1))]));
        assert_ne!(one, digest(&[(0, message(1, 0, 2.0, 100, 2))]));
        assert_ne!(one, digest(&[(1, message(1, 0, 2.0, 100, 1))]));
        assert_eq!(one.len(), 64);
    }

    #[test]
    fn the_digest_covers_the_number_of_messages() {
        let message = message(1, 0, 2.0, 0, 1);
        let twice = [(0, message.clone()), (0, message.clone())];
        assert_ne!(digest(&twice), digest(&twice[..1]));
    }

    #[test]
    fn a_stream_begun_with_a_known_hash_state_gives_the_same_digest() {
        let messages = [message(0, 5, 1.0, 3, 700), message(1, 5, 2.0, 4, 2)];
        let parts =
            [(0, 700), (1, 2)].map(|(i, n)| Parts::of_cdr(TopicId::WorldState, &messages[i], n));
        let mut whole = Digest::default();
        whole.update(TopicId::WorldState, 5, &parts[0]);
        let hasher = whole.beginning(TopicId::WorldState, 5).unwrap();
        whole.update(TopicId::WorldState, 5, &parts[1]);
        assert!(whole.beginning(TopicId::WorldState, 5).is_none());
        let mut begun = Digest::default();
        assert!(begun.begin(TopicId::WorldState, 5, &hasher));
        assert!(!begun.begin(TopicId::WorldState, 5, &hasher));
        begun.update(TopicId::WorldState, 5, &parts[1]);
        assert_eq!(begun.finish(), whole.finish());
    }

    proptest! {
        #[test]
        fn interleaving_of_sources_does_not_matter(
            order in proptest::collection::vec(0_u32..4, 1..60), robots in 1_usize..400,
        ) {
            let mut next = [0_u64; 4];
            let interleaved: Vec<_> = order
                .iter()
                .map(|&source| {
                    let tick = next[source as usize];
                    next[source as usize] += 1;
                    (source, message(tick, source, tick as f64, 7, robots))
                })
                .collect();
            let mut by_source = interleaved.clone();
            by_source.sort_by_key(|(source, _)| *source);
            prop_assert_eq!(digest(&interleaved), digest(&by_source));
        }
    }
}
