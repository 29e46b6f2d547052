//! Events of a run, and waypoints that ended.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::{RobotEvents, TopicId, Waypoints, WorldEvents};

use crate::run_model::LoggedRun;
use scenario::spec::MAX_ROBOTS;

/// Maximum number of events on the page: of important ones, and of frequent ones.
const EVENTS: usize = 5000;
/// Maximum number of waypoints on the page.
const WAYPOINTS: usize = 20_000;
/// Kinds of events that may be very frequent.
const FREQUENT: [&str; 4] = [
    "contact_begin",
    "contact_end",
    "invalid_command",
    "missing_command",
];

/// Events and waypoints in order, up to the maximum numbers.
#[derive(Debug, Clone, Default)]
pub struct EventLists {
    /// Events, by time (ns).
    pub(super) events: Vec<(u64, WorldEvent)>,
    frequent: usize,
    /// Events that did not fit.
    pub(super) events_omitted: u64,
    /// Waypoints that ended, by time (ns).
    pub(super) waypoints: Vec<(u64, WaypointEnd)>,
    /// Waypoints that did not fit.
    pub(super) waypoints_omitted: u64,
}

impl Consumer<LoggedRun> for EventLists {
    fn topics(&self) -> &[TopicId] {
        &[
            TopicId::WorldEvents,
            TopicId::RobotEvents,
            TopicId::Waypoints,
        ]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if let Some((_, events)) = run.decode::<WorldEvents>(message) {
            for event in &events {
                self.event(message.time_ns, event);
            }
        }
        if let Some((_, events)) = run.decode::<RobotEvents>(message) {
            let own = events
                .iter()
                .filter(|event| event.kind >= WorldEvent::SIGHTED);
            own.for_each(|event| self.event(message.time_ns, event));
        }
        if let Some((_, ends)) = run.decode::<Waypoints>(message) {
            let known = ends
                .into_iter()
                .filter(|end| (end.robot as usize) < MAX_ROBOTS);
            known.for_each(|end| self.waypoint(message.time_ns, end));
        }
    }
}

impl EventLists {
    fn event(&mut self, time_ns: u64, event: &WorldEvent) {
        let is_frequent = FREQUENT.contains(&WorldEvent::name_of(event.kind));
        let others = self.events.len() - self.frequent;
        if is_frequent && self.frequent >= EVENTS || !is_frequent && others >= EVENTS {
            self.events_omitted += 1;
            return;
        }
        self.frequent += usize::from(is_frequent);
        self.events.push((time_ns, *event));
    }

    fn waypoint(&mut self, time_ns: u64, end: WaypointEnd) {
        if self.waypoints.len() < WAYPOINTS {
            self.waypoints.push((time_ns, end));
        } else {
            self.waypoints_omitted += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequent_events_do_not_displace_important_ones() {
        let mut event_lists = EventLists::default();
        let event = |kind| WorldEvent {
            kind,
            ..WorldEvent::default()
        };
        for i in 0..6000 {
            event_lists.event(i, &event(4));
        }
        event_lists.event(6000, &event(0));
        assert_eq!(event_lists.events.len(), EVENTS + 1);
        assert_eq!(event_lists.events_omitted, 1000);
        assert_eq!(event_lists.events.last().unwrap().1.kind, 0);
    }
}
