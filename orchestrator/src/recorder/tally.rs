//! What a run amounts to, without a log: for runs of which there are many.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use ipc_types::bus::{Bus, BusError, ReceiveError, Received, Subscriber};
use ipc_types::cdr::SequenceHead;
use ipc_types::messages::observer::Prediction;
use ipc_types::messages::process::ProcessEvent;
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::{CoverageState, RobotState, WorldEvent, WorldHeader};
use ipc_types::stamp::Header as _;
use ipc_types::topics::{
    Coverage, Predictions, ProcessEvents, Topic, TopicVisitor, Verdicts, Waypoints, WorldEvents,
    WorldMap, WorldState, for_each_topic,
};
use zerocopy::IntoBytes as _;

use super::beginnings::Beginnings;
use super::error::RecorderError;
use super::gate::{Gate, Observer};
use super::ledger::Ledger;
use super::options::{ProcessInfo, RobotInfo};
use super::parts::Parts;
use super::summary::{Outcome, Summary, TopicCount, seconds};
use super::topic_info;

/// Longest sleep between two looks at a bus between processes: long enough to be woken per batch of
/// ticks; a gate wakes earlier when the simulator is about to be held back.
const NAP: Duration = Duration::from_millis(10);

/// Checks, counts and fingerprints the messages of a run as a [`Recording`](super::Recording) does,
/// and comes to the same summary, but for latencies, and keeps nothing. Messages of processes, who
/// could still write to them, are copied first; those of one thread are looked at where they lie.
pub struct Tally {
    states: Tap<WorldState>,
    events: Tap<WorldEvents>,
    maps: Tap<WorldMap>,
    coverage: Tap<Coverage>,
    verdicts: Tap<Verdicts>,
    waypoints: Tap<Waypoints>,
    predictions: Tap<Predictions>,
    failures: Tap<ProcessEvents>,
    /// All other topics.
    taps: Vec<Box<dyn AnyTap>>,
    ledger: Ledger,
    outcome: Outcome,
    /// Verdicts of ticks that are not complete yet: referees may be ahead of each other.
    undecided: Vec<(u64, u32, Verdict)>,
    tick_period_ns: u64,
    beginnings: Arc<Beginnings>,
}

impl Tally {
    /// Subscribes to every topic of a run of these processes and robots, with this much simulated
    /// time between two ticks [ns]; `beginnings` is what other runs know of their maps.
    ///
    /// # Errors
    /// [`RecorderError::Subscribe`].
    pub fn open(
        bus: &Bus,
        processes: &[ProcessInfo],
        robots: &[RobotInfo],
        tick_period_ns: u64,
        beginnings: Arc<Beginnings>,
    ) -> Result<Self, RecorderError> {
        struct Open<'a>(&'a Bus, Vec<Box<dyn AnyTap>>);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                let own = [
                    WorldState::NAME,
                    WorldEvents::NAME,
                    WorldMap::NAME,
                    Coverage::NAME,
                    Verdicts::NAME,
                    Waypoints::NAME,
                    Predictions::NAME,
                    ProcessEvents::NAME,
                ];
                if !own.contains(&T::NAME) {
                    self.1.push(Box::new(Tap::<T>::open(self.0)?));
                }
                Ok(())
            }
        }
        let mut open = Open(bus, Vec::new());
        for_each_topic(&mut open)?;
        Ok(Self {
            states: Tap::open(bus)?,
            events: Tap::open(bus)?,
            maps: Tap::open(bus)?,
            coverage: Tap::open(bus)?,
            verdicts: Tap::open(bus)?,
            waypoints: Tap::open(bus)?,
            predictions: Tap::open(bus)?,
            failures: Tap::open(bus)?,
            taps: open.1,
            ledger: Ledger::new(processes, tick_period_ns),
            outcome: Outcome::new(robots, processes, tick_period_ns),
            undecided: Vec::new(),
            tick_period_ns,
            beginnings,
        })
    }

    /// Connects to all publishers that exist by now (part of the run's handshake).
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn update_connections(&self) -> Result<(), RecorderError> {
        let own: [&dyn AnyTap; 8] = [
            &self.states,
            &self.events,
            &self.maps,
            &self.coverage,
            &self.verdicts,
            &self.waypoints,
            &self.predictions,
            &self.failures,
        ];
        let others = self.taps.iter().map(AsRef::as_ref);
        for tap in own.into_iter().chain(others) {
            tap.connect()?;
        }
        Ok(())
    }

    /// Takes up the messages of a run in lock-step until the gate says that it has ended.
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn run(
        mut self,
        gate: &dyn Gate,
        observer: &mut dyn Observer,
    ) -> Result<Summary, RecorderError> {
        let mut recorded = None;
        loop {
            // What the gate says must be known before the buffers are looked at: then every
            // message that it speaks of is in them.
            let (ended, completed) = (gate.ended(), gate.completed_tick());
            let calls = gate.calls();
            self.take(completed, observer)?;
            gate.answer(calls);
            if ended {
                return Ok(self.finish());
            }
            if let Some(tick) = completed
                && completed > recorded
            {
                gate.recorded(tick);
                recorded = completed;
            }
            gate.wait(NAP);
        }
    }

    /// Takes up everything that came; all messages of the ticks up to `completed` have been sent.
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn take(
        &mut self,
        completed: Option<u64>,
        observer: &mut dyn Observer,
    ) -> Result<(), RecorderError> {
        let Self {
            outcome,
            undecided,
            tick_period_ns,
            ..
        } = self;
        self.states.take(
            &mut self.ledger,
            |header: &WorldHeader, robots: &[RobotState]| {
                outcome.state(header, robots);
                observer.on_state(header, robots);
            },
        )?;
        self.events
            .take(&mut self.ledger, |header, events: &[WorldEvent]| {
                let time_s = seconds(header.stamp.tick.saturating_mul(*tick_period_ns));
                for event in events {
                    outcome.event(time_s, event);
                    observer.on_event(time_s, event);
                }
            })?;
        self.coverage
            .take(&mut self.ledger, |_, reports: &[CoverageState]| {
                for report in reports {
                    outcome.coverage(report);
                }
            })?;
        self.verdicts
            .take(&mut self.ledger, |header, verdicts: &[Verdict]| {
                let of = |verdict: &Verdict| (header.stamp.tick, header.stamp.source, *verdict);
                undecided.extend(verdicts.iter().map(of));
            })?;
        self.waypoints
            .take(&mut self.ledger, |_, ends: &[WaypointEnd]| {
                for end in ends {
                    outcome.waypoint(end);
                }
            })?;
        self.predictions
            .take(&mut self.ledger, |header, predictions: &[Prediction]| {
                let stamp = &header.stamp;
                let time_s = seconds(stamp.tick.saturating_mul(*tick_period_ns));
                for prediction in predictions {
                    outcome.prediction(stamp.source, time_s, prediction);
                }
            })?;
        self.failures
            .take(&mut self.ledger, |_, events: &[ProcessEvent]| {
                for event in events {
                    outcome.process_event(event);
                }
            })?;
        self.decide(completed);
        self.take_maps()?;
        for tap in &self.taps {
            tap.take_any(&mut self.ledger)?;
        }
        Ok(())
    }

    /// Takes up the verdicts of the ticks up to `completed`, by tick and process as a log has them.
    fn decide(&mut self, completed: Option<u64>) {
        if self.undecided.is_empty() {
            return;
        }
        // Stable: those of one message stay in their order.
        self.undecided
            .sort_by_key(|(tick, source, _)| (*tick, *source));
        let is_due = |(tick, ..): &(u64, u32, Verdict)| Some(*tick) <= completed;
        let due = self.undecided.partition_point(is_due);
        for (tick, _, verdict) in self.undecided.drain(..due) {
            let time_s = seconds(tick.saturating_mul(self.tick_period_ns));
            self.outcome.verdict(time_s, &verdict);
        }
    }

    /// Takes up maps, which other runs may know.
    fn take_maps(&mut self) -> Result<(), ReceiveError> {
        let (rank, ledger) = (self.maps.rank, &mut self.ledger);
        while let Some(message) = self.maps.subscriber.receive()? {
            let Some(cells) = message.shared() else {
                self.maps.enter(&message, ledger, |_, _| {});
                continue;
            };
            let stamp = message.header().stamp();
            let head = SequenceHead::of::<WorldMap>(message.elements().len());
            let parts = parts::<WorldMap>(message.header(), &head, message.elements());
            let known = self.beginnings.find(cells, &parts);
            let verdict = ledger.enter_known(rank, stamp, &parts, known.as_deref());
            if known.is_none()
                && verdict.is_some_and(|verdict| verdict.holds)
                && let Some(hasher) = ledger.beginning(rank, stamp.source)
            {
                self.beginnings.keep(cells, &parts, hasher);
            }
        }
        Ok(())
    }

    /// What the run amounted to. There are no latencies, and no log.
    pub fn finish(mut self) -> Summary {
        self.decide(Some(u64::MAX));
        let topics = self
            .ledger
            .counts()
            .filter(|(_, count)| *count != TopicCount::default())
            .map(|(name, count)| (name.to_owned(), count))
            .collect();
        self.outcome.finish(
            self.ledger.digest(),
            topics,
            BTreeMap::new(),
            PathBuf::new(),
            0,
        )
    }
}

impl core::fmt::Debug for Tally {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tally")
            .field("newest", &self.ledger.newest())
            .finish_non_exhaustive()
    }
}

/// One topic.
struct Tap<T: Topic> {
    subscriber: Subscriber<T>,
    rank: usize,
    /// Holds the elements of the message at hand, if others could still write to them.
    copied: Option<RefCell<Vec<T::Element>>>,
}

impl<T: Topic> Tap<T> {
    fn open(bus: &Bus) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.recorder()?,
            rank: topic_info::rank::<T>(),
            copied: (!bus.is_local()).then(RefCell::default),
        })
    }

    /// Enters what came; what holds is shown to `show`.
    fn take(
        &self,
        ledger: &mut Ledger,
        mut show: impl FnMut(&T::Header, &[T::Element]),
    ) -> Result<(), ReceiveError> {
        while let Some(message) = self.subscriber.receive()? {
            self.enter(&message, ledger, &mut show);
        }
        Ok(())
    }

    fn enter(
        &self,
        message: &Received<T>,
        ledger: &mut Ledger,
        show: impl FnOnce(&T::Header, &[T::Element]),
    ) {
        let Some(copied) = &self.copied else {
            self.enter_here(message.header(), message.elements(), ledger, show);
            return;
        };
        let header = *message.header();
        let mut elements = copied.borrow_mut();
        elements.clear();
        elements.extend_from_slice(message.elements());
        self.enter_here(&header, &elements, ledger, show);
    }

    fn enter_here(
        &self,
        header: &T::Header,
        elements: &[T::Element],
        ledger: &mut Ledger,
        show: impl FnOnce(&T::Header, &[T::Element]),
    ) {
        let head = SequenceHead::of::<T>(elements.len());
        let parts = parts::<T>(header, &head, elements);
        let verdict = ledger.enter(self.rank, header.stamp(), &parts);
        if verdict.is_some_and(|verdict| verdict.holds) {
            show(header, elements);
        }
    }
}

/// A message as its bytes.
fn parts<'a, T: Topic>(
    header: &'a T::Header,
    head: &'a SequenceHead,
    elements: &'a [T::Element],
) -> Parts<'a> {
    Parts::new(header.as_bytes(), head, elements.as_bytes(), elements.len())
}

/// A topic of which nothing is shown.
trait AnyTap {
    fn connect(&self) -> Result<(), ReceiveError>;
    fn take_any(&self, ledger: &mut Ledger) -> Result<(), ReceiveError>;
}

impl<T: Topic> AnyTap for Tap<T> {
    fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    fn take_any(&self, ledger: &mut Ledger) -> Result<(), ReceiveError> {
        self.take(ledger, |_, _| {})
    }
}
