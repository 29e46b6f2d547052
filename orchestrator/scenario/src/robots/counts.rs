//! `count`: several equal robots from one `[[robots]]` block.

use config::{Code, FieldPath, Node};

use super::{Robot, check_name, inherit, teams};
use crate::context::Context;
use crate::spec::MAX_ROBOTS;

/// Reports a team's `count` that does not belong to exactly one block.
pub fn check(ctx: &mut Context<'_>, blocks: &[(FieldPath, Node)]) -> bool {
    let mut holds = true;
    for team in teams::tables(ctx) {
        let team = team.as_str();
        let path = FieldPath::key("teams").then(team).then("count");
        let Some(count) = ctx.root.at(&path).cloned() else {
            continue;
        };
        let of_team = |node: &Node| {
            let merged = inherit(ctx, node);
            merged.get("team").and_then(Node::as_str) == Some(team)
        };
        let heirs = blocks
            .iter()
            .filter(|(_, node)| node.get("count").is_none() && of_team(node))
            .count();
        if heirs == 1 {
            continue;
        }
        let message = format!("`{path}` belongs to {heirs} [[robots]] blocks");
        ctx.problems.push(
            ctx.block_problem(count.origin, &path, Code::Requirement, message)
                .value(count.render_short())
                .expected("one block of the team without its own `count`"),
        );
        holds = false;
    }
    holds
}

/// Reports a `count` out of its range, one whose robots would share a start, and names that become too long.
pub fn check_block(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    name: &str,
    count: Option<usize>,
) -> bool {
    let Some(count) = count else {
        return true;
    };
    let (code, message, expected) = if !(1..=MAX_ROBOTS).contains(&count) {
        let message = "`count` is out of range".to_owned();
        let expected = format!("a number from 1 to {MAX_ROBOTS}");
        (Code::OutOfRange, message, expected)
    } else if count > 1 && node.get("random_start").is_none() {
        let message = format!("the {count} robots `{name}` have one start");
        let expected = "random_start = { region = …, robot_distance = 0.5 } (m)".to_owned();
        (Code::Requirement, message, expected)
    } else {
        return check_name(ctx, node, path, "name", &numbered(name, count));
    };
    ctx.problems.push(
        ctx.problem(node, path, "count", code, message)
            .value(count)
            .expected(expected),
    );
    false
}

/// Returns the robots of a block.
pub fn expand(robot: Robot, count: Option<usize>) -> Vec<Robot> {
    let Some(count) = count else {
        return vec![robot];
    };
    let numbers = 1..=count;
    numbers
        .map(|number| {
            let mut copy = robot.clone();
            copy.spec.name = numbered(&robot.spec.name, number);
            copy
        })
        .collect()
}

fn numbered(name: &str, number: usize) -> String {
    format!("{name}_{number}")
}
