//! Time, order and sender of a message.

use iceoryx2::prelude::ZeroCopySend;

use crate::message;

message! {
    /// Stands first in the user header of every message.
    ///
    /// The simulated part (tick, time, sequence, source) is a function of scenario and seed in
    /// lock-step and belongs to the digest of a run. The monotonic clocks sit together at the end,
    /// never steer anything, and are outside the digest. A sender's own four follow each other:
    /// it is its turn, the last input is there, the result is there, the message is on its way. A
    /// clock that was not read is 0.
    pub struct Stamp = "protean/Stamp" {
        tick: u64 = "tick of the world state that this message belongs to",
        time_ns: u64 = "simulated time of that tick [ns]",
        sequence: u64 = "counts the messages of one publisher on one topic from 0; a gap is a loss",
        source: u32 = "index of the sending process in the run",
        reserved: u32 = "always 0",
        origin_ns: u64 = "monotonic clock when the causing world state was sent [ns], handed on unchanged",
        begun_ns: u64 = "monotonic clock when the sender was awake and began its turn [ns]",
        received_ns: u64 = "monotonic clock when the sender took up the last input for this message [ns]",
        computed_ns: u64 = "monotonic clock when the content of this message was known and its writing began [ns]",
        sent_ns: u64 = "monotonic clock when this message was written and sent [ns]",
    }
}

impl Stamp {
    /// Number of leading bytes that belong to simulated history; the clocks follow them.
    pub const SIMULATED_BYTES: usize = core::mem::offset_of!(Stamp, origin_ns);

    /// Offset of `computed_ns` (bytes).
    pub const COMPUTED_AT: usize = core::mem::offset_of!(Stamp, computed_ns);
    /// Offset of `sent_ns` (bytes).
    pub const SENT_AT: usize = core::mem::offset_of!(Stamp, sent_ns);

    /// Becomes the stamp of a message with this number on a bus without clocks.
    pub fn renumber(&mut self, sequence: u64) {
        self.sequence = sequence;
        self.clocks_mut().into_iter().for_each(|clock| *clock = 0);
    }

    /// All clocks, mutable.
    pub fn clocks_mut(&mut self) -> [&mut u64; 5] {
        [
            &mut self.origin_ns,
            &mut self.begun_ns,
            &mut self.received_ns,
            &mut self.computed_ns,
            &mut self.sent_ns,
        ]
    }
}

/// A user header: a message whose first field is the [`Stamp`].
pub trait Header: message::Message {
    /// The stamp.
    fn stamp(&self) -> &Stamp;
    /// The stamp, mutable.
    fn stamp_mut(&mut self) -> &mut Stamp;
}

/// Implements [`Header`] for messages with a `stamp` field at offset 0, and checks that offset.
#[macro_export]
macro_rules! headers {
    ($($name:ident),+ $(,)?) => {$(
        impl $crate::stamp::Header for $name {
            fn stamp(&self) -> &$crate::stamp::Stamp {
                &self.stamp
            }
            fn stamp_mut(&mut self) -> &mut $crate::stamp::Stamp {
                &mut self.stamp
            }
        }
        const _: () = assert!(core::mem::offset_of!($name, stamp) == 0 && size_of::<$name>() % 8 == 0);
    )+};
}

message! {
    /// Header of topics that need nothing but the stamp.
    pub struct PlainHeader = "protean/PlainHeader" {
        stamp: Stamp = "when, in which order, by whom",
    }
}
headers!(PlainHeader);
