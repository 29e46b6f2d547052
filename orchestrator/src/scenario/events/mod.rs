//! `[[events]]`: obstacles that appear, disappear and move while the game runs.

use serde::{Deserialize, Serialize};
use sim_backend::map::{MapSpec, ObstacleChange, ObstacleId};
use sim_backend::shape::Shape;

use super::context::Context;
use super::spec::MAX_EVENTS;
use super::text::{Code, Diagnostic, FieldPath, Node, list_choices, nearest};
use super::world::shape_problem;

/// Most corners of a polygon that appears during a run (its message has a fixed size).
pub const MAX_EVENT_VERTICES: usize = 16;

/// What happens to the obstacle of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// It comes to be.
    Appear,
    /// It ceases to be.
    Disappear,
    /// It takes another place or shape.
    Move,
}

/// One change of the obstacles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventSpec {
    /// Simulated time [s], ≥ 0.
    pub time_s: f64,
    /// What happens.
    pub action: Action,
    /// Name of the obstacle: one of the map's, or one that appears.
    pub obstacle: String,
    /// Its number: the map's obstacles have theirs, those that appear get the next ones in the
    /// order of their first appearance.
    #[serde(skip)]
    pub id: u32,
    /// Its new shape and place; absent if it disappears.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
}

impl EventSpec {
    /// The change as the world takes it; `None` if the shape is missing that the action needs
    /// (no event of a resolved scenario).
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EventBlock {
    time_s: f64,
    action: Action,
    obstacle: String,
    #[serde(default)]
    shape: Option<Shape>,
}

/// Reads all events and checks them against the map's obstacles and each other; everything wrong is
/// reported (of the order of events nothing, if there is no map).
pub fn resolve(ctx: &mut Context<'_>, map: Option<&MapSpec>) -> Vec<EventSpec> {
    let blocks = ctx.blocks("events");
    if let Some((path, node)) = blocks.get(MAX_EVENTS) {
        let problem = ctx
            .block_problem(node.origin, path, Code::Limit, "too many events")
            .value(blocks.len())
            .expected(format!("at most {MAX_EVENTS} events"));
        ctx.problems.push(problem);
        return Vec::new();
    }
    let mut read: Vec<(EventSpec, FieldPath, Node)> = Vec::with_capacity(blocks.len());
    for (path, node) in blocks {
        if let Some(event) = read_event(ctx, &node, &path) {
            read.push((event, path, node));
        }
    }
    // Without the map nobody knows what stands; its own problems are reported.
    let Some(map) = map else { return Vec::new() };
    // Stable: events of one time happen in the order of the file.
    read.sort_by(|a, b| a.0.time_s.total_cmp(&b.0.time_s));
    let mut history = History::new(map);
    let mut events = Vec::with_capacity(read.len());
    for (mut event, path, node) in read {
        match history.apply(&event) {
            Ok(id) => {
                event.id = id;
                events.push(event);
            }
            Err(found) => {
                let blank = ctx.problem(&node, &path, "obstacle", found.code, found.message);
                let problem = Diagnostic {
                    expected: found.expected,
                    help: found.help,
                    ..blank
                };
                ctx.problems.push(problem);
            }
        }
    }
    events
}

fn read_event(ctx: &mut Context<'_>, node: &Node, path: &FieldPath) -> Option<EventSpec> {
    let EventBlock {
        time_s,
        action,
        obstacle,
        shape,
    } = ctx.read(node, path)?;
    let mut fine = true;
    let mut complain = |ctx: &mut Context<'_>, field: &str, code, message: &str, expected: &str| {
        let problem = ctx
            .problem(node, path, field, code, message)
            .expected(expected);
        ctx.problems.push(problem);
        fine = false;
    };
    if !(0.0..=1e9).contains(&time_s) {
        let expected = "a simulated time from 0 to 1e9 [s]";
        complain(
            ctx,
            "time_s",
            Code::OutOfRange,
            "`time_s` is out of range",
            expected,
        );
    }
    if obstacle.is_empty() {
        complain(
            ctx,
            "obstacle",
            Code::OutOfRange,
            "the obstacle has no name",
            "a name",
        );
    }
    match (action, &shape) {
        (Action::Disappear, Some(_)) => {
            let message = "an obstacle that disappears has no shape";
            complain(ctx, "shape", Code::Requirement, message, "no `shape`");
        }
        (Action::Appear | Action::Move, None) => {
            let expected =
                "shape = { circle = { … } }, { rectangle = { … } } or { polygon = { … } }";
            complain(
                ctx,
                "shape",
                Code::MissingKey,
                "missing key `shape`",
                expected,
            );
        }
        (_, Some(Shape::Polygon { vertices })) if vertices.len() > MAX_EVENT_VERTICES => {
            let expected = format!("at most {MAX_EVENT_VERTICES} vertices");
            let message = "too many vertices for an obstacle of an event";
            complain(
                ctx,
                "shape.polygon.vertices",
                Code::Limit,
                message,
                &expected,
            );
        }
        _ => {}
    }
    if let Some(Err(e)) = shape.as_ref().map(Shape::parts) {
        let mut found = shape_problem(e);
        found.field = format!("shape.{}", found.field);
        ctx.refuse(node, path, found);
        fine = false;
    }
    fine.then_some(EventSpec {
        time_s,
        action,
        obstacle,
        id: 0,
        shape,
    })
}

/// Which obstacles stand, as the events go by.
struct History {
    /// Name, number, and whether it stands.
    known: Vec<(String, u32, bool)>,
    next: u32,
}

struct Impossible {
    code: Code,
    message: String,
    expected: Option<String>,
    help: Option<String>,
}

impl History {
    fn new(map: &MapSpec) -> Self {
        let obstacles = match map {
            MapSpec::Vector(map) => map.obstacles.as_slice(),
            _ => &[],
        };
        let known = obstacles
            .iter()
            .enumerate()
            .filter(|(_, o)| !o.name.is_empty())
            .map(|(i, o)| (o.name.clone(), i as u32, true))
            .collect();
        Self {
            known,
            next: obstacles.len() as u32,
        }
    }

    fn apply(&mut self, event: &EventSpec) -> Result<u32, Impossible> {
        let name = &event.obstacle;
        let time = event.time_s;
        let found = self.known.iter_mut().find(|k| k.0 == *name);
        match (event.action, found) {
            (Action::Appear, Some((_, id, stands @ false))) => {
                *stands = true;
                Ok(*id)
            }
            (Action::Appear, Some(_)) => Err(Impossible {
                code: Code::Duplicate,
                message: format!("obstacle `{name}` appears at {time} s, but it stands already"),
                expected: Some("the name of an obstacle that does not stand at that time".into()),
                help: None,
            }),
            (Action::Appear, None) => {
                let id = self.next;
                self.next += 1;
                self.known.push((name.clone(), id, true));
                Ok(id)
            }
            (Action::Disappear, Some((_, id, stands @ true))) => {
                *stands = false;
                Ok(*id)
            }
            (Action::Move, Some((_, id, true))) => Ok(*id),
            (Action::Disappear | Action::Move, _) => {
                let standing: Vec<&str> = self
                    .known
                    .iter()
                    .filter(|k| k.2)
                    .map(|k| k.0.as_str())
                    .collect();
                Err(Impossible {
                    code: Code::UnknownName,
                    message: format!("no obstacle `{name}` stands at {time} s"),
                    expected: Some(list_choices(&standing)),
                    help: nearest(name, standing.iter().copied())
                        .map(|near| format!("did you mean `{near}`?")),
                })
            }
        }
    }
}
