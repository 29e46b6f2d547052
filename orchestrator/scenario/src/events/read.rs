//! Reading one `[[events]]` block.

use config::{Code, FieldPath, Node};
use geometry::map::MapSpec;
use geometry::shape::Shape;
use parameters::{Parameters, between};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::moment::{self, MAX_TIME_S, WhenBlock};
use super::{Action, EventSpec, MAX_EVENT_VERTICES};
use crate::context::Context;
use crate::robots::Robot;
use crate::world::shape_problem;

/// One change of an obstacle: it appears, moves or disappears.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EventBlock {
    /// Simulated time of the event, which happens at the first tick at or after it. This or `when`.
    #[serde(default)]
    #[schemars(transform = between(0.0, MAX_TIME_S).unit("s"))]
    time_s: Option<f64>,
    /// Condition of a robot that triggers the event.
    #[serde(default)]
    when: Option<WhenBlock>,
    /// With `when`: simulated time from the condition to the event; 0 if absent.
    #[serde(default)]
    #[schemars(transform = between(0.0, MAX_TIME_S).unit("s"))]
    after_s: Option<f64>,
    /// Change of the obstacle.
    action: Action,
    /// Name of the obstacle: one of the map's, or one that appears.
    obstacle: String,
    /// Its shape and place, as in maps; a polygon has at most 16 corners. Not for `"disappear"`.
    // It is checked with what holds between its corners.
    #[serde(default, skip_serializing)]
    shape: Option<Shape>,
}

impl Parameters for EventBlock {}

/// Reads one event and reports everything wrong with it.
pub(super) fn event(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    map: Option<&MapSpec>,
    robots: Option<&[Robot]>,
) -> Option<EventSpec> {
    let block: EventBlock = ctx.read(node, path)?;
    let mut fine = ctx.check(node, path, &block);
    let EventBlock {
        time_s,
        when,
        after_s,
        action,
        obstacle,
        shape,
    } = block;
    let moment = moment::resolve(ctx, node, path, (time_s, when, after_s), map, robots);
    let mut report = |ctx: &mut Context<'_>, field: &str, code, message: &str, expected: &str| {
        ctx.problems.push(
            ctx.problem(node, path, field, code, message)
                .expected(expected),
        );
        fine = false;
    };
    if obstacle.is_empty() {
        report(
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
            report(ctx, "shape", Code::Requirement, message, "no `shape`");
        }
        (Action::Appear | Action::Move, None) => {
            let expected =
                "shape = { circle = { … } }, { rectangle = { … } } or { polygon = { … } }";
            report(
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
            report(
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
    let moment = moment.filter(|_| fine)?;
    Some(EventSpec {
        moment,
        action,
        obstacle,
        id: 0,
        in_turn: false,
        shape,
    })
}
