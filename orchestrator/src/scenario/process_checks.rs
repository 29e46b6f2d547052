//! Whether the processes fit each other and the robots.

use super::context::Context;
use super::kinds::Need;
use super::processes::{Read, kind_of};
use super::robots::Robot;
use super::text::Code;

/// Names that the run itself uses.
const RESERVED: [&str; 3] = ["simulator", "orchestrator", "recorder"];

/// Every process has a name of its own.
pub fn check_names(ctx: &mut Context<'_>, read: &[Read]) {
    for (i, r) in read.iter().enumerate() {
        let name = &r.spec.name;
        if RESERVED.contains(&name.as_str()) {
            let message = format!("`{name}` is a name of the run's own");
            let problem = ctx
                .block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                .expected("another name");
            ctx.problems.push(problem);
        } else if read.iter().take(i).any(|o| o.spec.name == *name) {
            let message = format!("two processes are called `{name}`");
            let problem = ctx
                .block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                .expected("a name of its own for every process (`name = \"…\"`)");
            ctx.problems.push(problem);
        }
    }
}

/// Every robot is driven by exactly one process.
pub fn check_drivers(ctx: &mut Context<'_>, read: &[Read], robots: &[Robot]) {
    for (i, robot) in robots.iter().enumerate() {
        let name = &robot.spec.name;
        let drivers: Vec<&Read> = read.iter().filter(|r| r.spec.robots.contains(&i)).collect();
        let problem = match drivers.as_slice() {
            [_] => continue,
            [] => ctx
                .block_problem(
                    robot.node.origin,
                    &robot.path,
                    Code::Requirement,
                    format!("robot `{name}` is driven by no process"),
                )
                .expected("exactly one process that drives it")
                .help(format!(
                    "add robots = [\"{name}\"] to a [[processes]] block"
                )),
            [first, second, ..] => ctx
                .block_problem(
                    second.origin,
                    &second.path,
                    Code::Requirement,
                    format!(
                        "robot `{name}` is driven by two processes, `{}` and `{}`",
                        first.spec.name, second.spec.name
                    ),
                )
                .expected("exactly one process that drives it"),
        };
        ctx.problems.push(problem);
    }
}

/// What a process needs is there.
pub fn check_needs(ctx: &mut Context<'_>, read: &[Read], robots: &[Robot]) {
    let kinds = ctx.kinds;
    let providers: Vec<&Read> = read
        .iter()
        .filter(|r| kind_of(kinds, &r.spec).is_some_and(|k| k.provides_belief))
        .collect();
    if let [first, second, ..] = providers.as_slice() {
        let message = format!(
            "two processes publish beliefs, `{}` and `{}`",
            first.spec.name, second.spec.name
        );
        let problem = ctx
            .block_problem(second.origin, &second.path, Code::Requirement, message)
            .expected("at most one");
        ctx.problems.push(problem);
    }
    let belief_kinds: Vec<&str> = kinds
        .iter()
        .filter(|k| k.provides_belief)
        .map(|k| k.name)
        .collect();
    for r in read {
        let Some(kind) = kind_of(kinds, &r.spec) else {
            continue;
        };
        for need in (kind.needs)(&r.spec.params) {
            match need {
                Need::Belief if providers.is_empty() => {
                    let provider = belief_kinds.first().copied().unwrap_or("perception");
                    let message = format!(
                        "process `{}` goes by beliefs, but no process provides them",
                        r.spec.name
                    );
                    let problem = ctx
                        .block_problem(r.origin, &r.path, Code::Requirement, message)
                        .expected(format!("a [[processes]] block with kind = \"{provider}\""));
                    ctx.problems.push(problem);
                }
                Need::Scan => {
                    let blind = |&&i: &&usize| robots.get(i).is_some_and(|r| r.spec.scan.is_none());
                    for robot in r
                        .spec
                        .robots
                        .iter()
                        .filter(blind)
                        .filter_map(|&i| robots.get(i))
                    {
                        let message = format!(
                            "robot `{}` has no range scanner, but process `{}` ({}) steers by it",
                            robot.spec.name, r.spec.name, kind.name
                        );
                        let problem = ctx
                            .block_problem(
                                robot.node.origin,
                                &robot.path.then("scan"),
                                Code::Requirement,
                                message,
                            )
                            .expected("a `scan` table on the robot")
                            .help("scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m");
                        ctx.problems.push(problem);
                    }
                }
                Need::Belief => {}
            }
        }
    }
}
