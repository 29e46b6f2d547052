//! Events of the world over a run.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::{TopicId, WorldEvents};

use super::run_info::RobotInfo;
use super::summary::{EventEntry, OutcomePart, Summary};

/// Maximum number of events in a summary; the log contains all.
const MAX_EVENTS: usize = 100_000;

/// The events so far.
#[derive(Debug)]
pub(super) struct EventList {
    robots: Vec<String>,
    events: Vec<EventEntry>,
    omitted: u64,
    /// Number of standstills, by robot.
    standstills: Vec<u32>,
}

impl EventList {
    /// Creates the list for a run with these robots.
    pub(super) fn new(robots: &[RobotInfo]) -> Self {
        Self {
            robots: robots.iter().map(|robot| robot.name.clone()).collect(),
            events: Vec::new(),
            omitted: 0,
            standstills: vec![0; robots.len()],
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
        self.events.push(EventEntry {
            time_s,
            kind: kind.to_owned(),
            robot: self.robots.get(event.robot as usize).cloned(),
            other: (event.other != WorldEvent::NONE).then_some(event.other),
            x: event.x,
            y: event.y,
            value: event.value,
        });
    }
}

impl Consumer for EventList {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldEvents]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, events)) = message.view::<WorldEvents>() {
            events.for_each(|event| self.add(message.time_s(), &event));
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
