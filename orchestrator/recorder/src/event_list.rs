//! Events of the world and of robots over a run.

use ipc_types::consumer::{Consumer, EVENTS, LoggedMessage};
use ipc_types::event_names::EventNames;
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::TopicId;

use super::run_info::RunInfo;
use super::summary::{EventEntry, OutcomePart, Summary};

/// Maximum number of events in a summary; the log contains all.
const MAX_EVENTS: usize = 100_000;

/// The events so far.
#[derive(Debug)]
pub(super) struct EventList {
    names: EventNames,
    events: Vec<EventEntry>,
    omitted: u64,
    /// Number of standstills, by robot.
    standstills: Vec<u32>,
}

impl EventList {
    /// Creates the list of a run.
    pub(super) fn new(run: &RunInfo) -> Self {
        Self {
            names: run.event_names(),
            events: Vec::new(),
            omitted: 0,
            standstills: vec![0; run.robots.len()],
        }
    }

    fn add(&mut self, time_s: f64, event: &WorldEvent) {
        let kind = WorldEvent::name_of(event.kind);
        if kind == "stands"
            && let Some(standstills) = self.standstills.get_mut(event.robot as usize)
        {
            *standstills += 1;
        }
        if self.events.len() >= MAX_EVENTS {
            self.omitted += 1;
            return;
        }
        self.events
            .push(EventEntry::new(time_s, event, &self.names));
    }
}

impl Consumer for EventList {
    fn topics(&self) -> &[TopicId] {
        &EVENTS
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        for event in message.events() {
            self.add(message.time_s(), &event);
        }
    }
}

impl OutcomePart for EventList {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        for (robot, standstills) in summary.robots.iter_mut().zip(self.standstills) {
            robot.standstills = standstills;
        }
        summary.events = self.events;
        summary.events_omitted = self.omitted;
    }
}
