//! Time of an event: a fixed time, or the time at which a robot meets a condition.

use config::{Code, FieldPath, Node, list_choices, nearest};
use geometry::extent::MAX_COORDINATE;
use geometry::map::MapSpec;
use geometry::math;
use parameters::{above, at_least, between, each};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sim_backend::spec::Condition;

use crate::context::Context;
use crate::robots::Robot;

/// Maximum time and delay (s).
pub(super) const MAX_TIME_S: f64 = 1e9;

/// Time or condition of an event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Moment {
    /// At a fixed time.
    At {
        /// Simulated time (s), ≥ 0.
        time_s: f64,
    },
    /// Relative to the time at which a robot meets a condition.
    When {
        /// The robot and its condition.
        when: Trigger,
        /// Simulated time between the condition and the event (s), ≥ 0.
        #[serde(default)]
        after_s: f64,
    },
}

/// Condition that an event waits for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trigger {
    /// Name of the robot.
    pub robot: String,
    /// Index of the robot.
    #[serde(skip)]
    pub index: usize,
    /// Condition that the robot must meet.
    #[serde(flatten)]
    pub condition: Condition,
}

/// Condition of an event, about one robot: one of `travelled`, `progress` and `within`.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WhenBlock {
    /// Name of the robot.
    robot: String,
    /// Distance that its centre has travelled, as `distance` in `world/state` counts it.
    #[serde(default)]
    #[schemars(transform = at_least(0).at_most(MAX_COORDINATE).unit("m"))]
    travelled: Option<f64>,
    /// Share of the straight distance from its start to the centre of its goal that it has covered. Only
    /// for a robot with a `goal`.
    #[serde(default)]
    #[schemars(transform = between(0, 1))]
    progress: Option<f64>,
    /// Maximum distance of its centre from the point `of`; some place of the map must be as near.
    #[serde(default)]
    #[schemars(transform = above(0).at_most(MAX_COORDINATE).unit("m"))]
    within: Option<f64>,
    /// The point, x and y.
    #[serde(default)]
    #[schemars(transform = each(between(-MAX_COORDINATE, MAX_COORDINATE).unit("m")))]
    of: Option<[f64; 2]>,
}

/// Returns the time or condition that an event's keys state; reports all problems.
pub(super) fn resolve(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    (time_s, when, after_s): (Option<f64>, Option<WhenBlock>, Option<f64>),
    map: Option<&MapSpec>,
    robots: Option<&[Robot]>,
) -> Option<Moment> {
    let mut problems = EventProblems { ctx, node, path };
    match (time_s, when) {
        (Some(time_s), None) => {
            if after_s.is_some() {
                let message = "`after_s` delays an event with `when`, not one with `time_s`";
                return problems.report("after_s", Code::Requirement, message, "a later `time_s`");
            }
            Some(Moment::At { time_s })
        }
        (None, Some(block)) => {
            let after_s = after_s.unwrap_or(0.0);
            let condition = block.condition(&mut problems);
            let index = problems.robot(&block.robot, robots);
            let condition = condition?;
            let robot = robots?.get(index?)?;
            problems.check_possible(&condition, robot, map)?;
            let when = Trigger {
                robot: block.robot,
                index: index?,
                condition,
            };
            Some(Moment::When { when, after_s })
        }
        (Some(_), Some(_)) => {
            let message = "an event with both `time_s` and `when`";
            problems.report("when", Code::Requirement, message, "one of them")
        }
        (None, None) => {
            let message = "neither `time_s` nor `when` defines the time of the event";
            let expected = "time_s = 10.0 (s), or when = { robot = \"…\", travelled = 1.5 } (m)";
            problems.report("time_s", Code::MissingKey, message, expected)
        }
    }
}

impl WhenBlock {
    /// Returns the one condition that is written.
    fn condition(&self, problems: &mut EventProblems<'_, '_>) -> Option<Condition> {
        const ONE: &str =
            "`travelled` (m), `progress` (0 to 1), or `within` (m) together with `of`";
        let Self {
            travelled,
            progress,
            within,
            of,
            ..
        } = *self;
        let written = [
            ("travelled", travelled.is_some()),
            ("progress", progress.is_some()),
            ("within", within.is_some()),
        ];
        let mut written = written.iter().filter(|w| w.1).map(|w| w.0);
        let (first, second) = (written.next(), written.next());
        if let (Some(first), Some(second)) = (first, second) {
            let message = format!("`when` has two conditions, `{first}` and `{second}`");
            let field = format!("when.{second}");
            let expected = format!("one of {ONE}");
            return problems.report(&field, Code::Requirement, &message, &expected);
        }
        if of.is_some() && within.is_none() {
            let expected = "within = 0.8 (m) beside it";
            let message = "`of` is the point that a robot comes `within` a distance of";
            return problems.report("when.of", Code::Requirement, message, expected);
        }
        let condition = if let Some(travelled) = travelled {
            Condition::Travelled { travelled }
        } else if let Some(progress) = progress {
            Condition::Progress { progress }
        } else if let Some(within) = within {
            let Some(of) = of else {
                let message = "missing key `of`";
                let expected = "of = [x, y], the point that the robot comes near (m)";
                return problems.report("when.of", Code::MissingKey, message, expected);
            };
            Condition::Within { within, of }
        } else {
            return problems.report("when", Code::MissingKey, "`when` has no condition", ONE);
        };
        Some(condition)
    }
}

/// Reporter of the problems of one event.
struct EventProblems<'a, 'c> {
    ctx: &'a mut Context<'c>,
    node: &'a Node,
    path: &'a FieldPath,
}

impl EventProblems<'_, '_> {
    /// Reports a problem and returns `None`.
    fn report<T>(&mut self, field: &str, code: Code, message: &str, expected: &str) -> Option<T> {
        self.ctx.problems.push(
            self.ctx
                .problem(self.node, self.path, field, code, message)
                .expected(expected),
        );
        None
    }

    /// Returns the index of a robot; reports nothing about robots that have errors themselves.
    fn robot(&mut self, name: &str, robots: Option<&[Robot]>) -> Option<usize> {
        let robots = robots?;
        let found = robots.iter().position(|r| r.spec.name == name);
        if found.is_none() {
            let names: Vec<&str> = robots.iter().map(|r| r.spec.name.as_str()).collect();
            let message = format!("no robot is called `{name}`");
            let mut problem = self
                .ctx
                .problem(
                    self.node,
                    self.path,
                    "when.robot",
                    Code::UnknownName,
                    message,
                )
                .expected(list_choices(&names));
            problem.help =
                nearest(name, names.iter().copied()).map(|near| format!("did you mean `{near}`?"));
            self.ctx.problems.push(problem);
        }
        found
    }

    /// Checks that the robot can meet the condition.
    fn check_possible(
        &mut self,
        condition: &Condition,
        robot: &Robot,
        map: Option<&MapSpec>,
    ) -> Option<()> {
        let name = &robot.spec.name;
        match *condition {
            Condition::Travelled { .. } => Some(()),
            Condition::Progress { .. } => {
                let Some(goal) = &robot.spec.goal else {
                    let message = format!("robot `{name}` has no goal to make progress to");
                    let expected = "a robot with a `goal`, or `travelled` or `within` instead";
                    return self.report("when.progress", Code::Requirement, &message, expected);
                };
                if robot.has_start() && goal.center() == robot.spec.start.position() {
                    let message = format!("robot `{name}` starts at the centre of its goal");
                    let expected = "a robot with a distance between its start and its goal";
                    return self.report("when.progress", Code::Geometry, &message, expected);
                }
                Some(())
            }
            Condition::Within { within, of } => match map.and_then(bounds) {
                Some([min, max]) => {
                    let outside = |i: usize| (min[i] - of[i]).max(of[i] - max[i]).max(0.0);
                    let far = math::hypot(outside(0), outside(1));
                    if far <= within {
                        return Some(());
                    }
                    let message = format!(
                        "no place of the map is within {within} m of {of:?}: it ends {far:.3} m from there"
                    );
                    let expected = format!(
                        "a point in or near x = {} to {}, y = {} to {} (m)",
                        min[0], max[0], min[1], max[1]
                    );
                    self.report("when.of", Code::Geometry, &message, &expected)
                }
                None => Some(()),
            },
        }
    }
}

/// Returns the smallest and largest x and y of a map (m), if it is written out.
fn bounds(map: &MapSpec) -> Option<[[f64; 2]; 2]> {
    match map {
        MapSpec::Vector(map) => Some([map.bounds.min, map.bounds.max]),
        MapSpec::Cells(map) => {
            let [x, y] = map.origin;
            let side = |cells: usize| cells as f64 * map.resolution;
            Some([[x, y], [x + side(map.width), y + side(map.height)]])
        }
        MapSpec::File { .. } => None,
    }
}
