//! Checks that the processes fit each other and the robots.

use config::Code;
use runtime::kind::{Need, Product};

use super::read::Read;
use crate::context::Context;
use crate::robots::Robot;

/// Names of the run's own processes.
const RESERVED: [&str; 3] = ["simulator", "orchestrator", "recorder"];

/// Checks that every process has a unique name.
pub fn check_names(ctx: &mut Context<'_>, read: &[Read]) {
    for (i, r) in read.iter().enumerate() {
        let name = &r.spec.name;
        if RESERVED.contains(&name.as_str()) {
            let message = format!("`{name}` is reserved");
            let problem = ctx
                .block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                .expected("another name");
            ctx.problems.push(problem);
        } else if read.iter().take(i).any(|o| o.spec.name == *name) {
            let message = format!("two processes are called `{name}`");
            let problem = ctx
                .block_problem(r.origin, &r.path.then("name"), Code::Duplicate, message)
                .expected("a unique name for every process (`name = \"…\"`)");
            ctx.problems.push(problem);
        }
    }
}

/// Checks that exactly one process drives every robot.
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

/// A product that one process makes for others.
struct Provision {
    need: Need,
    /// Kind of the product.
    product: Product,
    /// End of the message "two processes …".
    both: &'static str,
    /// Part of the message "process … …, but no process provides them".
    uses: &'static str,
}

const PROVISIONS: [Provision; 2] = [
    Provision {
        need: Need::Belief,
        product: Product::Beliefs,
        both: "publish beliefs",
        uses: "uses beliefs",
    },
    Provision {
        need: Need::Plans,
        product: Product::Plans,
        both: "make plans",
        uses: "asks for plans",
    },
];

/// Checks that the needs of every process are met.
pub fn check_needs(ctx: &mut Context<'_>, read: &[Read], robots: &[Robot]) {
    for provision in &PROVISIONS {
        check_provision(ctx, read, provision);
    }
    check_robots(ctx, read, robots, &SCANNER);
    check_robots(ctx, read, robots, &GOAL);
}

/// Checks that one process at most makes each product, and that every needed product has one.
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
                r.spec.name, provision.uses
            );
            let problem = ctx
                .block_problem(r.origin, &r.path, Code::Requirement, message)
                .expected(format!("a [[processes]] block with kind = \"{provider}\""));
            ctx.problems.push(problem);
        }
    }
}

/// Equipment of a robot that the process driving it needs.
struct Equipment {
    need: Need,
    /// Key of the robot that adds it.
    key: &'static str,
    is_there: fn(&Robot) -> bool,
    /// Parts of the message "robot … has no range scanner, but process … steers by it".
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

/// Checks that a process that needs equipment drives robots that have it.
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
