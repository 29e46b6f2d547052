//! `[[robots]]`, with the values inherited from their team and from the defaults.

use std::collections::BTreeMap;

use config::{Code, FieldPath, Node, Value};
use geometry::pose::Pose2;
use parameters::{Parameters, faults};
use robot::spec::RobotSpec;

use super::context::Context;
use super::spec::{Defaults, MAX_NAME, MAX_ROBOTS, RobotBlock};
use super::starts::Draw;

mod counts;
mod teams;

/// A robot as read, before its start is drawn.
#[derive(Clone)]
pub struct Robot {
    /// Specification with the start of the scenario; the default pose if it has none.
    pub spec: RobotSpec,
    /// Way in which the start varies with the seed.
    pub draw: Option<Draw>,
    /// Tree of the robot with inheritance applied and the places of its values.
    pub node: Node,
    /// Path of the robot in the scenario.
    pub path: FieldPath,
}

impl Robot {
    /// Returns `true` if the scenario's start counts: it is the start, or what the start is displaced from.
    pub fn has_start(&self) -> bool {
        !matches!(self.draw, Some(Draw::Random(_)))
    }
}

/// Reports a name, the value of a key, that is empty, too long, or has characters that messages, file names or
/// process tables do not permit.
pub fn check_name(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    key: &str,
    name: &str,
) -> bool {
    let allowed = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    if !name.is_empty() && name.len() <= MAX_NAME && name.bytes().all(allowed) {
        return true;
    }
    ctx.problems.push(
        ctx.problem(node, path, key, Code::OutOfRange, "name not allowed")
            .value(format!("{name:?}"))
            .expected(format!(
                "1 to {MAX_NAME} of the characters a–z, A–Z, 0–9, _ and -"
            )),
    );
    false
}

/// Reads all robots and reports all problems. Returns `None` if some robot is unreadable.
pub fn resolve(ctx: &mut Context<'_>) -> Option<Vec<Robot>> {
    check_inherited(ctx);
    let blocks = ctx.blocks("robots");
    let listed = ctx
        .root
        .get("robots")
        .is_none_or(|n| n.as_array().is_some());
    if blocks.is_empty() && listed {
        let path = FieldPath::key("robots");
        ctx.problems.push(
            ctx.block_problem(
                ctx.root.origin,
                &path,
                Code::MissingKey,
                "the scenario has no robots",
            )
            .expected("at least one [[robots]] block"),
        );
        return None;
    }
    if let Some((path, node)) = blocks.get(MAX_ROBOTS) {
        report_too_many(ctx, path, node, blocks.len());
        return None;
    }
    let mut complete = counts::check(ctx, &blocks);
    let mut robots: Vec<Robot> = Vec::with_capacity(blocks.len());
    for (path, node) in blocks {
        let merged = inherit(ctx, &node);
        let Some((robot, count)) = read_robot(ctx, merged, path.clone()) else {
            complete = false;
            continue;
        };
        for robot in counts::expand(robot, count) {
            complete &= check_unique(ctx, &robots, &robot);
            robots.push(robot);
        }
        if robots.len() > MAX_ROBOTS {
            report_too_many(ctx, &path, &node, robots.len());
            return None;
        }
    }
    complete = complete && teams::check(ctx, &robots);
    complete.then_some(robots)
}

fn report_too_many(ctx: &mut Context<'_>, path: &FieldPath, node: &Node, found: usize) {
    ctx.problems.push(
        ctx.block_problem(node.origin, path, Code::Limit, "too many robots")
            .value(found)
            .expected(format!("at most {MAX_ROBOTS} robots")),
    );
}

/// Reports faults in `[defaults]` and `[teams]`, also in values that no robot inherits.
fn check_inherited(ctx: &mut Context<'_>) {
    let paths = ["defaults", "teams"].map(FieldPath::key);
    let [defaults, teams] = paths.each_ref().map(|path| ctx.root.at(path).cloned());
    if let Some(node) = defaults {
        let _: Option<Defaults> = ctx.read(&node, &paths[0]);
    }
    if let Some(node) = teams {
        let _: Option<BTreeMap<String, RobotBlock>> = ctx.read(&node, &paths[1]);
    }
    let defaults = FieldPath::key("defaults").then("robot");
    let of_team = |team: &String| (FieldPath::key("teams").then(team), &["name", "start"][..]);
    let teams = teams::tables(ctx);
    let tables = teams.iter().map(of_team);
    for (path, keys) in core::iter::once((defaults, &["name", "start", "count"][..])).chain(tables)
    {
        for key in keys {
            let table = ctx.root.at(&path).and_then(Node::as_table);
            let Some(entry) = table.and_then(|t| t.entry(key)) else {
                continue;
            };
            let message = format!("`{key}` cannot be inherited: every robot has its own");
            ctx.problems.push(
                ctx.block_problem(entry.origin, &path.then(key), Code::Requirement, message)
                    .value(entry.node.render_short())
                    .expected(format!("`{key}` in each [[robots]] block")),
            );
        }
    }
}

/// Merges the robot's own keys over its team's keys over the defaults.
fn inherit(ctx: &Context<'_>, robot: &Node) -> Node {
    let defaults = ctx.root.get("defaults").and_then(|n| n.get("robot"));
    let team = robot
        .get("team")
        .or_else(|| defaults.and_then(|d| d.get("team")))
        .and_then(Node::as_str)
        .and_then(|team| ctx.root.get("teams").and_then(|teams| teams.get(team)));
    let mut merged = Node::empty_table(robot.origin);
    let (Value::Table(table), Some(own)) = (&mut merged.value, robot.as_table()) else {
        return robot.clone();
    };
    for layer in [defaults, team]
        .into_iter()
        .flatten()
        .filter_map(Node::as_table)
    {
        table.overlay(layer);
    }
    table.overlay(own);
    merged
}

/// Reads one block; returns its robot under the block's name, and its `count`.
fn read_robot(
    ctx: &mut Context<'_>,
    node: Node,
    path: FieldPath,
) -> Option<(Robot, Option<usize>)> {
    let block: RobotBlock = ctx.read(&node, &path)?;
    let missing = |ctx: &mut Context<'_>, key: &str, expected: &str| {
        ctx.problems.push(
            ctx.problem(
                &node,
                &path,
                key,
                Code::MissingKey,
                format!("missing key `{key}`"),
            )
            .expected(expected),
        );
    };
    if block.name.is_none() {
        missing(ctx, "name", "name = \"…\"");
    }
    if block.team.is_none() {
        missing(ctx, "team", "team = \"…\"");
    }
    if block.start.is_none() && block.random_start.is_none() {
        missing(
            ctx,
            "start",
            "start = { x = 0.0, y = 0.0, theta = 0.0 } (m, m, rad)",
        );
    }
    let (name, team, start): (String, String, Pose2) = match block.random_start {
        None => (block.name?, block.team?, block.start?),
        Some(_) => (block.name?, block.team?, block.start.unwrap_or_default()),
    };
    let team_ok = teams::check_block(ctx, &node, &path, &team, block.role);
    let name_ok = check_name(ctx, &node, &path, "name", &name)
        & counts::check_block(ctx, &node, &path, &name, block.count);
    let spec = RobotSpec {
        name,
        team,
        role: block.role,
        hostile_to: block.hostile_to,
        start,
        preset: block.preset.unwrap_or_default(),
        radius: block.radius,
        wheel_separation: block.wheel_separation,
        limits: block.limits,
        actuator: block.actuator,
        scan: block.scan,
        odometry: block.odometry,
        goal: block.goal,
    };
    let spec_ok = team_ok && ctx.check(&node, &path, &spec);
    let draws_ok = check_draw(
        ctx,
        &node,
        &path,
        "start_jitter",
        block.start_jitter.as_ref(),
    ) & check_draw(
        ctx,
        &node,
        &path,
        "random_start",
        block.random_start.as_ref(),
    );
    let random = block.random_start.map(Draw::Random);
    let robot = Robot {
        spec,
        draw: random.or(block.start_jitter.map(Draw::Jitter)),
        node,
        path,
    };
    (name_ok && spec_ok && draws_ok).then_some((robot, block.count))
}

/// Reports faults of an optional table of the robot.
fn check_draw<T: Parameters>(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    key: &str,
    draw: Option<&T>,
) -> bool {
    let faults = draw.map(faults).unwrap_or_default();
    let holds = faults.is_empty();
    for fault in faults {
        ctx.refuse(node, path, fault.within(key));
    }
    holds
}

fn check_unique(ctx: &mut Context<'_>, others: &[Robot], robot: &Robot) -> bool {
    let Some(other) = others.iter().find(|o| o.spec.name == robot.spec.name) else {
        return true;
    };
    let name = &robot.spec.name;
    let line = ctx
        .sources
        .place(other.node.origin)
        .map_or(String::new(), |p| {
            format!(" (the other is at {}:{})", p.file, p.line)
        });
    ctx.problems.push(
        ctx.problem(
            &robot.node,
            &robot.path,
            "name",
            Code::Duplicate,
            format!("two robots are called `{name}`{line}"),
        )
        .expected("a unique name for every robot"),
    );
    false
}
