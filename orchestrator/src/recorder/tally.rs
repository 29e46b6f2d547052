//! What a run amounts to, without a log: for runs of which there are many.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use ipc_types::bus::{Bus, BusError, ReceiveError, Received, Subscriber};
use ipc_types::cdr::SequenceHead;
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::world::{CoverageState, RobotState, WorldEvent, WorldHeader};
use ipc_types::stamp::Header as _;
use ipc_types::topics::{
    Coverage, Topic, TopicVisitor, Verdicts, WorldEvents, WorldMap, WorldState, for_each_topic,
};
use zerocopy::IntoBytes as _;

use super::beginnings::Beginnings;
use super::error::RecorderError;
use super::gate::Observer;
use super::ledger::Ledger;
use super::options::{ProcessInfo, RobotInfo};
use super::parts::Parts;
use super::summary::{Outcome, Summary, TopicCount, seconds};
use super::topic_info;

/// Checks, counts and fingerprints the messages of a run as a [`Recording`](super::Recording) does,
/// and comes to the same summary, but keeps nothing. Messages are looked at where they lie.
pub struct Tally {
    states: Tap<WorldState>,
    events: Tap<WorldEvents>,
    maps: Tap<WorldMap>,
    coverage: Tap<Coverage>,
    verdicts: Tap<Verdicts>,
    /// All other topics.
    taps: Vec<Box<dyn AnyTap>>,
    ledger: Ledger,
    outcome: Outcome,
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
            taps: open.1,
            ledger: Ledger::new(processes, tick_period_ns),
            outcome: Outcome::new(robots, tick_period_ns),
            tick_period_ns,
            beginnings,
        })
    }

    /// Takes up everything that came.
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn take(&mut self, observer: &mut dyn Observer) -> Result<(), RecorderError> {
        let Self {
            outcome,
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
                let time_s = seconds(header.stamp.tick.saturating_mul(*tick_period_ns));
                for verdict in verdicts {
                    outcome.verdict(time_s, verdict);
                }
            })?;
        self.take_maps()?;
        for tap in &self.taps {
            tap.take_any(&mut self.ledger)?;
        }
        Ok(())
    }

    /// Takes up maps, which other runs may know.
    fn take_maps(&mut self) -> Result<(), ReceiveError> {
        let (rank, ledger) = (self.maps.rank, &mut self.ledger);
        while let Some(message) = self.maps.subscriber.receive()? {
            let stamp = message.header().stamp();
            let head = SequenceHead::of::<WorldMap>(message.elements().len());
            let parts = parts::<WorldMap>(&message, &head);
            let Some(cells) = message.shared() else {
                ledger.enter(rank, stamp, &parts);
                continue;
            };
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
}

impl<T: Topic> Tap<T> {
    fn open(bus: &Bus) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.recorder()?,
            rank: topic_info::rank::<T>(),
        })
    }

    /// Enters what came; what holds is shown to `show`.
    fn take(
        &self,
        ledger: &mut Ledger,
        mut show: impl FnMut(&T::Header, &[T::Element]),
    ) -> Result<(), ReceiveError> {
        while let Some(message) = self.subscriber.receive()? {
            let (header, elements) = (message.header(), message.elements());
            let head = SequenceHead::of::<T>(elements.len());
            let parts = parts::<T>(&message, &head);
            let verdict = ledger.enter(self.rank, header.stamp(), &parts);
            if verdict.is_some_and(|verdict| verdict.holds) {
                show(header, elements);
            }
        }
        Ok(())
    }
}

/// A message as its bytes.
fn parts<'a, T: Topic>(message: &'a Received<T>, head: &'a SequenceHead) -> Parts<'a> {
    let elements = message.elements();
    let header = message.header().as_bytes();
    Parts::new(header, head, elements.as_bytes(), elements.len())
}

/// A topic of which nothing is shown.
trait AnyTap {
    fn take_any(&self, ledger: &mut Ledger) -> Result<(), ReceiveError>;
}

impl<T: Topic> AnyTap for Tap<T> {
    fn take_any(&self, ledger: &mut Ledger) -> Result<(), ReceiveError> {
        self.take(ledger, |_, _| {})
    }
}
