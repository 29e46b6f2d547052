//! `[[events]]`: obstacles that appear, disappear and move during a run.

mod history;
mod moment;
mod read;

pub(super) use moment::WhenBlock;
pub use moment::{Moment, Trigger};
pub(super) use read::EventBlock;

use std::collections::BTreeSet;

use config::{Code, Diagnostic, FieldPath, Node};
use geometry::map::{MapSpec, ObstacleChange, ObstacleId};
use geometry::shape::Shape;
use history::History;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::context::Context;
use super::robots::Robot;
use super::spec::MAX_EVENTS;

/// Maximum number of corners of a polygon of an event (its message has a fixed size).
pub const MAX_EVENT_VERTICES: usize = 16;

/// Change of the obstacle of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// The obstacle is added.
    Appear,
    /// The obstacle is removed.
    Disappear,
    /// The obstacle gets another place or shape.
    Move,
}

/// One change of the obstacles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventSpec {
    /// Time or condition of the event.
    #[serde(flatten)]
    pub moment: Moment,
    /// Change of the obstacle.
    pub action: Action,
    /// Name of the obstacle: one of the map's, or one that appears.
    pub obstacle: String,
    /// Id of the obstacle. Obstacles of the map keep theirs; those that appear get the next ids in the
    /// order of their first appearance.
    #[serde(skip)]
    pub id: u32,
    /// `true` if an event of the same obstacle waits for a robot. The times of the obstacle's changes are
    /// then unknown in advance; only their order is known.
    #[serde(skip)]
    pub in_turn: bool,
    /// Its new shape and place; absent if it disappears.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
}

impl EventSpec {
    /// Returns the shapes that obstacles take, with the ids of the obstacles.
    pub fn shapes(events: &[Self]) -> impl Iterator<Item = (u32, &Shape)> {
        events
            .iter()
            .filter_map(|event| Some((event.id, event.shape.as_ref()?)))
    }

    /// Returns the change for the world; `None` if the shape that the action needs is missing (never in a
    /// resolved scenario).
    pub fn change(&self) -> Option<ObstacleChange> {
        let id = ObstacleId(self.id);
        Some(match self.action {
            Action::Appear => ObstacleChange::Appear {
                id,
                shape: self.shape.clone()?,
            },
            Action::Disappear => ObstacleChange::Disappear { id },
            Action::Move => ObstacleChange::Move {
                id,
                shape: self.shape.clone()?,
            },
        })
    }
}

/// Reads all events, checks them against the robots, the map's obstacles and each other, and reports
/// all problems. Without a map, the order of events is not checked.
///
/// Sorts obstacles whose events all have a time first, by time; then obstacles with an event that waits
/// for a robot, in the order of the file.
pub fn resolve(
    ctx: &mut Context<'_>,
    map: Option<&MapSpec>,
    robots: Option<&[Robot]>,
) -> Vec<EventSpec> {
    let blocks = ctx.blocks("events");
    if let Some((path, node)) = blocks.get(MAX_EVENTS) {
        ctx.problems.push(
            ctx.block_problem(node.origin, path, Code::Limit, "too many events")
                .value(blocks.len())
                .expected(format!("at most {MAX_EVENTS} events")),
        );
        return Vec::new();
    }
    let mut read: Vec<(EventSpec, FieldPath, Node)> = Vec::with_capacity(blocks.len());
    // The changes of these obstacles are unknown.
    let mut unread: BTreeSet<String> = BTreeSet::new();
    for (path, node) in blocks {
        if let Some(event) = read::event(ctx, &node, &path, map, robots) {
            read.push((event, path, node));
        } else if let Some(name) = node.get("obstacle").and_then(Node::as_str) {
            unread.insert(name.to_owned());
        }
    }
    // Without the map, the obstacles are unknown; the problems of the map are reported already.
    let Some(map) = map else { return Vec::new() };
    let waiting: BTreeSet<String> = read
        .iter()
        .filter(|(event, ..)| matches!(event.moment, Moment::When { .. }))
        .map(|(event, ..)| event.obstacle.clone())
        .collect();
    for (event, ..) in &mut read {
        event.in_turn = waiting.contains(&event.obstacle);
    }
    let key = |event: &EventSpec| match event.moment {
        Moment::At { time_s } if !event.in_turn => (false, time_s),
        _ => (true, 0.0),
    };
    // A stable sort keeps events of the same time in the order of the file.
    read.sort_by(|(a, ..), (b, ..)| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut history = History::new(map);
    let mut events = Vec::with_capacity(read.len());
    for (mut event, path, node) in read {
        match history.apply(&event) {
            Ok(id) => {
                event.id = id;
                events.push(event);
            }
            Err(_) if unread.contains(&event.obstacle) => {}
            Err(found) => {
                let blank = ctx.problem(&node, &path, found.field, found.code, found.message);
                ctx.problems.push(Diagnostic {
                    expected: found.expected,
                    help: found.help,
                    ..blank
                });
            }
        }
    }
    events
}
