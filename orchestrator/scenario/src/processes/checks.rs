//! Whether the processes fit each other and the robots.

use config::Code;
use runtime::kind::{Need, Product};

use super::read::Read;
use crate::context::Context;
use crate::robots::Robot;

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

/// Something that one process makes for others.
struct Provision {
    need: Need,
    /// What provides it.
    product: Product,
    /// Two processes …
    both: &'static str,
    /// A process …, but no process provides them.
    goes_by: &'static str,
}

const PROVISIONS: [Provision; 2] = [
    Provision {
        need: Need::Belief,
        product: Product::Beliefs,
        both: "publish beliefs",
        goes_by: "goes by beliefs",
    },
    Provision {
        need: Need::Plans,
        product: Product::Plans,
        both: "make plans",
        goes_by: "asks for plans",
    },
];

/// What a process needs is there.
pub fn check_needs(ctx: &mut Context<'_>, read: &[Read], robots: &[Robot]) {
    for provision in &PROVISIONS {
        check_provision(ctx, read, provision);
    }
    check_robots(ctx, read, robots, &SCANNER);
    check_robots(ctx, read, robots, &GOAL);
}

/// What is needed of other processes is made, and by one only.
fn check_provision(ctx: &mut Context<'_>, read: &[Read], provision: &Provision) {
    let providers: Vec<&Read> = read
        .iter()
        .filter(|r| r.spec.makes(provision.product))
        .collect();
    if let [first, second, ..] = providers.as_slice() {
        let message = format!(
            "two processes {}, `{}` and `{}`",
            provision.both, first.spec.name, second.spec.name
        );
        let problem = ctx
            .block_problem(second.origin, &second.path, Code::Requirement, message)
            .expected("at most one");
        ctx.problems.push(problem);
    }
    if !providers.is_empty() {
        return;
    }
    let provider = ctx.kinds.iter().find(|kind| kind.makes(provision.product));
    let provider = provider.map_or("…", |kind| kind.name);
    for r in read {
        if r.spec.needs(provision.need) {
            let message = format!(
                "process `{}` {}, but no process provides them",
                r.spec.name, provision.goes_by
            );
            let problem = ctx
                .block_problem(r.origin, &r.path, Code::Requirement, message)
                .expected(format!("a [[processes]] block with kind = \"{provider}\""));
            ctx.problems.push(problem);
        }
    }
}

/// Something that robots must have for who drives them.
struct Equipment {
    need: Need,
    /// The key of the robot that gives it.
    key: &'static str,
    is_there: fn(&Robot) -> bool,
    /// Robot … has no range scanner, but process … steers by it.
    lacks: [&'static str; 2],
    expected: &'static str,
    help: &'static str,
}

const SCANNER: Equipment = Equipment {
    need: Need::Scan,
    key: "scan",
    is_there: |robot| robot.spec.scan.is_some(),
    lacks: ["range scanner", "steers by it"],
    expected: "a `scan` table on the robot",
    help: "scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m",
};

const GOAL: Equipment = Equipment {
    need: Need::Goal,
    key: "goal",
    is_there: |robot| robot.spec.goal.is_some(),
    lacks: ["goal", "drives there"],
    expected: "a `goal` of the robot, or `goals` among the process's parameters",
    help: "goal = { circle = { center = [x, y], radius = 0.1 } }",
};

/// Whoever needs a piece of equipment drives robots that have it.
fn check_robots(ctx: &mut Context<'_>, read: &[Read], robots: &[Robot], equipment: &Equipment) {
    let [thing, use_of_it] = equipment.lacks;
    for r in read {
        let Some(kind) = r
            .spec
            .program
            .kind()
            .filter(|kind| kind.needs(equipment.need))
        else {
            continue;
        };
        let driven = r.spec.robots.iter().filter_map(|&i| robots.get(i));
        for robot in driven.filter(|robot| !(equipment.is_there)(robot)) {
            let message = format!(
                "robot `{}` has no {thing}, but process `{}` ({}) {use_of_it}",
                robot.spec.name,
                r.spec.name,
                kind.kind().name
            );
            let path = robot.path.then(equipment.key);
            let problem = ctx
                .block_problem(robot.node.origin, &path, Code::Requirement, message)
                .expected(equipment.expected)
                .help(equipment.help);
            ctx.problems.push(problem);
        }
    }
}
