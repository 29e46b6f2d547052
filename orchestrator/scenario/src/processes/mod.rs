//! `[[processes]]`: the processes of a run and the robots that each drives.

mod checks;
mod files;
mod read;
mod tasks;

use config::{Code, FieldPath, Node};
use geometry::map::MapSpec;
use runtime::declaration::{self, Declaration, WrittenDeclaration};
use sim_backend::spec::RulesSpec;

use super::context::Context;
use super::events::EventSpec;
use super::files::Base;
use super::resolved::ProcessSpec;
use super::robots::Robot;
use super::spec::{MAX_PROCESSES, RunSpec};
use checks::{check_drivers, check_inputs, check_names};
use read::ProcessEntry;

/// Reads all processes, checks that every robot is driven by exactly one, and that each process can do
/// its task on this map. Reports all problems.
pub fn resolve(
    ctx: &mut Context<'_>,
    base: &Base,
    robots: Option<&[Robot]>,
    map: Option<&MapSpec>,
    rules: Option<&RulesSpec>,
    events: &[EventSpec],
    run: &RunSpec,
) -> Vec<ProcessSpec> {
    let mut read: Vec<ProcessEntry> = Vec::new();
    let before = ctx.problems.len();
    let blocks = ctx.blocks("processes");
    for (path, node) in &blocks {
        register_topics(ctx, node, path);
    }
    if ctx.problems.len() > before {
        return Vec::new();
    }
    for (path, node) in blocks {
        read::block(ctx, base, &node, &path, robots, run, &mut read);
    }
    if let Some(extra) = read.get(MAX_PROCESSES) {
        ctx.problems.push(
            ctx.block_problem(extra.origin, &extra.path, Code::Limit, "too many processes")
                .value(read.len())
                .expected(format!("at most {MAX_PROCESSES} processes"))
                .help("let one process drive several robots: grouping = \"together\""),
        );
    }
    check_names(ctx, &read);
    // A process that is unreadable may drive the robots without a driver.
    if ctx.problems.len() == before
        && let Some(robots) = robots
    {
        check_drivers(ctx, &read, robots);
        check_inputs(ctx, &read, robots);
        if let (Some(map), Some(rules)) = (map, rules)
            && ctx.problems.len() == before
        {
            tasks::check(ctx, map, robots, rules, events, &read, run.seed);
        }
    }
    in_order(read.into_iter().map(|r| r.spec).collect())
}

/// Sorts processes so that those that others may wait for come first, each after those that it waits for; otherwise the order
/// of the file holds.
fn in_order(mut specs: Vec<ProcessSpec>) -> Vec<ProcessSpec> {
    specs.sort_by_key(|spec| {
        let declaration = spec.declaration();
        !declaration.is_some_and(|known| known.is_within_tick())
    });
    let declarations: Vec<Option<Declaration>> =
        specs.iter().map(ProcessSpec::declaration).collect();
    let Ok(order) = declaration::order(&declaration::upstream(&declarations), |_| false) else {
        // A circle has been reported.
        return specs;
    };
    let mut places = vec![0; specs.len()];
    for (place, &index) in order.iter().enumerate() {
        places[index] = place;
    }
    let mut placed: Vec<_> = places.into_iter().zip(specs).collect();
    placed.sort_by_key(|(place, _)| *place);
    placed.into_iter().map(|(_, spec)| spec).collect()
}

/// Registers the topics that the external programs declare to write, so that others can name them.
fn register_topics(ctx: &mut Context<'_>, node: &Node, path: &FieldPath) {
    if let Some(declaration) = node.get("declaration").filter(|it| it.as_table().is_some())
        && let Some(written) =
            ctx.read::<WrittenDeclaration>(declaration, &path.then("declaration"))
        && let Err(fault) = written.register()
    {
        let message = fault.to_string();
        ctx.problems
            .push(ctx.problem(node, path, "declaration", Code::OutOfRange, message));
    }
}
