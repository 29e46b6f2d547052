//! Broadcaster between the recorder, which must not wait, and viewers, which may be slow.

use std::collections::{BTreeMap, VecDeque};
use std::os::fd::OwnedFd;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mcap_log::states::is_latched;
use mcap_log::{ChannelSpec, LogObserver};
use serde::Serialize;
use serde_json::Value as Json;

use super::wire::{self, Subscription};

/// Maximum size of the queue of a viewer (bytes); beyond it the oldest messages are dropped.
const MAX_QUEUE_BYTES: usize = 32 << 20;

/// Totals of the messages to viewers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct LiveTotals {
    /// Number of viewers that connected.
    pub viewers: u64,
    /// Number of messages written to connections.
    pub messages: u64,
    /// Number of messages dropped because a viewer was too slow.
    pub left_out: u64,
    /// Number of viewers disconnected because they stopped reading.
    pub cut_off: u64,
}

/// Broadcaster: the channels and the connected viewers.
#[derive(Debug, Default)]
pub struct Broadcaster {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    channels: Vec<Channel>,
    viewers: BTreeMap<u64, Viewer>,
    time_ns: u64,
    /// The latest time so far (ns).
    reached_ns: u64,
    totals: LiveTotals,
    closed: bool,
}

#[derive(Debug)]
struct Channel {
    /// Announcement of the channel.
    announced: Json,
    /// `true` if the channel is latched: late viewers get its last message.
    latched: bool,
    last: Option<(u64, Arc<[u8]>)>,
}

#[derive(Debug)]
struct Viewer {
    /// Subscription ids of the viewer, by channel.
    subscriptions: BTreeMap<usize, u32>,
    queue: VecDeque<Frame>,
    queued_bytes: usize,
    /// Event descriptor, written when a message is queued.
    wake: Arc<OwnedFd>,
}

/// A frame to send to a viewer.
#[derive(Debug)]
pub(super) enum Frame {
    /// A text.
    Text(String),
    /// Current time (simulated ns).
    Time(u64),
    /// A message.
    Message {
        /// Subscription id of the viewer.
        subscription: u32,
        /// Index of the channel.
        channel: usize,
        /// Log time (simulated ns).
        time_ns: u64,
        /// Payload, shared by all viewers.
        data: Arc<[u8]>,
    },
}

impl Frame {
    /// Returns the approximate size on the wire (bytes).
    fn bytes(&self) -> usize {
        16 + match self {
            Self::Text(text) => text.len(),
            Self::Time(_) => 0,
            Self::Message { data, .. } => data.len(),
        }
    }
}

impl Broadcaster {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A panic while the lock is held leaves the state usable for viewers.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the handle that receives logged messages.
    pub fn tap(self: &Arc<Self>) -> BroadcastHandle {
        BroadcastHandle(Arc::clone(self))
    }

    /// Adds a viewer and announces all channels to it; `wake` is written when a frame is queued. Returns the
    /// id of the viewer; `None` after the end.
    pub(super) fn join(&self, session: &str, wake: Arc<OwnedFd>) -> Option<u64> {
        let mut state = self.lock();
        if state.closed {
            return None;
        }
        state.totals.viewers += 1;
        let id = state.totals.viewers;
        let announced: Vec<Json> = state.channels.iter().map(|c| c.announced.clone()).collect();
        let mut viewer = Viewer {
            subscriptions: BTreeMap::new(),
            queue: VecDeque::new(),
            queued_bytes: 0,
            wake,
        };
        viewer.push(Frame::Text(wire::server_info(session)));
        viewer.push(Frame::Time(state.time_ns));
        viewer.push(Frame::Text(wire::advertise(&announced)));
        state.viewers.insert(id, viewer);
        Some(id)
    }

    /// Counts a browser that shows the page.
    pub(super) fn count_viewer(&self) {
        self.lock().totals.viewers += 1;
    }

    /// Counts a browser that was disconnected because it stopped reading.
    pub(super) fn count_cut_off(&self) {
        self.lock().totals.cut_off += 1;
    }

    /// Returns the simulated time, and the latest so far (ns): a replay may begin again.
    pub(super) fn times_ns(&self) -> [u64; 2] {
        let state = self.lock();
        [state.time_ns, state.reached_ns]
    }

    /// Removes a viewer, which left or was disconnected (`cut_off`).
    pub(super) fn leave(&self, viewer: u64, cut_off: bool) {
        let mut state = self.lock();
        state.totals.cut_off += u64::from(cut_off);
        state.viewers.remove(&viewer);
    }

    /// Subscribes a viewer to channels; queues their latched messages.
    pub(super) fn subscribe(&self, viewer: u64, subscriptions: &[Subscription]) {
        let mut state = self.lock();
        let State {
            channels, viewers, ..
        } = &mut *state;
        let Some(viewer) = viewers.get_mut(&viewer) else {
            return;
        };
        for subscription in subscriptions {
            let index = subscription.channel_id as usize;
            let Some(channel) = channels.get(index) else {
                continue;
            };
            viewer.subscriptions.insert(index, subscription.id);
            if let Some((time_ns, data)) = &channel.last {
                viewer.push(Frame::Message {
                    subscription: subscription.id,
                    channel: index,
                    time_ns: *time_ns,
                    data: Arc::clone(data),
                });
            }
        }
    }

    /// Ends subscriptions of a viewer.
    pub(super) fn unsubscribe(&self, viewer: u64, subscriptions: &[u32]) {
        let mut state = self.lock();
        if let Some(viewer) = state.viewers.get_mut(&viewer) {
            viewer
                .subscriptions
                .retain(|_, id| !subscriptions.contains(id));
        }
    }

    /// Takes queued frames of a viewer, up to about this size (bytes).
    pub(super) fn take(&self, viewer: u64, bytes: usize) -> Vec<Frame> {
        let mut state = self.lock();
        let Some(viewer) = state.viewers.get_mut(&viewer) else {
            return Vec::new();
        };
        let (mut taken, mut sum) = (Vec::new(), 0);
        while sum < bytes
            && let Some(frame) = viewer.queue.pop_front()
        {
            sum += frame.bytes();
            taken.push(frame);
        }
        viewer.queued_bytes -= sum;
        let messages = taken.iter().filter(|f| matches!(f, Frame::Message { .. }));
        state.totals.messages += messages.count() as u64;
        taken
    }

    /// Returns `true` after the end: queued frames are still sent, new ones do not follow.
    pub(super) fn is_closed(&self) -> bool {
        self.lock().closed
    }

    /// Marks the end.
    pub(super) fn close(&self) {
        let mut state = self.lock();
        state.closed = true;
        state.viewers.values().for_each(Viewer::wake);
    }

    /// Returns the totals so far.
    pub fn totals(&self) -> LiveTotals {
        self.lock().totals
    }
}

impl State {
    /// Continues at another time; discards latched messages.
    fn jump(&mut self, time_ns: u64) {
        self.time_ns = time_ns;
        self.channels
            .iter_mut()
            .for_each(|channel| channel.last = None);
        for viewer in self.viewers.values_mut() {
            viewer.push(Frame::Time(time_ns));
        }
    }

    fn message(&mut self, channel: usize, time_ns: u64, data: &[u8]) {
        let Self {
            channels, viewers, ..
        } = self;
        self.reached_ns = self.reached_ns.max(time_ns);
        if time_ns > self.time_ns {
            self.time_ns = time_ns;
            for viewer in viewers.values_mut() {
                viewer.push(Frame::Time(time_ns));
            }
        }
        let Some(here) = channels.get_mut(channel) else {
            return;
        };
        let wanted = |viewer: &Viewer| viewer.subscriptions.contains_key(&channel);
        if !here.latched && !viewers.values().any(wanted) {
            return;
        }
        let data: Arc<[u8]> = data.into();
        if here.latched {
            here.last = Some((time_ns, Arc::clone(&data)));
        }
        for viewer in viewers.values_mut() {
            if let Some(&subscription) = viewer.subscriptions.get(&channel) {
                viewer.push(Frame::Message {
                    subscription,
                    channel,
                    time_ns,
                    data: Arc::clone(&data),
                });
                self.totals.left_out += viewer.shorten(channels);
            }
        }
    }
}

impl Viewer {
    fn push(&mut self, frame: Frame) {
        self.queued_bytes += frame.bytes();
        if self.queue.is_empty() {
            self.wake();
        }
        self.queue.push_back(frame);
    }

    fn wake(&self) {
        // A full counter also wakes the reader.
        let _ = rustix::io::write(&*self.wake, &1_u64.to_ne_bytes());
    }

    /// Drops the oldest messages while the queue is too long, except latched ones; returns their number.
    fn shorten(&mut self, channels: &[Channel]) -> u64 {
        let mut left_out = 0;
        if self.queued_bytes <= MAX_QUEUE_BYTES {
            return left_out;
        }
        let (wanted, mut waiting) = (MAX_QUEUE_BYTES / 2, self.queued_bytes);
        self.queue.retain(|frame| {
            let Frame::Message { channel, data, .. } = frame else {
                return true;
            };
            let last = channels.get(*channel).and_then(|c| c.last.as_ref());
            let holds = last.is_some_and(|(_, last)| Arc::ptr_eq(last, data));
            let stays = waiting <= wanted || holds;
            if !stays {
                waiting -= frame.bytes();
                left_out += 1;
            }
            stays
        });
        self.queued_bytes = waiting;
        left_out
    }
}

/// Handle that receives logged messages.
#[derive(Debug)]
pub struct BroadcastHandle(Arc<Broadcaster>);

impl BroadcastHandle {
    /// Continues at another time (simulated ns), which may be earlier. Discards latched messages; the caller
    /// sends those of the new time next.
    pub fn jump(&mut self, time_ns: u64) {
        self.0.lock().jump(time_ns);
    }
}

impl LogObserver for BroadcastHandle {
    fn channel(&mut self, spec: &ChannelSpec<'_>) {
        let mut state = self.0.lock();
        // A log contains at most 65 535 channels.
        let announced = wire::channel(state.channels.len() as u32, spec);
        let text = wire::advertise(std::slice::from_ref(&announced));
        state.channels.push(Channel {
            announced,
            latched: is_latched(spec.topic, spec.metadata),
            last: None,
        });
        for viewer in state.viewers.values_mut() {
            viewer.push(Frame::Text(text.clone()));
        }
    }

    fn message(&mut self, channel: usize, log_time: u64, data: &[u8]) {
        self.0.lock().message(channel, log_time, data);
    }
}

#[cfg(test)]
mod tests {
    use mcap_log::states::latched_entry;

    use super::*;

    fn spec<'a>(topic: &'a str, metadata: &'a BTreeMap<String, String>) -> ChannelSpec<'a> {
        ChannelSpec {
            topic,
            schema_name: "Thing",
            schema_encoding: "ros2msg",
            schema: b"uint8 x",
            message_encoding: "cdr",
            metadata,
        }
    }

    fn broadcaster() -> (Arc<Broadcaster>, BroadcastHandle) {
        let broadcaster = Arc::new(Broadcaster::default());
        let mut tap = broadcaster.tap();
        tap.channel(&spec("/map", &BTreeMap::from([latched_entry()])));
        tap.channel(&spec("/rosout", &BTreeMap::new()));
        (broadcaster, tap)
    }

    fn join(broadcaster: &Broadcaster) -> u64 {
        let wake = rustix::event::eventfd(0, rustix::event::EventfdFlags::NONBLOCK).unwrap();
        broadcaster.join("session", Arc::new(wake)).unwrap()
    }

    fn subscribe(broadcaster: &Broadcaster, viewer: u64) {
        let both = [0, 1, 99].map(|channel_id| Subscription {
            id: 10 + channel_id,
            channel_id,
        });
        broadcaster.subscribe(viewer, &both);
    }

    fn messages(broadcaster: &Broadcaster, viewer: u64) -> Vec<(u32, u64, Vec<u8>)> {
        let frames = broadcaster.take(viewer, usize::MAX);
        let message = |frame| match frame {
            Frame::Message {
                subscription,
                time_ns,
                data,
                ..
            } => Some((subscription, time_ns, data.to_vec())),
            _ => None,
        };
        frames.into_iter().filter_map(message).collect()
    }

    #[test]
    fn late_viewers_get_latched_messages_only() {
        let (broadcaster, mut tap) = broadcaster();
        tap.message(0, 5, b"old map");
        tap.message(0, 6, b"map");
        tap.message(1, 7, b"news");
        let viewer = join(&broadcaster);
        let hello = broadcaster.take(viewer, usize::MAX);
        assert!(matches!(
            &hello[..],
            [Frame::Text(_), Frame::Time(7), Frame::Text(_)]
        ));
        subscribe(&broadcaster, viewer);
        assert_eq!(messages(&broadcaster, viewer), [(10, 6, b"map".to_vec())]);
        tap.message(1, 8, b"more news");
        assert_eq!(
            messages(&broadcaster, viewer),
            [(11, 8, b"more news".to_vec())]
        );
        broadcaster.unsubscribe(viewer, &[11]);
        tap.message(1, 9, b"unsubscribed");
        assert_eq!(messages(&broadcaster, viewer), []);
    }

    #[test]
    fn a_jump_sets_the_clock_back_and_late_viewers_get_the_messages_latched_there() {
        let (broadcaster, mut tap) = broadcaster();
        let early = join(&broadcaster);
        subscribe(&broadcaster, early);
        tap.message(0, 5, b"map");
        tap.message(1, 7, b"news");
        broadcaster.take(early, usize::MAX);
        tap.jump(3);
        let late = join(&broadcaster);
        subscribe(&broadcaster, late);
        let frames = broadcaster.take(late, usize::MAX);
        assert!(
            matches!(
                &frames[..],
                [Frame::Text(_), Frame::Time(3), Frame::Text(_)]
            ),
            "{frames:?}"
        );
        tap.message(0, 2, b"older map");
        tap.message(1, 4, b"old news");
        let frames = broadcaster.take(early, usize::MAX);
        let times = frames.iter().map(|frame| match frame {
            Frame::Time(time_ns) | Frame::Message { time_ns, .. } => *time_ns,
            Frame::Text(_) => u64::MAX,
        });
        // Time, latched messages, time, new messages.
        assert_eq!(times.collect::<Vec<_>>(), [3, 2, 4, 4]);
        assert_eq!(
            messages(&broadcaster, late),
            [
                (10, 2, b"older map".to_vec()),
                (11, 4, b"old news".to_vec())
            ]
        );
    }

    #[test]
    fn a_slow_viewer_loses_the_oldest_messages_but_no_latched_ones() {
        let (broadcaster, mut tap) = broadcaster();
        let [slow, fast] = [join(&broadcaster), join(&broadcaster)];
        subscribe(&broadcaster, slow);
        subscribe(&broadcaster, fast);
        tap.message(0, 1, b"map");
        let large = vec![0; 1 << 20];
        let mut received = 0;
        for time_ns in 2..102 {
            tap.message(1, time_ns, &large);
            received += messages(&broadcaster, fast).len() as u64;
        }
        assert_eq!(received, 101, "the fast viewer loses no message");
        let got = messages(&broadcaster, slow);
        assert_eq!(got[0], (10, 1, b"map".to_vec()));
        let last = got.last().unwrap();
        assert_eq!((last.0, last.1), (11, 101), "the newest messages are kept");
        let totals = broadcaster.totals();
        assert_eq!(totals.left_out, 101 - got.len() as u64);
        assert!(totals.left_out >= 100 - 32, "{totals:?}");
        assert_eq!(totals.messages, received + got.len() as u64);
        assert_eq!(broadcaster.lock().viewers[&slow].queued_bytes, 0);
    }

    #[test]
    fn no_viewer_is_accepted_after_the_end() {
        let (broadcaster, _tap) = broadcaster();
        broadcaster.close();
        let wake = rustix::event::eventfd(0, rustix::event::EventfdFlags::NONBLOCK).unwrap();
        assert_eq!(broadcaster.join("session", Arc::new(wake)), None);
    }
}
