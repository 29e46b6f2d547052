//! Checks that the processes fit each other and the robots.

use config::Code;
use runtime::declaration::{self, Declaration, Flow, Input, When};

use super::read::ProcessEntry;
use crate::context::Context;
use crate::robots::Robot;

/// Names of the run's own processes.
const RESERVED: [&str; 3] = ["simulator", "orchestrator", "recorder"];

/// Checks that every process has a unique name.
pub fn check_names(ctx: &mut Context<'_>, read: &[ProcessEntry]) {
    for (i, r) in read.iter().enumerate() {
        let name = &r.spec.name;
        if RESERVED.contains(&name.as_str()) {
            let message = format!("`{name}` is reserved");
            ctx.problems.push(
                ctx.block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                    .expected("another name"),
            );
        } else if read.iter().take(i).any(|o| o.spec.name == *name) {
            let message = format!("two processes are called `{name}`");
            ctx.problems.push(
                ctx.block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                    .expected("a unique name for every process (`name = \"…\"`)"),
            );
        }
    }
}

/// Checks that exactly one process drives every robot.
pub fn check_drivers(ctx: &mut Context<'_>, read: &[ProcessEntry], robots: &[Robot]) {
    for (i, robot) in robots.iter().enumerate() {
        let name = &robot.spec.name;
        let drivers: Vec<&ProcessEntry> =
            read.iter().filter(|r| r.spec.robots.contains(&i)).collect();
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

/// Checks the inputs of every process: one process at most writes a sole output, every required input has a writer, and no
/// processes wait for each other in a circle.
pub fn check_inputs(ctx: &mut Context<'_>, read: &[ProcessEntry], robots: &[Robot]) {
    let declarations: Vec<_> = read.iter().map(|r| r.spec.declaration()).collect();
    check_sole_writers(ctx, read, &declarations);
    // A program that is asked before the run may write any topic.
    if !read.iter().any(|r| r.spec.is_to_be_asked()) {
        check_writers(ctx, read, &declarations);
    }
    check_circles(ctx, read, &declarations);
    check_robots(ctx, read, &declarations, robots, &SCANNER);
    check_robots(ctx, read, &declarations, robots, &GOAL);
}

/// Reports the second process that writes a sole output.
fn check_sole_writers(
    ctx: &mut Context<'_>,
    read: &[ProcessEntry],
    declarations: &[Option<Declaration>],
) {
    let mut writers: Vec<(Flow, &ProcessEntry)> = Vec::new();
    for (r, declaration) in read.iter().zip(declarations) {
        let outputs = declaration.iter().flat_map(|known| &known.outputs);
        for output in outputs.filter(|output| output.is_sole) {
            let Some((flow, first)) = writers.iter().find(|(flow, _)| *flow == output.flow) else {
                writers.push((output.flow, r));
                continue;
            };
            let message = format!(
                "two processes write {flow}, `{}` and `{}`",
                first.spec.name, r.spec.name
            );
            ctx.problems.push(
                ctx.block_problem(r.origin, &r.path, Code::Requirement, message)
                    .expected("at most one"),
            );
        }
    }
}

/// Reports required inputs that no process writes. What the run itself writes is there, or is checked with the robots and
/// the map.
fn check_writers(
    ctx: &mut Context<'_>,
    read: &[ProcessEntry],
    declarations: &[Option<Declaration>],
) {
    let is_written = |flow| {
        let mut known = declarations.iter().flatten();
        known.any(|writer| writer.output(flow).is_some())
    };
    for (r, declaration) in read.iter().zip(declarations) {
        let required = declaration.iter().flat_map(Declaration::required);
        for flow in required.filter(|flow| !flow.is_of_the_run() && !is_written(*flow)) {
            let message = format!(
                "process `{}` reads {flow}, but no process writes it",
                r.spec.name
            );
            let mut kinds = ctx.kinds.iter();
            let writer = kinds.find(|kind| kind.declaration().output(flow).is_some());
            let expected = writer.map_or_else(
                || "a process of a kind that writes it".to_owned(),
                |kind| format!("a [[processes]] block with kind = \"{}\"", kind.name),
            );
            ctx.problems.push(
                ctx.block_problem(r.origin, &r.path, Code::Requirement, message)
                    .expected(expected),
            );
        }
    }
}

/// Reports processes that wait for each other within a tick.
fn check_circles(
    ctx: &mut Context<'_>,
    read: &[ProcessEntry],
    declarations: &[Option<Declaration>],
) {
    let upstream = declaration::upstream(declarations);
    let Err(circle) = declaration::order(&upstream, |_| false) else {
        return;
    };
    let Some(r) = circle.first().and_then(|&first| read.get(first)) else {
        return;
    };
    let named = circle.iter().filter_map(|&index| {
        let inputs = &declarations.get(index)?.as_ref()?.inputs;
        let within = |input: &&Input| input.when == When::ThisTick && !input.flow.is_of_the_run();
        let flows: Vec<String> = inputs
            .iter()
            .filter(within)
            .map(|input| input.flow.to_string())
            .collect();
        Some(format!(
            "`{}` reads {}",
            read.get(index)?.spec.name,
            flows.join(" and ")
        ))
    });
    let message = format!(
        "processes wait for each other within a tick: {}",
        named.collect::<Vec<_>>().join(", ")
    );
    ctx.problems.push(
        ctx.block_problem(r.origin, &r.path, Code::Requirement, message)
            .expected("inputs of the tick before for one of them"),
    );
}

/// Equipment of a robot that the process driving it needs.
struct Equipment {
    is_required: fn(&Declaration) -> bool,
    /// Key of the robot that adds it.
    key: &'static str,
    is_there: fn(&Robot) -> bool,
    /// Parts of the message "robot … has no range scanner, but process … steers by it".
    lacks: [&'static str; 2],
    expected: &'static str,
    help: &'static str,
}

const SCANNER: Equipment = Equipment {
    is_required: |known| known.required().any(|flow| flow == Input::SCANS.flow),
    key: "scan",
    is_there: |robot| robot.spec.scan.is_some(),
    lacks: ["range scanner", "steers by it"],
    expected: "a `scan` table on the robot",
    help: "scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m",
};

const GOAL: Equipment = Equipment {
    is_required: |known| known.needs_goals,
    key: "goal",
    is_there: |robot| robot.spec.goal.is_some(),
    lacks: ["goal", "drives there"],
    expected: "a `goal` of the robot, or `goals` among the process's parameters",
    help: "goal = { circle = { center = [x, y], radius = 0.1 } }",
};

/// Checks that a process that needs equipment drives robots that have it.
fn check_robots(
    ctx: &mut Context<'_>,
    read: &[ProcessEntry],
    declarations: &[Option<Declaration>],
    robots: &[Robot],
    equipment: &Equipment,
) {
    let [thing, use_of_it] = equipment.lacks;
    for (r, declaration) in read.iter().zip(declarations) {
        let Some(kind) = r.spec.program.kind() else {
            continue;
        };
        if !declaration.as_ref().is_some_and(equipment.is_required) {
            continue;
        }
        let driven = r.spec.robots.iter().filter_map(|&i| robots.get(i));
        for robot in driven.filter(|robot| !(equipment.is_there)(robot)) {
            let message = format!(
                "robot `{}` has no {thing}, but process `{}` ({}) {use_of_it}",
                robot.spec.name,
                r.spec.name,
                kind.kind().name
            );
            let path = robot.path.then(equipment.key);
            ctx.problems.push(
                ctx.block_problem(robot.node.origin, &path, Code::Requirement, message)
                    .expected(equipment.expected)
                    .help(equipment.help),
            );
        }
    }
}
