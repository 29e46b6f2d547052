//! Teams: their tables, roles and opponents.

use config::{Code, FieldPath, Node, suggest};
use robot::team::Role;

use super::{Robot, check_name};
use crate::context::Context;

/// Returns the names of the tables in `[teams]`, in the order of the file.
pub fn tables(ctx: &Context<'_>) -> Vec<String> {
    let table = ctx.root.get("teams").and_then(Node::as_table);
    let entries = table.into_iter().flat_map(|teams| &teams.entries);
    entries.map(|entry| entry.key.clone()).collect()
}

/// Reports a team whose name is not allowed or that has no role.
pub fn check_block(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    team: &str,
    role: Option<Role>,
) -> bool {
    if !check_name(ctx, node, path, "team", team) {
        return false;
    }
    if role.is_some() || Role::of_team(team).is_some() {
        return true;
    }
    let with_role = |name: &String| {
        let path = FieldPath::key("teams").then(name).then("role");
        ctx.root.at(&path).is_some()
    };
    let standard = Role::ALL.map(|role| role.team().to_owned());
    let mut known = tables(ctx);
    known.retain(with_role);
    known.extend(standard);
    let message = format!("team `{team}` has no role");
    let lead =
        format!("role = \"pursuer\", \"evader\" or \"neutral\" in [teams.{team}], or a team: ");
    let blank = ctx.problem(node, path, "team", Code::UnknownName, message);
    ctx.problems.push(suggest(blank, team, &known, &lead));
    false
}

/// Reports tables of teams without robots, robots of one team that differ in its keys, and opponents that do not exist
/// or cannot be hostile.
pub fn check(ctx: &mut Context<'_>, robots: &[Robot]) -> bool {
    let before = ctx.problems.len();
    check_tables(ctx, robots);
    for (i, robot) in robots.iter().enumerate() {
        let mut earlier = robots.iter().take(i);
        match earlier.find(|other| other.spec.team == robot.spec.team) {
            Some(first) => check_same(ctx, first, robot),
            None => check_opponents(ctx, robots, robot),
        }
    }
    ctx.problems.len() == before
}

/// Reports tables of teams without robots. The standard teams may have none.
fn check_tables(ctx: &mut Context<'_>, robots: &[Robot]) {
    for team in tables(ctx) {
        let has_robots = robots.iter().any(|robot| robot.spec.team == team);
        if has_robots || Role::of_team(&team).is_some() {
            continue;
        }
        let path = FieldPath::key("teams").then(&team);
        let origin = ctx.root.origin_along(&path);
        let message = format!("no robot is in team `{team}`");
        let blank = ctx.block_problem(origin, &path, Code::UnknownName, message);
        let known = names(robots, |_| true);
        ctx.problems.push(suggest(blank, &team, &known, "a team: "));
    }
}

/// Reports a robot with another role or other opponents than its team.
fn check_same(ctx: &mut Context<'_>, first: &Robot, robot: &Robot) {
    let key = if robot.spec.role() != first.spec.role() {
        "role"
    } else if robot.spec.hostile_to != first.spec.hostile_to {
        "hostile_to"
    } else {
        return;
    };
    let team = &robot.spec.team;
    let message = format!(
        "`{key}` differs within team `{team}`, between `{}` and `{}`",
        first.spec.name, robot.spec.name
    );
    ctx.problems.push(
        ctx.problem(&robot.node, &robot.path, key, Code::Requirement, message)
            .expected(format!("`{key}` in [teams.{team}], for all of its robots")),
    );
}

/// Reports opponents that are no team, or a team without the opposite role.
fn check_opponents(ctx: &mut Context<'_>, robots: &[Robot], robot: &Robot) {
    let opposite = robot.spec.role().opposite();
    let possible = names(robots, |other| Some(other.spec.role()) == opposite);
    for (i, name) in robot.spec.hostile_to.iter().flatten().enumerate() {
        if possible.contains(&name.as_str()) {
            continue;
        }
        let field = format!("hostile_to[{i}]");
        let (team, role) = (&robot.spec.team, robot.spec.role().name());
        let message = format!("team `{team}` of role {role} cannot be hostile to `{name}`");
        let blank = ctx.problem(&robot.node, &robot.path, &field, Code::UnknownName, message);
        ctx.problems.push(match opposite {
            Some(role) if !possible.is_empty() => {
                let lead = format!("a team of role {}: ", role.name());
                suggest(blank, name, &possible, &lead)
            }
            Some(role) => blank.expected(format!("a team of role {} with robots", role.name())),
            None => blank.expected("no `hostile_to`: neutral robots have no opponents"),
        });
    }
}

/// Returns the names of the teams with such robots, in the order of the robots.
fn names(robots: &[Robot], is_such: impl Fn(&Robot) -> bool) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for robot in robots.iter().filter(|robot| is_such(robot)) {
        if !names.contains(&robot.spec.team.as_str()) {
            names.push(&robot.spec.team);
        }
    }
    names
}
