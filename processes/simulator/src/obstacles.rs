//! Which change of the obstacles comes at which tick.

use geometry::map::ObstacleChange;
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::ObstacleEvents;
use runtime::{ProcessError, obstacle};
use sim_backend::world::World;

use crate::event_schedule::{EventSchedule, PlannedChange};

/// The changes that are still to come: those announced for a tick, and those on the event schedule.
pub(crate) struct Obstacles {
    /// Changes by message, with their tick.
    announced: Vec<(u64, ObstacleEvent)>,
    event_schedule: EventSchedule,
    /// Index of this process.
    index: u32,
    inbox: Subscriber<ObstacleEvents>,
    /// Where changes from the event schedule are told when they happen; none if there is no event schedule.
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

    /// Applies what comes at the stamp's tick: first what was announced for it, then what the
    /// event schedule has for the robots as they stand then. `applied` gets every change that the world
    /// took.
    pub(crate) fn apply(
        &mut self,
        world: &mut World,
        stamp: Stamp,
        mut applied: impl FnMut(ObstacleChange),
    ) -> Result<(), ProcessError> {
        let tick = stamp.tick;
        while let Some(message) = self.inbox.receive()? {
            let header = message.header().stamp;
            // What was told from here has happened already.
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

/// Whether the world took a change; if not, that is logged.
fn take(world: &mut World, tick: u64, change: &ObstacleChange) -> bool {
    let taken = world.apply(change);
    if let Err(e) = &taken {
        refuse(tick, &e.to_string());
    }
    taken.is_ok()
}

fn refuse(tick: u64, reason: &str) {
    tracing::warn!("tick {tick}: obstacle event refused: {reason}");
}

fn held(planned: &PlannedChange) -> String {
    let does = match planned.change {
        ObstacleChange::Appear { .. } => "appear",
        ObstacleChange::Disappear { .. } => "disappear",
        ObstacleChange::Move { .. } => "move",
    };
    format!(
        "obstacle `{}` is to {does}, but an event before that has not happened yet: it waits",
        planned.obstacle
    )
}
