//! Changes of the obstacles, by tick.

use geometry::map::ObstacleChange;
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::ObstacleEvents;
use runtime::{ProcessError, obstacle};
use sim_backend::world::World;

use crate::event_schedule::{EventSchedule, PlannedChange};

/// Future changes: those announced for a tick, and those of the event schedule.
pub struct Obstacles {
    /// Changes by message, with their tick.
    announced: Vec<(u64, ObstacleEvent)>,
    event_schedule: EventSchedule,
    /// Index of this process.
    index: u32,
    inbox: Subscriber<ObstacleEvents>,
    /// Publisher of changes from the event schedule; none if there is no event schedule.
    outbox: Option<Publisher<ObstacleEvents>>,
}

impl Obstacles {
    pub(crate) fn open(
        bus: &Bus,
        index: u32,
        event_schedule: EventSchedule,
    ) -> Result<Self, ProcessError> {
        let outbox = (!event_schedule.is_empty())
            .then(|| bus.publisher(PublisherOptions::new(index, 1)))
            .transpose()?;
        Ok(Self {
            announced: Vec::new(),
            event_schedule,
            index,
            inbox: bus.subscriber()?,
            outbox,
        })
    }

    pub(crate) fn connect(&mut self) -> Result<(), ProcessError> {
        if let Some(outbox) = &self.outbox {
            outbox.update_connections()?;
        }
        Ok(self.inbox.update_connections()?)
    }

    /// Applies the changes of the stamp's tick: first the announced ones, then those of the event
    /// schedule for the robots' state after that. `applied` receives every accepted change.
    pub(crate) fn apply(
        &mut self,
        world: &mut World,
        stamp: Stamp,
        mut applied: impl FnMut(ObstacleChange),
    ) -> Result<(), ProcessError> {
        let tick = stamp.tick;
        while let Some(message) = self.inbox.receive()? {
            let header = message.header().stamp;
            // A change from this process has happened already.
            if header.source != self.index {
                let events = message.elements().iter();
                self.announced
                    .extend(events.map(|event| (header.tick, *event)));
            }
        }
        while let Some(at) = self.announced.iter().position(|(due, _)| *due <= tick) {
            let (_, event) = self.announced.remove(at);
            match obstacle::from_message(&event) {
                Ok(change) => {
                    if take(world, tick, &change) {
                        applied(change);
                    }
                }
                Err(e) => refuse(tick, &e.to_string()),
            }
        }
        if self.event_schedule.is_empty() {
            return Ok(());
        }
        self.event_schedule.observe(tick, world.robots());
        while let Some(planned) = self.event_schedule.take(tick) {
            let change = &planned.change;
            let event = match obstacle::to_message(change) {
                Ok(event) => event,
                Err(e) => {
                    refuse(tick, &e.to_string());
                    continue;
                }
            };
            if take(world, tick, change) {
                applied(change.clone());
                if let Some(outbox) = &self.outbox {
                    outbox.send(PlainHeader { stamp }, &[event])?;
                }
            }
        }
        for planned in self.event_schedule.newly_held(tick) {
            tracing::warn!("tick {tick}: {}", held(planned));
        }
        Ok(())
    }
}

/// Returns `true` if the world accepted a change; logs a rejection.
fn take(world: &mut World, tick: u64, change: &ObstacleChange) -> bool {
    let taken = world.apply(change);
    if let Err(e) = &taken {
        refuse(tick, &e.to_string());
    }
    taken.is_ok()
}

fn refuse(tick: u64, reason: &str) {
    tracing::warn!("tick {tick}: obstacle event rejected: {reason}");
}

fn held(planned: &PlannedChange) -> String {
    let does = match planned.change {
        ObstacleChange::Appear { .. } => "appear",
        ObstacleChange::Disappear { .. } => "disappear",
        ObstacleChange::Move { .. } => "move",
    };
    format!(
        "obstacle `{}` waits to {does}: an earlier event has not happened yet",
        planned.obstacle
    )
}
