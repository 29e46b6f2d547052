//! The fingerprint of a run's simulated history.

use std::collections::BTreeMap;

use ipc_types::stamp::Stamp;

/// Messages are gathered up to this size before they are hashed: BLAKE3 is fastest on many blocks
/// at once. A multiple of its chunk of 1024 bytes.
const BUFFER_BYTES: usize = 16 * 1024;

/// Hashes messages apart by topic and source, in the order in which each source sent them, so that
/// the result depends on nothing but what was said: not on how messages of different sources
/// interleave, not on batches, cores or clocks.
#[derive(Debug, Default)]
pub(super) struct Digest {
    /// By topic name and source: the canonical order.
    streams: BTreeMap<(&'static str, u32), Stream>,
}

#[derive(Debug, Default)]
struct Stream {
    hasher: blake3::Hasher,
    buffer: Vec<u8>,
    messages: u64,
}

impl Digest {
    /// Takes up the next message of a source, in its CDR form with `header_bytes` of user header.
    ///
    /// The clocks at the end of the stamp are left out.
    pub(super) fn update(
        &mut self,
        topic: &'static str,
        source: u32,
        cdr: &[u8],
        header_bytes: usize,
    ) {
        debug_assert!(header_bytes >= size_of::<Stamp>());
        let stream = self.streams.entry((topic, source)).or_default();
        stream.messages += 1;
        // The length keeps two messages apart from one that looks like both.
        stream.push(&(cdr.len() as u64).to_le_bytes());
        stream.push(cdr.get(4..4 + Stamp::SIMULATED_BYTES).unwrap_or_default());
        stream.push(cdr.get(4 + size_of::<Stamp>()..).unwrap_or_default());
    }

    /// The fingerprint of everything so far, as 64 hexadecimal digits.
    pub(super) fn finish(&mut self) -> String {
        let mut all = blake3::Hasher::new();
        for ((topic, source), stream) in &mut self.streams {
            stream.empty();
            all.update(&(topic.len() as u64).to_le_bytes());
            all.update(topic.as_bytes());
            all.update(&source.to_le_bytes());
            all.update(&stream.messages.to_le_bytes());
            all.update(stream.hasher.finalize().as_bytes());
        }
        all.finalize().to_hex().to_string()
    }
}

impl Stream {
    fn push(&mut self, bytes: &[u8]) {
        if self.buffer.len() + bytes.len() > BUFFER_BYTES {
            self.empty();
        }
        if bytes.len() > BUFFER_BYTES {
            self.hasher.update(bytes);
        } else {
            self.buffer.extend_from_slice(bytes);
        }
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
    use ipc_types::topics::{Topic, WorldState};
    use proptest::prelude::*;

    use super::*;

    fn message(tick: u64, source: u32, x: f64, clock: u64, robots: usize) -> Vec<u8> {
        let mut header = WorldHeader::default();
        header.stamp.tick = tick;
        header.stamp.source = source;
        header.stamp.origin_ns = clock;
        header.stamp.received_ns = clock + 1;
        header.stamp.sent_ns = clock + 2;
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
            digest.update(WorldState::NAME, *source, bytes, size_of::<WorldHeader>());
        }
        digest.finish()
    }

    #[test]
    fn clocks_do_not_count_and_everything_else_does() {
        let one = digest(&[(0, message(1, 0, 2.0, 100, 1))]);
        assert_eq!(one, digest(&[(0, message(1, 0, 2.0, 999, 1))]));
        assert_ne!(one, digest(&[(0, message(2, 0, 2.0, 100, 1))]));
        assert_ne!(one, digest(&[(0, message(1, 0, 2.5, 100, 1))]));
        assert_ne!(one, digest(&[(0, message(1, 0, 2.0, 100, 2))]));
        assert_ne!(one, digest(&[(1, message(1, 0, 2.0, 100, 1))]));
        assert_eq!(one.len(), 64);
    }

    #[test]
    fn the_number_of_messages_counts_even_when_the_bytes_are_the_same() {
        let message = message(1, 0, 2.0, 0, 1);
        let twice = [(0, message.clone()), (0, message.clone())];
        assert_ne!(digest(&twice), digest(&twice[..1]));
    }

    proptest! {
        #[test]
        fn interleaving_of_sources_does_not_count(
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
