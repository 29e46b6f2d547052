//! The steps of the processes under test, tick by tick, and the messages that they send.

use std::time::Instant;

use diff::Message;
use ipc_types::bus::Bus;
use ipc_types::messages::world::WorldHeader;
use ipc_types::topics::{Control, NAMES, Topic as _, TopicId, WorldMap, WorldShapes, WorldState};
use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use mcap_log::known::ENCAPSULATION;
use mcap_log::source::{LogMessage, Source};
use zerocopy::FromBytes as _;

use super::super::publishers::TopicPublishers;
use super::VerificationReport;
use super::capture::OutputCapture;
use super::processes::ProcessesUnderTest;
use super::test_selection::TestSelection;
use crate::ReplayError;
use mission::MissionError;
use mission::plan::Plan;

/// The messages of one tick.
struct Moment {
    tick: u64,
    time: u64,
    messages: Vec<LogMessage>,
}

impl Moment {
    /// Returns the state of the world, if the messages contain it.
    fn state(&self) -> Option<WorldHeader> {
        let state = self
            .messages
            .iter()
            .find(|m| NAMES.get(m.rank) == Some(&WorldState::NAME))?;
        let (header, _) = WorldHeader::read_from_prefix(state.data.get(ENCAPSULATION..)?).ok()?;
        Some(header)
    }
}

/// The bus of a test, with publishers for every process that is not under test.
pub(super) struct TestBus<'a> {
    bus: &'a Bus,
    test_selection: &'a TestSelection,
    publishers: TopicPublishers,
    capture: OutputCapture,
    period_ns: u64,
}

impl<'a> TestBus<'a> {
    /// Opens the publishers of all processes that are not under test, and the subscribers to those under test.
    pub(super) fn open(
        bus: &'a Bus,
        plan: &Plan,
        test_selection: &'a TestSelection,
        source: &mut Source,
        watch: &mut ReadProgress,
    ) -> Result<Self, ReplayError> {
        let mut test_bus = Self {
            bus,
            test_selection,
            publishers: TopicPublishers::new(),
            capture: OutputCapture::open(bus).map_err(MissionError::from)?,
            period_ns: plan.run.tick_period_ns.max(1),
        };
        source.visit_senders(watch, &mut |rank, sender| {
            test_bus.open_port(rank, sender).map(drop)
        })?;
        source.seek(0, watch)?;
        Ok(test_bus)
    }

    /// Opens the port that a sender needs. Returns `false` if its messages are not sent.
    fn open_port(&mut self, rank: usize, sender: u32) -> Result<bool, ReplayError> {
        if self.test_selection.is_silent(sender) || NAMES.get(rank) == Some(&Control::NAME) {
            return Ok(false);
        }
        self.publishers.open(self.bus, rank, sender)?;
        Ok(true)
    }

    fn send(&mut self, message: &LogMessage) -> Result<(), ReplayError> {
        if !self.open_port(message.rank, message.sender())? {
            return Ok(());
        }
        // An invalid message had no effect in the run either.
        self.publishers.publish(message)?;
        Ok(())
    }

    /// Returns all messages of the next tick.
    fn next(&self, source: &mut Source) -> Result<Option<Moment>, ReplayError> {
        let mut messages = Vec::new();
        source.tick(&mut messages)?;
        Ok(messages.first().map(|first| first.time).map(|time| Moment {
            tick: time / self.period_ns,
            time,
            messages,
        }))
    }

    pub(super) fn run(
        &mut self,
        processes: &mut dyn ProcessesUnderTest,
        source: &mut Source,
        watch: &ReadProgress,
        done: &mut VerificationReport,
    ) -> Result<(), ReplayError> {
        self.publishers.connect().map_err(MissionError::from)?;
        processes.connect()?;
        self.publishers.connect().map_err(MissionError::from)?;
        self.capture.connect().map_err(MissionError::from)?;
        let mut moment = self.next(source)?;
        // All processes build their data of the map before the first tick.
        if let Some(first) = &mut moment {
            for name in [WorldMap::NAME, WorldShapes::NAME] {
                let mut messages = first.messages.iter();
                if let Some(at) = messages.position(|m| NAMES.get(m.rank) == Some(&name)) {
                    let message = first.messages.remove(at);
                    self.send(&message)?;
                }
            }
        }
        processes.prepare()?;
        let start = Instant::now();
        let mut over = false;
        while let Some(now) = moment {
            if watch.interrupted.load(std::sync::atomic::Ordering::Relaxed) {
                return Err(LogReadError::Interrupted.into());
            }
            let state = now.state().filter(|state| state.stamp.tick == done.ticks);
            let Some(state) = state.filter(|_| now.tick == done.ticks) else {
                return Err(LogReadError::NotRepeatable {
                    path: source.path().to_owned(),
                    reason: format!(
                        "it does not contain the state of the world at tick {}: a log that was cut or \
                         damaged is unsuitable for a test",
                        done.ticks
                    ),
                }
                .into());
            };
            over = state.phase == WorldHeader::OVER;
            moment = self.next(source)?;
            for message in &now.messages {
                let sender = message.sender();
                if self.test_selection.before.contains(&sender) {
                    self.send(message)?;
                }
            }
            if !over {
                processes.turn(now.tick)?;
            }
            done.ticks += 1;
            // The last tick of a log that was cut may be incomplete.
            let senders = &self.test_selection.senders;
            let captured = self.capture.take(senders).map_err(MissionError::from)?;
            let logged: Vec<Message> = now
                .messages
                .iter()
                .filter(|message| senders.contains(&message.sender()))
                .filter_map(|message| {
                    let topic = TopicId::all().nth(message.rank)?;
                    Message::from_cdr(topic, message.data.clone())
                })
                .collect();
            let may_lack = [moment.is_none() && !over, false];
            done.comparison.add(now.time, &logged, &captured, may_lack);
            for message in &now.messages {
                let sender = message.sender();
                if !self.test_selection.before.contains(&sender) {
                    self.send(message)?;
                }
            }
        }
        done.whole = over || source.has_index();
        done.wall_time_s = start.elapsed().as_secs_f64();
        Ok(())
    }
}
